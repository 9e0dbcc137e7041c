"""Derivatives of the potential contact segments of a mesh cycle: gap, lever arm, line contact, place.

Segments of contact lines move with their lines, to the ends at edges if these may touch. A piece of an edge keeps its
place along the edge; what of it may touch changes with the settings. All that follows from fields and lines in closed
form or by Newton's method, and is differentiated by central differences along their exact derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...lines.contact_lines import ContactLines
from ...lines.line_ends import line_rotations
from ...lines.mesh_edges import chosen_elements
from ...loaded_cases import LoadedCase
from ...segments import DEPTHS, CycleSegments
from .field_directions import FieldDirections
from .line_motion import LineMotion

Array = NDArray[Any]

STEP = 1e-5  # of the flank, and of the range of a field, in differences of smooth functions of the fields
#: What a segment has of its own.
NAMES = ("separation_angle", "lever_arm", "curvature", "overhang", "length", *DEPTHS)


@dataclass(frozen=True)
class EdgePieces:
    """Pieces of edges (n) in contact over a mesh cycle, in the order of their keys.

    Parameters
    ----------
    keys
        Mesh position, tooth pair, edge and element (n, 4), see ``Segments``.
    """

    keys: NDArray[np.int64]

    @classmethod
    def of(cls, cases: Sequence[LoadedCase]) -> EdgePieces:
        """Those that carry load in any of the cases."""
        keys = [np.zeros((0, 4), dtype=np.int64)]
        for case in cases:
            keys.append(_keys(case)[(case.segments.edge >= 0) & (case.solution.force > 0.0)])
        return cls(np.unique(np.concatenate(keys), axis=0))

    def rows(self, case: LoadedCase) -> NDArray[np.int64]:
        """Numbers of a case's segments (s) among the pieces; -1 where they are none of them."""
        number = {tuple(key): row for row, key in enumerate(self.keys.tolist())}
        return np.array([number.get(tuple(key), -1) for key in _keys(case).tolist()], dtype=np.int64)


def _keys(case: LoadedCase) -> NDArray[np.int64]:
    here = case.segments
    return np.stack([np.full(here.pair.size, case.mesh_position), here.pair, here.edge, here.element], axis=1)


@dataclass(frozen=True)
class SegmentSlopes:
    """Derivatives of the segments of contact lines, and of pieces of edges after these (n), by settings (j).

    Parameters
    ----------
    segments
        Those of the contact lines.
    pieces
        Pieces of edges.
    slopes
        Derivatives (n, j) by name; NaN where the setting at hand takes a line away.
    points
        Where the teeth are loaded (2, n, g), as fractions on the gear.
    motion
        Derivatives of these points (2, n, g, j).
    steps
        Step of every setting (j) that moves points and fields by about ``STEP`` of their ranges.
    """

    segments: CycleSegments
    pieces: EdgePieces
    slopes: dict[str, Array]
    points: Array
    motion: Array
    steps: Array

    @classmethod
    def of(
        cls, segments: CycleSegments, directions: FieldDirections, motion: LineMotion, pieces: EdgePieces | None
    ) -> SegmentSlopes:
        """Derivatives of segments that move with their lines.

        Parameters
        ----------
        segments
            Of the contact lines as they are traced.
        directions
            Fields and their derivatives.
        motion
            Of the lines.
        pieces
            Pieces of edges, up to which the lines go then; ``None`` for contact on lines alone.
        """
        known = pieces or EdgePieces(np.zeros((0, 4), dtype=np.int64))
        own = segments if pieces is None else segments.to_edges
        here = _Loaded.of(segments, own, known)
        steps = STEP / np.maximum(_sizes(directions), np.max(np.abs(motion.points), axis=(0, 1, 2)))
        columns = []
        for j, step in enumerate(steps):
            ahead, behind = (_moved(segments, own, directions, motion, known, j, sign * step) for sign in (1.0, -1.0))
            columns.append((ahead - behind).times(0.5 / step))
        slopes = {name: np.stack([one.values[name] for one in columns], axis=-1) for name in NAMES}
        return cls(own, known, slopes, here.points, np.stack([one.points for one in columns], axis=-1), steps)

    @property
    def places(self) -> Array:
        """Derivatives (2, n, j) of the segments' places, the means of the points where the teeth are loaded."""
        return np.asarray(np.einsum("xngj,g->xnj", self.motion, self.segments.on_lines.quadrature[1]))

    def rows(self, case: LoadedCase) -> NDArray[np.int64]:
        """Numbers of a case's segments (s) among these; -1 for pieces of edges that are not."""
        position = self.segments.on_lines.names["position"]
        of_pieces = self.pieces.rows(case)
        rows = np.where(of_pieces >= 0, position.size + of_pieces, -1)
        rows[case.segments.edge < 0] = np.flatnonzero(position == case.mesh_position)
        return rows


