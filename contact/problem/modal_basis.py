"""Bending compliance in as few modes as it has: the factor V of C = diag(d) + V V^T, block by block and compressed.

Segments on different tooth pairs share no bending mode, so V has a zero pattern: groups of columns with disjoint rows.
Along a contact line the modes are smooth, so the rows of a group span a space of small numerical rank: a dozen of
eighty modes make up V V^T to all digits. The blocks U with U U^T = V V^T are what the modal solver works on.

Shafts, bearings, housing and the body between the teeth couple the tooth pairs by a few modes W beside those blocks,
C = diag(d) + U U^T + W W^T. Within a block, W has no more directions than a rigid motion, six.

The compiled contact solution reads the modes block by block, and again for a part of the segments. On level 0 stand all
segments, on level 1 every fourth of each block, on level 2 every fourth of these. Places are numbers of segments in the
order of the blocks; a mode of a block is contiguous in ``columns``, and so is a shared column on its segments, behind
the modes.

In a factor as given, columns that couple groups of segments which else fall apart are found by counting: an entry is
zero or it is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...core.arrays import Bools, Integers, RealArray as Array, record
from ...core.checks import instance, read_only, whole
from ...core.errors import InputError
from ...core.kernels import kernel

_kernel = kernel(".mode_kernel", __package__)
label_blocks, arrange = _kernel.label_blocks, _kernel.arrange

#: One segment stands for so many on the next level.
STRIDE = 4
#: On every level a block has at least so many segments.
FEWEST_SEGMENTS = 4
MAX_LEVELS = 5


class ModeColumns(NamedTuple):
    """Modes [(mm/N)^0.5] of one compliance, by levels (l) and blocks (q), each with the columns it shares."""

    places: Integers  # first place of every level in order (l)
    #: (l, q, 4): first place from that of the level, number of segments, first entry of columns, number of modes.
    blocks: Integers
    order: Integers
    columns: Array
    #: (4, n) [mm/N] by segments: diagonal and row sums of U U', diagonal of W W', and that if no terms of W cancelled;
    #: the last two only with shared modes.
    sums: Array
    mixing: Array


def mode_columns(
    size: int, blocks: Sequence[tuple[Integers, Array]], columns: Array, mixing: Array, shared_factor: Array
) -> ModeColumns:
    """Arrange modes of n segments: blocks of segments (m) and modes (m, k) [(mm/N)^0.5], and shared modes.

    Shared are columns (n, j), mixing (q, j, s) and factor W (n, s), the columns themselves under a mixing of ones.
    """
    segments = [np.asarray(index, dtype=np.int64) for index, _ in blocks]
    modes = [modes for _, modes in blocks]
    shortest = min(index.size for index in segments)
    levels = 1
    while levels < MAX_LEVELS and shortest // STRIDE**levels >= FEWEST_SEGMENTS:
        levels += 1
    # Of a block every so many segments, from the half of that on.
    taken = [(STRIDE**level // 2, STRIDE**level) for level in range(levels)]
    counts = [[len(range(begin, index.size, step)) for index in segments] for begin, step in taken]
    widths = [one.shape[1] + columns.shape[1] for one in modes]
    entries = sum(count * width for row in counts for count, width in zip(row, widths, strict=True))
    order, arranged = np.empty(sum(map(sum, counts)), dtype=np.int64), np.empty(entries)
    sums = np.zeros((4 if mixing.shape[2] else 2, size))
    places, table = [], []
    place = entry = 0
    for (begin, step), row in zip(taken, counts, strict=True):
        places.append(place)
        for index, one, count, width in zip(segments, modes, row, widths, strict=True):
            arrange(index, one, columns, begin, step, count, place, entry, order, arranged)
            table.append((place - places[-1], count, entry, one.shape[1]))
            place, entry = place + count, entry + count * width
    for index, one in zip(segments, modes, strict=True):
        sums[0, index] = np.einsum("ij,ij->i", one, one)
        sums[1, index] = one @ one.sum(axis=0)
    if mixing.shape[2]:
        sums[2:] = np.einsum("ij,ij->i", shared_factor, shared_factor)
        if shared_factor is not columns:
            for index, own_mixing in zip(segments, np.abs(mixing), strict=True):
                terms = np.abs(columns[index]) @ own_mixing
                sums[3, index] = np.einsum("ij,ij->i", terms, terms)
    blocks_of_levels = np.array(table, dtype=np.int64).reshape(levels, len(modes), 4)
    whole = ModeColumns(np.array(places), blocks_of_levels, order, arranged, sums, np.ascontiguousarray(mixing))
    for part in whole:
        part.setflags(write=False)  # else they would be copied
    return whole


#: Work with shared columns set apart, over that with all columns in one block, below which it is worth while.
WORTHWHILE_WORK = 0.8
#: Size of a direction left out, relative to the largest.
DIRECTION_TOLERANCE = 1e-15


def shared_columns(factor: Array, blocks: Sequence[tuple[Integers, Integers]]) -> Bools:
    """Mask (k) of the columns of V (n, k) that couple groups of rows, if setting them apart saves enough work."""
    shared = np.zeros(factor.shape[1], dtype=np.bool_)
    work, split_work = 0.0, 0.0
    for rows, columns in blocks:
        cost = _work(rows.size, columns.size, 0)
        present = part_of(factor, rows, columns) != 0.0
        if present.all():
            work, split_work = work + cost, split_work + cost
            continue
        order = np.argsort(np.count_nonzero(present, axis=0), kind="stable")
        present, columns = present[:, order], columns[order]
        coupling, split = _coupling(present)
        work, split_work = work + cost, split_work + (split if coupling.any() else cost)
        shared[columns[coupling]] = True
    count = int(np.count_nonzero(shared))
    return shared if not count or split_work + count**3 / 3 < WORTHWHILE_WORK * work else np.zeros_like(shared)


def part_of(factor: Array, rows: Integers, columns: Integers) -> Array:
    """Some rows and columns of a factor, in ascending order; no copy where they are all in a row."""
    both = [slice(one[0], one[-1] + 1) if one.size and one[-1] - one[0] < one.size else one for one in (rows, columns)]
    return factor[both[0]][:, both[1]]


def _coupling(present: Bools) -> tuple[Bools, float]:
    """Columns that couple groups of rows (k), and the work with these set apart.

    Columns of the mask (n, k), fewest entries first, are taken in turn: one that meets rows of a single group extends
    it, one that meets several couples them.
    """
    coupling = np.zeros(present.shape[1], dtype=np.bool_)
    if not (present[:, :-1] & ~present[:, 1:]).any():  # each column has the entries of the one before
        return coupling, 0.0
    # Few patterns occur among many rows. Sets of patterns are bits of a whole number.
    patterns, rows = np.unique(present, axis=0, return_counts=True)
    sets = [int.from_bytes(number.tobytes(), "little") for number in np.packbits(patterns.T, axis=1, bitorder="little")]
    groups: list[tuple[int, int]] = []  # patterns and number of columns of each
    for column, number in enumerate(sets):
        met = [group for group in groups if group[0] & number]
        if len(met) > 1:
            coupling[column] = True
        elif met:
            groups[groups.index(met[0])] = (met[0][0] | number, met[0][1] + 1)
        else:
            groups.append((number, 1))
    shared = int(np.count_nonzero(coupling))
    sizes = [sum(int(count) for bit, count in enumerate(rows) if group >> bit & 1) for group, _ in groups]
    return coupling, sum(_work(size, number, shared) for size, (_, number) in zip(sizes, groups, strict=True))


def _work(segments: int, modes: int, shared: int) -> float:
    """Operations on a block of so many segments, modes of its own and shared modes."""
    return float(segments * (min(segments, modes) + min(segments, shared)) ** 2)


def few_directions(rows: Array) -> tuple[Array, Array]:
    """Return orthonormal Q (m, r) and M (r, s) with Q M = W up to rounding, for the rows W (m, s) of one block."""
    from scipy.linalg import qr  # the contact problem itself needs no scipy

    directions, triangle, order = qr(rows, mode="economic", pivoting=True)
    sizes = np.abs(triangle.diagonal())
    rank = int(np.count_nonzero(sizes > DIRECTION_TOLERANCE * sizes.max(initial=0.0)))
    mixing = np.empty((rank, rows.shape[1]))
    mixing[:, order] = triangle[:rank]
    return np.ascontiguousarray(directions[:, :rank]), mixing


#: Largest contribution of a dropped mode to a block of V V^T, relative to its greatest entry (or eigenvalue).
DROP_TOLERANCE = 1e-15
#: Directions of a rigid motion: more shared columns than these are tried for fewer directions.
RIGID_DIRECTIONS = 6


@record(frozen=True, eq=False)
class SharedModes:
    """Modes W that all blocks share: a segment i of block b has the row W_i = columns_i mixing_b.

    Attributes
    ----------
    columns
        What a unit force at each segment does to what all share, such as its wrench (n, q).
    mixing
        Of every block (p, q, s); in units that make W [(mm/N)^0.5].

    Examples
    --------
    Two tooth pairs of two segments each on one spring of 1e-6 mm/N:

    >>> import numpy as np
    >>> from easeoff.contact import ModalBasis, SharedModes
    >>> spring = SharedModes(np.ones((4, 1)), np.full((2, 1, 1), 1e-3))
    >>> basis = ModalBasis(4, np.array([[0, 1], [2, 3]]), np.zeros((2, 2, 0)), spring)
    >>> (basis.factor @ basis.factor.T).round(9)[0].tolist()
    [1e-06, 1e-06, 1e-06, 1e-06]
    """

    columns: Array
    mixing: Array


@record(frozen=True, eq=False)
class ModalBasis:
    """Blocks of a compressed factor, padded to the size of the largest, and modes that all blocks share.

    Attributes
    ----------
    size
        Number of segments n.
    index
        Segments of each block (p, m); n where padded. Every segment is in one block.
    modes
        U of each block (p, m, k) [(mm/N)^0.5], zero where padded.
    shared
        Modes W beside those of the blocks, or None: C = diag(d) + U U^T + W W^T.

    Raises
    ------
    InputError
        The arrays do not fit each other, a segment is in no block or in two, or a mode is not finite.

    Examples
    --------
    Two tooth pairs of two segments each, with one mode a pair:

    >>> from easeoff.contact import ContactProblem, solve
    >>> basis = ModalBasis(4, np.array([[0, 1], [2, 3]]), np.array([[[1e-3], [2e-3]], [[2e-3], [1e-3]]]))
    >>> basis.factor.shape, len(basis.blocks)
    ((4, 2), 2)
    >>> problem = ContactProblem(np.zeros(4), np.full(4, 40.0), 1.6e5, (np.full(4, 1e-6), basis))
    >>> solve(problem).certified, problem.modal_basis is basis
    (True, True)
    """

    size: int
    index: Integers
    modes: Array
    shared: SharedModes | None = None

    def __post_init__(self) -> None:
        """Check that the arrays fit: compiled code reads them without asking."""
        index, modes, size = self.index, self.modes, whole("size", self.size, 0)
        given = all(isinstance(one, np.ndarray) for one in (index, modes))
        if not (given and (index.ndim, modes.ndim) == (2, 3) and index.dtype.kind in "iu" and modes.dtype == float):
            raise InputError("index, modes: must be whole numbers (p, m), and floats (p, m, k) [(mm/N)^0.5]")
        if modes.shape[:2] != index.shape:
            raise InputError(f"modes = array of shape {modes.shape}: must have the shape (p, m, k), index being (p, m)")
        within = bool(index.size) and size <= index.size and index.min() >= 0 and index.max() <= size
        if not (within and (np.bincount(index.ravel(), minlength=size + 1)[:size] == 1).all()):
            raise InputError(f"index = array of shape {index.shape}: must have each segment from 0 to {size - 1} once")
        if not np.isfinite(modes).all() or modes[index == size].any():
            raise InputError("modes: must be finite, and zero where index is padded")

        if self.shared is not None:
            _check_shared(self.shared, size, index.shape[0])

    @cached_property
    def factor(self) -> Array:
        """[U, W] as one array (n, r), read-only; every block has columns of its own, before the shared ones."""
        block, mode = np.nonzero(self.modes.any(axis=1))
        factor = np.zeros((self.size + 1, block.size))
        factor[self.index[block], np.arange(block.size)[:, None]] = self.modes[block, :, mode]
        if self.shared_factor.shape[1]:
            factor = np.concatenate([factor[:-1], self.shared_factor], axis=1)
        return factor[: self.size]

    @cached_property
    def shared_factor(self) -> Array:
        """W (n, s) [(mm/N)^0.5], without columns of zeros."""
        if self.shared is None:
            return np.zeros((self.size, 0))
        columns, mixing = self.shared.columns, self.shared.mixing
        wide, shared = np.zeros((self.size + 1, columns.shape[1])), np.zeros((self.size + 1, mixing.shape[2]))
        wide[:-1] = columns
        shared[self.index] = wide[self.index] @ mixing
        kept = shared.any(axis=0)
        return shared[:-1] if kept.all() else np.ascontiguousarray(shared[:-1, kept])

    @cached_property
    def border(self) -> SharedModes:
        """The shared modes as solvers take them: with no more than the directions of all blocks together.

        Where there are at most q modes, the columns are W itself, and the mixing is one of ones.
        """
        factor, blocks = self.shared_factor, self.index.shape[0]
        shared = self.shared
        if shared is None:
            return SharedModes(factor, np.zeros((blocks, 0, 0)))
        if factor.shape[1] <= shared.columns.shape[1]:
            one = np.eye(factor.shape[1])
            return SharedModes(factor, np.broadcast_to(one, (blocks, *one.shape)))
        mixing = shared.mixing[:, :, shared.mixing.any(axis=(0, 1))]
        every = blocks * mixing.shape[1]
        if mixing.shape[2] > every:  # M = R'Q', and M M' = R'R
            triangle: Array = np.asarray(np.linalg.qr(mixing.reshape(every, -1).T, mode="r"))
            mixing = triangle.T.reshape(*mixing.shape[:2], every)
        return SharedModes(shared.columns, np.ascontiguousarray(mixing))

    @cached_property
    def blocks(self) -> list[tuple[Integers, Array]]:
        """Segments (m) and own modes (m, k) of each block, without the padding."""
        rows = [index < self.size for index in self.index]
        blocks = zip(self.index, self.modes, rows, strict=True)
        return [(index[mask], modes[mask][:, modes.any(axis=0)]) for index, modes, mask in blocks]

    @cached_property
    def columns(self) -> ModeColumns:
        """The modes as the compiled contact solution reads them."""
        return mode_columns(self.size, self.blocks, self.border.columns, self.border.mixing, self.shared_factor)

    @property
    def basis(self) -> ModalBasis:
        """These modes themselves: they are compressed."""
        return self


@record(frozen=True, eq=False)
class BendingFactor:
    """A factor V (n, k) [(mm/N)^0.5] as given; its blocks are found and compressed when first asked for."""

    factor: Array

    @cached_property
    def labels(self) -> BlockLabels:
        """Groups of rows and columns."""
        return block_labels(self.factor)

    @cached_property
    def is_shared(self) -> Bools:
        """True for the columns (k) that couple blocks."""
        if self.labels.has_full_rows:
            return np.zeros(self.factor.shape[1], dtype=np.bool_)
        return shared_columns(self.factor, self.labels.blocks)

    @cached_property
    def shared_factor(self) -> Array:
        """The columns that couple blocks (n, s) [(mm/N)^0.5]."""
        return self.factor[:, self.is_shared]

    @cached_property
    def compressed(self) -> list[tuple[Integers, Array]]:
        """Rows (m) and U (m, r) [(mm/N)^0.5] of each block, where no columns couple them."""
        return [(rows, compressed_block(part_of(self.factor, rows, columns))) for rows, columns in self.labels.blocks]

    @cached_property
    def basis(self) -> ModalBasis:
        """The factor compressed by blocks; columns that couple blocks become shared modes."""
        if not self.is_shared.any():
            rows, modes = zip(*self.compressed, strict=True)
            return basis_of_blocks(self.factor.shape[0], rows, modes)
        basis = BendingFactor(self.factor[:, ~self.is_shared]).basis
        return replace(basis, shared=_shared_modes(self.shared_factor, [rows for rows, _ in basis.blocks]))

    @cached_property
    def columns(self) -> ModeColumns:
        """The compressed modes as the compiled contact solution reads them."""
        if self.is_shared.any():
            return self.basis.columns
        none = np.zeros((self.factor.shape[0], 0))
        return mode_columns(none.shape[0], self.compressed, none, np.zeros((self.labels.rows.size, 0, 0)), none)


def _check_shared(shared: SharedModes, size: int, blocks: int) -> None:
    """Check shared modes of a number of segments and blocks."""
    instance("shared", shared, SharedModes)
    columns, mixing = shared.columns, shared.mixing
    values: Any
    for name, values, shape in (("columns", columns, f"({size}, q)"), ("mixing", mixing, f"({blocks}, q, s)")):
        wanted = 2 if name == "columns" else 3
        if not (isinstance(values, np.ndarray) and values.dtype == np.float64 and values.ndim == wanted):
            raise InputError(f"shared {name}: must be an array of floats of shape {shape}")
        if not np.isfinite(values).all():
            raise InputError(f"shared {name}: must be finite")
    if columns.shape[0] != size:
        raise InputError(f"shared columns = array of shape {columns.shape}: must have {size} rows")
    if mixing.shape[:2] != (blocks, columns.shape[1]):
        raise InputError(
            f"shared mixing = array of shape {mixing.shape}: must have the shape ({blocks}, {columns.shape[1]}, s), "
            f"there being {blocks} blocks and {columns.shape[1]} shared columns"
        )


def modal_basis(factor: Array) -> ModalBasis:
    """Return a factor V (n, k) [(mm/N)^0.5] compressed by blocks, see `BendingFactor`."""
    return BendingFactor(factor).basis


def _shared_modes(factor: Array, rows: Sequence[Integers]) -> SharedModes:
    """Shared modes W (n, s) [(mm/N)^0.5] in as few columns as they have directions, in all and within a block."""
    if factor.shape[1] > RIGID_DIRECTIONS:
        factor = compressed_block(factor)
    size, count = factor.shape
    parts = [few_directions(factor[segments]) for segments in rows] if count > RIGID_DIRECTIONS else []
    most = max((mixing.shape[0] for _, mixing in parts), default=count)
    if most >= count:
        return SharedModes(factor, np.tile(np.eye(count), (len(rows), 1, 1)))
    columns, mixing = np.zeros((size, most)), np.zeros((len(rows), most, count))
    for number, (segments, (directions, mixed)) in enumerate(zip(rows, parts, strict=True)):
        columns[segments, : mixed.shape[0]] = directions
        mixing[number, : mixed.shape[0]] = mixed
    return SharedModes(columns, mixing)


def basis_of_blocks(
    size: int, rows: Sequence[Integers], compressed: Sequence[Array], shared: SharedModes | None = None
) -> ModalBasis:
    """Basis of compressed blocks U (m, r) [(mm/N)^0.5] on rows (m), which together have each segment once."""
    longest = max(segments.size for segments in rows)
    rank = max(block.shape[1] for block in compressed)
    index = np.full((len(compressed), longest), size, dtype=np.intp)
    modes = np.zeros((len(compressed), longest, rank))
    for number, (segments, block) in enumerate(zip(rows, compressed, strict=True)):
        index[number, : segments.size] = segments
        modes[number, : segments.size, : block.shape[1]] = block
    basis = ModalBasis(size, index, modes, shared)
    shapes = [block.shape for block in compressed]
    basis.__dict__["blocks"] = [(basis.index[b, :m], basis.modes[b, :m, :k]) for b, (m, k) in enumerate(shapes)]
    return basis


class BlockLabels(NamedTuple):
    """Groups of rows and columns of V (n, k) that share no entry but zero."""

    row: Integers  # number of the group of each row (n), in the order of their first rows
    column: Integers  # of each column (k); -1 of a column of zeros
    rows: Integers  # number of rows of each group
    has_full_rows: bool  # each group has a row without zeros, so that no column couples others

    @property
    def blocks(self) -> list[tuple[Integers, Integers]]:
        """Rows and columns of each group; rows of zeros make one without columns."""
        return [(np.flatnonzero(self.row == b), np.flatnonzero(self.column == b)) for b in range(self.rows.size)]


def block_labels(factor: Array) -> BlockLabels:
    """Groups of rows and columns of V (n, k) that share no entry but zero."""
    row, column = (np.empty(count, dtype=np.int64) for count in factor.shape)
    rows, filled = np.empty((2, row.size), dtype=np.int64)
    room = np.empty((2, column.size), dtype=np.int64)
    count, has_full_rows = label_blocks(np.ascontiguousarray(factor), row, column, rows, filled, *room)
    return BlockLabels(row, column, rows[:count], bool(has_full_rows))


def compressed_block(block: Array) -> Array:
    """Return U (m, r) with U U^T = V V^T up to rounding, of as few columns as that takes, for a block V (m, k)."""
    from scipy.linalg.blas import dsyrk  # the contact problem itself needs no scipy
    from scipy.linalg.lapack import dgeqrf, dorgqr, dpstrf

    if not block.size:
        return np.zeros((block.shape[0], 0))
    tall = block.shape[0] > block.shape[1]
    product = dsyrk(1.0, block.T, trans=not tall, lower=1)  # zero above the diagonal
    tolerance = DROP_TOLERANCE * float(product.diagonal().max())
    lower, pivot, rank, _info = dpstrf(product, tol=tolerance, lower=1, overwrite_a=1)
    compressed = np.empty((product.shape[0], rank), order="F")
    compressed[pivot - 1] = lower[:, :rank]
    if not tall:
        return read_only(compressed)
    # The rows of V are in the directions of L with V^T V = L L^T: what they have beside these is rounding in V V^T.
    return read_only(block @ (dorgqr(*dgeqrf(compressed, overwrite_a=1)[:2])[0] if rank else compressed))


def with_shared_modes(basis: ModalBasis, columns: Array, mixing: Array) -> ModalBasis:
    """The modes of tooth pairs, and shared modes W beside them: C = diag(d) + U U' + W W'.

    Parameters
    ----------
    basis
        Modes U of the tooth pairs, p blocks; shared modes that it has already are kept.
    columns
        What a unit force at each segment does to what all share, such as its wrench (n, q).
    mixing
        Of every block (p, q, s): a segment i of block b has the row W_i = columns_i mixing_b [(mm/N)^0.5].

    Raises
    ------
    InputError
        Arrays of the wrong shape, or numbers that are not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ModalBasis, with_shared_modes
    >>> pairs = ModalBasis(4, np.array([[0, 1], [2, 3]]), np.array([[[1e-3], [2e-3]], [[2e-3], [1e-3]]]))
    >>> spring = with_shared_modes(pairs, np.ones((4, 1)), np.full((2, 1, 1), 5e-4))
    >>> round(float(spring.factor[0] @ spring.factor[3]), 12)
    2.5e-07
    """
    instance("basis", basis, ModalBasis)
    shared = replace(basis, shared=SharedModes(columns, mixing))
    if not shared.shared_factor.shape[1]:  # rigid supports
        return basis
    if basis.shared is not None:
        shared = replace(basis, shared=_joined(basis.shared, columns, mixing))
    shared.__dict__["blocks"] = basis.blocks
    return shared


def _joined(first: SharedModes, columns: Array, mixing: Array) -> SharedModes:
    """Shared modes, and others beside them."""
    p, q, s = first.mixing.shape
    both = np.zeros((p, q + mixing.shape[1], s + mixing.shape[2]))
    both[:, :q, :s], both[:, q:, s:] = first.mixing, mixing
    return SharedModes(np.hstack([first.columns, columns]), both)
