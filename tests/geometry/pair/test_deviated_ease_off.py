"""The ease-off of deviating flanks: identities of the update, and the flanks themselves as its judge."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from deviations import GEAR_ERRORS, PINION_ERRORS, worn
from numpy.typing import NDArray
from pairs import conjugate_pair
from runs import small

import easeoff
from easeoff import InputError
from easeoff.cases import gear_pair
from easeoff.geometry import (
    Deviation,
    GearPair,
    Member,
    PairGeometry,
    deviation_from_formula,
    pair_geometry,
    principal_curvatures,
)
from easeoff.geometry.cutting.blade import Relief
from easeoff.geometry.cutting.named_settings import get_setting, with_settings
from easeoff.geometry.deviation.deviated_flank import deviated_ease_off, deviated_member, deviated_pair
from easeoff.geometry.newton import complex_steps
from easeoff.geometry.pair.ease_off import EaseOff, drift, exact_ease_off, relative_velocity, rolling
from easeoff.geometry.pair.gear_pair import grid
from easeoff.verification.envelope_condition import distance_along_normals

Array = NDArray[np.float64]
Formula = Callable[[Array, Array], Array]
NODES = (15, 11)


@cache
def case_pair() -> GearPair:
    return gear_pair(easeoff.read_case("fm-11x41"), "drive")


@cache
def designed(pair: GearPair) -> PairGeometry:
    return pair_geometry(pair, NODES)


def absolute(ease_off: xr.Dataset) -> Array:
    """Ease-off as a gear rotation, without a zero of its own [rad]."""
    return np.asarray(ease_off["ease_off_angle"].values + ease_off.attrs["first_contact_rad"])


def of(member: Member, formula: Formula, factor: float = 1.0) -> Deviation:
    return deviation_from_formula(member.section, lambda t, h: factor * formula(t, h))


def uniform(t: Array, h: Array) -> Array:
    return np.asarray(10.0 + 0.0 * t + 0.0 * h)


def errors_of_the_update(pair: GearPair, pinion: Formula, gear: Formula, factor: float) -> tuple[float, float]:
    """Largest errors of the updated normal ease-off [um] and roll angle [rad], against the deviating flanks."""
    deviations = {"pinion": of(pair.pinion, pinion, factor), "gear": of(pair.gear, gear, factor)}
    updated = deviated_ease_off(designed(pair), pinion=deviations["pinion"], gear=deviations["gear"])
    surfaces = deviated_pair(pair, pinion=deviations["pinion"], gear=deviations["gear"])
    exact = pair_geometry(surfaces, NODES).ease_off
    both = (updated["inside"].values & exact["inside"].values).astype(bool)
    gap = 1e3 * (absolute(updated) - absolute(exact)) * updated["lever_arm"].values
    roll = (updated["roll_angle"] - exact["roll_angle"]).values
    return float(np.max(np.abs(gap[both]))), float(np.max(np.abs(roll[both])))


def test_no_deviation_changes_nothing_in_the_last_bit() -> None:
    case = small("fm-11x41", "shell")
    plain = easeoff.analyze(case, torques=[200.0])
    pair = gear_pair(case, "drive")
    nothing = {"pinion": of(pair.pinion, uniform, 0.0), "gear": of(pair.gear, uniform, 0.0)}
    for way in ("ease_off", "surface"):
        again = easeoff.analyze(case, torques=[200.0], deviations=nothing, deviated=way)  # type: ignore[arg-type]
        for group in ("ease_off", "unloaded", "loaded"):
            for name, values in plain[group].to_dataset().items():
                where = f"{way} {group} {name}"
                np.testing.assert_array_equal(again[group].to_dataset()[name].values, values.values, err_msg=where)
        assert again["unloaded"].attrs["rms"] == plain["unloaded"].attrs["rms"]


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_uniform_metal_on_one_member_takes_just_as_much_off_the_normal_ease_off(member: str) -> None:
    pair = case_pair()
    deviation = of(pair.pinion if member == "pinion" else pair.gear, uniform)
    updated = deviated_ease_off(designed(pair), **{member: deviation})
    change = 1e3 * (absolute(updated) - absolute(designed(pair).ease_off)) * updated["lever_arm"].values
    inside = updated["inside"].values.astype(bool)
    np.testing.assert_allclose(change[inside], -10.0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(updated["ease_off_change"].values[inside], -10.0, rtol=0, atol=1e-12)


def test_equal_and_opposite_deviations_of_conjugate_points_cancel() -> None:
    pair = case_pair()
    t, h = grid(NODES)
    gear = of(pair.gear, GEAR_ERRORS)
    surface = exact_ease_off(pair.gear.flank(t, h), pair.pinion.loaded, pair.pinion.section, pair.assembly)
    place = surface.pinion_position
    on_gear = gear.at(*np.meshgrid(t, h, indexing="ij"))
    pinion = Deviation(pair.pinion.section, place[2].reshape(NODES), np.hypot(*place[:2]).reshape(NODES), -on_gear)
    updated = deviated_ease_off(designed(pair), pinion=pinion, gear=gear)
    assert np.max(np.abs(updated["gear_deviation"].values)) > 10.0
    before = designed(pair).ease_off
    np.testing.assert_allclose(updated["ease_off"].values, before["ease_off"].values, rtol=0, atol=1e-8)


def test_the_printed_form_is_low_by_the_square_of_the_cosine() -> None:
    """Kolivand 2009, Eq. 4.5a: (u . n) d / L for d / (L (u . n)); the page on real flanks compares both."""
    studies = importlib.import_module("real_flanks_studies")
    pair = case_pair()
    gear = of(pair.gear, GEAR_ERRORS)
    correct = deviated_ease_off(designed(pair), gear=gear)
    printed = studies.printed_update(pair, designed(pair).ease_off, correct)
    flank = pair.gear.flank(*grid(NODES))
    radius = np.hypot(flank.position[0], flank.position[1])
    around = np.stack([-flank.position[1], flank.position[0], 0.0 * radius]) / radius
    cosine = np.sum(around * flank.normal, axis=0).reshape(NODES)
    share = printed["ease_off_change"].values / correct["ease_off_change"].values
    np.testing.assert_allclose(share, cosine**2, rtol=1e-12)
    assert 0.55 < share.min() < share.max() < 0.8


@pytest.mark.thorough
def test_the_update_errs_in_the_second_order_where_flanks_are_conjugate() -> None:
    pair = conjugate_pair()
    errors = [errors_of_the_update(pair, PINION_ERRORS, GEAR_ERRORS, factor) for factor in (1.0, 0.5, 0.25)]
    for whole, half in pairwise(errors):
        assert 3.6 < whole[0] / half[0] < 4.4
        assert 3.6 < whole[1] / half[1] < 4.4
    assert errors[0][0] < 0.1  # um, of 40 um


@pytest.mark.parametrize(("pinion", "gear"), [(PINION_ERRORS, GEAR_ERRORS), (worn, worn)])
@pytest.mark.quick(1)
def test_the_update_is_within_a_percent_on_a_real_pair(pinion: Formula, gear: Formula) -> None:
    pair = case_pair()
    gap, roll = errors_of_the_update(pair, pinion, gear, 1.0)
    updated = deviated_ease_off(designed(pair), pinion=of(pair.pinion, pinion), gear=of(pair.gear, gear))
    inside = updated["inside"].values.astype(bool)
    assert gap < 0.01 * np.max(np.abs(updated["ease_off_change"].values[inside]))
    moved = np.abs((updated["roll_angle"] - designed(pair).ease_off["roll_angle"]).values[inside])
    assert roll < 0.05 * np.max(moved)


@pytest.mark.thorough
def test_what_is_of_first_order_in_the_error_is_the_lever_arm_of_the_pinion() -> None:
    """The gear's arm stands for both; with the arm of the pinion's own normal the error is of second order."""
    pair, before = case_pair(), designed(case_pair()).ease_off
    arm = np.cross(before.attrs["gear_axis"], before["action_position"].values - before.attrs["gear_origin_mm"])
    share = before["lever_arm"].values / np.abs(np.sum(arm * before["action_normal"].values, axis=-1)) - 1.0
    inside = before["inside"].values.astype(bool)
    assert 0.002 < np.max(np.abs(share[inside])) < 0.01
    errors = []
    for factor in (1.0, 0.5, 0.25):
        pinion = of(pair.pinion, PINION_ERRORS, factor)
        updated = deviated_ease_off(designed(pair), pinion=pinion)
        exact = pair_geometry(deviated_pair(pair, pinion=pinion), NODES).ease_off
        both = inside & exact["inside"].values.astype(bool)
        error = 1e3 * (absolute(updated) - absolute(exact)) * before["lever_arm"].values
        errors.append([np.max(np.abs(e[both])) for e in (error, error - updated["pinion_deviation"].values * share)])
    for coarse, fine in pairwise(errors):
        assert 3.5 < coarse[1] / fine[1] < 4.5
    assert errors[-1][0] > 2.0 * errors[-1][1]


@pytest.mark.thorough
def test_both_hands_and_every_kind_of_flank_deviate_alike() -> None:
    """Mirror images err alike to the last digit; coast flanks and face-hobbed ones err as little."""
    errors = {}
    for case, flank, hand in (
        ("fm-11x41", "drive", "left"),
        ("fm-11x41", "drive", "right"),
        ("fm-11x41", "coast", "left"),
        ("fh-12x41-45", "drive", "left"),
    ):
        read = easeoff.read_case(case)
        pinion = read.pinion.model_copy(update={"hand_of_spiral": hand})
        pair = gear_pair(read.model_copy(update={"pinion": pinion}), flank)  # type: ignore[arg-type]
        errors[case, flank, hand] = errors_of_the_update(pair, PINION_ERRORS, GEAR_ERRORS, 1.0)
    assert errors["fm-11x41", "drive", "left"] == errors["fm-11x41", "drive", "right"]
    assert max(gap for gap, _ in errors.values()) < 0.25  # um, of about 30
    assert max(roll for _, roll in errors.values()) < 2e-4


@pytest.mark.thorough
def test_flanks_of_several_sections_deviate_too() -> None:
    pair = case_pair()

    def relieved(member: Member, **relief: Relief) -> Member:
        return replace(member, loaded=replace(member.loaded, blade=replace(member.loaded.blade, **relief)))  # type: ignore[arg-type]

    pair = replace(
        pair,
        pinion=relieved(pair.pinion, toprem=Relief(1.6, 0.02)),
        gear=relieved(pair.gear, flankrem=Relief(5.0, 0.02)),
    )
    surface = exact_ease_off(pair.gear.flank(*grid(NODES)), pair.pinion.loaded, pair.pinion.section, pair.assembly)
    assert set(surface.part) == {0, 1}
    nothing = deviated_pair(pair, pinion=of(pair.pinion, uniform, 0.0), gear=of(pair.gear, uniform, 0.0))
    same = pair_geometry(nothing, NODES).ease_off
    for name, values in designed(pair).ease_off.items():
        np.testing.assert_array_equal(same[name].values, values.values, err_msg=str(name))
    gap, _ = errors_of_the_update(pair, PINION_ERRORS, GEAR_ERRORS, 1.0)
    assert gap < 0.5


def test_a_pinion_turned_as_a_whole_rolls_later_everywhere_by_its_angle() -> None:
    """There Eq. 4.6 is right: with metal taken off as a rotation does it, to the second order of the angle."""
    pair, angle = conjugate_pair(), 2e-4
    t, h = np.meshgrid(np.linspace(0, 1, 33), np.linspace(0.15, 1, 17), indexing="ij")  # undercut at the root
    flank = pair.pinion.flank(t[:, 0], h[0])
    lever = np.abs(flank.position[0] * flank.normal[1] - flank.position[1] * flank.normal[0]).reshape(t.shape)
    axial, radial = pair.pinion.section.points(t, h)
    turned = Deviation(pair.pinion.section, axial, radial, -angle * lever)
    updated = deviated_ease_off(designed(pair), pinion=turned)
    inside = updated["inside"].values > updated["extrapolated"].values
    later = (updated["roll_angle"] - designed(pair).ease_off["roll_angle"]).values[inside]
    np.testing.assert_allclose(later, angle, rtol=1e-4)
    gap = (absolute(updated) - absolute(designed(pair).ease_off))[inside]
    np.testing.assert_allclose(gap, angle / pair.assembly.ratio, rtol=1e-4)


@pytest.mark.thorough
def test_settings_of_a_machine_by_deviation() -> None:
    """The difference of two settings as a deviation gives the second one's ease-off: to rounding as a surface, to the
    second order by the update."""
    pair = conjugate_pair()
    t, h = np.meshgrid(np.linspace(-0.02, 1.02, 61), np.linspace(0.15, 1.25, 41), indexing="ij")  # undercut at the root
    points = pair.pinion.flank(t[:, 0], h[0])
    axial, radial = pair.pinion.section.points(t, h)
    moved = {"point_radius": 0.05, "pressure_angle": 0.001, "machine_root_angle": 0.0003}
    errors = []
    for factor in (1.0, 0.5):
        settings = {name: get_setting(pair.pinion.loaded, name) + factor * by for name, by in moved.items()}
        second = replace(pair.pinion, loaded=with_settings(pair.pinion.loaded, settings))
        distance = distance_along_normals(second.loaded, second.section, points.position, points.normal)
        deviation = Deviation(pair.pinion.section, axial, radial, distance.reshape(t.shape))
        wanted = pair_geometry(replace(pair, pinion=second), NODES).ease_off
        by_surface = pair_geometry(deviated_pair(pair, pinion=deviation), NODES).ease_off
        by_update = deviated_ease_off(designed(pair), pinion=deviation)
        use = (by_update["inside"].values > by_update["extrapolated"].values) & (wanted["inside"].values == 1)
        exact, update, change = (
            np.max(np.abs(1e3 * (absolute(e) - absolute(wanted)) * wanted["lever_arm"].values)[use])
            for e in (by_surface, by_update, designed(pair).ease_off)
        )
        assert exact < 1e-5
        assert update < 1e-3 * change
        errors.append(update)
    assert 3.8 < errors[0] / errors[1] < 4.2


def test_the_deviating_flank_has_its_own_normals() -> None:
    member = deviated_member(case_pair().pinion, of(case_pair().pinion, worn))
    flank = member.flank(*grid((7, 5)))
    _, tangents = complex_steps(lambda p: member.loaded.evaluate(p)[0], flank.parameters)
    for tangent in tangents:
        cosine = np.sum(tangent * flank.normal, axis=0) / np.linalg.norm(tangent, axis=0)
        np.testing.assert_allclose(cosine, 0.0, rtol=0, atol=1e-11)
    plain = case_pair().pinion.flank(*grid((7, 5)))
    assert np.max(np.linalg.norm(flank.normal - plain.normal, axis=0)) > 1e-3
    np.testing.assert_allclose(np.linalg.norm(flank.normal, axis=0), 1.0, rtol=1e-12)


def test_a_parallel_flank_has_the_curvatures_of_a_parallel_surface() -> None:
    """Closed form: with d more metal the curvatures are k / (1 + d k), convex positive."""
    pair = case_pair()
    plain = pair.gear.flank(*grid((5, 5)))
    parallel = deviated_member(pair.gear, of(pair.gear, uniform, 20.0))
    raised = replace(plain, surface=parallel.loaded)
    before, after = principal_curvatures(plain).curvature, principal_curvatures(raised).curvature
    np.testing.assert_allclose(after, before / (1.0 + 0.2 * before), rtol=1e-8, atol=1e-9)


def test_a_deviation_of_another_blank_is_refused() -> None:
    pair = case_pair()
    with pytest.raises(InputError, match="another blank"):
        deviated_pair(pair, pinion=of(pair.gear, uniform))
    with pytest.raises(InputError, match="another blank"):
        easeoff.analyze(small("fm-11x41", "shell"), deviations={"pinion": of(pair.gear, uniform)})
    with pytest.raises(InputError, match="of the gear is a ndarray: give a file, a dataset or a Deviation"):
        easeoff.analyze(small("fm-11x41", "shell"), deviations={"gear": np.zeros((5, 9))})  # type: ignore[dict-item]
    with pytest.raises(InputError, match="member = 'axle'"):
        easeoff.analyze(small("fm-11x41", "shell"), deviations={"axle": of(pair.gear, uniform)})  # type: ignore[dict-item]
    with pytest.raises(InputError, match="must be one of ease_off, surface"):
        easeoff.analyze(small("fm-11x41", "shell"), deviations={"gear": of(pair.gear, uniform)}, deviated="both")  # type: ignore[arg-type]


@cache
def computed() -> EaseOff:
    pair = case_pair()
    return exact_ease_off(pair.gear.flank(*grid((9, 7))), pair.pinion.loaded, pair.pinion.section, pair.assembly)


def test_what_drifts_past_a_place_of_the_gear_is_the_sliding_pinion() -> None:
    """Two ways to one vector: differences along the conjugate motion, and the spins of both members."""
    ease_off, moving = computed(), drift(computed())
    motion, use = ease_off.motion, computed().inside
    rotation = ease_off.roll_angle + motion.center
    space, normal = motion.action_point(ease_off.pinion_parameters, rotation)
    velocity = relative_velocity(motion, space)
    # No part along the normal: that is what makes the points conjugate.
    assert np.max(np.abs(np.sum(velocity * normal, axis=0)[use])) < 1e-10
    from easeoff.geometry.vectors import rotate

    back = np.tensordot(motion.assembly.pinion_frame.T, rotate(motion.pinion_axis, -rotation, velocity), axes=1)
    np.testing.assert_allclose(moving.axial[use], -back[2][use], rtol=0, atol=1e-4)
    radius = np.hypot(*ease_off.pinion_position[:2])
    radial = (ease_off.pinion_position[0] * back[0] + ease_off.pinion_position[1] * back[1]) / radius
    np.testing.assert_allclose(moving.radial[use], -radial[use], rtol=0, atol=1e-4)


def test_sliding_is_the_difference_of_the_speeds_across_the_line_and_along_it() -> None:
    """The line's speeds over both flanks differ by the sliding across it: by less than all of it."""
    found, use = rolling(computed()), computed().inside
    difference = np.abs(found.pinion_speed - found.gear_speed)[use]
    assert np.all(difference < found.sliding[use] * (1.0 + 1e-9))
    motion = computed().motion
    rotation = computed().roll_angle + motion.center
    space, _ = motion.action_point(computed().pinion_parameters, rotation)
    np.testing.assert_allclose(found.sliding, np.linalg.norm(relative_velocity(motion, space), axis=0), rtol=1e-12)
    # Across the line, by the direction of the line: what the roll angle of neighbouring places on the gear tells.
    gear, slopes = complex_steps(lambda p: np.stack([*motion.conjugate_gear(p)[0]]), computed().pinion_parameters)
    _, roll = complex_steps(lambda p: motion.conjugate_gear(p)[1], computed().pinion_parameters)
    along = roll[1] * slopes[0] - roll[0] * slopes[1]
    along = along / np.linalg.norm(along, axis=0)
    from easeoff.geometry.vectors import cross, rotate

    normal = cross(slopes[0], slopes[1])
    across = cross(normal / np.linalg.norm(normal, axis=0), along)
    spin = -rotation / motion.assembly.ratio
    velocity = rotate(motion.gear_axis, spin, relative_velocity(motion, space))
    np.testing.assert_allclose(np.abs(np.sum(velocity * across, axis=0))[use], difference, rtol=1e-8)
    assert gear.shape[0] == 3
