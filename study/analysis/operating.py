"""Operating of a case: what an analysis is given in keywords beside the case, checked once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from ...cases.analysis_size import AnalysisSize
from ...cases.schema.case_schema import Case
from ...contact.evaluation.marking_print import checked_thickness
from ...contact.solvers import SolverChoice
from ...core.checks import instance
from ...core.errors import InputError
from ..case_in_mesh import FlanksInMesh
from .contact_analysis import case_torques

if TYPE_CHECKING:
    from ...cases.schema.friction_table import FrictionTable
    from ...contact.supports.assembly_rounds import AssemblyRounds
    from ...contact.supports.support import LoadedSupports
    from ...core.arrays import Array
    from ...friction import FrictionModel, Lubricant, Operation
    from ...friction.operation import Numbers, Roughness

Part = TypeVar("Part")


class Friction(NamedTuple):
    """Friction of an analysis: operating conditions, models, and whether it is fed back."""

    operation: Operation
    model: FrictionModel
    feedback: bool


@dataclass(frozen=True)
class FrictionConditions:
    """Speeds [1/min], temperatures [degC], roughnesses [um], oil, models and feedback, as of ``analyze``."""

    speed: Numbers | None = None
    temperature: Numbers | None = None
    roughness: Roughness | list[Roughness] | Array | None = None
    oil: str | Lubricant | None = None
    friction_model: FrictionModel | None = None
    friction_feedback: bool | None = None

    def __post_init__(self) -> None:
        instance("friction_feedback", self.friction_feedback, bool | None)

    def of_case(self, case: Case) -> Friction | None:
        """Friction of a case: what is given, or else the case's own; ``None`` without any speed."""
        conditions = {name: getattr(self, name) for name in ("speed", "temperature", "roughness", "oil")}
        operation = operation_of(case.friction, **conditions)
        return friction_of(case, operation, self.friction_model, self.friction_feedback)


def friction_of(
    case: Case, operation: Operation | None, model: FrictionModel | None = None, feedback: bool | None = None
) -> Friction | None:
    """Friction under operating conditions, with models and feedback; what is not given is the case's own."""
    operation = operation_of(case.friction) if operation is None else operation
    if case.friction is not None:
        model = case.friction.model() if model is None else model
        feedback = case.friction.feedback if feedback is None else feedback
    if operation is None:
        if model is not None or feedback:
            raise InputError("speed = None: must be given [1/min] for friction_model and friction_feedback")
        return None
    from ...friction import FrictionModel, Operation

    model = FrictionModel() if model is None else model
    instance("operation", operation, Operation)
    instance("friction_model", model, FrictionModel)
    model.oil_states(operation)  # a temperature the oil has no data for shows before the work, not after
    return Friction(operation, model, bool(feedback))


def operation_of(table: FrictionTable | None, **conditions: Any) -> Operation | None:
    """Operating conditions that are given, not ``None``, or else the case's own; ``None`` without any speed."""
    given = {name: value for name, value in conditions.items() if value is not None}
    if table is not None:
        return table.operation(**given)
    if "speed" not in given:
        if given:
            raise InputError(
                f"{' and '.join(given)} without a speed: friction needs the speed of the pinion in 1/min, here or in a "
                "table [friction] of the case"
            )
        return None
    from ...friction import Operation

    return Operation(**given)


@dataclass(frozen=True)
class Operating:
    """Flanks in mesh, torques at the pinion [N m], contact, solver, friction and supports, as of ``analyze``.

    What is ``None`` is the case's own.
    """

    flanks: FlanksInMesh = field(default_factory=FlanksInMesh)
    torques: float | Sequence[float] | None = None
    edge_contact: bool | None = None
    marking: float | None = None
    solver: SolverChoice = "auto"
    friction: FrictionConditions = field(default_factory=FrictionConditions)
    supports: LoadedSupports | None = None
    rounds: AssemblyRounds | None = None

    def __post_init__(self) -> None:
        instance("edge_contact", self.edge_contact, bool | None)
        if self.supports is not None or self.rounds is not None:
            from ...contact.supports.assembly_rounds import AssemblyRounds
            from ...contact.supports.support import LoadedSupports

            instance("supports", self.supports, LoadedSupports | None)
            instance("rounds", self.rounds, AssemblyRounds | None)
        if self.marking is not None:
            checked_thickness(self.marking)

    @classmethod
    def of(cls, **keywords: Any) -> Operating:
        """Operating of keywords by their names in ``analyze``."""

        def part(kind: type[Part]) -> Part:
            names = {one.name for one in fields(kind)} & keywords.keys()  # type: ignore[arg-type]  # dataclasses
            return kind(**{name: keywords.pop(name) for name in names})

        return cls(part(FlanksInMesh), friction=part(FrictionConditions), **keywords)

    @property
    def contact(self) -> dict[str, Any]:
        """Keywords of ``contact_analysis``."""
        names = ("edge_contact", "marking", "solver", "supports", "rounds")
        return {name: getattr(self, name) for name in names}

    def load(self, case: Case) -> Array:
        """Torques (t) [N m], checked."""
        return case_torques(case, self.torques)


def analysis_size(case: Case, torques: int, friction: Friction | None) -> AnalysisSize:
    """Size of the analysis of a case at a number of torques, with its friction."""
    if friction is None:
        return AnalysisSize.of(case, torques)
    return AnalysisSize.of(case, torques, friction.operation.shape, feedback=friction.feedback)
