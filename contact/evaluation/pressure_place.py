"""Place of the greatest pressure, whether a contact line ends there, and the greatest pressure away from line ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.ordered_values import ordered
from ...core.stored_status import StoredStatus
from ..lines.flank_splines import FlankSplines

Array = NDArray[Any]
LINE_END_SHARE = 0.1  # of a contact line, within which a segment counts as one at its end
BORDER_SHARE = 0.02  # of a flank, within which a point counts as one at its border
OVER = ("torque", "mesh_position", "segment")
EQUAL_LENGTH_TOLERANCE = 1e-9  # relative; the segments of a contact line are equally long


class LineEnd(StoredStatus):
    """Whether a contact line ends near a segment, and at which border of the common flank.

    Examples
    --------
    >>> LineEnd(0).name, LineEnd.PINION_TIP.value
    ('INSIDE', 8)
    """

    INSIDE = 0
    GEAR_TOE = 1
    GEAR_HEEL = 2
    GEAR_ROOT = 3
    GEAR_TIP = 4
    PINION_TOE = 5
    PINION_HEEL = 6
    PINION_ROOT = 7
    PINION_TIP = 8
    FILLET = 9
    UNKNOWN = 10


@dataclass(frozen=True)
class PressurePlace:
    """Place of the greatest pressure of a mesh cycle.

    Parameters
    ----------
    mesh_position
        Fraction of the mesh cycle.
    pair
        Tooth pair.
    point
        Lengthwise and profile fractions on the gear (2).
    line_end
        Whether the contact line ends there, or within ``LINE_END_SHARE`` of its length, or the flank within
        ``BORDER_SHARE``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=9)
    >>> loaded, _ = cycle.loaded([100.0], edge_contact=False)
    >>> PressurePlace.of(loaded.isel(torque=0), cycle.fields).line_end.name
    'PINION_TIP'
    """

    mesh_position: float
    pair: float
    point: Array
    line_end: LineEnd

    @classmethod
    def of(cls, at_torque: xr.Dataset, splines: FlankSplines) -> PressurePlace:
        """From the group ``/loaded`` at one torque, and splines from ``contact_lines.contact_splines``."""
        order = ("mesh_position", "segment")
        pressure = ordered(at_torque, "pressure", *order)
        if not np.any(pressure > 0.0):
            return cls(np.nan, np.nan, np.full(2, np.nan), LineEnd.UNKNOWN)
        position, segment = np.unravel_index(int(np.nanargmax(pressure)), pressure.shape)
        names = ("tooth", "length", "lengthwise", "profile")
        here = np.stack([ordered(at_torque, name, *order)[position] for name in names])
        on_line = np.isfinite(pressure[position])
        return cls(
            float(ordered(at_torque, "mesh_position", "mesh_position")[position]),
            float(here[0, segment]),
            here[2:, segment],
            _line_end(here, on_line, int(segment), splines),
        )


def _line_end(segments: Array, on_line: NDArray[np.bool_], number: int, splines: FlankSplines) -> LineEnd:
    """Border at which the line of a segment ends near it, from rows tooth, length, lengthwise, profile."""
    own, own_length = segments[:2, number]

    def beyond(sign: int) -> int:
        """Segments of the same line on one side."""
        other = number + sign
        while 0 <= other < on_line.size and on_line[other]:
            tooth, length = segments[:2, other]
            if tooth != own or abs(length - own_length) > EQUAL_LENGTH_TOLERANCE * own_length:
                break
            other += sign
        return abs(other - number) - 1

    sides = {sign: beyond(sign) for sign in (-1, 1)}
    sign = min(sides, key=lambda one: sides[one])
    if sides[sign] > LINE_END_SHARE * (1 + sum(sides.values())):
        # A line that cuts a corner of the flank is short: all of it is near its ends.
        here = segments[2:, number]
        return nearest_border(splines, here) if np.min(_margins(splines, here)) < BORDER_SHARE else LineEnd.INSIDE
    last = number + sign * sides[sign]
    point = segments[2:, last]
    if sum(sides.values()) > 0:
        point = point + 0.5 * (point - segments[2:, last - sign])
    return nearest_border(splines, point)


def nearest_border(splines: FlankSplines, point: Array) -> LineEnd:
    """Border of the common flank that is nearest to a point (2), in fractions.

    Parameters
    ----------
    splines
        Splines from ``contact_lines.contact_splines``.
    point
        Lengthwise and profile fractions on the gear.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> fields = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5).fields
    >>> nearest_border(fields, np.array([0.99, 0.5])).name
    'GEAR_HEEL'
    """
    blade = splines("blade_distance", np.clip(point, 0.0, 1.0)[:, None])
    return LineEnd(1 + int(np.argmin([*_margins(splines, point), *blade])))


def _margins(splines: FlankSplines, point: Array) -> Array:
    """Distances (8) of a point from the borders of both flanks, in fractions: toe, heel, root, tip of either."""
    point = np.clip(point, 0.0, 1.0)
    opposite = splines.evaluate(["pinion_lengthwise", "pinion_profile"], point[:, None]).values()
    on_both = np.array([*point, *(float(values[0]) for values in opposite)])
    return np.stack([on_both, 1.0 - on_both], axis=1).ravel()


def at_line_end(loaded: xr.Dataset) -> NDArray[np.bool_]:
    """Whether a segment is among the outer ones of its contact line, or at the border of the gear flank.

    Parameters
    ----------
    loaded
        The group ``/loaded``.

    Returns
    -------
    Array
        Over (torque, mesh_position, segment); those on no line are not.

    Examples
    --------
    >>> shape = ("torque", "mesh_position", "segment")
    >>> line = {"pressure": 500.0, "tooth": 0.0, "length": 1.0, "lengthwise": 0.5, "profile": 0.5}
    >>> loaded = xr.Dataset({name: (shape, np.full((1, 1, 5), value)) for name, value in line.items()})
    >>> at_line_end(loaded)[0, 0].tolist()
    [True, False, False, False, True]
    """
    pressure, tooth, length, lengthwise, profile = (
        ordered(loaded, name, *OVER) for name in ("pressure", "tooth", "length", "lengthwise", "profile")
    )
    on_line = np.isfinite(pressure)
    with np.errstate(invalid="ignore"):
        same = (tooth[..., 1:] == tooth[..., :-1]) & on_line[..., 1:] & on_line[..., :-1]
        same &= np.abs(length[..., 1:] - length[..., :-1]) <= EQUAL_LENGTH_TOLERANCE * length[..., 1:]
        margin = np.minimum(np.minimum(lengthwise, 1.0 - lengthwise), np.minimum(profile, 1.0 - profile))
    before, after = np.zeros(pressure.shape), np.zeros(pressure.shape)
    for number in range(same.shape[-1]):
        before[..., number + 1] = np.where(same[..., number], before[..., number] + 1.0, 0.0)
        back = same.shape[-1] - 1 - number
        after[..., back] = np.where(same[..., back], after[..., back + 1] + 1.0, 0.0)
    outer = np.minimum(before, after) <= LINE_END_SHARE * (1.0 + before + after)
    return np.asarray(on_line & (outer | (margin < BORDER_SHARE)))


def max_inner_pressure(loaded: xr.Dataset) -> Array:
    """Greatest pressure [MPa] away from the ends of the contact lines, over (torque); NaN where nothing carries there.

    Parameters
    ----------
    loaded
        The group ``/loaded``.

    Examples
    --------
    >>> import easeoff
    >>> loaded = easeoff.analyze("nasa-12x36", torques=[100.0])["loaded"].to_dataset()
    >>> bool(max_inner_pressure(loaded)[0] < loaded["max_pressure"].values[0])
    True
    """
    pressure = ordered(loaded, "pressure", *OVER)
    inner = np.where(np.isfinite(pressure) & ~at_line_end(loaded), pressure, -np.inf).max(axis=(1, 2))
    return np.where(inner > 0.0, inner, np.nan)
