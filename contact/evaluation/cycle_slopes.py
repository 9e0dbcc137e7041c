"""Derivatives of a mesh cycle as a dataset: ease-off, roll angle, unloaded and loaded contact.

The elastic teeth and the segments in contact are held: within a touching set everything is smooth, and across its
changes forces and rotation are continuous. At every mesh position the system of the touching segments that Newton's
method ended with is solved once more, with the changes of gap, lever arm and deflection by all settings on the right.
From these follow pressures, load shares, centre and extent of the load, with the layout of the loaded dataset.

The root stress is linear in the segments' forces, with responses that depend on their places. The largest stress keeps
its place in the root and its direction. It changes with the forces on the nodes of the flank, which follow the
segments' forces and the shares of these that fall to each node.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import Array, Integers, record
from ...core.attributes import labelled, ordered
from ...core.errors import InputError
from ...geometry.pair.field_slopes import field_slopes
from ...geometry.pair.gear_pair import MEMBERS
from ...geometry.pair.near_pair import PairSetting
from ...geometry.pair.tooth_thickness import mean_thicknesses, thickness_slopes
from ..compliance.finite_elements.flank_compliance import spread_shares
from ..compliance.weber_line_contact import WeberLineContact
from ..line_contact.line_contact_path import line_contact_sensitivity
from ..loaded import LoadedCase
from ..mesh_cycle import MeshCycle
from ..segments import MATERIAL_DEPTH_MINIMUM, RELATIVE_CURVATURE_MINIMUM
from ..tooth_root_stress import Teeth, root_stress
from .bending_slopes import POINT_STEP, BendingSlopes
from .cycle_numbers import WAYS, load_spot
from .segment_slopes import (
    EdgePieces,
    FieldDirections,
    SegmentSlopes,
    on_member,
    rotation_slopes,
    unloaded_numbers,
)
from .unloaded_slopes import UnloadedSlopes, unloaded_slopes

SIZE_STEP = 1e-5  # relative, of the sizes of a line contact in a difference of its deflection
OVERHANG_STEP = 1e-7  # [mm], of the distance beyond an edge in such a difference; strips are some hundredths wide
SIZES = ("length", "equivalent_radius", "depth_pinion", "depth_gear", "overhang")


@record(frozen=True)
class CaseSlopes:
    """Derivatives of one case of n segments by settings (j), of which the last is the torque at the pinion.

    Places and lengths of edges without load are left at zero.
    """

    case: LoadedCase
    rotation: Array  # of the gear (j) [rad]
    force: Array  # (n, j) [N]
    pressure: Array
    moment: Array
    place: Array  # where the gear is loaded (2, n, j)
    pinion_place: Array
    length: Array
    equivalent_radius: Array


def case_slopes(
    slopes: SegmentSlopes, bending: BendingSlopes, cases: Sequence[LoadedCase], torque_slope: float
) -> list[CaseSlopes]:
    """Derivatives of solved cases; an ``InputError`` refuses one that is not certified, or is supported.

    ``torque_slope`` is the torque about the gear axis per torque at the pinion [N mm / (N m)].
    """
    result = []
    for case, softer in zip(cases, _deflection_slopes(cases), strict=True):
        segments, force = case.segments, case.solution.force
        if segments.support is not None:
            raise InputError("cases: must be those of rigid supports to have derivatives")
        rows = slopes.rows(case)
        known = np.flatnonzero(rows >= 0)  # edges without load have no part in the derivatives
        derivatives = {name: _among(values, rows) for name, values in slopes.slopes.items()}
        pinion, gear = (np.stack([_among(values, rows) for values in one]) for one in slopes.places)
        sizes = _sizes(segments.line_contact, derivatives)
        bent = np.zeros(pinion.shape[1:])
        bent[known] = bending(segments.pair[known], rows[known], force[known])
        bent = bent + sum(softer[name][:, None] * change for name, change in sizes.items())
        result.append(_case(case, derivatives | sizes, bent, (pinion, gear), torque_slope))
    return result


def _among(values: Array, rows: Integers) -> Array:
    """Values (n, j) of given rows (s) among all (m, j), zero for a row of -1."""
    return np.where(rows[:, None] >= 0, values[rows], 0.0)


def _case(
    case: LoadedCase, slopes: dict[str, Array], bent: Array, places: tuple[Array, Array], torque_slope: float
) -> CaseSlopes:
    segments, solution = case.segments, case.solution
    force, contact = solution.force, segments.line_contact
    arm, count = slopes["lever_arm"], bent.shape[1]
    gap = slopes["separation_angle"] * segments.lever_arm[:, None] + segments.separation_angle[:, None] * arm
    turn = np.zeros(count + 1)
    turn[-1] = torque_slope

    def with_torque(values: Array) -> Array:
        return np.pad(values, ((0, 0), (0, 1)))

    problem = segments.bending_problem.with_torque(case.problem.torque)
    changes = line_contact_sensitivity(problem, contact, solution).forward_all(
        torque=turn, separation=with_torque(gap), lever_arm=with_torque(arm), bent=with_torque(bent)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        of_load = np.nan_to_num(changes.force / force[:, None], posinf=0.0, neginf=0.0)
    of_load = of_load - with_torque(slopes["length"] / contact.length[:, None])
    of_load = of_load - with_torque(slopes["equivalent_radius"] / contact.equivalent_radius[:, None])
    pressure = 0.5 * contact.pressure(force)[:, None] * of_load
    moment = changes.force * segments.lever_arm[:, None] + force[:, None] * with_torque(arm)
    length, radius = (with_torque(slopes[name]) for name in ("length", "equivalent_radius"))
    pinion, gear = (np.stack([with_torque(values) for values in one]) for one in places)
    return CaseSlopes(case, changes.rotation, changes.force, pressure, moment, gear, pinion, length, radius)


def _sizes(contact: WeberLineContact, slopes: dict[str, Array]) -> dict[str, Array]:
    """Derivatives (n, j) of the sizes of a line contact, zero where a size is at its limit."""
    radius = contact.equivalent_radius[:, None]
    free = radius < 1.0 / RELATIVE_CURVATURE_MINIMUM
    sizes = {"length": slopes["length"], "equivalent_radius": np.where(free, -(radius**2) * slopes["curvature"], 0.0)}
    for name in ("depth_pinion", "depth_gear"):
        inside = getattr(contact, name)[:, None] > MATERIAL_DEPTH_MINIMUM
        sizes[name] = np.where(inside, slopes[name], 0.0)
    if np.any(np.isfinite(contact.overhang)):
        sizes["overhang"] = slopes["overhang"]
    return sizes


def _deflection_slopes(cases: Sequence[LoadedCase]) -> list[dict[str, Array]]:
    """Derivatives (n) of the local deflections under held forces by each of the sizes, for every case."""
    contact = WeberLineContact.joined([case.segments.line_contact for case in cases])
    force = np.concatenate([case.solution.force for case in cases])
    ends = np.cumsum([case.solution.force.size for case in cases])[:-1]
    slopes: list[dict[str, Array]] = [{} for _ in cases]
    for name in SIZES:
        size = getattr(contact, name)
        step = OVERHANG_STEP if name == "overhang" else SIZE_STEP * size
        ahead, behind = (replace(contact, **{name: size + sign * step}).deflection(force) for sign in (1.0, -1.0))
        for one, values in zip(slopes, np.split((ahead - behind) / (2.0 * step), ends), strict=True):
            one[name] = values
    return slopes


def load_spot_slopes(
    spot: Mapping[str, tuple[tuple[str, ...], Array]], slopes: Sequence[CaseSlopes]
) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Derivatives of load-weighted centre and extents, with their dimensions; ``spot`` is that of ``load_spot``."""
    torques, count = spot[f"load_centre_{WAYS[0]}"][1].size, slopes[0].rotation.size
    centre, extent = (np.stack([spot[f"load_{name}_{way}"][1] for way in WAYS]) for name in ("centre", "extent"))
    whole = np.zeros(torques)
    by_centre, by_square = np.zeros((2, torques, count)), np.zeros((2, torques, count))
    for one in slopes:
        at, force = one.case.torque, one.case.solution.force
        whole[at] += force.sum()
        away = one.case.segments.point - centre[:, at, None]
        moved = force[:, None] * one.place
        by_centre[:, at] += away @ one.force + moved.sum(axis=1)
        # About the centre, whose own motion does not count to first order.
        farther = away**2 - extent[:, at, None] ** 2
        by_square[:, at] += farther @ one.force + 2.0 * np.einsum("xn,xnj->xj", away, moved)
    with np.errstate(divide="ignore", invalid="ignore"):
        by_centre = by_centre / whole[:, None]
        by_extent = 0.5 * by_square / (whole[:, None] * extent[..., None])
    dims = ("torque", "setting")
    return {
        f"load_{name}_{way}": (dims, values[axis])
        for name, values in (("centre", by_centre), ("extent", by_extent))
        for axis, way in enumerate(WAYS)
    }


