"""Several teeth of a member on one sector of its body, or all on a closed one, as one lattice that is solved whole.

The pitches are turned copies of one, joined where they meet. A sector begins and ends with a pitch of the body without
a tooth, as that of a single tooth does; its outer sides are held. What each tooth of a product's model takes from one
pitch by waves, or from a sector of its own, stands here in one system of equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...contact.compliance.finite_elements.elastic_body import ElasticBody, elastic_body
from ...contact.compliance.finite_elements.flank_compliance import flank_loads, foot_displacements
from ...contact.compliance.finite_elements.tooth_ring import pitch_angle
from ...contact.compliance.material import Material
from ...core.checks import frozen_arrays
from ...geometry.tooth.tooth_lattice import ToothLattice
from ...geometry.vectors import rotate_z

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class ToothedSector:
    """Teeth (t) on one body.

    Parameters
    ----------
    pitch
        The lattice of one pitch.
    nodes, cells, held
        Nodes, bricks and held nodes of the whole.
    numbers
        Nodes of the whole (t, n) by those of the pitch, of every tooth.
    angles
        Of the teeth about the member's axis (t) [rad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import STEEL
    >>> from easeoff.geometry import LatticeSize, tooth_lattice
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> pitch = tooth_lattice(pair, "pinion", LatticeSize(3, 1, 1, 1, 0, 1, 1))
    >>> on_flanks, _ = toothed_sector(pitch, 12, 2).compliance(STEEL, loaded=0)
    >>> bool(on_flanks[0].sum() > 5.0 * on_flanks[1].sum() > 0.0)
    True
    """

    pitch: ToothLattice
    nodes: Array
    cells: NDArray[np.int64]
    held: NDArray[np.int64]
    numbers: NDArray[np.int64]
    angles: Array

    def body(self, material: Material) -> ElasticBody:
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
        """Displacements under unit loads (n) on the flank of one tooth.

        Returns
        -------
        tuple
            On the flanks of all teeth (t, n, n), and at the feet of the normals of the loaded one (n, n) [mm/N].
        """
        from scipy.sparse import hstack

        on_flank, feet = flank_loads(self.pitch), foot_displacements(self.pitch)
        wanted = [*(self.turned(on_flank, tooth) for tooth in range(len(self.angles))), self.turned(feet, loaded)]
        response = self.body(material).response(self.turned(on_flank, loaded), hstack(wanted, format="csc"))
        parts = np.split(response, len(wanted))
        return np.stack(parts[:-1]), parts[-1]


def toothed_sector(pitch: ToothLattice, teeth: int, on_sector: int | None = None) -> ToothedSector:
    """Teeth of a member on one body.

    Parameters
    ----------
    pitch
        Lattice of one pitch, from mid slot to mid slot (``LatticeSize(beside=0)``).
    teeth
        Teeth of the member.
    on_sector
        Teeth on the sector; ``None`` for all of them on a closed body.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import LatticeSize, tooth_lattice
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> pitch = tooth_lattice(pair, "pinion", LatticeSize(3, 1, 1, 1, 0, 1, 1))
    >>> three, all_of_them = toothed_sector(pitch, 12, 3), toothed_sector(pitch, 12)
    >>> len(three.angles), len(all_of_them.cells) // len(pitch.cells)
    (3, 12)
    """
    angle = pitch_angle(pitch, teeth)
    start, end = (side.ravel() for side in pitch.sides)
    on_body = np.zeros(len(pitch.nodes), dtype=bool)
    on_body[pitch.body] = True
    closed, inner = on_sector is None, on_sector or teeth
    places = range(inner) if closed else range(-1, inner + 1)
    numbers: list[NDArray[np.int64]] = []
    nodes, cells, count = [], [], 0
    for place in places:
        own, with_tooth = np.full(len(pitch.nodes), -1), 0 <= place < inner
        if numbers:
            own[start] = numbers[-1][end]
        if closed and place == inner - 1:
            own[end] = numbers[0][start]
        new = np.flatnonzero((own < 0) & (on_body | with_tooth))
        own[new] = count + np.arange(new.size)
        count += new.size
        nodes.append(rotate_z(np.full(new.size, place * angle), pitch.nodes[new].T).T)
        cells.append(own[pitch.cells if with_tooth else pitch.cells[: pitch.body_bricks]])
        numbers.append(own)
    held = [own[pitch.body[:, :, 0].ravel()] for own in numbers]
    if not closed:
        held += [numbers[0][start], numbers[-1][end]]
    return ToothedSector(
        pitch,
        np.concatenate(nodes),
        np.concatenate(cells),
        np.unique(np.concatenate(held)),
        np.stack(numbers if closed else numbers[1:-1]),
        angle * np.arange(inner),
    )
