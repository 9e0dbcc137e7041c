"""Unloaded and loaded tooth contact: curves, compliance, the contact problem and its solvers.

The contact problem stands on its own: ``ContactProblem``, ``solve`` and ``certify`` need no gear.
"""

from .bending import ElasticModel
from .certificate import Certificate, certify
from .complementarity_form import LCP, lcp
from .dual_form import DualQP, dual_qp
from .exchange import read_labels, read_problems, write_problems
from .lifted_form import LiftedQP, lifted_qp
from .line_contact_solution import solve_line_contact
from .loaded import loaded_contact, loaded_fields
from .problem import ContactProblem
from .programme_file import read_npz, write_npz
from .segments import lines_in_mesh
from .solvers import ContactSolution, Status, available_solvers, solve, solve_many
from .unloaded import unloaded_contact

__all__ = [
    "LCP",
    "Certificate",
    "ContactProblem",
    "ContactSolution",
    "DualQP",
    "ElasticModel",
    "LiftedQP",
    "Status",
    "available_solvers",
    "certify",
    "dual_qp",
    "lcp",
    "lifted_qp",
    "lines_in_mesh",
    "loaded_contact",
    "loaded_fields",
    "read_labels",
    "read_npz",
    "read_problems",
    "solve",
    "solve_line_contact",
    "solve_many",
    "unloaded_contact",
    "write_npz",
    "write_problems",
]