#: Variables of the loaded contact that are differentiated.
OF_LOAD = (
    "transmission_error",
    "mean_level",
    "peak_to_peak",
    "harmonic",
    "rms",
    "load_share",
    "edge_share",
    "force",
    "pressure",
    "max_pressure",
)


def load_variables(loaded: xr.Dataset, solved: Sequence[CaseSlopes]) -> dict[str, Any]:
    """Derivatives of the variables ``OF_LOAD``, with their dimensions."""
    cycle, count = (loaded.sizes["torque"], loaded.sizes["mesh_position"]), solved[0].rotation.size
    pairs, size = loaded["pair"].values, loaded.sizes["segment"]
    rotation = np.full((*cycle, count), np.nan)
    share = np.full((*cycle, pairs.size, count), np.nan)
    on_edges = np.full((*cycle, count), np.nan)
    of_segments = {name: np.full((*cycle, size, count), np.nan) for name in ("force", "pressure")}
    for one in solved:
        at, segments = (one.case.torque, one.case.mesh_position), one.case.segments
        rotation[at] = 1e6 * one.rotation
        whole = one.case.problem.torque
        moments = segments.lever_arm * one.case.solution.force

        def of_whole(values: Array, one: CaseSlopes = one, moments: Array = moments, whole: float = whole) -> Array:
            # The moments add up to the torque, which the last setting changes.
            part = one.moment[values].sum(axis=0) / whole
            part[-1] -= moments[values].sum() / whole * one.moment[:, -1].sum() / whole
            return np.asarray(part)

        for number, pair in enumerate(pairs):
            share[at][number] = of_whole(segments.pair == pair)
        on_edges[at] = of_whole(segments.edge >= 0)
        of_segments["force"][at][: segments.pair.size] = one.force
        of_segments["pressure"][at][: segments.pair.size] = one.pressure
    error = ordered(loaded, "transmission_error", "torque", "mesh_position")
    data: dict[str, Any] = {"transmission_error": (("torque", "mesh_position", "setting"), rotation)}
    data |= rotation_slopes(error, rotation, loaded.sizes["order"])
    data["load_share"] = (("torque", "mesh_position", "pair", "setting"), share)
    data["edge_share"] = (("torque", "mesh_position", "setting"), on_edges)
    for name, values in of_segments.items():
        data[name] = (("torque", "mesh_position", "segment", "setting"), values)
    pressure = ordered(loaded, "pressure", "torque", "mesh_position", "segment")
    flat, slopes = pressure.reshape(cycle[0], -1), of_segments["pressure"].reshape(cycle[0], -1, count)
    greatest = np.argmax(np.where(flat > 0.0, flat, -np.inf), axis=1)
    data["max_pressure"] = (("torque", "setting"), slopes[np.arange(cycle[0]), greatest])
    return data


