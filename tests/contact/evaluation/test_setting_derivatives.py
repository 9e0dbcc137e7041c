"""Derivatives of an analysis: against differences of analyses, closed forms and identities."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr
from held_teeth import anew
from numpy.typing import NDArray
from pairs import relieved
from scipy.optimize import root_scalar
from whole_differences import (
    OPERATION,
    Analyses,
    Course,
    Departure,
    coarse,
    coarse_cycle,
    departures,
    longest_step,
    moves,
    touching,
)

from easeoff.cases import gear_pair, read_case
from easeoff.contact import MeshCycle
from easeoff.contact.compliance import elastic_model
from easeoff.contact.compliance.finite_elements.flank_compliance import FlankCompliance, StressResponse
from easeoff.contact.evaluation.cycle_numbers import load_spot
from easeoff.contact.evaluation.cycle_slopes import CycleSlopes
from easeoff.contact.evaluation.segment_slopes import unloaded_numbers
from easeoff.contact.evaluation.unloaded_slopes import UnloadedSlopes, unloaded_slopes
from easeoff.contact.lines.closest_approach import PASSING_FIELDS
from easeoff.contact.lines.mesh_lines import MeshLines
from easeoff.contact.lines.turned_flanks import TurnedFlanks
from easeoff.contact.loaded import LoadedCase, rotation_numbers
from easeoff.contact.tooth_root_stress import root_stress
from easeoff.contact.unloaded import PairErrors
from easeoff.core.errors import InputError
from easeoff.friction import FrictionModel, friction
from easeoff.geometry import pair_geometry
from easeoff.geometry.cutting.blade import Relief
from easeoff.geometry.cutting.named_settings import BLADE_STEPS, CURVATURE_STEPS, MACHINE_STEPS, MODIFIED_ROLL_ORDERS
from easeoff.geometry.pair.field_slopes import field_slopes, gear_gap_slopes, pinion_gap_slopes
from easeoff.geometry.pair.gear_pair import FlankName, GearPair, PairGeometry, tooth_angles
from easeoff.geometry.pair.modification import TERM_POWERS, Modification, modified_ease_off
from easeoff.geometry.pair.near_pair import ERROR_STEPS, PLACES, PairSetting, rate, uneven
from easeoff.geometry.pair.tooth_thickness import mean_thicknesses, thickness_slopes
from easeoff.study import CaseInMesh, derivatives
from easeoff.study.analysis.setting_derivatives import loss_slopes, loss_values

Array = NDArray[Any]

CASES = ("fm-11x41", "nasa-12x36", "fh-12x41-45", "fh-design-a", "fh-design-b")
FLANKS: tuple[FlankName, ...] = ("drive", "coast")
TORQUES = {"fm-11x41": 250.0, "nasa-12x36": 100.0}
MOTIONS = ("sliding_base_motion_1", "cutter_tilt_motion_2")
#: Steps of the differences, over the usual step of a setting. Long ones are for what hardly moves the flanks, where
#: rounding rules; of others a short one meets no change of the touching segments, and curves less.
STEPS = (1e-4, 3e-3, 1e-5, 3e-6, 1e-6)
TOLERANCE = 1e-6
MEDIAN_FACTOR, BEYOND_FACTOR = 2.0, 3.0  # of all settings; of one, beyond the scatter of its differences
#: What rounding leaves of the rotation [rad]; over a step it is the least error a difference can have.
ROTATION_ROUNDING = 3e-15
UNLOADED_STEP = 4e-4  # of the usual step of a setting, in differences of fourth order
GAP_ROUNDING = 4e-15  # [rad]; what rounding leaves of the smallest gap


@pytest.fixture(autouse=True)
def all_shared_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that are left out change no digit of a result, but all digits of a difference over 1e-5."""
    monkeypatch.setattr(elastic_model, "DROPPED_SHARE", 1e-15)


def settings_of(pair: GearPair) -> list[PairSetting]:
    names = [*BLADE_STEPS, *CURVATURE_STEPS, *MACHINE_STEPS, *MODIFIED_ROLL_ORDERS, *MOTIONS]
    found = [PairSetting("pinion", name) for name in names] + [PairSetting("gear", name) for name in names]
    found += [PairSetting("assembly", name) for name in ERROR_STEPS]
    return [one for one in found if one.acts_on(pair)]


@cache
def geometry_of(name: str, flank: FlankName = "drive") -> PairGeometry:
    return pair_geometry(gear_pair(read_case(name), flank))


@cache
def cycle_of(name: str, flank: FlankName = "drive", mesh_positions: int = 8) -> MeshCycle:
    return MeshCycle.of(geometry_of(name, flank), mesh_positions=mesh_positions, segments_per_line=15)


def torques_of(name: str) -> list[float]:
    return [TORQUES.get(name, 300.0)]


