"""Compliance of a flank under pressures on it, indentation and bending in one, from finite elements.

Between two points a distance r apart the compliance is that of a half space, (1 - nu^2) / (pi E r), plus what the real
body adds. The latter is smooth and is interpolated between nodes; the former is integrated in closed form over the
cells of a pressure field by whoever has such cells.

The field of a normal point force on the surface of a half space (J. Boussinesq 1885; K. L. Johnson, Contact Mechanics,
1985, section 3.2) in vectors: with the unit normal N into the body, d from the force to the point, rho = |d| and
z = d . N,

    u = P / (4 pi G) [ z d / rho^3 + (3 - 4 nu) N / rho - (1 - 2 nu) grad ln(rho + z) ].

It also solves the equations of elasticity beyond the plane z = 0, up to the ray on which rho + z = 0.

The displacement under a point force has no limit, and bricks of some millimetres know nothing of it. It is known in
closed form, though: near the force the body is a half space. The finite elements solve for the rest alone. With the
half space's field u* in the bricks around the loaded surface, and its values at their nodes b,

    u = v + u* - (interpolation of b),       K v = K_near b - (tractions of u* on the surface of these bricks),

for any value of b at the loaded node itself. On the loaded surface u* has hardly any traction, on all others it is
smooth. At every other node u = v; at the loaded one, with b = 0 there, v is what the body adds to its half space.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, csr_array

from ..contact.compliance.finite_elements.array_store import kept, key_of
from ..contact.compliance.finite_elements.elastic_body import COLUMNS_PER_SOLVE, elastic_body, quadratic, stiffness
from ..contact.compliance.finite_elements.finite_element_tooth import filling
from ..contact.compliance.material import Material
from ..core.arrays import Array, Integers, record
from ..core.checks import instance
from ..geometry.pair.gear_pair import GearPair
from ..geometry.tooth.tooth_flanks import MemberName
from ..geometry.tooth.tooth_lattice import LatticeSize, LatticeSpacing, ToothLattice, tooth_lattice, with_middles


def point_force_displacement(offset: Array, inward: Array, material: Material) -> Array:
    """Displacement (..., 3) [mm/N] at offsets (..., 3) [mm] from a unit force along the normal into the body."""
    nu = material.poisson_ratio
    shear = 0.5 * material.elastic_modulus / (1.0 + nu)
    rho = np.linalg.norm(offset, axis=-1, keepdims=True)
    z = np.sum(offset * inward, axis=-1, keepdims=True)
    gradient = (offset / rho + inward) / (rho + z)
    field = z * offset / rho**3 + (3.0 - 4.0 * nu) * inward / rho - (1.0 - 2.0 * nu) * gradient
    return np.asarray(field / (4.0 * np.pi * shear))


def point_force_traction(offset: Array, inward: Array, normal: Array, poisson_ratio: float) -> Array:
    """Traction (..., 3) [MPa/N] of a unit force's field on surfaces with given normals.

    Offsets in [mm], the force along the normal into the body; zero on the half space's own surface.
    """
    rho = np.linalg.norm(offset, axis=-1, keepdims=True)
    d, z = offset / rho, np.sum(offset * inward, axis=-1, keepdims=True) / rho
    along, facing = (np.sum(v * normal, axis=-1, keepdims=True) for v in (d, inward))
    hessian = (normal - d * along) / (1.0 + z) - (d + inward) * (along + facing) / (1.0 + z) ** 2
    free = z * normal - inward * along - d * facing - hessian
    return np.asarray(((1.0 - 2.0 * poisson_ratio) * free - 3.0 * z * d * along) / (2.0 * np.pi * rho**2))


FACE_GAUSS_POINTS = 6  # points in each direction of a face; an even number, which leaves its middle node out
RAY_CLEARANCE_LIMIT = 0.3  # (rho + z) / rho of bricks that take part in the field; less is near its singular ray
LOAD_DISTANCE_LIMIT = 0.02  # [mm]


def surface_compliance(
    nodes: Array, cells: Integers, fixed: Integers, material: Material, loaded: Integers, normal: Array
) -> Array:
    """Displacements (k, k) [mm/N] into the body by unit forces into it at nodes (k) of a smooth surface.

    None on its edge; normals point outwards. The diagonal has what the body adds to the half space. Fails if a brick is
    turned inside out.
    """
    body = elastic_body(nodes, cells, fixed, material)
    near = _near(nodes, cells, loaded, normal)
    field_matrix = stiffness(nodes, near, material).tocsr()
    points, weighted_normals, onto_nodes = _faces(nodes, near)
    area = np.linalg.norm(weighted_normals, axis=1, keepdims=True)
    direction = weighted_normals / area
    inside = np.unique(near)
    result = np.empty((loaded.size, loaded.size))
    for start in range(0, loaded.size, COLUMNS_PER_SOLVE):
        part = slice(start, min(start + COLUMNS_PER_SOLVE, loaded.size))
        count = part.stop - start
        known = np.zeros((len(nodes), 3, count))
        loads = np.zeros((3 * len(nodes), count))
        for k in range(count):
            node, inward = loaded[start + k], -normal[start + k]
            others = inside[inside != node]
            known[others, :, k] = point_force_displacement(nodes[others] - nodes[node], inward, material)
            offset = points - nodes[node]
            with np.errstate(divide="ignore", invalid="ignore"):
                traction = area * point_force_traction(offset, inward, direction, material.poisson_ratio)
            traction[np.linalg.norm(offset, axis=1) < LOAD_DISTANCE_LIMIT] = 0.0
            loads[:, k] = (onto_nodes @ traction).ravel()
        answer = body.solve(np.asarray(field_matrix @ known.reshape(-1, count) - loads))
        at_loaded = answer.reshape(len(nodes), 3, count)[loaded]
        result[:, part] = -np.einsum("mx,mxk->mk", normal, at_loaded)
    return result


def _near(nodes: Array, cells: Integers, loaded: Integers, normal: Array) -> Integers:
    """Bricks that stay clear of the singular rays of all forces."""
    middles = nodes[cells[:, 1, 1, 1]]
    clear = np.ones(len(cells), dtype=bool)
    for node, outward in zip(loaded, normal, strict=True):
        offset = middles - nodes[node]
        clear &= 1.0 - offset @ outward / np.linalg.norm(offset, axis=1) > RAY_CLEARANCE_LIMIT
    return cells[clear]


def _faces(nodes: Array, cells: Integers) -> tuple[Array, Array, csc_array]:
    """Surface of bricks: quadrature points (q, 3), outward normals times weights, and their shares in the nodes."""
    sides = [(np.take(cells, end, axis=1 + axis).reshape(-1, 9), axis, end) for axis in range(3) for end in (0, 2)]
    all_faces = np.concatenate([face for face, _, _ in sides])
    inner = np.concatenate([cells[:, 1, 1, 1]] * 6)
    _, first, count = np.unique(np.sort(all_faces, axis=1), axis=0, return_index=True, return_counts=True)
    chosen = first[count == 1]
    faces, inner = all_faces[chosen], inner[chosen]
    x, w = np.polynomial.legendre.leggauss(FACE_GAUSS_POINTS)
    (value, slope), count_points = quadratic(x), FACE_GAUSS_POINTS**2
    shape = np.einsum("ia,jb->ijab", value, value).reshape(count_points, 9)
    along = [np.einsum("ia,jb->ijab", a, b).reshape(count_points, 9) for a, b in ((slope, value), (value, slope))]
    corners = nodes[faces]
    points = np.einsum("qa,fax->fqx", shape, corners)
    normal = np.cross(*(np.einsum("qa,fax->fqx", d, corners) for d in along))
    outward = np.sign(np.einsum("fqx,fqx->f", normal, points - nodes[inner][:, None]))
    normal *= outward[:, None, None] * np.outer(w, w).ravel()[:, None]
    rows = np.broadcast_to(faces[:, None, :], (len(faces), count_points, 9)).ravel()
    columns = np.repeat(np.arange(len(faces) * count_points), 9)
    shares = np.broadcast_to(shape, (len(faces), count_points, 9)).ravel()
    onto = csc_array((shares, (rows, columns)), shape=(len(nodes), len(faces) * count_points))
    return points.reshape(-1, 3), normal.reshape(-1, 3), onto


# Thicknesses of bricks over that of the others, the outermost first: at tip, toe and heel, and below the loaded flank.
# A tooth ends in wedges; with bricks as thick as the load is far from the end, a sharp one would be much too stiff.
EDGE_BRICKS = (0.05, 0.12, 0.3, 0.65)
THROUGH_BRICKS = (0.04, 0.1, 0.25, 0.7, 1.0, 0.3)
EDGE_SHARE = 4  # at most every so many bricks are thinner at one edge
LOADED_PROFILE_LIMIT = 0.02  # of the nodes that are loaded; the fillet below is too strongly curved for a half space
STORE_VERSION = 2  # of what is kept; raise it when the same input gives other arrays


@record(frozen=True)
class FlankResponse:
    """Compliance that a tooth's body adds to the half space under normal forces on its loaded flank.

    Parameters
    ----------
    lengthwise
        Lengthwise fractions (nt) of the loaded nodes.
    profile
        Their profile fractions (nt, nh).
    beyond_half_space
        (nt nh, nt nh) [mm/N], symmetric.

    Examples
    --------
    >>> even = np.linspace(0.0, 1.0, 4)
    >>> response = FlankResponse(even, np.tile(even, (4, 1)), np.eye(16))
    >>> print(response.shares(np.array([[0.5], [0.5]])).sum().round(12))
    1.0
    """

    lengthwise: Array
    profile: Array
    beyond_half_space: Array

    def shares(self, points: Array) -> csr_array:
        """Nodes' shares (n, nt nh) in points (2, n) of the flank, by cubics; beyond the outermost nodes, theirs."""
        count, rows = self.profile.shape
        sections, along = cubic_shares(np.broadcast_to(self.lengthwise, (points.shape[1], count)), points[0])
        nodes, shares = [], []
        for k in range(sections.shape[1]):
            levels, up = cubic_shares(self.profile[sections[:, k]], points[1])
            nodes.append(sections[:, [k]] * rows + levels)
            shares.append(along[:, [k]] * up)
        index = np.concatenate(nodes, axis=1)
        points_of = np.repeat(np.arange(points.shape[1]), index.shape[1])
        values = np.concatenate(shares, axis=1).ravel()
        return csr_array((values, (points_of, index.ravel())), shape=(points.shape[1], self.profile.size))