OF_ROOTS = ("root_stress_history", "max_root_stress")


def root_stress_slopes(
    directions: FieldDirections, teeth: Teeth, cases: Sequence[CaseSlopes], stress: xr.Dataset
) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Derivatives of ``root_stress_history`` and ``max_root_stress``, with their dimensions."""
    pairs, count = stress["pair"].values, cases[0].rotation.size
    history = stress["root_stress_history"].transpose("torque", "member", "mesh_position", "pair").values
    slopes = np.full((*history.shape, count), np.nan)
    for one in cases:
        segments, force = one.case.segments, one.case.solution.force
        of_case = one.case.torque, slice(None), one.case.mesh_position
        column = np.searchsorted(pairs, segments.pair)
        places = (segments.pinion_point, one.pinion_place), (segments.point, one.place)
        for member, (tooth, place) in enumerate(zip(teeth, places, strict=True)):
            assert tooth.root is not None  # or there were no stress
            points, motion = on_member(directions, MEMBERS[member], *place)
            grid = tooth.flank.lengthwise, tooth.flank.profile
            nodes, shares = spread_shares(*grid, points)
            on_nodes = np.zeros((tooth.flank.profile.size, pairs.size))
            np.add.at(on_nodes, (nodes, column[:, None]), shares * force[:, None])
            gradient = tooth.root.gradients(on_nodes)
            by_segment = np.sum(shares * gradient[nodes, column[:, None]], axis=1)[:, None] * one.force
            for axis, step in enumerate(POINT_STEP * np.eye(2)[:, :, None]):
                ahead, behind = (_responses(grid, at, gradient, column) for at in (points + step, points - step))
                by_segment += ((ahead - behind) / (2.0 * POINT_STEP) * force)[:, None] * motion[axis]
            change = np.zeros((pairs.size, count))
            np.add.at(change, column, by_segment)
            slopes[of_case][member] = change
    flat, by_setting = (
        np.moveaxis(values, 1, 0).reshape(len(MEMBERS), len(history), -1, *rest)
        for values, rest in ((history, ()), (slopes, (count,)))
    )
    greatest = np.argmax(np.where(np.isfinite(flat), flat, -np.inf), axis=2)
    of_cycle = np.take_along_axis(by_setting, greatest[..., None, None], axis=2)[:, :, 0]
    return {
        "root_stress_history": (("torque", "member", "mesh_position", "pair", "setting"), slopes),
        "max_root_stress": (("torque", "member", "setting"), np.moveaxis(of_cycle, 0, 1)),
    }


def _responses(grid: tuple[Array, Array], points: Array, gradient: Array, column: Array) -> Array:
    """Stress (n) under unit forces at points."""
    nodes, shares = spread_shares(*grid, points)
    return np.asarray(np.sum(shares * gradient[nodes, column[:, None]], axis=1))


_GRID = ("lengthwise", "profile")
#: Variables of the ease-off that are differentiated.
ON_FLANK = ("ease_off", "ease_off_angle", "roll_angle", "lever_arm")


def ease_off_slopes(cycle: MeshCycle, slopes: Mapping[str, Array]) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Derivatives of ease-off and roll angle at the nodes of the gear flank, with their dimensions; none by torque."""
    ease_off = cycle.geometry.ease_off
    angle, arm = (ordered(ease_off, name, *_GRID)[..., None] for name in ("ease_off_angle", "lever_arm"))
    fields = {name: slopes[name] for name in ("ease_off_angle", "roll_angle", "lever_arm")}
    fields["ease_off"] = 1e3 * (slopes["ease_off_angle"] * arm + angle * slopes["lever_arm"])
    return {name: ((*_GRID, "setting"), np.pad(values, ((0, 0), (0, 0), (0, 1)))) for name, values in fields.items()}