#: Settings of a pair, of which those that only turn a member come first.
SOME = {
    "nasa-12x36": [
        *(PairSetting(of, name) for of in ("pinion", "gear") for name in ("cradle_angle", "cutter_swivel")),
        PairSetting("pinion", "machine_root_angle"),
        PairSetting("modification", "lengthwise_crowning"),
    ],
    "fm-11x41": [PairSetting("pinion", "work_offset"), PairSetting("pinion", "radial_distance")],
}


def cycle_slopes(
    cycle: MeshCycle, settings: list[PairSetting], loaded: xr.Dataset, cases: list[LoadedCase]
) -> tuple[xr.Dataset, xr.Dataset]:
    """Numbers of a mesh cycle, and their derivatives by settings and torque."""
    return CycleSlopes.of(cycle, settings, cases).datasets(loaded)


@cache
def values_and_slopes(name: str) -> tuple[xr.Dataset, xr.Dataset]:
    """Numbers of a coarse pair, and their derivatives by some settings."""
    cycle = coarse_cycle(name)
    return cycle_slopes(cycle, SOME[name], *cycle.loaded(torques_of(name)))


@pytest.mark.thorough
@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("name", CASES)
def test_loaded_contact_agrees_with_differences_for_all_settings(name: str, flank: FlankName) -> None:
    check_rotations(cycle_of(name, flank), torques_of(name), settings_of(geometry_of(name, flank).pair))


@pytest.mark.thorough
@pytest.mark.parametrize("name", CASES)
def test_contact_on_lines_agrees_with_differences(name: str) -> None:
    check_rotations(cycle_of(name), torques_of(name), settings_of(geometry_of(name).pair)[::6], edges=False)


@pytest.mark.parametrize(("name", "edges"), [("fm-11x41", False), ("nasa-12x36", True), ("fh-12x41-45", True)])
def test_loaded_contact_agrees_with_differences(name: str, edges: bool) -> None:
    check_rotations(coarse_cycle(name), torques_of(name), [PairSetting("pinion", "radial_distance")], edges=edges)


def check_rotations(
    cycle: MeshCycle,
    torques: list[float],
    settings: list[PairSetting],
    steps: Sequence[float] = STEPS,
    edges: bool = True,
) -> None:
    pair = cycle.geometry.pair
    loaded, cases = cycle.loaded(torques, edge_contact=edges)
    _, slopes = cycle_slopes(cycle, settings, loaded, cases)
    for number, setting in enumerate(settings):
        own = 1e-6 * slopes["transmission_error"].values[0, :, number]
        best = np.full(own.size, np.inf)
        for share in steps:
            step = share * setting.scale
            ahead, behind = (
                anew(cycle, setting.moved(pair, sign * step)).loaded(torques, edge_contact=edges)[1]
                for sign in (1.0, -1.0)
            )
            for at, case in enumerate(cases):
                if not all(np.array_equal(touching(case), touching(cycles[at])) for cycles in (ahead, behind)):
                    continue
                change = (ahead[at].solution.rotation - behind[at].solution.rotation) / (2.0 * step)
                best[at] = min(best[at], max(abs(change - own[at]) - ROTATION_ROUNDING / step, 0.0))
            if best.max() < TOLERANCE * np.abs(own).max():
                break
        assert np.isfinite(best).mean() > 0.7, setting
        assert best[np.isfinite(best)].max() < TOLERANCE * np.abs(own).max(), setting


@pytest.mark.thorough
@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("name", CASES)
def test_numbers_agree_with_differences_for_settings_of_all_kinds(name: str, flank: FlankName) -> None:
    """A fifth of the settings of each, others for the next; all of them take an hour."""
    first = (CASES.index(name) + 2 * FLANKS.index(flank)) % 5
    # The fewer positions, the fewer lie beside a change of what touches.
    check_numbers(cycle_of(name, flank, 4), torques_of(name), settings_of(geometry_of(name, flank).pair)[first::5])


@pytest.mark.thorough
@pytest.mark.parametrize("name", CASES)
def test_numbers_on_lines_agree_with_differences(name: str) -> None:
    check_numbers(cycle_of(name, "drive", 4), torques_of(name), settings_of(geometry_of(name).pair)[::6], edges=False)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["fm-11x41", "nasa-12x36", "fh-12x41-45", "fh-design-b"])
def test_numbers_agree_with_differences(name: str) -> None:
    check_numbers(coarse_cycle(name), torques_of(name), [PairSetting("pinion", "radial_distance")])


