"""Closed surfaces: a segment of a ring, and a tooth between its flanks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from easeoff.geometry import GearPair, tooth_angle
from easeoff.geometry.tooth.tooth_flanks import placed_flanks

Array = NDArray[Any]


def ring_segment(nodes: int = 9, turn: float = math.pi / 6) -> dict[str, Array]:
    """All six sides of a piece of a square ring about the z axis, radius 10 to 12, height 3, looking outwards."""
    u, angle = np.linspace(0.0, 1.0, nodes), np.linspace(0.0, turn, nodes + 2)

    def points(radius: Array | float, about: Array | float, height: Array | float) -> Array:
        return np.stack(
            np.broadcast_arrays(radius * np.cos(about), radius * np.sin(about), height + 0.0 * np.asarray(about)), -1
        )

    rise, spread = 3.0 * u, 10.0 + 2.0 * u
    return {
        "outer": points(12.0, angle[:, None], rise[None]),
        "inner": points(10.0, angle[None], rise[:, None]),
        "top": points(spread[:, None], angle[None], 3.0),
        "bottom": points(spread[None], angle[:, None], 0.0),
        "start": points(spread[:, None], 0.0 * u, rise[None]),
        "end": points(spread[None], turn, rise[:, None]),
    }


def flank_patches(pair: GearPair, name: str, nodes: tuple[int, int]) -> dict[str, Array]:
    """Both flanks over the whole height of the blank, each from toe to heel, looking out of the tooth."""
    t, h = np.meshgrid(np.linspace(0.0, 1.0, nodes[0]), np.linspace(0.0, 1.0, nodes[1]), indexing="ij")
    patches: dict[str, Array] = {}
    for side, flank in placed_flanks(getattr(pair, name), tooth_angle(pair, name)).items():
        found = flank.at(*flank.section.points(t.ravel(), h.ravel()))
        points, normals = (np.moveaxis(one.reshape(3, *nodes), 0, -1) for one in (found.position, found.normal))
        along, up = points[1:, :-1] - points[:-1, :-1], points[:-1, 1:] - points[:-1, :-1]
        outward = np.sum(np.cross(along, up) * normals[:-1, :-1]) > 0.0
        patches[side] = points if outward else points[::-1]
    return patches


def closed_tooth(pair: GearPair, name: str, nodes: tuple[int, int]) -> tuple[dict[str, Array], float]:
    """Both flanks of a tooth, closed by surfaces of circular arcs about the axis, and the volume between them.

    The volume is the integral of arc length over the axial section, by Gauss quadrature on the exact flanks.
    """
    patches = {key: p if p[0, 0, 2] < p[-1, 0, 2] else p[::-1] for key, p in flank_patches(pair, name, nodes).items()}
    first, second = patches.values()
    radius = np.hypot(first[..., 0], first[..., 1])
    start, stop = (np.arctan2(p[..., 1], p[..., 0]) for p in (first, second))
    across = np.linspace(0.0, 1.0, 11)

    def arcs(*edge: Any) -> Array:
        about = start[edge][:, None] + np.multiply.outer(stop[edge] - start[edge], across)
        arm, height = radius[edge][:, None], np.broadcast_to(first[edge][:, None, 2], about.shape)
        return np.stack([arm * np.cos(about), arm * np.sin(about), height], axis=-1)

    whole = slice(None)
    ends = {"tip": (whole, -1), "root": (whole, 0), "toe": (0, whole), "heel": (-1, whole)}
    closed = {**flank_patches(pair, name, nodes), **{key: arcs(*edge) for key, edge in ends.items()}}

    section = getattr(pair, name).section
    points, weights = np.polynomial.legendre.leggauss(20)
    t, h = np.meshgrid(0.5 + 0.5 * points, 0.5 + 0.5 * points, indexing="ij")
    axial, radial = (values.ravel() for values in section.points(t, h))
    one, other = (
        np.arctan2(*flank.at(axial, radial).position[1::-1])
        for flank in placed_flanks(getattr(pair, name), tooth_angle(pair, name)).values()
    )
    (a, b), (c, d) = section.corners
    along = np.multiply.outer(c - a, 1 - h) + np.multiply.outer(d - b, h)
    up = np.multiply.outer(b - a, 1 - t) + np.multiply.outer(d - c, t)
    area = np.abs(along[0] * up[1] - along[1] * up[0]).ravel() * 0.25 * np.outer(weights, weights).ravel()
    return closed, float(np.sum(np.abs(other - one) * radial * area))
