"""Search for machine settings: the model against analyses, limits, multipliers, assemblies, fronts, and the command."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from extreme_designs import Extreme
from pairs import conjugate_pair
from runs import SMALL, output_of, refusal_of, small
from shared import Shared
from tooth_models import with_teeth

import easeoff
from easeoff import Case, GeometryError, InputError, optimize
from easeoff.cases import gear_pair, parse_case, parse_design, write_case
from easeoff.geometry import EaseOffTarget, Misalignment, fit_pinion
from easeoff.geometry.cutting.machine import machine_pose
from easeoff.geometry.cutting.named_settings import (
    BLADE_STEPS,
    CURVATURE_STEPS,
    MACHINE_STEPS,
    MODIFIED_ROLL_ORDERS,
    MachineResolution,
    get_setting,
    scale_of,
    with_settings,
)
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.near_pair import PairSetting
from easeoff.study.case_in_mesh import CaseInMesh
from easeoff.study.design.case_design import design_case
from easeoff.study.design.optimization.aim import LOST_TIP, Aim, ContactQuantity, Judgement, Objective, QuantityLimit
from easeoff.study.design.optimization.analysed_settings import (
    AnalysedSettings,
    Workshop,
    blade_tip_gaps,
    blade_tip_slopes,
    usual_root_line_change,
)
from easeoff.study.design.optimization.free_setting import SettingSpace, free_settings, with_limits
from easeoff.study.design.optimization.setting_optimization import corner_assemblies, sampled_assemblies
from easeoff.study.design.optimization.setting_search import SettingSearch, first_workshop
from easeoff.study.summary.settings_report import setting_report

RADIAL, ROLL = "pinion.concave.machine.radial_distance", "pinion.concave.machine.ratio_of_roll"
TWO = [RADIAL, ROLL]
TORQUE = 150.0


@pytest.fixture(scope="module", autouse=True)
def shared() -> Iterator[None]:
    """Searches begin with the same pair in mesh: it is computed once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(CaseInMesh, "of", classmethod(Shared().once(CaseInMesh.of.__func__)))  # type: ignore[attr-defined]
        yield


@cache
def coarse_case() -> Case:
    """Of the fewest functions, each tooth on a body of its own: shells have no exact derivatives."""
    case = small("nasa-12x36", torques=(TORQUE,))
    return with_teeth(case, "solid_shell", fineness=0.2, neighbours=False)


def quick(minimize: list[str], **options: Any) -> xr.DataTree:
    return optimize(coarse_case(), minimize, free=TWO, **options)


@cache
def first() -> tuple[Workshop, Any]:
    """Where searches begin, whatever they are for, and what is read there."""
    case = coarse_case()
    space = SettingSpace(case, free_settings(case, ["drive"], TWO))
    state = CaseInMesh.of(case)
    own = state.pair.assembly.misalignment
    rough = Workshop(space, (TORQUE,), (own,), {"drive": state}, np.ones(2))
    return first_workshop(rough)


@cache
def begun(*quantities: str) -> AnalysedSettings:
    workshop, readings = first()
    space = workshop.space
    bounded = replace(space, free=with_limits(space.free, workshop.units, 100.0, {}))
    searching = SettingSearch(replace(workshop, space=bounded), readings, steps=1)
    aim = Aim(
        tuple(Objective(ContactQuantity.parsed(text)) for text in quantities), (), "worst", (TORQUE,), ("drive",), 1
    )
    references = aim.references(searching.begun(Judgement(aim, ())).read)
    return searching.begun(Judgement(aim, references))


