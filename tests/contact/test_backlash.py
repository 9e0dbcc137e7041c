"""Backlash: distance of the flanks of two teeth turned in space, conjugate flanks, thickness, shims, ISO 23509."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import xarray as xr
from pairs import conjugate_pair, hobbed_pair
from scipy.interpolate import CloughTocher2DInterpolator

from easeoff.cases import gear_pair, read_case
from easeoff.contact import MeshCycle
from easeoff.contact.backlash import ERRORS, backlash, backlash_unknown
from easeoff.contact.lines.mesh_lines import lines_at, mesh_rotations
from easeoff.contact.unloaded import unloaded_contact
from easeoff.core.errors import GeometryError
from easeoff.geometry import Misalignment, PairGeometry, pair_geometry
from easeoff.geometry.pair.gear_pair import FlankName, GearPair, tooth_angles
from easeoff.geometry.pair.tooth_thickness import filling_thickness, mean_thicknesses
from easeoff.geometry.tooth.tooth_flanks import placed_flanks
from easeoff.geometry.vectors import rotate_z

POSITIONS = 3


def with_thickness(pair: GearPair, thinner: float) -> GearPair:
    """The pair with the pinion's tooth thinner than the gear's slot admits [mm], both thicknesses given."""
    thicknesses = filling_thickness(pair) - thinner, mean_thicknesses(pair)[1]
    pinion, gear = (
        replace(m, mean_thickness=float(s)) for m, s in zip((pair.pinion, pair.gear), thicknesses, strict=True)
    )
    return replace(pair, pinion=pinion, gear=gear)


@cache
def played(pair: GearPair) -> tuple[xr.Dataset, PairGeometry, xr.Dataset]:
    geometry = pair_geometry(pair, (15, 11))
    unloaded = MeshCycle.of(geometry, mesh_positions=POSITIONS, segments_per_line=1).unloaded()
    return backlash(geometry, unloaded), geometry, unloaded


def contact_angle(pair: GearPair, turn: float, sides: tuple[str, str], sense: float) -> float:
    """Rotation of the gear, in a sense, at which its flank meets the pinion's, turned about its axis [rad].

    Points of the pinion's flanks are put into space; the gear's flank is interpolated between its points.
    """
    angles, assembly = tooth_angles(pair), pair.assembly
    t, h = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, 61), np.linspace(0, 1, 31), indexing="ij"))
    points, gear = (
        placed_flanks(member, angle)[side].at(*member.section.points(t, h)).position  # type: ignore[index]
        for member, angle, side in zip((pair.pinion, pair.gear), angles, sides, strict=True)
    )
    radius, azimuth = np.hypot(gear[0], gear[1]), np.unwrap(np.arctan2(gear[1], gear[0]))
    flank = CloughTocher2DInterpolator(np.stack([gear[2], radius], axis=1), azimuth)
    least = np.inf
    for tooth in range(-3, 4):
        angle = turn + tooth * assembly.pinion_pitch
        turned = assembly.pinion_frame @ rotate_z(np.full(points.shape[1], angle), points)
        x, y, z = turned + (assembly.pinion_origin - assembly.gear_origin)[:, None]
        apart = np.arctan2(y, x) - flank(np.stack([z, np.hypot(x, y)], axis=1))
        apart = sense * (apart + tooth * assembly.pinion_pitch / assembly.ratio)
        least = min(least, float(np.nanmin(apart, initial=np.inf)))
    return least


@pytest.mark.parametrize(("name", "flank"), [("nasa-12x36", "drive"), ("fh-design-a", "coast")])
def test_flanks_turned_in_space_touch_where_the_backlash_is_used_up(name: str, flank: FlankName) -> None:
    """At three mesh positions, misaligned, without the ease-off: teeth are turned until both their sides touch."""
    errors = Misalignment(offset=-0.03, pinion_axial=0.1, gear_axial=0.05, shaft_angle=2e-4)
    pair = with_thickness(gear_pair(read_case(name), flank), 0.2).misaligned(errors)
    play, geometry, unloaded = played(pair)
    motion = geometry.exact.motion
    loaded, other = (("concave", "convex"), ("convex", "concave"))[:: 1 if flank == "drive" else -1]
    pitch = pair.assembly.pinion_pitch / pair.assembly.ratio
    for number, rolled in enumerate(unloaded["pinion_rotation"].values):
        turn = motion.pinion_sense * (rolled + motion.center)
        both = contact_angle(pair, turn, loaded, motion.pinion_sense) + contact_angle(
            pair, turn, other, -motion.pinion_sense
        )
        found = 1e-6 * float(play["backlash_rotation"][number])
        assert np.mod(both - found + pitch / 2, pitch) - pitch / 2 == pytest.approx(0.0, abs=8e-6)
        assert found > 2e-4


@pytest.mark.parametrize("pair", [conjugate_pair(), conjugate_pair("right", coast=True), hobbed_pair("left")])
def test_conjugate_flanks_have_one_backlash_at_every_position(pair: GearPair) -> None:
    """It is what the pinion's tooth is thinner than the slot that it fills, as an angle of the gear."""
    thinner = 0.2
    play, _, _ = played(with_thickness(pair, thinner))
    per_angle = mean_thicknesses(pair)[0] / tooth_angles(pair)[0]
    wanted = 1e6 * thinner / per_angle / pair.assembly.ratio
    np.testing.assert_allclose(play["backlash_rotation"].values, wanted, rtol=1e-6)


