"""The gear pair of a case in mesh: designed or deviating flanks, in an assembly, with or without a modification."""

from __future__ import annotations

import datetime
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from ..cases.analysis_size import AnalysisSize
from ..cases.conversion import elastic_model, finite_elements, gear_pair, misalignment as case_misalignment
from ..cases.deflection_table import MisalignmentSource, misalignment_of
from ..cases.deflections import UNITS, Deflections, misalignment_at
from ..cases.reading import read_case
from ..cases.schema.case_schema import Case, MisalignmentTable
from ..cases.writing import case_toml
from ..contact.compliance.finite_elements.finite_element_tooth import FiniteElementTooth
from ..contact.mesh_cycle import MeshCycle
from ..core.checks import instance
from ..geometry.deviation.deviation import Deviation, Method
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.gear_pair import FlankName, GearPair
from ..geometry.pair.modification import Modification, modified_ease_off
from ..geometry.tooth.tooth_flanks import MemberName
from .deviations import Deviated, Source, deviated_geometry, deviation_attributes, flank_deviations, updated_geometry


def checked_case(case: Case | str | Path) -> Case:
    """A case that is read already, or the name or path of one."""
    return case if isinstance(case, Case) else read_case(case)


@dataclass(frozen=True)
class FlanksInMesh:
    """Flanks in mesh, their assembly and departures, as of ``analyze``; the case's own where ``None``."""

    flank: FlankName = "drive"
    misalignment: MisalignmentSource | None = None
    deviations: Mapping[MemberName, Source] | None = None
    deviated: Deviated = "ease_off"
    interpolation: Method = "spline"
    modification: Modification | None = None

    def __post_init__(self) -> None:
        instance("deviations", self.deviations, Mapping | None)
        instance("modification", self.modification, Modification | None)
        if self.misalignment is not None:  # a table is read once
            object.__setattr__(self, "misalignment", misalignment_of(self.misalignment))

    def errors(self, case: Case) -> Misalignment | Deflections:
        """The misalignment, or that of a case."""
        given = self.misalignment
        return case_misalignment(case.misalignment) if given is None else misalignment_of(given)


@cache
def _own_version() -> str:
    return version("easeoff")


def case_attributes(case: Case, what: str) -> dict[str, Any]:
    """Attributes of every file: conventions, title, names of case and supports, version, computation, and the case."""
    now, package_version = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%dT%H:%M:%SZ"), _own_version()
    names = {"case_name": case.name, "supports_name": case.supports_name}
    return {
        "Conventions": "CF-1.11",
        "title": case.title,
        **{key: name for key, name in names.items() if name},
        "history": f"{now} easeoff {package_version} {what}",
        "easeoff_version": package_version,
        "case": case.text or case_toml(case),
    }


def prepared_pair(case: Case, flank: FlankName, misalignment: MisalignmentSource | None) -> GearPair:
    """The gear pair of a case without torque, with its own misalignment or another."""
    if misalignment is None:
        return gear_pair(case, flank)
    errors = misalignment_at(misalignment_of(misalignment), 0.0, flank)
    # The case's own deflections may have no rows of the flank.
    return gear_pair(case.model_copy(update={"misalignment": MisalignmentTable()}), flank).misaligned(errors)


def misalignment_attributes(misalignment: Misalignment) -> dict[str, float]:
    """Attributes of a file: the assembly errors E, P, G and Sigma, in this order."""
    return {f"misalignment_{name}_{unit}": getattr(misalignment, name) for name, unit in UNITS.items()}


def deflection_attributes(
    misalignment: Misalignment | Deflections, flank: FlankName, torques: Sequence[float] | NDArray[Any]
) -> dict[str, Any]:
    """Attributes of a file: torques [N m] from which to which deflections are tabulated, and which are beyond."""
    if isinstance(misalignment, Misalignment):
        return {}
    first, last = misalignment.torque_range(flank)
    beyond = f", extrapolated to {max(torques):g} N m" if len(torques) and max(torques) > last else ""
    note = f"table from {first:g} to {last:g} N m{beyond}"
    return {"deflection_torques_N_m": [first, last], "deflections": note}


