"""Greatest load per length over stretches of a contact line, alike for segments and for cells of a pressure field.

At a point where a line runs into an edge a line load has no definite value: pieces of the edge are shorter than the
pressed strip is wide, and cells across the line are cut by it. A mean over a stretch as long as the strip is wide has
one: shorter than that, nothing acts as a line contact.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .flank_contact import FlankContact

Array = NDArray[Any]


def greatest_stretch_load(place: Array, length: Array, force: Array, stretch: float) -> float:
    """Greatest load per length over any stretch of a line [N/mm].

    Parameters
    ----------
    place, length
        Middles and lengths along the line of pieces (n), which may overlap [mm].
    force
        On the pieces, spread evenly over each (n) [N].
    stretch
        Length of the stretches [mm].

    Examples
    --------
    Two pieces of 1 mm side by side under 100 N and 300 N:

    >>> place, length, force = np.array([0.5, 1.5]), np.ones(2), np.array([100.0, 300.0])
    >>> [greatest_stretch_load(place, length, force, stretch) for stretch in (1.0, 2.0, 4.0)]
    [300.0, 200.0, 100.0]
    """
    loaded = np.flatnonzero(force > 0.0)
    if not loaded.size:
        return 0.0
    place, length, force = place[loaded], length[loaded], force[loaded]
    start, end = place - 0.5 * length, place + 0.5 * length
    # The load of a stretch is piecewise linear in its place, with kinks where either end meets an end of a piece.
    kinks = np.concatenate([start, end])
    first = np.concatenate([kinks, kinks - stretch])

    def load_before(places: Array) -> Array:
        return np.asarray(np.clip((places[:, None] - start) / length, 0.0, 1.0) @ force)

    return float(np.max(load_before(first + stretch) - load_before(first)) / stretch)


def stretch_load(contact: FlankContact, stretch: float) -> float:
    """Greatest load per length of a contact without the split over any stretch of its lines [N/mm]; zero if none.

    Examples
    --------
    >>> stretch_load(FlankContact(0.0, [], [], []), 1.0)
    0.0
    """
    found = [0.0]
    for direction, cells, force in zip(line_directions(contact), contact.cells, contact.force, strict=True):
        found.append(greatest_stretch_load(cells.position @ direction, cells.sides[:, 0], force, stretch))
    return max(found)


def line_directions(contact: FlankContact) -> list[Array]:
    """Unit vector (3) along the contact line of every tooth pair, in the gear's frame.

    Examples
    --------
    >>> line_directions(FlankContact(0.0, [], [], []))
    []
    """
    means = [cells.along.mean(axis=0) for cells in contact.cells]
    return [mean / np.linalg.norm(mean) for mean in means]
