"""Tables of load cases, in a case and as text in columns."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from easeoff import InputError, read_case
from easeoff.cases import LoadCase, case_text, case_toml, load_case_misalignment, parse_case, read_load_cases

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
    path = folder / "duty.csv"
    path.write_text(text, encoding="utf-8")
    return path


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
