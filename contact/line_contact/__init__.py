"""Contact problems with the load-dependent compliance of line contact."""
