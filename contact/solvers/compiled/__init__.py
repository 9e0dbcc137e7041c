"""The contact solution as one compiled function over many problems."""
