"""Written pages: the contact report of results, the report of a comparison, meshes of the contact."""
