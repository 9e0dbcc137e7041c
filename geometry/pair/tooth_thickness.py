"""Thickness of the teeth in the middle of the flank and at the mean point, and its derivatives by settings.

Most settings leave it as it is: the other flank of a tooth stands where the thickness puts it. Where a gear is cut from
one set-up its cutter leaves the tooth, and the pinion's is as thick as the slot is wide.

The backlash is the rotation of the gear between contact on the drive side and contact on the coast side. Both sides
have their ease-off in the position in which the machines cut the flanks. Its least value is where the flanks first
touch; the thickness of the teeth turns the flanks of the other side.

Tips of either member that run along no flank of the other have no mate there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array
from ...core.errors import GeometryError
from ..cutting.generating_surface import SurfacePoints
from ..flanks.flank import Flank, NodeStatus, on_parts, solve_flank
from .assembly import Misalignment
from .ease_off import conjugate_motion, exact_ease_off
from .gear_pair import GearPair, Member, grid, spiral_cosine, thickness_per_angle, tooth_angles
from .near_pair import PairSetting

STEP_SHARE = 1e-3  # of the usual step of a setting
TOUCH_TOLERANCE = 0.02  # of the cone distance: pitch cones further apart do not touch
GAP_LIMIT = 0.005  # likewise: 3e-4 in pairs of the literature, whose angles are rounded
MODULE_LIMIT = 0.02  # 1e-3 in shipped pairs; a tooth more or less is 2 % of fifty
STEP_COUNT = 30  # of Newton's method: five do, from the plane of the axes


def mean_cone_distances(pair: GearPair, *, must_touch: bool = False) -> tuple[float, float]:
    """Cone distances of pinion and gear [mm] at the mean point: mid face of the gear, and where pitch cones touch.

    Misalignment is not used. Cones that do not touch are refused if ``must_touch``; else the pinion's is mid face, too.
    """
    distances, apart = _mean_point(pair)
    if must_touch and not abs(apart) < TOUCH_TOLERANCE * distances[1]:
        raise GeometryError(f"the pitch cones of pinion and gear are {abs(apart):.2f} mm apart, not in touch")
    return distances


def _mean_point(pair: GearPair) -> tuple[tuple[float, float], float]:
    """Cone distances of pinion and gear at the mean point, and how far their pitch cones are apart there [mm]."""
    distance, apart = _nearest(pair)
    gear = pair.gear.section.middle_distance
    return (distance if abs(apart) < TOUCH_TOLERANCE * gear else pair.pinion.section.middle_distance, gear), apart


def _nearest(pair: GearPair) -> tuple[float, float]:
    """Cone distance at which the pinion's pitch cone is nearest to the gear's mid face, and the gap there [mm]."""
    pinion, gear = pair.pinion.section, pair.gear.section
    nominal = replace(pair.assembly, misalignment=Misalignment())
    axial, radial = gear.on_pitch_cone(gear.middle_distance)
    axis = nominal.pinion_frame[:, 2]
    centre = nominal.gear_origin - nominal.pinion_origin + np.array([0.0, 0.0, axial])
    sine, cosine = math.sin(pinion.pitch_angle), math.cos(pinion.pitch_angle)
    azimuth = math.atan2(axis[1], axis[0])
    for _ in range(STEP_COUNT):
        arm = radial * np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        tangent = np.array([-arm[1], arm[0], 0.0])
        point = centre + arm
        along = float(point @ axis)
        out = float(np.linalg.norm(point - along * axis))
        # Half the square of ``out`` and its derivatives by the azimuth give those of ``out``.
        slope = float(point @ tangent - along * (tangent @ axis)) / out
        square = float(tangent @ tangent - point @ arm - (tangent @ axis) ** 2 + along * (arm @ axis))
        first = slope * cosine - float(tangent @ axis) * sine
        second = (square - slope**2) / out * cosine + float(arm @ axis) * sine
        if not second > 0.0:
            return math.nan, math.nan
        azimuth -= first / second
    return math.hypot(along + pinion.pitch_apex, out), out * cosine - (along + pinion.pitch_apex) * sine


def contradictions(pair: GearPair) -> list[str]:
    """Contradictions of pitch cones, axes, tooth numbers and flanks of a pair, a sentence each.

    Pitch cones touch at the mean point, and teeth that mesh there have one normal module. Misalignment is not used.
    """
    sentences = []
    assembly = pair.assembly
    distances, apart = _mean_point(pair)
    if not abs(apart) <= GAP_LIMIT * distances[1]:
        far = f"are {abs(apart):.2f} mm apart" if math.isfinite(apart) else "do not come near each other"
        sentences.append(
            f"the pitch cones of pinion and gear {far} in the middle of the face, where they should touch: check pitch "
            f"angles and apexes, shaft_angle = {math.degrees(assembly.shaft_angle):.6g} and hypoid_offset = "
            f"{assembly.hypoid_offset:.6g}"
        )
    try:
        module, mate = (
            2.0 * _normal_arc(member, mean_flanks(member, distance)) / member.teeth
            for member, distance in zip((pair.pinion, pair.gear), distances, strict=True)
        )
    except GeometryError:
        return sentences  # an analysis says so of the flanks
    if abs(module - mate) > MODULE_LIMIT * max(module, mate):
        sentences.append(
            f"the mean normal module is {module:.3f} mm at the pinion and {mate:.3f} mm at the gear: check the tooth "
            "numbers, the pitch cones and the settings that make the spiral angles"
        )
    return sentences


def mid_flank_thickness(member: Member, mean_normal_thickness: float, distance: float) -> float:
    """Normal circular thickness [mm] in the middle of the flank of a tooth that has the given one at the mean point.

    That is s_mn of ISO 23509:2016 on the pitch cone, at the cone distance [mm]; the member's own is not used.
    """
    per_angle, thicker = _at_mean_point(member, distance)
    return (mean_normal_thickness / per_angle - thicker) * thickness_per_angle(member)


def mean_normal_thickness(member: Member, mid_flank_thickness: float, distance: float) -> float:
    """Inverse of ``mid_flank_thickness``: s_mn of ISO 23509:2016 [mm]. Takes and raises what that does."""
    per_angle, thicker = _at_mean_point(member, distance)
    return (mid_flank_thickness / thickness_per_angle(member) + thicker) * per_angle


def _at_mean_point(member: Member, distance: float) -> tuple[float, float]:
    """Normal arc per angle on the pitch cone [mm/rad], and by what angle the tooth is thicker there than mid-flank."""
    front, back = flanks = mean_flanks(member, distance)
    turn, middle = member.middle_angle()
    if not math.isfinite(middle):
        raise GeometryError("a flank does not pass through the middle of its blank")
    ends = [math.atan2(flank.position[1, 0], flank.position[0, 0]) for flank in (front, back)]
    return _normal_arc(member, flanks), math.remainder(turn * (ends[1] - ends[0]) - middle, 2.0 * math.pi)


def mean_flanks(member: Member, distance: float) -> list[Flank]:
    """The loaded flank and the other one at the mean point, one node each."""
    axial, radial = member.section.on_pitch_cone(distance)[:, None]
    flanks = [solve_flank(surface, member.section, axial, radial) for surface in (member.loaded, member.other)]
    if not all(np.isfinite(flank.position).all() for flank in flanks):
        raise GeometryError("a flank does not pass through the mean point of its blank")
    return flanks


def _normal_arc(member: Member, flanks: list[Flank]) -> float:
    """Normal arc per angle [mm/rad] at the mean spiral angle of both flanks, one node each."""
    radius = np.hypot(*flanks[0].position[:2, 0])
    return float(radius * np.cos(np.mean([np.arccos(spiral_cosine(flank, member.section)) for flank in flanks])))


def mean_thicknesses(pair: GearPair) -> Array:
    """Normal circular thickness (2) of the teeth of pinion and gear in the middle of the flank [mm]."""
    return np.array(tooth_angles(pair)) * [thickness_per_angle(member) for member in (pair.pinion, pair.gear)]


def thickness_slopes(pair: GearPair, settings: Sequence[PairSetting]) -> Array:
    """Derivatives (2, j) [mm] of the thicknesses of pinion and gear, by mm, rad or the unit of the setting."""
    slopes = np.zeros((2, len(settings)))
    for number, setting in enumerate(settings):
        if setting.of in ("pinion", "gear"):
            step = STEP_SHARE * setting.scale
            ahead, behind = (mean_thicknesses(setting.moved(pair, sign * step)) for sign in (1.0, -1.0))
            slopes[:, number] = (ahead - behind) / (2.0 * step)
    return slopes


NODES = (31, 21)


def filling_thickness(pair: GearPair) -> float:
    """Normal circular thickness of the pinion's tooth in the middle of its flank [mm] that leaves no backlash.

    The gear's is that of ``gear_pair.tooth_angles``; both members need both flanks.
    """
    other = replace(pair, pinion=pair.pinion.from_opposite, gear=pair.gear.from_opposite)
    sides = [
        exact_ease_off(side.gear.flank(*grid(NODES)), side.pinion.loaded, side.pinion.section, side.assembly)
        for side in (pair, other)
    ]
    touching = sum(float(side.angle[side.inside].min()) for side in sides)
    turn, as_cut = pair.gear.middle_angle()
    gear_rotation = turn * (tooth_angles(pair)[1] - as_cut)
    # Each side touches where the gear is turned by its least ease-off against its own sense of drive.
    rotation = -pair.assembly.ratio * (gear_rotation + sides[0].motion.pinion_sense * touching)
    turn, as_cut = pair.pinion.middle_angle()
    angle = float(np.mod(as_cut + turn * rotation, 2.0 * np.pi / pair.pinion.teeth))
    return angle * thickness_per_angle(pair.pinion)


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
    of_gear = _share(gear.status[1::2], ease_off.status[1::2], ease_off.pinion_lengthwise[1::2])  # the tips among them
    return _share(pinion_tip.status, status, lengthwise), of_gear


def _conjugate_place(pair: GearPair, tip: Flank) -> Array:
    """Axial and radial coordinate (2, n) [mm] of the gear's points that are conjugate to those of the pinion."""
    middle = pair.gear.section.points(np.array([0.5]), np.array([0.5]))[:, 0]
    motion = conjugate_motion(pair.pinion.loaded.on("profile"), pair.pinion.section, pair.assembly, middle)
    with np.errstate(all="ignore"):
        return on_parts(
            pair.pinion.loaded.flank_parts,
            tip.part,
            tip.parameters,
            lambda part, p: replace(motion, surface=part).conjugate_place(SurfacePoints.of(part, p))[0],
        )


def _share(tip: NDArray[np.int8], status: NDArray[np.int8], lengthwise: Array) -> float:
    """Share of the mates of a tip, by the status of both, that are not cut; those beyond the face do not count."""
    counted = ~((lengthwise < 0.0) | (lengthwise > 1.0)) & ~np.isin(tip, NOT_CUT)
    return float(np.mean(np.isin(status[counted], NOT_CUT))) if np.any(counted) else 0.0