def check_numbers(cycle: MeshCycle, torques: list[float], settings: list[PairSetting], edges: bool = True) -> None:
    """Every number, wherever the same segments touch on both sides."""
    analyses = Analyses(tuple(torques), edges)
    slopes, found = analyses.slopes(cycle, settings), []
    for number, setting in enumerate(settings):
        own = slopes.isel(setting=number)
        if moves(setting, own):
            found.append(check(analyses.along(cycle, setting), own, longest_step(setting, own), setting))
    assert len(found) > 0.8 * len(settings)
    for variable in map(str, slopes):
        assert np.mean([one[variable].compared for one in found]) > 0.7, variable
        # Beside a change of what touches, and of settings that hardly move the flanks, differences tell less.
        assert np.median([one[variable].farther for one in found]) < MEDIAN_FACTOR * TOLERANCE, variable


def check(course: Course, slopes: xr.Dataset, step: float, setting: object) -> dict[str, Departure]:
    """No derivative is beyond the scatter of its differences."""
    found = departures(course, slopes, step, TOLERANCE)
    for variable, one in found.items():
        assert one.beyond < BEYOND_FACTOR * TOLERANCE, (setting, variable)
    return found


def test_a_load_beside_the_border_of_a_shape_function_moves_on_its_own_side() -> None:
    """One point of a segment lies within 1e-6 of the flank from such a border."""
    cycle, setting = beside_a_border(coarse_cycle("fm-11x41")), PairSetting("assembly", "gear_axial")
    torques, step = torques_of("fm-11x41"), 1e-4 * setting.scale
    _, slopes = cycle_slopes(cycle, [setting], *cycle.loaded(torques, edge_contact=False))
    own = 1e-6 * slopes["transmission_error"].values[0, :, 0]
    moved = [anew(cycle, setting.moved(cycle.geometry.pair, place * step)) for place in PLACES]
    rotations = [one.loaded(torques, edge_contact=False)[1][0].solution.rotation for one in moved]
    change = rate([np.asarray(rotation) for rotation in rotations], step)
    assert abs(change - own[0]) < 2e-6 * np.abs(own).max() + ROTATION_ROUNDING / step


def beside_a_border(cycle: MeshCycle) -> MeshCycle:
    """The same pair with a point of the first contact line 5e-7 of the gear's face width from a border."""
    tooth, (first, second, *_) = cycle.elastic[1], cycle.lines.rotations
    assert isinstance(tooth, FlankCompliance)
    border = tooth.lengthwise[4]  # of three nodes a shape, every second is one

    def beyond(rotation: float) -> Array:
        return np.asarray(cycle.at_rotations(np.array([rotation])).segments.on_lines.quadrature[0][0, 0] - border)

    nearest = np.argmin(np.abs(beyond(first)))
    found = root_scalar(lambda rotation: beyond(rotation)[nearest] - 5e-7, x0=first, x1=second, xtol=1e-12)
    return cycle.at_rotations(np.array([found.root, second]))


def test_differences_depart_by_three_times_the_error_of_the_nearer_one() -> None:
    assert uneven([np.exp(0.1 * np.array([place])) for place in PLACES]) == pytest.approx(3.0 * 0.1**2 / 6.0, rel=2e-2)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45"])
def test_fields_agree_with_differences_of_solutions(name: str) -> None:
    """The implicit path has the tangent of the solutions that Newton's method finds anew."""
    geometry = pair_geometry(gear_pair(read_case(name)), (9, 7))
    settings = [
        PairSetting("pinion", "radial_distance"),
        PairSetting("pinion", "cutter_tilt"),
        PairSetting("gear", "pressure_angle"),
        PairSetting("assembly", "shaft_angle"),
    ]
    slopes = field_slopes(geometry, settings)
    for number, setting in enumerate(settings):
        step = 0.01 * setting.scale
        found = []
        for place in PLACES:
            moved = pair_geometry(setting.moved(geometry.pair, place * step), (9, 7))
            depth = moved.members.gear.position  # the gear's nodes have no field of their own
            found.append({"position": np.moveaxis(depth.reshape(3, 9, 7), 0, -1)})
            for field in (
                "roll_angle",
                "ease_off_angle",
                "lever_arm",
                "separation_curvature",
                "pinion_profile",
                *PASSING_FIELDS,
            ):
                found[-1][field] = moved.ease_off[field].values
        for field in found[0]:
            change, own = rate([one[field] for one in found], step), slopes[field][..., number]
            if field == "ease_off_angle":  # its zero may be that of another node
                change, own = change - change[4, 3], own - own[4, 3]
            rough = 1e3 if field.endswith("acceleration") else 1.0  # a second difference in the field itself
            assert np.abs(change - own).max() <= rough * (1e-6 * np.abs(own).max() + 1e-7), (setting, field)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "power"), [("fm-11x41", "modified_roll_24e"), ("fh-12x41-45", "modified_roll_720g")])
