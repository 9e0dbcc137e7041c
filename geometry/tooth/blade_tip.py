"""Height of a blade's tip above the root cone at the bottom of the slot that it cuts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from .tooth_surface import FILLET_NODES, tooth_side

Array = NDArray[Any]

SIDE_NODES = 5  # up the flank, of which the lower end is used
TOE_MIDDLE_HEEL = np.array([0.0, 0.5, 1.0])


def tip_gap(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Height of a blade's tip above the root cone at toe, middle and heel (3) [mm].

    Negative where it cuts deeper, NaN where the flank is undercut or missing.

    Parameters
    ----------
    surface
        Generating surface of the flank.
    section
        The blank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> gear = gear_pair(read_case("nasa-12x36")).gear
    >>> bool(np.all(np.abs(tip_gap(gear.loaded, gear.section)) < 1e-3))
    True
    """
    try:
        side = tooth_side(surface.designed, section, tuple(TOE_MIDDLE_HEEL.tolist()), SIDE_NODES, FILLET_NODES)
    except GeometryError:
        return np.full(TOE_MIDDLE_HEEL.size, np.nan)
    lowest = side.fillet[:, :, 0]
    return section.height_above_root(lowest[2], np.hypot(lowest[0], lowest[1]))
