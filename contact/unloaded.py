"""Unloaded contact: transmission error of every tooth pair, its envelope, path of contact and contact-line ends.

Unloaded transmission error of every tooth pair, and of the pair that carries at any rotation of a mesh cycle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from ..core.arrays import Array, Integers
from ..core.attributes import flag_attributes, labelled
from ..core.checks import instance, positive
from ..core.errors import GeometryError
from ..geometry.pair.gear_pair import PairGeometry
from .lines.closest_approach import ClosestApproach, closest_approach
from .lines.contact_lines import ContactLines, between_points
from .lines.flank_splines import FlankSplines
from .lines.mesh_lines import MeshLines
from .lines.touching_points import GAP_LIMIT, TouchingPoints, least, refined, touching_points
from .lines.turned_flanks import BOUNDS, TurnedFlanks
from .loaded import continuous_range, harmonics, rms

ENVELOPE_REFINEMENT = 16  # rotations between two mesh positions at which the envelope is taken
NEIGHBOUR_DISTANCE_LIMIT = 0.2  # fraction of the flank; points farther apart do not belong to one course of the contact


@dataclass(frozen=True)
class PairErrors:
    """Gap of each tooth pair by itself, also of one before the first and one after the last, which may touch edges."""

    flanks: TurnedFlanks
    mesh: MeshLines
    pairs: Integers  # (p)
    touching: TouchingPoints  # (p * k), pair by pair

    @classmethod
    def of(cls, flanks: TurnedFlanks, mesh: MeshLines) -> PairErrors:
        """Search all tooth pairs at all rotations of a mesh cycle."""
        pairs = np.arange(mesh.pair.min() - 1, mesh.pair.max() + 2)
        turned = mesh.rotations[None, :] - pairs[:, None] * mesh.pinion_pitch
        return cls(flanks, mesh, pairs, touching_points(flanks, turned.ravel()))

    def table(self, values: Array) -> Array:
        """Values (..., p * k) as (p, k, ...)."""
        shape = (self.pairs.size, self.mesh.rotations.size)
        return np.asarray(np.moveaxis(values.reshape(*values.shape[:-1], *shape), (-2, -1), (0, 1)))

    @property
    def error(self) -> Array:
        """Gap of every tooth pair at every rotation (p, k), as a gear rotation [rad]; NaN where it has none."""
        return self.table(self.touching.gap)

    def fine_envelope(self) -> Array:
        """Smallest gap over all tooth pairs, at ENVELOPE_REFINEMENT times as many rotations [rad]."""
        count = self.mesh.rotations.size * ENVELOPE_REFINEMENT
        return self.envelope_at(np.arange(count) / count)

    def envelope_at(self, ahead: Array) -> Array:
        """Smallest gap over all pairs (m) [rad], at rotations (m) beyond the first, as fractions of a pitch.

        Contact is found anew wherever a pair may carry: kinks, at edges and transfers, lie between the mesh positions.
        """
        return self.carrying_at(ahead)[1].gap

    def carrying_at(self, ahead: Array) -> tuple[Integers, TouchingPoints]:
        """Number of the pair that carries (m) and its point of contact, at rotations as of ``envelope_at``."""
        course = self._course[0]
        before, share = self._between_positions(ahead[None, :], np.arange(self.pairs.size)[:, None])
        estimate, doubt = _between(course.gap, before, share)
        highest = np.min(np.where(np.isfinite(estimate), estimate + doubt, np.inf), axis=0)
        pair, place = np.nonzero(estimate - doubt <= highest)
        points = self.touching_at(pair, ahead[place])
        fine = np.where(np.isfinite(estimate), estimate, np.inf)
        fine[pair, place] = np.where(np.isfinite(points.gap), points.gap, fine[pair, place])
        number = np.full(fine.shape, -1)
        number[pair, place] = np.arange(pair.size)
        carrying, places = np.argmin(fine, axis=0), np.arange(ahead.size)
        index = number[carrying, places]
        touching = points.at(index) if pair.size else course.at(np.zeros(ahead.size, dtype=np.int64))
        touching.gap[:] = np.where(np.isfinite(fine[carrying, places]), fine[carrying, places], np.nan)
        lost = (index < 0) | ~np.isfinite(points.gap[index]) if pair.size else np.ones(ahead.size, dtype=bool)
        touching.points[:, lost] = np.nan
        return carrying, touching

    def touching_at(self, pair: Integers, ahead: Array) -> TouchingPoints:
        """Points of contact of given pairs (n), by their numbers, each at a rotation (n) as of ``envelope_at``."""
        before, share = self._between_positions(ahead, pair)
        return self._found(self._course[0], before, share, self.rotations_at(ahead, pair))

    def rotations_at(self, ahead: Array, pair: Integers) -> Array:
        """Pinion rotations [rad], counted as the roll angle of each pair, at rotations as of ``envelope_at``."""
        return np.asarray(self.mesh.rotations[0] + (ahead - self.pairs[pair]) * self.mesh.pinion_pitch)

    def _between_positions(self, ahead: Array, pair: Integers) -> tuple[Integers, Array]:
        """Elements of the course before places of pairs, and how far on towards the next."""
        turned, wanted = self._course[1], self.rotations_at(ahead, pair)
        before = np.clip(np.searchsorted(turned, wanted, side="right") - 1, 0, turned.size - 2)
        return before, np.clip((wanted - turned[before]) / (turned[before + 1] - turned[before]), 0.0, 1.0)

    @cached_property
    def _course(self) -> tuple[TouchingPoints, Array]:
        """Points of contact of all pairs in the order of their rotations, as of one pair, and these rotations."""
        turned = (self.mesh.rotations[None, :] - self.pairs[:, None] * self.mesh.pinion_pitch).ravel()
        order = np.argsort(turned)
        return self.touching.at(order), turned[order]

    def _found(self, course: TouchingPoints, before: Integers, share: Array, wanted: Array) -> TouchingPoints:
        """Points of contact (n) at rotations (n) from those of a course (m) between which they lie."""
        first, second = course.at(before), course.at(before + 1)
        near = np.max(np.abs(first.points - second.points), axis=0) < NEIGHBOUR_DISTANCE_LIMIT
        near &= first.part == second.part
        # One start between both neighbours, or one at each of them.
        shares = np.stack([np.where(near, share, 0.0), np.ones_like(share)])
        row = np.tile(np.arange(share.size), 2)
        kept = np.flatnonzero(np.concatenate([near | np.isfinite(first.gap), ~near & np.isfinite(second.gap)]))
        weight, row = shares.ravel()[kept], row[kept]

        def between(one: Array, other: Array) -> Array:
            mixed = one[:, row] * (1.0 - weight) + other[:, row] * weight
            return np.where(weight == 0.0, one[:, row], np.where(weight == 1.0, other[:, row], mixed))

        points = between(first.points, second.points)
        parameters = between(first.parameters, second.parameters)
        part = np.where(weight == 1.0, second.part[row], first.part[row])
        return least(refined(self.flanks, points, wanted[row], parameters, part), row, share.size)


def smallest(values: Array) -> Array:
    """Smallest value along the first axis, NaN where there is none."""
    minimum = np.where(np.isfinite(values), values, np.inf).min(axis=0)
    return np.where(np.isfinite(minimum), minimum, np.nan)


def _between(values: Array, before: Integers, share: Array) -> tuple[Array, Array]:
    """Values between those of a course (m), and by how much they may be wrong, at places after its elements (...)."""
    first, second = values[before], values[before + 1]
    middle = np.where(np.isfinite(first), first, second) * (1.0 - share)
    middle = middle + np.where(np.isfinite(second), second, first) * share
    steps = np.diff(values, prepend=np.nan, append=np.nan)
    bends = np.nan_to_num(np.abs(np.diff(steps)))
    either = np.maximum(bends[before], bends[before + 1])
    alone = np.isfinite(first) != np.isfinite(second)
    beside = np.fmax(np.abs(steps[before]), np.abs(steps[np.minimum(before + 2, steps.size - 1)]))
    return middle, np.where(alone, 2.0 * np.nan_to_num(beside), 0.5 * either)


#: Edges and, at the end of the blade's profile, where the flank ends as at its root.
FLANK_ENDS = (*BOUNDS[:8], "gear_root", "pinion_root")
PEAK_TOLERANCE = 0.02  # [urad]; between the estimated peak of a kink and the error there
CONTACT_EDGES = {-1: "no_contact", 0: "inside"} | {i + 1: name for i, name in enumerate(BOUNDS[:8])}


def _smallest(values: Array) -> tuple[Array, Array]:
    """Smallest value along the last axis (m), refined by a parabola, and its fractional index (m)."""
    index = np.argmin(values, axis=-1)
    middle = np.clip(index, 1, values.shape[-1] - 2)
    rows = np.arange(values.shape[0])
    left, centre, right = (values[rows, middle + shift] for shift in (-1, 0, 1))
    bend = left - 2.0 * centre + right
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.where(bend > 0.0, 0.5 * (left - right) / bend, 0.0)
    step = np.clip(np.where(index == middle, step, index - middle), -1.0, 1.0)
    value = centre + 0.5 * step * (right - left) + 0.5 * step**2 * bend
    return value, middle + step


def _line_ends(
    lines: ContactLines, closest: ClosestApproach, smallest: Array, where: Array, separation: float
) -> tuple[Array, Array, Array]:
    """Both ends (m, 2) of the contact lines within a separation [mm], as fractions, and their lengths (m) [mm]."""
    # Along the line the gap grows like a parabola: its root is nearly straight between two points.
    gap = (closest.separation_angle - smallest[:, None]) * closest.lever_arm
    excess = np.sqrt(np.maximum(gap, 0.0)) - separation**0.5
    count, rows = excess.shape[1], np.arange(smallest.size)
    start, place, wide = np.rint(where).astype(int)[:, None], np.arange(count), ~(excess <= 0.0)
    before = np.where(wide & (place < start), place, -1).max(axis=1)
    after = np.where(wide & (place > start), place, count).min(axis=1)
    ends = np.empty((2, rows.size))
    for side, (step, beyond) in enumerate(((-1, before), (1, after))):
        index = beyond - step
        last_excess, there = excess[rows, index], excess[rows, np.clip(beyond, 0, count - 1)]
        cut = (beyond >= 0) & (beyond < count) & (last_excess < 0.0)
        ends[side] = index + step * np.where(cut, -last_excess, 0.0) / np.where(cut, there - last_excess, 1.0)
    length = (ends[1] - ends[0]) / (count - 1) * lines.length
    points = between_points(lines.points, rows, ends.T)
    return points[0], points[1], length


def unloaded_contact(
    geometry: PairGeometry, splines: FlankSplines, mesh: MeshLines, *, separation: float = 6.0
) -> xr.Dataset:
    """Unloaded contact over one mesh cycle.

    A tooth pair touches where the gap between both flanks, as a gear rotation, is smallest: inside, or on an edge of
    either member. A pair without a contact line is listed where it comes as close as the pair that carries does
    anywhere.

    Parameters
    ----------
    geometry
        The pair, with the ease-off that the splines are made from.
    splines
        Splines from ``contact_lines.contact_splines``.
    mesh
        Contact lines from ``lines_in_mesh``.
    separation
        A contact line ends where the flanks are this far apart [um].

    Returns
    -------
    xr.Dataset
        Transmission error (pair, mesh_position) and envelope, which is there on a finer grid, too; path of contact with
        the edge it runs on, ends of the contact lines (Kolivand 2009, sections 2.5 and 2.6); attributes with peak to
        peak, harmonics and rms as in the dissertation's tables.

    Raises
    ------
    GeometryError
        If no tooth pair comes near contact at any rotation.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> unloaded = unloaded_contact(geometry, cycle.fields, cycle.lines, separation=5.0)
    >>> unloaded["transmission_error_envelope"].dims
    ('mesh_position',)
    """
    instance("geometry", geometry, PairGeometry)
    instance("splines", splines, FlankSplines)
    instance("mesh", mesh, MeshLines)
    positive("separation", separation, "um")
    errors = PairErrors.of(TurnedFlanks(geometry), mesh)
    error, touching, grid = errors.error, errors.touching, ("pair", "mesh_position")
    if not np.any(np.isfinite(error)):
        raise GeometryError(
            f"no tooth pair comes within {GAP_LIMIT:g} rad of contact at any rotation: are settings, blanks and "
            "misalignment right?"
        )
    envelope = smallest(error)
    line = _line_tables(splines, mesh, errors, 1e-3 * separation)
    listed = np.isfinite(error) & (np.isfinite(line["line_length"]) | (error <= np.nanmax(envelope)))
    edges = np.array([0, *(BOUNDS.index(name) + 1 for name in FLANK_ENDS)])[touching.bound + 1]
    tables = {
        "transmission_error": 1e6 * error,
        "path_lengthwise": errors.table(touching.points[0]),
        "path_profile": errors.table(touching.points[1]),
    }
    data: dict[str, Any] = {name: (grid, np.where(listed, table, np.nan)) for name, table in tables.items()}
    edge = np.where(listed, errors.table(edges), -1).astype(np.int8)
    data["contact_edge"] = (grid, edge, flag_attributes(CONTACT_EDGES))
    data |= {name: ((*grid, "end")[: table.ndim], table) for name, table in line.items()}
    carrying = errors.pairs[np.argmin(np.where(np.isfinite(error), error, np.inf), axis=0)]
    fine = 1e6 * errors.fine_envelope()
    amplitudes = harmonics(fine)
    dataset = xr.Dataset(
        {
            **data,
            "transmission_error_envelope": ("mesh_position", 1e6 * envelope),
            "fine_envelope": ("fine_position", fine),
            "carrying_pair": ("mesh_position", np.where(np.isfinite(envelope), carrying, np.nan)),
            "pinion_rotation": ("mesh_position", mesh.rotations),
        },
        coords={
            "pair": errors.pairs,
            "mesh_position": np.arange(mesh.rotations.size) / mesh.rotations.size,
            "fine_position": np.arange(fine.size) / fine.size,
        },
        attrs={
            "separation": separation,
            "attribute_units": "peak_to_peak, harmonics, rms: urad; separation: um",
            "peak_to_peak": continuous_range(fine, lambda ahead: 1e6 * errors.envelope_at(ahead), PEAK_TOLERANCE),
            "harmonics": amplitudes,
            "rms": rms(amplitudes),
        },
    )
    seen = np.any(listed | np.isfinite(line["line_length"]), axis=1)
    return labelled(dataset.isel(pair=np.flatnonzero(seen)))


def _line_tables(splines: FlankSplines, mesh: MeshLines, errors: PairErrors, separation: float) -> dict[str, Array]:
    """Ends of the contact lines within a separation [mm] (pair, position, end), and their lengths (pair, position)."""
    row = np.searchsorted(errors.pairs, mesh.pair)
    closest = closest_approach(splines, mesh.lines.points)
    least, index = _smallest(closest.separation_angle)
    error = errors.error[row, mesh.position]
    error = np.where(np.isfinite(error), error, least)
    ends_t, ends_h, length = _line_ends(mesh.lines, closest, error, index, separation)
    # A level set may come in several pieces; the one on which the flanks come closest speaks for its tooth pair.
    order = np.argsort(-least, kind="stable")
    tables = {}
    for name, values in (("line_lengthwise", ends_t), ("line_profile", ends_h), ("line_length", length)):
        table = np.full((*errors.error.shape, *values.shape[1:]), np.nan)
        table[row[order], mesh.position[order]] = values[order]
        tables[name] = table
    return tables
