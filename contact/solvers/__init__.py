"""Solvers of the contact problem behind one interface, one adapter a file."""

from .many import solve_many
from .registry import available_solvers, require_solver, solve
from .settings import SOLVERS, SolverSettings
from .status import ContactSolution, Status

__all__ = [
    "SOLVERS",
    "ContactSolution",
    "SolverSettings",
    "Status",
    "available_solvers",
    "require_solver",
    "solve",
    "solve_many",
]
