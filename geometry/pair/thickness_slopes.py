"""Thickness of the teeth in the middle of the flank, and its derivatives by settings.

Most settings leave it as it is: the other flank of a tooth stands where the thickness puts it. Where a gear is cut from
one set-up its cutter leaves the tooth, and the pinion's is as thick as the slot is wide.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .gear_pair import GearPair, thickness_per_angle, tooth_angles
from .pair_setting import PairSetting

Array = NDArray[Any]

STEP_SHARE = 1e-3  # of the usual step of a setting


def mean_thicknesses(pair: GearPair) -> Array:
    """Normal circular thickness (2) of the teeth of pinion and gear in the middle of the flank [mm].

    Raises
    ------
    GeometryError
        If a cutter meets no tooth of its blank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> mean_thicknesses(gear_pair(read_case("nasa-12x36"))).round(2).tolist()
    [5.27, 5.87]
    """
    per_angle = [thickness_per_angle(member) for member in (pair.pinion, pair.gear)]
    return np.array(tooth_angles(pair)) * per_angle


def thickness_slopes(pair: GearPair, settings: Sequence[PairSetting]) -> Array:
    """Derivatives (2, j) [mm] of the thicknesses of pinion and gear, by mm, rad or the unit of the setting.

    Parameters
    ----------
    pair
        The pair.
    settings
        By what to differentiate (j).

    Raises
    ------
    GeometryError
        As ``mean_thicknesses``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> by_radius = [PairSetting("gear", "point_radius"), PairSetting("pinion", "point_radius")]
    >>> slopes = thickness_slopes(gear_pair(read_case("nasa-12x36")), by_radius)
    >>> bool(slopes[1, 0] > 0.5), bool(abs(slopes[1, 1]) < 1e-9)
    (True, True)
    """
    slopes = np.zeros((2, len(settings)))
    for number, setting in enumerate(settings):
        if setting.of in ("pinion", "gear"):
            step = STEP_SHARE * setting.scale
            ahead, behind = (mean_thicknesses(setting.moved(pair, sign * step)) for sign in (1.0, -1.0))
            slopes[:, number] = (ahead - behind) / (2.0 * step)
    return slopes
