"""Relative motion of the members: its six parts, and the change of the gap by each, against geometries moved so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_mirror import mirrored

from easeoff.cases import gear_pair, read_case
from easeoff.contact.supports.mesh_wrench import MeshWrenches
from easeoff.contact.supports.relative_motion import PARTS, RelativeMotion, moved
from easeoff.geometry import FlankName, GearPair, Misalignment, PairGeometry, pair_geometry

#: About which the parts are: not small, so that the map is that of the assembly as it stands.
ERRORS = Misalignment(0.05, -0.03, 0.02, 0.001)
PAIRS = [("fm-11x41", False), ("fm-11x41", True), ("nasa-12x36", False)]


def moved_pair(name: str, mirror: bool, flank: FlankName) -> GearPair:
    pair = gear_pair(read_case(name), flank).misaligned(ERRORS)
    return mirrored(pair) if mirror else pair


def motion_of(geometry: PairGeometry) -> RelativeMotion:
    motion = geometry.exact.motion
    return RelativeMotion(motion.assembly, motion.pinion_sense)


@pytest.mark.parametrize(
    ("name", "mirror", "flank"),
    [("fm-11x41", True, "drive"), ("nasa-12x36", False, "drive"), ("fm-11x41", False, "coast")],
)
def test_gap_changes_by_the_wrenches_as_in_moved_geometries(name: str, mirror: bool, flank: FlankName) -> None:
    """Central differences of the ease-off: their error falls with the square of the step."""
    geometry = pair_geometry(moved_pair(name, mirror, flank), (9, 7))
    wrenches = MeshWrenches.of(geometry)
    slopes = wrenches.flank @ motion_of(geometry).twists / wrenches.lever_arm[:, None]
    for number, part in enumerate(PARTS[:4]):
        errors = []
        for step in np.array([0.04, 0.02]) * (0.01 if part == "shaft_angle" else 1.0):
            angles = []
            for sense in (1.0, -1.0):
                parts = sense * step * np.eye(6)[number]
                angles.append(geometry.misaligned(moved(ERRORS, parts)).exact.angle[geometry.exact.inside])
            errors.append(np.nanmax(np.abs((angles[0] - angles[1]) / (2.0 * step) - slopes[:, number])))
        assert errors[1] < 1e-6 * np.abs(slopes[:, number]).max()
        assert abs(np.log2(errors[0] / errors[1]) - 2.0) < 0.01


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize(("name", "mirror"), PAIRS)
def test_rotations_move_the_gap_by_the_lever_arms(name: str, mirror: bool, flank: FlankName) -> None:
    """A gear rotation opens it by the lever arm, one of the pinion closes it by that over the ratio."""
    geometry = pair_geometry(moved_pair(name, mirror, flank), (9, 7))
    wrenches, ratio = MeshWrenches.of(geometry), geometry.pair.assembly.ratio
    slopes = wrenches.flank @ motion_of(geometry).twists / wrenches.lever_arm[:, None]
    np.testing.assert_allclose(slopes[:, PARTS.index("gear_rotation")], 1.0, atol=1e-12)
    np.testing.assert_allclose(slopes[:, PARTS.index("pinion_rotation")], -1.0 / ratio, atol=1e-12)


@pytest.mark.parametrize(("name", "mirror"), PAIRS)
def test_parts_are_the_derivatives_of_the_assembly(name: str, mirror: bool) -> None:
    """Points of the pinion and of the gear move by the twist as their frames do."""
    pair = moved_pair(name, mirror, "drive")
    motion = RelativeMotion(pair.assembly, 1.0)
    point = np.array([[12.0], [-35.0], [80.0]])
    twists = motion.twists
    there, _ = pair.assembly.pinion_to_global(point, point)
    for number, part in enumerate(PARTS[:4]):
        step = 1e-4
        ends = []
        for sense in (1.0, -1.0):
            assembly = replace(pair.assembly, misalignment=moved(ERRORS, sense * step * np.eye(6)[number]))
            of_pinion, _ = assembly.pinion_to_global(point, point)
            ends.append(of_pinion - (assembly.gear_origin[:, None]))
        found = (ends[0] - ends[1])[:, 0] / (2.0 * step)
        expected = twists[:3, number] + np.cross(twists[3:, number], there[:, 0])
        np.testing.assert_allclose(found, expected, atol=1e-5, err_msg=part)


def test_twist_and_parts_are_each_other_s_inverse() -> None:
    motion = RelativeMotion(moved_pair("fm-11x41", False, "drive").assembly, -1.0)
    parts = np.random.default_rng(3).normal(size=(2, 5, 6))
    np.testing.assert_allclose(motion.parts(motion.twist(parts)), parts, atol=1e-10)
