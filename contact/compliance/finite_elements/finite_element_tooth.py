"""Teeth of a pair by finite elements or as solid shells, kept on disk.

The solid shell is a Rayleigh-Ritz model of the solid tooth on its body of bricks. As in the shell, Legendre polynomials
along the face and up the tooth are the trial functions; but they stand for all three displacements, there are more of
them through the thickness, and the strain energy is that of the solid tooth on its generated surfaces, fillets and
slanted ends included. The sections slant against the tooth: a wave along it takes more functions through it than the
parabola of a straight one.

The body below is quadratic bricks, whose nodes on the joint follow the polynomials: no springs stand between. It is a
Ritz system of both, too stiff by what its functions cannot follow; each function more makes it softer.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....core.arrays import Array, Integers
from ....core.checks import number
from ....core.errors import GeometryError, InputError
from ....core.memory import require_memory
from ....geometry.pair.gear_pair import GearPair
from ....geometry.tooth.tooth_flanks import MemberName, named_member, side, tooth_angle
from ....geometry.tooth.tooth_lattice import (
    DEPTH_PER_HEIGHT,
    SHELL_HINT,
    LatticeSize,
    ToothLattice,
    tooth_lattice,
    usual_depth,
)
from ....geometry.tooth.tooth_surface import end_faces
from ..material import Material
from ..shell import legendre
from .array_store import Shapes, kept, key_of
from .elastic_body import brick_stiffness, elastic_body, require_right_way_round, substructures
from .flank_compliance import (
    FlankCompliance,
    SharedBody,
    StressResponse,
    by_station,
    flank_loads,
    foot_displacements,
    square_root,
    stress_functionals,
)
from .tooth_ring import WHOLE_BODY, ToothBody, body_modes, ring_lattice, ring_size, with_body

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Counts = tuple[int, int, int]

EXTRA_GAUSS_POINTS = (6, 2, 4)  # Gauss points beyond the number of functions, along, through and up
SHAPE_POLYNOMIAL_LIMITS = (9, 3, 7)  # polynomials of the tooth's own shape
#: Where those overshoot so far, beside a kink of the flank, that the tooth is inside out.
SMOOTH_SHAPE_LIMITS = (9, 3, 5)


@dataclass(frozen=True)
class SolidShell:
    """Factored Rayleigh-Ritz model of a solid tooth on its body.

    Degrees of freedom are ordered (along, through, up, xyz), the last fastest.
    """

    tooth: Integers
    functions: Array  # values (l t u, m) at these
    factor: Array  # L; the stiffness is d^-1 L L^T d^-1, d the scale
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
    """Assemble and factor; of the lattice's bricks only the body's are used."""
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
    parts = zip(fractions, limits, strict=True)
    inverses = [np.linalg.pinv(legendre(fraction, min(most, fraction.size))[0]) for fraction, most in parts]
    return np.asarray(np.einsum("ai,bj,ck,ijkx->abcx", *inverses, nodes, optimize=True))


def tooth_stiffness(shape: Array, counts: Counts, material: Material) -> Array:
    """Stiffness (3 m, 3 m) [N/mm] of a solid of Legendre polynomials, m = the product of ``counts``."""
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

    # Both Lame terms and the Laplacian are entries of the gradients' outer products in other orders (``elastic_body``).
    young, nu = material.elastic_modulus, material.poisson_ratio
    first, shear = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), material.shear_modulus
    result = first * outer + shear * outer.transpose(0, 1, 5, 3, 4, 2)
    laplacian = shear * np.einsum("naimbi->namb", outer)
    for k in range(3):
        result[:, :, k, :, :, k] += laplacian
    size = counts[0] * in_section * 3
    return np.ascontiguousarray(result.reshape(size, size))


def body_stiffness(lattice: ToothLattice, joint: Integers, functions: Array, material: Material) -> Array:
    """Stiffness (3 r, 3 r) of the body alone against displacements of its joint with the tooth, as functions (n, r)."""
    cells = lattice.cells[: lattice.body_bricks]
    body = substructures(cells, *brick_stiffness(lattice.nodes, cells, material), lattice.fixed_nodes, joint)
    motions = np.kron(functions, np.eye(3))
    result = motions.T @ body.stiffness @ motions
    return np.asarray(0.5 * (result + result.T))


BRICKS_PER_HEIGHT = 4.4  # along the face, per usual depth of the body
LENGTHWISE_BRICK_LIMITS = (8, 32)
THROUGH_BRICK_LIMITS = (4, 8)

FUNCTIONS_THROUGH, FUNCTIONS_UP = 4, 9  # trial functions of a solid shell
FACTOR_SIZE, FACTOR_EXPONENT = 1.2e3, 1.4  # memory of a body's factor [byte] over its nodes to this power
UNKNOWNS_LIMIT = 12000  # of a solid shell: its full matrix then takes 1.2 GB
FULL_MATRICES = 4.2  # of that size at once


@dataclass(frozen=True)
class FiniteElementTooth:
    """Compliance and root stress of one member's tooth by finite elements."""

    flank: FlankCompliance
    root: StressResponse | None  # None for a solid shell and for a sharp root
    no_root: str = ""  # reason why there is no stress