def test_a_node_that_the_moved_pair_lacks_asks_for_no_correction(monkeypatch: pytest.MonkeyPatch) -> None:
    """It once counted with its whole ease-off, which moved the settings as far."""
    start = begun("max_pressure")
    form, step = start.forms["drive"], np.array([0.3, -0.2])
    pair = gear_pair(start.workshop.space.case_at(start._values(start.settings + step)))
    whole = form.missed(pair, step)

    def holed(*given: Any) -> Any:
        found = exact_ease_off(*given)
        angle = found.angle.copy()
        angle[-1] = np.nan
        return replace(found, angle=angle)

    monkeypatch.setattr("easeoff.study.design.optimization.aim.exact_ease_off", holed)
    missed = form.missed(pair, step)
    assert missed[-1] == 0.0
    assert np.abs(missed).max() < 2.0 * np.abs(whole).max() < 0.1


def test_a_tip_that_no_longer_reaches_its_place_passes_the_limit() -> None:
    start = begun("max_pressure").readings["drive", 0].values
    lost = start.assign(blade_tip_gap=start["blade_tip_gap"].where(start["root_place"] != "heel"))
    quantity = ContactQuantity.parsed("root_line_change")
    assert quantity.composite(start, None, 0, start).value() == 0.0
    assert quantity.composite(lost, None, 0, start).value() == LOST_TIP
    assert quantity.composite(lost, None, 0, lost).value() == 0.0


@pytest.mark.thorough
def test_the_model_is_tangent_to_analyses() -> None:
    """Halving a step divides what the model misses by four, until contact changes are met."""
    quantities = ("peak_to_peak", "harmonic_1", "max_pressure", "load_centre_lengthwise", "ease_off_change")
    start = begun(*quantities)
    model = start.model(1.0)
    assert model.objectives[0][0].value() == pytest.approx(1.0)
    for group in model.objectives[:4]:
        missed = []
        for size in (4e-3, 2e-3):
            step = size * np.array([1.0, -0.5])
            there = start.moved(step)
            assert there is not None
            # The step is corrected so that the ease-off comes out as promised.
            number = model.objectives.index(group)
            fresh = there.model(1.0).objectives[number][0].value()
            missed.append(abs(fresh - group[0].value(there.settings - start.settings)))
        assert missed[1] < 0.4 * missed[0] + 1e-9


def test_values_are_those_of_an_analysis() -> None:
    start = begun("peak_to_peak", "max_pressure", "harmonic_2")
    _, values, _ = start.judgement.worst(start.read)
    tree = easeoff.analyze(coarse_case())
    loaded = tree["loaded"].to_dataset()
    known = [loaded["peak_to_peak"].item(), loaded["max_pressure"].item(), loaded["harmonic"].sel(order=2).item()]
    assert values == pytest.approx(known, rel=1e-9)


def test_differences_of_analyses_come_near_exact_derivatives() -> None:
    start = begun("peak_to_peak", "max_pressure")
    (exact,) = start.readings.values()
    other = start.by_differences()
    assert other is not None
    (found,) = other.readings.values()
    assert other.by_differences() is None
    for name in ("transmission_error", "ease_off", "blade_tip_gap", "load_centre_lengthwise"):
        known = exact.slopes[name].transpose(*found.slopes[name].dims)
        assert float(np.abs(found.slopes[name] - known).max()) < 0.02 * float(np.abs(known).max())
    greatest = exact.values["pressure"].fillna(0.0).argmax(...)
    for known, near in ((exact.slopes["pressure"][greatest], found.slopes["pressure"][greatest]),):
        assert near.values == pytest.approx(known.values, rel=0.05)


def without_derivatives(*_args: Any, **_keywords: Any) -> Any:
    raise GeometryError("a contact line ends at a hole of the flank")


