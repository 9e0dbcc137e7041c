"""Top lands, slot widths and cutter edge radii of a pair by AGMA 929-B22, from its blanks."""