@dataclass(frozen=True)
class CaseInMesh:
    """The gear pair of a case in mesh, over one pitch of the pinion; ``of`` makes one.

    Parameters
    ----------
    case
        The checked case.
    flank
        ``drive`` or ``coast``.
    pair
        The designed pair, with its misalignment.
    teeth
        Teeth of pinion and gear by finite elements or as solid shells; ``None`` for plain shells.
    deviations
        Deviations of the flanks by member.
    deviated
        Treatment of the deviations.
    modification
        Added to the ease-off; ``None`` for none.
    unmodified
        The pair in mesh without the modification.
    deflections
        Misalignment over the torque, of which ``pair`` has that without torque; ``None`` if it is constant.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> state = CaseInMesh.of(read_case("nasa-12x36"))
    >>> state.misaligned(Misalignment(offset=0.1)).pair.assembly.misalignment.offset
    0.1
    >>> state.modified(Modification({"lengthwise_crowning": 5.0})).cycle.lines is state.cycle.lines
    True
    """

    case: Case
    flank: FlankName
    pair: GearPair
    teeth: tuple[FiniteElementTooth, FiniteElementTooth] | None
    deviations: Mapping[str, Deviation]
    deviated: Deviated
    modification: Modification | None
    unmodified: MeshCycle
    deflections: Deflections | None = None

    @classmethod
    def of(
        cls,
        case: Case,
        *,
        flank: FlankName = "drive",
        misalignment: MisalignmentSource | None = None,
        deviations: Mapping[MemberName, Source] | None = None,
        deviated: Deviated = "ease_off",
        interpolation: Method = "spline",
        modification: Modification | None = None,
        stage: Callable[[str], None] | None = None,
    ) -> CaseInMesh:
        """Compute geometry, elastic teeth and contact lines of a case; arguments and raises as of ``analyze``."""
        flanks = FlanksInMesh(flank, misalignment, deviations, deviated, interpolation, modification)
        return cls.meshed(case, flanks, stage)

    @classmethod
    def meshed(cls, case: Case, flanks: FlanksInMesh, stage: Callable[[str], None] | None = None) -> CaseInMesh:
        """The same, of flanks as one argument."""
        instance("case", case, Case)
        instance("stage", stage, Callable | None)
        AnalysisSize.of(case, 1).require_memory()
        given = flanks.errors(case)
        pair, settings = prepared_pair(case, flanks.flank, given), case.contact
        departures = flank_deviations(pair, flanks.deviations, flanks.interpolation)
        teeth = finite_elements(case, pair, stage)
        nodes = (settings.lengthwise_nodes, settings.profile_nodes)
        geometry = deviated_geometry(pair, nodes, departures, flanks.deviated)
        counts = {"mesh_positions": settings.mesh_positions, "segments_per_line": settings.segments_per_line}
        cycle = MeshCycle.of(geometry, elastic_model(case, teeth), **counts)
        deflections = given if isinstance(given, Deflections) else None
        return cls(
            case, flanks.flank, pair, teeth, departures, flanks.deviated, flanks.modification, cycle, deflections
        )

    @cached_property
    def cycle(self) -> MeshCycle:
        """The pair in mesh, with the modification."""
        if self.modification is None:
            return self.unmodified
        return self.unmodified.with_ease_off(modified_ease_off(self.unmodified.geometry.ease_off, self.modification))

    def modified(self, modification: Modification | None) -> CaseInMesh:
        """The same with this modification in place of its own."""
        return replace(self, modification=modification)

    @property
    def misalignment(self) -> Misalignment | Deflections:
        """Misalignment, over the torque if it depends on it."""
        return self.pair.assembly.misalignment if self.deflections is None else self.deflections

    def misaligned(self, misalignment: Misalignment | Deflections) -> CaseInMesh:
        """The same in another assembly: with its deviations and its modification."""
        errors = misalignment_at(misalignment, 0.0, self.flank)
        geometry = self.unmodified.geometry.misaligned(errors)
        cycle = self.unmodified.with_geometry(updated_geometry(geometry, self.deviations, self.deviated))
        deflections = misalignment if isinstance(misalignment, Deflections) else None
        return replace(self, pair=self.pair.misaligned(errors), unmodified=cycle, deflections=deflections)

    def recut(self, case: Case) -> CaseInMesh:
        """The pair of a case with other machine or cutter settings in its own assembly; the elastic teeth are held.

        Raises
        ------
        GeometryError
            If a cutter meets no tooth of its blank, or the flanks do not meet.
        """
        pair = prepared_pair(case, self.flank, None)
        geometry = self.unmodified.geometry.recut(pair)
        cycle = self.unmodified.with_geometry(updated_geometry(geometry, self.deviations, self.deviated))
        return replace(self, case=case, pair=pair, unmodified=cycle)

    def assemblies(self, torques: Sequence[float] | NDArray[Any]) -> list[tuple[tuple[int, ...], CaseInMesh]]:
        """The distinct assemblies at torques [N m]: numbers of the torques, and the pair in that assembly.

        Examples
        --------
        >>> from easeoff.cases import Deflections, read_case
        >>> axle = Deflections([100.0, 300.0], offset=[0.02, 0.05])
        >>> state = CaseInMesh.of(read_case("nasa-12x36"), misalignment=axle)
        >>> [(places, at.pair.assembly.misalignment.offset) for places, at in state.assemblies([300.0, 50.0, 100.0])]
        [((0,), 0.05), ((1, 2), 0.02)]
        """
        if self.deflections is None:
            return [(tuple(range(len(torques))), self)]
        assemblies: dict[Misalignment, list[int]] = {}
        for number, torque in enumerate(torques):
            assemblies.setdefault(self.deflections.at(float(torque), self.flank), []).append(number)
        constant, errors = replace(self, deflections=None), self.pair.assembly.misalignment
        return [(tuple(at), constant if one == errors else self.misaligned(one)) for one, at in assemblies.items()]

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of a file: flank, teeth, assembly errors, modification and deviations."""
        assembly, added = self.pair.assembly, self.modification
        return {
            "flank": self.flank,
            "pinion_teeth": assembly.pinion_teeth,
            "gear_teeth": assembly.gear_teeth,
            "pinion_hand": assembly.pinion_hand,
            **misalignment_attributes(assembly.misalignment),
            **({} if added is None else {"modification_um": json.dumps(dict(added.coefficients))}),
            **deviation_attributes(self.deviations, self.deviated),
        }