def test_powers_of_the_roll_agree_with_differences_of_solutions_on_coast(name: str, power: str) -> None:
    """They move conjugate contact by millimetres over their usual step, and most at one end of the flank."""
    setting = PairSetting("pinion", power)
    geometry = pair_geometry(gear_pair(read_case(name), "coast"), (17, 11))
    slopes = field_slopes(geometry, [setting])

    def changes(step: float) -> dict[str, Array]:
        moved = [pair_geometry(setting.moved(geometry.pair, place * step), (17, 11)).ease_off for place in PLACES]
        return {name: rate([one[name].values for one in moved], step) for name in ("ease_off_angle", *limits)}

    # Rounding of the skew, a third derivative, is greater than that of the others.
    limits = {"roll_angle": 1e-8, "separation_curvature": 2e-8, "separation_skew": 2e-7}
    shorter, longer = (changes(share * setting.scale) for share in (4e-4, 8e-4))
    for field, limit in limits.items():
        size = np.nanmax(np.abs(shorter[field]))
        assert np.nanmax(np.abs(shorter[field] - longer[field])) < limit * size, field
        assert np.nanmax(np.abs(shorter[field] - slopes[field][..., 0])) < limit * size, field
    ease_off, own = longer["ease_off_angle"], slopes["ease_off_angle"][..., 0]
    apart = ease_off - own  # but for the zero
    assert np.nanmax(apart) - np.nanmin(apart) < 1e-8 * np.nanmax(np.abs(own))


@pytest.mark.quick(1)
@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("name", ["fh-12x41-45", "fh-design-b", "nasa-12x36", "fm-11x41"])
def test_ease_off_moves_as_the_flanks_do_along_their_normals(name: str, flank: FlankName) -> None:
    geometry = pair_geometry(gear_pair(read_case(name), flank), (9, 7))
    settings = settings_of(geometry.pair)
    exact = geometry.exact
    closed = pinion_gap_slopes(geometry, settings, exact.pinion_parameters, exact.part, exact.roll_angle)
    closed += gear_gap_slopes(geometry, settings, geometry.members.gear)
    slopes = field_slopes(geometry, settings)
    full = slopes["ease_off_angle"].reshape(-1, len(settings))
    # Of every setting that moves the flanks at all.
    size = np.ptp(full, axis=0)
    moving = size > 1e-9
    assert moving.sum() > 25
    assert np.all(np.ptp(closed - full, axis=0)[moving] < 5e-8 * size[moving])
    # The zero of the ease-off is what is put in.
    zero = slopes["put_in"].reshape(-1, len(settings))
    assert np.all(np.abs(closed + zero - full).max(axis=0)[moving] < 5e-8 * size[moving])


def test_settings_that_only_turn_a_member_change_nothing() -> None:
    """On a generator without tilt the cradle angle turns the work, and the swivel the cutter about its own axis."""
    pair = coarse_cycle("nasa-12x36").geometry.pair
    assert pair.pinion.loaded.settings.cutter_tilt == pair.gear.loaded.settings.cutter_tilt == 0.0
    _, slopes = values_and_slopes("nasa-12x36")
    for name in ("ease_off", "transmission_error", "load_share", "pressure", "unloaded_transmission_error_envelope"):
        values = np.nan_to_num(slopes[name].values)
        assert np.abs(values[..., :4]).max() < 1e-6 * np.abs(values[..., 4]).max(), name


def test_torque_and_modification_agree_with_differences() -> None:
    _, slopes = values_and_slopes("nasa-12x36")
    cycle, torque = coarse_cycle("nasa-12x36"), TORQUES["nasa-12x36"]
    told = cycle.geometry.ease_off

    def added(amount: float) -> Array:
        moved = cycle.with_ease_off(modified_ease_off(told, Modification({"lengthwise_crowning": amount})))
        return np.array([case.solution.rotation for case in moved.loaded([torque])[1]])

    def loaded(amount: float) -> Array:
        return np.array([case.solution.rotation for case in cycle.loaded([torque + amount])[1]])

    for number, function, step in ((-2, added, 1e-4), (-1, loaded, 1e-3)):
        change = 1e6 * (function(step) - function(-step)) / (2.0 * step)
        own = slopes["transmission_error"].values[0, :, number]
        assert np.abs(change - own).max() < TOLERANCE * np.abs(own).max()


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", [name for name, powers in TERM_POWERS.items() if sum(powers) < 4])
def test_modifications_agree_with_differences(name: str) -> None:
    term, cycle, analyses = PairSetting("modification", name), coarse_cycle("nasa-12x36"), Analyses((100.0,))
    own = analyses.slopes(cycle, [term]).isel(setting=0)
    found = check(analyses.along(cycle, term), own, longest_step(term, own), term)
    assert min(one.compared for one in found.values()) > 0.7
    assert np.mean([one.farther < TOLERANCE for one in found.values()]) > 0.9
    assert found["transmission_error"].farther < TOLERANCE


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", CASES)
def test_torque_agrees_with_differences(name: str) -> None:
    cycle, analyses = coarse_cycle(name), Analyses(tuple(torques_of(name)))
    own = analyses.slopes(cycle, [PairSetting("assembly", "offset")]).isel(setting=-1)
    found = check(analyses.along_torque(cycle), own, 0.3, "torque")
    assert found["transmission_error"].compared > 0.7
    assert found["transmission_error"].farther < TOLERANCE


