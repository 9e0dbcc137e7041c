"""One adapter a solver package."""
