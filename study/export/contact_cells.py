"""Contact segments of a mesh position as strips in the tangent plane of the gear flank, and the pressure under them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.lines.flank_splines import FlankSplines, fit
from ...core.attributes import ordered
from ...geometry.pair.gear_pair import MEMBERS
from ...geometry.tooth.tooth_flanks import MemberName

Array = NDArray[np.float64]
Index = NDArray[np.int64]

#: Values of a segment in a file, by the name there: group, variable and factor.
SEGMENT_VALUES = {
    "pressure [MPa]": ("loaded", "pressure"),
    "force [N]": ("loaded", "force"),
    "half width [mm]": ("loaded", "half_width"),
    "film thickness [um]": ("friction", "film_thickness"),
    "lambda ratio [1]": ("friction", "lambda_ratio"),
    "friction coefficient [1]": ("friction", "friction_coefficient"),
    "sliding velocity [m/s]": ("friction", "sliding_velocity"),
    "flash temperature [K]": ("friction", "flash_temperature"),
}
LOAD_PER_LENGTH, CONTACT_TEMPERATURE = "load per length [N/mm]", "contact temperature [degC]"
SHARP_HALF_WIDTH = 0.05  # [mm] of a segment on a sharp edge, whose contact has no width
LENGTH_TOLERANCE = 1e-9  # relative, between the segments of a line


@dataclass(frozen=True)
class Segments:
    """Loaded segments at a mesh position.

    Parameters
    ----------
    points
        Fractions of their middles on the gear flank (2, n).
    tooth
        Numbers of their tooth pairs (n).
    line
        Numbers of their contact lines (n).
    length, half_width
        Size [mm] (n) each.
    values
        Values (n) by name in a file.
    """

    points: Array
    tooth: Index
    line: Index
    length: Array
    half_width: Array
    values: dict[str, Array]


def loaded_segments(at_position: xr.Dataset, friction: xr.Dataset | None) -> Segments:
    """Loaded segments of the group ``loaded`` at one torque and mesh position, with friction at one condition."""
    force = np.nan_to_num(ordered(at_position, "force", "segment"))
    chosen = np.flatnonzero(force > 0.0)
    tooth, length = (ordered(at_position, name, "segment") for name in ("tooth", "length"))
    known = np.nan_to_num(np.stack([tooth, length]))
    new = (known[0][1:] != known[0][:-1]) | (np.abs(np.diff(known[1])) > LENGTH_TOLERANCE * known[1][1:])
    line = np.concatenate([[0], np.cumsum(new)]).astype(np.int64)
    groups = {"loaded": at_position} | ({} if friction is None else {"friction": friction})
    values = {
        name: ordered(groups[group], variable, "segment")[chosen]
        for name, (group, variable) in SEGMENT_VALUES.items()
        if group in groups and variable in groups[group]
    }
    values[LOAD_PER_LENGTH] = force[chosen] / length[chosen]
    if "flash temperature [K]" in values and friction is not None:
        values[CONTACT_TEMPERATURE] = values["flash temperature [K]"] + float(friction["bulk_temperature"])
    width = ordered(at_position, "half_width", "segment")[chosen]
    return Segments(
        np.stack([ordered(at_position, name, "segment")[chosen] for name in ("lengthwise", "profile")]),
        tooth[chosen].astype(np.int64),
        line[chosen],
        length[chosen],
        np.where(width > 0.0, width, SHARP_HALF_WIDTH),
        values,
    )


def flank_positions(flanks: xr.Dataset, member: MemberName) -> FlankSplines:
    """Spline ``position`` [mm] of a member's flank, in its own frame, over its own fractions."""
    position = ordered(flanks, "position", "member", "lengthwise", "profile", "xyz")[MEMBERS.index(member)]
    return fit(flanks["lengthwise"].values, flanks["profile"].values, {"position": position})


def strip_corners(segments: Segments, splines: FlankSplines) -> Array:
    """Corners (n, 4, 3) [mm] of the strips on the gear flank, in its frame.

    Parameters
    ----------
    segments
        The segments.
    splines
        Of ``flank_positions``.
    """
    middle = splines("position", segments.points).T
    first, second = (splines("position", segments.points, order).T for order in ((1, 0), (0, 1)))
    normal = np.cross(first, second)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = _directions(middle, segments.line, first)
    along -= np.sum(along * normal, axis=1, keepdims=True) * normal
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = np.cross(normal, along) * segments.half_width[:, None]
    ahead = along * (0.5 * segments.length)[:, None]
    return np.stack(
        [middle - ahead - across, middle + ahead - across, middle + ahead + across, middle - ahead + across], axis=1
    )


def _directions(middle: Array, line: Index, default: Array) -> Array:
    """Directions (n, 3) of the contact lines at the middles (n, 3) of their segments."""
    found = default.copy()
    for number in np.unique(line):
        own = np.flatnonzero(line == number)
        if own.size > 1:
            found[own] = np.gradient(middle[own], axis=0)
    return found


def band_pressure(points: Array, strips: Array, pressure: Array) -> Array:
    """Hertzian pressure [MPa] at points (m, n, 3) of a flank under strips.

    Parameters
    ----------
    points
        Nodes of the flank [mm].
    strips
        Corners of the strips (k, 4, 3) [mm].
    pressure
        Greatest pressure of the strips (k) [MPa]; NaN for none.

    Returns
    -------
    Array
        Pressure (m, n), zero beside the strips.

    Examples
    --------
    >>> strip = np.array([[[-1.0, -0.2, 0.0], [1.0, -0.2, 0.0], [1.0, 0.2, 0.0], [-1.0, 0.2, 0.0]]])
    >>> line = np.array([[[0.0, 0.0, 0.0], [0.0, 0.12, 0.0], [0.0, 0.3, 0.0]]])
    >>> band_pressure(line, strip, np.array([1000.0])).round(9).tolist()
    [[1000.0, 800.0, 0.0]]
    """
    from scipy.spatial import cKDTree

    flat = points.reshape(-1, 3)
    found = np.zeros(len(flat))
    tree = cKDTree(flat)
    middle = strips.mean(axis=1)
    along, across = 0.5 * (strips[:, 1] - strips[:, 0]), 0.5 * (strips[:, 3] - strips[:, 0])
    reach = np.linalg.norm(along, axis=1) + np.linalg.norm(across, axis=1)
    for k in np.flatnonzero(np.isfinite(pressure)):
        near = np.array(tree.query_ball_point(middle[k], 1.01 * reach[k]), dtype=np.int64)
        if not near.size:
            continue
        away = flat[near] - middle[k]
        u = away @ along[k] / (along[k] @ along[k])
        v = away @ across[k] / (across[k] @ across[k])
        within = np.abs(u) <= 1.0
        value = pressure[k] * np.sqrt(np.maximum(1.0 - v**2, 0.0))
        np.maximum.at(found, near[within], value[within])
    return found.reshape(points.shape[:2])
