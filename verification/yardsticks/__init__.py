"""Rows of a verification: each module puts a pair through some of the independent methods and says how far they are."""
