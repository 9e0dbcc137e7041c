"""The gear body under one tooth and beyond its ends, in the sections of the tooth's lattice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..flanks.blank_section import BlankSection

Array = NDArray[Any]

COLUMN_SPREAD = 0.25  # widening of the columns under the tooth, over the depth
SPREAD_LIMIT = 0.3  # of the way from there to the side of the body
DEPTH_PER_HEIGHT = 1.2  # default depth of the body over the height of the tooth
DEPTH_SHARE_LIMIT = 0.65  # of the way from the root to the member's axis


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


def overhang(sections: LatticeSections, body: Array, end: int, away: Array) -> Array:
    """Nodes (n, columns rows, 3) of the body beyond one end of the tooth, at distances (n) [mm] along the root."""
    if away.size == 0:
        return np.empty((0, body[0, 0].size, 3))
    roots = np.asarray(sections.blank.points(np.array([0.0, 1.0]), np.zeros(2)))
    away = away / np.linalg.norm(roots[:, 1] - roots[:, 0])
    t = sections.lengthwise[end] + (away if end else -away)
    next_to = -2 if end else 1
    step = abs(sections.lengthwise[end] - sections.lengthwise[next_to])
    middle = sections.middle[end] + (sections.middle[end] - sections.middle[next_to]) * away / step
    root, tip = (np.asarray(sections.blank.points(t, np.full_like(t, h))) for h in (0.0, 1.0))
    beyond = LatticeSections(sections.blank, t, sections.turn, middle, np.hypot(*(tip - root)))
    up = np.broadcast_to(body[1, end].ravel(), (t.size, body[1, end].size))
    angle = body[0, end] / sections.radial(body[1])[1][end]
    plane = np.stack([angle.ravel() * beyond.radial(up)[1], up])
    return np.moveaxis(beyond.points(plane), 0, -1)