def test_where_there_are_no_exact_derivatives_analyses_lead_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pair with undercut was once refused, and a search ended where a contact line began to end there."""
    usual = quick(["max_pressure"], steps=1)["optimal_settings"].to_dataset()
    monkeypatch.setattr("easeoff.study.analysis.setting_derivatives.SolvedContact.differentiated", without_derivatives)
    record = quick(["max_pressure"], steps=1)["optimal_settings"].to_dataset()
    assert record.attrs["differentiated_analyses"] == 0
    assert record["accepted"].item() == 1
    assert record["objective_ratio"].item() == pytest.approx(usual["objective_ratio"].item(), abs=2e-3)


def test_refused_proposals_are_named_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Once the report said of them that nothing better was found, and asked for more steps."""

    def refused(*_args: Any) -> Any:
        raise GeometryError("there is no whole tooth")

    monkeypatch.setattr("easeoff.study.design.optimization.analysed_settings.tooth_surface", refused)
    tree = quick(["max_pressure"])
    record, said = tree["optimal_settings"].to_dataset(), setting_report(tree)
    count = record.sizes["programme"]
    assert record.attrs["ended"] == "no_gain"
    assert record.attrs["refused_proposals"] == count > 3
    assert set(record["refusal"].values.tolist()) == {"there is no whole tooth"}
    assert f"Refused, not analysed: {count} of {count} proposals: there is no whole tooth" in said
    assert "No proposal could be analysed" in said
    assert "better than the start" not in said.replace("whether there is something better than the start", "")
    assert "--steps" not in said


@pytest.mark.thorough
def test_a_pair_at_95_degrees_is_improved_within_its_limits() -> None:
    """Every proposal was refused, by a check of its teeth that took too long strides along their fillets."""
    design = Extreme((19, 62), module=3.0, shaft=95.0, spiral=30.0, generated=True).text("modified_roll")
    case, _ = design_case(parse_design(design))
    case = case.model_copy(update={"contact": case.contact.model_copy(update=SMALL)})
    tree = optimize(case, ["peak_to_peak"], limits=["ease_off_change<=15"], steps=3)
    record = tree["optimal_settings"].to_dataset()
    assert np.all(np.isfinite(record["fresh_objective"]))
    assert record["objective_ratio"].item() < 0.97
    assert record["limited_value"].values[0] <= 15.0


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_settings_are_rounded_within_their_limits(side: float) -> None:
    """Limits between steps of the machine: the nearest multiple beyond one is not taken."""
    space = begun("max_pressure").workshop.space
    low, high = 74.8691, 74.8795
    free = tuple(replace(one, low=low, high=high) if one.name == RADIAL else one for one in space.free)
    coarse_steps = replace(space, free=free, resolution=MachineResolution(length=0.004))
    found = coarse_steps.nearest(np.array([74.87 + side, 3.24]))
    assert found[0] == (74.872 if side < 0.0 else 74.876)
    assert coarse_steps.nearest(space.start)[0] == 74.876
    with pytest.raises(InputError, match=r"pinion.concave.machine.radial_distance = 74.8691:74.8795: must hold a mult"):
        replace(space, free=free, resolution=MachineResolution(length=0.05))


def test_a_search_keeps_limits_between_the_steps_of_the_machine() -> None:
    start = begun("max_pressure").workshop.space.start[0]
    limits = {RADIAL: (start - 0.00513, start + 0.00537)}
    steps = MachineResolution(length=0.004)
    tree = quick(["max_pressure"], limit_settings=limits, steps=1, resolution=steps)
    record = tree["optimal_settings"].to_dataset().sel(setting=RADIAL)
    value = record["setting_value"].item()
    assert limits[RADIAL][0] <= value <= limits[RADIAL][1]
    assert value / 0.004 == pytest.approx(round(value / 0.004), abs=1e-9)
    found = parse_case(tree.attrs["case"])
    assert found.pinion.concave is not None
    assert found.pinion.concave.machine.radial_distance == value


def test_limits_are_of_the_setting_that_moves_not_of_one_that_follows() -> None:
    """The sliding base follows the machine centre: its limits were once taken for those of the machine centre."""
    free = free_settings(coarse_case(), ["drive"])
    with pytest.raises(InputError, match=r"limit_setting = '\*.sliding_base': must be the key of a free setting"):
        with_limits(free, np.ones(len(free)), 100.0, {"*.sliding_base": (-1e3, 1e3)})