def test_thickness_taken_off_is_backlash() -> None:
    """Of the gear exactly, at every position; the pinion's other flank meets another part of its mate, too."""
    pair = with_thickness(gear_pair(read_case("nasa-12x36")), 0.2)
    play = played(pair)[0]["outer_normal_backlash"].values
    # The thickness is given mid-flank, where the pinion is thicker than on the pitch cone of the derivative.
    wanted = -0.05 * float(played(pair)[0]["backlash_by_thickness"])
    for name, spread in (("gear", 1e-9), ("pinion", 0.02)):
        member = getattr(pair, name)
        thinner = replace(pair, **{name: replace(member, mean_thickness=member.mean_thickness - 0.05)})
        gained = played(thinner)[0]["outer_normal_backlash"].values - play
        np.testing.assert_allclose(gained, gained.mean(), rtol=spread)
        assert gained.mean() == pytest.approx(wanted, rel=0.05)


def test_shims_change_the_backlash_by_its_derivatives() -> None:
    """Central differences at one rotation of the pinion; positions where both sides touch inside of their flanks."""
    pair = with_thickness(gear_pair(read_case("fh-design-a")), 0.2)
    play, geometry, _ = played(pair)
    pitch = pair.assembly.pinion_pitch
    rotations = mesh_rotations(pitch, POSITIONS) + geometry.exact.motion.center

    def at_same_rotations(errors: Misalignment) -> np.ndarray:
        moved = pair_geometry(pair.misaligned(errors), (15, 11))
        fields = MeshCycle.of(moved, mesh_positions=1, segments_per_line=1).fields
        mesh = lines_at(fields, pitch, rotations - moved.exact.motion.center)
        return np.asarray(backlash(moved, unloaded_contact(moved, fields, mesh))["outer_normal_backlash"])

    for name in ERRORS:
        step = 1e-4 if name == "shaft_angle" else 0.005
        ahead, behind = (at_same_rotations(Misalignment(**{name: way * step})) for way in (1.0, -1.0))
        wanted = play[f"backlash_by_{name}"].values
        np.testing.assert_allclose(((ahead - behind) / (2.0 * step))[1:], wanted[1:], rtol=1e-3)


def test_reasons_why_it_is_not_known() -> None:
    pair = gear_pair(read_case("nasa-12x36"))
    assert "thickness of the teeth of the pinion" in backlash_unknown(pair)
    alone = replace(pair, pinion=replace(pair.pinion, opposite=None))
    assert "other flank of the pinion" in backlash_unknown(alone)
    geometry = pair_geometry(pair, (9, 7))
    with pytest.raises(GeometryError, match="not known: the thickness"):
        backlash(geometry, xr.Dataset())
