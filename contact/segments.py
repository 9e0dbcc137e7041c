"""Contact segments: every potential contact line of every tooth pair, divided evenly, with the data the contact needs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .curves import ContactLines, trace
from .fields import FlankFields

Array = NDArray[Any]

GAUSS_POINTS = 3


@dataclass(frozen=True)
class LineGeometry:
    """Contact lines at many mesh positions; m lines with s points each.

    Parameters
    ----------
    mesh_position, pair
        Index of the mesh position and number of the tooth pair of each line (m).
    length
        Length of each line (m) [mm].
    points
        Lengthwise and profile fractions on the gear (2, m, s).
    separation_angle
        Gap of closest approach next to each point, as a gear rotation (m, s) [rad].
    shift
        How far the closest approach lies from the point, as fractions (2, m, s).
    lever_arm
        Arm of the normal force about the gear axis (m, s) [mm].
    equivalent_radius
        Radius of relative curvature across the line (m, s) [mm].
    """

    mesh_position: NDArray[np.int64]
    pair: NDArray[np.int64]
    length: Array
    points: Array
    separation_angle: Array
    shift: Array
    lever_arm: Array
    equivalent_radius: Array


def mesh_rotations(pinion_pitch: float, positions: int) -> Array:
    """Pinion rotations (positions) [rad] spread evenly over one pitch, the middle of the flank in its middle."""
    return (np.arange(positions) / positions - 0.5) * pinion_pitch


def lines_in_mesh(fields: FlankFields, rotations: Array, pinion_pitch: float) -> tuple[ContactLines, Array, Array]:
    """Trace the contact lines of every tooth pair that can touch.

    Parameters
    ----------
    fields
        Splines from ``curves.contact_fields``.
    rotations
        Pinion rotations (k) [rad].
    pinion_pitch
        Angular pitch of the pinion [rad].

    Returns
    -------
    tuple
        The lines, and for each of them the index of its mesh position and its tooth pair. The pair 0 is the one that is
        at its middle in the middle of the mesh cycle; pair -1 is one pitch ahead of it, pair 1 one pitch behind.
    """
    corner = np.linspace(0.0, 1.0, 21)
    roll = fields("roll_angle", np.stack(np.meshgrid(corner, corner, indexing="ij")))
    ahead = int(np.ceil((float(np.max(roll)) - float(np.min(rotations))) / pinion_pitch))
    behind = int(np.ceil((float(np.max(rotations)) - float(np.min(roll))) / pinion_pitch))
    pairs = np.arange(-ahead, behind + 1)
    levels = (rotations[:, None] - pairs[None, :] * pinion_pitch).ravel()
    position = np.repeat(np.arange(rotations.size), pairs.size)
    pair = np.tile(pairs, rotations.size)
    lines = trace(fields, levels)
    return lines, position[lines.level], pair[lines.level]


def closest_approach(fields: FlankFields, points: Array) -> tuple[Array, Array, Array, Array]:
    """Gap, place and curvature of the closest approach next to points of a contact curve.

    Across the curve the gap is a(u) + (1/2) c u^2, where u is the roll angle beyond the curve's own, a the ease-off and c the
    separation curvature. Its minimum is at u = -a'/(c + a'') and is a - (1/2) a'^2/(c + a'').

    Parameters
    ----------
    fields
        Splines from ``curves.contact_fields``.
    points
        Points of contact curves (2, ...).

    Returns
    -------
    tuple
        Separation angle (...) [rad], shift of the closest approach (2, ...), lever arm (...) [mm], equivalent radius of
        the gap across the curve (...) [mm].
    """
    names = ["roll_angle", "ease_off_angle", "lever_arm", "separation_curvature"]
    value = fields.evaluate(names, points)
    first = [fields.evaluate(["roll_angle", "ease_off_angle", "position"], points, d) for d in ((1, 0), (0, 1))]
    second = [fields.evaluate(["roll_angle", "ease_off_angle"], points, d) for d in ((2, 0), (1, 1), (0, 2))]

    # Unit length across the curve on the flank, as a direction (lengthwise, profile).
    metric = [np.sum(first[i]["position"] * first[j]["position"], axis=0) for i, j in ((0, 0), (0, 1), (1, 1))]
    gradient = [f["roll_angle"] for f in first]
    determinant = metric[0] * metric[2] - metric[1] ** 2
    across = np.stack([metric[2] * gradient[0] - metric[1] * gradient[1],
                       metric[0] * gradient[1] - metric[1] * gradient[0]]) / determinant
    slope = np.sqrt(gradient[0] * across[0] + gradient[1] * across[1])  # roll angle per mm across the curve
    across = across / slope

    def along_across(name: str) -> tuple[Array, Array]:
        d = first[0][name] * across[0] + first[1][name] * across[1]
        dd = second[0][name] * across[0] ** 2 + 2 * second[1][name] * across[0] * across[1]
        return d, dd + second[2][name] * across[1] ** 2

    _, roll_bend = along_across("roll_angle")
    ease_slope, ease_bend = along_across("ease_off_angle")
    by_roll = ease_slope / slope
    bend_by_roll = (ease_bend - by_roll * roll_bend) / slope**2
    stiffness = value["separation_curvature"] + bend_by_roll
    # A gap that does not open across the curve has no closest approach there: keep the curve itself.
    opens = stiffness > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.where(opens, -by_roll / stiffness, 0.0)
        radius = np.where(opens, 1.0 / (value["lever_arm"] * stiffness * slope**2), np.inf)
    separation = value["ease_off_angle"] + 0.5 * by_roll * step
    return separation, across * step / slope, value["lever_arm"], radius


def line_geometry(
    fields: FlankFields, lines: ContactLines, position: NDArray[np.int64], pair: NDArray[np.int64], points: Array
) -> LineGeometry:
    """Attach separation, lever arm and curvature to points (2, m, s) of contact lines."""
    separation, shift, lever_arm, radius = closest_approach(fields, points)
    return LineGeometry(position, pair, lines.length, points, separation, shift, lever_arm, radius)


def gauss_points(lines: ContactLines, segments: int) -> tuple[Array, Array]:
    """Quadrature points of even segments.

    Parameters
    ----------
    lines
        Contact lines (m).
    segments
        Segments per line.

    Returns
    -------
    tuple
        Points (2, m, segments * GAUSS_POINTS) and the weights (GAUSS_POINTS) of one segment, which add up to one.
    """
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    fraction = ((np.arange(segments)[:, None] + 0.5 * (nodes + 1.0)) / segments).ravel()
    dense = fraction * (lines.points.shape[2] - 1)
    low = np.clip(dense.astype(int), 1, lines.points.shape[2] - 3)
    x = dense - low
    # Cubic through the four points around: the curve bends, and a chord would leave the level set.
    cubic = (
        (-x * (x - 1) * (x - 2) / 6, -1), ((x + 1) * (x - 1) * (x - 2) / 2, 0),
        (-(x + 1) * x * (x - 2) / 2, 1), ((x + 1) * x * (x - 1) / 6, 2),
    )
    points = sum(weight * lines.points[:, :, low + shift] for weight, shift in cubic)
    return np.asarray(points), weights / 2.0