@pytest.mark.thorough
def test_two_settings_reach_the_best_of_a_grid() -> None:
    start = begun("peak_to_peak")
    tree = quick(
        ["peak_to_peak"], limit_settings={"*.radial_distance": (74.7, 75.1), "*.ratio_of_roll": (3.238, 3.247)}
    )
    record = tree["optimal_settings"].to_dataset()
    assert record.attrs["converged"] == 1
    held, space = start.workshop.states["drive"], start.workshop.space
    best = np.inf
    for radial in np.linspace(74.7, 75.1, 9):
        for roll in np.linspace(3.238, 3.247, 9):
            cycle = held.recut(space.case_at(np.array([radial, roll]))).cycle
            best = min(best, cycle.loaded([TORQUE])[0]["peak_to_peak"].item())
    assert record["objective_value"].item() <= 1.02 * best


@cache
def limited(bound: float) -> xr.Dataset:
    tree = quick(["max_pressure"], limits=[f"ease_off_change<={bound:g}"])
    return tree["optimal_settings"].to_dataset()


@pytest.mark.thorough
def test_limits_are_kept_and_a_multiplier_is_what_a_moved_limit_gains() -> None:
    here, less, more = (limited(bound) for bound in (8.0, 7.0, 9.0))
    for record, bound in ((here, 8.0), (less, 7.0), (more, 9.0)):
        assert record["limited_value"].values[0] <= bound
        assert record.attrs["violation"] == 0.0
    gain = 0.5 * (less["objective_ratio"].item() - more["objective_ratio"].item())
    assert here["limit_multiplier"].values[0] == pytest.approx(gain, rel=0.3)


def test_distances_of_blade_tips_change_as_their_derivatives_say() -> None:
    """Halving a step divides what the derivative misses by four."""
    pair = gear_pair(easeoff.read_case("fm-11x41"), "drive")
    tilt = PairSetting("pinion", "cutter_tilt")
    gap, change = blade_tip_gaps(pair), blade_tip_slopes(pair, [("tilt", tilt)])
    missed = []
    for step in (2e-3, 1e-3):
        there = blade_tip_gaps(tilt.moved(pair, step))
        missed.append(np.abs(there - gap - np.degrees(step) * change[..., 0]).sel(member="pinion").max().item())
    assert 0.2 * missed[0] < missed[1] < 0.3 * missed[0]
    assert np.abs(change.sel(member="gear")).max() == 0.0


@pytest.mark.thorough
def test_a_tilted_cutter_keeps_to_its_root_line_unless_told_otherwise() -> None:
    case = small("fm-11x41", mesh_positions=4).model_copy(update={"friction": None})
    pair = gear_pair(case, "drive")
    start = blade_tip_gaps(pair)
    changes = []
    for limits in ([], ["root_line_change<=9"]):
        tree = optimize(case, ["peak_to_peak"], torques=[200.0], limits=limits, steps=4)
        found = blade_tip_gaps(gear_pair(parse_case(tree.attrs["case"]), "drive"))
        changes.append(float(np.abs(found - start).max()))
        record = tree["optimal_settings"].to_dataset()
        assert record["quantity_limit"].item().startswith("root_line_change<=")
        assert record["limited_value"].item() == pytest.approx(changes[-1], rel=1e-9)
        assert record["objective_ratio"].item() < 0.9
    assert changes[0] <= usual_root_line_change([pair]) < changes[1]


@pytest.mark.thorough
def test_the_worst_of_all_assemblies_is_what_the_result_says() -> None:
    away = Misalignment(offset=0.05)
    tree = quick(["max_pressure"], misalignments=[away], steps=4)
    record = tree["optimal_settings"].to_dataset()
    found = parse_case(tree.attrs["case"])
    pressures = [
        [easeoff.analyze(case, misalignment=one)["loaded/max_pressure"].item() for one in (None, away)]
        for case in (coarse_case(), found)
    ]
    before, after = (max(row) for row in pressures)
    assert record["objective_start"].item() == pytest.approx(before, rel=1e-9)
    assert record["objective_value"].item() == pytest.approx(after, rel=1e-6)
    assert record["ratio_by_assembly"].values.ravel() == pytest.approx(np.array(pressures[1]) / before, rel=1e-6)
    assert after < before


