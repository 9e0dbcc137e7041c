"""Compliance of two half spaces on a regular grid of rectangular cells, as products by the fast Fourier transform.

An even pressure on one cell deflects the middle of another by Love's closed form, which depends on their distance
alone: the deflections are a convolution. On a grid padded with zeros to twice its size a product with C costs
O(n log n) and is exact up to rounding; C itself, n^2 numbers, is never formed. The surface is not periodic.

A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377-420; K. L. Johnson, Contact Mechanics (1985), Eq. 3.25; S. Liu,
Q. Wang, G. Liu, Wear 243 (2000) 101-111, doi 10.1016/S0043-1648(00)00427-0.
"""

from __future__ import annotations

import numpy as np
from scipy.fft import irfft2, next_fast_len, rfft2
from scipy.sparse.linalg import LinearOperator

from ...core.arrays import Array
from ...core.checks import array, instances, two_whole
from .material import Material


class HalfSpaceCompliance(LinearOperator):
    """Compliance of the cells of a grid on two half spaces pressed together, a `LinearOperator` for a contact problem.

    Parameters
    ----------
    shape
        Number of cells along the two sides; cell (i, j) is segment ``i * shape[1] + j``.
    sides
        Lengths of a cell along these sides [mm].
    materials
        Of the two bodies.

    Raises
    ------
    InputError
        If a number or a length is not positive.

    Examples
    --------
    >>> from easeoff.contact import STEEL, ContactProblem, HalfSpaceCompliance, solve
    >>> x, y = np.meshgrid(np.linspace(-0.5, 0.5, 21), np.linspace(-0.5, 0.5, 21), indexing="ij")
    >>> separation = ((x**2 + y**2) / (2 * 20.0)).ravel()  # a sphere of 20 mm on a plane, cells of 0.05 mm
    >>> compliance = HalfSpaceCompliance((21, 21), (0.05, 0.05), (STEEL, STEEL))
    >>> solution = solve(ContactProblem(separation, np.ones(441), 100.0, compliance))
    >>> solution.certified, round(solution.rotation * 1e3, 2)  # approach of the bodies, as by Hertz [um]
    (True, 2.8)
    """

    def __init__(
        self, shape: tuple[int, int], sides: tuple[float, float], materials: tuple[Material, Material]
    ) -> None:
        self.cells = two_whole("shape", shape, 1)
        lengths = array("sides", sides, "mm", ndim=1, size=2, above=0.0)
        first, second = (side * np.arange(count) for side, count in zip(lengths, self.cells, strict=True))
        bodies = instances("materials", materials, Material, 2)
        flexibility = sum(1.0 / material.plane_strain_modulus for material in bodies)
        area = lengths[0] * lengths[1]
        integral = even_pressure_integral(first[:, None], second[None], *np.split(0.5 * lengths, 2))
        influence = flexibility / (np.pi * area) * integral
        self._own = float(influence[0, 0])
        self._padded = tuple(next_fast_len(2 * count - 1, real=True) for count in self.cells)
        kernel = np.zeros(self._padded)
        kernel[: self.cells[0], : self.cells[1]] = influence
        # Distances to the other side stand at the end of each axis, as a cyclic convolution has them.
        kernel[self._padded[0] - self.cells[0] + 1 :] = kernel[self.cells[0] - 1 : 0 : -1]
        kernel[:, self._padded[1] - self.cells[1] + 1 :] = kernel[:, self.cells[1] - 1 : 0 : -1]
        self._transfer = rfft2(kernel).real  # the kernel is even
        size = self.cells[0] * self.cells[1]
        super().__init__(np.float64, (size, size))  # type: ignore[call-arg]  # unknown to the stubs

    def diagonal(self) -> Array:
        """Deflection of each cell under a unit force on itself (n) [mm/N]."""
        return np.full(self.shape[0], self._own)

    def _matvec(self, force: Array) -> Array:
        """Deflections (n) [mm] under forces (n) [N]."""
        turned = rfft2(np.asarray(force, dtype=np.float64).reshape(self.cells), self._padded)
        turned *= self._transfer
        deflection = irfft2(turned, self._padded, overwrite_x=True)[: self.cells[0], : self.cells[1]]
        return np.asarray(deflection).ravel()

    def _adjoint(self) -> HalfSpaceCompliance:
        return self


def even_pressure_integral(first: Array, second: Array, half_first: Array, half_second: Array) -> Array:
    """Integral of 1 / r over a rectangle [mm]: even pressure deflects the surface by (1 - nu^2) / (pi E) times this.

    ``first`` and ``second`` count from the middle of the rectangle [mm]. A. E. H. Love 1929; K. L. Johnson, Contact
    Mechanics, Eq. 3.25.
    """
    right, left = first + half_first, first - half_first
    top, bottom = second + half_second, second - half_second

    def corner(a: Array, b: Array) -> Array:
        """Half of the corner's antiderivative: a asinh(b / |a|), zero on its axis."""
        size = np.abs(a)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(size > 0.0, a * np.arcsinh(b / size), 0.0)

    return np.asarray(
        corner(right, top)
        - corner(right, bottom)
        - corner(left, top)
        + corner(left, bottom)
        + corner(top, right)
        - corner(top, left)
        - corner(bottom, right)
        + corner(bottom, left)
    )
