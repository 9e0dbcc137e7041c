"""Where toe and heel of either member lie, seen from points of contact lines: distance and obliqueness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from .flank_splines import VALUE_AND_SLOPES, FlankSplines

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class ToothEnds:
    """Toe and heel of a member seen from points (...) of its flank.

    Parameters
    ----------
    distance
        From toe and heel (2, ...), at right angles to these along the flank [mm]; zero beyond the end.
    cosine
        Of the angle (...) between the contact line and the normal of the end's edge, in the flank.
    """

    distance: Array
    cosine: Array


def tooth_ends(splines: FlankSplines, member: str, points: Array) -> ToothEnds:
    """Toe and heel: the lengthwise fraction over the length of its gradient.

    Parameters
    ----------
    splines
        Splines from ``loaded_splines``.
    member
        ``"pinion"`` or ``"gear"``.
    points
        Where the member is loaded (2, ...), as fractions on the gear.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact.loaded import loaded_splines
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    >>> tooth_ends(fields, "gear", np.full((2, 1), 0.5)).distance.round(1).T.tolist()
    [[14.9, 14.9]]
    """
    of_pinion = member == "pinion"
    names = ["position", "roll_angle", *(["pinion_lengthwise"] if of_pinion else [])]
    value, *slopes = splines.derivatives(names, points, VALUE_AND_SLOPES)
    fraction, by_fraction = points[0], [np.ones_like(points[0]), np.zeros_like(points[0])]
    if of_pinion:
        fraction, by_fraction = value["pinion_lengthwise"], [each["pinion_lengthwise"] for each in slopes]
    tangents, roll = [each["position"] for each in slopes], [each["roll_angle"] for each in slopes]
    # Gradients along the surface, with the metric of the two fractions: dots of the tangents.
    dots = [np.sum(tangents[i] * tangents[j], axis=0) for i, j in ((0, 0), (0, 1), (1, 1))]
    area = np.sqrt(dots[0] * dots[2] - dots[1] ** 2)
    steep, level = (_gradient(dots, *one) / area for one in (by_fraction, roll))
    # The roll angle is even along the line: the sine between both gradients is the cosine between line and gradient.
    turned = np.abs(by_fraction[0] * roll[1] - by_fraction[1] * roll[0]) / area
    distance = np.maximum(np.stack([fraction, 1.0 - fraction]), 0.0) / steep
    return ToothEnds(distance, turned / (steep * level))


def _gradient(dots: list[Array], first: Array, second: Array) -> Array:
    """Length of a gradient from its two derivatives, times the area of the fractions."""
    return np.asarray(np.sqrt(dots[2] * first**2 - 2.0 * dots[1] * first * second + dots[0] * second**2))
