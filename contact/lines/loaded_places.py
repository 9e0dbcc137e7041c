"""Where pinion and gear are loaded, with what line contact and bending both ask of these places."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...geometry.pair.gear_pair import MEMBERS
from .flank_splines import FlankSplines
from .tooth_ends import ToothEnds, tooth_ends

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class LoadedPlaces:
    """Points at which both members are loaded.

    Parameters
    ----------
    fields
        Splines from ``loaded_splines``.
    pinion, gear
        Where each is loaded (2, ...), as fractions on the gear, see ``opposite_points.pinion_points``.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact.loaded import loaded_splines
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    >>> places = LoadedPlaces(fields, *[np.full((2, 1), 0.5)] * 2)
    >>> [depth.round(1).tolist() for depth in places.depths]
    [[3.1], [3.1]]
    """

    fields: FlankSplines
    pinion: Array
    gear: Array

    @property
    def points(self) -> tuple[Array, Array]:
        """Those of pinion and gear."""
        return self.pinion, self.gear

    @cached_property
    def depths(self) -> list[Array]:
        """Distances of the mid-surfaces along the normal (...) [mm]; not positive next to a sharp edge."""
        return [self.fields(f"depth_{member}", one) for member, one in zip(MEMBERS, self.points, strict=True)]

    @cached_property
    def ends(self) -> list[ToothEnds]:
        """Toe and heel of either member."""
        return [tooth_ends(self.fields, member, one) for member, one in zip(MEMBERS, self.points, strict=True)]
