"""Loaded contact of a pair on its supports, with the motion of its members under load.

Results of a pair on supports: misalignment under load, mesh force, bearing loads, shares of the rotation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import RealArray as Array, record
from ...core.attributes import labelled
from ...geometry.pair.gear_pair import MEMBERS
from ..loaded import LoadedCase, loaded_dataset, rotation_numbers
from .assembly_rounds import CycleInAssembly, FoundRound, Round, RoundsStatus
from .support import ORIGIN, shifted_wrench
from .supported_pair import PARTS, SupportedPair, cycle_mean

CYCLE = ("torque", "mesh_position")
SHARES = ("teeth_rotation", "contact_rotation", "supports_rotation", "ease_off_rotation")


def _mesh_forces(found: Sequence[Round], wrench: Array) -> dict[str, Any]:
    """Force and moment of the mesh on each member about its reference, for wrenches (t, k, 6) about the origin."""
    supports = found[0].supports[0]
    references = np.array([supports.pinion.reference, supports.gear.reference])
    both = [sign * shifted_wrench(wrench, ORIGIN, point) for sign, point in zip((1.0, -1.0), references, strict=True)]
    on_members = np.stack(both)
    dims = ("member", *CYCLE, "space")
    return {
        "mesh_force": (dims, on_members[..., :3]),
        "mesh_moment": (dims, 1e-3 * on_members[..., 3:]),
        "reference": (("member", "space"), references),
    }


def _bearing_names(found: Round) -> list[str]:
    """Names of the bearings of pinion and gear."""
    supports = found.supports[0]
    members = zip(MEMBERS, (supports.pinion, supports.gear), strict=True)
    return [f"{member} {bearing.name}" for member, support in members for bearing in support.bearings]


def _bearing_loads(found: Sequence[Round], wrench: Array) -> dict[str, Any]:
    """Force on every bearing, and its moment about the bearing's centre, for wrenches (t, k, 6) about the origin."""
    names = _bearing_names(found[0])
    if not names:
        return {}
    loads = np.full((len(names), *wrench.shape), np.nan)
    for torque, one in enumerate(found):
        for position, supports in enumerate(one.supports):
            loads[:, torque, position] = [
                bearing.load(sign * shifted_wrench(wrench[torque, position], ORIGIN, support.reference))
                for sign, support in ((1.0, supports.pinion), (-1.0, supports.gear))
                for bearing in support.bearings
            ]
    members = (found[0].supports[0].pinion, found[0].supports[0].gear)
    points = np.array([bearing.point for support in members for bearing in support.bearings])
    dims = ("bearing", *CYCLE, "space")
    return {
        "bearing_force": (dims, loads[..., :3]),
        "bearing_moment": (dims, 1e-3 * loads[..., 3:]),
        "bearing_position": (("bearing", "space"), points),
    }


def _shares(rotation: Array, cases: Sequence[LoadedCase], torques: Array) -> list[Array]:
    """Parts of the rotation (t, k) [rad] by compliances, and by the ease-off, for torques at the gear (t) [N m].

    Work of the forces on each compliance over the torque, F'CF/T; the rest is that on the ease-off, F'S/T.
    """
    shares = [np.full(rotation.shape, np.nan) for _ in range(3)]
    for case in cases:
        if not case.solution.certified:
            continue
        segments, force, place = case.segments, case.solution.force, (case.torque, case.mesh_position)
        bending = float(np.sum((force @ segments.bending.factor) ** 2))
        local = float(force @ segments.line_contact.deflection(force))
        wrench = segments.mesh_wrench(force)
        motion = 0.0 if segments.held is None else float(segments.held.twist(wrench) @ wrench)
        for share, work in zip(shares, (bending, local, motion), strict=True):
            share[place] = work / (1e3 * torques[case.torque])
    return [*shares, rotation - sum(shares)]


