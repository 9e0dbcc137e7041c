"""Solvers of the contact problem behind one interface, one adapter a file."""

from .problem_batch import ContactSolutions, solve_many
from .registry import available_solvers, require_solver, solve
from .solution import ContactSolution, Status
from .solver_table import SOLVERS, SolverSettings

__all__ = [
    "SOLVERS",
    "ContactSolution",
    "ContactSolutions",
    "SolverSettings",
    "Status",
    "available_solvers",
    "require_solver",
    "solve",
    "solve_many",
]
