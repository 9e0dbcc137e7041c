"""Loaded contact of a pair on its supports, with the motion of its members under load.

The assembly under load is found in rounds. The contact problem of a round has the ease-off of its assembly, and what
the members move beyond it to first order. What is left to the next round is that the forces turn and move with the
flanks: about a hundredth of the change before.

The relative motion of pinion and gear is a twist, told as E, P, G, Sigma and the rotations of both about their axes.
With it stand mesh force, bearing loads and shares of the rotation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import RealArray as Array, record
from ...core.attributes import labelled
from ...core.errors import GeometryError
from ...geometry.pair.assembly import Assembly, Misalignment
from ...geometry.pair.gear_pair import MEMBERS
from ..loaded import CycleSolver, LoadedCase, loaded_dataset, rotation_numbers
from ..mesh_wrench import MeshWrenches, SupportModes
from ..segments import HeldMembers, Segments
from .assembly_rounds import AssemblyRounds, CycleInAssembly, LastRound, Round, RoundsStatus, Update
from .support import ORIGIN, LoadedSupports, Supports, member_axes, shifted_wrench

#: Parts of a relative motion, in this order: the four of ``Misalignment``, then the rotations in the drive sense.
PARTS = ("offset", "pinion_axial", "gear_axial", "shaft_angle", "pinion_rotation", "gear_rotation")


@record(frozen=True, eq=False)
class RelativeMotion:
    """The twist of the pinion relative to the gear, about the origin of the global frame, by its six parts."""

    assembly: Assembly
    pinion_sense: float  # of the drive rotation about the pinion axis, +1 or -1

    @cached_property
    def twists(self) -> Array:
        """The twist (6, 6) of a unit of each part, one a column."""
        pinion, gear = member_axes(self.assembly)
        side = 1.0 if self.assembly.pinion_hand == "left" else -1.0
        nothing = np.zeros(3)
        columns = [
            np.concatenate([[0.0, side, 0.0], nothing]),
            np.concatenate([pinion.direction, nothing]),
            np.concatenate([[0.0, 0.0, -1.0], nothing]),
            np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
            self.pinion_sense * pinion.rotation,
            self.pinion_sense * gear.rotation,  # the gear turns against it, and its motion counts negative
        ]
        return np.stack(columns, axis=1)

    def twist(self, parts: Array) -> Array:
        """The twist (..., 6) of parts (..., 6) [mm, rad]."""
        return np.asarray(parts @ self.twists.T)

    def parts(self, twist: Array) -> Array:
        """The parts (..., 6) [mm, rad] of a twist (..., 6)."""
        return np.asarray(np.linalg.solve(self.twists, np.asarray(twist)[..., None])[..., 0])


def moved(misalignment: Misalignment, parts: Array) -> Misalignment:
    """A misalignment with the first four parts (6) of a relative motion added."""
    return Misalignment(*(float(value) for value in np.array(list(vars(misalignment).values())) + parts[:4]))


#: Parts of the relative motion that a geometry can be made with: E, P, G, Sigma, and the rotation of the pinion.
MISALIGNMENT_PARTS, MOVED_PARTS = slice(0, 4), slice(0, 5)
#: Makes the pair in another assembly.
Assembled = Callable[[Misalignment], CycleInAssembly]


@dataclass(frozen=True, eq=False)
class SupportedPair:
    """A pair on supports, without load in the assembly of a mesh cycle."""

    cycle: CycleInAssembly
    supports: LoadedSupports
    assembled: Assembled
    solver: CycleSolver
    progress: Callable[[], None] | None = None

    @property
    def assembly(self) -> Assembly:
        """The assembly without load."""
        return self.cycle.geometry.pair.assembly

    def motion(self, cycle: CycleInAssembly) -> RelativeMotion:
        """The parts of a relative motion in the assembly of a cycle."""
        motion = cycle.geometry.exact.motion
        return RelativeMotion(motion.assembly, motion.pinion_sense)

    def solved(self, torques: Array, rounds: AssemblyRounds) -> list[LastRound]:
        """The last rounds at torques (t) [N m]: of all together where nothing is updated, else of each alone."""
        every = tuple(range(torques.size))
        alone = [torques[i : i + 1] for i in every]
        if not isinstance(self.supports, Supports):
            return [self._ended((i,), alone[i], self._first(alone[i]), rounds) for i in every]
        positions = self.cycle.lines.rotations.size
        together = self._round(torques, np.zeros((positions, 6)), (self.supports,) * positions, "none")
        if rounds.update == "none":
            return [self._ended(every, torques, together, rounds)]
        return [self._ended((i,), alone[i], together.at(i), rounds) for i in every]

    def _ended(self, numbers: tuple[int, ...], torques: Array, first: Round, rounds: AssemblyRounds) -> LastRound:
        """The last round at torques (t), counted by the progress."""
        ended = self._rounds(numbers, torques, first, rounds)
        if self.progress is not None:
            for _ in ended.round.cases:
                self.progress()
        return ended

    def _rounds(self, numbers: tuple[int, ...], torques: Array, last: Round, rounds: AssemblyRounds) -> LastRound:
        """The last round at torques (t), from the first."""
        absorbed, supports = np.zeros((len(last.supports), 6)), last.supports
        for count in range(1, rounds.most + 1):
            now, following = self._next(last, absorbed, rounds.update)
            change = self._change(last, now - absorbed, following) if rounds.update != "none" or following else 0.0
            ended = LastRound(numbers, last, count, change, RoundsStatus.ENDED, "")
            if not np.isfinite(change):
                reason = "no mesh position has a certified solution"
                return replace(ended, status=RoundsStatus.NOT_CERTIFIED, reason=reason)
            if change <= rounds.limit:
                return ended
            if count == rounds.most:
                break
            try:
                last = self._round(torques, now, following or supports, rounds.update)
            except GeometryError as error:
                reason = f"the flanks have no contact in the assembly found: {error}"
                return replace(ended, status=RoundsStatus.NO_GEOMETRY, reason=reason)
            absorbed, supports = now, following or supports
        reason = f"after {rounds.most} rounds the assembly still changes gaps by {change:.3g} um"
        return replace(ended, status=RoundsStatus.ROUND_LIMIT, reason=reason)

    def _first(self, torque: Array) -> Round:
        """The first round at a torque (1) on supports that depend on the load: under that of the pair on rigid ones."""
        assert not isinstance(self.supports, Supports)
        absorbed = np.zeros((self.cycle.lines.rotations.size, 6))
        wrench = self._round(torque, absorbed, (Supports.rigid(),) * len(absorbed), "none").wrench
        mean = np.nan_to_num(np.nanmean(wrench[0], axis=0)) if np.isfinite(wrench).any() else np.zeros(6)
        return self._round(torque, absorbed, (self.supports.at(mean, -mean),) * len(absorbed), "none")

    def _next(self, last: Round, absorbed: Array, update: Update) -> tuple[Array, tuple[Supports, ...]]:
        """Parts (k, 6) that the geometry of the next round absorbs, and its supports; none if they stay."""
        known = np.isfinite(last.wrench[0]).all(axis=1)
        if not known.any():
            return np.full_like(absorbed, np.nan), ()
        mean, wrench = last.parts[0, known].mean(axis=0), last.wrench[0, known].mean(axis=0)
        following, each = np.zeros_like(absorbed), np.where(known[:, None], last.wrench[0], wrench)
        if update == "mean":
            following[:, MISALIGNMENT_PARTS] = mean[MISALIGNMENT_PARTS]
        elif update == "position":
            every = np.where(known[:, None], last.parts[0], mean)
            following[:, MOVED_PARTS] = every[:, MOVED_PARTS]
        if isinstance(self.supports, Supports):
            return following, ()
        if update == "position":
            return following, tuple(self.supports.at(one, -one) for one in each)
        return following, (self.supports.at(wrench, -wrench),) * known.size

    def _change(self, last: Round, parts: Array, following: tuple[Supports, ...]) -> float:
        """Greatest change of a gap [um] by parts (k, 6) of the motion, and by other supports under the same load."""
        twist = self.motion(last.cycle).twist(parts)
        for number, (supports, wrench) in enumerate(zip(following, last.wrench[0], strict=False)):
            changed = supports.relative(self.assembly) - last.supports[number].relative(self.assembly)
            twist[number] += np.nan_to_num(changed @ wrench)
        return 1e3 * float(np.abs(last.wrenches.flank @ twist.T).max())

    def _round(self, torques: Array, absorbed: Array, supports: tuple[Supports, ...], update: Update) -> Round:
        """One round: the contact in the assembly that has absorbed parts (k, 6) of the motion."""
        compliances = {one: one.relative(self.assembly) for one in set(supports)}
        positions, misalignment = len(supports), self.assembly.misalignment
        mean = self._in_assembly(moved(misalignment, absorbed.mean(axis=0)), bool(absorbed.any()))
        shape = (torques.size, positions)
        wrench, parts, rotation = np.full((*shape, 6), np.nan), np.full((*shape, 6), np.nan), np.full(shape, np.nan)
        if update == "position":
            groups = [([number], self._at(number, absorbed[number])) for number in range(positions)]
        else:
            groups = [(list(range(positions)), mean)]
        segments, cases = list[Segments | None](), list[LoadedCase]()
        in_mean = MeshWrenches.of(mean.geometry)
        for numbers, cycle in groups:
            motion, wrenches = self.motion(cycle), in_mean if cycle is mean else MeshWrenches.of(cycle.geometry)
            keys = [(supports[k], tuple(absorbed[k])) for k in numbers]
            kinds = {key: SupportModes(compliances[key[0]], motion.twist(np.array(key[1]))) for key in set(keys)}
            modes = [kinds[key] for key in keys]  # those of equal ones are found once
            members = HeldMembers(modes, wrenches)
            there, solved = self.solver.cases(replace(cycle.segments, wrenches=wrenches), torques, members)
            segments += there
            apart = self._first_contact_change(cycle)
            for case in solved:
                k = numbers[case.mesh_position]
                cases.append(replace(case, mesh_position=k))
                if case.solution.certified:
                    case_segments, place = case.segments, (case.torque, k)
                    wrench[place] = case_segments.mesh_wrench(case.solution.force)
                    parts[place] = motion.parts(modes[case.mesh_position].twist(wrench[place]))
                    rotation[place] = case.solution.rotation + apart - absorbed[k, 4] / self.assembly.ratio
        beyond = np.nan_to_num(cycle_mean(parts)) - absorbed.mean(axis=0)
        beyond[:, MISALIGNMENT_PARTS.stop :] = 0.0
        change = np.array([in_mean.first_contact_change(one) for one in self.motion(mean).twist(beyond)])
        first_contact = change + self._first_contact_change(mean)
        return Round(mean, in_mean, segments, cases, wrench, parts, rotation, first_contact, supports)

    def _in_assembly(self, misalignment: Misalignment, changed: bool) -> CycleInAssembly:
        return self.assembled(misalignment) if changed else self.cycle

    def _at(self, number: int, absorbed: Array) -> CycleInAssembly:
        """The pair at one mesh position, in the assembly with parts (6) of the motion, the pinion turned with it."""
        cycle = self._in_assembly(moved(self.assembly.misalignment, absorbed), bool(absorbed.any()))
        middle = cycle.geometry.exact.motion.center - self.cycle.geometry.exact.motion.center
        rotation = self.cycle.lines.rotations[number] + absorbed[4] - _nearest_zero(middle)
        return cycle.at_rotations(np.array([rotation]))

    def _first_contact_change(self, cycle: CycleInAssembly) -> float:
        """First contact in the assembly of a cycle [rad], counted from that without load."""
        there, reference = (one.geometry.ease_off.attrs["first_contact_rad"] for one in (cycle, self.cycle))
        return _nearest_zero(there - reference)


def _nearest_zero(angle: float) -> float:
    """An angle [rad] without whole turns."""
    return float(np.mod(angle + np.pi, 2.0 * np.pi) - np.pi)


def cycle_mean(values: Array) -> Array:
    """Means (t, c) over mesh positions of values (t, k, c) that may be NaN; NaN where all are."""
    known = np.isfinite(values)
    count = known.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(known, values, 0.0).sum(axis=1) / count)


CYCLE = ("torque", "mesh_position")
SHARES = ("teeth_rotation", "contact_rotation", "supports_rotation", "ease_off_rotation")


def _mesh_forces(rounds: Sequence[Round], wrench: Array) -> dict[str, Any]:
    """Force and moment of the mesh on each member about its reference, for wrenches (t, k, 6) about the origin."""
    supports = rounds[0].supports[0]
    references = np.array([supports.pinion.reference, supports.gear.reference])
    both = [sign * shifted_wrench(wrench, ORIGIN, point) for sign, point in zip((1.0, -1.0), references, strict=True)]
    on_members = np.stack(both)
    dims = ("member", *CYCLE, "space")
    return {
        "mesh_force": (dims, on_members[..., :3]),
        "mesh_moment": (dims, 1e-3 * on_members[..., 3:]),
        "reference": (("member", "space"), references),
    }


def _bearing_names(last: Round) -> list[str]:
    """Names of the bearings of pinion and gear."""
    supports = last.supports[0]
    members = zip(MEMBERS, (supports.pinion, supports.gear), strict=True)
    return [f"{member} {bearing.name}" for member, support in members for bearing in support.bearings]


def _bearing_loads(rounds: Sequence[Round], wrench: Array) -> dict[str, Any]:
    """Force on every bearing, and its moment about the bearing's centre, for wrenches (t, k, 6) about the origin."""
    names = _bearing_names(rounds[0])
    if not names:
        return {}
    loads = np.full((len(names), *wrench.shape), np.nan)
    for torque, one in enumerate(rounds):
        for position, supports in enumerate(one.supports):
            loads[:, torque, position] = [
                bearing.load(sign * shifted_wrench(wrench[torque, position], ORIGIN, support.reference))
                for sign, support in ((1.0, supports.pinion), (-1.0, supports.gear))
                for bearing in support.bearings
            ]
    members = (rounds[0].supports[0].pinion, rounds[0].supports[0].gear)
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
        motion = 0.0 if segments.support is None else float(segments.support.twist(wrench) @ wrench)
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
    >>> supported = cycle.supported([100.0], Supports(spring, spring))
    >>> supported.misalignment["offset"].dims
    ('torque', 'mesh_position')
    """

    pair: SupportedPair
    torques: Array
    rounds: tuple[LastRound, ...]

    @cached_property
    def cases(self) -> list[LoadedCase]:
        """Every solved case with its contact problem."""
        cases = [replace(case, torque=one.torques[case.torque]) for one in self.rounds for case in one.round.cases]
        return sorted(cases, key=lambda case: (case.mesh_position, float(self.torques[case.torque])))

    @cached_property
    def _by_torque(self) -> list[tuple[LastRound, int]]:
        """Last round of every torque, and its number in there."""
        places = {number: (one, row) for one in self.rounds for row, number in enumerate(one.torques)}
        return [places[number] for number in range(self.torques.size)]

    @cached_property
    def assemblies(self) -> list[tuple[tuple[int, ...], CycleInAssembly]]:
        """Numbers of the torques and the pair in the assembly of their geometry."""
        return [(one.torques, one.round.cycle) for one in self.rounds]

    def over_torque(self, name: str) -> Array:
        """An array of the rounds over all torques (t, ...)."""
        return np.stack([getattr(one.round, name)[row] for one, row in self._by_torque])

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
        segments = [position_segments for one in self.rounds for position_segments in one.round.segments]
        dataset = loaded_dataset(segments, self.cases, self.torques, self.pair.cycle.lines.rotations)
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
        ended, rounds = [one for one, _ in self._by_torque], [one.round for one, _ in self._by_torque]
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