def test_numbers_of_a_cycle_follow_its_transmission_error() -> None:
    values, slopes = values_and_slopes("fm-11x41")
    error, slope = (one["transmission_error"].values[0] for one in (values, slopes))
    step = 1e-7 / np.abs(slope).max()
    for number in (0, -1):
        ahead, behind = (rotation_numbers((error + sign * step * slope[:, number])[None]) for sign in (1.0, -1.0))
        for name in ("mean_level", "peak_to_peak", "harmonic", "rms"):
            change = (ahead[name][1][0] - behind[name][1][0]) / (2.0 * step)
            np.testing.assert_allclose(slopes[name].values[0, ..., number], change, rtol=1e-4, atol=1e-4)
    # Pairs share one torque, and forces keep its balance.
    np.testing.assert_allclose(slopes["load_share"].sum("pair"), 0.0, atol=1e-9)
    np.testing.assert_allclose(values["load_share"].sum("pair"), 1.0, rtol=1e-9)


def test_pressure_agrees_with_differences() -> None:
    setting, cycle, torques = SOME["fm-11x41"][1], coarse_cycle("fm-11x41"), torques_of("fm-11x41")
    _, slopes = values_and_slopes("fm-11x41")
    step = 1e-5 * setting.scale
    ahead, behind = (
        anew(cycle, setting.moved(cycle.geometry.pair, sign * step)).loaded(torques)[0] for sign in (1.0, -1.0)
    )
    change = (ahead["max_pressure"] - behind["max_pressure"]).item() / (2.0 * step)
    assert slopes["max_pressure"].values[0, 1] == pytest.approx(change, rel=1e-4)
    share = (ahead["load_share"] - behind["load_share"]).values / (2.0 * step)
    own = slopes["load_share"].values[..., 1]
    assert np.nanmax(np.abs(share - own)) < 1e-4 * np.nanmax(np.abs(own))
    on_edges = (ahead["edge_share"] - behind["edge_share"]).values / (2.0 * step)
    own = slopes["edge_share"].values[..., 1]
    assert np.abs(on_edges - own).max() < 1e-4 * np.abs(own).max()


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("name", "flank", "every"),
    [
        ("nasa-12x36", "drive", 21),
        ("nasa-12x36", "coast", 7),
        *((name, flank, 7) for name in CASES if name != "nasa-12x36" for flank in FLANKS),
    ],
)
def test_unloaded_contact_agrees_with_whole_analyses(name: str, flank: FlankName, every: int) -> None:
    """On edges as well, which carry ``nasa-12x36`` at every rotation."""
    pair, nodes = gear_pair(read_case(name), flank), (9, 7)
    settings, geometry = settings_of(pair)[::every], pair_geometry(pair, nodes)
    found = unloaded_slopes(geometry, lines_of(geometry), settings, field_slopes(geometry, settings))
    values, slopes = ({name: value for name, (_, value) in one.items()} for one in unloaded_numbers(found))
    errors = errors_of(geometry)
    places = np.arange(128) / 128
    assert values["unloaded_transmission_error_envelope"] == pytest.approx(
        1e6 * errors.envelope_at(places[::16]), abs=1e-8
    )
    own = 1e-6 * slopes["unloaded_transmission_error_envelope"]
    for number, setting in enumerate(settings):
        step = UNLOADED_STEP * setting.scale
        moved = [errors_of(pair_geometry(setting.moved(pair, place * step), nodes)) for place in PLACES]
        change = rate([one.envelope_at(places[::16]) for one in moved], step)
        limit = TOLERANCE * np.nanmax(np.abs(own[:, number])) + GAP_ROUNDING / step
        # All of them, but where the carrying pair changes just there.
        assert np.sort(np.abs(change - own[:, number]))[:-1].max() < limit, setting
        by_steps = rate([np.asarray(range_of(one)) for one in moved], step)
        assert 1e-6 * slopes["unloaded_peak_to_peak"][number] == pytest.approx(by_steps, abs=limit), setting


