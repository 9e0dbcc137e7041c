"""Lines of a solved contact without the split: the greatest pressure and the line load of every loaded station."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...geometry.flanks.blank_section import BlankSection
from ...geometry.pair.gear_pair import GearPair
from ...geometry.tooth.tooth_flanks import MemberName
from ...geometry.tooth.tooth_lattice import LatticeSize
from .flank_contact import FlankContact
from .flank_response import THROUGH_BRICKS

Array = NDArray[Any]
BRICKS_PER_MILLIMETRE = 0.55  # along the face
FEWEST_BRICKS, MOST_BRICKS = 24, 32  # along the face
THIN_BRICKS = 4  # of these


@frozen_arrays
@dataclass(frozen=True)
class LineStations:
    """Stations (n) across the contact lines that carry load.

    Parameters
    ----------
    tooth
        Tooth pair.
    lengthwise, profile
        Place of the greatest pressure, as fractions on the gear.
    pressure
        Greatest pressure [MPa].
    line_load
        Force per length of the line [N/mm].
    edge_distance
        Distance from toe, heel and tip of either member [mm].

    Examples
    --------
    >>> one = np.ones(1)
    >>> LineStations(one, one, one, one, one, one).table.shape
    (6, 1)
    """

    tooth: Array
    lengthwise: Array
    profile: Array
    pressure: Array
    line_load: Array
    edge_distance: Array

    @property
    def table(self) -> Array:
        """All of them as rows (6, n)."""
        parts = (self.tooth, self.lengthwise, self.profile, self.pressure, self.line_load, self.edge_distance)
        return np.stack(parts)


def line_stations(pair: GearPair, contact: FlankContact) -> LineStations:
    """Stations of a solved contact.

    Parameters
    ----------
    pair
        The pair.
    contact
        From ``contact_of_flanks``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> line_stations(pair, FlankContact(0.0, [], [], [])).pressure.size
    0
    """
    columns = []
    for tooth, cells, force in zip(contact.pairs, contact.cells, contact.force, strict=True):
        pressure = force / cells.area
        for station in np.unique(cells.station[force > 0.0]):
            own = np.flatnonzero(cells.station == station)
            top = own[np.argmax(pressure[own])]
            load = float(pressure[own] @ cells.sides[own, 1])
            place = cells.gear_fractions[:, top]
            edge = min(
                edge_distance(pair.gear.section, place),
                edge_distance(pair.pinion.section, cells.pinion_fractions[:, top]),
            )
            columns.append((tooth, *place, pressure[top], load, edge))
    return LineStations(*np.array(columns).T.reshape(6, -1))


def edge_distance(section: BlankSection, place: Array) -> float:
    """Distance of a place (2), as fractions, from toe, heel and tip of its flank [mm].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> edge_distance(gear_pair(read_case("nasa-12x36")).gear.section, np.array([0.5, 1.0]))
    0.0
    """
    corners = section.corners
    height = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1) @ np.array([1.0 - place[0], place[0]])
    length = np.linalg.norm(corners[1, 1] - corners[0, 1])
    return float(min(place[0] * length, (1.0 - place[0]) * length, (1.0 - place[1]) * height))


def response_size(pair: GearPair, member: MemberName, *, finer: bool = False) -> LatticeSize:
    """Bricks of a tooth for its response: more than those of the analysis, thin ones at its ends, or many more.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> response_size(gear_pair(read_case("nasa-12x36")), "gear").lengthwise
    24
    """
    one = getattr(pair, member)
    trace = one.flank(np.linspace(0.0, 1.0, 17), np.array([0.5])).position
    length = float(np.linalg.norm(np.diff(trace, axis=1), axis=0).sum())
    along = int(np.clip(round(BRICKS_PER_MILLIMETRE * length) + THIN_BRICKS, FEWEST_BRICKS, MOST_BRICKS))
    usual = LatticeSize(lengthwise=along, upward=13, through=len(THROUGH_BRICKS))
    return replace(usual, lengthwise=usual.lengthwise + 8, upward=17, slot=3) if finer else usual
