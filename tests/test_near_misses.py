"""What engineers type at first: torques in any order, names without suffix, inches, files of other commands."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import click
import pytest
import xarray as xr
from runs import call, output_of, refusal_of, small_file

import easeoff
from easeoff import InputError
from easeoff.cases.reading import DESIGN
from easeoff.cases.schema.inch_lengths import refuse_inches
from easeoff.core.toml_text import toml_tables
from easeoff.study import vh_check
from easeoff.study.cli import main
from easeoff.study.cli.options.shared_options import torques
from easeoff.study.report.vh_table import vh_table
from easeoff.study.vh.vh_check import write_vh_check


@pytest.mark.parametrize("text", ["800,400,100", "800.0,100,400", "400, 100.0, 800"])
def test_torques_may_come_in_any_order_that_no_decimal_comma_makes(
    text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    context: Any = click.Context(main)
    option: Any = None
    assert torques(context, option, text) == (100.0, 400.0, 800.0)
    assert capsys.readouterr().err == "torques in rising order: 100, 400, 800 N m\n"
    assert torques(context, option, "100,400,800") == (100.0, 400.0, 800.0)
    assert capsys.readouterr().err == ""


def test_a_name_without_its_suffix_is_found_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("p3.toml").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match=r"did you mean 'p3.toml'\?"):
        easeoff.read_case("p3")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("hand_of_spiral = left", 'text needs quotes: "left"'),
        ("hand_of_spiral = left  # of the pinion", 'text needs quotes: "left"'),
        ("hypoid_offset = 35,5", "a decimal has a point: 35.5"),
    ],
)
def test_a_line_that_is_no_toml_says_how_it_is_written(line: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        toml_tables(line, "mine.toml")


def test_a_cutter_in_inches_is_told_its_millimetres() -> None:
    data = DESIGN.read("fm-11x41").model_dump()
    data["blank_design"]["cutter_radius"] = 3.75
    with pytest.raises(InputError, match=r"cutter_radius = 3.75: .*; 3.75 in is 95.25 mm"):
        DESIGN.check(data, "mine")


@pytest.mark.parametrize("name", DESIGN.names())
def test_shipped_cutters_are_in_millimetres(name: str) -> None:
    refuse_inches(DESIGN.read(name).blank_design)


def test_new_takes_a_file_in_place_of_an_option(tmp_path: Path) -> None:
    target = tmp_path / "mine.toml"
    output_of("new", "design", target)
    easeoff.cases.read_design(target)
    said = refusal_of("new", "design")
    assert "easeoff new design my.toml" in " ".join(said.split())


@cache
def check() -> xr.Dataset:
    return vh_check("fh-design-a")


@pytest.mark.thorough
def test_show_prints_the_table_of_a_vh_check(tmp_path: Path) -> None:
    path = tmp_path / "vh.nc"
    write_vh_check(check(), path)
    assert vh_table(check()) in output_of("show", path)
    with pytest.raises(InputError, match="of 'easeoff vh', for 'easeoff show', 'plot' and 'report'"):
        easeoff.read_result(path)


def test_a_table_of_another_command_is_named(tmp_path: Path) -> None:
    path = tmp_path / "table.nc"
    xr.Dataset({"solver_tolerance": ("row", [0])}).to_netcdf(path)
    with pytest.raises(InputError, match="the table of 'easeoff compare'"):
        easeoff.read_result(path)
    xr.Dataset({"comparison_status": ("row", [0])}).to_netcdf(path)
    for command, *words in (["show"], ["plot", "-o", tmp_path / "pictures"], ["report"]):
        said = refusal_of(command, path, *words)
        assert "the table of 'easeoff verify'" in " ".join(said.split())


def test_a_report_is_named_after_its_result(tmp_path: Path) -> None:
    case = small_file(tmp_path, more='\n[compliance]\nmodel = "shell"\n')
    easeoff.write_result(easeoff.analyze(case, torques=[50.0]), tmp_path / "one.nc")
    output_of("report", tmp_path / "one.nc", "--author", "A. Gear <engineer>")
    assert "A. Gear \\u003cengineer>" in (tmp_path / "one.html").read_text(encoding="utf-8")
    assert (tmp_path / "one.html").exists()
    assert "-o: must be given with several results" in call("report", "a.nc", "b.nc").output
