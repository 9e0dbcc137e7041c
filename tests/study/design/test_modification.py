"""Low-order modifications: what they do to ease-off and analysis, machine settings for them, the best of a case."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import output_of, small

import easeoff
from easeoff import InputError, modify
from easeoff.cases import Case, gear_pair, read_case
from easeoff.contact import Status
from easeoff.contact.modification.modified_contact import ModifiedContact
from easeoff.geometry import EaseOffTarget, Misalignment, Modification, ease_off
from easeoff.geometry.pair.modification import TERM_ORDERS, basis, modified_ease_off, terms
from easeoff.study import CaseInMesh
from easeoff.study.design.case_design import fit_modification, recorded_modification

T, H = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 7), indexing="ij")
SOME = Modification({"lengthwise_crowning": 8.0, "bias": -5.0, "profile_3": 3.0, "spiral_angle_error": 2.0})


def test_second_order_terms_are_those_of_a_target() -> None:
    for name in terms(2):
        ours = Modification({name: 7.0})(T, H)
        np.testing.assert_allclose(ours, 1e3 * EaseOffTarget(**{name: 7e-3})(T, H), rtol=0, atol=1e-12)


def test_terms_are_named_by_their_powers() -> None:
    assert terms(3)[5:] == ("lengthwise_3", "lengthwise_2_profile_1", "lengthwise_1_profile_2", "profile_3")


@pytest.mark.parametrize("order", TERM_ORDERS)
def test_terms_span_all_surfaces_of_their_order_but_the_constant(order: int) -> None:
    columns = basis(terms(order), T.ravel(), H.ravel())
    assert columns.shape[1] == (order + 1) * (order + 2) // 2 - 1
    whole = np.column_stack([np.ones(T.size), columns])
    assert np.linalg.matrix_rank(whole) == whole.shape[1]
    rng = np.random.default_rng(order)
    powers = [(a, b) for a in range(order + 1) for b in range(order + 1 - a)]
    wanted = sum(rng.standard_normal() * T**a * H**b for a, b in powers)
    left = np.linalg.lstsq(whole, np.ravel(wanted), rcond=None)[1]
    assert left.size == 0 or left.max() < 1e-20


def test_modification_adds_to_the_normal_ease_off_up_to_a_rotation() -> None:
    before = ease_off(gear_pair(read_case("fm-11x41")), (9, 7))
    after = modified_ease_off(before, SOME)
    turned = after.attrs["first_contact_rad"] - before.attrs["first_contact_rad"]
    added = after["ease_off"] - before["ease_off"] + 1e3 * turned * before["lever_arm"]
    np.testing.assert_allclose(added.values, SOME(T, H), rtol=0, atol=1e-9)
    np.testing.assert_allclose(after["ease_off"], 1e3 * after["ease_off_angle"] * after["lever_arm"], rtol=1e-12)
    assert after["ease_off"].attrs == before["ease_off"].attrs
    # Zero at first contact, which lies between the nodes.
    assert 0.0 <= after["ease_off"].values[after["inside"].values == 1].min() < 1.0
    back = modified_ease_off(after, Modification({k: -v for k, v in SOME.coefficients.items()}))
    np.testing.assert_allclose(back["ease_off_angle"], before["ease_off_angle"], rtol=0, atol=1e-15)
    assert back.attrs["first_contact_rad"] == pytest.approx(before.attrs["first_contact_rad"], rel=1e-12)


def test_settings_for_a_modification_give_what_they_say() -> None:
    """The ease-off of the fitted case, made afresh, is the old one with the modification, within what is left."""
    case = read_case("fm-11x41")
    wanted = Modification({"lengthwise_crowning": 4.0, "profile_crowning": 3.0, "bias": 2.0})
    fitted, found = fit_modification(case, wanted)
    assert fitted.target.drive is None
    assert fitted.pinion.convex == case.pinion.convex
    goal = modified_ease_off(ease_off(gear_pair(case), (9, 7)), wanted)
    fresh = ease_off(gear_pair(fitted), (9, 7))
    lever = goal["lever_arm"].values
    error = fresh["ease_off"].values - goal["ease_off"].values
    error -= lever * np.sum(lever * error) / np.sum(lever**2)
    np.testing.assert_allclose(error.ravel(), 1e3 * found.residual, rtol=0, atol=1e-4)
    assert np.abs(error).max() < 0.2 * np.ptp(wanted(T, H))


def test_no_modification_changes_nothing() -> None:
    case, nothing = small("nasa-12x36", "shell"), Modification({"bias": 0.0})
    plain, same = (easeoff.analyze(case, torques=[100.0], modification=one) for one in (None, nothing))
    np.testing.assert_allclose(same["loaded"]["force"], plain["loaded"]["force"], rtol=1e-9, atol=1e-6)
    assert same.attrs["modification_um"] == '{"bias": 0.0}'


def test_mistakes_are_named() -> None:
    with pytest.raises(InputError, match="modification term = 'crowning': must be one of spiral_angle_error"):
        Modification({"crowning": 1.0})
    with pytest.raises(InputError, match="bias = nan"):
        Modification({"bias": np.nan})
    with pytest.raises(InputError, match="order = 5: must be a whole number from 2 to 4"):
        terms(5)


# Optimising a whole case: what it promises is what an ordinary analysis of the modified case gives


AWAY = Misalignment(offset=0.05, pinion_axial=-0.05)


@cache
def coarse_case() -> Case:
    return small("fm-11x41", "shell", torques=(50.0, 250.0))


@cache
def modified(objective: str = "peak_load", **options: Any) -> xr.DataTree:
    return modify(coarse_case(), objective=objective, order=2, **options)


def line_load(tree: xr.DataTree) -> Any:
    return (tree["loaded"]["force"] / tree["loaded"]["length"]).max(("mesh_position", "segment")).values


@pytest.mark.parametrize("objective", ["peak_load", "peak_pressure", "even_load"])
@pytest.mark.quick(1)
def test_figures_are_those_of_ordinary_analyses_on_lines_alone(objective: str) -> None:
    tree = modified(objective)
    assert tree.attrs["edge_contact"] == tree["optimization"].attrs["edge_contact"] == 0
    record = tree["optimization"].isel(assembly=0)
    fresh = easeoff.analyze(coarse_case(), modification=recorded_modification(tree), edge_contact=False)
    for stage, analysis in (("before", easeoff.analyze(coarse_case(), edge_contact=False)), ("after", fresh)):
        loaded = analysis["loaded"]
        assert np.all(loaded["status"].values == Status.CERTIFIED)
        here = record.sel(stage=stage)
        np.testing.assert_allclose(here["max_line_load"], line_load(analysis), rtol=1e-10)
        np.testing.assert_allclose(here["max_pressure"], loaded["max_pressure"], rtol=1e-10)
        np.testing.assert_allclose(here["peak_to_peak"], loaded["peak_to_peak"], rtol=1e-7)
        square = (loaded["force"] ** 2 / loaded["length"]).sum(("mesh_position", "segment"))
        np.testing.assert_allclose(here["load_norm"], np.sqrt(square), rtol=1e-10)
        assert np.all(here["least_line_load"] <= here["max_line_load"])
    np.testing.assert_allclose(tree["loaded"]["force"], fresh["loaded"]["force"], rtol=1e-12)


@pytest.mark.parametrize(
    ("objective", "name"),
    [("peak_load", "max_line_load"), ("peak_pressure", "max_pressure"), ("even_load", "load_norm")],
)
def test_every_torque_gains_and_no_edge_loses(objective: str, name: str) -> None:
    record = modified(objective)["optimization"].to_dataset()
    before, after = record.sel(stage="before"), record.sel(stage="after")
    gain = (after[name] / before[name]).max().item()
    assert gain < 0.97
    assert np.all(after["max_end_load"] <= before["max_end_load"])
    assert record.attrs["converged"] == 1
    taken = record.isel(programme=np.flatnonzero(record["accepted"]))
    assert np.abs(taken["fresh_objective"].values - gain).min() < 1e-9
    # Near the end the programmes promise what comes true; the local compliance makes the difference.
    last = taken.isel(programme=-1)
    assert last["promised_objective"].item() == pytest.approx(last["fresh_objective"].item(), rel=2e-3)


@pytest.mark.thorough
def test_limit_of_transmission_error_is_kept_and_costs_load() -> None:
    free = modified()["optimization"].sel(stage="after")
    limit = 0.85 * free["peak_to_peak"].max().item()
    tight = modified(transmission_error=limit)["optimization"].sel(stage="after")
    assert np.all(tight["peak_to_peak"] <= limit)
    assert tight["max_line_load"].sum() > free["max_line_load"].sum()


@pytest.mark.thorough
def test_further_assembly_counts_as_much_as_the_own_one() -> None:
    tree = modified(misalignments=(AWAY,))
    record = tree["optimization"].to_dataset()
    assert record["offset_error"].values[1] == 0.05
    found = recorded_modification(tree)
    other = easeoff.analyze(coarse_case(), misalignment=AWAY, modification=found, edge_contact=False)
    np.testing.assert_allclose(record["max_line_load"].sel(stage="after", assembly=1), line_load(other), rtol=1e-10)
    worst = record["max_line_load"].max("assembly")
    assert np.all(worst.sel(stage="after") < worst.sel(stage="before"))
    # The one found for the own assembly alone does worse in the worst of both.
    alone = easeoff.analyze(coarse_case(), misalignment=AWAY, modification=recorded_modification(modified()))
    ratio = np.maximum(line_load(alone), line_load(modified())) / worst.sel(stage="before").values
    assert (worst.sel(stage="after") / worst.sel(stage="before")).max() <= ratio.max() + 1e-3


def test_slopes_of_the_gear_are_differences_of_its_analyses() -> None:
    """All that is left is that a modification also changes the curvature, and with it the local compliance."""
    case, names = coarse_case(), terms(2)
    contact = ModifiedContact(CaseInMesh.of(case).cycle, np.array([250.0]), names)
    loads = contact.loads(np.zeros(5))
    assert loads is not None
    for j, unit in enumerate(np.eye(5)):
        ahead, behind = contact.loads(0.01 * unit), contact.loads(-0.01 * unit)
        assert ahead is not None
        assert behind is not None
        on = loads.line_load > 5.0
        rate = (ahead.line_load - behind.line_load)[on] / 0.02
        error = np.abs(loads.line_load_slope[on, j] - rate)
        assert np.median(error) < 0.005 * np.abs(rate).max()
        assert error.max() < 0.08 * np.abs(rate).max()
        # The zero of the rotation moves with the first contact, which is no change of form.
        turned = loads.rotation_slope[:, j] - (ahead.rotation - behind.rotation) / 0.02
        assert np.ptp(turned) < 0.02 * np.ptp(loads.rotation_slope[:, j])


def test_result_is_a_result(tmp_path: Path) -> None:
    easeoff.write_result(modified(), tmp_path / "best.nc")
    tree = easeoff.read_result(tmp_path / "best.nc")
    assert recorded_modification(tree) == recorded_modification(modified())
    for group in ("modification", "optimization"):
        for variable in tree[group].variables.values():
            assert "long_name" in variable.attrs


def test_command_writes_result_and_fitted_case(tmp_path: Path) -> None:
    from easeoff.cases import write_case

    write_case(coarse_case(), tmp_path / "case.toml", "A coarse case.")
    arguments = ["modify", tmp_path / "case.toml", "-o", tmp_path / "best.nc", "--torque", "250"]
    arguments += ["--order", "2", "--end-load", "inf", "--misalignment", "E=0.02", "--fitted-case"]
    assert "assembly 1: E +0.02 mm" in output_of(*arguments, tmp_path / "fitted.toml")
    record = easeoff.read_result(tmp_path / "best.nc")["optimization"].to_dataset()
    assert math.isinf(np.max(record.attrs["end_load_limit_N_per_mm"]))
    before, after = record["max_line_load"].values[:, 0, 0]
    assert after < 0.9 * before
    # Real settings keep most of the gain.
    fitted = easeoff.analyze(read_case(tmp_path / "fitted.toml"), torques=[250.0])
    assert line_load(fitted)[0] < 0.5 * (before + after)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"objective": "noise"}, "objective = 'noise'"),
        ({"order": 1}, "order = 1: must be a whole number from 2 to 4"),
        ({"transmission_error": 0.0}, r"transmission_error = 0: must be a number above 0 \[urad\]"),
        ({"end_load": -1.0}, "end_load = -1: must be a number of 0 or more"),
        ({"largest": math.inf}, r"largest = inf: must be a number above 0 and at most 1000 \[um\]"),
        ({"programmes": 0}, "programmes = 0"),
        ({"transmission_error": 1e-308}, r"transmission_error = 1e-308: must be at least 0.001 \[urad\]"),
        ({"largest": 1e-308}, r"largest = 1e-308: must be at least 0.0001 \[um\]"),
        ({"torques": [1e-308]}, r"torques = 1e-308: must be at least 1e-06 and below 1e\+07 N m"),
        ({"torques": [1e308]}, r"torques = 1e\+308: must be at least 1e-06 and below 1e\+07 N m"),
        ({"torques": [-5.0]}, r"torques = -5: must be a finite number above 0"),
        ({"flank": "left"}, "flank = 'left'"),
    ],
)
def test_mistakes_in_the_options_of_the_best_one_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        modify(coarse_case(), **options)
