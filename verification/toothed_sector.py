"""Several teeth of a member on one sector of its body, or all on a closed one, as one lattice that is solved whole.

The pitches are turned copies of one, joined where they meet. A sector begins and ends with a pitch of the body without
a tooth, as that of a single tooth does; its outer sides are held. What each tooth of a product's model takes from one
pitch by waves, or from a sector of its own, stands here in one system of equations.

Relief of a free end: finite elements of a body with a free end face, at which an even line load ends.

Under an even line load that goes on for ever a half space is in plane strain, with Flamant's stresses. Where the body
ends, these must be taken off the end face; the displacements by their opposites are what the end adds. The load itself
has no part in that: the displacements grow towards the end as a logarithm, and bricks that shrink towards it follow.
An independent check of ``contact.compliance.spread_deflection``.

Shape functions of the serendipity brick of 20 nodes, the element of CalculiX and other programs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from ..contact.compliance.finite_elements.elastic_body import Substructures, elastic_body, quadratic, shape_functions
from ..contact.compliance.finite_elements.flank_compliance import flank_loads, foot_displacements
from ..contact.compliance.finite_elements.tooth_ring import pitch_angle
from ..contact.compliance.material import Material
from ..core.arrays import Array
from ..core.checks import frozen_arrays, instance, number, whole
from ..geometry.tooth.tooth_lattice import ToothLattice, with_middles
from ..geometry.vectors import rotate_z

if TYPE_CHECKING:
    from scipy.sparse import csc_array


@frozen_arrays
@dataclass(frozen=True)
class ToothedSector:
    """Teeth (t) on one body, meshed in copies of the lattice of one pitch."""

    pitch: ToothLattice
    nodes: Array
    cells: NDArray[np.int64]
    held: NDArray[np.int64]
    numbers: NDArray[np.int64]  # of the pitch's nodes in the whole (t, n)
    angles: Array  # about the member's axis (t) [rad]

    def body(self, material: Material) -> Substructures:
        """The whole, factored."""
        return elastic_body(self.nodes, self.cells, self.held, material)

    def turned(self, functionals: csc_array, tooth: int) -> csc_array:
        """Functionals (3 n, m) of one pitch on a tooth of the whole."""
        from scipy.sparse import csc_array

        known = functionals.tocoo()
        node, axis = np.divmod(known.row, 3)
        parts = np.zeros((3, node.size))
        parts[axis, np.arange(node.size)] = known.data
        turned = rotate_z(np.full(node.size, self.angles[tooth]), parts)
        rows = 3 * self.numbers[tooth][node] + np.arange(3)[:, None]
        columns = np.broadcast_to(known.col, rows.shape)
        shape = (3 * len(self.nodes), functionals.shape[1])
        return csc_array((turned.ravel(), (rows.ravel(), columns.ravel())), shape=shape)

    def compliance(self, material: Material, loaded: int) -> tuple[Array, Array]:
        """Displacements [mm/N] under unit loads (n) on one flank: on all flanks (t, n, n), and at feet (n, n).

        The feet are those of the normals of the loaded tooth.
        """
        from scipy.sparse import hstack

        on_flank, feet = flank_loads(self.pitch), foot_displacements(self.pitch)
        wanted = [*(self.turned(on_flank, tooth) for tooth in range(len(self.angles))), self.turned(feet, loaded)]
        response = self.body(material).response(self.turned(on_flank, loaded), hstack(wanted, format="csc"))
        parts = np.split(response, len(wanted))
        return np.stack(parts[:-1]), parts[-1]


def toothed_sector(pitch: ToothLattice, teeth: int, on_sector: int | None = None) -> ToothedSector:
    """Teeth on one body from a pitch between mid slots (``LatticeSize(beside=0)``); by default all on a closed body."""
    angle = pitch_angle(pitch, teeth)
    start, end = (side.ravel() for side in pitch.sides)
    on_body = np.zeros(len(pitch.nodes), dtype=bool)
    on_body[pitch.body] = True
    closed, inner = on_sector is None, on_sector or teeth
    places = range(inner) if closed else range(-1, inner + 1)
    numbers: list[NDArray[np.int64]] = []
    nodes, cells, count = [], [], 0
    for place in places:
        node_numbers, with_tooth = np.full(len(pitch.nodes), -1), 0 <= place < inner
        if numbers:
            node_numbers[start] = numbers[-1][end]
        if closed and place == inner - 1:
            node_numbers[end] = numbers[0][start]
        new = np.flatnonzero((node_numbers < 0) & (on_body | with_tooth))
        node_numbers[new] = count + np.arange(new.size)
        count += new.size
        nodes.append(rotate_z(np.full(new.size, place * angle), pitch.nodes[new].T).T)
        cells.append(node_numbers[pitch.cells if with_tooth else pitch.cells[: pitch.body_bricks]])
        numbers.append(node_numbers)
    fixed_nodes = [node_numbers[pitch.body[:, :, 0].ravel()] for node_numbers in numbers]
    if not closed:
        fixed_nodes += [numbers[0][start], numbers[-1][end]]
    return ToothedSector(
        pitch,
        np.concatenate(nodes),
        np.concatenate(cells),
        np.unique(np.concatenate(fixed_nodes)),
        np.stack(numbers if closed else numbers[1:-1]),
        angle * np.arange(inner),
    )


FACE_GAUSS_POINTS = 8  # in each direction of a brick's face; the stress is singular at the load
FIRST_BRICK = 0.03  # [mm]
GROWTH = 2.0  # of the bricks' borders away from the end of the load
BORDER_COUNT_LIMIT = 16  # 1 km


@frozen_arrays
@dataclass(frozen=True)
class EndRelief:
    """Added displacements of a free end under a line load of 1 N/mm.

    Parameters
    ----------
    distance
        From the end along the line (n) [mm].
    depth
        Below the flank (m) [mm]; the first is zero.
    sinking
        Displacements into the body under the line (n, m) [mm].
    slant
        How much farther along the line the body begins per depth: the tangent of the angle of the end face.

    Examples
    --------
    A flank that sinks by 2 nm where the point 1 mm below it sinks by 1 nm has come 1 nm nearer:

    >>> even = EndRelief(np.arange(3.0), np.array([0.0, 1.0]), np.array([[2e-6, 1e-6]] * 3), slant=0.0)
    >>> even.approach(1).tolist()
    [1e-06, 1e-06, 1e-06]
    """

    distance: Array
    depth: Array
    sinking: Array
    slant: float

    def approach(self, row: int) -> Array:
        """Approach (n) of the flank and the point at one of the depths below it, or nearest to it, [mm]."""
        begin = self.slant * self.depth[row]
        below = PchipInterpolator(self.distance + begin, self.sinking[:, row])
        return np.asarray(self.sinking[:, 0] - below(np.maximum(self.distance, begin)))


def end_relief(material: Material, *, slant: float = 0.0, oblique: float = 0.0, borders: int = 10) -> EndRelief:
    """Relief of an end face.

    Parameters
    ----------
    material
        Of the body.
    slant
        Angle of the end face against the normal of the flank [rad], positive where the body is a sharp wedge.
    oblique
        Angle of the load against the normal of the end's edge, in the flank [rad].
    borders
        Borders of bricks in each direction; the outermost is held, 15 mm away with ten of them.

    Examples
    --------
    >>> from easeoff.contact import STEEL
    >>> found = end_relief(STEEL, borders=6)
    >>> found.sinking.shape, bool(np.all(np.diff(found.sinking[1:6, 0]) < 0.0))
    ((13, 13), True)
    """
    instance("material", material, Material)
    number("slant", slant, "rad", above=-0.5 * math.pi, below=0.5 * math.pi)
    number("oblique", oblique, "rad", above=-0.5 * math.pi, below=0.5 * math.pi)
    whole("borders", borders, 2, BORDER_COUNT_LIMIT)
    sides = np.concatenate([[0.0], FIRST_BRICK * GROWTH ** np.arange(borders)])
    one, both = with_middles(sides), with_middles(np.concatenate([-sides[:0:-1], sides]))
    across, along, deep = np.meshgrid(both, one, one, indexing="ij")
    leaning = math.tan(slant), math.tan(oblique)
    nodes = np.stack([across, along + leaning[0] * deep + leaning[1] * across, deep], axis=-1)
    index = np.arange(across.size).reshape(across.shape)
    windows = np.lib.stride_tricks.sliding_window_view(index, (3, 3, 3))[::2, ::2, ::2]
    fixed_nodes = np.unique(np.concatenate([index[0], index[-1], index[:, -1], index[:, :, -1]], axis=None))
    body = elastic_body(nodes.reshape(-1, 3), windows.reshape(-1, 3, 3, 3), fixed_nodes, material)
    loads = np.zeros((across.size, 3))
    x, w = np.polynomial.legendre.leggauss(FACE_GAUSS_POINTS)
    shape = quadratic(x)[0]
    for i in range(0, both.size - 1, 2):
        for k in range(0, one.size - 1, 2):
            half = 0.5 * (both[i + 2] - both[i]), 0.5 * (one[k + 2] - one[k])
            at = (both[i + 1] + half[0] * x)[:, None], (one[k + 1] + half[1] * x)[None]
            weight = half[0] * half[1] * np.outer(w, w)
            traction = _traction(*at, leaning, material.poisson_ratio) * weight[..., None]
            face = index[i : i + 3, 0, k : k + 3].ravel()
            loads[face] += np.einsum("pi,qj,pqx->ijx", shape, shape, traction).reshape(9, 3)
    moved = body.solve(loads.reshape(-1, 1)).reshape(*across.shape, 3)
    return EndRelief(one, one, moved[both.size // 2, :, :, 2], leaning[0])


def _traction(across: Array, depth: Array, leaning: tuple[float, float], poisson_ratio: float) -> Array:
    """Opposite (..., 3) of what plane strain puts on an end face, per area at right angles to the load."""
    fourth = math.pi * (across**2 + depth**2) ** 2
    first, shear, last = (-2.0 * across**n * depth ** (3 - n) / fourth for n in (2, 1, 0))
    along = poisson_ratio * (first + last)
    slant, oblique = leaning
    return -np.stack([first * oblique + shear * slant, -along, shear * oblique + last * slant], axis=-1)


def serendipity_functions(points: Array) -> tuple[Array, Array]:
    """Shape functions and gradients as ``elastic_body.shape_functions``, zero for seven nodes the brick lacks."""
    values, gradients = shape_functions(points)
    fewer = _serendipity()
    return values @ fewer, np.einsum("nak,ab->nbk", gradients, fewer)


@cache
def _serendipity() -> Array:
    """Values (27, 27) of the 20 functions at all 27 nodes, zero for the nodes they lack."""
    points = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(27, 3)
    values = np.zeros((27, 27))
    for node, at in enumerate(points):
        zero = np.flatnonzero(at == 0.0)
        linear = np.prod(1.0 + np.delete(points, zero, axis=1) * np.delete(at, zero), axis=1)
        if zero.size == 0:
            values[:, node] = linear * (points @ at - 2.0) / 8.0
        elif zero.size == 1:
            values[:, node] = linear * (1.0 - points[:, zero[0]] ** 2) / 4.0
    return values
