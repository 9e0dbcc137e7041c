"""Unloaded and loaded tooth contact: curves, compliance, the contact problem and its solvers.

The contact problem stands on its own: ``ContactProblem``, ``solve`` and ``certify`` need no gear.
"""

from .bending import ElasticModel
from .certificate import Certificate, certify
from .exchange import read_labels, read_problems, write_problems
from .line_contact_solution import solve_line_contact
from .loaded import loaded_contact, loaded_fields
from .problem import ContactProblem
from .segments import lines_in_mesh
from .solvers import ContactSolution, Status, available_solvers, solve
from .unloaded import unloaded_contact

__all__ = [
    "Certificate",
    "ContactProblem",
    "ContactSolution",
    "ElasticModel",
    "Status",
    "available_solvers",
    "certify",
    "lines_in_mesh",
    "loaded_contact",
    "loaded_fields",
    "read_labels",
    "read_problems",
    "solve",
    "solve_line_contact",
    "unloaded_contact",
    "write_problems",
]
