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
    from .problem.compliance_matrix import OperatorCompliance
    from .problem.contact_problem import ContactProblem
    from .problem.exchange.fclib_file import read_references
    from .problem.exchange.problem_file import ProblemSet, problem_checksum, read_problems, write_problems
    from .problem.exchange.problem_formats import export_problems, import_problems
    from .problem.exchange.programme_file import read_npz
    from .problem.modal_basis import ModalBasis, SharedModes, with_shared_modes
    from .problem.programme_forms import LCP, DualQP, LiftedQP, dual_qp, lcp, lifted_qp
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
    from .solvers.parametric.sensitivity import Differentiability, ProblemGradient, Sensitivity, SolutionChange
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
    ".problem.compliance_matrix": ["OperatorCompliance"],
    ".problem.contact_problem": ["ContactProblem"],
    ".problem.exchange.fclib_file": ["read_references"],
    ".problem.exchange.problem_file": ["ProblemSet", "problem_checksum", "read_problems", "write_problems"],
    ".problem.exchange.problem_formats": ["export_problems", "import_problems"],
    ".problem.exchange.programme_file": ["read_npz"],
    ".problem.modal_basis": ["ModalBasis", "SharedModes", "with_shared_modes"],
    ".problem.programme_forms": ["DualQP", "LCP", "LiftedQP", "dual_qp", "lcp", "lifted_qp"],
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
    ".solvers.parametric.sensitivity": ["Differentiability", "ProblemGradient", "Sensitivity", "SolutionChange"],
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
