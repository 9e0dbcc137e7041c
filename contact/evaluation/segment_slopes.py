"""Derivatives of the potential contact segments of a mesh cycle: gap, lever arm, line contact, place.

Segments of contact lines move with their lines, to the ends at edges if these may touch. A piece of an edge keeps its
place along the edge; what of it may touch changes with the settings. All that follows from fields and lines in closed
form or by Newton's method, and is differentiated by central differences along their exact derivatives.

Fields are splines on the gear flank, moved along their derivatives by several settings; contact lines are level sets of
the roll angle. A point of a line moves across it as the roll angle there changes. An end moves to where line and
boundary of the common flank meet then. Between the ends points stay evenly spaced in length on the gear flank, which
moves as well. Numbers of a transmission error over the mesh cycle are differentiated, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...core.arrays import Array, Integers
from ...core.errors import GeometryError
from ...geometry.newton import cramers_rule
from ...geometry.pair.gear_pair import MEMBERS
from ..compliance.elastic_model import member_points
from ..lines.closest_approach import PASSING_FIELDS, PINION_FRACTIONS, SEPARATION_FIELDS, pinion_points
from ..lines.contact_lines import BOUNDARY_FIELDS, ContactLines, bend_and_slope, length_through
from ..lines.flank_splines import SLOPES, VALUE_AND_SLOPES, FlankSplines, TensorSpline, fit
from ..lines.mesh_edges import FlankEdge, chosen_elements, flank_edges, line_rotations
from ..lines.mesh_lines import LoadedPlaces, MeshLines
from ..loaded import HARMONIC_ORDER_COUNT, LoadedCase, rotation_numbers
from ..segments import DEPTHS, CycleSegments, loaded_at
from ..unloaded import ENVELOPE_REFINEMENT
from .unloaded_slopes import UnloadedSlopes


def rotation_slopes(error: Array, slopes: Array, orders: int) -> dict[str, Any]:
    """Derivatives of mean level, peak to peak, harmonics and rms of errors (t, k) by settings, with dimensions."""
    rows, count = np.arange(len(error)), error.shape[1]
    spectrum, change = np.fft.rfft(error, axis=1), np.fft.rfft(slopes, axis=1)
    scale = np.full(spectrum.shape[1], 2.0 / count)
    if count % 2 == 0:
        scale[-1] /= 2.0  # as in ``loaded``
    amplitude = scale * np.abs(spectrum)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = np.real(np.conj(spectrum / np.abs(spectrum))[..., None] * change) * scale[:, None]
    harmonic = np.zeros((len(error), orders, slopes.shape[2]))
    kept = min(orders, spectrum.shape[1] - 1)
    harmonic[:, :kept] = along[:, 1 : kept + 1]
    first = slice(1, min(3, kept) + 1)
    rms = np.sqrt(np.sum(amplitude[:, first] ** 2, axis=1))
    by_rms = np.sum(amplitude[:, first, None] * along[:, first], axis=1) / rms[:, None]
    ends = slopes[rows, np.argmax(error, axis=1)] - slopes[rows, np.argmin(error, axis=1)]
    return {
        "mean_level": (("torque", "setting"), slopes.mean(axis=1)),
        "peak_to_peak": (("torque", "setting"), ends),
        "harmonic": (("torque", "order", "setting"), harmonic),
        "rms": (("torque", "setting"), by_rms),
    }


def unloaded_numbers(unloaded: UnloadedSlopes) -> tuple[dict[str, Any], dict[str, Any]]:
    """Numbers ``unloaded_...`` of the transmission error [urad], and their derivatives, zero by the torque."""
    fine, change = 1e6 * unloaded.error[None], 1e6 * np.pad(unloaded.slopes, ((0, 0), (0, 1)))[None]
    names = ("mean_level", "harmonic", "rms")
    numbers, by_setting = rotation_numbers(fine), rotation_slopes(fine, change, HARMONIC_ORDER_COUNT)
    values = {f"unloaded_{name}": (numbers[name][0][1:], numbers[name][1][0]) for name in names}
    data = {f"unloaded_{name}": (by_setting[name][0][1:], by_setting[name][1][0]) for name in names}
    envelope = "unloaded_transmission_error_envelope"
    values[envelope] = (("mesh_position",), fine[0, ::ENVELOPE_REFINEMENT])
    data[envelope] = (("mesh_position", "setting"), change[0, ::ENVELOPE_REFINEMENT])
    values["unloaded_peak_to_peak"] = ((), 1e6 * unloaded.peak_to_peak)
    data["unloaded_peak_to_peak"] = (("setting",), 1e6 * np.append(unloaded.peak_slopes, 0.0))
    return values, data


#: What contact depends on.
FIELDS = (
    "roll_angle",
    "ease_off_angle",
    "lever_arm",
    *BOUNDARY_FIELDS,
    *SEPARATION_FIELDS,
    "position",
    *DEPTHS,
    *PASSING_FIELDS,
)
BEND_STEP = 1e-4  # of the greatest change of curvature and skew, in a difference of their bounded forms


@dataclass(frozen=True)
class FieldDirections:
    """Splines of the ``FIELDS`` of a pair and of their derivatives by settings (j), which come last."""

    base: FlankSplines
    slopes: FlankSplines
    count: int

    @classmethod
    def of(cls, fields: FlankSplines, ease_off: Mapping[str, Array], slopes: Mapping[str, Array]) -> FieldDirections:
        """Splines through derivatives at the nodes; a ``GeometryError`` refuses a conjugate point without any."""
        curvature, skew = ease_off["separation_curvature"][..., None], ease_off["separation_skew"][..., None]
        by_curvature, by_skew = slopes["separation_curvature"], slopes["separation_skew"]
        sizes = [np.nanmax(np.abs(d) / (0.1 + np.abs(v))) for v, d in ((curvature, by_curvature), (skew, by_skew))]
        step = BEND_STEP / max(*sizes, 1e-300)
        ahead, behind = (bend_and_slope(curvature + d * by_curvature, skew + d * by_skew) for d in (step, -step))
        bends = zip(SEPARATION_FIELDS, ahead, behind, strict=True)
        given = dict(slopes) | {name: (a - b) / (2.0 * step) for name, a, b in bends}
        splines = fit(fields.lengthwise, fields.profile, {name: given[name] for name in FIELDS})
        if not np.array_equal(splines.holes, fields.holes):
            raise GeometryError(
                "the flanks have no derivatives at some nodes: a setting moves the end of the flank there"
            )
        return cls(_part(fields), splines, given["roll_angle"].shape[-1])

    def moved(self, setting: int, step: float) -> FlankSplines:
        """The fields after a step of one setting, to first order."""
        base = self.base.spline
        change = self.slopes.spline.coefficients.reshape(-1, self.count, *base.coefficients.shape[1:])[:, setting]
        return replace(self.base, spline=TensorSpline(base.intervals, base.coefficients + step * change))


def on_member(directions: FieldDirections, member: str, points: Array, motion: Array) -> tuple[Array, Array]:
    """Fractions (2, ...) on a member of points (2, ...) where it is loaded, and their derivatives (2, ..., j)."""
    if member == "gear":
        return points, motion
    change = np.stack(list(directions.slopes.evaluate(list(PINION_FRACTIONS), points).values()))
    by_t, by_h = (np.stack(list(d.values())) for d in directions.base.derivatives(PINION_FRACTIONS, points, SLOPES))
    by_torque = (0, motion.shape[-1] - directions.count)  # which moves no field
    fixed = np.pad(np.moveaxis(change, 1, -1), [(0, 0)] * points.ndim + [by_torque])
    moved = fixed + by_t[..., None] * motion[0] + by_h[..., None] * motion[1]
    return member_points(directions.base, member, points), moved


def _part(fields: FlankSplines) -> FlankSplines:
    """The ``FIELDS`` alone."""
    numbers, columns, start = [], {}, 0
    for name in FIELDS:
        components, shape = fields.columns[name]
        numbers.append(np.arange(components.start, components.stop))
        columns[name] = (slice(start, start := start + components.stop - components.start), shape)
    return replace(fields, spline=fields.spline.part(np.concatenate(numbers)), columns=columns)


END_TOLERANCE = 1e-6  # fraction of the flank, or mm, within which a line's end lies on the boundary
LENGTH_STEP = 1e-5  # [mm], of the points of a line in a difference of lengths


@dataclass(frozen=True)
class LineMotion:
    """Derivatives of contact lines (m) by settings (j)."""

    points: Array  # as fractions (2, m, k, j)
    length: Array


def line_motion(directions: FieldDirections, mesh: MeshLines) -> LineMotion:
    """Motion of contact lines; a ``GeometryError`` refuses a line that ends at a hole within the flank."""
    points, base = mesh.lines.points, directions.base
    roll = np.stack([d["roll_angle"] for d in base.derivatives(["roll_angle"], points, SLOPES)])
    tangents = [d["position"] for d in base.derivatives(["position"], points, SLOPES)]
    metric = [np.sum(tangents[i] * tangents[j], axis=0) for i, j in ((0, 0), (0, 1), (1, 1))]
    across = cramers_rule(metric[:2], metric[1:], roll)
    across = across / np.sum(roll * across, axis=0)  # a unit of roll angle across the line
    along = np.stack([-roll[1], roll[0]])
    squared = metric[0] * along[0] ** 2 + 2.0 * metric[1] * along[0] * along[1] + metric[2] * along[1] ** 2
    along = along / np.sqrt(squared)
    along = along * np.sign(np.sum(np.gradient(points, axis=-1) * along, axis=0))  # a millimetre along the line
    change = directions.slopes.evaluate(["roll_angle", "position"], points)
    turned, shifted = np.moveaxis(change["roll_angle"], 0, -1), np.moveaxis(change["position"], 1, -1)
    moved = -across[..., None] * turned[None]

    ends = [0, points.shape[2] - 1]
    wanted = _ends(directions, points[:, :, ends], roll[:, :, ends], turned[:, ends])
    unit = along[:, :, ends, None]
    slide = np.sum((wanted - moved[:, :, ends]) * unit, axis=0) / np.sum(unit**2, axis=0)
    share = np.linspace(0.0, 1.0, points.shape[2])
    slides = slide[:, :1] * (1.0 - share[:, None]) + slide[:, 1:] * share[:, None]
    moved = moved + along[..., None] * slides[None]

    # What that makes of lengths, and the slide that spaces the points evenly again.
    position = base("position", points)
    in_space = shifted + tangents[0][..., None] * moved[0] + tangents[1][..., None] * moved[1]
    longer = np.empty(turned.shape)
    for j in range(directions.count):
        step = LENGTH_STEP / max(float(np.max(np.abs(in_space[..., j]))), 1e-300)
        ahead, behind = (length_through(position + sign * step * in_space[..., j]) for sign in (1.0, -1.0))
        longer[..., j] = (ahead - behind) / (2.0 * step)
    moved = moved + along[..., None] * (share[:, None] * longer[:, -1:] - longer)
    return LineMotion(moved, longer[:, -1])


def _ends(directions: FieldDirections, points: Array, roll: Array, turned: Array) -> Array:
    """Derivatives (2, m, 2, j) of the ends of the lines: on their level and on the boundary that ends them."""
    names = list(BOUNDARY_FIELDS)
    derivatives = directions.base.derivatives(names, points, VALUE_AND_SLOPES)
    change = directions.slopes.evaluate(names, points)
    t, h = points
    one, none = np.ones_like(t), np.zeros_like(t)
    still = np.zeros(turned.shape)
    distances, slopes, changes = [t, 1.0 - t, h, 1.0 - h], [[one, none]] * 2 + [[none, one]] * 2, [still] * 4
    for name in names:
        value, *by_fraction = (each[name] for each in derivatives)
        for side in (value,) if name == "blade_distance" else (value, 1.0 - value):
            distances.append(side)
            slopes.append(by_fraction)
            changes.append(np.moveaxis(change[name], 0, -1))
    nearest = np.argmin(np.abs(distances), axis=0)
    if np.any(np.min(np.abs(distances), axis=0) > END_TOLERANCE):
        raise GeometryError(
            "a contact line ends at a hole of the flank, which has no derivative: use more grid nodes, or settings "
            "without undercut"
        )
    slope = np.take_along_axis(np.array(slopes), nearest[None, None], axis=0)[0]
    moved = np.take_along_axis(np.array(changes), nearest[None, ..., None], axis=0)[0]
    first, second = np.stack([roll[0], slope[0]]), np.stack([roll[1], slope[1]])
    return cramers_rule(first[..., None], second[..., None], -np.stack([turned, moved]))


STEP = 1e-5  # of the flank, and of the range of a field, in differences of smooth functions of the fields
#: What a segment has of its own; the depths follow from where both members are loaded.
NAMES = ("separation_angle", "lever_arm", "curvature", "overhang", "length", *DEPTHS)


@dataclass(frozen=True)
class EdgePieces:
    """Pieces of edges (n) in contact over a mesh cycle, in the order of their keys."""

    keys: Integers  # mesh position, tooth pair, edge and element (n, 4)

    @classmethod
    def of(cls, cases: Sequence[LoadedCase]) -> EdgePieces:
        """Those that carry load in any of the cases."""
        keys = [np.zeros((0, 4), dtype=np.int64)]
        for case in cases:
            keys.append(_keys(case)[(case.segments.edge >= 0) & (case.solution.force > 0.0)])
        return cls(np.unique(np.concatenate(keys), axis=0))

    def rows(self, case: LoadedCase) -> Integers:
        """Numbers of a case's segments (s) among the pieces; -1 where they are none of them."""
        number = {tuple(key): row for row, key in enumerate(self.keys.tolist())}
        return np.array([number.get(tuple(key), -1) for key in _keys(case).tolist()], dtype=np.int64)