def test_unloaded_error_follows_the_gear_as_its_splines_do() -> None:
    """High powers of the roll bend the gear's flank within a cell of the grid, which the value does not see."""
    settings = tuple(PairSetting("gear", f"modified_roll_{key}") for key in ("120f", "720g"))
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36"), "coast"), (17, 11))
    cycle = MeshCycle.of(geometry, mesh_positions=4)
    slopes = unloaded_slopes(geometry, cycle.lines, settings, field_slopes(geometry, settings)).slopes
    own, places = slopes[:: len(slopes) // 8], np.arange(8) / 8
    for number, setting in enumerate(settings):
        step = 2e-3 * setting.scale
        found = [anew(cycle, setting.moved(cycle.geometry.pair, place * step)) for place in PLACES]
        errors = [PairErrors.of(TurnedFlanks(one.geometry), one.lines) for one in found]
        change = rate([one.envelope_at(places) for one in errors], step)
        assert np.abs(change - own[:, number]).max() < 5e-7 * np.abs(own[:, number]).max(), setting


@pytest.mark.quick(1)
@pytest.mark.parametrize("flank", FLANKS)
def test_unloaded_error_follows_a_gear_of_several_parts(flank: FlankName) -> None:
    """Parts of the gear flank join at kinks; each has a spline of its own, which others continue."""
    reliefs = {"toprem": Relief(0.3, 0.0, 30.0), "flankrem": Relief(0.6, 0.0, 50.0)}
    geometry = relieved(gear_pair(read_case("nasa-12x36"), flank), "gear", (17, 15), **reliefs)
    cycle = MeshCycle.of(geometry, mesh_positions=4)
    setting = PairSetting("gear", "pressure_angle")
    own = unloaded_slopes(geometry, cycle.lines, [setting], field_slopes(geometry, [setting])).slopes[:, 0]
    step = 1e-3 * setting.scale
    found = [anew(cycle, setting.moved(geometry.pair, place * step)) for place in PLACES]
    errors = [PairErrors.of(TurnedFlanks(one.geometry), one.lines) for one in found]
    change = rate([one.envelope_at(np.arange(64) / 64) for one in errors], step)
    assert np.abs(change - own).max() < 1e-8 * np.abs(own).max()


def errors_of(geometry: PairGeometry) -> PairErrors:
    return PairErrors.of(TurnedFlanks(geometry), lines_of(geometry))


def lines_of(geometry: PairGeometry) -> MeshLines:
    return MeshCycle.of(geometry, mesh_positions=8).lines


def range_of(errors: PairErrors) -> float:
    """Peak to peak of the envelope [rad], by looking ever closer around its extremes."""
    fine, found = errors.fine_envelope(), 0.0
    for sign in (1.0, -1.0):
        place, reach = np.argmax(sign * fine) / fine.size, 1.5 / fine.size
        for _ in range(6):
            around = place + np.linspace(-reach, reach, 101)
            heights = sign * errors.envelope_at(np.mod(around, 1.0))
            place, reach = around[np.argmax(heights)], 0.025 * reach
        found += float(np.max(heights))
    return found


@pytest.mark.parametrize(
    ("name", "setting"),
    [
        ("fm-11x41", PairSetting("gear", "cutter_tilt")),
        ("fh-12x41-45", PairSetting("pinion", "radial_distance")),
    ],
)
def test_unloaded_range_agrees_with_differences_of_itself(name: str, setting: PairSetting) -> None:
    """Where two pairs' errors cross, the value is that of the crossing, not of a place near it."""
    cycle = MeshCycle.of(pair_geometry(gear_pair(read_case(name)), (9, 7)), mesh_positions=4)

    def found(pair: GearPair) -> UnloadedSlopes:
        moved = anew(cycle, pair)
        return unloaded_slopes(moved.geometry, moved.lines, [setting], field_slopes(moved.geometry, [setting]))

    own, step = found(cycle.geometry.pair), 1.5e-4 * setting.scale
    peaks = [found(setting.moved(cycle.geometry.pair, place * step)).peak_to_peak for place in PLACES]
    change = rate([np.asarray(peak) for peak in peaks], step)
    # Both courses move, a hundred times as much as where they cross.
    assert own.peak_slopes[0] == pytest.approx(change, abs=1e-7 * np.abs(own.slopes).max())


def test_user_gets_names_and_units_of_sweeps() -> None:
    case = coarse("fm-11x41")
    names = ["torque", "gear.convex.machine.cradle_angle", "E", "modification.bias"]
    tree = derivatives(case, names, torques=[100.0, 200.0])
    slopes = tree["derivatives"].to_dataset()
    assert slopes["setting"].values.tolist() == names
    assert slopes["setting_units"].values.tolist() == ["N m", "degree", "mm", "um"]
    assert slopes["transmission_error"].dims == ("torque", "mesh_position", "setting")
    assert slopes["transmission_error"].attrs["units"] == "urad per setting_units"
    # More torque winds the pair up, whatever the setting is called.
    assert (slopes["mean_level"].sel(setting="torque") > 0.0).all()
    cycle = coarse_cycle("fm-11x41")
    plain = cycle_slopes(cycle, [PairSetting("gear", "cradle_angle")], *cycle.loaded([100.0, 200.0]))[1]
    in_degrees = np.radians(1.0) * plain["transmission_error"].values[..., 0]
    np.testing.assert_allclose(slopes["transmission_error"].values[..., 1], in_degrees, rtol=1e-9)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (
            ["pinion.convex.machine.radial_distance"],
            "setting = .*: must be a machine or cutter setting",
        ),
        (
            ["gear.convex.machine.ratio_of_roll"],
            "setting = .*: must be a machine or cutter setting",
        ),
        (["E", "E"], "settings = .*none of them twice"),
        ([], "settings = "),
    ],
)
def test_wrong_settings_are_refused(settings: list[str], said: str) -> None:
    with pytest.raises(InputError, match=said):
        derivatives(coarse("fm-11x41"), settings)


