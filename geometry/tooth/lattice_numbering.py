"""The lattice of bricks in a tooth and its body, and the numbering of its nodes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays, whole

Array = NDArray[Any]


@dataclass(frozen=True)
class LatticeSize:
    """Number of bricks in each direction.

    Parameters
    ----------
    lengthwise
        Along the face.
    upward
        From the middle of the fillet to the tip.
    through
        From one side of the tooth to the other.
    slot
        From the middle of the slot to the middle of the fillet, on either side.
    beside
        In the pitch beyond the slot, on either side; zero to let the lattice end in mid slot.
    deep
        From the root to the bottom of the body.
    overhang
        Of the body beyond either end of the tooth; zero to let it end there.

    Examples
    --------
    >>> LatticeSize(lengthwise=6).finer(0.5)
    LatticeSize(lengthwise=3, upward=2, through=2, slot=1, beside=1, deep=2, overhang=1)
    """

    lengthwise: int = 14
    upward: int = 5
    through: int = 4
    slot: int = 2
    beside: int = 2
    deep: int = 3
    overhang: int = 2

    def __post_init__(self) -> None:
        for name, bricks in vars(self).items():
            whole(name, bricks, 0 if name in ("beside", "overhang") else 1)

    def finer(self, factor: float) -> LatticeSize:
        """The same lattice with ``factor`` times as many bricks in every direction."""
        return LatticeSize(
            *(max(round(factor * n), 1) for n in (self.lengthwise, self.upward, self.through, self.slot)),
            *(max(round(factor * n), 1) for n in (self.beside, self.deep, self.overhang)),
        )


@frozen_arrays
@dataclass(frozen=True)
class ToothLattice:
    """Nodes and bricks of one tooth on its body, in the member's frame.

    The nodes of the tooth and of the body under it are found by three numbers: lengthwise, through the tooth from the
    loaded side, and up from the bottom of the body.

    Parameters
    ----------
    nodes
        Points (n, 3) [mm].
    cells
        Nodes (m, 3, 3, 3) of every brick.
    column
        Nodes (2 l + 1, 2 t + 1, 2 (d + u) + 1) of the tooth and the body under it.
    root_row
        Third index in ``column`` where the tooth begins.
    held
        Nodes at the bottom and at both sides of the body.
    flank_normal
        Unit normals (2 l + 1, 2 u + 1, 3) of the loaded side at the nodes ``flank``, outwards.
    lengthwise
        Lengthwise fractions (2 l + 1) of the sections.
    profile
        Profile fractions (2 l + 1, 2 u + 1) of the nodes ``flank`` on the blank; negative in the fillet.
    slot
        Nodes (2, 2 l + 1, 2 s + 1) of the slots' floors on the loaded and the opposite side, towards the tooth.
    through, upward
        Fractions (2 t + 1) through the tooth from the loaded side, and (2 u + 1) from the middle of the fillet to the
        tip.
    body_bricks
        Number of bricks of the body; they come first.
    body
        Nodes (2 (l + 2 o) + 1, c, 2 d + 1) of the body: from toe to heel with the o bricks of the overhang at either
        end, across it from the loaded side, and up from its bottom.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import tooth_lattice
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> lattice = tooth_lattice(pair, "gear", LatticeSize(4, 2, 2, 1, 1, 1, 0))
    >>> lattice.cells.shape, lattice.flank.shape
    ((40, 3, 3, 3), (9, 5))
    """

    nodes: Array
    cells: NDArray[np.int64]
    column: NDArray[np.int64]
    root_row: int
    held: NDArray[np.int64]
    flank_normal: Array
    lengthwise: Array
    profile: Array
    slot: NDArray[np.int64]
    through: Array
    upward: Array
    body_bricks: int
    body: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 0, 0), dtype=np.int64))

    @property
    def flank(self) -> NDArray[np.int64]:
        """Nodes (2 l + 1, 2 u + 1) on the loaded side, from the middle of the fillet to the tip."""
        return self.column[:, 0, self.root_row :]

    @property
    def sides(self) -> NDArray[np.int64]:
        """Nodes (2, 2 (l + 2 o) + 1, 2 d + 1) at the sides of the body, the loaded one first."""
        return np.stack([self.body[:, 0], self.body[:, -1]])


def numbered(
    nodes: Array,
    ends: list[Array],
    size: LatticeSize,
    body: tuple[int, int],
    normal: Array,
    fractions: tuple[Array, Array, Array],
    profile: Array,
) -> ToothLattice:
    """The lattice; of each section's nodes (nt, per section, 3) the body's (columns, rows) come first."""
    columns, rows = body
    t, through, up = fractions
    in_body = np.arange(columns * rows).reshape(columns, rows)
    first, last = 2 * (size.beside + size.slot), columns - 2 * (size.beside + size.slot)
    above = columns * rows + np.arange(2 * size.upward * (2 * size.through + 1)).reshape(2 * size.upward, -1)
    under = in_body[first:last]
    in_column = np.concatenate([under, above.T], axis=1)
    tooth = np.arange(t.size) * nodes.shape[1]
    counts = [len(end) for end in ends]
    toe, heel = np.split(nodes.shape[0] * nodes.shape[1] + np.arange(sum(counts)) * in_body.size, counts[:1])
    whole = np.concatenate([toe[::-1], tooth, heel])
    in_the_body = layers(whole, in_body)
    cells = np.concatenate([in_the_body, layers(tooth, in_column[:, rows - 1 :])])
    held = np.unique(np.concatenate([in_body[:, 0], in_body[0], in_body[-1]]))
    floors = np.stack(
        [in_body[2 * size.beside : first + 1, -1], in_body[last - 1 : columns - 2 * size.beside, -1][::-1]]
    )
    flat = np.concatenate([nodes.reshape(-1, 3), *(end.reshape(-1, 3) for end in ends)])
    # Left-handed or right-handed, as the tooth's hand has it: all bricks are to have positive volume.
    axes = [flat[cells[0][index]] - flat[cells[0][0, 0, 0]] for index in ((2, 0, 0), (0, 2, 0), (0, 0, 2))]
    if np.linalg.det(np.stack(axes)) < 0.0:
        cells = cells[:, ::-1]
    return ToothLattice(
        flat,
        np.ascontiguousarray(cells),
        tooth[:, None, None] + in_column,
        rows - 1,
        (whole[:, None] + held).ravel(),
        normal,
        t,
        profile,
        np.moveaxis(tooth[:, None, None] + floors, 1, 0),
        through,
        up,
        len(in_the_body),
        whole[:, None, None] + in_body,
    )


def layers(sections: NDArray[np.int64], plane: NDArray[np.int64]) -> NDArray[np.int64]:
    """Nodes (m, 3, 3, 3) of bricks between sections that begin at given nodes, on the cells of a plane lattice."""
    threes = np.lib.stride_tricks.sliding_window_view(sections, 3)[::2]
    return np.asarray((threes[:, None, :, None, None] + cells_of(plane)[:, None]).reshape(-1, 3, 3, 3))


def cells_of(lattice: NDArray[np.int64]) -> NDArray[np.int64]:
    """Nodes (m, 3, 3) of the plane cells of a lattice (2 a + 1, 2 b + 1)."""
    windows = np.lib.stride_tricks.sliding_window_view(lattice, (3, 3))[::2, ::2]
    return np.asarray(windows.reshape(-1, 3, 3))
