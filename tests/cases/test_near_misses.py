"""Inputs as users type or misread them: what is meant is taken, or the message names key or option and what to do."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest
import xarray as xr
from runs import SHELLS, call, output_of, refusal_of, small_file, text_file

import easeoff
from easeoff import InputError
from easeoff.cases import Design, LoadCase, designed_blanks, gear_pair, read_case, read_design, read_load_cases
from easeoff.cases.conversion import blank_design
from easeoff.cases.reading import DESIGN
from easeoff.cases.schema.case_schema import refuse_inches
from easeoff.core.toml_text import toml_tables
from easeoff.geometry.design.blank import blank_dimensions
from easeoff.geometry.design.tooth_proportions import ToothProportions
from easeoff.geometry.flanks.flank import NodeStatus
from easeoff.geometry.pair.assembly import Assembly
from easeoff.study import analyze_load_cases, vh_check
from easeoff.study.analysis.case_analysis import require_solver_options
from easeoff.study.cli import main
from easeoff.study.cli.option_values import torques
from easeoff.study.design.design_check import (
    blank_or_none,
    limit_pressure_angle_advice,
    offset_advice,
    proportion_warnings,
    small_target_advice,
)
from easeoff.study.summary.sweep_report import vh_table
from easeoff.study.vh import write_vh_check
from easeoff.verification import VerificationRow
from easeoff.verification.case_verification import closing
from easeoff.verification.geometry_rows import flank_rows


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
    design = DESIGN.read(name)
    refuse_inches(design.blank_design, design.gear.number_of_teeth)


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
    case = small_file(tmp_path, more=SHELLS)
    easeoff.write_result(easeoff.analyze(case, torques=[50.0]), tmp_path / "one.nc")
    output_of("report", tmp_path / "one.nc", "--author", "A. Gear <engineer>")
    assert "A. Gear \\u003cengineer>" in (tmp_path / "one.html").read_text(encoding="utf-8")
    assert (tmp_path / "one.html").exists()
    assert "-o: must be given with several results" in call("report", "a.nc", "b.nc").output


# Keywords of an analysis: what is no argument and no setting of its solver is refused before any work


COPY = r'it is a key of the case\'s \[{0}\]: .*case\.{0}\.model_copy\(update={{"{1}": \.\.\.}}\)'


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"torque": 100.0}, r"^torque = 100: must be an argument of analyze .*; did you mean 'torques'\?$"),
        ({"suports_": "axle-fm-11x41"}, "^suports_ = 'axle-fm-11x41': .*; did you mean 'supports'"),
        ({"time_limt": 1.0}, "did you mean 'time_limit'"),
        ({"xyz": 1}, "native takes tolerance, time_limit, max_iterations, polish, form, method$"),
        ({"mesh_positions": 8}, COPY.format("contact", "mesh_positions")),
        ({"fineness": 0.5}, COPY.format("compliance", "fineness")),
        ({"initial_force": [1.0]}, "initial_force = .*: must be an argument"),
        ({"tolerance": -1.0}, "tolerance = -1: must be a number above 0"),
        ({"method": "modl"}, "method = 'modl': must be one of cascade, modal"),
        ({"solver": "osqp", "torque": 100.0}, "did you mean 'torques'"),
        ({"solver": "osqp", "mesh_positions": 8}, COPY.format("contact", "mesh_positions")),
    ],
)
def test_an_unknown_keyword_is_refused_before_any_work(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        easeoff.analyze("no such case", **given)  # it is not even read


def test_load_cases_suggest_their_own_arguments() -> None:
    with pytest.raises(InputError, match=r"argument of analyze_load_cases .*did you mean 'temperature'"):
        analyze_load_cases("nasa-12x36", [LoadCase(torque=100.0)], temperaturee=90.0)


@pytest.mark.parametrize("setting", ["presolve", "eps_abs", "max_iter", "rho", "verbose", "scaling", "seed", "polish"])
def test_settings_of_another_solver_are_its_own(setting: str) -> None:
    require_solver_options({setting: 1}, "osqp", easeoff.analyze)


def test_a_method_of_the_native_solver_is_taken() -> None:
    require_solver_options({"method": "modal", "tolerance": 1e-10}, "auto", easeoff.analyze)


# Inputs that a user misreads: messages and hints name the key or option at fault and what to do instead


def changed(name: str, table: str, **values: Any) -> Design:
    """A shipped design with other values in one table."""
    design = read_design(name)
    part = getattr(design, table).model_copy(update=values)
    return design.model_copy(update={table: part})


def basic_data(design: Design) -> Any:
    teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
    return blank_design(design.blank_design, teeth, design.pair)


@pytest.mark.parametrize("name", ["fm-11x41", "fh-design-a"])
def test_a_gear_too_small_for_its_face_width_is_named(name: str) -> None:
    design = changed(name, "blank_design", gear_outer_pitch_diameter=20.0)
    teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
    with pytest.raises(InputError, match=r"gear_outer_pitch_diameter = 20\.0: must be greater, the gear_face_width of"):
        designed_blanks(design.blank_design, teeth, design.pair)


def test_exchanged_teeth_are_told_by_the_keys_of_the_file() -> None:
    design = read_design("fm-11x41")
    with pytest.raises(InputError, match=r"^pinion\.number_of_teeth = 37: must be at most gear\.number_of_teeth = 9"):
        blank_design(design.blank_design, (37, 9), design.pair)


@pytest.mark.parametrize("command", ["run", "verify", "problems"])
def test_a_negative_torque_points_to_the_coast_flanks(command: str, tmp_path: Path) -> None:
    said = refusal_of(command, "nasa-12x36", "--torque", "-300", "-o", tmp_path / "x.nc")
    assert "-300: must be greater than 0" in said
    assert "--flank coast" in said
    assert "--flank" not in call(command, "nasa-12x36", "--torque", "0", "-o", tmp_path / "x.nc").output
    assert list(tmp_path.iterdir()) == []


def test_a_negative_torque_of_a_load_case_points_to_its_flank(tmp_path: Path) -> None:
    table = text_file(tmp_path / "duty.csv", "torque,flank\n100,drive\n-80,drive\n")
    with pytest.raises(InputError, match=r'line 3, torque = -80\.0: must be at least .*; flank = "coast"'):
        read_load_cases(table)
    table.write_text("torque\n0\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"torque = 0\.0: must be at least 1e-06") as told:
        read_load_cases(table)
    assert "coast" not in str(told.value)


def test_a_flank_beside_load_cases_that_name_theirs_is_refused(tmp_path: Path) -> None:
    table, output = tmp_path / "duty.csv", tmp_path / "x.nc"
    table.write_text("torque,flank\n100,\n200,drive\n", encoding="utf-8")
    said = refusal_of("run", "nasa-12x36", "-o", output, "--load-cases", table, "--flank", "coast")
    assert "--flank: must not go with load cases that name their flank, as number 2 does" in " ".join(said.split())
    assert not output.exists()


@pytest.mark.parametrize(("thickness", "told"), [("0.006", True), ("0.5", False), ("6", False), ("-1", False)])
def test_a_marking_thickness_in_mm_is_told(thickness: str, told: bool, tmp_path: Path) -> None:
    """The hint comes with the options: before the case, which there is not, is read."""
    for command in ("run", "vh"):
        said = refusal_of(command, "no-such-case", "--marking", thickness, "-o", tmp_path / "x.nc")
        assert ("um are meant, not mm?" in said) == told


def test_a_crowning_in_mm_is_told_by_its_key() -> None:
    design = read_design("fm-11x41")
    assert small_target_advice(design) == []
    drive = design.target.drive.model_copy(update={"lengthwise_crowning": 0.06, "profile_crowning": 0.0})
    small = design.model_copy(update={"target": design.target.model_copy(update={"drive": drive})})
    (told,) = small_target_advice(small)
    assert told.startswith("target.drive.lengthwise_crowning = 0.06: ")
    assert "um are meant, not mm?" in told


@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45", "axle-10x41", "aero-12x36"])
def test_the_diameter_of_a_cutter_is_told_and_no_radius_of_a_shipped_design(name: str) -> None:
    data = basic_data(read_design(name))
    large = replace(data, cutter_radius=2.0 * data.cutter_radius)
    usual, unusual = (
        ToothProportions.of(blank_dimensions(each), each.cutter_radius, generated_gear=True) for each in (data, large)
    )
    assert list(proportion_warnings(usual)) == []
    *_, told = proportion_warnings(unusual)
    assert told.startswith(f"cutter_radius = {2.0 * data.cutter_radius:g} mm")
    assert "not the diameter?" in told


@pytest.mark.parametrize("hand", ["left", "right"])
@pytest.mark.parametrize("offset", [20.0, -20.0])
def test_a_positive_offset_is_below_centre_for_a_left_hand_pinion_and_enlarges_its_spiral_angle(
    hand: Any, offset: float
) -> None:
    """From the axes of the assembly, seen on the gear's toothed face with the pinion to the right, and the blanks."""
    pinion = Assembly(11, 41, pinion_hand=hand, shaft_angle=math.pi / 2, hypoid_offset=offset)
    forward = np.array([0.0, 0.0, 1.0])  # from the gear's apex towards its heel: onto the toothed face
    right = pinion.pinion_frame[:, 2]  # towards the pinion's heel
    up = np.cross(right, forward)
    assert right @ forward == pytest.approx(0.0, abs=1e-15)
    above = float(up @ pinion.pinion_origin) > 0.0
    assert above == ((hand == "right") == (offset > 0.0))
    design = changed("fm-11x41", "pair", hypoid_offset=offset)
    design = design.model_copy(update={"pinion": design.pinion.model_copy(update={"hand_of_spiral": hand})})
    data = replace(basic_data(design), depth_taper="standard")
    from easeoff.geometry.design.blank import blank_dimensions

    blanks = blank_dimensions(data)
    assert (blanks.pinion.mean_spiral_angle > blanks.gear.mean_spiral_angle) == (offset > 0.0)
    told = offset_advice(design, data)
    assert bool(told) == (offset < 0.0)
    if told:
        assert f"the {hand}-hand pinion lies {'above' if above else 'below'} centre and has the smaller" in told[0]