def test_plates_are_refused() -> None:
    case = read_case("fm-11x41")
    plates = case.model_copy(update={"compliance": case.compliance.model_copy(update={"model": "shell"})})
    with pytest.raises(InputError, match=r"compliance.model = 'shell'"):
        derivatives(plates, ["E"])


# --- Derivatives by the load


SETTINGS = (PairSetting("pinion", "radial_distance"), PairSetting("gear", "pressure_angle"))
LOAD_TORQUES = [100.0, 250.0]
STEP_SHARE = 2.5e-6  # of the usual step of a setting; errors fall with its square, to 1e-6 here


def loss_of(cycle: MeshCycle, loaded: xr.Dataset) -> xr.Dataset:
    tree = xr.DataTree.from_dict({"ease_off": cycle.geometry.ease_off, "loaded": loaded})
    return friction(tree, OPERATION, FrictionModel(), segment_fields=False)


def test_values_are_those_of_the_friction_stage() -> None:
    cycle = coarse_cycle("nasa-12x36")
    loaded, _ = cycle.loaded(LOAD_TORQUES)
    whole, values = loss_of(cycle, loaded), loss_values(cycle, loaded, OPERATION, FrictionModel())
    for name in values:
        np.testing.assert_array_equal(values[name], whole[name])


@pytest.mark.quick(1)
@pytest.mark.parametrize("setting", SETTINGS, ids=lambda one: f"{one.of}_{one.name}")
def test_losses_and_place_of_the_load_agree_with_differences(setting: PairSetting) -> None:
    cycle = coarse_cycle("nasa-12x36")
    loaded, cases = cycle.loaded(LOAD_TORQUES)
    found = CycleSlopes.of(cycle, [setting], cases)
    slopes, step = found.datasets(loaded)[1], STEP_SHARE * setting.scale
    values, of_loss = loss_slopes(found, loaded, OPERATION, FrictionModel())
    whole = loss_of(cycle, loaded)
    np.testing.assert_array_equal(values["mean_power_loss"], whole["mean_power_loss"])
    np.testing.assert_array_equal(values["efficiency"], whole["efficiency"])
    moved = [anew(cycle, setting.moved(cycle.geometry.pair, sign * step)) for sign in (1.0, -1.0)]
    both = [(one, one.loaded(LOAD_TORQUES)[0]) for one in moved]
    spots = [load_spot(one) for _, one in both]
    for name in spots[0]:
        change = (spots[0][name][1] - spots[1][name][1]) / (2.0 * step)
        # At one torque the derivative may be next to nothing, and rounding of the difference is not.
        rounding = 1e-5 * np.abs(change).max()
        np.testing.assert_allclose(slopes[name].values[:, 0], change, rtol=1e-4, atol=rounding, err_msg=name)
    ahead, behind = (loss_of(*one) for one in both)
    for name in ("mean_power_loss", "efficiency", "mean_friction_coefficient"):
        change = ((ahead[name] - behind[name]) / (2.0 * step)).values
        np.testing.assert_allclose(of_loss[name].values[..., 0], change, rtol=1e-5, err_msg=name)


def test_loss_follows_the_torque() -> None:
    cycle, step = coarse_cycle("nasa-12x36"), 1e-3
    loaded, cases = cycle.loaded(LOAD_TORQUES)
    found = CycleSlopes.of(cycle, SETTINGS[:1], cases)
    slopes = loss_slopes(found, loaded, OPERATION, FrictionModel())[1]
    ahead, behind = (loss_of(cycle, cycle.loaded(np.array(LOAD_TORQUES) + sign * step)[0]) for sign in (1.0, -1.0))
    change = (ahead["mean_power_loss"].values - behind["mean_power_loss"].values) / (2.0 * step)
    np.testing.assert_allclose(slopes["mean_power_loss"].values[..., -1], change, rtol=1e-5)
    # Twice pi times the speed over a minute is what a newton metre more brings in.
    np.testing.assert_allclose(slopes["input_power"].values[..., -1], np.pi * 1500.0 / 30.0, rtol=1e-9)
    np.testing.assert_allclose(slopes["input_power"].values[..., 0], 0.0, atol=1e-6)


