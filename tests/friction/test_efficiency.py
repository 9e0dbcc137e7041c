"""Power loss and efficiency of whole pairs: balances, limits, and the claims of the dissertation's chapter 5."""

from __future__ import annotations

import importlib
import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pairs import by_the_dissertation
from runs import SHELLS, SMALL, call, output_of, refusal_of, small_file
from spur_pair import shape_operators, spur

import easeoff
from easeoff import InputError
from easeoff.cases import Case
from easeoff.cases.schema.case_schema import ContactTable
from easeoff.contact import Status
from easeoff.friction import COEFFICIENTS, FrictionModel, Operation, friction, friction_feedback, lubricant
from easeoff.friction.coefficient import contact_conditions
from easeoff.friction.efficiency import conditions_of
from easeoff.friction.feedback import friction_torques
from easeoff.friction.loaded_contacts import action_splines, axes_of, loaded_contacts, surface_velocities
from easeoff.friction.lubricants.lubricant import LUBRICANTS_FOLDER
from easeoff.friction.operation import named_models
from easeoff.geometry import Misalignment
from easeoff.geometry.vectors import dot
from easeoff.study import Analysis, CaseInMesh
from easeoff.study.analysis.contact_analysis import contact_analysis
from easeoff.study.analysis.operating import operation_of
from easeoff.study.summary.result_summary import result_summary, uncertified

POSITIONS = 4
CONTACT = ContactTable(
    torques=(100.0, 500.0, 1000.0),
    mesh_positions=POSITIONS,
    segments_per_line=9,
    lengthwise_nodes=21,
    profile_nodes=15,
    edge_contact=False,
)
OPERATION = Operation([250.0, 1500.0, 3000.0], [50.0, 90.0], [0.2, (0.8, 0.4), 0.8])


def small_case(name: str) -> Case:
    """A coarse case with the dissertation's model: shells for teeth, and contact on the contact lines alone."""
    return by_the_dissertation(name, **CONTACT.model_dump())


@cache
def analysed(name: str) -> Analysis:
    case = small_case(name)
    return contact_analysis(CaseInMesh.of(case), case.contact.torques)


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return analysed("fh-design-a")


@pytest.fixture(scope="module")
def tree(analysis: Analysis) -> xr.DataTree:
    return analysis.tree


@pytest.fixture(scope="module")
def dissertation() -> Any:
    """The script with the radius and the slide-to-roll ratio that the dissertation may have."""
    return importlib.import_module("dissertation_radius")


@pytest.fixture(scope="module")
def result(tree: xr.DataTree) -> xr.Dataset:
    return friction(tree, OPERATION)


def test_losses_add_up(tree: xr.DataTree, result: xr.Dataset) -> None:
    """Kolivand 2009, Eq. 5.12 to 5.14, from the labelled fields alone."""
    loaded = tree["loaded"].to_dataset()
    sliding = result["friction_coefficient"] * loaded["force"] * result["sliding_velocity"]
    xr.testing.assert_allclose(sliding.sum("segment").mean("mesh_position"), result["mean_sliding_loss"])
    xr.testing.assert_allclose(
        result["power_loss"].sum("segment"), result["mesh_power_loss"].transpose(..., "roughness")
    )
    xr.testing.assert_allclose(result["mesh_power_loss"].mean("mesh_position"), result["mean_power_loss"])
    xr.testing.assert_allclose(result["mean_sliding_loss"] + result["mean_rolling_loss"], result["mean_power_loss"])
    power = result["torque"] * result["speed"] * 2.0 * np.pi / 60.0
    xr.testing.assert_allclose(result["efficiency"], 1.0 - result["mean_power_loss"] / power)
    xr.testing.assert_allclose(result["mesh_efficiency"], 1.0 - result["mesh_power_loss"] / power)
    xr.testing.assert_allclose(
        result["mean_friction_coefficient"],
        result["mean_sliding_loss"]
        * POSITIONS
        / (loaded["force"] * result["sliding_velocity"]).sum(["segment", "mesh_position"]),
    )
    assert np.all(result["power_loss"].notnull() == (loaded["force"] > 0.0))


def test_fields_are_those_of_the_models(tree: xr.DataTree, result: xr.Dataset) -> None:
    """Film, lambda and coefficient of one segment, from its pressure, radius and velocities."""
    loaded = tree["loaded"].to_dataset()
    here = loaded.isel(torque=1, mesh_position=3)
    segment = int(np.nanargmax(here["pressure"].values))
    values = result.isel(torque=1, mesh_position=3, segment=segment).sel(speed=1500.0, temperature=90.0)
    arguments = {
        "hertz_pressure": 1e6 * here["pressure"].values[segment],
        "equivalent_radius": 1e-3 * here["equivalent_radius"].values[segment],
        "rolling_velocity": float(values["rolling_velocity"]),
        "slide_to_roll": float(values["slide_to_roll"]),
        "contact_modulus": 1e6 * loaded.attrs["contact_modulus_MPa"],
    }
    for number, roughness in enumerate(OPERATION.roughnesses):
        pair = (1e-6 * roughness[0], 1e-6 * roughness[1])
        conditions = contact_conditions(**arguments, roughness=pair)
        found = values.isel(roughness=number)
        assert found["film_thickness"] == pytest.approx(1e6 * float(conditions.film_thickness))
        assert found["lambda_ratio"] == pytest.approx(float(conditions.lambda_ratio))
        expected = float(easeoff.friction.friction_coefficient(**arguments, roughness=pair))
        assert found["friction_coefficient"] == pytest.approx(expected)
        assert found["formula_flags"] == easeoff.friction.formula_flags(conditions)


