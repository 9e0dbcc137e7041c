"""Distance of the blades' tips from the root cones at toe, middle and heel, with derivatives by settings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.attributes import ordered
from ....geometry.design.root_line import RootLine
from ....geometry.pair.gear_pair import GearPair, Member
from ....geometry.pair.near_pair import PairSetting, is_angle
from .aim import Reading

Array = NDArray[np.float64]

#: Change of the root line that a search may make unless told otherwise, over the height of the flank.
USUAL_CHANGE_RATIO = 0.01
DIMENSIONS = ("member", "root_place")
MEMBERS, PLACES = ["pinion", "gear"], ["toe", "middle", "heel"]
#: Weight of the distances in a correction [um/mm]: a tenth of that of the ease-off.
TIP_WEIGHT = 100.0


def blade_tip_gaps(pair: GearPair) -> xr.DataArray:
    """Distances of the blades' tips above the root cones of the loaded flanks [mm], negative where they cut deeper.

    Returns
    -------
    xr.DataArray
        The distances (member, root_place), NaN where the flank ends before.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> blade_tip_gaps(gear_pair(read_case("nasa-12x36"))).dims
    ('member', 'root_place')
    """
    flanks = [(member.loaded.designed, member.section) for member in _both(pair)]
    gaps = [RootLine.of(surface, section).gap(surface)[0] for surface, section in flanks]
    return xr.DataArray(gaps, {"member": MEMBERS, "root_place": PLACES}, DIMENSIONS)


def blade_tip_slopes(pair: GearPair, settings: Sequence[tuple[str, PairSetting]]) -> xr.DataArray:
    """Derivatives of the distances by machine and cutter settings.

    Parameters
    ----------
    pair
        The pair.
    settings
        The settings (n) with their names.

    Returns
    -------
    xr.DataArray
        The derivatives (member, root_place, setting) per mm or degree.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> chosen = [("base", PairSetting("pinion", "sliding_base"))]
    >>> change = blade_tip_slopes(gear_pair(read_case("nasa-12x36")), chosen)
    >>> change.sel(member="pinion", root_place="middle").values.round(2).tolist()
    [1.0]
    """
    change = np.zeros((len(MEMBERS), len(PLACES), len(settings)))
    for row, (name, member) in enumerate(zip(MEMBERS, _both(pair), strict=True)):
        surface = member.loaded.designed
        _, line = RootLine.of(surface, member.section).gap(surface)
        for column, (_, setting) in enumerate(settings):
            if setting.of == name:
                step = setting.scale
                behind, ahead = (_both(setting.moved(pair, sign * step))[row].loaded.designed for sign in (-1.0, 1.0))
                factor = math.radians(1.0) if is_angle(setting) else 1.0
                change[row, :, column] = factor * line.change(surface, behind, ahead) / (2.0 * step)
    over = {"member": MEMBERS, "root_place": PLACES, "setting": [name for name, _ in settings]}
    return xr.DataArray(change, over, (*DIMENSIONS, "setting"))


def _both(pair: GearPair) -> tuple[Member, Member]:
    return pair.pinion, pair.gear


@dataclass(frozen=True, eq=False)
class BladeTips:
    """Distances of the blades' tips from the root cones in an analysis with derivatives, weighted.

    Parameters
    ----------
    value
        At their places (p), times ``TIP_WEIGHT``.
    slopes
        Their derivatives (p, n) by the settings.
    """

    value: Array
    slopes: Array

    @classmethod
    def of(cls, reading: Reading) -> BladeTips:
        """Those of an analysis."""
        value = ordered(reading.values, "blade_tip_gap", *DIMENSIONS).ravel()
        slopes = ordered(reading.slopes, "blade_tip_gap", *DIMENSIONS, "setting").reshape(value.size, -1)
        return cls(TIP_WEIGHT * value, TIP_WEIGHT * slopes)

    def missed(self, pair: GearPair, step: Array) -> Array:
        """What another pair lacks of the distances (p) after a step (n) to first order; zero where either is unknown.

        Raises GeometryError if a cutter meets no tooth.
        """
        found = TIP_WEIGHT * ordered(blade_tip_gaps(pair).to_dataset(name="gap"), "gap", *DIMENSIONS).ravel()
        return np.nan_to_num(self.value + self.slopes @ step - found)


def usual_root_line_change(pairs: Sequence[GearPair]) -> float:
    """Limit of the change of the root line [mm]: a share of the lower flank's height in its middle."""
    heights = []
    for pair in pairs:
        for member in _both(pair):
            axial, radial = member.section.points(np.array([0.5, 0.5]), np.array([0.0, 1.0]))
            heights.append(math.hypot(axial[1] - axial[0], radial[1] - radial[0]))
    return USUAL_CHANGE_RATIO * min(heights)