def test_gradient_of_the_largest_stress_gives_it_back() -> None:
    """Stress is linear in the forces, so that its largest principal one is homogeneous."""
    generator = np.random.default_rng(5)
    root = StressResponse(np.linspace(0.1, 0.9, 3), generator.normal(size=(3, 4, 6, 5)))
    forces = generator.uniform(0.5, 1.0, size=(5, 7))
    gradient, largest = root.gradients(forces), root.largest(forces).max(axis=0)
    np.testing.assert_allclose(np.sum(gradient * forces, axis=0), largest, rtol=1e-12)
    change = generator.normal(size=forces.shape)
    ahead, behind = (root.largest(forces + sign * 1e-6 * change).max(axis=0) for sign in (1.0, -1.0))
    np.testing.assert_allclose(np.sum(gradient * change, axis=0), (ahead - behind) / 2e-6, rtol=1e-6)


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45", "fh-design-a", "fh-design-b"])
def test_root_stress_agrees_with_differences(name: str) -> None:
    state = CaseInMesh.of(coarse(name, "fe"))
    cycle, teeth = state.cycle, state.teeth
    assert teeth is not None
    loaded, cases = cycle.loaded(LOAD_TORQUES)
    analyses = Analyses(tuple(LOAD_TORQUES), roots=teeth)
    slopes = analyses.slopes(cycle, list(SETTINGS))
    told, values = root_stress(cycle.fields, teeth, cases, loaded), analyses.numbers(cycle)[0]
    np.testing.assert_array_equal(values["max_root_stress"], told["max_root_stress"])
    for number, setting in enumerate(SETTINGS):
        own = slopes.isel(setting=number)
        found = departures(analyses.along(cycle, setting), own, longest_step(setting, own), TOLERANCE)
        for variable in ("root_stress_history", "max_root_stress"):
            assert found[variable].farther < TOLERANCE, (setting, variable)
            assert found[variable].compared > 0.7, (setting, variable)
    # More torque, more stress, in every root.
    assert (slopes["max_root_stress"].isel(setting=-1) > 0.0).all()


@pytest.mark.parametrize("name", ["fm-11x41", "fh-design-a"])
def test_thickness_follows_the_gear_cutter_alone(name: str) -> None:
    pair = gear_pair(read_case(name))
    by_radius, by_distance = PairSetting("gear", "point_radius"), PairSetting("pinion", "radial_distance")
    slopes = thickness_slopes(pair, [by_radius, by_distance, PairSetting("assembly", "offset")])
    assert slopes[0, 0] < 0.0
    if pair.gear.mean_thickness is None:
        assert slopes[1, 0] > 0.5
    else:  # a given thickness is what the settings leave as it is
        assert slopes[1, 0] == pytest.approx(0.0, abs=1e-9)
    # The pinion's other flank follows the loaded one: no more changes than the angle at which the tooth stands.
    assert abs(slopes[0, 1]) < 0.1
    assert slopes[1, 1] == 0.0
    assert np.all(slopes[:, 2] == 0.0)
    # Both teeth fill the pitch: what the gear's angle gains the pinion's loses.
    step = 1e-3 * by_radius.scale
    ahead, behind = (np.array(tooth_angles(by_radius.moved(pair, sign * step))) for sign in (1.0, -1.0))
    counts = np.array([pair.pinion.teeth, pair.gear.teeth])
    assert np.sum(counts * (ahead - behind)) == pytest.approx(0.0, abs=1e-12)
    own = mean_thicknesses(pair)[0] / tooth_angles(pair)[0] * (ahead - behind)[0] / (2.0 * step)
    assert slopes[0, 0] == pytest.approx(own, rel=1e-6)


def test_user_gets_losses_with_a_speed_and_the_torque_alone() -> None:
    tree = derivatives(coarse("nasa-12x36"), ["torque"], torques=LOAD_TORQUES, speed=[1000.0, 2000.0])
    slopes = tree["derivatives"].to_dataset()
    assert slopes["setting"].values.tolist() == ["torque"]
    assert slopes["mean_power_loss"].dims == ("torque", "speed", "temperature", "roughness", "setting")
    assert slopes["efficiency"].attrs["units"] == "1 per setting_units"
    assert (slopes["mean_power_loss"] > 0.0).all()
    assert tree.attrs["edge_contact"] == 1
    assert (slopes["tooth_thickness"] == 0.0).all()


def test_user_gets_losses_by_deviations() -> None:
    tree = derivatives(coarse("nasa-12x36"), ["modification.bias"], torques=LOAD_TORQUES, speed=[1000.0])
    slopes = tree["derivatives"].to_dataset()
    share = slopes["mean_power_loss"] / slopes["efficiency"]
    power = np.array(LOAD_TORQUES) * np.pi * 1000.0 / 30.0
    np.testing.assert_allclose(share.values.ravel(), -power, rtol=1e-9)
