"""The mates of the tips: where the tip of a member's tooth runs along no flank of the other member."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array
from ..cutting.generating_surface import SurfacePoints
from ..flanks.flank import Flank, NodeStatus, pick, solve_flank
from .ease_off import conjugate_motion, exact_ease_off
from .gear_pair import GearPair

TIP_NODES = 41  # along a tip
NOT_CUT = (NodeStatus.NO_SOLUTION, NodeStatus.UNDERCUT, NodeStatus.BEYOND_BLADE_TIP)


def unmet_tips(pair: GearPair) -> tuple[float, float]:
    """Shares of the tips of pinion and gear, within the mate's face, that meet no flank cut by the mate's cutter.

    A generated flank ends above the root cone, where the blade's tip leaves it: harmless unless the mate's tip comes so
    far, as where the flank is undercut or its fillet too high.
    """
    # With the middle of the gear's flank, which meets the pinion; its tip need not.
    t, half_way_and_tip = np.linspace(0.0, 1.0, TIP_NODES), np.array([0.5, 1.0])
    gear, section = pair.gear.flank(t, half_way_and_tip), pair.gear.section
    pinion_tip = pair.pinion.flank(t, np.ones(1))
    ease_off = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    place = _conjugate_place(pair, pinion_tip)
    lengthwise, _ = section.fractions(*place)
    known = np.isfinite(lengthwise)
    status = np.zeros(TIP_NODES, dtype=np.int8)
    if np.any(known):
        status[known] = solve_flank(pair.gear.loaded, section, *place[:, known]).status
    tip = slice(1, None, 2)
    of_gear = _share(gear.status[tip], ease_off.status[tip], ease_off.pinion_lengthwise[tip])
    return _share(pinion_tip.status, status, lengthwise), of_gear


def _conjugate_place(pair: GearPair, tip: Flank) -> Array:
    """Axial and radial coordinate (2, n) [mm] of the gear's points that are conjugate to those of the pinion."""
    middle = pair.gear.section.points(np.array([0.5]), np.array([0.5]))[:, 0]
    motion = conjugate_motion(pair.pinion.loaded.on("profile"), pair.pinion.section, pair.assembly, middle)
    places = []
    with np.errstate(all="ignore"):
        for part in pair.pinion.loaded.flank_parts:
            on_part = replace(motion, surface=part)
            places.append(on_part.conjugate_place(SurfacePoints.of(part, tip.parameters))[0])
    return pick(places, tip.part)


def _share(tip: NDArray[np.int8], status: NDArray[np.int8], lengthwise: Array) -> float:
    """Share of the mates of a tip, by the status of both, that are not cut; those beyond the face do not count."""
    beyond = (lengthwise < 0.0) | (lengthwise > 1.0)
    counted = ~beyond & ~np.isin(tip, NOT_CUT)
    return float(np.mean(np.isin(status[counted], NOT_CUT))) if np.any(counted) else 0.0
