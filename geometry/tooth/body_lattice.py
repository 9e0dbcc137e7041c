"""The gear body under one tooth and beyond its ends, in the sections of the tooth's lattice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import positive
from ...core.errors import InputError
from ..flanks.blank_section import BlankSection

Array = NDArray[Any]

COLUMN_SPREAD = 0.25  # widening of the columns under the tooth, over the depth
SPREAD_LIMIT = 0.3  # of the way from there to the side of the body
DEPTH_PER_HEIGHT = 1.2  # default depth of the body over the height of the tooth
WEB_FALL_MINIMUM = 0.5  # of the web's radius per mm: flatter cones than of 30 degrees lead to no bore
WEB_SLOPE_LENGTH = 0.25  # over which the rim passes into the web, over the overhang at the toe
WEB_BRICK_LENGTH = 0.7  # of a brick of the web, over that overhang
DEPTH_SHARE_LIMIT = 0.65  # of the way from the root to the member's axis


@dataclass(frozen=True)
class Web:
    """Web that carries the rim below the teeth, from its toe end inwards along the root cone to a bore.

    Parameters
    ----------
    bore_diameter
        Where the web ends [mm].
    thickness
        Of the web [mm], at right angles to the root cone, flush with the bottom of the rim; ``None`` for that of the
        rim.

    Examples
    --------
    >>> Web(bore_diameter=80.0).thickness is None
    True
    """

    bore_diameter: float
    thickness: float | None = None

    def __post_init__(self) -> None:
        positive("bore_diameter", self.bore_diameter, "mm")
        if self.thickness is not None:
            positive("web_thickness", self.thickness, "mm")


@dataclass(frozen=True)
class LatticeSections:
    """Plane coordinates (across, up) [mm] in the sections (nt), zero in mid tooth, negative on the loaded side."""

    blank: BlankSection
    lengthwise: Array
    turn: float
    middle: Array
    depth: Array

    def plane(self, points: Array) -> Array:
        """Coordinates (2, nt, ...) of points (3, nt, ...)."""
        radius = np.hypot(points[0], points[1])
        _, height = self.blank.fractions(points[2], radius)
        shape = (-1, *([1] * (points.ndim - 2)))
        angle = self.turn * (np.arctan2(points[1], points[0]) - self.middle.reshape(shape))
        angle = np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
        return np.stack([radius * angle, height * self.depth.reshape(shape)])

    def points(self, plane: Array) -> Array:
        """Points (3, nt, ...) of coordinates (2, nt, ...)."""
        shape = (-1, *([1] * (plane.ndim - 2)))
        axial, radius = self.radial(plane[1])
        angle = self.middle.reshape(shape) + self.turn * plane[0] / radius
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), axial])

    def radial(self, up: Array) -> Array:
        """Axial and radial coordinates (2, nt, ...) at heights (nt, ...)."""
        shape = (-1, *([1] * (up.ndim - 1)))
        return self.blank.points(self.lengthwise.reshape(shape), up / self.depth.reshape(shape))


def usual_depth(blank: BlankSection) -> float:
    """Default depth of the body [mm]: 1.2 times the tooth's height at mid face.

    That is about 2.5 normal modules, the rim of the finite elements that the root springs were compared with.
    """
    root, tip = (np.array(blank.points(np.array(0.5), np.array(h))) for h in (0.0, 1.0))
    return DEPTH_PER_HEIGHT * (float(np.linalg.norm(tip - root)) + blank.clearance)


def body_nodes(sections: LatticeSections, top: Array, corner: int, through: Array, depth: float, rise: Array) -> Array:
    """Nodes (2, nt, columns, rows) of the body, from its bottom to the root."""
    floor = top[1].min(axis=1)
    here, below = (sections.radial(up)[1] for up in (floor, floor - 1.0))
    falling = np.maximum(here - below, 1e-9)  # of the radius per mm of depth
    bottom = floor - np.minimum(depth, DEPTH_SHARE_LIMIT * here / falling)
    angle = top[0] / sections.radial(top[1])[1]
    last = top.shape[2] - 1 - corner
    room = np.minimum(angle[:, corner] - angle[:, 0], angle[:, -1] - angle[:, last])
    spread = np.minimum(COLUMN_SPREAD * (floor - bottom) / here, SPREAD_LIMIT * room)
    left, right = angle[:, corner] - spread, angle[:, last] + spread
    lower = angle.copy()
    lower[:, corner : last + 1] = left[:, None] + (right - left)[:, None] * through
    for edge, ends, new in ((0, slice(0, corner + 1), left), (-1, slice(last, None), right)):
        old = angle[:, corner if edge == 0 else last]
        share = (angle[:, ends] - angle[:, [edge]]) / (old - angle[:, edge])[:, None]
        lower[:, ends] = angle[:, [edge]] + share * (new - angle[:, edge])[:, None]
    radius = sections.radial(bottom)[1]
    base = np.stack([radius[:, None] * lower, np.broadcast_to(bottom[:, None], lower.shape)])
    return np.asarray((1.0 - rise) * top[..., None] + rise * base[..., None])


def overhang(sections: LatticeSections, body: Array, end: int, away: Array, web: Web | None = None) -> Array:
    """Nodes (n, columns rows, 3) of the body beyond one end of the tooth, at distances (n) [mm] along the root.

    With a web, more follow from there to its bore.
    """
    if away.size == 0:
        return np.empty((0, body[0, 0].size, 3))
    roots = np.asarray(sections.blank.points(np.array([0.0, 1.0]), np.zeros(2)))
    length = float(np.linalg.norm(roots[:, 1] - roots[:, 0]))
    next_to = -2 if end else 1
    step = abs(sections.lengthwise[end] - sections.lengthwise[next_to])
    slope = (sections.middle[end] - sections.middle[next_to]) / step * np.minimum(away, away[-1]) / length
    up = np.broadcast_to(body[1, end], (away.size, *body[1, end].shape))
    if web is not None:
        further = _web_distances(sections, float(body[1, end, 0, 0]), float(away[-1]), length, web)
        floor, rise = body[1, end, :, :1], body[1, end] - body[1, end, :, :1]
        slimmer = floor + rise / rise[:, -1:] * (web.thickness or float(rise[:, -1].min()))
        up = np.concatenate([up, np.broadcast_to(slimmer, (further.size, *slimmer.shape))])
        # The node in the middle of the first brick of the web, half way from the rim to the web.
        up[away.size] = 0.5 * (up[away.size - 1] + slimmer)
        away, slope = np.concatenate([away, further]), np.append(slope, np.full(further.size, slope[-1]))
    t = sections.lengthwise[end] + (away if end else -away) / length
    middle = sections.middle[end] + slope
    root, tip = (np.asarray(sections.blank.points(t, np.full_like(t, h))) for h in (0.0, 1.0))
    beyond = LatticeSections(sections.blank, t, sections.turn, middle, np.hypot(*(tip - root)))
    up = up.reshape(t.size, -1)
    angle = body[0, end] / sections.radial(body[1])[1][end]
    plane = np.stack([angle.ravel() * beyond.radial(up)[1], up])
    return np.moveaxis(beyond.points(plane), 0, -1)


def _web_distances(sections: LatticeSections, floor: float, start: float, length: float, web: Web) -> Array:
    """Distances (n) [mm] along the root of the sections of a web, from the rim to where its bottom is at its bore."""

    def radius(away: float) -> float:
        t = np.array([sections.lengthwise[0] - away / length])
        root, tip = (np.asarray(sections.blank.points(t, np.full_like(t, h))) for h in (0.0, 1.0))
        one = LatticeSections(sections.blank, t, sections.turn, np.zeros(1), np.hypot(*(tip - root)))
        return float(one.radial(np.array([floor]))[1][0])

    wanted, at_rim, falling = 0.5 * web.bore_diameter, radius(start), radius(start) - radius(start + 1.0)
    if not (wanted < at_rim and falling > WEB_FALL_MINIMUM):
        raise InputError(
            f"bore_diameter = {web.bore_diameter:g} mm: must be less than that of the rim's bottom at the toe, "
            f"{2.0 * at_rim:.4g} mm, on a member whose root cone leads there; hold its back instead"
        )
    reach = (at_rim - wanted) / falling
    first = min(WEB_SLOPE_LENGTH * start, reach / 3.0)
    count = max(round((reach - first) / (start * WEB_BRICK_LENGTH)), 2)
    rest = first + (reach - first) * np.arange(1, 2 * count + 1) / (2 * count)
    return np.asarray(start + np.concatenate([[0.5 * first, first], rest]))