def usual_size(pair: GearPair, member: MemberName) -> LatticeSize:
    """Number of bricks that leaves an error of about 1 % in the compliance.

    Bricks are a third of the tooth's height long; through the tooth as many as the brick lengths by which its sections
    slant against its normal, at least.
    """
    one = named_member(pair, member)
    trace = one.flank(np.linspace(0.0, 1.0, 17), np.array([0.5])).position
    step = np.diff(trace, axis=1)
    lengths = np.linalg.norm(step, axis=0)
    length = float(np.nansum(lengths))
    bricks = int(np.clip(round(BRICKS_PER_HEIGHT * length / usual_depth(one.section)), *LENGTHWISE_BRICK_LIMITS))
    middle = 0.5 * (trace[:2, 1:] + trace[:2, :-1])
    around = (middle[0] * step[1] - middle[1] * step[0]) / np.hypot(*middle) / lengths
    slant = float(np.nanmax(np.abs(around) / np.sqrt(1.0 - around**2)))
    shift = slant * usual_depth(one.section) / DEPTH_PER_HEIGHT
    through = int(np.clip(round(shift * bricks / length), *THROUGH_BRICK_LIMITS))
    return LatticeSize(bricks, through=through)


def finite_element_tooth(
    pair: GearPair, member: MemberName, material: Material, fineness: float = 1.0, body: ToothBody = WHOLE_BODY
) -> FiniteElementTooth:
    """Compliance and root stress of one member's tooth, made once and kept on disk.

    ``fineness`` multiplies the bricks in every direction.
    """
    number("fineness", fineness, least=0.2, most=4.0)
    size = _long_enough(usual_size(pair, member).finer(fineness))
    key = key_of("finite elements", _tooth(pair, member), size, body.rim_depth, material)
    of_flank = _flank_arrays(size)
    arrays = kept(
        key,
        {**of_flank, "stations": (None,), "stress": (None, None, 6, of_flank["factor"][1])},
        lambda: _condensed(tooth_lattice(pair, member, size, body.rim_depth), material, member, fineness),
    )
    reason = _sharp_root(pair, member)
    root = None if reason else StressResponse(arrays["stations"], arrays["stress"])
    return FiniteElementTooth(_flank(arrays, pair, member, material, body, key), root, reason)


def _sharp_root(pair: GearPair, member: MemberName) -> str:
    """Reason why the root of the loaded side has no stress to compute; empty if it has a fillet."""
    surface = named_member(pair, member).loaded
    if surface.blade.edge_radius > 0.0:
        return ""
    return (
        f"tool_edge_radius = 0 of the {member}'s {side(surface)} flank: must be above 0 mm for a root stress, as the "
        "stress in a sharp root has no limit; give the edge radius of its blade"
    )


def solid_shell_size(pair: GearPair, member: MemberName, fineness: float = 1.0) -> tuple[LatticeSize, Counts]:
    """Bricks of the body and functions along, through and up the tooth that leave an error of 1 to 4 %."""
    usual = usual_size(pair, member)
    functions = (usual.lengthwise, FUNCTIONS_THROUGH, FUNCTIONS_UP)
    along, through, up = (max(round(fineness * n), 2) for n in functions)
    bricks = replace(usual, slot=1).finer(fineness)
    # The bricks of the joint have to follow every function through the tooth; more of them change nothing.
    return _long_enough(replace(bricks, through=2 * math.ceil(through / 4))), (along, through, up)


def solid_shell_tooth(
    pair: GearPair, member: MemberName, material: Material, fineness: float = 1.0, body: ToothBody = WHOLE_BODY
) -> FiniteElementTooth:
    """Compliance of one member's tooth as a solid shell, made once and kept on disk; see ``finite_element_tooth``."""
    number("fineness", fineness, least=0.2, most=4.0)
    size, counts = solid_shell_size(pair, member, fineness)
    unknowns = 3 * math.prod(counts)
    if unknowns > UNKNOWNS_LIMIT:
        raise InputError(
            f"fineness = {fineness!r}: must be smaller, as the {member} would have {unknowns} unknowns as a solid "
            f'shell, and {UNKNOWNS_LIMIT} are allowed; or take model = "fe"'
        )
    key = key_of("solid shell", _tooth(pair, member), size, body.rim_depth, material, counts)
    arrays = kept(
        key,
        _flank_arrays(size),
        lambda: _condensed_shell(tooth_lattice(pair, member, size, body.rim_depth), material, counts, member, fineness),
    )
    flank = _flank(arrays, pair, member, material, body, key)
    return FiniteElementTooth(flank, None, 'root stresses need finite elements: model = "fe" in [compliance]')


