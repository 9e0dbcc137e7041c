"""Case files that the package writes: they read as the case they were written from, to the last digit."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from case_strategies import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from easeoff import InputError
from easeoff.cases import Case, case_toml, parse_case, read_case, shipped_cases, write_case


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_cases_survive(name: str) -> None:
    case = read_case(name)
    assert parse_case(case_toml(case)).model_dump() == case.model_dump()


@settings(max_examples=settings().max_examples // 2)
@given(cases())
def test_any_case_survives(case: Case) -> None:
    text = case_toml(case)
    assert parse_case(text).model_dump() == case.model_dump()
    assert case_toml(parse_case(text)) == text


def test_only_what_says_something_is_written_and_in_the_order_of_the_schema() -> None:
    case = read_case("nasa-12x36")
    data = tomllib.loads(case_toml(case))
    assert list(data) == ["easeoff_case", "title", "description", "pair", "pinion", "gear", "contact"]
    assert data["pair"] == {}  # must be there, but says nothing that is not the default
    assert list(data["contact"]) == ["torques"]
    assert "pitch_apex_beyond_crossing_point" not in data["pinion"]["blank"]
    assert "work_offset" not in data["gear"]["convex"]["machine"]
    assert data["pinion"]["concave"]["cutter"]["blade_point_radius"] == 75.3267830027
    assert "motions" not in data["pinion"]["concave"]["machine"]


@given(st.text(max_size=80))
def test_a_comment_stays_a_comment(comment: str) -> None:
    case = read_case("nasa-12x36")
    text = case_toml(case, comment)
    assert parse_case(text).model_dump() == case.model_dump()


def test_comment_lines_stand_at_the_top() -> None:
    assert case_toml(read_case("nasa-12x36"), "one\n\ntwo").startswith("# one\n#\n# two\neaseoff_case = 1\n")


def test_a_file_is_whole_or_not_there(tmp_path: Path) -> None:
    case = read_case("fm-11x41")
    write_case(case, tmp_path / "new" / "pair.toml", "made by a test")
    assert read_case(tmp_path / "new" / "pair.toml").model_dump() == case.model_dump()
    assert [p.name for p in (tmp_path / "new").iterdir()] == ["pair.toml"]
    with pytest.raises(InputError, match="folder"):
        write_case(case, tmp_path)