@record(frozen=True)
class CycleSlopes:
    """Derivatives of a mesh cycle by settings, and last by the torque; ``of`` makes them."""

    cycle: MeshCycle
    settings: tuple[PairSetting, ...]
    nodes: Mapping[str, Array]
    directions: FieldDirections
    cases: list[CaseSlopes]

    @classmethod
    def of(cls, cycle: MeshCycle, settings: Sequence[PairSetting], cases: Sequence[LoadedCase]) -> CycleSlopes:
        """Differentiate solved cases.

        Refused are plates, cases not on rigid supports (``InputError``), and lines that end at a hole
        (``GeometryError``).
        """
        nodes, ease_off = field_slopes(cycle.geometry, settings), cycle.geometry.ease_off
        bends = {name: ordered(ease_off, name, *_GRID) for name in ("separation_curvature", "separation_skew")}
        directions = FieldDirections.of(cycle.fields, bends, nodes)
        edges = any(np.any(np.isfinite(case.segments.line_contact.overhang)) for case in cases)
        slopes = SegmentSlopes.of(cycle.segments, directions, EdgePieces.of(cases) if edges else None)
        derivatives = case_slopes(slopes, BendingSlopes.of(directions, slopes), cases, 1e3 * cycle.ratio)
        return cls(cycle, tuple(settings), nodes, directions, derivatives)

    def datasets(
        self, loaded: xr.Dataset, roots: Teeth | None = None, *, unloaded: bool = True
    ) -> tuple[xr.Dataset, xr.Dataset]:
        """Numbers of the mesh cycle, and their derivatives by settings, and last by the torque at the pinion [N m].

        By mm, rad or the setting's unit; NaN where the contact has a kink. Those without load only if asked.
        """
        cycle, cases = self.cycle, [one.case for one in self.cases]
        errors = unloaded_slopes(cycle.geometry, cycle.lines, self.settings, self.nodes) if unloaded else None
        values = cycle_values(cycle, loaded, cases, roots, errors)
        data: dict[str, Any] = ease_off_slopes(cycle, self.nodes) | load_variables(loaded, self.cases)
        data |= load_spot_slopes(load_spot(loaded), self.cases)
        data |= {} if errors is None else unloaded_numbers(errors)[1]
        by_setting = thickness_slopes(cycle.geometry.pair, self.settings)
        data["tooth_thickness"] = (("member", "setting"), np.pad(by_setting, ((0, 0), (0, 1))))
        if roots is not None:
            data |= root_stress_slopes(self.directions, roots, self.cases, values)
        return values, xr.Dataset(data, coords=values.coords)


def cycle_values(
    cycle: MeshCycle, loaded: xr.Dataset, cases: list[LoadedCase], roots: Teeth | None, unloaded: UnloadedSlopes | None
) -> xr.Dataset:
    """Values of the variables that ``CycleSlopes`` differentiates; the unloaded error only with ``unloaded``."""
    ease_off = cycle.geometry.ease_off
    values: dict[str, Any] = {name: ease_off[name] for name in ON_FLANK} | {name: loaded[name] for name in OF_LOAD}
    values |= load_spot(loaded)
    values |= {} if unloaded is None else unloaded_numbers(unloaded)[0]
    values["tooth_thickness"] = (("member",), mean_thicknesses(cycle.geometry.pair))
    coords: dict[str, Any] = {name: loaded[name] for name in ("torque", "mesh_position", "order", "pair")}
    coords["member"] = list(MEMBERS)
    coords |= {name: ease_off[name] for name in _GRID}
    if roots is not None:
        stress = root_stress(cycle.fields, roots, cases, loaded)
        values |= {name: stress[name] for name in OF_ROOTS}
    return labelled(xr.Dataset(values, coords=coords).drop_attrs(deep=False))
