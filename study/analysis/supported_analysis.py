"""Loaded contact of a case on its supports, by the assemblies that are found under load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import xarray as xr
from numpy.typing import NDArray

from ...contact.loaded_cases import LoadedCase
from ...contact.mesh_cycle import MeshCycle
from ...contact.supports.assembly_rounds import AssemblyRounds
from ...contact.supports.support import LoadedSupports
from ...geometry.pair.assembly import Misalignment
from ..case_in_mesh import CaseInMesh

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
    >>> coarse = {"mesh_positions": 2, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
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
