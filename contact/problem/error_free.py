"""Error-free sums and products: the rounding error of a double-precision operation, itself a double.

Knuth's sum and Veltkamp's and Dekker's product (Dekker 1971, doi:10.1007/BF01397083). They hold for round to nearest
where nothing overflows and no product is below 10^-290.
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from ...core.arrays import RealArray as Array

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
