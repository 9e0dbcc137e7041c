"""Solvers of the contact problem behind one interface, one adapter a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .problem_batch import ContactSolutions, solve_many
    from .registry import available_solvers, require_solver, solve
    from .solution import ContactSolution, Status
    from .solver_declaration import Solver, SolverChoice
    from .solver_table import SOLVERS

__all__ = [
    "SOLVERS",
    "ContactSolution",
    "ContactSolutions",
    "Solver",
    "SolverChoice",
    "Status",
    "available_solvers",
    "require_solver",
    "solve",
    "solve_many",
]

_ORIGINS = {
    ".problem_batch": ["ContactSolutions", "solve_many"],
    ".registry": ["available_solvers", "require_solver", "solve"],
    ".solution": ["ContactSolution", "Status"],
    ".solver_declaration": ["Solver", "SolverChoice"],
    ".solver_table": ["SOLVERS"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
