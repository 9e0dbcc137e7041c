"""Studies of a pair: analysis, design, optimisation, wear, reports, pictures, comparison of solvers, command line."""
