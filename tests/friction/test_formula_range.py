"""What is told of the friction models' ranges, the refusal of models that give no friction, and the film's heating."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import SHELLS, call, output_of, refusal_of, small, small_file
from tooth_models import with_teeth

import easeoff
from easeoff import InputError
from easeoff.cases.schema.case_schema import ContactTable
from easeoff.cases.schema.friction_table import FrictionTable
from easeoff.friction import (
    COEFFICIENTS,
    THERMAL_FACTORS,
    ContactConditions,
    FrictionModel,
    Operation,
    formula_flags,
    friction,
    friction_coefficient,
    kolivand_formula as formula,
    lubricant,
)
from easeoff.friction.coefficient import contact_conditions
from easeoff.friction.efficiency import losses
from easeoff.friction.ehl.study import shipped_formula
from easeoff.friction.kolivand_formula import FLAGS, combined_flags
from easeoff.friction.loaded_contacts import loaded_contacts
from easeoff.study.plot.friction_charts import efficiency, friction_maps
from easeoff.study.summary.plausibility import INPUTS, range_notes
from easeoff.study.summary.result_summary import result_summary

CONTACT = ContactTable(
    torques=(100.0, 500.0),
    mesh_positions=3,
    segments_per_line=9,
    lengthwise_nodes=15,
    profile_nodes=11,
    edge_contact=False,
)


@pytest.fixture(scope="module")
def tree() -> xr.DataTree:
    return easeoff.analyze(with_teeth(easeoff.read_case("fh-design-a").model_copy(update={"contact": CONTACT})))


def on_shells(folder: Path, name: str) -> Path:
    return small_file(folder, name, SHELLS)


def with_friction(tree: xr.DataTree, found: xr.Dataset) -> xr.DataTree:
    whole = tree.assign(friction=xr.DataTree(found))
    whole.attrs = tree.attrs
    return whole


# --- shares of the power loss


@pytest.mark.parametrize("name", [name for name in COEFFICIENTS if name != "constant"])
def test_shares_are_those_of_the_segments(tree: xr.DataTree, name: str) -> None:
    operation = Operation([30.0, 1500.0], [60.0, 90.0], [0.3, 3.0])
    found = friction(tree, operation, name)
    loss, flags = found["power_loss"], found["formula_flags"]
    whole = loss.sum(["mesh_position", "segment"])
    cycle = ["mesh_position", "segment"]
    outside = loss.where(flags > 0).sum(cycle) / whole
    xr.testing.assert_allclose(outside.transpose(*found["extrapolated_share"].dims), found["extrapolated_share"])
    for bit in FLAGS:
        one = loss.where((flags & bit) > 0).sum(cycle) / whole
        np.testing.assert_allclose(
            one.transpose("torque", ...), found["flagged_share"].sel(formula_flag=bit), rtol=1e-9, atol=1e-12
        )
    assert np.all((found["extrapolated_share"] >= 0.0) & (found["extrapolated_share"] <= 1.0 + 1e-12))


def test_shares_do_not_depend_on_the_blocks(tree: xr.DataTree, monkeypatch: pytest.MonkeyPatch) -> None:
    operation = Operation([30.0, 1500.0], [60.0, 90.0], [0.3, 3.0])
    one = friction(tree, operation, segment_fields=False)
    monkeypatch.setattr("easeoff.friction.efficiency.BLOCK_SIZE", 100)
    xr.testing.assert_allclose(friction(tree, operation, segment_fields=False), one, rtol=1e-12)


def test_share_between_the_regimes_is_that_of_the_windows(tree: xr.DataTree) -> None:
    found = friction(tree, Operation(1500.0, 60.0, 0.2), "kolivand")
    loss, ratio = found["power_loss"], found["lambda_ratio"]
    near = ((ratio > 0.9) & (ratio < 1.1)) | ((ratio > 2.7) & (ratio < 3.3))
    share = loss.where(near).sum(["mesh_position", "segment"]) / loss.sum(["mesh_position", "segment"])
    xr.testing.assert_allclose(share.transpose(*found["transition_share"].dims), found["transition_share"])
    assert float(share.max()) > 0.1


# --- in words


def test_a_run_outside_the_study_is_told_with_share_place_and_inputs(tree: xr.DataTree) -> None:
    (note,) = range_notes(friction(tree, Operation([30.0, 1500.0], 90.0, [0.8, 3.0])).isel(torque=[1]))
    assert note.startswith("Note: 100 % of the power loss at 500 N m, 30 1/min")
    assert "outside the range of the friction formula" in note
    assert "rolling velocity" in note


def test_the_share_in_the_note_is_that_of_the_dataset(tree: xr.DataTree) -> None:
    """Of light loads a part is below the pressures of the study."""
    found = friction(tree, Operation(1500.0, 90.0, 0.3), "mixed_lubrication")
    share = 100.0 * float(found["extrapolated_share"].max())
    assert 5.0 < share < 95.0
    (note,) = range_notes(found)
    assert f"Note: {share:.0f} % of the power loss at 100 N m, 1500 1/min, 0.3 um" in note
    assert note.endswith("(pressure).")


def test_within_all_ranges_there_is_nothing_to_tell(tree: xr.DataTree) -> None:
    """But for the pitch line, where nothing slides: some per cent."""
    found = friction(tree, Operation(1500.0, 90.0, 0.8)).isel(torque=[1])
    assert 0.0 < float(found["extrapolated_share"].max()) < 0.05
    assert range_notes(found) == []


def test_another_oil_is_told_and_the_same_oil_by_another_name_is_not(tree: xr.DataTree) -> None:
    own = replace(lubricant("75w90"), name="mine")
    assert range_notes(friction(tree, Operation(1500.0, 90.0, 0.8, own)).isel(torque=[1])) == []
    found = friction(tree, Operation(1500.0, 90.0, 0.8, "mineral-vg100"))
    notes = [note for note in range_notes(found) if "mineral-vg100" in note]
    assert len(notes) == 1
    share = 100.0 * float((found["mean_sliding_loss"] / found["mean_power_loss"]).max())
    assert notes[0].startswith(
        f"Note: {min(share, 99.0):.0f} % of the power loss is by a friction formula made for 75w90"
    )
    constant = friction(tree, Operation(1500.0, 90.0, 0.8, "mineral-vg100"), 0.05)
    assert range_notes(constant) == []


def test_the_own_formula_knows_oils_unlike_that_of_its_study(tree: xr.DataTree) -> None:
    for oil, like in (("75w90", True), ("mineral-vg100", False)):
        found = friction(tree, Operation(1500.0, 60.0, 0.3, oil), "mixed_lubrication")
        share = found["flagged_share"].sel(formula_flag=8192)
        assert float(share.max()) == (0.0 if like else pytest.approx(1.0))


def test_a_clamped_temperature_is_told(tree: xr.DataTree) -> None:
    model = FrictionModel(out_of_range="clamp")
    notes = range_notes(friction(tree, Operation(1500.0, [90.0, 120.0], 0.8), model))
    (told,) = [note for note in notes if "end of its data" in note]
    assert told.startswith("Note: 100 % of the power loss at 120 degC")
    assert "from 25 to 100 degC" in told


def test_every_flag_has_words() -> None:
    assert set(INPUTS) == set(FLAGS)


def test_notes_go_with_the_feedback_too() -> None:
    tree = easeoff.analyze(
        small("nasa-12x36", "shell"),
        torques=100.0,
        speed=[30.0, 1500.0],
        roughness=[0.8, 3.0],
        friction_feedback=True,
        edge_contact=False,
    )
    found = tree["friction"].to_dataset()
    assert found["extrapolated_share"].sizes == {"torque": 1, "speed": 2, "temperature": 1, "roughness": 2}
    assert "100 % of the power loss at 100 N m, 30 1/min" in range_notes(found)[0]


def test_an_older_result_has_no_notes(tree: xr.DataTree) -> None:
    found = friction(tree, Operation(30.0))
    assert range_notes(found.drop_vars(["film_thinning", "extrapolated_share", "flagged_share"])) == []


def test_show_and_pictures_tell_it(tree: xr.DataTree) -> None:
    whole = with_friction(tree, friction(tree, Operation(30.0, 90.0, 3.0)))
    assert "Note: 100 % of the power loss at 100 N m, 30 1/min, 3 um lies outside" in result_summary(whole)
    for figure in (friction_maps(whole), efficiency(whole)):
        small_print = " ".join(" ".join(text.get_text() for text in figure.texts).split())
        assert "100 % of the power loss" in small_print
        assert "outside the range of the friction formula (roughness, rolling velocity" in small_print


def test_run_tells_it(tmp_path: Path) -> None:
    options = ["--torque", "500", "--speed", "30", "--roughness", "3"]
    made = call("run", on_shells(tmp_path, "fh-design-a"), "-o", tmp_path / "a.nc", *options)
    assert made.exit_code == 0, made.output
    assert "Note: 100 % of the power loss at 500 N m, 30 1/min, 3 um lies outside the range" in made.stderr


# --- models that give no friction


def negative(c: ContactConditions) -> Any:
    return np.where(c.hertz_pressure > 0.5e9, -0.05, 0.05)


def nothing(c: ContactConditions) -> Any:
    return np.full(c.shape, np.nan)


def infinite(c: ContactConditions) -> Any:
    return np.where(c.hertz_pressure > 0.5e9, np.inf, 0.05)


def text(c: ContactConditions) -> Any:
    return "slippery"


def absent(c: ContactConditions) -> Any:
    return None


def imaginary(c: ContactConditions) -> Any:
    return 0.05j


def wrong_shape(c: ContactConditions) -> Any:
    return np.full(3, 0.05)


def too_many(c: ContactConditions) -> Any:
    return np.full((2, *c.shape), 0.05)


def ragged(c: ContactConditions) -> Any:
    return [[0.05], [0.05, 0.05]]


@pytest.mark.parametrize("model", [negative, nothing, infinite, text, absent, imaginary, wrong_shape, too_many, ragged])
def test_a_model_that_gives_no_friction_is_refused_by_name(tree: xr.DataTree, model: Callable[..., Any]) -> None:
    with pytest.raises(InputError, match=f"coefficient = {model.__name__}: gives .*: must give "):
        friction(tree, Operation(1500.0), model)
    with pytest.raises(InputError, match=f"coefficient = {model.__name__}: gives"):
        friction_coefficient(
            model, hertz_pressure=[1e9, 2e9], equivalent_radius=0.02, rolling_velocity=2.0, slide_to_roll=0.3,
            roughness=0.4e-6,
        )  # fmt: skip


def test_the_refusal_counts_and_shows_the_first_contact() -> None:
    here = {"equivalent_radius": 0.02, "rolling_velocity": 2.0, "slide_to_roll": 0.3, "roughness": 0.4e-6}
    with pytest.raises(InputError, match=r"gives -0.05 at 2 of 3 contacts .* first at 600 MPa, radius 20 mm"):
        friction_coefficient(negative, hertz_pressure=[0.4e9, 0.6e9, 0.8e9], **here)


def test_partial_functions_and_objects_are_named_too() -> None:
    class Slippery:
        def __call__(self, c: ContactConditions) -> Any:
            return -1.0

    here: dict[str, Any] = {"hertz_pressure": 1e9, "equivalent_radius": 0.02, "rolling_velocity": 2.0}
    here |= {"slide_to_roll": 0.3, "roughness": 0.4e-6}
    for model, name in ((Slippery(), "Slippery"), (partial(negative), "negative")):
        with pytest.raises(InputError, match=f"coefficient = {name}: gives -"):
            friction_coefficient(model, **here)


def test_models_that_give_whole_numbers_or_one_number_are_taken(tree: xr.DataTree) -> None:
    models: list[tuple[float, Callable[[ContactConditions], Any]]] = [
        (0.0, lambda c: 0),
        (0.05, lambda c: 0.05),
        (0.05, lambda c: [0.05]),
        (0.05, lambda c: np.full(c.shape, 0.05)),
    ]
    for value, own in models:
        expected = friction(tree, Operation(1500.0), value)["efficiency"]
        np.testing.assert_allclose(friction(tree, Operation(1500.0), own)["efficiency"], expected)


# --- heat of the film


def test_film_heating_thins_the_film_by_its_factor(tree: xr.DataTree) -> None:
    operation = Operation(3000.0, 50.0, 0.4)
    cold, warm = (friction(tree, operation, FrictionModel(film_heating=name)) for name in ("none", "gupta_cheng"))
    (block,) = losses(loaded_contacts(tree), operation, FrictionModel())
    factor = THERMAL_FACTORS["gupta_cheng"](block.conditions)[0, 0, 0]
    ratio = warm["lambda_ratio"].values / cold["lambda_ratio"].values
    np.testing.assert_allclose(ratio[np.isfinite(ratio)], factor, rtol=1e-12)
    by_torque = warm["film_thinning"].values.ravel()
    assert by_torque.max() == pytest.approx(1.0 - factor.min(), rel=1e-12)
    xr.testing.assert_allclose(cold["film_thinning"], warm["film_thinning"])
    assert np.all(warm["mean_friction_coefficient"] != cold["mean_friction_coefficient"])
    slow = friction(tree, Operation(10.0, 50.0, 0.4))
    assert float(slow["film_thinning"].max()) < 0.1


def test_thinning_above_a_tenth_is_told_taken_in_or_not(tree: xr.DataTree) -> None:
    for name, words in (("none", "left out"), ("gupta_cheng", "included"), ("murch_wilson", "included")):
        found = friction(tree, Operation(3000.0, 50.0, 0.4), FrictionModel(film_heating=name))
        (note,) = [note for note in range_notes(found) if "heat of the inlet" in note]
        assert f"by up to {100.0 * float(found['film_thinning'].max()):.0f} %" in note
        assert words in note
    assert not [n for n in range_notes(friction(tree, Operation(300.0, 90.0, 0.4))) if "heat of the inlet" in n]


def test_film_heating_from_case_and_command_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="film_heating = 'oven': must be one of none, gupta_cheng, murch_wilson"):
        FrictionModel(film_heating="oven")
    options = ["--torque", "100", "--speed", "3000", "--temperature", "50", "--film-heating"]
    case = on_shells(tmp_path, "nasa-12x36")
    output_of("run", case, "-o", tmp_path / "a.nc", *options, "murch_wilson")
    assert easeoff.read_result(tmp_path / "a.nc")["friction"].attrs["film_heating"] == "murch_wilson"
    assert "film_heating = 'oven'" in refusal_of("run", case, "-o", tmp_path / "b.nc", *options, "oven")
    table = FrictionTable(speed=(1000.0,), film_heating="gupta_cheng")
    assert table.model().film_heating == "gupta_cheng"


# --- named models


def test_the_own_formula_is_a_named_model(tree: xr.DataTree) -> None:
    operation = Operation([500.0, 1500.0], [60.0, 90.0], [0.3, 0.8])
    named = friction(tree, operation, "mixed_lubrication")
    own = friction(tree, operation, shipped_formula().coefficient)
    xr.testing.assert_allclose(named["efficiency"], own["efficiency"])
    assert named.attrs["friction_coefficient"] == "mixed_lubrication"


def test_flags_of_the_own_formula_are_where_it_says_that_it_is_outside() -> None:
    rng = np.random.default_rng(4)
    count = 2000
    here = contact_conditions(
        hertz_pressure=rng.uniform(0.3e9, 3e9, count),
        equivalent_radius=rng.uniform(3e-3, 50e-3, count),
        rolling_velocity=rng.uniform(0.5, 25.0, count),
        slide_to_roll=rng.uniform(0.0, 1.3, count),
        roughness=rng.uniform(0.05e-6, 1.3e-6, count),
        temperature=rng.uniform(40.0, 100.0, count),
        oil="pao-vg100",
    )
    own = shipped_formula()
    _, inside = own(
        here.hertz_pressure, here.equivalent_radius, here.rolling_velocity, here.slide_to_roll, here.viscosity,
        here.pressure_viscosity, here.composite_roughness, here.contact_modulus,
    )  # fmt: skip
    flags = own.flags(here)
    np.testing.assert_array_equal(flags == 0, inside)
    assert 0.02 < np.mean(inside) < 0.98
    np.testing.assert_array_equal(
        (flags & 1024) > 0, (here.equivalent_radius < 5e-3) | (here.equivalent_radius > 40e-3)
    )


def test_smooth_is_the_default() -> None:
    """No step over a sweep of the speed, where the printed expressions have two."""
    rolling = np.geomspace(1.0, 400.0, 4001)
    here: dict[str, Any] = {"hertz_pressure": 1e9, "equivalent_radius": 0.02, "slide_to_roll": 0.3}
    here |= {"temperature": 60.0, "roughness": 0.6e-6, "rolling_velocity": rolling}
    assert FrictionModel().coefficient == "kolivand_blended"
    assert np.abs(np.diff(np.log(friction_coefficient(**here)))).max() < 0.006
    assert np.abs(np.diff(np.log(friction_coefficient("kolivand", **here)))).max() > 0.05


def test_jumps_of_the_printed_formula_have_the_size_that_is_told() -> None:
    """At random within the study: 12 and 9 % in the median, twice at most."""
    rng = np.random.default_rng(0)
    count = 100_000
    rough = tuple(rng.uniform(0.1e-6, 1e-6, (2, count)))
    here = contact_conditions(
        hertz_pressure=rng.uniform(0.5e9, 2.5e9, count),
        equivalent_radius=rng.uniform(5e-3, 40e-3, count),
        rolling_velocity=rng.uniform(1.0, 20.0, count),
        slide_to_roll=rng.uniform(0.025, 1.0, count),
        temperature=rng.uniform(25.0, 100.0, count),
        roughness=rough,
    )
    assert not np.any(formula_flags(here))
    for at, median in ((1.0, 0.12), (3.0, 0.09)):
        near = np.abs(np.log(here.lambda_ratio / at)) < 0.03
        # Roughnesses changed so that lambda is just below and just above the step.
        pairs = []
        for wanted in (at * (1.0 - 1e-9), at * (1.0 + 1e-9)):
            factor = here.lambda_ratio / wanted
            changed = replace(here, roughness_pinion=factor * rough[0], roughness_gear=factor * rough[1])
            pairs.append(formula.formula_coefficient(changed)[near])
        jumps = np.abs(np.log(pairs[1] / pairs[0]))
        assert np.median(np.expm1(jumps)) == pytest.approx(median, abs=0.02)
        assert np.exp(jumps.max()) < 2.1


def test_flags_of_all_shapes_are_added() -> None:
    flags = combined_flags({1: np.array([True, False]), 4: np.array([[True], [False]])})
    np.testing.assert_array_equal(flags, np.array([[5, 4], [1, 0]]))
