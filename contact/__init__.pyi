from .compliance import (
    ElasticFoundation as ElasticFoundation,
    HalfSpaceCompliance as HalfSpaceCompliance,
    Material as Material,
    Shell as Shell,
    ToothDimensions as ToothDimensions,
)
from .compliance.elastic_model import STEEL as STEEL, ElasticModel as ElasticModel
from .line_contact.line_contact_path import (
    LineContactPath as LineContactPath,
    line_contact_path as line_contact_path,
    line_contact_sensitivity as line_contact_sensitivity,
)
from .lines.mesh_lines import MeshLines as MeshLines, lines_in_mesh as lines_in_mesh
from .mesh_cycle import MeshCycle as MeshCycle
from .problem.certificate import Certificate as Certificate, certify as certify
from .problem.compliance_matrix import OperatorCompliance as OperatorCompliance
from .problem.contact_problem import ContactProblem as ContactProblem
from .problem.exchange.fclib_file import read_references as read_references
from .problem.exchange.problem_file import (
    ProblemSet as ProblemSet,
    problem_checksum as problem_checksum,
    read_problems as read_problems,
    write_problems as write_problems,
)
from .problem.exchange.problem_formats import export_problems as export_problems, import_problems as import_problems
from .problem.exchange.programme_file import read_npz as read_npz
from .problem.modal_basis import (
    ModalBasis as ModalBasis,
    SharedModes as SharedModes,
    with_shared_modes as with_shared_modes,
)
from .problem.programme_forms import (
    LCP as LCP,
    DualQP as DualQP,
    LiftedQP as LiftedQP,
    dual_qp as dual_qp,
    lcp as lcp,
    lifted_qp as lifted_qp,
)
from .solvers import (
    SOLVERS as SOLVERS,
    ContactSolution as ContactSolution,
    ContactSolutions as ContactSolutions,
    Solver as Solver,
    Status as Status,
    available_solvers as available_solvers,
    solve as solve,
    solve_many as solve_many,
)
from .solvers.parametric.sensitivity import (
    Differentiability as Differentiability,
    ProblemGradient as ProblemGradient,
    Sensitivity as Sensitivity,
    SolutionChange as SolutionChange,
)
from .solvers.parametric.solution_sensitivity import sensitivity as sensitivity
from .solvers.parametric.torque_path import TorquePath as TorquePath, torque_path as torque_path
from .supports.assembly_rounds import AssemblyRounds as AssemblyRounds
from .supports.support import BearingReaction as BearingReaction, Supports as Supports
from .supports.support_identification import (
    IdentifiedSupport as IdentifiedSupport,
    identified_support as identified_support,
)
from .supports.supported_contact import SupportedContact as SupportedContact
from .tooth_root_stress import root_stress as root_stress
from .unloaded import unloaded_contact as unloaded_contact

__all__: list[str]
