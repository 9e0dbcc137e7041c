"""A result in a notebook: the accessor of a tree, and its summary as text, tables and HTML."""
