"""Motion of the contact lines with the settings: implicit derivatives of the level sets of the roll angle.

A point of a line moves across it as the roll angle there changes. An end moves to where line and boundary of the common
flank meet then. Between the ends points stay evenly spaced in length on the gear flank, which moves as well.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.errors import GeometryError
from ....geometry.newton import cramers_rule
from ...lines.contact_lines import BOUNDARY_FIELDS, length_through
from ...lines.flank_splines import SLOPES, VALUE_AND_SLOPES
from ...lines.mesh_lines import MeshLines
from .field_directions import FieldDirections

Array = NDArray[Any]

END_TOLERANCE = 1e-6  # fraction of the flank, or mm, within which a line's end lies on the boundary
LENGTH_STEP = 1e-5  # [mm], of the points of a line in a difference of lengths


@dataclass(frozen=True)
class LineMotion:
    """Derivatives of contact lines (m) by settings (j).

    Parameters
    ----------
    points
        Of the points along the lines (2, m, k, j), as fractions.
    length
        Of their lengths (m, j) [mm].
    """

    points: Array
    length: Array


def line_motion(directions: FieldDirections, mesh: MeshLines) -> LineMotion:
    """Motion of contact lines.

    Parameters
    ----------
    directions
        The fields and their derivatives.
    mesh
        Contact lines of the fields, from ``lines_in_mesh``.

    Raises
    ------
    GeometryError
        If a line ends within the flank, at a hole of it.
    """
    points, base = mesh.lines.points, directions.base
    roll = np.stack([d["roll_angle"] for d in base.derivatives(["roll_angle"], points, SLOPES)])
    tangents = [d["position"] for d in base.derivatives(["position"], points, SLOPES)]
    metric = [np.sum(tangents[i] * tangents[j], axis=0) for i, j in ((0, 0), (0, 1), (1, 1))]
    across = cramers_rule(metric[:2], metric[1:], roll)
    across = across / np.sum(roll * across, axis=0)  # a unit of roll angle across the line
    along = np.stack([-roll[1], roll[0]])
    along = along / np.sqrt(
        metric[0] * along[0] ** 2 + 2.0 * metric[1] * along[0] * along[1] + metric[2] * along[1] ** 2
    )
    forwards = np.sign(np.sum(np.gradient(points, axis=-1) * along, axis=0))
    along = along * forwards  # a millimetre along the line
    change = directions.slopes.evaluate(["roll_angle", "position"], points)
    turned, shifted = np.moveaxis(change["roll_angle"], 0, -1), np.moveaxis(change["position"], 1, -1)
    moved = -across[..., None] * turned[None]

    ends = [0, points.shape[2] - 1]
    wanted = _ends(directions, points[:, :, ends], roll[:, :, ends], turned[:, ends])
    unit = along[:, :, ends, None]
    slide = np.sum((wanted - moved[:, :, ends]) * unit, axis=0) / np.sum(unit**2, axis=0)
    share = np.linspace(0.0, 1.0, points.shape[2])
    slides = slide[:, :1] * (1.0 - share[:, None]) + slide[:, 1:] * share[:, None]
    moved = moved + along[..., None] * slides[None]

    # What that makes of lengths, and the slide that spaces the points evenly again.
    position = base("position", points)
    in_space = shifted + tangents[0][..., None] * moved[0] + tangents[1][..., None] * moved[1]
    longer = np.empty(turned.shape)
    for j in range(directions.count):
        step = LENGTH_STEP / max(float(np.max(np.abs(in_space[..., j]))), 1e-300)
        ahead, behind = (length_through(position + sign * step * in_space[..., j]) for sign in (1.0, -1.0))
        longer[..., j] = (ahead - behind) / (2.0 * step)
    moved = moved + along[..., None] * (share[:, None] * longer[:, -1:] - longer)
    return LineMotion(moved, longer[:, -1])


def _ends(directions: FieldDirections, points: Array, roll: Array, turned: Array) -> Array:
    """Derivatives (2, m, 2, j) of the ends of the lines: on their level and on the boundary that ends them."""
    names = list(BOUNDARY_FIELDS)
    found = directions.base.derivatives(names, points, VALUE_AND_SLOPES)
    change = directions.slopes.evaluate(names, points)
    t, h = points
    one, none = np.ones_like(t), np.zeros_like(t)
    still = np.zeros(turned.shape)
    distances, slopes, changes = [t, 1.0 - t, h, 1.0 - h], [[one, none]] * 2 + [[none, one]] * 2, [still] * 4
    for name in names:
        value, *by_fraction = (each[name] for each in found)
        for side in (value,) if name == "blade_distance" else (value, 1.0 - value):
            distances.append(side)
            slopes.append(by_fraction)
            changes.append(np.moveaxis(change[name], 0, -1))
    nearest = np.argmin(np.abs(distances), axis=0)
    if np.any(np.min(np.abs(distances), axis=0) > END_TOLERANCE):
        raise GeometryError(
            "a contact line ends at a hole of the flank, which has no derivative: use more grid nodes, or settings "
            "without undercut"
        )
    slope = np.take_along_axis(np.array(slopes), nearest[None, None], axis=0)[0]
    moved = np.take_along_axis(np.array(changes), nearest[None, ..., None], axis=0)[0]
    first, second = np.stack([roll[0], slope[0]]), np.stack([roll[1], slope[1]])
    return cramers_rule(first[..., None], second[..., None], -np.stack([turned, moved]))
