"""Contact ratio: rotation over which one tooth pair is in contact, over the angular pitch (ISO 1122-1, total ratio).

The same number is the mean of how many pairs are in contact at the same time. The *geometric* ratio counts the whole
rotation over which a pair has contact lines: conjugate flanks, or any pair under a load without limit, have it. Without
load one pair carries at a time; counted are rotations at which the pair comes within a separation. Under load a pair is
in contact where it carries.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.ordered_values import ordered
from ..lines.flank_splines import FlankSplines
from ..solvers import Status
from .carrying_error import CarryingError
from .tooth_passage import tooth_passage

Array = NDArray[Any]
PATH = ("path_lengthwise", "path_profile")


def unloaded_contact_ratio(
    splines: FlankSplines, unloaded: xr.Dataset, error: CarryingError, limits: tuple[float, float], separation: float
) -> float:
    """Contact ratio without load: where a pair is no further apart than a separation, measured along the normal.

    NaN if the pair's transmission error is not known.

    Parameters
    ----------
    splines
        Splines from ``contact_lines.contact_splines``.
    unloaded
        The group ``/unloaded``.
    error
        Transmission error of the pair, from ``unloaded``.
    limits
        From ``MeshCycle.roll_limits``.
    separation
        Widest gap that counts as contact [um].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=5)
    >>> unloaded = cycle.unloaded()
    >>> error = CarryingError.of(unloaded, cycle.pinion_pitch)
    >>> [round(unloaded_contact_ratio(cycle.fields, unloaded, error, cycle.roll_limits, s), 1) for s in (1e-6, 1e6)]
    [1.0, 2.6]
    """
    if not error.is_known:
        return float("nan")
    places = np.stack([ordered(unloaded, n, "pair", "mesh_position") for n in PATH], axis=-1)
    passage = tooth_passage(unloaded["pair"].values, places)
    known = np.all(np.isfinite(passage.values), axis=1)
    arms = splines("lever_arm", np.clip(passage.values[known].T, 0.0, 1.0))
    steps = error.steps
    rotation = error.rotation(steps)
    ahead = error.of_pair(rotation) - error.least(rotation)
    margin = separation - 1e3 * ahead * np.interp(steps, passage.steps[known], arms)
    return contact_time(steps, margin, error.step(np.array(limits))) / passage.per_cycle


def loaded_contact_ratio(at_torque: xr.Dataset, limits: Array) -> float:
    """Contact ratio under load; NaN if a mesh position has no certified solution.

    Parameters
    ----------
    at_torque
        The group ``/loaded`` at one torque.
    limits
        From ``MeshCycle.roll_limits``, in steps of the mesh cycle (2).

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> ratio = loaded_contact_ratio(tree["loaded"].to_dataset().isel(torque=0), np.array([-40.0, 30.0]))
    >>> 1.0 < ratio < 2.0
    True
    """
    order = ("mesh_position", "segment")
    names = ("tooth", "separation", "lever_arm")
    tooth, separation, arm = (ordered(at_torque, name, *order) for name in names)
    turned = 1e-6 * ordered(at_torque, "transmission_error", "mesh_position")
    pairs = ordered(at_torque, "pair", "pair")
    if not np.all(ordered(at_torque, "status", "mesh_position") == Status.CERTIFIED):
        return float("nan")
    with np.errstate(divide="ignore", invalid="ignore"):
        met = separation / arm
    # A pair carries where the rotation exceeds the least one that closes a gap of it.
    least = np.stack([np.where(tooth == pair, met, np.inf).min(axis=1) for pair in pairs])
    passage = tooth_passage(pairs, np.where(np.isfinite(least), turned - least, np.nan))
    return contact_time(passage.steps, passage.values, limits) / passage.per_cycle


def contact_time(time: Array, margin: Array, limits: Array) -> float:
    """Time over which a margin is positive, straight between its values; NaN where there is no contact line.

    At either end of the values contact goes on to where the margin leads to zero, or to the time at which the contact
    lines end, at most one unit.

    Parameters
    ----------
    time
        Times (n), evenly spaced, by one or less.
    margin
        Values (n).
    limits
        First and last time (2) with a contact line.

    Examples
    --------
    >>> contact_time(np.arange(4.0), np.array([-1.0, 1.0, 0.5, np.nan]), np.array([0.0, 2.4]))
    1.9
    """
    total, spacing = 0.0, float(time[1] - time[0])
    known = np.concatenate([[False], np.isfinite(margin), [False]])
    for first, beyond in np.flatnonzero(np.diff(known.astype(np.int8))).reshape(-1, 2):
        value, at = margin[first:beyond], time[first:beyond]
        low, high = np.minimum(value[:-1], value[1:]), np.maximum(value[:-1], value[1:])
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(low >= 0.0, 1.0, np.where(high > 0.0, high / (high - low), 0.0))
        total += spacing * float(np.sum(share))
        for sign, end, before, limit in ((-1.0, 0, 1, limits[0]), (1.0, -1, -2, limits[1])):
            if not value[end] > 0.0:
                continue
            fall = value[before] - value[end] if value.size > 1 else 0.0
            way = min(1.0, spacing * float(value[end] / fall)) if fall > 0.0 else 1.0
            left = sign * float(limit - at[end])
            total += min(way, left) if left >= 0.0 else way
    return total
