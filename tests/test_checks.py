"""Checks of arguments: every message names the argument, its value and what is allowed."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr

import easeoff
from easeoff import InputError, contact, geometry, read_case, study
from easeoff.cases import (
    LoadCase,
    case_toml,
    designed_blanks,
    gear_pair,
    parse_case,
    support_system,
    write_case,
    write_rexs,
)
from easeoff.core import checks
from easeoff.geometry import ease_off, formats, pair_geometry, tooth_angle
from easeoff.study.sweep import percentiles


@pytest.mark.parametrize("value", [None, "1", True, [1.0], 1 + 0j, math.nan, math.inf, -1.0])
def test_what_is_no_number_within_the_bounds_is_refused(value: Any) -> None:
    with pytest.raises(InputError, match=r"^length = .*: must be a finite number of 0 or more \[mm\]$"):
        checks.positive("length", value, "mm", zero=True)


@pytest.mark.parametrize("value", [3, 3.0, np.float32(3.0), np.int64(3), np.array(3.0), xr.DataArray(3.0)])
def test_numbers_of_numpy_are_numbers(value: Any) -> None:
    assert type(checks.number("length", value, least=0.0, most=5.0)) is float
    assert checks.array("length", value).tolist() == 3.0


@pytest.mark.parametrize("values", [["1.0"], [True], np.array([1.0 + 2.0j]), [None, 1.0]])
def test_what_is_no_array_of_numbers_is_refused(values: Any) -> None:
    with pytest.raises(InputError, match=r"^lengths = .*: must be "):
        checks.array("lengths", values)


def test_infinity_is_a_value_where_it_is_allowed() -> None:
    assert checks.positive("limit", math.inf, infinite=True) == math.inf
    with pytest.raises(InputError, match=r"must be a number above 0$"):
        checks.positive("limit", math.nan, infinite=True)


@pytest.mark.parametrize(
    ("check", "message"),
    [
        (
            lambda: checks.array("x", [[1.0], [1.0, 2.0]], "m"),
            r"^x = \[\[1.0\], \[1.0, 2.0\]\]: must be finite numbers",
        ),
        (lambda: checks.array("x", np.ones((2, 3)), ndim=1), r"^x = array of shape \(2, 3\): .*, in a row$"),
        (lambda: checks.array("x", [1.0, 2.0], ndim=1, size=3), "must be finite numbers, 3 in a row$"),
        (
            lambda: checks.array("x", [1.0, -2.0], above=0.0, most=9.0),
            "^x = -2: must be a number above 0 and at most 9$",
        ),
        (lambda: checks.number("x", 10**400), r"^x = 10+\.\.\.0+: must be a finite number$"),
        (lambda: checks.distinct("x", [10**400]), r"^x = \[10+\.\.\.0+\]: must be finite numbers, 1 or more$"),
        (lambda: checks.array("x", [1.0, math.nan]), "^x = nan: must be a finite number$"),
        (lambda: checks.distinct("x", [[1.0, 2.0]]), "must be a number, or numbers in a row$"),
        (lambda: checks.distinct("x", "fast", "1/min"), r"^x = 'fast': must be finite numbers \[1/min\], 1 or more$"),
        (lambda: checks.whole("x", 1.0, 0, 5), r"^x = 1.0: must be a whole number from 0 to 5$"),
        (lambda: checks.file_path("x", 5), "^x = 5: must be a path, as text, bytes or a Path$"),
        (lambda: read_case(5), "^case = 5: must be the name of a shipped case, or a path, as text, bytes or a Path$"),  # type: ignore[arg-type]
        (lambda: checks.one_of("x", ["a"], ("a", "b")), r"^x = \['a'\]: must be one of a, b$"),
    ],
)
def test_messages_name_argument_value_and_what_is_allowed(check: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check()


def test_small_arrays_are_shown_by_their_numbers_and_large_ones_by_their_shape() -> None:
    assert checks.shown(np.array(90.0)) == "90"
    assert checks.shown(np.array([0.5, 2.0])) == "[0.5, 2.0]"
    assert checks.shown(np.zeros(7)) == "array of shape (7,)"
    assert checks.shown(np.zeros((2, 2))) == "array of shape (2, 2)"


CASE = read_case("nasa-12x36")
PAIR = gear_pair(CASE)


@pytest.mark.parametrize("wrong", [5, 2.5, "nonsense", None, [], {}, b"x", np.zeros((2, 2))])
@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda wrong: gear_pair(wrong), "case"),
        (lambda wrong: case_toml(wrong), "case"),
        (lambda wrong: write_case(wrong, "mine.toml"), "case"),
        (lambda wrong: write_rexs(wrong, "mine.rexs"), "case"),
        (lambda wrong: support_system(wrong), "case"),
        (lambda wrong: study.rounded_case(wrong), "case"),
        (lambda wrong: pair_geometry(wrong), "pair"),
        (lambda wrong: ease_off(wrong), "pair"),
        (lambda wrong: tooth_angle(wrong, "gear"), "pair"),
        (lambda wrong: pair_geometry(PAIR, wrong), "nodes"),
        (lambda wrong: contact.solve(wrong), "problem"),
        (lambda wrong: contact.lcp(wrong), "problem"),
        (lambda wrong: contact.problem_checksum(wrong), "problem"),
        (lambda wrong: percentiles(wrong, [50.0], ["peak_to_peak"]), "dataset"),
        (lambda wrong: easeoff.write_result(wrong, "mine.nc"), "tree"),
        (lambda wrong: designed_blanks(wrong, (12, 36), CASE.pair), "table"),
        (lambda wrong: geometry.GearPair(PAIR.pinion, wrong, PAIR.assembly), "gear"),
        (lambda wrong: geometry.Assembly(12, 36, wrong, 1.5, 0.0), "pinion_hand"),
        (lambda wrong: geometry.MachineSettings(60.0, 1.0, 1.0, ratio_of_roll=1.0, motions=(wrong,)), "motions"),
        (lambda wrong: geometry.usual_settings(wrong), "surface"),
        (lambda wrong: geometry.conjugate_pinion(PAIR.gear.loaded, wrong, 10.0), "assembly"),
        (lambda wrong: geometry.departure(PAIR.gear, PAIR.gear.loaded, wrong), "nodes"),
        (lambda wrong: geometry.tooth_patches(PAIR, "gear", wrong), "nodes"),
        (lambda wrong: geometry.fit_pinion(PAIR, wrong), "target"),
        (lambda wrong: geometry.principal_curvatures(wrong), "flank"),
        (lambda wrong: geometry.corrective_settings(PAIR.gear, wrong), "deviation"),
        (lambda wrong: geometry.deviation_from_formula(PAIR.gear.section, wrong), "formula"),
        (lambda wrong: formats.cmm_points(wrong), "member"),
        (lambda wrong: formats.write_cmm_points(wrong, "mine.csv"), "dataset"),
        (lambda wrong: formats.measured_grid(wrong, np.ones((3, 5))), "points"),
        (lambda wrong: formats.write_mesh({"flank": wrong}, "mine.stl"), "patch"),
    ],
)
def test_wrong_kinds_are_refused_by_name(call: Callable[[object], object], name: str, wrong: object) -> None:
    with pytest.raises(InputError, match=rf"\b{name}\b.*must be"):
        call(wrong)


@pytest.mark.parametrize("wrong", [5, 2.5, "nonsense", [], b"x", np.zeros((2, 2))])
@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda wrong: easeoff.analyze(CASE, deviations=wrong), "deviations"),
        (lambda wrong: easeoff.analyze(CASE, modification=wrong), "modification"),
        (lambda wrong: easeoff.analyze(CASE, edge_contact=wrong), "edge_contact"),
        (lambda wrong: easeoff.analyze(CASE, stage=wrong), "stage"),
        (lambda wrong: easeoff.analyze(CASE, rounds=wrong), "rounds"),
        (lambda wrong: easeoff.sweep(CASE, wrong), "over"),
        (lambda wrong: easeoff.optimize(CASE, spread=wrong), "spread"),
        (lambda wrong: easeoff.optimize(CASE, resume=wrong), "resume"),
        (lambda wrong: geometry.Blade(75.0, 0.3, "outside", toprem=wrong), "toprem"),
        (lambda wrong: geometry.tooth_lattice(PAIR, "gear", wrong), "size"),
    ],
)
def test_wrong_kinds_of_what_may_be_left_out_are_refused_by_name(
    call: Callable[[object], object], name: str, wrong: object
) -> None:
    with pytest.raises(InputError, match=rf"\b{name}\b.*must be"):
        call(wrong)


@pytest.mark.parametrize("wrong", ["nonsense", object(), [], {}, b"x", np.zeros((2, 2)), 1j, math.nan, math.inf, True])
@pytest.mark.parametrize(
    ("record", "name"),
    [
        (geometry.Blade(75.0, 0.3, "outside"), "point_radius"),
        (geometry.MachineSettings(60.0, 1.0, 1.0), "cutter_tilt"),
        (geometry.Misalignment(), "offset"),
        (PAIR.assembly, "gear_teeth"),
        (PAIR.gear.section, "face_width"),
        (PAIR.gear, "mean_thickness"),
        (geometry.GlobalErrors(), "twist"),
        (geometry.EaseOffTarget(), "bias"),
        (formats.EdgeMargins(), "toe"),
    ],
)
def test_records_refuse_what_is_no_number(record: Any, name: str, wrong: object) -> None:
    with pytest.raises(InputError, match=rf"\b{name} = .*: must be a"):
        replace(record, **{name: wrong})


def test_numbers_of_numpy_become_numbers_in_records() -> None:
    moved = geometry.Misalignment(offset=np.array(0.1), shaft_angle=0)  # type: ignore[arg-type]
    assert type(moved.offset) is type(moved.shaft_angle) is float
    assert hash(moved) == hash(geometry.Misalignment(0.1))


@pytest.mark.parametrize("wrong", [5, None, [], {}, b"x"])
def test_texts_are_texts(wrong: Any) -> None:
    with pytest.raises(InputError, match=r"^comment = .*: must be text$"):
        case_toml(CASE, wrong)
    with pytest.raises(InputError, match=r"^text = .*: must be text$"):
        parse_case(wrong)


def test_tables_built_in_python_are_checked_as_those_of_a_file() -> None:
    with pytest.raises(InputError, match=r"LoadCase has 2 mistakes:\n  name = 5: must be text.*\n  torque: is missing"):
        LoadCase(name=5)
    with pytest.raises(InputError, match="values must be given by name"):
        LoadCase("a", 5.0)  # type: ignore[call-arg]
    case = read_case("nasa-12x36")
    assert pickle.loads(pickle.dumps(case)) == case
