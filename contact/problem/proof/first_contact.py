"""First contact of the rigid bodies, and the separations from there, free of the rounding of large rotations.

A segment f touches first, at the rotation S_f / r_f. The separations from there,

    S_i - r_i S_f / r_f  =  (S_i r_f - r_i S_f) / r_f ,

are differences of large numbers where the rotation is counted from far away. Both products are taken without error,
so that each separation is rounded once, and lacks at most 10^-32 of the products. The rotation S_f / r_f stands for
itself: what one double cannot hold of it is a second one, the remainder.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....core.checks import read_only
from .error_free import SPLITTER, two_product

Array = NDArray[np.float64]

#: Changes of the segment that touches first: the rounded ratios S/r mistake it where rotations are large.
MAX_CHANGES = 4
#: Greatest error of a separation from first contact besides its own rounding, relative to r S_f / r_f: of the products
#: without error, and of plain ones, which are left where numbers near 10^300 overflow.
ERROR_FREE, PLAIN = 2.0**-103, 2.0**-51


@dataclass(frozen=True, eq=False, slots=True)
class FirstContact:
    """Where the rigid bodies touch first.

    Attributes
    ----------
    rotation
        S_f / r_f of the segment that touches first, rounded [rad].
    remainder
        What the rounded rotation lacks [rad].
    separation
        S - r S_f / r_f (n) [mm], rounded once. Not negative where r > 0, zero at the segment f.
    error
        Greatest error of these besides their rounding, relative to r S_f / r_f.
    """

    rotation: float
    remainder: float
    separation: Array
    error: float


def first_contact(separation: Array, lever_arm: Array) -> FirstContact:
    """Find the first contact.

    Parameters
    ----------
    separation, lever_arm
        S and r of the segments (n) [mm]; some r is positive.

    Examples
    --------
    At 10^7 rad the plain difference would leave a separation of 0.01300 mm in steps of 6e-8 mm:

    >>> arm = np.array([40.0, 41.7])
    >>> first_contact(np.array([0.0, 0.013]) + 1e7 * arm, arm).separation
    array([0.        , 0.01300001])
    """
    positive = (lever_arm > 0.0).nonzero()[0]
    first = int(positive[(separation[positive] / lever_arm[positive]).argmin()])
    shifted, error = _shifted(separation, lever_arm, first)
    for _ in range(MAX_CHANGES):
        if not shifted[positive].min() < 0.0:
            break
        first = int(positive[(shifted[positive] / lever_arm[positive]).argmin()])
        shifted, error = _shifted(separation, lever_arm, first)
    shifted[positive] = np.maximum(shifted[positive], 0.0)
    own, arm = float(separation[first]), float(lever_arm[first])
    rotation = own / arm
    product, low = two_product(rotation, arm)
    remainder = ((own - product) - low) / arm
    return FirstContact(rotation, remainder if math.isfinite(remainder) else 0.0, read_only(shifted), error)


def _shifted(separation: Array, lever_arm: Array, first: int) -> tuple[Array, float]:
    """The separations at the contact of one segment (n), of any sign, its own being zero; and their `error`."""
    own = float(separation[first])
    if own == 0.0:
        return separation.copy(), ERROR_FREE
    # A power of two near its lever arm is taken out, so that no product overflows but where a number is near that.
    scale = math.ldexp(1.0, -math.frexp(float(lever_arm[first]))[1])
    arm = float(lever_arm[first]) * scale
    with np.errstate(over="ignore", invalid="ignore"):
        factors = np.array([separation, lever_arm * scale])
        others = np.array([[arm], [-own]])
        # The products S_i r_f and -r_i S_f with their errors, see ``two_product``, both in one go.
        product = factors * others
        big, other = SPLITTER * factors, SPLITTER * others
        high, high_other = big - (big - factors), other - (other - others)
        low, low_other = factors - high, others - high_other
        error = low * low_other - (((product - high * high_other) - low * high_other) - high * low_other)
        a, b = product
        total = a + b
        second = total - a
        rest = (a - (total - second)) + (b - second)
        rest += error[0] + error[1]
        shifted: Array = (total + rest) / arm
        if np.isfinite(shifted).all():
            return shifted, ERROR_FREE
        shifted = separation - own / float(lever_arm[first]) * lever_arm
        shifted[first] = 0.0
    return shifted, PLAIN
