"""Rayleigh-Ritz model of the solid tooth on its body of bricks.

As in the shell, Legendre polynomials along the face and up the tooth are the trial functions of a Rayleigh-Ritz system;
but they stand for all three displacements, there are more of them through the thickness, and the strain energy is that
of the solid tooth on its generated surfaces, fillets and slanted ends included. The sections slant against the tooth:
a wave along it takes more functions through it than the parabola of a straight one.

The body below is quadratic bricks, whose nodes on the joint follow the polynomials: no springs stand between. It is a
Ritz system of both, too stiff by what its functions cannot follow; each function more makes it softer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....core.errors import GeometryError
from ....geometry.tooth.tooth_lattice import ToothLattice
from ..material import Material
from ..trial_polynomials import legendre
from .bricks import brick_stiffness
from .substructures import substructures

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = NDArray[Any]
Counts = tuple[int, int, int]

EXTRA_GAUSS_POINTS = (6, 2, 4)  # Gauss points beyond the number of functions, along, through and up
SHAPE_POLYNOMIAL_LIMITS = (9, 3, 7)  # polynomials of the tooth's own shape
SMOOTH_SHAPE_LIMITS = (
    9,
    3,
    5,
)  # where those overshoot so far, beside a kink of the flank, that the tooth is inside out


@dataclass(frozen=True)
class SolidShell:
    """Factored Rayleigh-Ritz model of a solid tooth on its body.

    Degrees of freedom are ordered (along, through, up, xyz), the last fastest.

    Parameters
    ----------
    tooth
        Nodes (l, t, u) of the lattice's tooth.
    functions
        Values (l t u, m) of the trial functions there.
    factor, scale
        L and d such that the stiffness is d^-1 L L^T d^-1, a diagonal d.
    """

    tooth: NDArray[np.int64]
    functions: Array
    factor: Array
    scale: Array

    def whiten(self, functionals: csc_array) -> Array:
        """Whitened functionals (3 m, k) of displacements (3 n, k) of the tooth: inner products are compliances."""
        from scipy.linalg import solve_triangular

        rows = functionals.tocsr()
        nodes = self.tooth.ravel()
        parts = np.stack([rows[3 * nodes + axis].T @ self.functions for axis in range(3)], axis=-1)
        vectors = parts.reshape(functionals.shape[1], -1).T
        return np.asarray(solve_triangular(self.factor, vectors * self.scale[:, None], lower=True))

    def response(self, loads: csc_array, wanted: csc_array) -> Array:
        """Values (m, k) of the wanted functionals (3 n, m) of the displacements under loads (3 n, k) on the tooth."""
        return np.asarray(self.whiten(wanted).T @ self.whiten(loads))


def solid_shell(lattice: ToothLattice, material: Material, counts: Counts) -> SolidShell:
    """Assemble and factor.

    Parameters
    ----------
    lattice
        The tooth on its body; of its bricks only the body's are used.
    material
        Its material.
    counts
        Number of trial functions along, through and up the tooth.

    Raises
    ------
    GeometryError
        If a brick of the body is turned inside out, or the tooth is.
    """
    tooth = lattice.column[:, :, lattice.root_row :]
    fractions = (lattice.lengthwise, lattice.through, lattice.upward)
    along, through, up = (legendre(p, c)[0] for p, c in zip(fractions, counts, strict=True))
    whole = _stiffness(lattice.nodes[tooth], fractions, counts, material)
    joint = np.einsum("ia,jb->ijab", along, through).reshape(tooth[:, :, 0].size, -1)
    body = body_stiffness(lattice, tooth[:, :, 0].ravel(), joint, material)
    at_joint = legendre(np.zeros(1), counts[2])[0, 0]
    sizes = (counts[0] * counts[1], counts[2], 3)
    split = whole.reshape(*sizes, *sizes)
    split += np.einsum("axby,c,d->acxbdy", body.reshape(sizes[0], 3, sizes[0], 3), at_joint, at_joint)
    scale = 1.0 / np.sqrt(np.diagonal(whole))
    factor = np.linalg.cholesky(whole * scale[:, None] * scale)
    functions = np.einsum("ia,jb,kc->ijkabc", along, through, up).reshape(tooth.size, -1)
    return SolidShell(tooth, functions, factor, scale)


def _stiffness(nodes: Array, fractions: tuple[Array, Array, Array], counts: Counts, material: Material) -> Array:
    """Stiffness of a tooth from its nodes (l, t, u, 3); a whole tooth is not refused for overshooting polynomials."""
    try:
        return tooth_stiffness(tooth_shape(nodes, fractions), counts, material)
    except GeometryError:
        return tooth_stiffness(tooth_shape(nodes, fractions, SMOOTH_SHAPE_LIMITS), counts, material)


def tooth_shape(nodes: Array, fractions: tuple[Array, Array, Array], limits: Counts = SHAPE_POLYNOMIAL_LIMITS) -> Array:
    """Legendre series (a, b, c, 3) of a tooth's points, from its nodes (l, t, u, 3) at fractions from 0 to 1."""
    inverses = []
    for fraction, most in zip(fractions, limits, strict=True):
        inverses.append(np.linalg.pinv(legendre(fraction, min(most, fraction.size))[0]))
    return np.asarray(np.einsum("ai,bj,ck,ijkx->abcx", *inverses, nodes, optimize=True))