@dataclass(frozen=True)
class _Loaded:
    """Values of segments (n) by name, and the points (2, n, g) where the teeth are loaded."""

    values: dict[str, Array]
    points: Array

    @classmethod
    def of(cls, traced: CycleSegments, own: CycleSegments, pieces: EdgePieces) -> _Loaded:
        """Of segments ``own``, and of pieces of edges on the fields of those that are ``traced``."""
        table, weights = own.table, own.on_lines.quadrature[1]
        values = {name: table[name] for name in NAMES}
        points = own.loaded_points.reshape(2, -1, weights.size)
        if not pieces.keys.size:
            return cls(values, points)
        position, pair, edge, element = pieces.keys.T
        mesh = traced.on_lines.lines
        rotation = mesh.rotations[position] - pair * mesh.pinion_pitch
        found = chosen_elements(traced.fields, rotation, traced.edges, edge, element)
        on_edges = {name: getattr(found, name) for name in NAMES if name not in DEPTHS}
        on_edges |= traced.fields.evaluate(DEPTHS, found.points)
        every = np.repeat(found.points[..., None], weights.size, axis=-1)
        joined = {name: np.concatenate([values[name], on_edges[name]]) for name in NAMES}
        return cls(joined, np.concatenate([points, every], axis=1))

    def __sub__(self, other: _Loaded) -> _Loaded:
        return _Loaded(
            {name: value - other.values[name] for name, value in self.values.items()}, self.points - other.points
        )

    def times(self, factor: float) -> _Loaded:
        """All of it times a number."""
        return _Loaded({name: factor * value for name, value in self.values.items()}, factor * self.points)


def _moved(
    segments: CycleSegments,
    own: CycleSegments,
    directions: FieldDirections,
    motion: LineMotion,
    pieces: EdgePieces,
    setting: int,
    step: float,
) -> _Loaded:
    """Segments and pieces of edges after a step of one setting; NaN if they are not the same lines."""
    fields, mesh = directions.moved(setting, step), segments.on_lines.lines
    lines = ContactLines(
        mesh.lines.level,
        mesh.lines.points + step * motion.points[..., setting],
        mesh.lines.length + step * motion.length[:, setting],
    )
    on_lines = replace(segments.on_lines, fields=fields, lines=replace(mesh, lines=lines))
    traced = replace(segments, fields=fields, on_lines=on_lines)
    moved = traced.to_edges if own.cut else traced
    known, found = line_rotations(own.on_lines.lines), line_rotations(moved.on_lines.lines)
    if np.array_equal(known, found):
        return _Loaded.of(traced, moved, pieces)
    return _Loaded.of(segments, own, pieces).times(np.nan)


def _sizes(directions: FieldDirections) -> Array:
    """Greatest change (j) of any field by a unit of a setting, over the range of the field."""
    own = directions.base.spline.coefficients
    span = np.ptp(own, axis=(1, 2))
    change = np.abs(directions.slopes.spline.coefficients).max(axis=(1, 2)).reshape(len(own), directions.count)
    return np.asarray(np.maximum((change / span[:, None]).max(axis=0), 1e-300))