@cache
def pareto() -> xr.DataTree:
    return quick(["peak_to_peak", "max_pressure"], form="pareto", points=3, steps=6)


@pytest.mark.thorough
def test_every_point_of_a_front_is_what_an_analysis_of_its_settings_says() -> None:
    front, record = pareto()["front"].to_dataset(), pareto()["optimal_settings"].to_dataset()
    space = begun("peak_to_peak").workshop.space
    for point in range(front.sizes["point"]):
        one = front.isel(point=point)
        loaded = easeoff.analyze(space.case_at(one["front_setting"].values, rounded=True))["loaded"].to_dataset()
        known = [loaded["peak_to_peak"].item(), loaded["max_pressure"].item()]
        assert one["front_value"].values == pytest.approx(known, rel=1e-6)
        assert one["front_ratio"].values == pytest.approx(known / record["objective_start"].values, rel=1e-6)
    ratios = front["front_ratio"].values
    assert np.all(np.diff(ratios[:, 1]) > 0.0)
    assert ratios[-1, 0] == ratios[:, 0].min()
    assert len(easeoff.plot.front(pareto(), others={"genetic": ratios}).axes) == 1


@pytest.mark.thorough
def test_a_front_resumes_with_the_points_that_are_there(tmp_path: Path) -> None:
    easeoff.write_result(pareto(), tmp_path / "front.nc")
    earlier = easeoff.read_result(tmp_path / "front.nc")
    tree = quick(["peak_to_peak", "max_pressure"], form="pareto", points=4, steps=6, resume=earlier)
    known, found = (one["front"].to_dataset()["front_setting"].values.tolist() for one in (pareto(), tree))
    assert tree["front"].sizes["point"] == 4
    assert all(row in found for row in known)
    with pytest.raises(InputError, match="resume: its objectives are peak_to_peak, max_pressure: must be max_p"):
        quick(["max_pressure", "peak_to_peak"], form="pareto", resume=earlier)


@pytest.mark.thorough
def test_settings_are_rounded_and_analysed_rounded() -> None:
    tree = quick(["max_pressure"], steps=2, spread={"E": "uniform(-0.01,0.01)"}, samples=2)
    record = tree["optimal_settings"].to_dataset()
    steps = record["setting_value"].values / np.array([1e-3, 1e-6])
    assert steps == pytest.approx(np.round(steps), abs=1e-6)
    found = parse_case(tree.attrs["case"])
    assert found.pinion.concave is not None
    assert found.pinion.concave.machine.radial_distance == record["setting_value"].sel(setting=RADIAL).item()
    xr.testing.assert_allclose(easeoff.analyze(found)["loaded"].to_dataset(), tree["loaded"].to_dataset())
    accepted = record["accepted"].values.astype(bool)
    assert np.all(np.diff(record["fresh_objective"].values[accepted]) < 0.0)
    assert record["sample_ratio"].shape == (1, 2)
    assert record.sizes["assembly"] == 5  # its own, both ends of the distribution, and the samples


