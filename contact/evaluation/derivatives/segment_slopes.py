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
from ...lines.loaded_places import LoadedPlaces
from ...lines.mesh_edges import FlankEdge, chosen_elements, flank_edges
from ...lines.opposite_points import pinion_points
from ...loaded_cases import LoadedCase
from ...segments import DEPTHS, CycleSegments, loaded_at
from .field_directions import FieldDirections
from .line_motion import LineMotion

Array = NDArray[Any]

STEP = 1e-5  # of the flank, and of the range of a field, in differences of smooth functions of the fields
#: What a segment has of its own; the depths follow from where both members are loaded.
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
        Where pinion and gear are loaded (2, n, g), as fractions on the gear, see ``Segments``.
    motion
        Derivatives of these points (2, n, g, j).
    steps
        Step of every setting (j) that moves points and fields by about ``STEP`` of their ranges.
    """

    segments: CycleSegments
    pieces: EdgePieces
    slopes: dict[str, Array]
    points: tuple[Array, Array]
    motion: tuple[Array, Array]
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
        pinion, gear = (np.stack([one.points[member] for one in columns], axis=-1) for member in (0, 1))
        return cls(own, known, slopes, here.points, (pinion, gear), steps)

    @property
    def places(self) -> tuple[Array, Array]:
        """Derivatives (2, n, j) of the segments' places on pinion and gear, the means of the points."""
        pinion, gear = (np.einsum("xngj,g->xnj", one, self.segments.on_lines.quadrature[1]) for one in self.motion)
        return pinion, gear

    def rows(self, case: LoadedCase) -> NDArray[np.int64]:
        """Numbers of a case's segments (s) among these; -1 for pieces of edges that are not."""
        position = self.segments.on_lines.names["position"]
        of_pieces = self.pieces.rows(case)
        rows = np.where(of_pieces >= 0, position.size + of_pieces, -1)
        rows[case.segments.edge < 0] = np.flatnonzero(position == case.mesh_position)
        return rows


@dataclass(frozen=True)
class _Loaded:
    """Values of segments (n) by name, and the points (2, n, g) where pinion and gear are loaded."""

    values: dict[str, Array]
    points: tuple[Array, Array]

    @classmethod
    def of(
        cls,
        traced: CycleSegments,
        own: CycleSegments,
        pieces: EdgePieces,
        near: Sequence[FlankEdge] | None = None,
    ) -> _Loaded:
        """Of segments ``own``, and of pieces of edges on the fields of ``traced``; ``near`` as of ``flank_edges``."""
        table, weights = own.table, own.on_lines.quadrature[1]
        values = {name: table[name] for name in NAMES}
        pinion, gear = (one.reshape(2, -1, weights.size) for one in own.loaded_places.points)
        if not pieces.keys.size:
            return cls(values, (pinion, gear))
        position, pair, edge, element = pieces.keys.T
        mesh = traced.on_lines.lines
        rotation = mesh.rotations[position] - pair * mesh.pinion_pitch
        edges = traced.edges if near is None else flank_edges(traced.fields, near)
        found = chosen_elements(traced.fields, rotation, edges, edge, element)
        on_edges = {name: getattr(found, name) for name in NAMES if name not in DEPTHS}
        there = pinion_points(traced.fields, found.points, rotation), found.points
        on_edges |= loaded_at(LoadedPlaces(traced.fields, *there), traced.on_lines.teeth.solid)
        joined = {name: np.concatenate([values[name], on_edges[name]]) for name in NAMES}
        on_pinion, on_gear = (np.repeat(one[..., None], weights.size, axis=-1) for one in there)
        return cls(joined, (np.concatenate([pinion, on_pinion], axis=1), np.concatenate([gear, on_gear], axis=1)))

    def __sub__(self, other: _Loaded) -> _Loaded:
        pinion, gear = (one - another for one, another in zip(self.points, other.points, strict=True))
        return _Loaded({name: value - other.values[name] for name, value in self.values.items()}, (pinion, gear))

    def times(self, factor: float) -> _Loaded:
        """All of it times a number."""
        pinion, gear = self.points
        values = {name: factor * value for name, value in self.values.items()}
        return _Loaded(values, (factor * pinion, factor * gear))


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
        return _Loaded.of(traced, moved, pieces, segments.edges)
    return _Loaded.of(segments, own, pieces).times(np.nan)


def _sizes(directions: FieldDirections) -> Array:
    """Greatest change (j) of any field by a unit of a setting, over the range of the field."""
    own = directions.base.spline.coefficients
    span = np.ptp(own, axis=(1, 2))
    change = np.abs(directions.slopes.spline.coefficients).max(axis=(1, 2)).reshape(len(own), directions.count)
    return np.asarray(np.maximum((change / span[:, None]).max(axis=0), 1e-300))
