"""Analysis over load cases: each equals an analysis of its own; means by definition; tables of load cases."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from runs import call, output_of, refusal_of, small, text_file

import easeoff
from easeoff import GeometryError, InputError, read_case
from easeoff.cases import Case, LoadCase, case_text, case_toml, parse_case, read_load_cases, write_case
from easeoff.cases.load_cases import has_own_misalignment, load_case_misalignment
from easeoff.cases.schema.load_case_table import named_load_cases
from easeoff.geometry import Misalignment
from easeoff.study import analyze_load_cases, equivalent_torque, key_numbers
from easeoff.study.load_case_analysis import DAMAGE_EXPONENTS, duty_means
from easeoff.study.summary.load_case_summary import load_case_tables
from easeoff.study.summary.quantities import LOADED, Quantity

ROWS = (
    LoadCase(name="cruise", torque=100.0, speed=2500.0, share=90.0),
    LoadCase(name="climb", torque=300.0, speed=1500.0, E=0.05, P=-0.02, Sigma=0.01, share=8.0),
    LoadCase(name="overrun", torque=80.0, speed=2500.0, flank="coast", share=2.0),
)


@pytest.fixture(scope="module")
def case() -> Case:
    return small(compliance="shell")


@pytest.fixture(scope="module")
def tree(case: Case) -> xr.DataTree:
    return analyze_load_cases(case, ROWS)


@pytest.fixture(scope="module")
def plain(case: Case) -> xr.DataTree:
    """Of one load case, without share, speed and name."""
    return analyze_load_cases(case, [LoadCase(torque=100.0)])


def numbers(tree: xr.DataTree) -> xr.Dataset:
    return tree["load_cases"].to_dataset()


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_every_load_case_is_an_analysis_of_its_own(case: Case, tree: xr.DataTree, row: LoadCase) -> None:
    """In its misalignment, at its torque and speed, on its flank; every number of ``show``, to rounding."""
    errors = Misalignment(row.E or 0.0, row.P or 0.0, row.G or 0.0, math.radians(row.Sigma or 0.0))
    own = easeoff.analyze(case, flank=row.flank or "drive", torques=row.torque, misalignment=errors, speed=row.speed)
    expected, found = key_numbers(own).squeeze(), numbers(tree).sel(load_case=row.name)
    assert set(expected.data_vars) <= set(found.data_vars)
    for name, value in expected.data_vars.items():
        if name != "worst_certificate":
            np.testing.assert_allclose(found[name], value, rtol=1e-11, atol=1e-11, err_msg=str(name))
    result = tree["results"].children[str(row.name)]
    np.testing.assert_allclose(result["loaded/force"], own["loaded/force"], rtol=1e-10, atol=1e-8)


def test_means_are_those_of_the_shares_of_time(tree: xr.DataTree) -> None:
    found, duty = numbers(tree), tree["duty"].to_dataset()
    share = np.array([0.9, 0.08, 0.02])
    np.testing.assert_allclose(found["share"], share)
    loss, power = (float(np.sum(share * found[name].values)) for name in ("mean_power_loss", "input_power"))
    assert float(duty["duty_power_loss"]) == pytest.approx(loss)
    assert float(duty["duty_efficiency"]) == pytest.approx(1.0 - loss / power)
    efficiency = found["efficiency"].values
    np.testing.assert_allclose(1.0 - found["mean_power_loss"] / found["input_power"], efficiency, rtol=1e-9)
    assert efficiency.min() < float(duty["duty_efficiency"]) < efficiency.max()


def test_equal_damage_counts_the_revolutions_of_each_flank(tree: xr.DataTree) -> None:
    duty = tree["duty"].to_dataset()
    for exponent in DAMAGE_EXPONENTS:
        cycles = np.array([0.9 * 2500.0, 0.08 * 1500.0])
        damage = cycles * np.array([100.0, 300.0]) ** exponent
        found = duty.sel(damage_exponent=exponent)
        assert float(found["equivalent_torque"].sel(flank="drive")) == pytest.approx(
            (damage.sum() / cycles.sum()) ** (1.0 / exponent)
        )
        assert float(found["equivalent_torque"].sel(flank="coast")) == pytest.approx(80.0)
        np.testing.assert_allclose(found["damage_share"].values[:2], damage / damage.sum())


def test_exponents_are_the_slopes_of_the_life_factors() -> None:
    """Pitting 6.61 and root bending 8.74 for case-hardened steel, as in ISO 6336-6."""
    np.testing.assert_allclose(DAMAGE_EXPONENTS, (6.610, 8.738), atol=2e-3)


def test_equivalent_torque_lies_between_mean_and_greatest() -> None:
    torques, cycles = np.array([50.0, 200.0, 400.0]), np.array([5.0, 3.0, 1.0])
    found = [equivalent_torque(torques, cycles, exponent) for exponent in (1.0, 3.0, 6.61, 8.74, 1e4)]
    assert found[0] == pytest.approx(float(np.average(torques, weights=cycles)))
    assert np.all(np.diff(found) > 0.0)
    assert found[-1] == pytest.approx(400.0, rel=1e-3)
    assert equivalent_torque(3.0 * torques, 7.0 * cycles, 6.61) == pytest.approx(3.0 * found[2])


def test_a_load_case_that_fails_is_a_row_with_a_reason(case: Case) -> None:
    rows = [LoadCase(torque=100.0, share=0.5), LoadCase(name="apart", torque=100.0, G=9.9, share=0.5)]
    found = numbers(analyze_load_cases(case, rows))
    assert found["status"].values.tolist() == [0, 2]
    assert "no part of the gear flank meets the pinion flank" in str(found["reason"].sel(load_case="apart").item())
    assert np.isnan(float(found["max_pressure"].sel(load_case="apart")))
    assert float(found["max_pressure"].sel(load_case="1")) > 100.0
    with pytest.raises(GeometryError, match="no part of the gear flank"):
        analyze_load_cases(case, rows[1:])


def test_means_without_a_value_are_unknown() -> None:
    rows = {"torque": [100.0, 300.0], "share": [0.5, 0.5], "mean_power_loss": [40.0, np.nan]}
    numbers = xr.Dataset({name: ("load_case", values) for name, values in rows.items()})
    numbers = numbers.assign(input_power=("load_case", [1000.0, 3000.0]), flank=("load_case", ["drive", "drive"]))
    duty = duty_means(numbers, [2.0])
    assert np.isnan(float(duty["duty_efficiency"]))
    assert float(duty["equivalent_torque"].squeeze()) == pytest.approx(math.sqrt(0.5 * (100.0**2 + 300.0**2)))


def test_without_shares_or_speeds_there_are_no_means_and_no_friction(plain: xr.DataTree) -> None:
    assert "duty" not in plain.children
    assert "efficiency" not in numbers(plain)
    assert numbers(plain)["load_case"].values.tolist() == ["1"]


def test_a_result_is_read_as_it_was_written(tmp_path: Path, tree: xr.DataTree) -> None:
    easeoff.write_result(tree, tmp_path / "duty.nc")
    assert easeoff.read_result(tmp_path / "duty.nc").identical(tree)
    assert "torque of equal damage, coast flanks: 80 N m (p = 6.61)" in str(tree.easeoff.summary())


@pytest.mark.parametrize(("head", "variable"), [("load case", "load_case"), (LOADED["max_pressure"], "max_pressure")])
def test_a_column_tells_its_variable(plain: xr.DataTree, head: str | Quantity, variable: str) -> None:
    table = load_case_tables(plain["load_cases"].to_dataset())[1]
    assert table.variables[list(table.heads).index(head)] == f"load_cases/{variable}"


def test_a_result_is_shown_unless_it_lacks_a_load_case(tmp_path: Path, plain: xr.DataTree) -> None:
    file = tmp_path / "duty.nc"
    easeoff.write_result(plain, file)
    said = output_of("show", file)
    assert said.strip() == str(plain.easeoff.summary()).strip()
    assert said.splitlines()[3].split()[:4] == ["load", "case", "flank", "torque"]
    lacking = plain.copy()
    del lacking["results"]["1"]
    easeoff.write_result(lacking, file)
    with pytest.raises(InputError, match="results: no 1"):
        easeoff.read_result(file)


@pytest.mark.parametrize(
    ("rows", "given", "said"),
    [
        ([], {}, "load_cases: the case has none"),
        ([LoadCase(torque=1.0), LoadCase(name="1", torque=2.0)], {}, "name = '1' comes twice"),
        ([LoadCase(torque=1.0)], {"damage_exponents": [0.5]}, "damage_exponents = 0.5"),
        ([LoadCase(torque=1.0)], {"damage_exponents": []}, "damage_exponents = []"),
        ([LoadCase(torque=1.0, speed=5.0)], {"temperature": [80.0, 90.0]}, "temperature has 2 values"),
        ([LoadCase(torque=1.0)], {"marking": -1.0}, "marking = -1"),
    ],
)
def test_wrong_arguments_are_refused(case: Case, rows: list[LoadCase], given: dict[str, float], said: str) -> None:
    with pytest.raises(InputError) as caught:
        analyze_load_cases(case, rows, **given)  # type: ignore[arg-type]
    assert said in str(caught.value)


@pytest.mark.thorough
def test_a_table_is_read_as_a_spreadsheet_saves_it(tmp_path: Path) -> None:
    path = tmp_path / "duty.csv"
    path.write_bytes("sep=;\r\ntorque;E;speed\r\n100;0,05;1.5D+03\r\n".encode("utf-16"))
    (row,) = read_load_cases(path)
    assert (row.torque, row.E, row.speed) == (100.0, 0.05, 1500.0)


def test_the_command_runs_a_table_and_the_load_cases_of_the_case(tmp_path: Path, case: Case) -> None:
    own, table, file = (tmp_path / name for name in ("case.toml", "duty.csv", "duty.nc"))
    table.write_text("name,torque,speed,share,E\ncruise,100,2500,0.9,\nclimb,300,1500,0.1,0.05\n")
    rows = (LoadCase(name="cruise", torque=100.0), LoadCase(name="climb", torque=300.0, E=0.05))
    write_case(case.model_copy(update={"load_cases": rows}), own)
    plots = tmp_path / "plots"
    assert "mean over time: power loss" in output_of("run", own, "--load-cases", table, "-o", file, "--plots", plots)
    assert (plots / "case-load_cases.png").stat().st_size > 10_000
    assert (plots / "climb" / "case-drive-efficiency.png").exists()
    pressure = numbers(easeoff.read_result(file))["max_pressure"]
    plain = call("run", own, "--torque", "100", "-o", tmp_path / "plain.nc")
    assert "has 2 load cases: --load-cases case analyses them" in plain.output
    output_of("run", own, "--load-cases", "case", "-o", file)
    xr.testing.assert_allclose(numbers(easeoff.read_result(file))["max_pressure"], pressure)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--torque", "5"], "--torque: must not go with --load-cases"),
        (["--misalignment", "E=0.1"], "--misalignment: must not go with --load-cases"),
        (["--speed", "500"], "--speed: must not go with --load-cases"),
        (["--temperature", "80,90"], "--temperature: must be one value"),
    ],
)
def test_options_that_load_cases_have_themselves_are_refused(tmp_path: Path, words: list[str], said: str) -> None:
    table = text_file(tmp_path / "duty.csv", "torque\n100\n")
    assert said in refusal_of("run", "nasa-12x36", "--load-cases", table, "-o", tmp_path / "out.nc", *words)


def test_a_case_without_load_cases_is_refused(tmp_path: Path) -> None:
    said = refusal_of("run", "nasa-12x36", "--load-cases", "case", "-o", tmp_path / "out.nc")
    assert "the case has no tables [[load_cases]]" in said


# Tables of load cases, in a case and as text in columns


TABLES = """
[[load_cases]]
name = "cruise"
torque = 100
speed = 2500
share = 0.9