def tooth_stiffness(shape: Array, counts: Counts, material: Material) -> Array:
    """Stiffness (3 m, 3 m) [N/mm] of a solid of Legendre polynomials, m = the product of ``counts``.

    At each Gauss station along the face the gradients of the functions through and up are multiplied out; those along
    come in afterwards by one matrix product, as in the shell.

    Parameters
    ----------
    shape
        From ``tooth_shape``.
    counts
        Number of functions in each direction.
    material
        Its material.

    Raises
    ------
    GeometryError
        If the solid is turned inside out somewhere.
    """
    rules = [np.polynomial.legendre.leggauss(c + e) for c, e in zip(counts, EXTRA_GAUSS_POINTS, strict=True)]
    points = [0.5 * (x + 1.0) for x, _ in rules]
    weights = np.einsum("i,j,k->ijk", *(0.5 * w for _, w in rules))
    series = [legendre(p, n, order=1) for p, n in zip(points, shape.shape, strict=False)]
    slopes = [[values[int(axis == k)] for k, values in enumerate(series)] for axis in range(3)]
    jacobian = np.stack([np.einsum("ia,jb,kc,abcx->ijkx", *s, shape, optimize=True) for s in slopes], axis=-1)
    determinant = np.linalg.det(jacobian)
    if determinant.min() * determinant.max() <= 0.0:
        raise GeometryError("the tooth is turned inside out somewhere: its sides come too close to each other")
    inverse = np.linalg.inv(jacobian) * np.sqrt(np.abs(determinant) * weights)[..., None, None]

    along, through, up = (legendre(p, c, order=1) for p, c in zip(points, counts, strict=True))
    in_section = counts[1] * counts[2]

    def section(b: int, c: int) -> Array:
        products = np.einsum("jb,kc->jkbc", through[b], up[c])
        return np.asarray(products.reshape(1, *products.shape[:2], in_section, 1))

    # Gradients by the order of the derivative of what stands along the face.
    plain = section(1, 0) * inverse[:, :, :, None, 1] + section(0, 1) * inverse[:, :, :, None, 2]
    gradients = np.stack([plain, section(0, 0) * inverse[:, :, :, None, 0]], axis=3)
    stations = points[0].size
    gradients = gradients.reshape(stations, -1, 2 * in_section * 3)
    outer = (np.swapaxes(gradients, 1, 2) @ gradients).reshape(stations, 2, 3 * in_section, 2, 3 * in_section)
    products = along[:, None, :, :, None] * along[None, :, :, None, :]
    outer = outer.transpose(2, 4, 1, 3, 0).reshape((3 * in_section) ** 2, -1) @ products.reshape(4 * stations, -1)
    outer = outer.reshape(in_section, 3, in_section, 3, counts[0], counts[0]).transpose(4, 0, 1, 5, 2, 3)

    # Both Lame terms and the Laplacian are entries of the gradients' outer products in another order, as in ``bricks``.
    young, nu = material.elastic_modulus, material.poisson_ratio
    first, shear = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), material.shear_modulus
    result = first * outer + shear * outer.transpose(0, 1, 5, 3, 4, 2)
    laplacian = shear * np.einsum("naimbi->namb", outer)
    for k in range(3):
        result[:, :, k, :, :, k] += laplacian
    size = counts[0] * in_section * 3
    return np.ascontiguousarray(result.reshape(size, size))


def body_stiffness(lattice: ToothLattice, joint: NDArray[np.int64], functions: Array, material: Material) -> Array:
    """Stiffness (3 r, 3 r) of the body alone against displacements of its joint with the tooth.

    Parameters
    ----------
    lattice
        The tooth on its body.
    joint
        Nodes (n) of the joint.
    functions
        Values there (n, r) of the functions that each of the three displacements may follow.
    material
        Its material.
    """
    cells = lattice.cells[: lattice.body_bricks]
    body = substructures(cells, *brick_stiffness(lattice.nodes, cells, material), lattice.held, joint)
    motions = np.kron(functions, np.eye(3))
    result = motions.T @ body.stiffness @ motions
    return np.asarray(0.5 * (result + result.T))
