"""Misalignment that depends on the torque: the curve through its rows, and analyses and studies that take it.

What proves the analyses is an identity: at every torque they are those of this torque alone, in the constant
misalignment that the deflections have there.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import output_of, read_only, refusal_of, small, text_file

import easeoff
from easeoff.cases import Case, Deflections, LoadCase, case_text, case_toml, parse_case, read_deflections
from easeoff.cases.deflection_table import misalignment_of
from easeoff.cases.schema.case_schema import DeflectionRow, deflections_of
from easeoff.contact import read_problems
from easeoff.contact.supports.assembly_rounds import AssemblyRounds
from easeoff.core.errors import InputError
from easeoff.friction import Operation, friction
from easeoff.geometry import Misalignment, Modification
from easeoff.study import CaseInMesh, WearLaw, analyze_load_cases, vh_check, wear, write_pictures
from easeoff.study.analysis.contact_analysis import contact_analysis
from easeoff.study.summary.result_summary import result_summary
from easeoff.study.sweep import sweep
from easeoff.verification import verify
from easeoff.verification.verified_pair import VerifiedPair

AXLE = Deflections(
    [0.0, 100.0, 300.0],
    offset=[0.01, 0.03, 0.05],
    pinion_axial=[0.0, -0.01, -0.03],
    gear_axial=[0.0, 0.01, 0.02],
    shaft_angle=[0.0, 1e-4, 2e-4],
)
TORQUES = [300.0, 40.0]  # not in order
SPEEDS = [500.0, 1500.0]
TABLE = "torque,E,P,flank\n0,0,0,drive\n100,0.02,-0.01,drive\n300,0.05,-0.03,drive\n200,-0.04,0.01,coast\n"


@pytest.fixture(scope="module")
def case() -> Case:
    return small("fm-11x41", "shell", edge_contact=False)


@cache
def analysed(torque: float | None = None, at: float | None = None) -> xr.DataTree:
    """All torques at once, or one of them in the constant misalignment that the deflections have there or elsewhere."""
    there = AXLE if torque is None else AXLE.at(torque if at is None else at)
    torques = TORQUES if torque is None else torque
    return read_only(easeoff.analyze(small("fm-11x41", "shell"), torques=torques, misalignment=there, speed=SPEEDS))


def at_torque(group: xr.Dataset, number: int, own: xr.Dataset, name: str) -> Any:
    """Values of a variable at one torque, on the segments and tooth pairs of another dataset."""
    here = group[name].isel(torque=[number] if "torque" in own[name].dims else number)
    if "segment" in here.dims:
        beyond = here.isel(segment=slice(own.sizes["segment"], None)).values
        assert np.all(np.isnan(beyond) if beyond.dtype.kind == "f" else beyond == 0)
        here = here.isel(segment=slice(own.sizes["segment"]))
    if "pair" in here.dims:
        here = here.sel(pair=own["pair"].values)
    return here.transpose(*own[name].dims).values


def assert_joined(whole: xr.DataTree, alone: xr.DataTree, number: int, groups: tuple[str, ...]) -> None:
    for group in groups:
        joined, own = whole[group].to_dataset(), alone[group].to_dataset()
        for name in own.variables:
            if name != "pair" and "torque" in joined[name].dims:
                found = at_torque(joined, number, own, str(name))
                np.testing.assert_array_equal(found, own[name].values, err_msg=f"{group}/{name}")


# The curve


def test_goes_through_the_rows_and_not_beyond_the_two_it_is_between() -> None:
    rng = np.random.default_rng(3)
    torque = np.cumsum(rng.uniform(1.0, 80.0, 9))
    value = rng.normal(0.0, 0.1, 9)
    found = Deflections(torque, offset=value)
    assert [found.at(one).offset for one in torque] == value.tolist()
    for k in range(8):
        between = [found.at(one).offset for one in np.linspace(torque[k], torque[k + 1], 40)]
        assert np.all(np.diff(between) * np.sign(value[k + 1] - value[k]) >= -1e-15)
        assert min(value[k : k + 2]) - 1e-15 <= min(between) <= max(between) <= max(value[k : k + 2]) + 1e-15


def test_is_the_monotone_cubic_of_fritsch_and_carlson_with_the_slopes_of_fritsch_and_butland() -> None:
    """At an inner row the slope is the weighted harmonic mean of those beside it; by hand for three rows."""
    found = Deflections([0.0, 100.0, 300.0], offset=[0.0, 0.02, 0.05])
    before, after, h0, h1 = 0.02 / 100.0, 0.03 / 200.0, 100.0, 200.0
    inner = 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / before + (h1 + 2.0 * h0) / after)
    step = 1e-3
    assert (found.at(100.0 + step).offset - found.at(100.0 - step).offset) / (2 * step) == pytest.approx(
        inner, rel=1e-6
    )
    last = ((2.0 * h1 + h0) * after - h1 * before) / (h0 + h1)
    assert (found.at(500.0).offset - 0.05) / 200.0 == pytest.approx(last, rel=1e-12)


def test_straight_rows_give_a_straight_line_and_go_straight_on() -> None:
    found = Deflections([50.0, 150.0, 400.0], shaft_angle=[5e-5, 15e-5, 40e-5])
    for torque in (50.0, 77.0, 399.0, 400.0, 900.0):
        assert found.at(torque).shaft_angle == pytest.approx(1e-6 * torque, rel=1e-12)
    assert found.at(0.0) == found.at(20.0) == found.at(50.0)  # the first row holds below


def test_one_row_holds_at_every_torque_and_the_constant_part_is_added() -> None:
    found = Deflections([100.0], offset=[0.02], constant=Misalignment(offset=0.1, gear_axial=0.3))
    assert found.at(0.0) == found.at(100.0) == found.at(5000.0) == Misalignment(0.02 + 0.1, 0.0, 0.3, 0.0)


def test_drive_and_coast_have_their_own_rows() -> None:
    found = Deflections(
        [0.0, 200.0, 0.0, 100.0], offset=[0.0, 0.04, 0.0, -0.03], flank=["drive", "drive", "coast", "coast"]
    )
    assert found.at(100.0, "drive").offset == pytest.approx(0.02)
    assert found.at(100.0, "coast").offset == -0.03
    assert found.torque_range("coast") == (0.0, 100.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"torque": []}, "torque"),
        ({"torque": [1.0, 1.0]}, r"torque = 1: comes twice"),
        ({"torque": [2.0, 1.0]}, r"torque = 1: comes after 2"),
        ({"torque": [-1.0, 1.0]}, "torque"),
        ({"torque": [0.0, 1e7]}, "below 1e"),
        ({"torque": [0.0, np.nan]}, "torque"),
        ({"torque": [0.0, 1.0], "offset": [0.0, np.nan]}, "offset"),
        ({"torque": [0.0, 1.0], "offset": [0.0]}, "offset: has 1 values: must have 2"),
        ({"torque": [0.0, 1.0], "offset": 0.1}, "offset"),
        ({"torque": [0.0, 1.0], "offset": [0.0, 11.0]}, "offset = 11"),
        ({"torque": [0.0, 1.0], "shaft_angle": [0.0, 0.1]}, "shaft_angle = 0.1"),
        ({"torque": [0.0, 1.0], "flank": ["drive", "left"]}, "flank = 'left'"),
        ({"torque": [0.0, 1.0], "flank": ["drive"]}, "flank: has 1 values"),
        ({"torque": [3.0, 1.0, 1.0], "flank": ["drive", "coast", "coast"]}, "torques of the coast flanks must rise"),
    ],
)
def test_wrong_deflections_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Deflections(**arguments)


def test_what_the_table_cannot_say_is_refused() -> None:
    with pytest.raises(InputError, match=r"rows of the drive flanks alone: give rows of the coast flanks"):
        Deflections([0.0, 1.0], flank="drive").at(1.0, "coast")
    with pytest.raises(InputError, match=r"torque = 5000: E = 15 there: must lie between -10 and 10 \[mm\]; .* 1 N m"):
        Deflections([0.0, 1.0], offset=[0.0, 0.003]).at(5000.0)


# Files


def test_reads_a_file_and_writes_a_case(tmp_path: Path, case: Case) -> None:
    file = text_file(tmp_path / "axle.csv", TABLE)
    found = read_deflections(file)
    assert found.at(300.0) == Misalignment(0.05, -0.03)
    assert found.at(50.0, "coast") == Misalignment(-0.04, 0.01)
    rows = "[misalignment]\noffset = 0.1\n" + "".join(
        f"[[misalignment.deflections]]\ntorque = {torque}\nE = {error}\n" for torque, error in ((0, 0.0), (100, 0.02))
    )
    read = parse_case(case_toml(case).replace("[misalignment]\noffset = -0.15\npinion_axial = 0.12\n", rows))
    again = parse_case(case_toml(read))
    assert again.misalignment == read.misalignment
    state = CaseInMesh.of(again)
    assert isinstance(state.misalignment, Deflections)
    assert state.misalignment.at(100.0).offset == pytest.approx(0.12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no rows: give a head such as torque,E,P,G,Sigma"),
        ("torque,E\n", "has a head but no rows"),
        ("E,P\n0,0\n", "the column torque is missing"),
        ("torque,E\n1,0\n1,0\n", "comes twice"),
        ("torque,E\n2,0\n1,0\n", "must rise from row to row"),
        ("torque,E\n-1,0\n", r"line 2, torque = -1\.0: must be at least 0"),
        ("torque,E\n1,nan\n", "line 2, E = nan: must be a finite number"),
        ("torque,E\n1,0\n2,\n", "line 3, E: is missing"),
        ("torque,E,flank\n1,0,drive\n2,0,\n", "line 3, flank: is missing"),
        ("torque,E,flank\n1,0,left\n", "flank"),
        ("torque,Sgima\n1,0\n", "'Sgima' is no column.*did you mean 'Sigma'"),
        ("torque,Sigma\n1,7\n", "Sigma"),
        ("\x00\x01", "NUL|column|text"),
    ],
)
def test_files_with_mistakes_are_refused(text: str, message: str, tmp_path: Path) -> None:
    file = text_file(tmp_path / "axle.csv", text)
    with pytest.raises(InputError, match=message) as error:
        read_deflections(file)
    assert "axle.csv" in str(error.value)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("[misalignment.deflections]\ntorque = 1\n", "with two brackets"),
        ("[[misalignment.deflections]]\nE = 1\n", "torque: is missing"),
        ("[[misalignment.deflections]]\ntorque = 1\noffset = 1\n", "offset = 1: is not a key"),
        ("[[misalignment.deflections]]\ntorque = 1\n[[misalignment.deflections]]\ntorque = 1\n", "comes twice"),
        (
            "[[misalignment.deflections]]\ntorque = 1\nE = 0\n[[misalignment.deflections]]\ntorque = 2\n",
            "E is in some rows of the deflections and not in that of torque = 2",
        ),
        (
            '[[misalignment.deflections]]\ntorque = 1\nflank = "drive"\n[[misalignment.deflections]]\ntorque = 2\n',
            "flank is in some rows",
        ),
    ],
)
def test_cases_with_mistakes_are_refused(rows: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_case(case_text("fm-11x41").replace("[misalignment]\noffset = -0.15\npinion_axial = 0.12\n", rows))


# The analysis


def test_every_torque_is_analysed_in_its_own_assembly() -> None:
    """On lines and edges; for lines alone see the modified ease-offs below."""
    whole = analysed()
    assert whole["loaded"].to_dataset()["torque"].values.tolist() == TORQUES
    for number, torque in enumerate(TORQUES):
        assert_joined(whole, analysed(torque), number, ("misalignment", "loaded", "friction"))
    share = whole["loaded/load_share"].sum("pair")
    np.testing.assert_allclose(share, 1.0, rtol=0, atol=1e-12)


def test_without_torque_and_under_light_load_the_assembly_is_that_there() -> None:
    whole, without = analysed(), analysed(3.0, at=0.0)
    for group in ("flanks", "ease_off", "teeth", "unloaded"):
        xr.testing.assert_identical(whole[group].to_dataset(), without[group].to_dataset())
    assert whole.attrs["misalignment_offset_mm"] == 0.01
    assert_joined(whole.assign(loaded=whole["light_load"]), analysed(3.0), 0, ("loaded",))


def test_friction_varies_with_the_torque_and_is_stored(tmp_path: Path) -> None:
    whole = analysed()
    assert whole["friction/sliding_velocity"].dims == ("torque", "mesh_position", "segment", "speed")
    easeoff.write_result(whole, tmp_path / "axle.nc")
    assert easeoff.read_result(tmp_path / "axle.nc").identical(whole)
    with pytest.raises(InputError, match="depends on the torque"):
        friction(whole, Operation(speed=500.0))


@pytest.mark.thorough
def test_friction_fed_back_is_that_of_every_assembly(case: Case) -> None:
    known: dict[str, Any] = {"speed": SPEEDS, "friction_feedback": True}
    whole = easeoff.analyze(case, torques=TORQUES, misalignment=AXLE, **known)
    for number, torque in enumerate(TORQUES):
        own = easeoff.analyze(case, torques=torque, misalignment=AXLE.at(torque), **known)
        assert_joined(whole, own, number, ("loaded", "friction"))


def test_supports_to_first_order_have_friction_in_the_one_assembly_of_their_ease_off(case: Case) -> None:
    """The misalignment depends on the torque there, the ease-off does not."""
    known: dict[str, Any] = {"supports": "axle-fm-11x41", "rounds": AssemblyRounds(update="none"), "speed": 500.0}
    tree = easeoff.analyze(case, torques=[50.0, 100.0], **known)
    assert np.ptp(tree["misalignment"].to_dataset()["offset"].values) > 0.01
    assert "torque" not in tree["friction"].to_dataset()["sliding_velocity"].dims
    assert np.all(tree["friction"].to_dataset()["efficiency"].values > 0.9)


@pytest.mark.thorough
def test_root_stress_is_that_of_every_assembly(case: Case) -> None:
    bricks = case.compliance.model_validate({"model": "fe", "fineness": 0.3})
    whole_teeth = case.model_copy(update={"compliance": bricks})
    whole = easeoff.analyze(whole_teeth, torques=TORQUES, misalignment=AXLE)
    for number, torque in enumerate(TORQUES):
        alone = easeoff.analyze(whole_teeth, torques=torque, misalignment=AXLE.at(torque))
        assert_joined(whole, alone, number, ("loaded", "root_stress"))


def test_rows_that_do_not_differ_are_a_constant_misalignment(case: Case) -> None:
    even = Deflections([10.0, 300.0], offset=[0.04, 0.04], pinion_axial=[0.01, 0.01])
    found = easeoff.analyze(case, torques=TORQUES, misalignment=even, speed=500.0)
    constant = easeoff.analyze(case, torques=TORQUES, misalignment=Misalignment(0.04, 0.01), speed=500.0)
    assert list(found.children) == list(constant.children)
    for group in constant.children:
        xr.testing.assert_identical(found[group].to_dataset(), constant[group].to_dataset())
    np.testing.assert_array_equal(constant["misalignment/offset"].values, np.full((2, 3), 0.04))


@pytest.mark.usefixtures("reading_here")
def test_modified_ease_offs_and_deviating_flanks_go_into_every_assembly(case: Case, tmp_path: Path) -> None:
    known: dict[str, Any] = {"modification": Modification({"lengthwise_crowning": 8.0, "bias": -3.0})}
    worn = tmp_path / "worn.nc"
    wear(case, WearLaw(1e-10, 1e-10, revolutions=1e3), torque=200.0).to_netcdf(worn)
    known["deviations"] = {"pinion": worn, "gear": worn}
    whole = easeoff.analyze(case, torques=[50.0, 300.0], misalignment=AXLE, **known)
    for number, torque in enumerate((50.0, 300.0)):
        alone = easeoff.analyze(case, torques=torque, misalignment=AXLE.at(torque), **known)
        assert_joined(whole, alone, number, ("misalignment", "loaded"))
    np.testing.assert_allclose(whole["loaded/load_share"].sum("pair"), 1.0, rtol=0, atol=1e-12)


def test_a_case_whose_deflections_lack_a_flank_takes_others(case: Case, tmp_path: Path) -> None:
    table = type(case.misalignment).model_validate({"deflections": [{"torque": 5.0, "E": 0.1, "flank": "drive"}]})
    drive = case.model_copy(update={"misalignment": table})
    with pytest.raises(InputError, match="give rows of the coast flanks"):
        CaseInMesh.of(drive, flank="coast")
    state = CaseInMesh.of(drive, flank="coast", misalignment=Misalignment(offset=0.02))
    assert state.pair.assembly.misalignment == Misalignment(offset=0.02)
    for wrong in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(InputError):
            CaseInMesh.of(case, misalignment=wrong)
    with pytest.raises(InputError, match="misalignment: float: must be a mapping such as"):
        CaseInMesh.of(case, misalignment=0.1)  # type: ignore[arg-type]


def test_extrapolation_is_told(case: Case) -> None:
    tree = easeoff.analyze(case, torques=[100.0, 400.0], misalignment=AXLE)
    assert tree.attrs["deflections"] == "table from 0 to 300 N m, extrapolated to 400 N m"
    assert tree.attrs["deflection_torques_N_m"] == [0.0, 300.0]
    shown = " ".join(result_summary(tree).split())
    assert "the table of deflections ends at 300 N m; at 400 N m E, P, G and Sigma were extrapolated" in shown
    assert "100 +0.0300 -0.0100 +0.0100 +0.0057" in shown  # Sigma in degrees
    assert "extrapolated" not in result_summary(analysed())


@pytest.mark.thorough
def test_there_is_a_picture_where_the_misalignment_depends_on_the_torque(case: Case, tmp_path: Path) -> None:
    within = easeoff.analyze(case, torques=[100.0, 300.0], misalignment=AXLE)
    assert write_pictures(within, tmp_path)[-1].stem.endswith("drive-misalignment")
    constant = easeoff.analyze(case, torques=100.0, misalignment=AXLE.at(100.0))
    assert not any("misalignment" in path.stem for path in write_pictures(constant, tmp_path))
    assert not list(tmp_path.glob("*misalignment.png"))


# Studies


def test_load_cases_are_in_the_assembly_at_their_torque(case: Case) -> None:
    rows = [LoadCase(torque=100.0), LoadCase(name="own", torque=250.0, E=0.02)]
    tree = analyze_load_cases(case, rows, misalignment=AXLE)
    alone = easeoff.analyze(case, torques=100.0, misalignment=AXLE)
    for group in alone.children:
        xr.testing.assert_identical(tree[f"results/1/{group}"].to_dataset(), alone[group].to_dataset())
    errors = AXLE.at(250.0)
    own = easeoff.analyze(
        case,
        torques=250.0,
        misalignment=Misalignment(0.02, errors.pinion_axial, errors.gear_axial, errors.shaft_angle),
    )
    xr.testing.assert_identical(tree["results/own/loaded"].to_dataset(), own["loaded"].to_dataset())
    numbers = tree["load_cases"].to_dataset()
    assert numbers["misalignment_offset"].values.tolist() == [0.03, 0.02]
    assert numbers["misalignment_gear_axial"].values.tolist() == [0.01, errors.gear_axial]


def test_swept_errors_take_the_place_of_the_constant_ones(case: Case) -> None:
    found = sweep(case, {"E": [-0.05, 0.04], "torque": [80.0, 400.0]}, misalignment=AXLE, workers=1)
    for k, offset in enumerate((-0.05, 0.04)):
        tree = easeoff.analyze(
            case, torques=[80.0, 400.0], misalignment=AXLE.with_constant(Misalignment(offset=offset))
        )
        for name in ("peak_to_peak", "max_pressure"):
            np.testing.assert_array_equal(found[name].values[k], tree["loaded"][name].values)
    assert found.attrs["deflections"] == "table from 0 to 300 N m, extrapolated to 400 N m"


def test_a_flank_wears_in_all_assemblies_of_its_duty_cycle(case: Case) -> None:
    law = WearLaw(1e-12, 2e-12, revolutions=1e3)  # one step
    both = wear(case, law, torque={100.0: 0.25, 300.0: 0.75}, misalignment=AXLE)
    each = [wear(case, law, torque=torque, misalignment=AXLE.at(torque)) for torque in (100.0, 300.0)]
    for name in ("peak_to_peak", "max_pressure"):
        start = [one[name].values[0, 0] for one in each]
        np.testing.assert_array_equal(both[name].values[0], start)
    volume = 0.25 * each[0]["removed_volume"] + 0.75 * each[1]["removed_volume"]
    np.testing.assert_allclose(both["removed_volume"].values, volume.values, rtol=1e-13)
    depth = 0.25 * each[0]["wear_depth"][-1] + 0.75 * each[1]["wear_depth"][-1]
    here = (each[0]["wear_depth"][-1] > 0.0) & (each[1]["wear_depth"][-1] > 0.0)
    np.testing.assert_allclose(both["wear_depth"][-1].where(here), depth.where(here), rtol=1e-12)


@pytest.mark.thorough
def test_optimises_for_the_assembly_of_every_torque(case: Case) -> None:
    known: dict[str, Any] = {"order": 2, "programmes": 2}
    none = case.model_copy(update={"misalignment": type(case.misalignment)()})
    torques = [300.0, 100.0]
    tree = easeoff.modify(none, torques=torques, misalignments=[AXLE], **known)
    record = tree["optimization"].to_dataset()
    assert record["depends_on_torque"].values.tolist() == [0, 1]
    for number, torque in enumerate(torques):
        alone = easeoff.modify(none, torques=[torque], misalignments=[AXLE.at(torque)], **known)
        own = alone["optimization"].to_dataset()
        for name in ("max_line_load", "max_pressure", "peak_to_peak", "max_end_load"):
            np.testing.assert_array_equal(
                record[name].sel(stage="before").values[:, number], own[name].sel(stage="before").values[:, 0]
            )
    after = record["max_line_load"].sel(stage="after") / record["max_line_load"].sel(stage="before").max("assembly")
    assert after.max() < 1.0
    modified = tree["modification"].to_dataset()
    terms = dict(zip(modified["term"].values.tolist(), modified["coefficient"].values.tolist(), strict=True))
    fresh = contact_analysis(
        CaseInMesh.of(none, misalignment=AXLE, modification=easeoff.geometry.Modification(terms)),
        torques,
        edge_contact=False,
    ).groups["loaded"]
    load = (fresh["force"] / fresh["length"]).max(["mesh_position", "segment"]).values
    np.testing.assert_allclose(load, record["max_line_load"].sel(stage="after", assembly=1).values, rtol=1e-9)


@pytest.mark.thorough
def test_without_load_the_check_is_that_without_torque(case: Case) -> None:
    found, constant = (vh_check(case, misalignment=one) for one in (AXLE, AXLE.at(0.0)))
    for name in ("v", "h"):
        np.testing.assert_array_equal(found[name].values, constant[name].values)


def test_verifies_one_torque_at_a_time(case: Case) -> None:
    with pytest.raises(
        InputError, match=r"torques = 100, 200: must be one where the misalignment depends on the torque"
    ):
        verify(case, torques=[200.0, 100.0], misalignment=AXLE)
    assert VerifiedPair.of(case, torques=200.0, misalignment=AXLE).misalignment == AXLE.at(200.0)


def test_commands_take_a_table(case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("axle.csv").write_text(TABLE)
    Path("case.toml").write_text(case_toml(case))
    given = ["case.toml", "--misalignment", "axle.csv", "--torque", "100,300"]
    output_of("problems", *given, "-o", "problems.nc")
    problems = read_problems("problems.nc")
    for torque, number in ((100.0, 0), (300.0, 1)):
        state = CaseInMesh.of(case, misalignment=read_deflections("axle.csv").at(torque))
        for own in contact_analysis(state, [torque]).cases:
            exported = problems[2 * own.mesh_position + number]
            np.testing.assert_array_equal(exported.separation, own.problem.separation)
            assert exported.torque == own.problem.torque
    said = output_of("run", *given[:3], "--torque", "100,400", "-o", "axle.nc")
    assert "at 400 N m E, P, G and Sigma were extrapolated" in said
    for wrong, message in (("exle.csv", "there is no file of this name"), ("case.toml", "is no column")):
        assert message in refusal_of("run", "case.toml", "--misalignment", wrong, "-o", "axle.nc")


def test_misalignment_is_given_by_keys_and_deflections_by_rows_in_degrees() -> None:
    assert misalignment_of({"E": 0.1, "P": -0.05}) == Misalignment(offset=0.1, pinion_axial=-0.05)
    rows = [DeflectionRow(torque=0.0, Sigma=0.0), DeflectionRow(torque=300.0, Sigma=1.8)]
    assert deflections_of(rows).at(300.0).shaft_angle == pytest.approx(np.radians(1.8), rel=1e-15)
