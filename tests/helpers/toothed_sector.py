"""Several teeth of a member on one sector of its body, or all on a closed one, as one lattice that is solved whole.

The pitches are turned copies of one, joined where they meet. A sector begins and ends with a pitch of the body without
a tooth, as that of a single tooth does; its outer sides are held. What each tooth of a product's model takes from one
pitch by waves, or from a sector of its own, stands here in one system of equations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, hstack

from easeoff.contact import Material
from easeoff.contact.compliance.finite_elements.elastic_body import Substructures, elastic_body
from easeoff.contact.compliance.finite_elements.flank_compliance import flank_loads, foot_displacements
from easeoff.contact.compliance.finite_elements.tooth_ring import pitch_angle
from easeoff.core.arrays import Array
from easeoff.core.checks import frozen_arrays
from easeoff.geometry import ToothLattice
from easeoff.geometry.vectors import rotate_z


@frozen_arrays
@dataclass(frozen=True)
class ToothedSector:
    """Teeth (t) on one body, meshed in copies of the lattice of one pitch."""

    pitch: ToothLattice
    nodes: Array
    cells: NDArray[np.int64]
    fixed_nodes: NDArray[np.int64]
    numbers: NDArray[np.int64]  # of the pitch's nodes in the whole (t, n)
    angles: Array  # about the member's axis (t) [rad]

    def body(self, material: Material) -> Substructures:
        """The whole, factored."""
        return elastic_body(self.nodes, self.cells, self.fixed_nodes, material)

    def turned(self, functionals: csc_array, tooth: int) -> csc_array:
        """Functionals (3 n, m) of one pitch on a tooth of the whole."""
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
