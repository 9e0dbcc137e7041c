"""Backlash: dense points of the pinion's tooth, turned through the gear's slot, touch both of its flanks."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline

from easeoff.cases import gear_pair, read_case
from easeoff.geometry.pair.backlash import circular_backlash, filling_thickness
from easeoff.geometry.pair.gear_pair import GearPair, Member, thickness_per_angle, tooth_angles
from easeoff.geometry.tooth.tooth_flanks import PlacedFlank, placed_flanks, side

Array = NDArray[Any]
NODES = (41, 27)
#: On both flanks in one position.
LEAST_POINTS = 100


def both_sides(member: Member, angle: float) -> list[PlacedFlank]:
    """The loaded flank and the other one of a tooth."""
    placed = placed_flanks(member, angle)
    loaded = placed.pop(side(member.loaded))
    return [loaded, *placed.values()]


def points(member: Member, flank: PlacedFlank) -> Array:
    """Points (3, nt, nh) of a flank; NaN where it is undercut."""
    t, h = (np.linspace(0.0, 1.0, n) for n in NODES)
    axial, radial = member.section.points(*(each.ravel() for each in np.meshgrid(t, h, indexing="ij")))
    return flank.at(axial, radial).position.reshape(3, *NODES)


def measured_backlash(pair: GearPair, turns: Array) -> float:
    """Normal circular backlash at the gear [mm], by pinion points in single positions of the pinion."""
    assembly, pitch = pair.assembly, 2.0 * np.pi / pair.gear.teeth
    angles = tooth_angles(pair)
    teeth, slots = (both_sides(m, a) for m, a in zip((pair.pinion, pair.gear), angles, strict=True))
    gaps = []
    for tooth, slot in zip(teeth, slots, strict=True):
        wall = points(pair.gear, slot)
        azimuth = np.unwrap(np.unwrap(np.arctan2(wall[1], wall[0]), axis=0), axis=1)
        spline = RectBivariateSpline(np.linspace(0.0, 1.0, NODES[0]), np.linspace(0.0, 1.0, NODES[1]), azimuth)
        middle = slot.at(*pair.gear.section.points(np.array([0.5]), np.array([0.5])))
        out = np.sign(middle.position[0] * middle.normal[1] - middle.position[1] * middle.normal[0])
        own = points(pair.pinion, tooth).reshape(3, -1)
        own = own[:, np.all(np.isfinite(own), axis=0)]
        nearest = []
        for turn in turns:
            c, s = np.cos(turn), np.sin(turn)
            turned = np.stack([c * own[0] - s * own[1], s * own[0] + c * own[1], own[2]])
            seen = assembly.pinion_frame @ turned + (assembly.pinion_origin - assembly.gear_origin)[:, None]
            t, h = pair.gear.section.fractions(seen[2], np.hypot(seen[0], seen[1]))
            on = (t >= 0.0) & (t <= 1.0) & (h >= 0.0) & (h <= 1.0)
            if np.count_nonzero(on) < LEAST_POINTS:
                continue
            apart = np.arctan2(seen[1], seen[0])[on] - spline(t[on], h[on], grid=False) + turn / assembly.ratio
            nearest.append(np.min(out * (np.mod(apart - apart[0] + np.pi, 2.0 * np.pi) - np.pi + apart[0])))
        gaps.append(min(np.mod(each - nearest[0] + pitch / 2.0, pitch) + nearest[0] for each in nearest))
    both = np.mod(sum(gaps) + pitch / 2.0, pitch) - pitch / 2.0
    return float(both) * thickness_per_angle(pair.gear)


@pytest.mark.parametrize(("name", "thinner"), [("fm-11x41", 0.3), ("nasa-12x36", 0.1), ("fh-design-a", 0.0)])
def test_backlash_is_that_of_points_in_the_slot(name: str, thinner: float) -> None:
    """Within what edges, and positions 0.025 rad apart, differ from the smooth least ease-off."""
    pair = gear_pair(read_case(name))
    pair = replace(pair, pinion=replace(pair.pinion, mean_thickness=filling_thickness(pair) - thinner))
    found = circular_backlash(pair)
    assert found == pytest.approx(measured_backlash(pair, np.linspace(-1.2, 1.2, 97)), abs=0.006)
    shares = thickness_per_angle(pair.gear) / thickness_per_angle(pair.pinion) / pair.assembly.ratio
    assert found == pytest.approx(thinner * shares, abs=1e-9)


def test_backlash_is_the_same_from_both_sides() -> None:
    pair = gear_pair(read_case("nasa-12x36"))
    other = gear_pair(read_case("nasa-12x36"), "coast")
    angles = [circular_backlash(each) / thickness_per_angle(each.gear) for each in (pair, other)]
    assert angles[0] == pytest.approx(angles[1], abs=1e-9)