def cubic_shares(points: Array, wanted: Array) -> tuple[Integers, Array]:
    """Indices and shares (n, 4) of the four of each row's increasing points (n, m) around the wanted ones (n)."""
    inside = np.clip(wanted, points[:, 0], points[:, -1])
    first = np.clip(np.sum(points <= inside[:, None], axis=1) - 2, 0, points.shape[1] - 4)
    index = first[:, None] + np.arange(4)
    four = np.take_along_axis(points, index, axis=1)
    shares = np.ones_like(four)
    for j in range(4):
        for m in range(4):
            if m != j:
                shares[:, j] *= (inside - four[:, m]) / (four[:, j] - four[:, m])
    return index.astype(np.int64), shares


def thinner_edges(points: LatticeSpacing, ratios: tuple[float, ...]) -> LatticeSpacing:
    """Points of as many bricks, those at tip, toe and heel thinner by ratios, the outermost by the first."""
    heel = _thinner_end(points.lengthwise, ratios)
    both = 1.0 - _thinner_end((1.0 - heel)[::-1], ratios)[::-1]
    enough = points.through.size == 2 * len(THROUGH_BRICKS) + 1
    through = _points(np.array(THROUGH_BRICKS)) if enough else points.through
    return LatticeSpacing(both, _thinner_end(points.upward, ratios), through)


