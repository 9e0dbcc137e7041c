"""Solvers of one's own: their declaration, where they are found, and what their functions return."""