[[load_cases]]
torque = 300.0
E = 0.05
Sigma = -0.01
share = 0.1
"""
COLUMNS = """# measured on the road
name,torque,speed,share,E,Sigma
cruise,100,2500,0.9
,300,,0.1,0.05,-0.01
"""


def table(folder: Path, text: str) -> Path:
    return text_file(folder / "duty.csv", text)


def message(folder: Path, text: str) -> str:
    with pytest.raises(InputError) as caught:
        read_load_cases(table(folder, text))
    return str(caught.value)


def test_a_case_and_a_text_in_columns_say_the_same(tmp_path: Path) -> None:
    case = parse_case(case_text("nasa-12x36") + TABLES)
    assert case.load_cases == read_load_cases(table(tmp_path, COLUMNS))
    assert parse_case(case_toml(case)).load_cases == case.load_cases
    assert [load_case.torque for load_case in case.load_cases] == [100.0, 300.0]


def test_columns_may_be_separated_as_a_spreadsheet_does(tmp_path: Path) -> None:
    expected = (LoadCase(torque=100.5, E=-0.05), LoadCase(torque=300.0))
    for text in ("torque;E\n100,5;-0,05\n300;;;\n", "E\ttorque\n-0.05\t100.5\n\t300\n", "torque E\n100.5 -0.05\n300\n"):
        assert read_load_cases(table(tmp_path, text)) == expected


def test_what_a_load_case_leaves_out_of_the_misalignment_is_that_of_the_case() -> None:
    case = read_case("nasa-12x36")
    own = case.misalignment.model_copy(update={"offset": 0.1, "pinion_axial": 0.2, "gear_axial": 0.3, "shaft_angle": 1})
    found = load_case_misalignment(LoadCase(torque=1.0, P=0.0), case.model_copy(update={"misalignment": own}))
    assert (found.offset, found.pinion_axial, found.gear_axial, found.shaft_angle) == (0.1, 0.0, 0.3, math.radians(1))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "has no load cases"),
        ("torque,E\n", "has a head but no load cases"),
        ("E,P\n0,0\n", "line 1: 'E,P': the column torque is missing"),
        ("torque,Sigme\n1,0\n", "line 1: 'Sigme' is no column"),
        ("torque,E,E\n1,0,0\n", "line 1: the column E comes twice"),
        ("torque,E\n100,0,05\n", "line 2, '100,0,05': 3 values, but the head has 2 columns; a decimal has a point"),
        ("torque\nabc\n", "line 2, torque = 'abc': must be a number"),
        ("torque\nnan\n", "line 2, torque = nan: must be a finite number"),
        ("torque\n1\n-5\n", "line 3, torque = -5.0: must be at least 1e-06 [N m]"),
        ("torque,E\n,1\n", "line 2, torque: is missing; it must be given"),
        ("torque,E\n1,25\n", "line 2, E = 25.0: must be below 10 [mm]"),
        ("name,torque\na/b,1\n", "line 2, name: 'a/b': must be up to 60 letters"),
        ("name,torque\na,1\nA,2\n", "name = 'A' comes twice"),
        ("torque,share\n1,1\n2,\n", "'2' has no share"),
        ("torque,flank\n1,left\n", "line 2, flank = 'left': must be 'drive' or 'coast'"),
        ("torque\n" + "1\n" * 1001, "has 1001 load cases: must have at most 1000"),
    ],
)
def test_a_table_that_cannot_be_used_is_refused_with_line_column_and_value(
    tmp_path: Path, text: str, said: str
) -> None:
    assert said in message(tmp_path, text)


def test_every_wrong_line_is_named(tmp_path: Path) -> None:
    said = message(tmp_path, "torque,E\n-1,0\n5,99\n")
    assert "has 2 mistakes" in said
    assert "line 2, torque" in said
    assert "line 3, E" in said


@pytest.mark.parametrize(
    ("added", "said"),
    [
        ("[load_cases]\ntorque = 1.0\n", "[[load_cases]], with two brackets"),
        ("[[load_cases]]\nE = 0.1\n", "load_cases.0.torque: is missing"),
        ("[[load_cases]]\ntorque = 1.0\nsped = 1.0\n", "did you mean 'speed'?"),
        ("[[load_cases]]\ntorque = 1.0\n[[load_cases]]\ntorque = 0.0\n", "load_cases.1.torque = 0.0: must be at least"),
    ],
)
def test_a_wrong_load_case_in_a_case_is_refused(added: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(case_text("nasa-12x36") + "\n" + added)
    assert said in str(caught.value)


def test_a_load_case_without_a_name_takes_its_number() -> None:
    assert list(named_load_cases([LoadCase(torque=100.0), LoadCase(torque=250.0, name="climb")])) == ["1", "climb"]


def test_a_zero_is_a_value_of_its_own_for_an_assembly_error() -> None:
    assert has_own_misalignment(LoadCase(torque=100.0, P=0.0))
    assert not has_own_misalignment(LoadCase(torque=100.0))