def _thinner_end(points: Array, ratios: tuple[float, ...]) -> Array:
    sizes = np.diff(points[::2])
    count = min(len(ratios), max(sizes.size // EDGE_SHARE, 1))
    sizes[-count:] *= ratios[count - 1 :: -1]
    return _points(sizes)


def _points(sizes: Array) -> Array:
    return with_middles(np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum())


def flank_response(
    pair: GearPair, member: MemberName, material: Material, size: LatticeSize, rim_depth: float | None = None
) -> FlankResponse:
    """Response of one member's loaded flank; made once and kept on disk, see ``array_store.cache_folder``.

    Parameters
    ----------
    pair
        The gear pair.
    member
        ``"pinion"`` or ``"gear"``.
    material
        Its material.
    size
        Number of bricks; those at tip, toe and heel are thin.
    rim_depth
        As ``tooth_lattice``.

    Raises
    ------
    GeometryError
        As ``tooth_lattice``, or if a brick is turned inside out.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import STEEL
    >>> from easeoff.geometry import LatticeSize
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> response = flank_response(pair, "gear", STEEL, LatticeSize(4, 3, 2, 1, 1, 1, 0))
    >>> response.beyond_half_space.shape
    (35, 35)
    """
    instance("material", material, Material)
    instance("size", size, LatticeSize)
    lattice = tooth_lattice(pair, member, size, rim_depth, thinner_edges(LatticeSpacing.of_size(size), EDGE_BRICKS))
    key = key_of("flank_response", STORE_VERSION, lattice.nodes, lattice.fixed_nodes, lattice.flank_normal, material)
    shapes = {"lengthwise": (None,), "profile": (None, None), "beyond_half_space": (None, None)}
    arrays = kept(key, shapes, lambda: _response(lattice, material, member))
    return FlankResponse(arrays["lengthwise"], arrays["profile"], arrays["beyond_half_space"])


def _response(lattice: ToothLattice, material: Material, member: str) -> dict[str, Array]:
    lowest = int(np.argmax(np.all(lattice.profile > LOADED_PROFILE_LIMIT, axis=0)))
    chosen = (slice(1, -1), slice(lowest, -1))  # nothing is known of a force on the edge itself
    loaded, normal = lattice.flank[chosen].ravel(), lattice.flank_normal[chosen].reshape(-1, 3)
    with filling(member):
        whole = surface_compliance(lattice.nodes, lattice.cells, lattice.fixed_nodes, material, loaded, normal)
    position = lattice.nodes[loaded]
    distance = np.linalg.norm(position[:, None] - position, axis=2)
    np.fill_diagonal(distance, np.inf)
    beyond = whole - 1.0 / (np.pi * material.plane_strain_modulus * distance)
    return {
        "lengthwise": lattice.lengthwise[chosen[0]],
        "profile": lattice.profile[chosen],
        "beyond_half_space": 0.5 * (beyond + beyond.T),
    }
