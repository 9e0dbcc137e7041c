"""Active-set methods of the linear contact problem, and the exact answer on a given set."""