def test_an_assembly_drawn_anew_that_has_no_analysis_is_a_gap(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search is not lost for it, and the report counts it."""
    compute, drawn = Workshop.readings, []

    def readings(workshop: Workshop, case: Case) -> Any:
        if len(workshop.assemblies) == 1:
            drawn.append(workshop)
            if len(drawn) == 2:
                raise GeometryError("the flanks do not meet")
        return compute(workshop, case)

    monkeypatch.setattr(Workshop, "readings", readings)
    tree = quick(["max_pressure"], steps=1, spread={"E": "uniform(-0.01,0.01)"}, samples=2)
    ratios = tree["optimal_settings"].to_dataset()["sample_ratio"].values
    assert np.isfinite(ratios).tolist() == [[True, False]]
    assert "In 1 assembl" in setting_report(tree)
    assert "; 1 more could not be analysed" in setting_report(tree)


@pytest.mark.quick(1)
@pytest.mark.parametrize("exact", [False, True])
def test_settings_whose_rounded_teeth_cannot_be_built_are_kept(monkeypatch: pytest.MonkeyPatch, exact: bool) -> None:
    """As they are found, or beside the analysis of the start where these have no teeth either."""
    whole = Workshop.with_teeth

    def without(self: Workshop, case: Case, *rest: Any) -> Workshop:
        assert case.pinion.concave is not None
        radial = case.pinion.concave.machine.radial_distance
        assert radial is not None
        if not exact or abs(radial - round(radial, 3)) < 1e-12:
            raise GeometryError("no tooth")
        return whole(self, case, *rest)

    monkeypatch.setattr(Workshop, "with_teeth", without)
    tree = quick(["max_pressure"], steps=1)
    record = tree["optimal_settings"].to_dataset()
    assert np.any(record["setting_found"] != record["setting_start"])
    assert np.array_equal(record["setting_value"], record["setting_found" if exact else "setting_start"])
    assert (record["objective_ratio"].item() < 1.0) is exact
    told = "as they are" if exact else "only in 'setting_found'"
    assert f"the settings found cannot be rounded: no tooth; the result has them {told}" in setting_report(tree)
    kept = parse_case(tree.attrs["case"])
    assert kept.pinion.concave is not None
    radial = record["setting_value"].sel(setting=RADIAL).item()
    assert kept.pinion.concave.machine.radial_distance == pytest.approx(radial, rel=1e-12)


def test_both_flanks_of_one_set_up_move_together() -> None:
    case = easeoff.read_case("fm-11x41")
    free = free_settings(case, ["drive", "coast"], ["gear.*.machine.radial_distance"])
    assert [one.name for one in free] == ["gear.*.machine.radial_distance"]
    moved = SettingSpace(case, free).case_at(np.array([free[0].start + 0.1]))
    radial = [getattr(moved.gear, side).machine.radial_distance for side in ("concave", "convex")]
    assert radial[0] == radial[1] == pytest.approx(free[0].start + 0.1)
    assert moved.pinion == case.pinion


def test_without_tilt_the_sliding_base_keeps_the_tip_plane_through_its_apex() -> None:
    free = free_settings(coarse_case(), ["drive"])
    names = [one.name for one in free]
    assert "pinion.concave.machine.cutter_tilt" not in names
    centre = names.index("pinion.concave.machine.machine_center_to_crossing_point")
    values = np.array([one.start for one in free])
    values[centre] += 1.0
    flanks = [case.pinion.concave for case in (coarse_case(), SettingSpace(coarse_case(), free).case_at(values))]
    machine = [flank.machine for flank in flanks if flank is not None]
    angle = np.radians(machine[0].machine_root_angle)
    apex = [one.machine_center_to_crossing_point + one.sliding_base / np.sin(angle) for one in machine]
    assert apex[1] == pytest.approx(apex[0], abs=1e-9)


def test_samples_are_drawn_about_the_own_assembly_and_repeat() -> None:
    own = Misalignment(0.1, 0.2, 0.3, 0.0)
    first, again, other = (sampled_assemblies(own, {"Sigma": "normal(0,0.1)"}, 4, seed) for seed in (3, 3, 4))
    assert first == again != other
    assert {(one.offset, one.pinion_axial, one.gear_axial) for one in first} == {(0.1, 0.2, 0.3)}
    assert max(abs(one.shaft_angle) for one in first) < np.radians(0.5)


def test_corners_combine_the_bounds_and_leave_a_normal_error_as_it_is() -> None:
    spread = {"E": "uniform(-0.02, 0.02)", "P": "uniform(0.0, 0.1)", "G": "normal(0, 0.1)"}
    found = [(one.offset, one.pinion_axial, one.gear_axial) for one in corner_assemblies(Misalignment(), spread)]
    assert found == [(-0.02, 0.0, 0.0), (-0.02, 0.1, 0.0), (0.02, 0.0, 0.0), (0.02, 0.1, 0.0)]


def test_limits_and_quantities_are_read_as_they_are_written() -> None:
    band = QuantityLimit.parsed("load_centre_lengthwise@150 = 0.5+-0.05")
    assert [one.text for one in band] == ["load_centre_lengthwise@150<=0.55", "load_centre_lengthwise@150>=0.45"]
    assert ContactQuantity.parsed("coast.harmonic_3@50").text == "coast.harmonic_3@50"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"minimize": ["peak"]}, "quantity = 'peak': must be one of peak_to_peak, harmonic_1"),
        ({"minimize": []}, "must name a quantity at least"),
        ({"minimize": ["max_pressure@99"]}, "must be at one of the torques 150"),
        ({"minimize": ["coast.max_pressure"]}, "must be of the flanks that are analysed, drive"),
        ({"minimize": ["ease_off_change@150"]}, "must be without torque"),
        ({"limits": ["max_pressure<1500"]}, "limit = 'max_pressure<1500': must be QUANTITY<=VALUE"),
        ({"limits": ["max_pressure>=1500"]}, "must be an upper limit"),
        (
            {"limits": ["load_centre_profile<=0.3", "load_centre_profile>=0.6"]},
            "limit = 'load_centre_profile<=0.3': must be above the lower limit of the same quantity",
        ),
        ({"limits": ["max_pressure<=-1"]}, "limit of max_pressure = -1: must be"),
        ({"form": "best"}, "form = 'best': must be one of"),
        ({"form": "pareto", "minimize": ["max_pressure"]}, "must be two quantities"),
        ({"form": "pareto", "points": 1}, "points = 1: must be a whole number from 2"),
        ({"weights": [1.0]}, "weights = .*: must be as many as objectives, 2"),
        ({"free": ["pinion.concave.machine.radial_distanse"]}, "radial_distance"),
        ({"limit_settings": {"*.cutter_tilt": (0.0, 1.0)}}, "must be the key of a free setting such as pinion.concave"),
        ({"limit_settings": {"*.radial_distance": (1.0, 2.0)}}, "with the present value 74.87"),
        ({"samples": 3}, "samples = 3: must go with a distribution"),
        ({"spread": {"Q": "normal(0,1)"}, "samples": 3}, "must be of one of E, P, G, Sigma"),
        ({"steps": 0}, "steps = 0: must be a whole number"),
        ({"flank": "left"}, "flank = 'left': must be"),
        ({"minimize": ["pinion_root_stress"]}, "model = 'fe'"),
        (
            {"minimize": ["mean_power_loss"]},
            r"quantity = 'mean_power_loss': must be of a case with a speed in \[friction\]",
        ),
        ({"resume": xr.DataTree()}, "resume: must be a result of 'easeoff optimize'"),
    ],
)
def test_mistakes_are_told(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        optimize(coarse_case(), **{"minimize": ["peak_to_peak", "max_pressure"], "free": TWO, **options})


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--minimize", "peak"], "quantity = 'peak': must be one of"),
        (["--spread", "E=0.1"], "must be E, P, G or Sigma with a distribution"),
        (["--limit-setting", "x"], "must be KEY=LOW:HIGH"),
        (["--weight", "a"], "must be numbers separated by commas"),
        (["--case", "best.nc"], "best.nc"),
        (["--resume", "none.nc"], "none.nc"),
    ],
)
def test_the_command_tells_mistakes_and_writes_nothing(
    arguments: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert said in refusal_of("optimize", "nasa-12x36", "-o", "out.nc", *arguments)
    assert not list(tmp_path.iterdir())


@pytest.mark.thorough
def test_the_command_writes_result_and_case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_case(coarse_case(), tmp_path / "case.toml", "coarse")
    arguments = ["optimize", "case.toml", "-o", "out.nc", "--minimize", "max_pressure", "--free", RADIAL]
    assert "worst ratio" in output_of(*arguments, "--steps", "2", "--case", "best.toml")
    record = easeoff.read_result("out.nc")["optimal_settings"].to_dataset()
    best = easeoff.read_case("best.toml")
    assert best.pinion.concave is not None
    assert best.pinion.concave.machine.radial_distance == record["setting_value"].item()
    output_of(*arguments, "--steps", "1", "--resume", "out.nc")


# --- Free settings


NAMES = [
    *BLADE_STEPS,
    *CURVATURE_STEPS,
    *MACHINE_STEPS,
    *MODIFIED_ROLL_ORDERS,
    "sliding_base_motion_1",
    "cutter_tilt_motion_3",
]


@pytest.mark.parametrize("name", NAMES)
def test_a_setting_reads_back_and_leaves_the_others_alone(name: str) -> None:
    start = conjugate_pair().pinion.loaded
    moved = with_settings(start, {name: get_setting(start, name) + scale_of(name)})
    for other in NAMES:
        change = scale_of(name) if other == name else 0.0
        assert get_setting(moved, other) - get_setting(start, other) == pytest.approx(change, rel=1e-9)


def test_motion_moves_its_setting_by_the_derivatives() -> None:
    start = conjugate_pair().pinion.loaded
    moved = with_settings(start, {"sliding_base_motion_1": 1.5, "sliding_base_motion_3": -4.0})
    increment = 0.2
    basic = get_setting(start, "sliding_base")
    wanted = basic + 1.5 * increment - 4.0 * increment**3 / math.factorial(3)
    still = with_settings(start, {"sliding_base": wanted})
    cradle = np.array([moved.sense * increment])
    one, two = (machine_pose(s.settings, cradle, s.sense).origin for s in (moved, still))
    np.testing.assert_allclose(one, two, rtol=0, atol=1e-12)


def test_several_orders_of_one_motion_stand_together() -> None:
    start = conjugate_pair().pinion.loaded
    moved = with_settings(start, {"work_offset_motion_2": 3.0, "work_offset_motion_1": 2.0, "modified_roll_24e": 1.2})
    assert dict(moved.settings.motions) == {"work_offset": (2.0, 1.5)}
    assert moved.settings.modified_roll == pytest.approx((0.0, 0.0, 0.05))


@pytest.mark.parametrize("name", ["blade", "sliding_base_motion_7", "ratio_of_roll_motion_1", "modified_roll"])
def test_other_names_are_refused(name: str) -> None:
    with pytest.raises(InputError, match=name):
        scale_of(name)


@pytest.mark.thorough
def test_curved_blade_gives_profile_crowning_that_a_straight_one_cannot() -> None:
    """A hollow blade crowns the pinion; its curvature is near that of the wanted parabola over the flank's depth."""
    pair, target = conjugate_pair(), EaseOffTarget(profile_crowning=0.02)
    free = ("point_radius", "pressure_angle", "radial_distance", "work_offset", "machine_center_to_crossing_point")
    straight = fit_pinion(pair, target, free=free)
    curved = fit_pinion(pair, target, free=(*free, "blade_curvature"))
    rms = [float(np.sqrt(np.mean(fit.residual**2))) for fit in (straight, curved)]
    assert rms[1] < 0.3 * rms[0]
    corners = pair.gear.section.corners
    half_depth = 0.5 * float(np.mean(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)))
    curvature = curved.moved["blade_curvature"][1]
    assert curvature == pytest.approx(2.0 * 0.02 / half_depth**2, rel=0.2)
    assert curved.surface.blade.spheric_radius == pytest.approx(1.0 / curvature)
