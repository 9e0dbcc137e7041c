"""Unloaded contact: transmission error of every tooth pair, its envelope, path of contact and contact-line ends."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from ..core.attributes import labelled
from .harmonics import harmonics, peak_to_peak, rms
from .lines.closest_approach import ClosestApproach, closest_approach
from .lines.contact_lines import ContactLines
from .lines.flank_splines import FlankSplines
from .lines.mesh_lines import MeshLines

Array = NDArray[Any]
ENVELOPE_REFINEMENT = 16  # rotations between two mesh positions at which the envelope is taken


def _smallest(values: Array) -> tuple[Array, Array]:
    """Smallest value along the last axis (m), refined by a parabola, and its fractional index (m)."""
    index = np.argmin(values, axis=-1)
    middle = np.clip(index, 1, values.shape[-1] - 2)
    rows = np.arange(values.shape[0])
    left, here, right = (values[rows, middle + shift] for shift in (-1, 0, 1))
    bend = left - 2.0 * here + right
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.where(bend > 0.0, 0.5 * (left - right) / bend, 0.0)
    step = np.clip(np.where(index == middle, step, index - middle), -1.0, 1.0)
    value = here + 0.5 * step * (right - left) + 0.5 * step**2 * bend
    return value, middle + step


def _at(values: Array, index: Array) -> Array:
    """Values (..., m, s) at fractional indices (m), linearly."""
    low = np.clip(index.astype(int), 0, values.shape[-1] - 2)
    rows = np.arange(index.size)
    weight = index - low
    return np.asarray(values[..., rows, low] * (1 - weight) + values[..., rows, low + 1] * weight)


def _line_ends(
    lines: ContactLines, closest: ClosestApproach, smallest: Array, where: Array, separation: float
) -> tuple[Array, Array, Array]:
    """Both ends (m, 2) of the contact lines within a separation [mm], as fractions, and their lengths (m) [mm]."""
    # Along the line the gap grows like a parabola: its root is nearly straight between two points.
    gap = (closest.separation_angle - smallest[:, None]) * closest.lever_arm
    excess = np.sqrt(np.maximum(gap, 0.0)) - separation**0.5
    count = excess.shape[1]
    ends = np.empty((2, smallest.size))
    for side, step in enumerate((-1, 1)):
        for row in range(smallest.size):
            index = round(float(where[row]))
            while 0 <= index + step < count and excess[row, index + step] <= 0.0:
                index += step
            beyond = index + step
            if 0 <= beyond < count and excess[row, index] < 0.0:
                share = -excess[row, index] / (excess[row, beyond] - excess[row, index])
                ends[side, row] = index + step * share
            else:
                ends[side, row] = index
    length = (ends[1] - ends[0]) / (count - 1) * lines.length
    points = np.stack([_at(lines.points, ends[side]) for side in range(2)], axis=-1)
    return points[0], points[1], length


def _fine_envelope(errors: Array) -> Array:
    """Error of the pair that carries, at ENVELOPE_REFINEMENT times as many rotations as the errors (pair, position).

    One tooth pair's error is a smooth function of its rotation, known over several pitches; the kink where the next
    pair takes over, and with it the peak to peak, lies between the mesh positions.
    """
    pairs, positions = errors.shape
    # Pair p at position k has turned k - p * positions steps beyond the followed pair's start.
    step = (np.arange(positions)[None, :] - np.arange(pairs)[:, None] * positions).ravel()
    order = np.argsort(step)
    step, error = step[order], errors.ravel()[order]
    known = np.isfinite(error)
    single = PchipInterpolator(step[known], error[known], extrapolate=False)
    fine = np.arange(positions * ENVELOPE_REFINEMENT) / ENVELOPE_REFINEMENT
    candidates = np.stack([single(fine - p * positions) for p in range(pairs)])
    return _least(candidates)


def _least(values: Array) -> Array:
    """Smallest value along the first axis, NaN where there is none."""
    least = np.where(np.isfinite(values), values, np.inf).min(axis=0)
    return np.where(np.isfinite(least), least, np.nan)


def unloaded_contact(splines: FlankSplines, mesh: MeshLines, *, separation: float = 6.0) -> xr.Dataset:
    """Unloaded contact over one mesh cycle.

    Parameters
    ----------
    splines
        Splines from ``contact_lines.contact_splines``.
    mesh
        Contact lines from ``lines_in_mesh``.
    separation
        A contact line ends where the flanks are this far apart [um].

    Returns
    -------
    xr.Dataset
        Transmission error (pair, mesh_position) and envelope, path of contact, ends of the contact lines (Kolivand
        2009, sections 2.5 and 2.6); attributes with peak to peak, harmonics and rms as in the dissertation's tables.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> unloaded = unloaded_contact(cycle.fields, cycle.lines, separation=5.0)
    >>> unloaded["transmission_error_envelope"].dims
    ('mesh_position',)
    """
    lines, position, pair = mesh.lines, mesh.position, mesh.pair
    mesh_positions = mesh.rotations.size
    closest = closest_approach(splines, lines.points)
    error, index = _smallest(closest.separation_angle)
    # At the flank's edge the contact stays on the edge.
    at_edge = (index <= 0.0) | (index >= lines.points.shape[2] - 1)
    point = _at(lines.points + np.where(at_edge[:, None], 0.0, closest.shift), index)
    ends_t, ends_h, length = _line_ends(lines, closest, error, index, 1e-3 * separation)

    pairs = np.unique(pair)
    shape = (pairs.size, mesh_positions)
    row = np.searchsorted(pairs, pair)
    # A level set may come in several pieces; the one that touches first speaks for its tooth pair.
    order = np.argsort(-error, kind="stable")
    values = {
        "transmission_error": 1e6 * error,
        "path_lengthwise": point[0],
        "path_profile": point[1],
        "line_length": length,
    }
    grid = ("pair", "mesh_position")
    data: dict[str, Any] = {}
    for name, value in values.items():
        table = np.full(shape, np.nan)
        table[row[order], position[order]] = value[order]
        data[name] = (grid, table)
    for name, ends in (("line_lengthwise", ends_t), ("line_profile", ends_h)):
        table = np.full((*shape, 2), np.nan)
        table[row[order], position[order]] = ends[order]
        data[name] = ((*grid, "end"), table)
    errors = data["transmission_error"][1]
    envelope = _least(errors)
    carrying = np.where(
        np.isfinite(envelope), pairs[np.argmin(np.where(np.isfinite(errors), errors, np.inf), axis=0)], np.nan
    )
    fine = _fine_envelope(errors)
    amplitudes = harmonics(fine)
    dataset = xr.Dataset(
        {
            **data,
            "transmission_error_envelope": ("mesh_position", envelope),
            "carrying_pair": ("mesh_position", carrying),
            "pinion_rotation": ("mesh_position", mesh.rotations),
        },
        coords={"pair": pairs, "mesh_position": np.arange(mesh_positions) / mesh_positions},
        attrs={
            "separation": separation,
            "attribute_units": "peak_to_peak, harmonics, rms: urad; separation: um",
            "peak_to_peak": peak_to_peak(fine),
            "harmonics": amplitudes,
            "rms": rms(amplitudes),
        },
    )
    return labelled(dataset)
