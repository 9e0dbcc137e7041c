"""First contact of the rigid bodies, and the separations from there, free of the rounding of large rotations.

A segment f touches first, at the rotation S_f / r_f. The separations from there,

    S_i - r_i S_f / r_f  =  (S_i r_f - r_i S_f) / r_f ,

are differences of large numbers where the rotation is counted from far away. Both products are taken without error,
so that each separation is rounded once, and lacks at most 10^-32 of the products. The rotation S_f / r_f stands for
itself: what one double cannot hold of it is a second one, the remainder.

Without error means with the rounding error of each sum or product as a second double: Knuth's sum and Veltkamp's and
Dekker's product (Dekker 1971, doi:10.1007/BF01397083). They hold for round to nearest where nothing overflows and no
product is below 10^-290.
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from ...core.arrays import RealArray as Array, record
from ...core.checks import read_only

Number = TypeVar("Number", float, Array)

#: Half of the distance from 1 to the next double: greatest relative error of one operation.
UNIT_ROUNDOFF = 2.0**-53
#: 2^27 + 1, which splits a double into two of 26 bits.
SPLITTER = 134217729.0


def two_sum(a: Number, b: Number) -> tuple[Number, Number]:
    """Rounded sum and its rounding error."""
    total = a + b
    second = total - a
    return total, (a - (total - second)) + (b - second)


def split(a: Number) -> tuple[Number, Number]:
    """Return two numbers of at most 26 bits with the given sum."""
    big = SPLITTER * a
    high = big - (big - a)
    return high, a - high


def two_product(a: Number, b: Number) -> tuple[Number, Number]:
    """Rounded product and its rounding error."""
    product = a * b
    (high, low), (high_other, low_other) = split(a), split(b)
    return product, low * low_other - (((product - high * high_other) - low * high_other) - high * low_other)


def dot_terms(a: Array, b: Array) -> Array:
    """Return numbers (2 n) whose exact sum is the dot product of two vectors (n); for `math.fsum`."""
    return np.concatenate(two_product(a, b))


def double_double(terms: Array) -> tuple[float, float]:
    """Rounded sum of numbers and its rounded remainder: together twice the digits of a double."""
    high = math.fsum(terms)
    return high, math.fsum([*terms, -high])


#: Changes of the segment that touches first: the rounded ratios S/r mistake it where rotations are large.
MAX_CHANGES = 4
#: Greatest error of a separation from first contact besides its own rounding, relative to r S_f / r_f: of the products
#: without error, and of plain ones, which are left where numbers near 10^300 overflow.
ERROR_FREE, PLAIN = 2.0**-103, 2.0**-51


@record(frozen=True, eq=False, slots=True)
class FirstContact:
    """First contact of the rigid bodies, at the segment f and the rounded rotation S_f / r_f [rad]."""

    segment: int
    rotation: float
    remainder: float  # what the rounded rotation lacks [rad]
    separation: Array  # S - r S_f / r_f (n) [mm], rounded once; zero at f, not negative where r > 0
    error: float  # greatest besides rounding, relative to r S_f / r_f
    signs: bool  # some lever arm is not positive; else no separation is negative

    def whole_rotation(self, elastic_rotation: float) -> float:
        """Rotation from zero [rad] of a rotation beyond this contact [rad], rounded."""
        return self.rotation + (self.remainder + elastic_rotation)


def first_contact(separation: Array, lever_arm: Array) -> FirstContact:
    """First contact for separations S and lever arms r (n) [mm], some r positive."""
    signs = not lever_arm.min() > 0.0
    if not signs:
        first = int((separation / lever_arm).argmin())
        shifted, error = _shifted(separation, lever_arm, first)
        if shifted.min() < 0.0:
            first, shifted, error = _corrected(separation, lever_arm, shifted)
    else:
        positive = (lever_arm > 0.0).nonzero()[0]
        first = int(positive[(separation[positive] / lever_arm[positive]).argmin()])
        first, shifted, error = _corrected(separation, lever_arm, _shifted(separation, lever_arm, first)[0])
    distance, arm = float(separation[first]), float(lever_arm[first])
    rotation = distance / arm
    product, low = two_product(rotation, arm)
    remainder = ((distance - product) - low) / arm
    remainder = remainder if math.isfinite(remainder) else 0.0
    return FirstContact(first, rotation, remainder, read_only(shifted), error, signs)


def _corrected(separation: Array, lever_arm: Array, shifted: Array) -> tuple[int, Array, float]:
    """Return the segment that touches first, the separations there and their `error`, from those at a near contact."""
    positive = (lever_arm > 0.0).nonzero()[0]
    for _ in range(MAX_CHANGES):
        first = int(positive[(shifted[positive] / lever_arm[positive]).argmin()])
        shifted, error = _shifted(separation, lever_arm, first)
        if not shifted[positive].min() < 0.0:
            break
    shifted[positive] = np.maximum(shifted[positive], 0.0)
    return first, shifted, error


def _shifted(separation: Array, lever_arm: Array, first: int) -> tuple[Array, float]:
    """The separations at the contact of one segment (n), of any sign, its own being zero; and their `error`."""
    size, distance = separation.size, float(separation[first])
    if distance == 0.0:
        return separation.copy(), ERROR_FREE
    # A power of two near its lever arm is taken out, so that no product overflows but where a number is near that.
    scale = math.ldexp(1.0, -math.frexp(float(lever_arm[first]))[1])
    arm = float(lever_arm[first]) * scale
    (high_arm, low_arm), (high_own, low_own) = split(arm), split(-distance)
    with np.errstate(over="ignore", invalid="ignore"):
        # Both products S_i r_f and -r_i S_f in one go, and their errors: see ``two_product``.
        factors = np.concatenate([separation, lever_arm * scale])
        others, high_others, low_others = np.empty((3, 2 * size))
        others[:size], high_others[:size], low_others[:size] = arm, high_arm, low_arm
        others[size:], high_others[size:], low_others[size:] = -distance, high_own, low_own
        product = factors * others
        high, low = split(factors)
        error = low * low_others - (((product - high * high_others) - low * high_others) - high * low_others)
        total, rest = two_sum(product[:size], product[size:])
        rest += error[:size] + error[size:]
        shifted: Array = (total + rest) / arm
        if math.isfinite(float(shifted.sum())) or np.isfinite(shifted).all():
            return shifted, ERROR_FREE
        shifted = separation - distance / float(lever_arm[first]) * lever_arm
        shifted[first] = 0.0
    return shifted, PLAIN
