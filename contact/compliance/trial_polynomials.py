"""The one-dimensional trial functions of the Rayleigh-Ritz shell, with their derivatives.

Along the trace the functions are free at both ends; over the height a power of the relative height in front pins or
clamps the root. Legendre polynomials span the same space as the monomials of the dissertation, so the exact answer is
the same, while the condition number stays below 1e7 where that of the monomials passes 1e18 and Cholesky breaks down.
"""

from __future__ import annotations

from math import comb, perm
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class PolynomialFamily(Protocol):
    """Function that evaluates a family of polynomials, as ``legendre`` does."""

    def __call__(self, relative: FloatArray, count: int, *, order: int = 0) -> FloatArray:
        """Values and derivatives of the first ``count`` polynomials."""


def legendre(relative: FloatArray, count: int, *, order: int = 0) -> FloatArray:
    """Values and derivatives of the first ``count`` shifted Legendre polynomials on the unit interval.

    Parameters
    ----------
    relative
        Position relative to the interval [-], any shape; 0 and 1 are its ends. Outside, the polynomials continue.
    count
        Number of polynomials, of degree 0 to ``count`` - 1.
    order
        Highest derivative with respect to ``relative``.

    Returns
    -------
    Array
        Shape (order + 1, shape of relative, count).
    """
    values = np.zeros((order + 1, *relative.shape, count))
    t = 2.0 * relative - 1.0
    values[0, ..., 0] = 1.0
    if count > 1:
        values[0, ..., 1] = t
    for degree in range(1, count - 1):
        two_step = (2 * degree + 1) * t * values[0, ..., degree] - degree * values[0, ..., degree - 1]
        values[0, ..., degree + 1] = two_step / (degree + 1)
    for derivative in range(1, order + 1):
        # P'_{n+1} = P'_{n-1} + (2n + 1) P_n, and the factor 2 of the shift to the unit interval.
        lower, current = values[derivative - 1], values[derivative]
        for degree in range(count - 1):
            before = current[..., degree - 1] if degree > 0 else 0.0
            current[..., degree + 1] = before + 2.0 * (2 * degree + 1) * lower[..., degree]
    return values


def rooted_polynomials(
    relative: FloatArray,
    count: int,
    root_power: int,
    *,
    order: int = 0,
    family: PolynomialFamily = legendre,
) -> FloatArray:
    """Polynomials times a power of the relative height, which vanishes at the root as the support demands.

    Parameters
    ----------
    relative
        Height above the root divided by a reference height [-], any shape.
    count
        Number of functions.
    root_power
        0 leaves the root free, 1 pins the function there, 2 clamps it (value and slope vanish).
    order
        Highest derivative with respect to ``relative``.
    family
        Polynomials behind the power.

    Returns
    -------
    Array
        Shape (order + 1, shape of relative, count).
    """
    plain = family(relative, count, order=order)
    if root_power == 0:
        return plain
    rooted = np.zeros_like(plain)
    for derivative in range(order + 1):
        for inner in range(min(derivative, root_power) + 1):  # Leibniz: derivatives taken of the power in front
            factor = comb(derivative, inner) * perm(root_power, inner) * relative ** (root_power - inner)
            rooted[derivative] += factor[..., None] * plain[derivative - inner]
    return rooted