@pytest.mark.parametrize(("offset", "told"), [(60.0, True), (20.0, False)])
def test_a_small_generated_pressure_angle_is_told(offset: float, told: bool) -> None:
    """The limit pressure angle of a wide offset leaves the drive flank little; what the advice names helps."""
    design = changed("fm-11x41", "pair", hypoid_offset=offset)
    data = replace(basic_data(design), limit_pressure_angle_influence=1.0)
    found = limit_pressure_angle_advice(data, blank_or_none(data))
    assert bool(found) == told
    if told:
        assert "generated drive pressure angle of" in found[0]
        larger = replace(data, nominal_drive_pressure_angle=math.radians(40.0))
        assert not limit_pressure_angle_advice(larger, blank_or_none(larger))


def row(quantity: str, difference: float) -> VerificationRow:
    return VerificationRow(quantity, "another method", difference, 1.0, "%")


def test_the_closing_line_of_a_verification_speaks_of_contact_lines_alone() -> None:
    lines = [row("relative curvature across the line", 4.7), row("direction of the contact line", 2.0)]
    assert "near the ends of the path" in closing(lines)
    assert closing([*lines, row("unloaded transmission error", 2.0)]) == ""
    assert closing([]) == ""


def test_nodes_without_a_flank_are_named_in_the_rows_of_a_flank() -> None:
    gear = gear_pair(read_case("nasa-12x36")).gear
    flank = gear.flank(np.linspace(0.1, 0.9, 4), np.linspace(0.1, 0.9, 3))
    whole = flank_rows("gear", flank, gear.section)[0].compared
    assert "others" not in whole
    status, position = flank.status.copy(), flank.position.copy()
    status.flat[:3], status.flat[3] = NodeStatus.UNDERCUT, NodeStatus.BEYOND_BLADE_TIP
    position.reshape(3, -1)[:, :4] = np.nan
    cut = flank_rows("gear", replace(flank, status=status, position=position), gear.section)[0].compared
    assert (
        f"{flank.status.size - 4} of {flank.status.size} nodes (the others: 3 undercut, 1 beyond the blade tip)" in cut
    )
