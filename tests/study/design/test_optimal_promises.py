"""What a search for settings promises: fronts, multipliers, unseen assemblies, resumed searches and rounding."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import small

import easeoff
from easeoff import Case, optimize
from easeoff.cases import parse_case
from easeoff.contact.solvers import Status
from easeoff.geometry import Misalignment
from easeoff.geometry.cutting.named_settings import MachineResolution
from easeoff.study.case_in_mesh import CaseInMesh
from easeoff.study.design.optimization.free_setting import SettingSpace, free_settings
from easeoff.study.design.optimization.setting_optimization import sampled_assemblies
from easeoff.study.design.optimization.step_programme import Composite, LocalModel, StepProgramme
from easeoff.study.design.optimization.trust_region import GAIN_TOLERANCE

RADIAL, ROLL = "pinion.concave.machine.radial_distance", "pinion.concave.machine.ratio_of_roll"
TWO = [RADIAL, ROLL]
TORQUE = 150.0
OBJECTIVES = ("peak_to_peak", "max_pressure")


@cache
def coarse_case() -> Case:
    return small(mesh_positions=4, torques=(TORQUE,))


def searched(minimize: tuple[str, ...], **options: Any) -> xr.DataTree:
    return optimize(coarse_case(), minimize, free=TWO, **options)


def case_at(settings: xr.DataArray) -> Case:
    case = coarse_case()
    return SettingSpace(case, free_settings(case, ["drive"], TWO)).case_at(settings.values, rounded=True)


def analysed(case: Case) -> xr.Dataset:
    """Loaded contact of a new analysis, every problem of which is certified."""
    loaded = easeoff.analyze(case)["loaded"].to_dataset()
    assert np.all(loaded["status"] == Status.CERTIFIED)
    return loaded


# --- multipliers of a programme ---------------------------------------------------------------------------------------


def test_multipliers_of_a_programme_are_what_moved_limits_gain() -> None:
    """Of objective, limit and bounds of a small model; differences are exact where the same rows decide."""
    rows, slopes = np.array([0.9, 0.2, -0.1]), np.array([[-0.03, -0.01], [0.02, 0.01], [0.0, -0.03]])

    def solved(bound: float, low: float, form: Any) -> Any:
        limit = Composite("greatest", np.array([0.7]) / bound, np.array([[0.06, 0.01]]) / bound)
        reach, high = np.eye(2), np.array([50.0, 50.0])
        objective = Composite("range", rows, slopes)
        model = LocalModel(((objective,),), ((limit,),), reach, np.array([-50.0, low]), high)
        return StepProgramme(model, np.ones(1), form).solve(model, 20.0)

    for form in ("weighted", "worst"):
        here = solved(1.0, -1.0, form)
        by_limit = (solved(0.99, -1.0, form).objective - solved(1.01, -1.0, form).objective) / 0.02
        by_low = (solved(1.0, -0.9, form).objective - solved(1.0, -1.1, form).objective) / 0.2
        assert here.multipliers[0] > 0.1
        assert here.low_multipliers[1] > 0.001
        # The limit's row is divided by its own bound, so that its multiplier changes with it to second order.
        assert here.multipliers[0] == pytest.approx(by_limit, rel=3e-3)
        assert here.low_multipliers[1] == pytest.approx(by_low, rel=1e-5)
        assert here.high_multipliers == pytest.approx(0.0, abs=1e-6)


@cache
def limited(bound: float) -> xr.Dataset:
    fine = MachineResolution(length=1e-6, roll=1e-9)
    tree = searched(("max_pressure",), limits=[f"ease_off_change<={bound:g}"], resolution=fine)
    return tree["optimal_settings"].to_dataset()


@pytest.mark.thorough
def test_multipliers_of_a_search_lie_between_what_narrower_and_wider_limits_gain() -> None:
    """The narrower the limit, the more it costs; every optimum is known within the tolerance of its search."""
    less, here, more = (limited(bound) for bound in (6.0, 8.0, 10.0))
    for record, bound in ((less, 6.0), (here, 8.0), (more, 10.0)):
        assert record["limited_value"].values[0] <= bound
        assert record.attrs["violation"] == 0.0
    dearer, cheaper = (
        0.5 * (one.attrs["objective_total"] - other.attrs["objective_total"])
        for one, other in ((less, here), (here, more))
    )
    price, known = here["limit_multiplier"].values[0], GAIN_TOLERANCE
    assert cheaper - known <= price <= dearer + known
    assert price > 5.0 * known


# --- fronts -----------------------------------------------------------------------------------------------------------


@cache
def front_of(points: int) -> xr.DataTree:
    limits = ["ease_off_change<=25", "load_centre_lengthwise=0.5+-0.2"]
    return searched(OBJECTIVES, form="pareto", points=points, steps=6, limits=limits)


@pytest.mark.thorough
def test_every_point_of_a_front_is_certified_within_its_limits_and_what_is_said() -> None:
    front = front_of(3)["front"].to_dataset()
    record = front_of(3)["optimal_settings"].to_dataset()
    signs = np.where([str(name).count(">=") for name in front["quantity_limit"].values], -1.0, 1.0)
    assert front.sizes["point"] == 3
    for number in range(3):
        one = front.isel(point=number)
        loaded = analysed(case_at(one["front_setting"]))
        known = [loaded["peak_to_peak"].item(), loaded["max_pressure"].item()]
        assert one["front_value"].values == pytest.approx(known, rel=1e-9)
        assert one["front_ratio"].values == pytest.approx(known / record["objective_start"].values, rel=1e-9)
        assert np.all(signs * one["front_limited"].values <= signs * record["limit_bound"].values)
        force, place = loaded["force"].fillna(0.0), loaded["lengthwise"].fillna(0.0)
        centre = float((force * place).sum() / force.sum())
        assert one["front_limited"].values[1:3] == pytest.approx(centre, rel=1e-9)
        before, after = (
            easeoff.analyze(case)["ease_off"].to_dataset() for case in (coarse_case(), case_at(one["front_setting"]))
        )
        change = (after["ease_off"] - before["ease_off"]).values.ravel()
        arm = before["lever_arm"].values.ravel()
        known_nodes = np.isfinite(change)
        turn = np.sum((arm * change)[known_nodes]) / np.sum(arm[known_nodes] ** 2)
        assert one["front_limited"].values[0] == pytest.approx(np.nanmax(np.abs(change - turn * arm)), rel=1e-6)


@pytest.mark.thorough
def test_the_case_of_a_result_has_the_values_of_the_chosen_point() -> None:
    tree = front_of(3)
    found = analysed(parse_case(tree.attrs["case"]))
    front = tree["front"].to_dataset()
    chosen = front["front_value"].isel(point=front.attrs["chosen_point"]).values
    assert [found["peak_to_peak"].item(), found["max_pressure"].item()] == pytest.approx(chosen, rel=1e-9)
    assert tree["optimal_settings/objective_value"].values == pytest.approx(chosen, rel=1e-12)


@pytest.mark.thorough
def test_a_front_searched_in_two_parts_is_the_front_searched_at_once(tmp_path: Path) -> None:
    easeoff.write_result(front_of(3), tmp_path / "front.nc")
    limits = ["ease_off_change<=25", "load_centre_lengthwise=0.5+-0.2"]
    earlier = easeoff.read_result(tmp_path / "front.nc")
    parts = searched(OBJECTIVES, form="pareto", points=5, steps=6, limits=limits, resume=earlier)
    found, wanted = (tree["front"].to_dataset().drop_vars("front_analyses") for tree in (parts, front_of(5)))
    xr.testing.assert_identical(found, wanted)
    assert parts.attrs["case"] == front_of(5).attrs["case"]
    effort, whole = (tree["optimal_settings"].attrs["analyses"] for tree in (parts, front_of(5)))
    assert effort < whole


# --- assemblies and rounding ------------------------------------------------------------------------------------------


@pytest.mark.thorough
def test_assemblies_that_the_search_has_not_seen_keep_its_promise() -> None:
    """Eight assemblies with bounded errors and their corners in the search: none of 24 others is worse."""
    spread = {"E": "uniform(-0.05,0.05)", "P": "uniform(-0.03,0.03)", "Sigma": "uniform(-0.03,0.03)"}
    tree = searched(("max_pressure",), spread=spread, samples=8, steps=5)
    record = tree["optimal_settings"].to_dataset()
    state = CaseInMesh.of(parse_case(tree.attrs["case"]))
    unseen = sampled_assemblies(Misalignment(), spread, 24, seed=4711)
    worst = max(state.misaligned(one).cycle.loaded([TORQUE])[0]["max_pressure"].item() for one in unseen)
    assert record["objective_ratio"].item() < 0.95
    assert worst <= record["objective_value"].item()
    assert record["sample_ratio"].max().item() <= record["objective_ratio"].item()


@pytest.mark.thorough
@pytest.mark.parametrize("length", [1e-3, 0.02])
def test_rounding_changes_ease_off_and_objective_as_it_is_stated(length: float) -> None:
    """The stated change of the ease-off is that at the form's nodes; the objective differs by the teeth as well."""
    resolution = MachineResolution(length=length, roll=length / 10.0)
    record = searched(("max_pressure",), resolution=resolution, steps=4)["optimal_settings"].to_dataset()
    space = SettingSpace(coarse_case(), free_settings(coarse_case(), ["drive"], TWO), resolution)
    values = (record["setting_found"].values, record["setting_value"].values)
    trees = [easeoff.analyze(space.case_at(one)) for one in values]
    before, after = (tree["ease_off"].to_dataset() for tree in trees)
    change = (after["ease_off"] - before["ease_off"]).values.ravel()
    arm = before["lever_arm"].values.ravel()
    known = np.isfinite(change)
    turn = np.sum((arm * change)[known]) / np.sum(arm[known] ** 2)
    stated = record.attrs["rounding_change_um"]
    assert stated == pytest.approx(np.nanmax(np.abs(change - turn * arm)), rel=0.02, abs=1e-3)
    start = record["objective_start"].item()
    unrounded, rounded = (tree["loaded/max_pressure"].item() / start for tree in trees)
    assert rounded == pytest.approx(record.attrs["objective_total"], rel=1e-9)
    assert rounded - unrounded == pytest.approx(record.attrs["rounding_loss"], abs=GAIN_TOLERANCE)
    steps = values[1] / np.array([length, length / 10.0])
    assert steps == pytest.approx(np.round(steps), abs=1e-6)
