"""Widths of the lands between generated flanks: at the tip of a tooth, and at the bottom of its slot."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...core.errors import GeometryError
from ..flanks.flank import into_tooth
from ..pair.gear_pair import GearPair
from .tooth_flanks import PlacedFlank, named_member, placed_flanks, tooth_angle
from .tooth_surface import FILLET_NODES, tooth_side

Array = NDArray[Any]

LENGTHWISE_STEP = 1e-3  # of the face, over which the slope of the tooth line is taken
SIDE_NODES = 5  # up the flank, of which the ends are used


@frozen_arrays
@dataclass(frozen=True)
class LandWidths:
    """Lands of one member (n) [mm]; NaN where a flank is undercut or missing.

    Parameters
    ----------
    top_land
        Width on the face cone at right angles to the tooth line; negative if the tooth ends in an edge below it.
    slot
        Width at the bottom of the slot, between the tips of the blades as if they had no edge radius.
    root_line
        Height of the tips' paths above the root cone on the loaded and on the other side (2, n); negative where they
        cut deeper.
    """

    top_land: Array
    slot: Array
    root_line: Array


def land_widths(pair: GearPair, member: str, lengthwise: Array) -> LandWidths:
    """Top land and slot of one member, with the thickness of its teeth as in ``gear_pair.bodies``.

    Parameters
    ----------
    pair
        The gear pair.
    member
        ``"pinion"`` or ``"gear"``.
    lengthwise
        Fractions from toe to heel (n).

    Raises
    ------
    InputError
        If the member has another name.
    GeometryError
        If a cutter meets no tooth of the blank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> widths = land_widths(gear_pair(read_case("nasa-12x36")), "gear", np.array([0.0, 0.5, 1.0]))
    >>> widths.top_land.shape, widths.root_line.shape
    ((3,), (2, 3))
    """
    which = named_member(pair, member)
    front, back = placed_flanks(which, tooth_angle(pair, member)).values()
    section = which.section
    fractions = (lengthwise + LENGTHWISE_STEP * np.array([[-1.0], [0.0], [1.0]])).ravel()
    axial, radial = section.points(fractions, np.ones_like(fractions))
    tips = [side.at(axial, radial) for side in (front, back)]
    turn = into_tooth(tips[0].position, tips[0].normal)
    tooth, around = _width(tips[0].position, tips[1].position, turn)
    feet, beside = zip(*(_tip_path(side, fractions) for side in (front, back)), strict=True)
    bottom, whole = _width(feet[0], feet[1], turn)
    pitch = 2.0 * np.pi / which.teeth
    middle = slice(lengthwise.size, 2 * lengthwise.size)
    heights = [section.height_above_root(foot[2], np.hypot(foot[0], foot[1]))[middle] for foot in feet]
    return LandWidths(tooth * around, (pitch - bottom) * whole + beside[0] + beside[1], np.stack(heights))


def _tip_path(side: PlacedFlank, fractions: Array) -> tuple[Array, Array]:
    """Points (3, 3 n) [mm] that the tip of a blade cuts, and how far from its corner along the tip (n) [mm].

    The tip is that of a blade without edge radius. Where this one, longer along the flank, cuts no whole flank, it is
    the deepest point of the edge radius, beside the corner, which gives the slot to a tenth of that radius; NaN where
    that cuts none either.
    """
    blade, places = side.surface.blade, fractions.reshape(3, -1)
    points, beside = np.full((3, *places.shape), np.nan), np.zeros(places.shape[1])
    for number in range(places.shape[1]):
        for radius, nodes in ((0.0, 2), (blade.edge_radius, FILLET_NODES)):
            surface = replace(side.surface, blade=replace(blade, edge_radius=radius))
            try:
                found = tooth_side(surface, side.section, tuple(places[:, number].tolist()), SIDE_NODES, nodes)
            except GeometryError:
                continue
            points[:, :, number] = found.turned(side.rotation).fillet[:, :, 0]
            beside[number] = radius * (1.0 - np.sin(blade.pressure_angle)) / np.cos(blade.pressure_angle)
            break
    return points.reshape(3, -1), beside


def _width(front: Array, back: Array, turn: float) -> tuple[Array, Array]:
    """Angle from one edge to the other into the tooth (n) [rad], and normal width per angle (n) [mm/rad].

    The edges (3, 3 n) [mm] are given a little before, at and a little behind each place.
    """
    azimuth = [np.arctan2(each[1], each[0]) for each in (front, back)]
    angle = np.mod(turn * (azimuth[1] - azimuth[0]) + np.pi, 2.0 * np.pi) - np.pi
    middle = (azimuth[0] + 0.5 * turn * angle).reshape(3, -1)
    radius = 0.5 * (np.hypot(front[0], front[1]) + np.hypot(back[0], back[1])).reshape(3, -1)
    axial = 0.5 * (front[2] + back[2]).reshape(3, -1)
    around = 2.0 * radius[1] * np.sin(0.5 * (middle[2] - middle[0]))
    along = np.hypot(axial[2] - axial[0], radius[2] - radius[0])
    return np.asarray(angle.reshape(3, -1)[1]), np.asarray(radius[1] * along / np.hypot(along, around))