def require_solid_shell(pair: GearPair, member: MemberName) -> None:
    """Refuse a tooth that cannot be a solid shell on the body of all teeth, without building it."""
    lattice = tooth_lattice(pair, member, solid_shell_size(pair, member)[0])
    with filling(member):
        require_right_way_round(lattice.nodes, lattice.cells[: lattice.body_bricks])
    try:
        _ = ring_lattice(pair, member, ring_size())
    except GeometryError:  # as in ``_flank``
        _ = ring_lattice(pair, member, ring_size(2.0))


def _tooth(pair: GearPair, member: MemberName) -> tuple[Any, ...]:
    """Data that decide the shape of a tooth; the other member and the assembly do so by its thickness alone."""
    one = named_member(pair, member)
    return one.teeth, one.section, one.loaded, one.opposite, tooth_angle(pair, member)


def _flank_arrays(size: LatticeSize) -> Shapes:
    """Shapes of the arrays of a compliance."""
    along, up = 2 * size.lengthwise + 1, 2 * size.upward + 1
    return {"lengthwise": (along,), "profile": (along, up), "factor": (None, along * up)}


def _flank(
    stored: Mapping[str, Array], pair: GearPair, member: MemberName, material: Material, body: ToothBody, key: str
) -> FlankCompliance:
    """Compliance from its arrays, kept under a key, on the body that the tooth shares with its neighbours."""
    ends = end_faces(named_member(pair, member))
    flank = FlankCompliance(stored["lengthwise"], stored["profile"], stored["factor"], ends=ends)
    if not body.neighbours:
        return flank
    size = ring_size()

    def make() -> dict[str, Array]:
        with filling(member):
            try:
                modes = body_modes(pair, member, material, size, body)
            except GeometryError:  # smaller bricks follow what larger ones cannot
                modes = body_modes(pair, member, material, ring_size(2.0), body)
        whole = with_body(flank, *modes)
        assert whole.body is not None
        return {"factor": whole.factor, "shapes": whole.body.shapes, "coupling": whole.body.coupling}

    nodes = flank.profile.size
    shapes = {"factor": (None, nodes), "shapes": (None, nodes), "coupling": (None, None, None)}
    arrays = kept(key_of("shared body", key, size, body.web), shapes, make)
    return replace(flank, factor=arrays["factor"], body=SharedBody(arrays["shapes"], arrays["coupling"]))


def _condensed_shell(
    lattice: ToothLattice, material: Material, counts: Counts, member: str, fineness: float
) -> dict[str, Array]:
    needed = FULL_MATRICES * 8.0 * (3 * math.prod(counts)) ** 2
    require_memory(f"fineness = {fineness:g}", needed, f"the {member} as a solid shell")
    with filling(member):
        shell = solid_shell(lattice, material, counts)
    factor = square_root(shell.response(flank_loads(lattice), foot_displacements(lattice, in_tooth=True)))
    return {"lengthwise": lattice.lengthwise, "profile": lattice.profile, "factor": factor}


def _long_enough(size: LatticeSize) -> LatticeSize:
    return replace(size, lengthwise=max(size.lengthwise, 4))


@contextmanager
def filling(member: str) -> Iterator[None]:
    """Tell in errors of which member the lattice has a brick turned inside out, or that it has no lattice."""
    try:
        yield
    except GeometryError as error:
        if SHELL_HINT in str(error):  # it says so already
            raise
        raise GeometryError(f"the {member}'s tooth cannot be filled with bricks: {error}; {SHELL_HINT}") from error


def _condensed(lattice: ToothLattice, material: Material, member: str, fineness: float) -> dict[str, Array]:
    from scipy.sparse import hstack

    needed = FACTOR_SIZE * len(lattice.nodes) ** FACTOR_EXPONENT
    require_memory(f"fineness = {fineness:g}", needed, f"the {member} by finite elements")
    with filling(member):
        body = elastic_body(lattice.nodes, lattice.cells, lattice.fixed_nodes, material)
    feet, (stresses, station) = foot_displacements(lattice), stress_functionals(lattice, material)
    response = body.response(flank_loads(lattice), hstack([feet, stresses], format="csc"))
    count = feet.shape[1]
    root = by_station(response[count:], station)
    on_flank = {"lengthwise": lattice.lengthwise, "profile": lattice.profile, "factor": square_root(response[:count])}
    return on_flank | {"stations": root.lengthwise, "stress": root.stress}
