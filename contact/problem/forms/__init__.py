"""Forms of the contact problem that other solvers take: lifted, dual and complementarity problem."""
