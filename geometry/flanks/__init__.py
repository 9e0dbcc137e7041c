"""Tooth flanks on the nodes of their blanks, and their curvatures."""
