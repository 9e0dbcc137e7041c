"""How deep the mate's tip reaches: the least height above the root at which the flanks of a pair touch."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..pair.ease_off import exact_ease_off
from ..pair.gear_pair import GearPair

Array = NDArray[Any]

PROFILE_NODES = 21


def contact_heights(pair: GearPair, lengthwise: Array) -> tuple[Array, Array]:
    """Least heights of contact above the root cones of pinion and gear, and where along the face.

    Parameters
    ----------
    pair
        The gear pair, seen from the side in contact.
    lengthwise
        Fractions of the gear from toe to heel (n).

    Returns
    -------
    tuple
        Heights (2, n) [mm], on the pinion where the gear's tip touches, on the gear where the pinion's does; NaN where
        the tip finds no flank of its mate, or the pinion's tip none within that of the gear. Lengthwise fractions of
        these places on pinion and gear (2, n).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> heights, _ = contact_heights(gear_pair(read_case("nasa-12x36")), np.array([0.5]))
    >>> bool(np.all(heights > 0.0))
    True
    """
    profile = np.linspace(0.0, 1.0, PROFILE_NODES)
    gear, section = pair.gear.flank(lengthwise, profile), pair.pinion.section
    found = exact_ease_off(gear, pair.pinion.loaded, section, pair.assembly)
    shape = (lengthwise.size, PROFILE_NODES)
    position = found.pinion_position.reshape(3, *shape)
    radius = np.hypot(position[0], position[1])
    on_pinion = section.height_above_root(position[2], radius)[:, -1]
    along, above = section.fractions(position[2].ravel(), radius.ravel())
    height = pair.gear.section.height_above_root(gear.position[2], np.hypot(gear.position[0], gear.position[1]))
    on_gear = [_at_tip(*each) for each in zip(above.reshape(shape), height.reshape(shape), strict=True)]
    return np.stack([on_pinion, np.array(on_gear)]), np.stack([along.reshape(shape)[:, -1], lengthwise])


def _at_tip(fraction: Array, height: Array) -> float:
    """Height on the gear at which the conjugate point is the tip of the pinion, whose fraction falls towards it."""
    known = np.isfinite(fraction) & np.isfinite(height)
    fraction, height = fraction[known], height[known]
    if fraction.size < 2 or not fraction.min() < 1.0 < fraction.max():
        return float("nan")
    order = np.argsort(fraction)
    return float(np.interp(1.0, fraction[order], height[order]))
