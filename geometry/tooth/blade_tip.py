"""The path of a blade's tip at the bottom of the slot that it cuts, and its height above the root cone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from .tooth_surface import FILLET_NODES, tooth_side

Array = NDArray[Any]

SIDE_NODES = 5  # up the flank, of which the lower end is used
TOE_MIDDLE_HEEL = np.array([0.0, 0.5, 1.0])


def tip_path(surface: GeneratingSurface, section: BlankSection, lengthwise: Array) -> tuple[Array, float]:
    """Points that the tip of a blade cuts, and how far along the tip they are from its corner.

    The tip is that of a blade without edge radius. Where this one, longer along the flank, cuts no whole flank, it is
    the deepest point of the edge radius, beside the corner, which gives the slot to a tenth of that radius.

    Parameters
    ----------
    surface
        Generating surface of the flank.
    section
        The blank.
    lengthwise
        Fractions from toe to heel (n), three at least.

    Returns
    -------
    tuple
        The points (3, n), NaN where neither cuts a whole flank, and the distance [mm].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> gear = gear_pair(read_case("nasa-12x36")).gear
    >>> points, beside = tip_path(gear.loaded, gear.section, TOE_MIDDLE_HEEL)
    >>> points.shape, beside
    ((3, 3), 0.0)
    """
    blade = surface.blade
    for radius, nodes in ((0.0, 2), (blade.edge_radius, FILLET_NODES)):
        try:
            edged = replace(surface, blade=replace(blade, edge_radius=radius))
            fillet = tooth_side(edged, section, lengthwise, SIDE_NODES, nodes).fillet
        except GeometryError:
            continue
        return fillet[:, :, 0], float(radius * (1.0 - np.sin(blade.pressure_angle)) / np.cos(blade.pressure_angle))
    return np.full((3, lengthwise.size), np.nan), 0.0


def tip_gap(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Height of a blade's tip above the root cone at toe, middle and heel (3) [mm].

    Negative where it cuts deeper, NaN where the flank is undercut or missing.

    Parameters
    ----------
    surface
        Generating surface of the flank.
    section
        The blank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> gear = gear_pair(read_case("nasa-12x36")).gear
    >>> bool(np.all(np.abs(tip_gap(gear.loaded, gear.section)) < 1e-3))
    True
    """
    points, _ = tip_path(surface.designed, section, TOE_MIDDLE_HEEL)
    return section.height_above_root(points[2], np.hypot(points[0], points[1]))