@record(frozen=True, eq=False)
class SupportedContact:
    """Loaded contact on supports at torques (t) and mesh positions (k).

    Parameters
    ----------
    pair
        The pair and its supports.
    torques
        Torques at the pinion (t) [N m].
    rounds
        Last rounds of all torques.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.contact.supports.support import Support, Supports
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=9)
    >>> spring = Support((0.0, 0.0, 0.0), np.diag([5e-6, 5e-6, 5e-6, 1e-10, 1e-10, 1e-10]))
    >>> found = cycle.supported([100.0], Supports(spring, spring))
    >>> found.misalignment["offset"].dims
    ('torque', 'mesh_position')
    """

    pair: SupportedPair
    torques: Array
    rounds: tuple[FoundRound, ...]

    @cached_property
    def cases(self) -> list[LoadedCase]:
        """Every solved case with its contact problem."""
        cases = [replace(case, torque=one.torques[case.torque]) for one in self.rounds for case in one.found.cases]
        return sorted(cases, key=lambda case: (case.mesh_position, float(self.torques[case.torque])))

    @cached_property
    def _by_torque(self) -> list[tuple[FoundRound, int]]:
        """Last round of every torque, and its number in there."""
        places = {number: (one, row) for one in self.rounds for row, number in enumerate(one.torques)}
        return [places[number] for number in range(self.torques.size)]

    @cached_property
    def assemblies(self) -> list[tuple[tuple[int, ...], CycleInAssembly]]:
        """Numbers of the torques and the pair in the assembly of their geometry."""
        return [(one.torques, one.found.cycle) for one in self.rounds]

    def over_torque(self, name: str) -> Array:
        """An array of the rounds over all torques (t, ...)."""
        return np.stack([getattr(one.found, name)[row] for one, row in self._by_torque])

    @property
    def mesh_wrench(self) -> Array:
        """Force and moment of the gear on the pinion about the origin of the global frame (t, k, 6) [N, N mm]."""
        return self.over_torque("wrench")

    @property
    def transmission_error(self) -> Array:
        """Rotation of the gear (t, k) [rad] against the drive sense, without ``support_rotation``."""
        return np.asarray(self.over_torque("rotation") - self.support_rotation[:, None])

    @property
    def support_rotation(self) -> Array:
        """Rotation of the gear by the supports (t) [rad], on average over the mesh cycle.

        By the rotations of both members within their relative motion, and by the first contact in the assembly found.
        How it varies over the cycle belongs to the transmission error: E, P, G and Sigma vary with it, and turn the
        gear as well.
        """
        parts, ratio = cycle_mean(self.over_torque("parts")), self.pair.assembly.ratio
        pinion, gear = (parts[:, PARTS.index(name)] for name in ("pinion_rotation", "gear_rotation"))
        return np.asarray(self.over_torque("first_contact") + gear - pinion / ratio)

    @cached_property
    def loaded(self) -> xr.Dataset:
        """The group ``/loaded``; its transmission error leaves out ``support_rotation``."""
        segments = [position_segments for one in self.rounds for position_segments in one.found.segments]
        rotations = self.pair.cycle.lines.rotations
        dataset = loaded_dataset(segments, self.cases, self.torques, rotations)
        numbers = rotation_numbers(1e6 * self.transmission_error)
        return dataset.assign({name: (dims, values, dataset[name].attrs) for name, (dims, values) in numbers.items()})

    @property
    def _coords(self) -> dict[str, Any]:
        positions = self.pair.cycle.lines.rotations.size
        return {"torque": self.torques, "mesh_position": np.arange(positions) / positions}

    @cached_property
    def misalignment(self) -> xr.Dataset:
        """The group ``misalignment`` of a result: E, P, G [mm] and Sigma [rad] under load (t, k)."""
        given = np.array(list(vars(self.pair.assembly.misalignment).values()))
        misalignment = given + self.over_torque("parts")[..., :4]
        data = {name: (CYCLE, misalignment[..., number]) for number, name in enumerate(PARTS[:4])}
        return labelled(xr.Dataset(data, coords=self._coords))

    @cached_property
    def supports(self) -> xr.Dataset:
        """The group ``supports`` of a result: motion, mesh force, bearing loads and shares of the rotation (t, k)."""
        parts, wrench, rotation = (self.over_torque(name) for name in ("parts", "wrench", "rotation"))
        ended, rounds = [one for one, _ in self._by_torque], [one.found for one, _ in self._by_torque]
        shares = _shares(rotation, self.cases, self.pair.assembly.ratio * self.torques)
        statuses = np.array([one.status for one in ended], dtype=np.int8)
        data: dict[str, Any] = {
            "transmission_error": (CYCLE, 1e6 * self.transmission_error),
            "whole_rotation": (CYCLE, 1e6 * rotation),
            "support_rotation": ("torque", 1e6 * self.support_rotation),
            "pinion_support_rotation": (CYCLE, 1e6 * parts[..., PARTS.index("pinion_rotation")]),
            "gear_support_rotation": (CYCLE, 1e6 * parts[..., PARTS.index("gear_rotation")]),
            **{name: (CYCLE, 1e6 * share) for name, share in zip(SHARES, shares, strict=True)},
            **_mesh_forces(rounds, wrench),
            **_bearing_loads(rounds, wrench),
            "rounds": ("torque", [one.count for one in ended]),
            "last_change": ("torque", [one.change for one in ended]),
            "rounds_status": ("torque", statuses, RoundsStatus.flag_attributes()),
        }
        coords: dict[str, Any] = {**self._coords, "member": list(MEMBERS), "space": list("xyz")}
        if names := _bearing_names(rounds[0]):
            coords["bearing"] = names
        by_torque = zip(self.torques, ended, strict=True)
        reasons = {f"{torque:g} N m: {one.reason}" for torque, one in by_torque if one.reason}
        attributes = {"rounds_not_ended": "; ".join(sorted(reasons))} if reasons else {}
        return labelled(xr.Dataset(data, coords=coords, attrs=attributes))
