"""Elastic deflection of two half planes in line contact: a convolution with the logarithm, exact for hat functions.

In units of the Hertz contact the deflection under the pressure P is

    D(X) = -1/pi  integral P(X') ln|X - X'| dX'.

P is piecewise linear between the nodes of a uniform grid. The integral of a hat function against the logarithm is known
in closed form, so that the only error is that of the linear interpolation: second order in the spacing. The sum over
all nodes is a product with a Toeplitz matrix, taken by fast Fourier transforms of twice the length, padded with zeros:
n log n work and no wrap-around.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from ....core.checks import frozen_arrays

#: From this distance on, in grid spacings, a series replaces the closed form, whose digits cancel there.
SERIES_DISTANCE = 40


def logarithm_of_hats(distance: NDArray[np.int_]) -> NDArray[np.float64]:
    """Integral of a hat function of unit spacing against ln|k - x|, for whole distances k.

    Parameters
    ----------
    distance
        Distance k between node and centre of the hat, in spacings (n); its sign does not matter.

    Returns
    -------
    (n) array
        The closed form [G(k + 1) - 2 G(k) + G(k - 1)] with G(x) = x^2 ln|x| / 2 - 3 x^2 / 4 for small k; for large k
        its expansion ln k - 1/(12 k^2) - 1/(60 k^4) - 1/(168 k^6), to rounding.
    """
    k = np.abs(np.asarray(distance, dtype=np.float64))
    near = k < SERIES_DISTANCE

    def antiderivative(x: NDArray[np.float64]) -> NDArray[np.float64]:
        size = np.abs(x)
        return 0.5 * x**2 * np.log(np.where(size > 0.0, size, 1.0)) - 0.75 * x**2

    small, large = np.where(near, k, 0.0), np.where(near, SERIES_DISTANCE, k)
    closed = antiderivative(small + 1.0) - 2.0 * antiderivative(small) + antiderivative(small - 1.0)
    inverse = large**-2
    series = np.log(large) - inverse * (1.0 / 12.0 + inverse * (1.0 / 60.0 + inverse / 168.0))
    return np.where(near, closed, series)


@frozen_arrays
@dataclass(frozen=True)
class Deflection:
    """Deflection of the surfaces on a uniform grid.

    Parameters
    ----------
    nodes
        Number of nodes n.
    spacing
        Distance of neighbouring nodes, in half widths of the Hertz contact.
    """

    nodes: int
    spacing: float

    @cached_property
    def influence(self) -> NDArray[np.float64]:
        """Deflection at distances 0 ... n - 1 spacings from a node of unit pressure, (n)."""
        hats = logarithm_of_hats(np.arange(self.nodes))
        return np.asarray(-self.spacing / np.pi * (hats + np.log(self.spacing)))

    @cached_property
    def _length(self) -> int:
        return int(next_fast_len(2 * self.nodes - 1, real=True))

    @cached_property
    def _transform(self) -> NDArray[np.complex128]:
        ring = np.zeros(self._length)
        ring[: self.nodes] = self.influence
        ring[self._length - self.nodes + 1 :] = self.influence[:0:-1]
        return np.asarray(rfft(ring))

    def __call__(self, pressure: NDArray[np.float64]) -> NDArray[np.float64]:
        """Deflection under nodal pressures; both (..., n), dimensionless."""
        spectrum = rfft(pressure, self._length, axis=-1)
        spectrum *= self._transform
        return np.asarray(irfft(spectrum, self._length, axis=-1)[..., : self.nodes])
