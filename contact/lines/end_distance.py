"""Distance of points of a flank from the toe and the heel of either member, along the flank."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .flank_splines import SLOPES, VALUE_AND_SLOPES, FlankSplines

Array = NDArray[Any]


def end_distances(splines: FlankSplines, member: str, points: Array) -> Array:
    """Distances from toe and heel, at right angles to these: lengthwise fraction over the length of its gradient.

    Parameters
    ----------
    splines
        Splines from ``loaded_splines``.
    member
        ``"pinion"`` or ``"gear"``.
    points
        Where the member is loaded (2, ...), as fractions on the gear.

    Returns
    -------
    Array
        (2, ...) [mm]; zero beyond the end.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import loaded_splines
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    >>> end_distances(fields, "gear", np.full(2, 0.5)).round(1).tolist()
    [14.9, 14.9]
    """
    if member == "gear":
        fraction, by_fraction = points[0], [np.ones_like(points[0]), np.zeros_like(points[0])]
        tangents = [each["position"] for each in splines.derivatives(["position"], points, SLOPES)]
    else:
        found = splines.derivatives(["pinion_lengthwise", "position"], points, VALUE_AND_SLOPES)
        fraction, *by_fraction = (each["pinion_lengthwise"] for each in found)
        tangents = [each["position"] for each in found[1:]]
    # The gradient along the surface, with the metric of the two fractions: dots of the tangents.
    dots = [np.sum(tangents[i] * tangents[j], axis=0) for i, j in ((0, 0), (0, 1), (1, 1))]
    first, second = by_fraction
    squared = dots[2] * first**2 - 2.0 * dots[1] * first * second + dots[0] * second**2
    per_fraction = np.sqrt((dots[0] * dots[2] - dots[1] ** 2) / squared)
    return np.asarray(np.maximum(np.stack([fraction, 1.0 - fraction]), 0.0) * per_fraction)