@pytest.mark.parametrize("direction", ["across", "line", "trace"])
def test_force_and_hertz_agree_on_the_load(tree: xr.DataTree, dissertation: Any, direction: str) -> None:
    """The line load that film and traction take from the pressure is force over length, whatever the radius."""
    contacts = loaded_contacts(dissertation.with_radius_along(tree, direction) if direction != "across" else tree)
    conditions = conditions_of(contacts, OPERATION, FrictionModel(), slice(None))
    np.testing.assert_allclose(conditions.load, contacts.force / contacts.length, rtol=1e-9)


def test_one_call_for_all_conditions_is_many_calls(tree: xr.DataTree, result: xr.Dataset) -> None:
    one = friction(tree, Operation(1500.0, 50.0, (0.8, 0.4)))
    many = result.sel(speed=[1500.0], temperature=[50.0]).isel(roughness=[1])
    xr.testing.assert_allclose(one, many)


def test_blocks_change_nothing(tree: xr.DataTree, result: xr.Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("easeoff.friction.efficiency.BLOCK_SIZE", 100)
    xr.testing.assert_allclose(friction(tree, OPERATION), result, rtol=1e-13)


def test_fields_can_be_left_out(tree: xr.DataTree, result: xr.Dataset) -> None:
    lean = friction(tree, OPERATION, segment_fields=False)
    assert "power_loss" not in lean
    xr.testing.assert_identical(lean["efficiency"], result["efficiency"])


def test_constant_coefficient_is_proportional_and_knows_no_speed(tree: xr.DataTree) -> None:
    single, double = (friction(tree, OPERATION, FrictionModel(mu)) for mu in (0.04, 0.08))
    xr.testing.assert_allclose(double["mean_sliding_loss"], 2.0 * single["mean_sliding_loss"])
    xr.testing.assert_allclose(
        single["mean_friction_coefficient"], xr.full_like(single["mean_friction_coefficient"], 0.04)
    )
    share = (single["mean_sliding_loss"] / single["input_power"]).transpose("torque", ...).values
    np.testing.assert_allclose(share, np.broadcast_to(share[:, :1, :1, :1], share.shape), rtol=1e-12)


def test_without_friction_only_rolling_is_lost(tree: xr.DataTree) -> None:
    found = friction(tree, OPERATION, FrictionModel(0.0))
    np.testing.assert_array_equal(found["mean_sliding_loss"], 0.0)
    assert np.all(found["mean_rolling_loss"] > 0.0)
    # One per cent of the loss or so at 1500 / min.
    whole = friction(tree, OPERATION)
    share = (whole["mean_rolling_loss"] / whole["mean_power_loss"]).sel(speed=1500.0, torque=500.0)
    assert np.all(share < 0.03)


def test_roughnesses_can_change_places(tree: xr.DataTree) -> None:
    one, other = (friction(tree, Operation(1000.0, 90.0, pair)) for pair in ((0.3, 0.9), (0.9, 0.3)))
    np.testing.assert_allclose(one["efficiency"], other["efficiency"], rtol=1e-13)
    assert one["roughness"].item() == pytest.approx(np.sqrt((0.3**2 + 0.9**2) / 2))
    assert one["roughness_pinion"].item() == 0.3


def test_velocities_are_in_proportion_to_speed(result: xr.Dataset) -> None:
    for name in ("sliding_velocity", "sliding_along", "sliding_across", "rolling_velocity"):
        per_turn = (result[name] / result["speed"]).values
        np.testing.assert_allclose(per_turn, np.broadcast_to(per_turn[..., :1], per_turn.shape), rtol=1e-12)
    whole = np.hypot(result["sliding_along"], result["sliding_across"])
    np.testing.assert_allclose(whole, result["sliding_velocity"], rtol=1e-12)


@pytest.mark.parametrize("name", list(COEFFICIENTS))
def test_every_model_gives_a_possible_efficiency(tree: xr.DataTree, name: str) -> None:
    found = friction(tree, OPERATION, FrictionModel(name, film="dowson_higginson", thermal_factor="murch_wilson"))
    assert np.all((found["efficiency"] > 0.95) & (found["efficiency"] < 0.9995))
    assert ("formula_flags" in found) == (name != "constant")
    assert found.attrs["friction_coefficient"] == name


def test_whole_sliding_raises_the_ratio_of_the_coefficient(
    tree: xr.DataTree, result: xr.Dataset, dissertation: Any
) -> None:
    here: dict[str, Any] = {"hertz_pressure": 1e9, "equivalent_radius": 0.02, "rolling_velocity": 2.0}
    here |= {"roughness": 0.4e-6, "temperature": 90.0}
    given = contact_conditions(**here, slide_to_roll=0.3, sliding_velocity=1.0)
    expected = easeoff.friction.friction_coefficient(**here, slide_to_roll=0.5)
    np.testing.assert_allclose(dissertation.whole_sliding(given), expected, rtol=1e-12)
    other = friction(tree, OPERATION, dissertation.whole_sliding)
    assert np.all(other["mean_sliding_loss"] != result["mean_sliding_loss"])
    xr.testing.assert_identical(other["mean_rolling_loss"], result["mean_rolling_loss"])


def test_frames_of_rolling_differ_by_the_lines_motion_alone(tree: xr.DataTree, result: xr.Dataset) -> None:
    other = friction(tree, OPERATION, FrictionModel(rolling_frame="contact_line"))
    xr.testing.assert_identical(other["sliding_across"], result["sliding_across"])
    ratio = other["rolling_velocity"] / result["rolling_velocity"]
    assert float(ratio.min()) > 0.9
    assert float(ratio.max()) < 1.3


def test_equivalent_radius_is_that_of_the_conjugate_flanks_but_for_the_ease_off(tree: xr.DataTree) -> None:
    """Relative curvature across the line, from the points of action and their normals alone."""
    contacts, ease_off = loaded_contacts(tree), tree["ease_off"].to_dataset()
    loaded = tree["loaded"].to_dataset()
    points = np.stack([loaded[n].values[tuple(contacts.index)] for n in ("lengthwise", "profile")])
    across = contacts.velocities.across
    pinion, gear = shape_operators(axes_of(ease_off), action_splines(ease_off), points)
    ratio = contacts.equivalent_radius * np.abs(dot(gear(across) - pinion(across), across))
    assert ratio.min() > 0.9
    assert ratio.max() < 1.1


def test_radius_along_the_line_is_that_of_both_flanks_shapes(tree: xr.DataTree, dissertation: Any) -> None:
    """The pinion's from its shape operator, the gear's by Euler's formula from its principal curvatures."""
    ease_off, gear = tree["ease_off"].to_dataset(), tree["flanks"].to_dataset().sel(member="gear")
    nodes = {"lengthwise": slice(6, -6), "profile": slice(4, -4)}
    points = np.stack(np.meshgrid(*(ease_off[n].values[within] for n, within in nodes.items()), indexing="ij"))
    fields = action_splines(ease_off)
    line = surface_velocities(axes_of(ease_off), fields, points).along
    of_pinion = np.abs(dot(shape_operators(axes_of(ease_off), fields, points)[0](line), line))
    # The line's direction on the gear's own flank, by differences over the nodes.
    rates, tangents = (np.gradient(v, axis=(0, 1)) for v in (ease_off["roll_angle"].values, gear["position"].values))
    along = rates[0][..., None] * tangents[1] - rates[1][..., None] * tangents[0]
    cosine = np.sum(along * gear["principal_direction"].values, axis=-1) / np.linalg.norm(along, axis=-1)
    first, second = np.moveaxis(1e3 * gear["principal_curvature"].values, -1, 0)
    of_gear = np.abs(first * cosine**2 + second * (1.0 - cosine**2))[nodes["lengthwise"], nodes["profile"]]
    np.testing.assert_allclose(dissertation.radii_along(tree, points, "line"), 1.0 / (of_pinion + of_gear), rtol=2e-3)
    # Nearly conjugate flanks: one is about as hollow as the other is round.
    np.testing.assert_allclose(of_pinion, of_gear, rtol=0.15)


def test_radius_along_the_tooth_trace_is_that_of_both_flanks_shapes(tree: xr.DataTree, dissertation: Any) -> None:
    """The trace is the line of constant height on the gear; the pinion's curvature there from its shape operator."""
    ease_off, gear = tree["ease_off"].to_dataset(), tree["flanks"].to_dataset().sel(member="gear")
    nodes = {"lengthwise": slice(6, -6), "profile": slice(4, -4)}
    points = np.stack(np.meshgrid(*(ease_off[n].values[within] for n, within in nodes.items()), indexing="ij"))
    axes, fields = axes_of(ease_off), action_splines(ease_off)
    # The trace in space: what is left of the way of the points of action once the gear is turned back.
    moved, turned = (fields.evaluate([name], points, (1, 0))[name] for name in ("position", "roll_angle"))
    _, of_gear = axes.velocities(fields.evaluate(["position"], points)["position"])
    trace = moved - turned * of_gear
    trace = trace / np.sqrt(dot(trace, trace))
    of_pinion = np.abs(dot(shape_operators(axes, fields, points)[0](trace), trace))
    tangent = np.gradient(gear["position"].values, axis=0)
    cosine = np.sum(tangent * gear["principal_direction"].values, axis=-1) / np.linalg.norm(tangent, axis=-1)
    first, second = np.moveaxis(1e3 * gear["principal_curvature"].values, -1, 0)
    bend = np.abs(first * cosine**2 + second * (1.0 - cosine**2))[nodes["lengthwise"], nodes["profile"]]
    np.testing.assert_allclose(dissertation.radii_along(tree, points, "trace"), 1.0 / (of_pinion + bend), rtol=2e-3)


def test_radius_along_the_line_of_known_surfaces(dissertation: Any) -> None:
    """Lines that are circles of one radius on the pinion and of another on the gear, in planes of their own."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 8), indexing="ij")

    def flank(radius: float, component: str) -> dict[str, Any]:
        angle = 5.0 * u / radius
        normal = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
        position = radius * normal + np.stack([0.0 * v, 0.0 * v, 3.0 * v], axis=-1)
        return {
            name: (("lengthwise", "profile", component), x) for name, x in (("position", position), ("normal", normal))
        }

    coords = {"lengthwise": u[:, 0], "profile": v[0]}
    action = {f"action_{name}": value for name, value in flank(80.0, "space").items()}
    ease_off = xr.Dataset(action | {"roll_angle": (("lengthwise", "profile"), 0.1 * v)}, coords=coords)
    gear = xr.Dataset(flank(120.0, "xyz"), coords=coords).expand_dims(member=["gear"])
    tree = xr.DataTree.from_dict({"ease_off": ease_off, "flanks": gear})
    found = dissertation.radii_along(tree, np.array([[0.3], [0.6]]), "line")
    assert found == pytest.approx(80e-3 * 120e-3 / 200e-3, rel=1e-6)


def test_radius_along_the_line_changes_film_and_coefficient_alone(
    tree: xr.DataTree, result: xr.Dataset, dissertation: Any
) -> None:
    along = dissertation.with_radius_along(tree, "line")
    other = friction(along, OPERATION)
    xr.testing.assert_identical(other["sliding_velocity"], result["sliding_velocity"])
    # With film and pressure by Pan and Hamrock: h ~ R (U^0.694 W^-0.128) at the same force.
    ratio = along["loaded"]["equivalent_radius"] / tree["loaded"]["equivalent_radius"]
    expected = ratio ** (1.0 - 0.694 + 0.128)
    found = other["film_thickness"] / result["film_thickness"]
    xr.testing.assert_allclose(found, expected.broadcast_like(found).where(found.notnull()).transpose(*found.dims))
    constant, again = (friction(of, OPERATION, 0.05)["mean_sliding_loss"] for of in (tree, along))
    xr.testing.assert_identical(constant, again)


def test_unsolved_positions_are_nan(tree: xr.DataTree) -> None:
    loaded = tree["loaded"].to_dataset().copy(deep=True)
    loaded["status"][1, 2] = Status.NOT_CERTIFIED
    for name in ("force", "pressure"):
        loaded[name][1, 2] = np.nan
    found = friction(xr.DataTree.from_dict({"ease_off": tree["ease_off"].to_dataset(), "loaded": loaded}), OPERATION)
    assert np.all(found["mesh_power_loss"].isel(torque=1, mesh_position=2).isnull())
    assert np.all(found["efficiency"].isel(torque=1).isnull())
    assert np.all(found["efficiency"].isel(torque=[0, 2]).notnull())


def test_a_stored_result_gives_the_same(tree: xr.DataTree, result: xr.Dataset, tmp_path: Path) -> None:
    whole = xr.DataTree.from_dict({**tree.to_dict(), "/friction": result})
    whole.attrs = tree.attrs
    easeoff.write_result(whole, tmp_path / "result.nc")
    read = easeoff.read_result(tmp_path / "result.nc")
    xr.testing.assert_allclose(read["friction"].to_dataset(), result)
    xr.testing.assert_allclose(friction(read, OPERATION), result)
    assert all("units" in v.attrs or v.dtype.kind == "u" for v in read["friction"].to_dataset().variables.values())


def test_analyze_adds_the_group(tree: xr.DataTree, result: xr.Dataset) -> None:
    case = small_case("fh-design-a")
    found = easeoff.analyze(case, speed=1500.0, temperature=90.0, roughness=[0.2, 0.8])["friction"].to_dataset()
    expected = result["efficiency"].sel(speed=[1500.0], temperature=[90.0]).isel(roughness=[0, 2])
    xr.testing.assert_allclose(found["efficiency"], expected)
    assert "friction" not in tree.children


def test_spur_gears_lose_what_the_textbook_says() -> None:
    """One tooth pair at a time, constant coefficient: loss over input = mu (1 + 1/R) mean|s| / base radius."""
    radius, ratio, angle, torque, count = 0.05, 2.5, 0.35, 80.0, 40
    ease_off, _ = spur(radius, ratio, angle)
    profile = (np.arange(count) + 0.5) / count
    distance = 12e-3 * (profile - 0.5)  # from the pitch point along the path of contact
    force = torque / (radius * np.cos(angle))
    cycle = ("torque", "mesh_position", "segment")
    fields = {"force": force, "pressure": 800.0, "length": 20.0, "equivalent_radius": 12.0, "lengthwise": 0.5}
    data: dict[str, Any] = {name: (cycle, np.full((1, count, 1), value)) for name, value in fields.items()}
    data["profile"] = (cycle, profile.reshape(1, count, 1))
    data["status"] = (cycle[:2], np.zeros((1, count), dtype=np.int8))
    coords = {"torque": [torque], "mesh_position": np.arange(count) / count}
    loaded = xr.Dataset(data, coords, {"contact_modulus_MPa": 2.27e5})
    tree = xr.DataTree.from_dict({"ease_off": ease_off, "loaded": loaded})
    found = friction(tree, Operation([500.0, 2000.0]), FrictionModel(0.06))
    expected = 0.06 * (1.0 + 1.0 / ratio) * np.mean(np.abs(distance)) / (radius * np.cos(angle))
    np.testing.assert_allclose(found["mean_sliding_loss"] / found["input_power"], expected, rtol=1e-10)


# --- the dissertation's claims


@pytest.fixture(scope="module")
def designs() -> dict[str, xr.Dataset]:
    operation = Operation([250.0, 1500.0, 3000.0], [50.0, 75.0, 90.0, 100.0], [0.1, 0.5, 0.8, 1.3])
    return {letter: friction(analysed(f"fh-design-{letter}").tree, operation) for letter in "ab"}


@pytest.mark.parametrize(
    ("letter", "rolling", "sliding"), [("a", (0.5, 3.5), (1.0, 2.0)), ("b", (1.0, 4.5), (1.5, 3.0))]
)
def test_velocities_of_the_designs(
    designs: dict[str, xr.Dataset], letter: str, rolling: tuple[float, float], sliding: tuple[float, float]
) -> None:
    """Figures 5.5 to 5.7 at 1500 / min: the ranges of their contours, of which the lines lie within the flank."""
    found = designs[letter].sel(speed=1500.0)
    for name, (low, high) in {"rolling_velocity": rolling, "sliding_velocity": sliding}.items():
        values = found[name]
        assert float(values.min()) > low - 0.3
        assert float(values.max()) < high + 0.3
    assert 0.6 < float(found["slide_to_roll"].max()) < 0.9


def test_lambda_and_coefficient_of_the_designs(designs: dict[str, xr.Dataset]) -> None:
    """Figures 5.9 and 5.10 at 1500 / min, 500 N m, 90 degC, 0.8 um: 0.1 to 0.3, and 0.01 to 0.06."""
    for found in designs.values():
        here = found.sel(speed=1500.0, torque=500.0, temperature=90.0, roughness=0.8)
        assert 0.1 < float(here["lambda_ratio"].median()) < 0.3
        assert 0.01 < float(here["mean_friction_coefficient"]) < 0.06


def test_claims_on_efficiency(designs: dict[str, xr.Dataset]) -> None:
    """A ahead of B everywhere, by about 1.5 %; smooth ahead of rough; oil; torque (Kolivand 2009, section 5.3)."""
    a, b = (100.0 * designs[letter]["efficiency"] for letter in "ab")
    at = {"temperature": 90.0, "roughness": 0.8}
    assert np.all(a > b)
    assert 1.0 < float((a - b).sel(at).mean()) < 2.0
    for efficiency in (a, b):
        here = efficiency.sel(torque=500.0, speed=1500.0)
        for drawn in (efficiency.sel(at), here.sel(temperature=[50.0, 75.0, 100.0])):  # figures 5.11 and 5.12
            assert float(drawn.min()) > 95.5
            assert float(drawn.max()) < 99.5
        assert np.all(here.diff("roughness") < 0.0)
        assert np.all(here.sel(roughness=0.1).diff("temperature") > 0.0)
        assert np.all(here.sel(roughness=0.5).diff("temperature") < 0.0)
        assert np.all(efficiency.sel(at).sel(speed=250.0).diff("torque") > 0.0)
        assert np.all(efficiency.sel(at).sel(speed=3000.0).diff("torque") < 0.0)
        assert np.all(efficiency.sel(at).sel(speed=[1500.0, 3000.0]).diff("speed") > 0.0)


@pytest.fixture(scope="module")
def as_printed(dissertation: Any) -> dict[str, xr.Dataset]:
    """With the radius that the dissertation seems to have, at 1500 / min, 500 N m, 90 degC, 0.8 um."""
    trees = {letter: dissertation.with_radius_along(analysed(f"fh-design-{letter}").tree, "line") for letter in "ab"}
    return {
        letter: friction(tree, Operation(1500.0, 90.0, 0.8))
        .assign(equivalent_radius=tree["loaded"]["equivalent_radius"])
        .sel(torque=500.0)
        .squeeze(drop=True)
        for letter, tree in trees.items()
    }


@pytest.mark.parametrize(("letter", "low", "high"), [("a", 35.0, 50.0), ("b", 35.0, 55.0)])
def test_radius_along_the_line_is_the_printed_one(
    as_printed: dict[str, xr.Dataset], letter: str, low: float, high: float
) -> None:
    """Figure 5.8: contours from 35 to 50 mm for A, to 55 mm for B; nothing was fitted to them."""
    radius = as_printed[letter]["equivalent_radius"].where(as_printed[letter]["friction_coefficient"].notnull())
    found = np.nanpercentile(radius, [2.0, 98.0])
    assert low < found[0] < low + 7.0
    assert found[1] == pytest.approx(high, abs=3.0)


def test_claims_on_the_coefficient_hold_with_the_printed_radius(as_printed: dict[str, xr.Dataset]) -> None:
    """Figures 5.9 and 5.10: lambda 0.1 to 0.3, coefficient 0.01 to 0.06, both higher in B."""
    for found in as_printed.values():
        assert np.all(np.abs(np.nanpercentile(found["lambda_ratio"], [3.0, 90.0]) - 0.2) < 0.1)
        assert np.nanpercentile(found["friction_coefficient"], 5.0) > 0.01
        assert float(found["friction_coefficient"].max()) < 0.06
    a, b = (as_printed[letter] for letter in "ab")
    for name in ("lambda_ratio", "friction_coefficient"):
        assert float(b[name].median()) > float(a[name].median())


# --- friction fed back


@pytest.fixture(scope="module")
def fed_back(analysis: Analysis) -> xr.Dataset:
    return friction_feedback(analysis.tree, analysis.cases, Operation(1500.0, 90.0, [0.2, 0.8]))


def test_power_in_is_power_out_and_losses(analysis: Analysis, fed_back: xr.Dataset) -> None:
    assert float(abs(fed_back["energy_balance"]).max()) < 1e-10
    ratio = 41 / 12
    out = fed_back["output_torque"] * fed_back["speed"] * 2.0 * np.pi / 60.0 / ratio
    xr.testing.assert_allclose(out / fed_back["input_power"], fed_back["mesh_efficiency"].transpose(*out.dims))
    # Without feedback the balance is off by the friction's torque.
    without = friction(analysis.tree, Operation(1500.0, 90.0, 0.8))
    difference = 100.0 * (fed_back["efficiency"] - without["efficiency"])
    assert 0.05 < float(difference.max()) < 0.5


def test_balance_holds_with_the_forces_taken_apart(analysis: Analysis, fed_back: xr.Dataset) -> None:
    """Torque of the pinion, from forces, lever arms and surface velocities of every segment."""
    loaded = analysis.tree["loaded"].to_dataset()
    at = {"speed": 1500.0, "temperature": 90.0, "roughness": 0.8}
    here = fed_back.sel(at)
    replaced = loaded.assign(force=here["force"].transpose(*loaded["force"].dims))
    contacts = loaded_contacts(
        xr.DataTree.from_dict({"ease_off": analysis.tree["ease_off"].to_dataset(), "loaded": replaced})
    )
    index = tuple(contacts.index)
    pinion_arm, gear_arm = contacts.friction_arms
    np.testing.assert_allclose(pinion_arm - gear_arm, contacts.velocities.sliding_speed, atol=1e-12)
    friction_force = here["friction_coefficient"].values[index] * contacts.force
    normal = 1e-3 * (here["force"] * loaded["lever_arm"]).sum("segment").values * 12 / 41
    torque = normal.copy()
    np.add.at(torque, index[:2], friction_force * pinion_arm)
    rolling = float(fed_back["mean_rolling_loss"].sel(at).sel(torque=500.0)) / (1500 * 2 * np.pi / 60)
    np.testing.assert_allclose(torque[1], 500.0, atol=4.0 * rolling)


def test_forces_are_those_of_the_contact_at_the_torque_that_is_left(analysis: Analysis, fed_back: xr.Dataset) -> None:
    loaded = analysis.tree["loaded"].to_dataset()
    here = fed_back.sel(speed=1500.0, temperature=90.0, roughness=0.8, torque=500.0).isel(mesh_position=2)
    left = 1e-3 * float((here["force"] * loaded["lever_arm"].sel(torque=500.0).isel(mesh_position=2)).sum()) * 12 / 41
    assert left < 500.0
    case = small_case("fh-design-a")
    again = easeoff.analyze(case, torques=[left])["loaded"].to_dataset().isel(torque=0, mesh_position=2)
    force = here["force"].transpose("segment").values
    np.testing.assert_allclose(force, again["force"].values, atol=1e-7 * np.nanmax(force))


def test_feedback_without_friction_is_the_frictionless_contact(analysis: Analysis) -> None:
    operation = Operation(1e-3, 90.0, 0.8)  # at a crawl the rolling traction vanishes
    found = friction_feedback(analysis.tree, analysis.cases, operation, FrictionModel(0.0))
    force = found["force"].squeeze().transpose(*analysis.tree["loaded/force"].dims)
    np.testing.assert_allclose(force, analysis.tree["loaded/force"], atol=1e-5 * np.nanmax(force))
    taken, passed = friction_torques(loaded_contacts(analysis.tree), operation, FrictionModel(0.0))
    assert np.max(taken - passed) < 1e-4


@pytest.mark.parametrize("coefficient", [0.3, 0.5, 0.8])
def test_feedback_ends_whatever_friction_takes(analysis: Analysis, coefficient: float) -> None:
    """Also where friction takes a sixth of the power."""
    operation = Operation(1000.0, 90.0, 0.8)
    found = friction_feedback(analysis.tree, analysis.cases, operation, FrictionModel(coefficient))
    assert np.all(found["status"] == Status.CERTIFIED)
    assert float(abs(found["energy_balance"]).max()) < 1e-9
    assert np.all((found["efficiency"] > 0.5) & (found["efficiency"] < 1.0 - 0.2 * coefficient))


def test_rolling_that_takes_the_whole_torque_is_no_result_and_says_so(analysis: Analysis) -> None:
    whole = contact_analysis(CaseInMesh.of(small_case("fh-design-a")), [1e-3])
    found = friction_feedback(whole.tree, whole.cases, Operation(3000.0, 30.0, 0.8))
    assert np.all(found["status"] == Status.NOT_CONVERGED)
    assert np.all(found["efficiency"].isnull())
    (line,) = uncertified(whole.tree.assign({"friction": xr.DataTree(found)}))
    assert f"friction fed back: {POSITIONS} of {POSITIONS}" in line
    assert "not_converged" in line


def test_film_and_lambda_are_those_of_each_roughness_with_feedback(fed_back: xr.Dataset) -> None:
    composite = np.hypot(fed_back["roughness_pinion"], fed_back["roughness_gear"])
    xr.testing.assert_allclose(fed_back["lambda_ratio"] * composite, fed_back["film_thickness"])


def test_feedback_needs_no_particular_solver(analysis: Analysis, fed_back: xr.Dataset) -> None:
    found = friction_feedback(analysis.tree, analysis.cases, Operation(1500.0, 90.0, 0.8), solver="daqp")
    expected = fed_back.sel(speed=[1500.0], roughness=[0.8])
    xr.testing.assert_allclose(found["efficiency"], expected["efficiency"], rtol=1e-9)


# --- other pairs, other flanks, far conditions


@pytest.fixture(scope="module", params=["nasa-12x36:drive", "fh-design-b:coast", "fm-11x41:coast"])
def other(request: pytest.FixtureRequest) -> Analysis:
    """A misaligned pair from next to no torque to very much."""
    name, flank = request.param.split(":")
    state = CaseInMesh.of(
        by_the_dissertation(name, **SMALL), flank=flank, misalignment=Misalignment(0.1, -0.05, 0.03, 1e-3)
    )
    return contact_analysis(state, [0.01, 300.0, 3000.0])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("model", COEFFICIENTS)
def test_far_conditions_give_numbers(other: Analysis, model: str) -> None:
    """A crawl and a race, cold and hot oil, no roughness and much: finite losses, coefficients within reason."""
    operation = Operation([10.0, 1500.0, 10000.0], [20.0, 60.0, 150.0], [0.0, 0.1, 5.0, (0.0, 5.0)])
    found = friction(other.tree, operation, FrictionModel(model, out_of_range="clamp"))
    coefficient = found["friction_coefficient"]
    touching = other.tree["loaded"].to_dataset()["force"].values > 0.0
    assert np.array_equal(
        np.isfinite(coefficient.values), np.broadcast_to(touching[..., None, None, None], coefficient.shape)
    )
    assert float(coefficient.min()) >= 0.0
    assert float(coefficient.max()) < 0.6
    assert np.all(found["mean_sliding_loss"] >= 0.0)
    assert np.all(found["mean_rolling_loss"] > 0.0)
    assert found["temperature_clamped"].values.tolist() == [1, 0, 1]
    # Next to no torque is lost to the rolling traction at full speed; a usual one is not.
    assert np.all(found["efficiency"].sel(torque=300.0) > 0.8)
    assert np.all(found["efficiency"].sel(torque=0.01, speed=10000.0, temperature=20.0) < 0.9)


def test_balance_holds_on_other_pairs_and_flanks(other: Analysis) -> None:
    found = friction_feedback(other.tree, other.cases, Operation([10.0, 2500.0], 60.0, (1.2, 0.4)))
    assert float(abs(found["energy_balance"]).max()) < 1e-10
    assert np.all(np.isfinite(found["efficiency"]))


def test_no_result_of_a_pair_depends_on_the_units(tree: xr.DataTree) -> None:
    """Other units of length, time and mass throughout: powers change as they must, ratios not at all."""
    length, time, mass = 1.05, 0.97, 1.02  # small: the formula's limits are in Pa and m
    force, pressure = mass * length / time**2, mass / (length * time**2)
    ease_off, loaded = tree["ease_off"].to_dataset(), tree["loaded"].to_dataset()
    origins = {name: length * np.asarray(ease_off.attrs[name]) for name in ("pinion_origin_mm", "gear_origin_mm")}
    factors = {"force": force, "length": length, "equivalent_radius": length, "pressure": pressure}
    other = xr.DataTree.from_dict(
        {
            "ease_off": ease_off.assign(action_position=length * ease_off["action_position"]).assign_attrs(origins),
            "loaded": loaded.assign({name: factor * loaded[name] for name, factor in factors.items()})
            .assign_coords(torque=force * length * loaded["torque"])
            .assign_attrs(contact_modulus_MPa=pressure * loaded.attrs["contact_modulus_MPa"]),
        }
    )
    oil = lubricant("75w90")
    like_it = replace(
        oil,
        dynamic_viscosity=pressure * time * oil.dynamic_viscosity,
        pressure_viscosity=oil.pressure_viscosity / pressure,
        thermal_conductivity=mass * length / time**3 * oil.thermal_conductivity,
    )
    # ASTM D341 holds in mm^2/s alone: at a temperature of the table, and without the slope of the viscosity.
    model = FrictionModel(thermal_factor="none")
    one = friction(tree, Operation([300.0, 1500.0], 75.0, 0.8), model)
    two = friction(other, Operation([300.0 / time, 1500.0 / time], 75.0, 0.8 * length, like_it), model)
    for name in ("efficiency", "mean_friction_coefficient", "lambda_ratio", "friction_coefficient", "slide_to_roll"):
        np.testing.assert_allclose(two[name].values, one[name].values, rtol=1e-9)
    for name in ("mean_sliding_loss", "mean_rolling_loss", "input_power"):
        np.testing.assert_allclose(two[name].values, force * length / time * one[name].values, rtol=1e-9)


# --- what a user can get wrong, and the command line


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"speed": 0.0}, "speed = 0: must be a number above 0"),
        ({"speed": [1000.0, np.nan]}, "speed = nan"),
        ({"speed": "fast"}, "speed = 'fast'"),
        ({"speed": []}, r"speed = \[\]"),
        ({"speed": [500.0, 500.0]}, "comes twice"),
        ({"roughness": -0.1}, "roughness = -0.1"),
        ({"roughness": (0.1, 0.2, 0.3)}, "tuple"),
        ({"roughness": ["rough"]}, "rough"),
        ({"roughness": [0.8, 0.8]}, "values that differ"),
        ({"roughness": [(0.8, 0.4), (0.4, 0.8)]}, "values that differ"),
        ({"oil": None}, "oil = None"),
        ({"temperature": -300.0}, "temperature = -300"),
        ({"oil": "butter"}, "butter"),
    ],
)
def test_impossible_conditions_are_named(given: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Operation(**({"speed": 1000.0} | given))


def test_unknown_models_are_named() -> None:
    for options, message in (
        ({"coefficient": "sand"}, "sand"),
        ({"film": "thick"}, "film = 'thick'"),
        ({"thermal_factor": "hot"}, "thermal_factor = 'hot'"),
        ({"rolling_frame": "moon"}, "rolling_frame = 'moon'"),
        ({"out_of_range": "ignore"}, "out_of_range = 'ignore'"),
        ({"coefficient": None}, "coefficient = None"),
        ({"coefficient": True}, "coefficient = True"),
        ({"coefficient": np.inf}, "coefficient = inf: must be a number from 0 to 1"),
        ({"film": []}, "film = \\[\\]"),
    ):
        with pytest.raises(InputError, match=message):
            FrictionModel(**options)


def test_a_model_may_be_that_of_the_coefficient_alone(tree: xr.DataTree) -> None:
    operation = Operation(1500.0)
    for given in ("benedict_kelly", 0.07):
        by_model = friction(tree, operation, FrictionModel(given))
        xr.testing.assert_identical(friction(tree, operation, given), by_model)
    with pytest.raises(InputError, match="operation = 500: must be an Operation"):
        friction(tree, 500)  # type: ignore[arg-type]


def test_a_result_without_a_dimension_is_named(tree: xr.DataTree) -> None:
    with pytest.raises(InputError, match=r"no dimension torque.*isel\(torque=\[0\]\)"):
        friction(tree.isel(torque=0), Operation(1500.0))


def test_the_oil_of_a_case_is_not_written_over(tmp_path: Path) -> None:
    oil = (LUBRICANTS_FOLDER / "75w90.toml").read_text(encoding="utf-8")
    (tmp_path / "oil.toml").write_text(oil, encoding="utf-8")
    text = (Path(easeoff.cases.__file__).with_name("nasa-12x36.toml")).read_text(encoding="utf-8")
    (tmp_path / "case.toml").write_text(text + '\n[friction]\nspeed = 500\noil = "oil.toml"\n', encoding="utf-8")
    names = [str(tmp_path / name) for name in ("case.toml", "oil.toml")]
    for command in (["run"], ["convert", "--force"]):
        assert "is the file that is read" in refusal_of(*command, names[0], "-o", names[1])
        assert (tmp_path / "oil.toml").read_text(encoding="utf-8") == oil


def test_report_and_pictures_name_unusual_models(tree: xr.DataTree, result: xr.Dataset) -> None:
    assert named_models(result.attrs) == "oil 75w90, coefficient kolivand_blended"
    model = FrictionModel(film="dowson_higginson", rolling_frame="contact_line")
    text = named_models(friction(tree, Operation(1500.0), model).attrs)
    assert text == "oil 75w90, coefficient kolivand_blended, film dowson_higginson, rolling frame contact_line"


def test_conditions_need_a_speed() -> None:
    assert operation_of(None, speed=None, oil=None) is None
    found = operation_of(None, speed=1000.0, temperature=None)
    assert found is not None
    assert found.temperature == 90.0
    with pytest.raises(InputError, match="oil and roughness without a speed"):
        operation_of(None, speed=None, oil="75w90", roughness=0.4, temperature=None)
    with pytest.raises(InputError, match="speed = None: must be given"):
        easeoff.analyze(small_case("fh-design-a").model_copy(update={"friction": None}), friction_feedback=True)
    with pytest.raises(InputError, match="friction_model = 'kolivand': must be a FrictionModel"):
        easeoff.analyze(small_case("fh-design-a"), speed=1000.0, friction_model="kolivand")  # type: ignore[arg-type]


def test_temperature_out_of_range_shows_before_the_work_or_is_flagged(tree: xr.DataTree) -> None:
    with pytest.raises(InputError, match="temperature = 120"):
        easeoff.analyze(small_case("fh-design-a"), speed=1000.0, temperature=120.0)
    found = friction(tree, Operation(1000.0, [100.0, 120.0]), FrictionModel(out_of_range="clamp"))
    assert found["temperature_clamped"].values.tolist() == [0, 1]
    np.testing.assert_allclose(found["efficiency"].isel(temperature=0), found["efficiency"].isel(temperature=1))
    touching = found["friction_coefficient"].notnull()
    assert np.all((found["formula_flags"].isel(temperature=1) & 128).values[touching.isel(temperature=1)] == 128)


def test_command_line(tmp_path: Path) -> None:
    case, out = small_file(tmp_path, more=SHELLS), tmp_path / "out.nc"
    options = ["--torque", "200", "--speed", "500:1500:3", "--roughness", "0.8/0.4,0.2", "--temperature", "60,90"]
    output_of("run", case, "-o", out, *options, "--oil", "pao-vg100")
    group = easeoff.read_result(out)["friction"].to_dataset()
    assert group["speed"].values.tolist() == [500.0, 1000.0, 1500.0]
    assert group["roughness_gear"].values.tolist() == [0.4, 0.2]
    assert group.attrs["oil"] == "pao-vg100"
    shown = call("show", out).output
    assert "0.8/0.4" in shown
    assert f"{100 * group['efficiency'].values[0, 2, 1, 0]:.2f}" in shown


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--oil", "75w90"], "without a speed"),
        (["--friction-feedback"], "go with --speed"),
        (["--film-heating", "none"], "go with --speed"),
        (["--speed", "fast"], "FROM:TO:COUNT"),
        (["--speed", "1:2:3:4"], "FROM:TO:COUNT"),
        (["--speed", "-5"], "speed = -5"),
        (["--speed", "500", "--roughness", "0.8/x"], "PINION/GEAR"),
        (["--speed", "500", "--temperature", "400"], "temperature = 400"),
        (["--speed", "500", "--friction-model", "sand"], "sand"),
    ],
)
def test_mistakes_on_the_command_line(tmp_path: Path, options: list[str], message: str) -> None:
    assert message in refusal_of("run", "nasa-12x36", "-o", tmp_path / "out.nc", *options)
    assert not list(tmp_path.iterdir())


def test_report_with_feedback_says_so(tree: xr.DataTree, fed_back: xr.Dataset) -> None:
    whole = xr.DataTree.from_dict({**tree.to_dict(), "/friction": fed_back})
    whole.attrs = tree.attrs
    assert "fed back to the forces: oil 75w90" in result_summary(whole)


def test_a_long_report_names_the_extremes(tree: xr.DataTree, result: xr.Dataset) -> None:
    whole = xr.DataTree.from_dict({**tree.to_dict(), "/friction": result})
    whole.attrs = tree.attrs
    text = result_summary(whole)
    assert result["efficiency"].size == 54
    assert "... and 14 more" in text
    for word, value in (("least", result["efficiency"].min()), ("greatest", result["efficiency"].max())):
        told = re.search(rf"{word} efficiency: ([\d.]+) % at ", text)
        assert told is not None
        assert float(told[1]) == pytest.approx(100 * float(value), abs=0.051)  # one digit where the formula is left
