"""Search for machine settings by convex programmes in a trust region, every step certified by an analysis."""
