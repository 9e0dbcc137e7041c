"""Oil film: formulas of its least thickness, what heat of the inlet takes from it, and where it is least."""
