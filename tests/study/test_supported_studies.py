"""A case on supports in analysis, wear, optimization and verification, and on the command line."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import call, output_of, read_only, refusal_of, small

import easeoff
from easeoff import analyze, read_result
from easeoff.cases import Case, parse_case, read_supports, with_supports, write_case
from easeoff.contact import AssemblyRounds, Supports, read_problems
from easeoff.core.errors import GeometryError
from easeoff.geometry import Misalignment
from easeoff.study import CaseInMesh, WearLaw, wear
from easeoff.study.analysis.contact_analysis import contact_analysis, in_assembly_under_load
from easeoff.study.summary.plausibility import doubts

GROUPS = ["flanks", "ease_off", "teeth", "unloaded", "light_load", "misalignment", "supports", "loaded"]


def coarse() -> Case:
    return small("fm-11x41", "shell", edge_contact=False)


def on_supports() -> Case:
    return with_supports(coarse(), "axle-fm-11x41")


@cache
def analysis(supported: bool) -> xr.DataTree:
    return read_only(easeoff.analyze(on_supports() if supported else coarse(), torques=[100.0, 300.0]))


@pytest.mark.thorough
def test_analysis_on_supports_is_a_result_like_others(tmp_path: Path) -> None:
    tree = easeoff.analyze(coarse(), torques=[300.0, 100.0], supports="axle-fm-11x41", speed=1000.0)
    assert list(tree.children) == [*GROUPS, "friction"]
    assert (tree["loaded"].to_dataset()["status"].values == 0).all()
    path = tmp_path / "result.nc"
    easeoff.write_result(tree, path)
    again = easeoff.read_result(path)
    for name in ("supports", "misalignment", "loaded"):
        assert again[name].to_dataset().equals(tree[name].to_dataset())
    named = easeoff.analyze(on_supports(), torques=[300.0, 100.0])
    assert named["supports"].to_dataset().equals(tree["supports"].to_dataset())


@pytest.mark.parametrize(("given", "told"), [(None, True), ({"E": 0.0}, False), ({"E": 0.05}, False)])
def test_the_misalignment_of_a_case_is_told_to_be_added_on_supports(given: Any, told: bool) -> None:
    first_order = AssemblyRounds(update="none")
    tree = easeoff.analyze(on_supports(), torques=[250.0], misalignment=given, rounds=first_order)
    notes = [note for note in doubts(tree) if "is added to that of the supports" in note]
    assert len(notes) == told
    if told:
        assert "the case's misalignment E -0.15 mm, P +0.12 mm stands without torque" in notes[0]
        assert "is added to that of the supports" in tree.easeoff.summary()._repr_html_()


def test_rigid_supports_give_the_analysis_without() -> None:
    plain = analysis(False)
    assert "supports" not in plain.children
    rigid = easeoff.analyze(
        coarse(), torques=[100.0, 300.0], supports=Supports.rigid(), rounds=AssemblyRounds(update="none")
    )
    assert plain["loaded"].to_dataset().identical(rigid["loaded"].to_dataset())
    for name in ("offset", "pinion_axial", "gear_axial", "shaft_angle"):
        np.testing.assert_allclose(
            plain["misalignment"].to_dataset()[name], rigid["misalignment"].to_dataset()[name], atol=1e-15
        )


def test_unloaded_contact_is_that_of_the_assembly_without_load() -> None:
    tree, plain = analysis(True), analysis(False)
    for name in ("ease_off", "unloaded"):
        assert tree[name].to_dataset().identical(plain[name].to_dataset())
    moved = (
        tree["misalignment"].to_dataset()["shaft_angle"].values
        - plain["misalignment"].to_dataset()["shaft_angle"].values
    )
    assert (moved > 1e-4).all()
    light = abs(
        tree["light_load"].to_dataset()["transmission_error"].values
        - plain["light_load"].to_dataset()["transmission_error"].values
    ).max()
    heavy = abs(
        tree["loaded"].to_dataset()["transmission_error"].values
        - plain["loaded"].to_dataset()["transmission_error"].values
    ).max()
    assert light < 0.2 * heavy


def test_assembly_under_load_is_that_of_the_analysis() -> None:
    tree = analysis(True)
    state = in_assembly_under_load(CaseInMesh.of(on_supports()), [300.0, 100.0])
    assert state.case.supports is None
    assert state.deflections is not None
    for torque in (100.0, 300.0):
        found = tree["misalignment"].to_dataset().sel(torque=torque).mean("mesh_position")
        for name, value in vars(state.deflections.at(torque)).items():
            assert value == pytest.approx(found[name].item(), rel=1e-12)
    # What varies over the mesh cycle is small: so is the difference of the two analyses.
    held = contact_analysis(state, [100.0, 300.0]).groups["loaded"]
    np.testing.assert_allclose(held["max_pressure"], tree["loaded"].to_dataset()["max_pressure"], rtol=0.02)


@pytest.mark.thorough
def test_wear_and_optimization_hold_the_assembly_under_load() -> None:
    law = WearLaw(1e-10, 1e-10, revolutions=1e4)
    on, off = (wear(case, law, torque=300.0) for case in (on_supports(), coarse()))
    state = in_assembly_under_load(CaseInMesh.of(on_supports()), [300.0])
    assert state.deflections is not None
    errors = state.deflections.at(300.0)
    there = wear(coarse(), law, torque=300.0, misalignment=errors)
    np.testing.assert_allclose(on["max_pressure"], there["max_pressure"], rtol=1e-9)
    assert abs(off["max_pressure"].values[0] / on["max_pressure"].values[0] - 1.0) > 0.01
    best = easeoff.modify(on_supports(), torques=[300.0], order=2, programmes=1)
    for name, value in vars(errors).items():
        np.testing.assert_allclose(best["misalignment"].to_dataset()[name], value, rtol=1e-9)
    before, after = best["optimization"].to_dataset()["max_line_load"].values.ravel()
    assert after <= before


def test_assembly_that_is_not_found_is_an_error_with_a_reason() -> None:
    case = on_supports()
    state = CaseInMesh.of(case, misalignment=Misalignment(offset=0.1))
    with pytest.MonkeyPatch.context() as patch:
        limited = AssemblyRounds(limit=1e-9, most=1)
        patch.setattr("easeoff.study.analysis.contact_analysis.case_rounds", lambda case: limited)
        with pytest.raises(GeometryError, match="after 1 rounds the assembly still changes gaps"):
            in_assembly_under_load(state, [300.0])


# Supports on the command line, and what of them an analysis takes from the case


AXLE = "axle-fm-11x41"


@pytest.fixture(scope="module")
def case() -> Case:
    case = small("fm-11x41", "shell", torques=(250.0,), edge_contact=False)
    return case.model_copy(update={"misalignment": type(case.misalignment)()})


def test_supports_by_name_are_those_of_a_case_that_has_them(case: Case, tmp_path: Path) -> None:
    plain, own, found = tmp_path / "plain.toml", tmp_path / "own.toml", tmp_path / "found.nc"
    write_case(case, plain)
    write_case(with_supports(case, AXLE), own)
    output_of("run", plain, "--supports", AXLE, "-o", found)
    named = read_result(found)
    assert parse_case(named.attrs["case"]).supports == read_supports(AXLE)
    tree = analyze(own)
    for group in ("misalignment", "supports", "loaded"):
        assert group in named.children
    there, force = (np.asarray(one["loaded/force"], dtype=float) for one in (named, tree))
    np.testing.assert_array_equal(there, force)


@pytest.mark.thorough
def test_problems_and_sweeps_take_supports(case: Case, tmp_path: Path) -> None:
    plain = tmp_path / "plain.toml"
    write_case(case, plain)
    output_of("problems", plain, "-o", tmp_path / "rigid.nc")
    output_of("problems", plain, "--supports", AXLE, "-o", tmp_path / "held.nc")
    rigid, held = (read_problems(tmp_path / f"{name}.nc")[0] for name in ("rigid", "held"))
    softest = [
        float(np.max(diagonal + (factor**2).sum(axis=1))) for diagonal, factor in (rigid.compliance, held.compliance)
    ]
    assert softest[1] > 1.1 * softest[0]
    greatest = []
    for name, supports in (("rigid", []), ("held", ["--supports", AXLE])):
        out = tmp_path / f"{name}-sweep.nc"
        output_of("sweep", plain, *supports, "--over", "torque=100,250", "--workers", 1, "-o", out)
        with xr.open_dataset(out, engine="netcdf4") as found:
            assert not found["status"].any()
            greatest.append(found["max_pressure"].values)
    assert np.all(np.abs(greatest[1] / greatest[0] - 1.0) > 1e-3)


def test_a_mistake_in_supports_is_one_message(case: Case, tmp_path: Path) -> None:
    plain, mine = tmp_path / "plain.toml", tmp_path / "mine.toml"
    write_case(case, plain)
    out = tmp_path / "out.nc"
    assert "the shipped supports are: axle-fm-11x41" in refusal_of("run", plain, "--supports", "nothing", "-o", out)
    mine.write_text('easeoff_support = 1\ntitle = "x"\n[supports.pinion]\nreference = [0, 0, 0]\n')
    message = refusal_of("run", plain, "--supports", mine, "-o", out)
    assert "supports.pinion: none given: give one of stiffness, compliance, or a shaft with bearings" in message
    assert not out.exists()


@pytest.mark.thorough
def test_rounds_are_those_of_the_case_unless_given(case: Case) -> None:
    table = read_supports(AXLE).model_copy(update={"rounds": "none"})
    first_order = analyze(with_supports(case, table))
    given = analyze(with_supports(case, AXLE), rounds=AssemblyRounds("none"))
    usual = analyze(with_supports(case, table), rounds=AssemblyRounds("mean"))
    np.testing.assert_array_equal(first_order["loaded/force"], given["loaded/force"])
    np.testing.assert_array_equal(usual["loaded/force"], analyze(with_supports(case, AXLE))["loaded/force"])
    assert int(first_order["supports/rounds"].max()) < int(usual["supports/rounds"].max())


@pytest.mark.thorough
def test_bearings_that_stiffen_lie_between_their_least_and_greatest_stiffness(case: Case) -> None:
    """Of a pinion whose bearings follow a line contact, under a torque within the curves."""
    table = read_supports(AXLE)
    assert table.pinion is not None

    def held(scale: float | None) -> Misalignment:
        bearings = []
        for bearing in table.pinion.bearings:  # type: ignore[union-attr]
            curve = tuple((load, 4e5 * (load / 100.0) ** 0.1) for load in (100.0, 1e3, 1e4, 1e5))
            radial = curve if scale is None else scale
            bearings.append(bearing.model_copy(update={"radial_stiffness": radial}))
        pinion = table.pinion.model_copy(update={"bearings": tuple(bearings)})  # type: ignore[union-attr]
        tree = analyze(with_supports(case, table.model_copy(update={"pinion": pinion})))
        return Misalignment(offset=float(tree["misalignment/offset"].mean()))

    soft, between, stiff = (held(scale).offset for scale in (4e5, None, 4e5 * 1000.0**0.1))
    assert soft < between < stiff < 0.0


@pytest.mark.thorough
def test_the_shipped_axle_moves_as_the_page_says() -> None:
    tree = analyze("fm-11x41", supports=AXLE, misalignment=Misalignment(), torques=250.0)
    moved = {name: float(tree[f"misalignment/{name}"].mean()) for name in ("offset", "pinion_axial", "gear_axial")}
    assert moved == pytest.approx({"offset": -0.1050, "pinion_axial": 0.0425, "gear_axial": -0.0377}, abs=5e-4)
    assert float(np.degrees(tree["misalignment/shaft_angle"]).mean()) == pytest.approx(0.025, abs=5e-4)


@pytest.mark.parametrize("command", ["wear", "modify", "verify"])
def test_studies_refuse_supports_that_are_not_there_and_do_not_overwrite_their_file(
    command: str, case: Case, tmp_path: Path
) -> None:
    plain, held = tmp_path / "plain.toml", tmp_path / "held.nc"
    write_case(case, plain)
    needed = ["--torque", 250, "--revolutions", 10] if command == "wear" else []
    said = refusal_of(command, plain, *needed, "--supports", "axle-fm-11x4", "-o", tmp_path / "out.nc")
    assert "did you mean 'axle-fm-11x41'" in said
    held.write_text("easeoff_support = 1", encoding="utf-8")
    said = refusal_of(command, plain, *needed, "--supports", held, "-o", held)
    assert "is the file that is read" in said


@pytest.mark.thorough
def test_wear_modification_and_verification_take_supports(case: Case, tmp_path: Path) -> None:
    plain, own = tmp_path / "plain.toml", tmp_path / "own.toml"
    write_case(case, plain)
    write_case(with_supports(case, AXLE), own)
    worn = ("--torque", 250, "--revolutions", 10)
    for command, options in (("wear", worn), ("modify", ("--order", 2)), ("verify", ())):
        for name, words in (("named", (plain, "--supports", AXLE)), ("own", (own,)), ("plain", (plain,))):
            outcome = call(command, *words, *options, "-o", tmp_path / f"{name}.nc")
            assert outcome.exit_code in (0, 1), outcome.output
        held, same, rigid = (
            xr.open_datatree(tmp_path / f"{n}.nc", engine="netcdf4") for n in ("named", "own", "plain")
        )
        numbers = {"wear": "max_pressure", "modify": "loaded/max_pressure", "verify": "difference"}[command]
        first, second, third = (np.ravel(np.asarray(tree[numbers], dtype=float)) for tree in (held, same, rigid))
        np.testing.assert_allclose(first, second, rtol=1e-6, atol=1e-12)
        assert first.shape != third.shape or not np.allclose(first, third, rtol=1e-4, atol=0.0, equal_nan=True)
        for tree in (held, same, rigid):
            tree.close()
