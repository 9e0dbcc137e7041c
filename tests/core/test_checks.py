"""Checks of arguments: every message names the argument, its value and what is allowed."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
import xarray as xr

import easeoff
from easeoff import InputError, contact, friction, geometry, read_case, study, verification
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
from easeoff.core import checks, errors
from easeoff.friction import ehl
from easeoff.geometry import ease_off, formats, pair_geometry, tooth_angle
from easeoff.study.analysis.setting_derivatives import chosen_settings
from easeoff.study.case_in_mesh import CaseInMesh
from easeoff.study.plot.panel_grid import chosen_parts, chosen_torques, panels, require_result
from easeoff.study.sweep import percentiles


@dataclass(frozen=True)
class Line:
    position: np.ndarray[Any, Any]


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
        (
            lambda: checks.distinct("x", [500, 500], "1/min"),
            r"^x = \[500, 500\]: must .* differ; 500 comes twice$",
        ),
        (lambda: checks.number("x", 2.5, least=-2.0, most=2.0), "^x = 2.5: must be a number from -2 to 2$"),
        (lambda: checks.whole("x", 1.0, 0, 5), r"^x = 1.0: must be a whole number from 0 to 5$"),
        (lambda: checks.two_whole("x", 9, 5), "^x = 9: must be two whole numbers of 5 or more$"),
        (lambda: checks.instance("x", 500, dict), "^x = 500: must be a dict$"),
        (lambda: checks.words("x", "alone"), "^x = 'alone': must be a list of texts$"),
        (lambda: checks.file_path("x", 5), "^x = 5: must be a path, as text, bytes or a Path$"),
        (lambda: read_case(5), "^case = 5: must be the name of a shipped case, or a path, as text, bytes or a Path$"),  # type: ignore[arg-type]
        (lambda: checks.two("x", (1, 2, 3), "numbers"), r"^x = \(1, 2, 3\): must be two numbers$"),
        (
            lambda: checks.instances("x", [1, "a"], int),
            r"^x = \[1, 'a'\]: must be all of the type int, in a list or tuple$",
        ),
        (lambda: checks.instances("x", (1,), int, 2), r"^x = \(1,\): must be 2 of the type int, in a list or tuple$"),
        (lambda: checks.one_of("x", ["a"], ("a", "b")), r"^x = \['a'\]: must be one of a, b$"),
    ],
)
def test_messages_name_argument_value_and_what_is_allowed(check: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check()


@pytest.mark.parametrize(
    ("made", "text"),
    [
        (checks.shown(0.1 + 0.2), "0.3"),
        (errors.shortened("0123456789" * 3, 15), "01234 ... 56789"),
        (errors.printable_lines("title\r\nPAINT \x1b[2J"), "title?\nPAINT ?[2J"),
        (errors.suggestion("radial_distanse", ["radial_distance"]), "; did you mean 'radial_distance'?"),
        (errors.suggestion("x", ["radial_distance"]), ""),
        (errors.memory_in_words(2.16e9), "2.2 GB"),
        (errors.memory_in_words(10.0), "1 MB"),
        (errors.time_in_words(42.4), "about 42 s"),
        (errors.time_in_words(1e5), "about 28 h"),
        (errors.time_in_words(4e9), "about 130 years"),
        (errors.time_in_words(1e300), "over a million years"),
    ],
)
def test_messages_put_values_sizes_and_times_in_short_words(made: str, text: str) -> None:
    assert made == text


def test_a_record_keeps_a_read_only_copy_of_a_given_array() -> None:
    given = np.zeros(2)
    kept = checks.frozen_arrays(Line)(given).position
    assert (kept.flags.writeable, given.flags.writeable) == (False, True)


def test_small_arrays_are_shown_by_their_numbers_and_large_ones_by_their_shape() -> None:
    assert checks.shown(np.array(90.0)) == "90"
    assert checks.shown(np.array([0.5, 2.0])) == "[0.5, 2.0]"
    assert checks.shown(np.zeros(7)) == "array of shape (7,)"
    assert checks.shown(np.zeros((2, 2))) == "array of shape (2, 2)"


CASE = read_case("nasa-12x36")
PAIR = gear_pair(CASE)
OTHERS = ("responses", "materials", "mesh", "position", "torque", "half_width", "rotation")
NOT_LOOKED_AT: dict[str, Any] = dict.fromkeys(OTHERS)
TOOTH = contact.ToothDimensions(36.0, 95.25, 7.0, 9.5, 5.5, 7.5, 2.5, 2.5)
SPRINGS = contact.ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
LUBRICATED = ehl.LubricatedContact(1e9, 0.02, 5.0, ehl.Oil(0.02, 1.1e-8), slide_to_roll=0.25)


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
        (lambda wrong: contact.Shell(wrong, contact.STEEL), "dimensions"),
        (lambda wrong: contact.Shell(TOOTH, wrong), "material"),
        (lambda wrong: contact.Shell(TOOTH, contact.STEEL, modes=wrong), "modes"),
        (lambda wrong: contact.Shell(TOOTH, contact.STEEL, family=wrong), "family"),
        (lambda wrong: contact.HalfSpaceCompliance(wrong, (1.0, 1.0), (contact.STEEL, contact.STEEL)), "shape"),
        (lambda wrong: contact.HalfSpaceCompliance((2, 2), wrong, (contact.STEEL, contact.STEEL)), "sides"),
        (lambda wrong: contact.HalfSpaceCompliance((2, 2), (1.0, 1.0), wrong), "materials"),
        (lambda wrong: contact.ElasticModel(pinion=wrong), "pinion"),
        (lambda wrong: contact.Supports(wrong, wrong), "pinion"),
        (lambda wrong: contact.OperatorCompliance(wrong), "operator"),
        (lambda wrong: contact.with_shared_modes(wrong, np.ones((4, 1)), np.ones((2, 1, 1))), "basis"),
        (lambda wrong: contact.identified_support(wrong, [np.ones(6)], [np.ones(4)]), "assembly"),
        (lambda wrong: contact.line_contact_path(wrong, wrong, 0.0, 1.0), "bending"),
        (lambda wrong: contact.line_contact_path(SPRINGS, wrong, 0.0, 1.0), "line_contact"),
        (lambda wrong: contact.lines_in_mesh(wrong, 0.5), "splines"),
        (lambda wrong: contact.unloaded_contact(wrong, wrong, wrong), "geometry"),
        (lambda wrong: contact.root_stress(wrong, wrong, wrong, wrong), "splines"),
        (lambda wrong: contact.MeshCycle.of(wrong), "geometry"),
        (lambda wrong: friction.flash_temperature(1.0, 1e-4, (1.0, 2.0), wrong), "materials"),
        (lambda wrong: friction.blok_flash_temperature(1.0, 1e-4, (1.0, 2.0), wrong), "materials"),
        (lambda wrong: friction.matched_band(1.0, 1e-4, wrong), "velocities"),
        (lambda wrong: friction.formula_flags(wrong), "conditions"),
        (lambda wrong: friction.rolling_traction(wrong), "conditions"),
        (lambda wrong: friction.write_lubricant(wrong, "mine.toml"), "oil"),
        (lambda wrong: ehl.film_dataset(wrong), "film"),
        (lambda wrong: ehl.passage_dataset(wrong), "passage"),
        (lambda wrong: ehl.heated_inlet(wrong), "contact"),
        (lambda wrong: ehl.traction(wrong, *np.ones((3, 2))), "contact"),
        (lambda wrong: percentiles(wrong, [50.0], ["peak_to_peak"]), "dataset"),
        (lambda wrong: easeoff.write_result(wrong, "mine.nc"), "tree"),
        (lambda wrong: easeoff.plot.wear(wrong), "history"),
        (lambda wrong: easeoff.plot.vh_check(wrong), "check"),
        (lambda wrong: study.SweepSummary(wrong), "dataset"),
        (lambda wrong: study.compare.write_comparison(wrong, "mine"), "dataset"),
        (lambda wrong: study.contact_derivatives(wrong), "state"),
        (lambda wrong: study.derivative_settings(PAIR, wrong), "flank"),
        (lambda wrong: study.design_case(wrong), "design"),
        (lambda wrong: study.equivalent_torque(wrong, np.ones(1), 3.0), "torques"),
        (lambda wrong: study.key_numbers(wrong), "result"),
        (lambda wrong: study.rounding_effect(CASE, wrong), "rounded"),
        (lambda wrong: study.wear(CASE, wrong, torque=100.0), "law"),
        (lambda wrong: study.write_report(wrong, "mine.html"), "results"),
        (lambda wrong: verification.contact_of_flanks(wrong, **NOT_LOOKED_AT), "flanks"),
        (lambda wrong: verification.correction_loop(CASE, "gear", wrong), "errors"),
        (lambda wrong: verification.envelope_condition(wrong), "flank"),
        (lambda wrong: verification.flank_response(PAIR, "gear", contact.STEEL, wrong), "size"),
        (lambda wrong: verification.smallest_gap(wrong, np.zeros(1)), "geometry"),
        (lambda wrong: next(verification.problems(wrong, 1)), "name"),
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


@pytest.mark.parametrize("wrong", [object(), 2.5j, b"x", np.array("a"), [[1.0, [2.0]], ["a"]]])
@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda wrong: CaseInMesh.of(CASE, deviations=wrong), "deviations"),
        (lambda wrong: CaseInMesh.of(CASE, modification=wrong), "modification"),
        (lambda wrong: chosen_parts(("pinion", "gear"), wrong, "member"), "member"),
        (lambda wrong: chosen_torques(np.ones(2), wrong), "torque"),
        (lambda wrong: require_result(wrong), "tree"),
        (lambda wrong: panels(xr.DataTree(), "", 1.0, "", (1, 1), wrong), "axes"),
        (lambda wrong: next(study.library.generate(wrong)), "entries|entry"),
        (lambda wrong: study.analyze_load_cases(CASE, wrong), "load_cases"),
        (lambda wrong: study.compare.compare(wrong, "mine"), "paths"),
        (lambda wrong: study.correct_case(CASE, {"gear": wrong}), "gear"),
        (lambda wrong: study.correct_case(CASE, {}, thickness=wrong), "thickness"),
        (lambda wrong: chosen_settings(PAIR, "drive", wrong), "settings"),
        (lambda wrong: study.rounded_case(CASE, wrong), "resolution"),
        (lambda wrong: study.rounded_case(CASE, pinion_limits={"radial_distance": wrong}), "radial_distance"),
        (lambda wrong: study.vh_check(CASE, grid=wrong), "grid"),
        (lambda wrong: study.wear(CASE, study.WearLaw(0.0, 0.0, 1.0), torque={100.0: wrong}), "torque"),
        (lambda wrong: verification.verify(CASE, on_row=wrong), "on_row"),
    ],
)
def test_wrong_kinds_of_what_studies_may_leave_out_are_refused_by_name(
    call: Callable[[object], object], name: str, wrong: object
) -> None:
    with pytest.raises(InputError, match=rf"\b{name}\b"):
        call(wrong)


@pytest.mark.parametrize("wrong", ["nonsense", None, object(), [], {}, b"x", np.zeros((2, 2)), 1j, ("a", 1)])
@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda wrong: contact.certify(SPRINGS, np.zeros(2), wrong), "rotation"),
        (lambda wrong: contact.Status(wrong), "Status"),
        (lambda wrong: ehl.State(wrong), "State"),
        (lambda wrong: contact.ToothDimensions(36.0, 95.25, 7.0, 9.5, 5.5, 7.5, 2.5, 2.5, fanning=wrong), "fanning"),
        (lambda wrong: ehl.rough_passage(LUBRICATED, steps=40, nodes=wrong), "nodes"),
    ],
)
def test_what_is_no_number_is_refused_by_name(call: Callable[[object], object], name: str, wrong: object) -> None:
    with pytest.raises(InputError, match=rf"^{name} = .*: must be"):
        call(wrong)


def test_flags_are_true_or_false_and_never_an_array() -> None:
    wrong: Any = np.zeros(2)
    for call in (
        lambda: contact.lifted_qp(SPRINGS, compress=wrong),
        lambda: contact.solve(SPRINGS, polish=wrong),
        lambda: ehl.measured_profile(np.arange(16.0), 1.0, detrend=wrong),
    ):
        with pytest.raises(InputError, match="must be True or False"):
            call()


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
