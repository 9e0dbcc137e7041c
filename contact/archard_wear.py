"""Wear by Archard's law: depth that one engagement removes from both flanks, from line loads and sliding.

By that law (1953, doi:10.1063/1.1721448) a point of a flank loses h = k * integral of p v_s dt while the contact line
passes over it. The line crosses the flank at right angles to itself with the speed u, so that dt = dx / u with x across
the line; and the integral of p dx is the load per length F'. Hence, for either member,

    h = k F' v_s / u

per engagement, for any width of the contact. All teeth of a member are alike: the segments of every tooth pair in
mesh, over one mesh cycle, are one tooth's whole way through the mesh.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from scipy.interpolate import BSpline
from scipy.spatial import Delaunay

from ..core.arrays import Array, Bools, record
from ..core.errors import GeometryError, InputError
from ..geometry.pair.gear_pair import MEMBERS
from .lines.flank_splines import FlankSplines, fit

GRID = ("lengthwise", "profile")
SPLINE_DEGREE = 3  # of the field on a flank that the samples of an engagement are brought onto
SPLINE_INTERVALS = (16, 10)  # lengthwise and up the profile
SMOOTHING_WEIGHT = 1e-4  # weight of even continuation, against that of the samples


def rolling_splines(ease_off: xr.Dataset, rolling: Mapping[str, Array]) -> FlankSplines:
    """Splines on the gear flank of the ease-off and of the motion (lengthwise, profile) [mm per rad of the pinion]."""
    pinion = {f"pinion_{name}": ease_off[f"pinion_{name}"].transpose(*GRID).values for name in GRID}
    return fit(ease_off["lengthwise"].values, ease_off["profile"].values, {**rolling, **pinion})


@record(frozen=True)
class Engagement:
    """One tooth's way through the mesh: samples (n) at the contact segments, by member."""

    points: Mapping[str, Array]  # (2, n), fractions of the member's own flank
    passing: Mapping[str, Array]  # (n) [N/mm], times Archard's coefficient the depth
    area: Mapping[str, Array]  # (n) [mm^2] that each sample stands for
    ends: Mapping[str, Array]  # (2, m), of the contact lines, as fractions
    work: float  # load times sliding way [N mm], times the coefficient the volume


def engagement(
    loaded: xr.Dataset, splines: FlankSplines, pinion_pitch: float, segments_per_line: int, torque: int = 0
) -> Engagement:
    """Wear samples of one tooth in one engagement, from ``MeshCycle.loaded`` without edge contact.

    Refused if edges touch, which sweep no flank, or if a mesh position has no certified solution.
    """
    cycle = loaded.isel(torque=torque)
    if bool(cycle["overhang"].notnull().any()):
        raise InputError("loaded: must have contact on lines alone for wear (edge_contact = False)")
    values = {n: cycle[n].transpose("mesh_position", "segment").values for n in ("force", "length", *GRID)}
    present = np.isfinite(values["length"])
    if not np.all(np.isfinite(values["force"][present])) or not np.all(present.any(axis=1)):
        raise GeometryError("the contact is not solved at every mesh position: there is no wear to compute from it")
    force, length, lengthwise, profile = (v[present] for v in values.values())
    on_gear = np.stack([lengthwise, profile])
    moving = splines.evaluate(["sliding", "pinion_speed", "gear_speed", "pinion_lengthwise", "pinion_profile"], on_gear)
    points = {"pinion": np.stack([moving["pinion_lengthwise"], moving["pinion_profile"]]), "gear": on_gear}
    speed = {name: moving[f"{name}_speed"] for name in MEMBERS}
    step = pinion_pitch / cycle.sizes["mesh_position"]
    return Engagement(
        points,
        {name: force / length * moving["sliding"] / speed[name] for name in MEMBERS},
        {name: length * speed[name] * step for name in MEMBERS},
        {name: _ends(points[name].reshape(2, -1, segments_per_line)) for name in MEMBERS},
        float(np.sum(force * moving["sliding"])) * step,
    )


def _ends(lines: Array) -> Array:
    """Ends (2, 2 m) of lines whose segments have these middles (2, m, segments)."""
    first, last = lines[..., 0] - 0.5 * (lines[..., 1] - lines[..., 0]), lines[..., -1]
    return np.concatenate([first, last + 0.5 * (last - lines[..., -2])], axis=1)


def on_flank(samples: Engagement, member: str, lengthwise: Array, profile: Array) -> Array:
    """Samples as a smooth field (nt, nh), none below zero: the cubic tensor spline that fits best.

    Each sample weighs the area it stands for, so the integral is kept; where no line passes it is continued evenly.
    """
    points, value, area = samples.points[member], samples.passing[member], samples.area[member]
    before, beyond = [0.0] * SPLINE_DEGREE, [1.0] * SPLINE_DEGREE
    knots = [np.concatenate([before, np.linspace(0.0, 1.0, n + 1), beyond]) for n in SPLINE_INTERVALS]

    def basis(fractions: Array, axis: int) -> Array:
        return np.asarray(BSpline.design_matrix(np.clip(fractions, 0.0, 1.0), knots[axis], SPLINE_DEGREE).toarray())

    along, up = basis(points[0], 0), basis(points[1], 1)
    both = (along[:, :, None] * up[:, None, :]).reshape(value.size, -1)
    matrix = both.T @ (area[:, None] * both)
    sizes = (along.shape[1], up.shape[1])
    steps = [np.diff(np.eye(n), axis=0) for n in sizes]
    evenness = np.kron(steps[0].T @ steps[0], np.eye(sizes[1])) + np.kron(np.eye(sizes[0]), steps[1].T @ steps[1])
    matrix += SMOOTHING_WEIGHT * float(np.sum(area)) / matrix.shape[0] * evenness
    coefficients = np.linalg.solve(matrix, both.T @ (area * value)).reshape(sizes)
    return np.asarray(np.maximum(basis(lengthwise, 0) @ coefficients @ basis(profile, 1).T, 0.0))


def touched(samples: Engagement, member: str, lengthwise: Array, profile: Array) -> Bools:
    """True at nodes (nt, nh) of the flank between the outermost ends of the contact lines."""
    hull = Delaunay(np.concatenate([samples.points[member], samples.ends[member]], axis=1).T)
    grid = np.stack(np.meshgrid(lengthwise, profile, indexing="ij"), axis=-1)
    return np.asarray(hull.find_simplex(grid, tol=1e-9) >= 0)


def integral(value: Array, position: Array, lengthwise: Array, profile: Array) -> float:
    """Integral of a field (nt, nh) over a flank with nodes (nt, nh, 3) [mm], by trapezia."""
    along = np.gradient(position, lengthwise, axis=0, edge_order=2)
    up = np.gradient(position, profile, axis=1, edge_order=2)
    density = value * np.linalg.norm(np.cross(along, up), axis=-1)
    return float(np.trapezoid(np.trapezoid(density, profile, axis=1), lengthwise))
