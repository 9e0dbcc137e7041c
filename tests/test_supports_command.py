"""Supports on the command line, and what of them an analysis takes from the case."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from runs import call, output_of, refusal_of, small

from easeoff import analyze, read_result
from easeoff.cases import Case, parse_case, read_supports, with_supports, write_case
from easeoff.contact import read_problems
from easeoff.contact.supports.assembly_rounds import AssemblyRounds
from easeoff.geometry import Misalignment

AXLE = "axle-fm-11x41"


@pytest.fixture(scope="module")
def coarse() -> Case:
    case = small("fm-11x41", "shell", torques=(250.0,), edge_contact=False)
    return case.model_copy(update={"misalignment": type(case.misalignment)()})


def test_supports_by_name_are_those_of_a_case_that_has_them(coarse: Case, tmp_path: Path) -> None:
    plain, own, found = tmp_path / "plain.toml", tmp_path / "own.toml", tmp_path / "found.nc"
    write_case(coarse, plain)
    write_case(with_supports(coarse, AXLE), own)
    output_of("run", plain, "--supports", AXLE, "-o", found)
    named = read_result(found)
    assert parse_case(named.attrs["case"]).supports == read_supports(AXLE)
    tree = analyze(own)
    for group in ("misalignment", "supports", "loaded"):
        assert group in named.children
    there, force = (np.asarray(one["loaded/force"], dtype=float) for one in (named, tree))
    # Not the same to the bit: few problems are solved without compiled code
    np.testing.assert_allclose(there, force, rtol=0, atol=1e-9 * np.nanmax(force))


@pytest.mark.thorough
def test_problems_and_sweeps_take_supports(coarse: Case, tmp_path: Path) -> None:
    plain = tmp_path / "plain.toml"
    write_case(coarse, plain)
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


def test_a_mistake_in_supports_is_one_message(coarse: Case, tmp_path: Path) -> None:
    plain, mine = tmp_path / "plain.toml", tmp_path / "mine.toml"
    write_case(coarse, plain)
    out = tmp_path / "out.nc"
    assert "the shipped supports are: axle-fm-11x41" in refusal_of("run", plain, "--supports", "nothing", "-o", out)
    mine.write_text('easeoff_support = 1\ntitle = "x"\n[supports.pinion]\nreference = [0, 0, 0]\n')
    message = refusal_of("run", plain, "--supports", mine, "-o", out)
    assert "supports.pinion: none given: give one of stiffness, compliance, or a shaft with bearings" in message
    assert not out.exists()


@pytest.mark.thorough
def test_rounds_are_those_of_the_case_unless_given(coarse: Case) -> None:
    table = read_supports(AXLE).model_copy(update={"rounds": "none"})
    first_order = analyze(with_supports(coarse, table))
    given = analyze(with_supports(coarse, AXLE), rounds=AssemblyRounds("none"))
    usual = analyze(with_supports(coarse, table), rounds=AssemblyRounds("mean"))
    np.testing.assert_array_equal(first_order["loaded/force"], given["loaded/force"])
    np.testing.assert_array_equal(usual["loaded/force"], analyze(with_supports(coarse, AXLE))["loaded/force"])
    assert int(first_order["supports/rounds"].max()) < int(usual["supports/rounds"].max())


@pytest.mark.thorough
def test_bearings_that_stiffen_lie_between_their_least_and_greatest_stiffness(coarse: Case) -> None:
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
        tree = analyze(with_supports(coarse, table.model_copy(update={"pinion": pinion})))
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
    command: str, coarse: Case, tmp_path: Path
) -> None:
    plain, held = tmp_path / "plain.toml", tmp_path / "held.nc"
    write_case(coarse, plain)
    needed = ["--torque", 250, "--revolutions", 10] if command == "wear" else []
    said = refusal_of(command, plain, *needed, "--supports", "axle-fm-11x4", "-o", tmp_path / "out.nc")
    assert "did you mean 'axle-fm-11x41'" in said
    held.write_text("easeoff_support = 1", encoding="utf-8")
    said = refusal_of(command, plain, *needed, "--supports", held, "-o", held)
    assert "is the file that is read" in said


@pytest.mark.thorough
def test_wear_modification_and_verification_take_supports(coarse: Case, tmp_path: Path) -> None:
    plain, own = tmp_path / "plain.toml", tmp_path / "own.toml"
    write_case(coarse, plain)
    write_case(with_supports(coarse, AXLE), own)
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
