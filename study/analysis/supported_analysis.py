"""Loaded contact of a case on its supports, by the assemblies that are found under load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...cases.deflections import Deflections, misalignment_at
from ...cases.schema.case_schema import Case
from ...contact.loaded import LoadedCase
from ...contact.mesh_cycle import MeshCycle
from ...core.errors import GeometryError
from ...geometry.pair.assembly import Misalignment
from ..case_in_mesh import CaseInMesh

if TYPE_CHECKING:  # imported where a case has supports
    from ...contact.supports.assembly_rounds import AssemblyRounds
    from ...contact.supports.support import LoadedSupports

Array = NDArray[Any]


@dataclass(frozen=True)
class LoadedPart:
    """Loaded contact at some torques, in one assembly.

    Parameters
    ----------
    places
        Numbers of the torques.
    state
        The pair in mesh.
    loaded, cases
        As of ``MeshCycle.loaded``.
    groups
        Groups ``misalignment`` and ``supports`` of a pair on supports; empty without supports.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> LoadedPart((0,), CaseInMesh.of(read_case("nasa-12x36")), xr.Dataset(), [], {}).groups
    {}
    """

    places: tuple[int, ...]
    state: CaseInMesh
    loaded: xr.Dataset
    cases: list[LoadedCase]
    groups: dict[str, xr.Dataset]


def supported_parts(
    state: CaseInMesh,
    places: Sequence[int],
    torques: Array,
    supports: LoadedSupports,
    rounds: AssemblyRounds | None = None,
    **options: Any,
) -> list[LoadedPart]:
    """Loaded contact on supports, in the assemblies whose ease-off it was found with.

    Parameters
    ----------
    state
        The pair in mesh, without load.
    places
        Numbers of the torques among all.
    torques
        Torques at the pinion (t) [N m].
    supports, rounds, **options
        As of ``MeshCycle.supported``.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> import numpy as np
    >>> from easeoff.contact.supports.support import Supports
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> state = CaseInMesh.of(case.model_copy(update={"contact": case.contact.model_copy(update=coarse)}))
    >>> (part,) = supported_parts(state, [0], np.array([100.0]), Supports.rigid())
    >>> sorted(part.groups)
    ['misalignment', 'supports']
    """
    states = {state.pair.assembly.misalignment: state}

    def assembled(misalignment: Misalignment) -> MeshCycle:
        if misalignment not in states:
            states[misalignment] = state.misaligned(misalignment)
        return states[misalignment].cycle

    found = state.cycle.supported(torques, supports, rounds=rounds, assembled=assembled, **options)
    parts = []
    for numbers, cycle in found.assemblies:
        own = {number: row for row, number in enumerate(numbers)}
        cases = [replace(case, torque=own[case.torque]) for case in found.cases if case.torque in own]
        groups = {name: getattr(found, name).isel(torque=list(numbers)) for name in ("misalignment", "supports")}
        there = states[cycle.geometry.pair.assembly.misalignment]
        chosen = tuple(places[number] for number in numbers)
        parts.append(LoadedPart(chosen, there, found.loaded.isel(torque=list(numbers)), cases, groups))
    return parts


def case_rounds(case: Case) -> AssemblyRounds | None:
    """Rounds as a case on supports has them; ``None`` without supports.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case_rounds(read_case("nasa-12x36")) is None
    True
    """
    if case.supports is None:
        return None
    from ...contact.supports.assembly_rounds import AssemblyRounds

    return AssemblyRounds(case.supports.rounds)


def case_supports(case: Case) -> LoadedSupports | None:
    """Supports of a case as ``cases.support_conversion`` makes them; ``None`` if it has none.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case_supports(read_case("nasa-12x36")) is None
    True
    """
    if case.supports is None:
        return None
    from ...cases.support_conversion import support_system

    return support_system(case)


def in_assembly_under_load(state: CaseInMesh, torques: Sequence[float] | Array) -> CaseInMesh:
    """A pair on the supports of its case, in the mean assembly that they give at each of some torques.

    For what holds the assembly while something else changes, such as wear. Without supports the pair as it is.

    Parameters
    ----------
    state
        The pair in mesh, without load.
    torques
        Torques at the pinion (t) [N m].

    Returns
    -------
    CaseInMesh
        With ``deflections``, exact at the torques, and a case without supports.

    Raises
    ------
    GeometryError
        If the assembly at a torque is not known: the contact has no certified solution, or the rounds do not end.

    Examples
    --------
    >>> from easeoff.cases import read_case, with_supports
    >>> case = with_supports(read_case("nasa-12x36"), "gearbox-nasa-12x36")
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> found = in_assembly_under_load(CaseInMesh.of(case), [100.0, 200.0])
    >>> [round(found.deflections.at(torque).pinion_axial, 3) for torque in (0.0, 100.0, 200.0)]
    [0.0, 0.014, 0.027]
    """
    case, load = state.case, np.sort(np.asarray(torques, dtype=np.float64))
    held = case_supports(case)
    if held is None:
        return state
    from ...contact.supports.supported_pair import PARTS

    rows = {0.0: list(vars(misalignment_at(state.misalignment, 0.0, state.flank)).values())}
    for places, own in state.assemblies(load):
        chosen = load[list(places)]
        for part in supported_parts(
            own, places, chosen, held, case_rounds(case), edge_contact=case.contact.edge_contact
        ):
            reason = part.groups["supports"].attrs.get("rounds_not_ended", "")
            means = [part.groups["misalignment"][name].mean("mesh_position").values for name in PARTS[:4]]
            if reason or not np.isfinite(means).all():
                raise GeometryError(
                    f"the assembly under load is not known: {reason or 'the contact has no certified solution'}; see "
                    "'easeoff run', and choose other torques or stiffer supports"
                )
            rows |= {load[place]: list(row) for place, row in zip(part.places, np.transpose(means), strict=True)}
    offset, pinion_axial, gear_axial, shaft_angle = np.transpose([rows[torque] for torque in sorted(rows)])
    table = Deflections(sorted(rows), offset, pinion_axial, gear_axial, shaft_angle)
    rigid = case.model_copy(update={"supports": None})
    return replace(state.misaligned(table), case=rigid)
