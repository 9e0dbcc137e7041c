"""The support that explains measured deflections best: a compliance in E, P, G and Sigma by convex least squares."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array, record
from ...core.checks import array, instance, truth
from ...core.errors import InputError
from ...geometry.pair.assembly import Assembly
from .support import ORIGIN, Support, Supports
from .supported_contact import RelativeMotion

ROTATION_LENGTH = 100.0  # [mm]; an error of Sigma counts as the displacement at this length
RIDGE = 1e-6  # of the data; what the deflections do not determine is as small as it can be
RANK_SHARE = 1e-6  # of the greatest singular value; a smaller one is no independent datum


@record(frozen=True, eq=False)
class IdentifiedSupport:
    """A support identified from deflections (n).

    Parameters
    ----------
    assembly
        The assembly without load.
    compliance
        E, P, G [mm] and Sigma [rad] per force that works on each of them [N, N mm] (4, 4), or with the rotations of
        pinion and gear (6, 6); symmetric, without negative eigenvalues.
    residual
        Measured deflections less those of the compliance (n, 4) [mm, rad].
    determined
        How many of the numbers of a symmetric matrix the deflections determine: of the ten of (4, 4) four for mesh
        forces of one direction, seven for two, as of drive and coast. The others are as small as they can be.
    independent_forces
        Number of directions of the mesh force that differ.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> assembly = gear_pair(read_case("fm-11x41")).assembly
    >>> force = np.array([[9.0e3, -8.5e3, -2.5e3, 0.0, 0.0, 3.7e5]])
    >>> identified = identified_support(assembly, force, [[-0.1, 0.08, -0.02, 3e-4]])
    >>> identified.independent_forces, identified.determined
    (1, 4)
    """

    assembly: Assembly
    compliance: Array
    residual: Array
    determined: int
    independent_forces: int

    @property
    def supports(self) -> Supports:
        """The support for an analysis: all of it at the pinion, the gear rigid."""
        twists = _twists(self.assembly, len(self.compliance))
        relative = twists @ self.compliance @ twists.T
        return Supports(Support(ORIGIN, 0.5 * (relative + relative.T)), Support.rigid(), wind_up=True)


def identified_support(
    assembly: Assembly, wrenches: ArrayLike, deflections: ArrayLike, *, rotations: bool = False
) -> IdentifiedSupport:
    """Find the support under which mesh forces give the deflections that were measured.

    Parameters
    ----------
    assembly
        The assembly without load.
    wrenches
        Force and moment of the gear on the pinion about the origin of the global frame (n, 6) [N, N mm], such as means
        over the mesh cycle, see ``SupportedContact.mesh_wrench``.
    deflections
        E, P, G [mm] and Sigma [rad] under these, less those without load (n, 4).
    rotations
        Whether the moments about both axes may move E, P, G and Sigma, too, as they do where the members tilt.

    Returns
    -------
    IdentifiedSupport
        Well-posed only as far as the mesh forces differ: see its ``determined``.

    Raises
    ------
    InputError
        If the arrays do not fit each other, or there is no mesh force.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> assembly = gear_pair(read_case("fm-11x41")).assembly
    >>> drive, coast = [9.0e3, -8.5e3, -2.5e3, 0.0, 0.0, 3.7e5], [-5.0e3, 9.0e3, -3.0e3, 0.0, 0.0, -3.7e5]
    >>> moved = [[-0.1, 0.08, -0.02, 3e-4], [0.1, -0.05, -0.03, -2e-4]]
    >>> identified_support(assembly, [drive, coast], moved).determined
    7
    """
    instance("assembly", assembly, Assembly)
    truth("rotations", rotations)
    rows = array("deflections", deflections, "mm, rad", ndim=2, fewest=4)
    known = array("wrenches", wrenches, "N, N mm", ndim=2, fewest=6)
    if rows.shape[1] != 4 or known.shape != (rows.shape[0], 6):
        raise InputError(
            f"deflections, wrenches = arrays of shapes {rows.shape}, {known.shape}: must have the shapes (n, 4), (n, 6)"
        )
    parts = 6 if rotations else 4
    forces = known @ _twists(assembly, parts)
    # Sigma as a displacement, and what works on it as a force.
    scale = np.repeat([1.0, ROTATION_LENGTH], [3, parts - 3])
    given, moved = forces / scale, rows * scale[:4]
    size = float(np.linalg.norm(given, axis=1).max())
    if size == 0.0:
        raise InputError("wrenches = 0: must have a force on E, P, G or Sigma")
    given, stretch = given / size, max(float(np.abs(moved).max()), 1e-12)
    matrix = _nearest(given, moved / stretch) * stretch / size
    compliance = matrix / np.outer(scale, scale)
    values = np.linalg.svd(_symmetric_map(given), compute_uv=False)
    directions = np.linalg.svd(given, compute_uv=False)
    ranks = (int(np.count_nonzero(sizes > RANK_SHARE * sizes[0])) for sizes in (values, directions))
    return IdentifiedSupport(assembly, compliance, rows - (forces @ compliance)[:, :4], *ranks)


def _twists(assembly: Assembly, parts: int) -> Array:
    """Twists (6, p) of E, P, G, Sigma, and of both rotations if p is 6."""
    return RelativeMotion(assembly, 1.0).twists[:, :parts]


def _symmetric_basis(parts: int) -> Array:
    """Symmetric matrices (b, p, p) of unit length, one for every entry of a triangle."""
    row, column = np.triu_indices(parts)
    basis, number = np.zeros((row.size, parts, parts)), np.arange(row.size)
    basis[number, row, column] = basis[number, column, row] = np.where(row == column, 1.0, np.sqrt(0.5))
    return basis


def _symmetric_map(forces: Array) -> Array:
    """Displacements (n * 4, b) under forces (n, p) for the numbers of a symmetric compliance."""
    basis = _symmetric_basis(forces.shape[1])
    return np.asarray(np.einsum("nj,bij->nib", forces, basis[:, :4]).reshape(-1, len(basis)))


def _nearest(forces: Array, moved: Array) -> Array:
    """Matrix (p, p) without negative eigenvalues whose displacements under forces (n, p) are nearest to given ones.

    Where the least squares without this condition meet it, they are the answer.
    """
    parts = forces.shape[1]
    basis, design = _symmetric_basis(parts), _symmetric_map(forces)
    ridge = RIDGE * float(np.linalg.norm(design, 2))
    widened = np.concatenate([design, ridge * np.eye(len(basis))])
    numbers, *_ = np.linalg.lstsq(widened, np.concatenate([moved.ravel(), np.zeros(len(basis))]))
    free = np.tensordot(numbers, basis, axes=1)
    if np.linalg.eigvalsh(free).min() >= 0.0:
        return np.asarray(free)
    import cvxpy as untyped  # half a second

    cvxpy: Any = untyped
    matrix = cvxpy.Variable((parts, parts), PSD=True)
    errors = (forces @ matrix)[:, :4] - moved, ridge * matrix
    misfit = cvxpy.norm(cvxpy.hstack([cvxpy.vec(one, order="F") for one in errors]))
    cvxpy.Problem(cvxpy.Minimize(misfit)).solve(solver="CLARABEL")
    values, vectors = np.linalg.eigh(0.5 * (matrix.value + matrix.value.T))
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T)