def _keys(case: LoadedCase) -> Integers:
    segments, position = case.segments, np.full(case.segments.pair.size, case.mesh_position)
    return np.stack([position, segments.pair, segments.edge, segments.element], axis=1)


@dataclass(frozen=True)
class SegmentSlopes:
    """Derivatives of the segments of contact lines, and of pieces of edges after these (n), by settings (j)."""

    segments: CycleSegments
    pieces: EdgePieces
    slopes: dict[str, Array]  # (n, j); NaN where a setting takes a line away
    points: tuple[Array, Array]  # where pinion and gear are loaded (2, n, g), on the gear
    motion: tuple[Array, Array]
    steps: Array  # of settings (j), moving points and fields by some STEP of their ranges

    @classmethod
    def of(cls, segments: CycleSegments, directions: FieldDirections, pieces: EdgePieces | None) -> SegmentSlopes:
        """Derivatives of segments that move with their lines, which with ``pieces`` of edges go up to these."""
        known = pieces or EdgePieces(np.zeros((0, 4), dtype=np.int64))
        moving, mesh = segments if pieces is None else segments.to_edges, segments.on_lines.lines
        motion = line_motion(directions, mesh)
        reference, rotations = _loaded(segments, moving, known), line_rotations(moving.on_lines.lines)

        def moved(setting: int, step: float) -> dict[str, Array]:
            """Segments and pieces of edges after a step of one setting; NaN if they are not the same lines."""
            fields, points = directions.moved(setting, step), mesh.lines.points + step * motion.points[..., setting]
            lines = ContactLines(mesh.lines.level, points, mesh.lines.length + step * motion.length[:, setting])
            on_lines = replace(segments.on_lines, fields=fields, lines=replace(mesh, lines=lines))
            traced = replace(segments, fields=fields, on_lines=on_lines)
            stepped = traced.to_edges if moving.cut else traced
            if np.array_equal(rotations, line_rotations(stepped.on_lines.lines)):
                return _loaded(traced, stepped, known, segments.edges)
            return {name: np.nan * value for name, value in reference.items()}

        steps = STEP / np.maximum(_sizes(directions), np.max(np.abs(motion.points), axis=(0, 1, 2)))
        columns = []
        for j, step in enumerate(steps):
            ahead, behind = moved(j, step), moved(j, -step)
            columns.append({name: 0.5 / step * (ahead[name] - behind[name]) for name in reference})
        slopes = {name: np.stack([one[name] for one in columns], axis=-1) for name in reference}
        pinion, gear = (slopes.pop(member) for member in MEMBERS)
        return cls(moving, known, slopes, (reference["pinion"], reference["gear"]), (pinion, gear), steps)

    @property
    def places(self) -> tuple[Array, Array]:
        """Derivatives (2, n, j) of the segments' places on pinion and gear, the means of the points."""
        pinion, gear = (np.einsum("xngj,g->xnj", one, self.segments.on_lines.quadrature[1]) for one in self.motion)
        return pinion, gear

    def rows(self, case: LoadedCase) -> Integers:
        """Numbers of a case's segments (s) among these; -1 for pieces of edges that are not."""
        position = self.segments.on_lines.names["position"]
        of_pieces = self.pieces.rows(case)
        rows = np.where(of_pieces >= 0, position.size + of_pieces, -1)
        rows[case.segments.edge < 0] = np.flatnonzero(position == case.mesh_position)
        return rows


