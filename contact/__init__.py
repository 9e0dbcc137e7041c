"""Unloaded and loaded tooth contact: curves, compliance, the contact problem and its solvers.

The contact problem stands on its own: ``ContactProblem``, ``solve`` and ``certify`` need no gear.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .compliance import ElasticFoundation, HalfSpaceCompliance, Material, Shell, ToothDimensions
    from .compliance.elastic_model import STEEL, ElasticModel
    from .line_contact.line_contact_path import LineContactPath, line_contact_path, line_contact_sensitivity
    from .lines.mesh_lines import MeshLines, lines_in_mesh
    from .mesh_cycle import MeshCycle
    from .problem.certificate import Certificate, certify
    from .problem.contact_problem import ContactProblem
    from .problem.exchange.problem_checksum import problem_checksum
    from .problem.exchange.problem_file import read_problems, write_problems
    from .problem.exchange.problem_formats import export_problems, import_problems
    from .problem.exchange.problem_set import ProblemSet
    from .problem.exchange.programme_file import read_npz
    from .problem.exchange.reference_solutions import read_references
    from .problem.forms.complementarity_form import LCP, lcp
    from .problem.forms.dual_form import DualQP, dual_qp
    from .problem.forms.lifted_form import LiftedQP, lifted_qp
    from .problem.modal_basis import ModalBasis, SharedModes
    from .problem.operator_compliance import OperatorCompliance
    from .problem.shared_modes import with_shared_modes
    from .solvers import (
        SOLVERS,
        ContactSolution,
        ContactSolutions,
        Solver,
        Status,
        available_solvers,
        solve,
        solve_many,
    )
    from .solvers.parametric.problem_gradient import ProblemGradient
    from .solvers.parametric.sensitivity import Sensitivity
    from .solvers.parametric.solution_change import Differentiability, SolutionChange
    from .solvers.parametric.solution_sensitivity import sensitivity
    from .solvers.parametric.torque_path import TorquePath, torque_path
    from .supports.assembly_rounds import AssemblyRounds
    from .supports.support import BearingReaction, Supports
    from .supports.support_identification import IdentifiedSupport, identified_support
    from .supports.supported_contact import SupportedContact
    from .tooth_root_stress import root_stress
    from .unloaded import unloaded_contact

__all__ = [
    "LCP",
    "SOLVERS",
    "STEEL",
    "AssemblyRounds",
    "BearingReaction",
    "Certificate",
    "ContactProblem",
    "ContactSolution",
    "ContactSolutions",
    "Differentiability",
    "DualQP",
    "ElasticFoundation",
    "ElasticModel",
    "HalfSpaceCompliance",
    "IdentifiedSupport",
    "LiftedQP",
    "LineContactPath",
    "Material",
    "MeshCycle",
    "MeshLines",
    "ModalBasis",
    "OperatorCompliance",
    "ProblemGradient",
    "ProblemSet",
    "Sensitivity",
    "SharedModes",
    "Shell",
    "SolutionChange",
    "Solver",
    "Status",
    "SupportedContact",
    "Supports",
    "ToothDimensions",
    "TorquePath",
    "available_solvers",
    "certify",
    "dual_qp",
    "export_problems",
    "identified_support",
    "import_problems",
    "lcp",
    "lifted_qp",
    "line_contact_path",
    "line_contact_sensitivity",
    "lines_in_mesh",
    "problem_checksum",
    "read_npz",
    "read_problems",
    "read_references",
    "root_stress",
    "sensitivity",
    "solve",
    "solve_many",
    "torque_path",
    "unloaded_contact",
    "with_shared_modes",
    "write_problems",
]

_ORIGINS = {
    ".compliance": ["ElasticFoundation", "HalfSpaceCompliance", "Material", "Shell", "ToothDimensions"],
    ".compliance.elastic_model": ["ElasticModel", "STEEL"],
    ".line_contact.line_contact_path": ["LineContactPath", "line_contact_path", "line_contact_sensitivity"],
    ".lines.mesh_lines": ["MeshLines", "lines_in_mesh"],
    ".mesh_cycle": ["MeshCycle"],
    ".problem.certificate": ["Certificate", "certify"],
    ".problem.contact_problem": ["ContactProblem"],
    ".problem.exchange.problem_checksum": ["problem_checksum"],
    ".problem.exchange.problem_file": ["read_problems", "write_problems"],
    ".problem.exchange.problem_formats": ["export_problems", "import_problems"],
    ".problem.exchange.problem_set": ["ProblemSet"],
    ".problem.exchange.programme_file": ["read_npz"],
    ".problem.exchange.reference_solutions": ["read_references"],
    ".problem.forms.complementarity_form": ["LCP", "lcp"],
    ".problem.forms.dual_form": ["DualQP", "dual_qp"],
    ".problem.forms.lifted_form": ["LiftedQP", "lifted_qp"],
    ".problem.modal_basis": ["ModalBasis", "SharedModes"],
    ".problem.operator_compliance": ["OperatorCompliance"],
    ".problem.shared_modes": ["with_shared_modes"],
    ".solvers": [
        "ContactSolution",
        "ContactSolutions",
        "SOLVERS",
        "Solver",
        "Status",
        "available_solvers",
        "solve",
        "solve_many",
    ],
    ".solvers.parametric.problem_gradient": ["ProblemGradient"],
    ".solvers.parametric.sensitivity": ["Sensitivity"],
    ".solvers.parametric.solution_change": ["Differentiability", "SolutionChange"],
    ".solvers.parametric.solution_sensitivity": ["sensitivity"],
    ".solvers.parametric.torque_path": ["TorquePath", "torque_path"],
    ".supports.assembly_rounds": ["AssemblyRounds"],
    ".supports.support": ["BearingReaction", "Supports"],
    ".supports.support_identification": ["IdentifiedSupport", "identified_support"],
    ".supports.supported_contact": ["SupportedContact"],
    ".tooth_root_stress": ["root_stress"],
    ".unloaded": ["unloaded_contact"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