def _loaded(
    traced: CycleSegments, segments: CycleSegments, pieces: EdgePieces, near: Sequence[FlankEdge] | None = None
) -> dict[str, Array]:
    """Values (n) of segments ``segments`` by name, and the points (2, n, g) where ``pinion`` and ``gear`` are loaded.

    Pieces of edges, on the fields of ``traced``, come after them; ``near`` as of ``flank_edges``.
    """
    weights = segments.on_lines.quadrature[1]
    points = (one.reshape(2, -1, weights.size) for one in segments.loaded_places.points)
    values = {name: segments.table[name] for name in NAMES} | dict(zip(MEMBERS, points, strict=True))
    if not pieces.keys.size:
        return values
    position, pair, edge, element = pieces.keys.T
    mesh = traced.on_lines.lines
    rotation = mesh.rotations[position] - pair * mesh.pinion_pitch
    edges = traced.edges if near is None else flank_edges(traced.fields, near)
    elements = chosen_elements(traced.fields, rotation, edges, edge, element)
    there = pinion_points(traced.fields, elements.points, rotation), elements.points
    on_edges = {name: getattr(elements, name) for name in NAMES if name not in DEPTHS}
    on_edges |= loaded_at(LoadedPlaces(traced.fields, *there), traced.on_lines.teeth.solid)
    for member, one in zip(MEMBERS, there, strict=True):
        on_edges[member] = np.repeat(one[..., None], weights.size, axis=-1)
    return {name: np.concatenate([value, on_edges[name]], axis=int(name in MEMBERS)) for name, value in values.items()}


def _sizes(directions: FieldDirections) -> Array:
    """Greatest change (j) of any field by a unit of a setting, over the range of the field."""
    coefficients = directions.base.spline.coefficients
    span = np.ptp(coefficients, axis=(1, 2))
    change = np.abs(directions.slopes.spline.coefficients).max(axis=(1, 2)).reshape(len(coefficients), directions.count)
    return np.asarray(np.maximum((change / span[:, None]).max(axis=0), 1e-300))
