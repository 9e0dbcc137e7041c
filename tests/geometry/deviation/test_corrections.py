"""Corrections that can be executed: shared set-ups, settings to move, rounding, the corrected case, closed loops."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from correction_loops import CORRECTION_LOOPS, FORMATE, GENERATED, TILTED, loop_case
from generated_part import generated
from matplotlib.backends.backend_agg import FigureCanvasAgg
from report_content import content
from runs import output_of, refusal_of, small
from shared import Shared, replace_everywhere

import easeoff
from easeoff import GeometryError, InputError, plot
from easeoff.cases import case_toml, gear_pair, read_case, write_case
from easeoff.cases.schema.case_schema import Case
from easeoff.core.arrays import RealArray as Array
from easeoff.geometry import (
    GlobalErrors,
    corrective_settings,
    departure,
    deviation_from_formula,
    shares_set_up,
    tooth_angle,
    usual_settings,
)
from easeoff.geometry.cutting.generating_surface import GeneratingSurface
from easeoff.geometry.cutting.named_settings import (
    MACHINE_STEPS,
    MODIFIED_ROLL_ORDERS,
    get_setting,
    movable_settings,
    nearest_multiple,
    scale_of,
    setting_step,
    step_count,
    with_settings,
)
from easeoff.geometry.deviation.corrective_settings import GIVEN_UP, LEAST_GIVEN_UP, SetUpFit
from easeoff.geometry.deviation.deviated_flank import RecutFlank, deviated_member
from easeoff.geometry.deviation.deviation import Deviation
from easeoff.geometry.formats import cmm_points, flank_deviation, measured_matrix
from easeoff.geometry.pair.gear_pair import Member
from easeoff.geometry.pair.tooth_body import middle_angle
from easeoff.geometry.tooth.tooth_flanks import MemberName, Side, side
from easeoff.study import correct_case, measured_file, summary_sheet
from easeoff.study.case_correction import CaseCorrection
from easeoff.study.report.report_file import report_page
from easeoff.study.summary.load_case_summary import load_case_notes
from easeoff.study.summary.result_summary import result_notes
from easeoff.study.summary.settings_report import correction_report, root_warnings
from easeoff.verification import correction_loop
from easeoff.verification.correction_loop import (
    SIDES,
    greatest,
    grids,
    measured,
    measured_case,
    views,
    with_errors,
)


@pytest.fixture(scope="module", autouse=True)
def shared() -> Iterator[None]:
    """The points at which a member is measured are computed once."""
    with pytest.MonkeyPatch.context() as patch:
        replace_everywhere(patch, cmm_points, Shared().once(cmm_points))
        yield


@pytest.mark.parametrize("loop", sorted(CORRECTION_LOOPS, key=lambda loop: "fixed" not in str(loop)))
@pytest.mark.quick(1)
def test_the_corrected_case_leaves_less_than_three_percent(loop: str, tmp_path: Path) -> None:
    """Measured by another method than the fit uses: along the normals, by Newton."""
    name, member, errors = CORRECTION_LOOPS[loop]
    case = loop_case(name)
    done = correction_loop(case, member, errors)
    assert greatest(done.before) > 15.0
    assert done.left < 0.03
    shared = "fixed" not in loop
    assert len(done.correction.corrections[member]) == (1 if shared else 2)
    table = getattr(done.correction.case, member)
    assert (table.concave.machine == table.convex.machine) == shared
    for which in SIDES:
        assert getattr(table, which).cutter == getattr(getattr(case, member), which).cutter
    for correction in done.correction.corrections[member]:
        assert correction.rms < 0.02 * correction.rms_before
    write_case(done.correction.case, tmp_path / "corrected.toml")
    assert read_case(tmp_path / "corrected.toml").model_dump() == done.correction.case.model_dump()


@pytest.mark.parametrize("loop", CORRECTION_LOOPS)
@pytest.mark.quick(1)
def test_measuring_errors_stay_what_they_are(loop: str) -> None:
    """Noise of 0.5 um in every point; what is left of the flanks themselves is no more than that."""
    name, member, errors = CORRECTION_LOOPS[loop]
    done = correction_loop(loop_case(name), member, errors, noise=0.5)
    left = np.concatenate([value.ravel() for value in done.after.values()])
    assert np.sqrt(np.mean(left**2)) < 0.6
    for correction in done.correction.corrections[member]:
        assert 1e3 * correction.rms == pytest.approx(0.5, abs=0.12)  # the noise is what the prediction leaves


MACHINE_ERRORS = (*(name for name in MACHINE_STEPS if name != "cradle_angle"), "modified_roll_2c", "modified_roll_6d")
UNSEEN = [("fh-design-a", "gear"), ("fh-design-b", "gear"), ("nasa-12x36", "gear"), ("fm-11x41", "pinion")]


@pytest.mark.thorough
@pytest.mark.parametrize(("case", "member"), UNSEEN)
@pytest.mark.parametrize("seed", [1, 2])
def test_random_errors_of_all_machine_settings_are_corrected(case: str, member: Any, seed: int) -> None:
    checked, random = read_case(case), np.random.default_rng(seed)
    seen = views(checked, member)
    own: dict[Side, dict[str, float]] = {}
    for which in SIDES:
        surface = seen[which].loaded
        unused = [name for name in MODIFIED_ROLL_ORDERS if get_setting(surface, name) == 0.0]
        names = [name for name in movable_settings(surface) if name in MACHINE_ERRORS and name not in unused]
        own[which] = {n: 0.25 * scale_of(n) * float(random.normal()) for n in names}
    if shares_set_up(seen["concave"]):
        own["convex"] = own["concave"]
    done = correction_loop(checked, member, own)
    assert greatest(done.before) > 5.0
    assert done.left < 0.03


def turned_to_its_middle(seen: Member, real: GeneratingSurface) -> float:
    """Rotation with which a machine measures a flank [rad]."""
    return RecutFlank.of(seen, *seen.section.points(np.array([0.5]), np.array([0.5]))).turn(real)


@pytest.mark.parametrize(("case", "errors"), [("nasa-12x36", GENERATED), ("fh-design-a completing", TILTED)])
def test_the_departure_of_a_recut_flank_is_what_the_yardstick_measures(case: str, errors: dict[str, float]) -> None:
    """Undercut, the other case has its points further up: those of both flanks."""
    for seen in views(loop_case(case), "gear" if case == "nasa-12x36" else "pinion").values():
        real = with_errors(seen.loaded, errors)
        exact = measured(seen, real)
        grid = flank_deviation(measured_matrix(seen, exact), seen)
        found = RecutFlank.of(seen, grid.axial, grid.radial).distance(real, turned_to_its_middle(seen, real))
        np.testing.assert_allclose(1e3 * found, exact.T.ravel(), rtol=0, atol=1e-6)


def roots(function: Any, starts: Array) -> Array:
    """Solutions (n, m) of equations of one point after the other, by MINPACK."""
    from scipy.optimize import root

    found = [root(function, start, args=(number,), tol=1e-13) for number, start in enumerate(starts)]
    assert max(float(np.abs(one.fun).max()) for one in found) < 1e-8
    return np.array([one.x for one in found])


def point(surface: GeneratingSurface, parameters: Array) -> tuple[Array, Array]:
    """Position and normal (3) of one point of a surface."""
    position, normal, _ = surface.evaluate(np.reshape(parameters, (2, 1)))
    return position[:, 0], normal[:, 0]


def about_the_axis(vector: Array, angle: float) -> Array:
    matrix = [[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]]
    return np.asarray(np.array(matrix) @ vector)


def test_a_departure_lies_along_the_designed_normals_where_the_tangent_plane_errs_in_second_order() -> None:
    """Each normal of the designed flank is intersected with the recut flank by MINPACK, point by point."""
    seen = views(loop_case("fh-12x41-45 completing"), "pinion")["convex"]
    wrong, largest, of_plane = [], [], []
    for size in (1.0, 2.0, 4.0):
        real = with_errors(seen.loaded, {name: size * by for name, by in TILTED.items()})
        deviation = departure(seen, real, (5, 3))
        assert abs(float(deviation.value[2, 1])) < 1e-9  # the middle of the flank
        designed = RecutFlank.of(seen, deviation.axial, deviation.radial).flank
        starts, target = designed.parameters.T, RecutFlank.of(seen, deviation.axial, deviation.radial).target

        def beside(p: Array, number: int, real: Any = real, target: Array = target) -> Array:
            x, y, z = point(real, p)[0]
            return np.array([z, np.hypot(x, y)]) - target[:, number]

        near = roots(beside, starts)
        middle = 2 * 3 + 1
        around = [np.arctan2(*place[1::-1]) for place in (point(real, near[middle])[0], designed.position[:, middle])]
        back = float(around[1] - around[0])

        def off(p: Array, number: int, real: Any = real, back: float = back, flank: Any = designed) -> Array:
            gone = flank.position[:, number] + p[2] * flank.normal[:, number]
            return np.asarray(about_the_axis(point(real, p[:2])[0], back) - gone)

        met = roots(off, np.column_stack([near, np.zeros(len(near))]))
        exact = met[:, 2]
        wrong.append(float(np.abs(deviation.value.ravel() - exact).max()))
        largest.append(float(np.abs(exact).max()))
        tangent = []
        for number, p in enumerate(near):
            place, normal = (about_the_axis(vector, back) for vector in point(real, p))
            own, along = designed.position[:, number], designed.normal[:, number]
            tangent.append(float((place - own) @ normal / (along @ normal)))
        of_plane.append(float(np.abs(tangent - exact).max()))
        # The deviated flank, of which contact and loads are computed, goes through the same points of the recut one.
        surface = deviated_member(seen, deviation).loaded
        through = surface.evaluate(designed.parameters)[0].T
        real_points = [about_the_axis(point(real, p[:2])[0], back) for p in met]
        np.testing.assert_allclose(through, real_points, rtol=0, atol=1e-8)
    assert largest[-1] > 0.25
    assert max(wrong) < 1e-8
    orders = np.diff(np.log2(of_plane))
    np.testing.assert_allclose(orders, 2.0, atol=0.35)
    assert of_plane[-1] > 1e-3  # more than a micrometre


def scaled_errors(case: Case, member: MemberName, errors: dict[Side, dict[str, float]], size: float) -> Any:
    """Errors in proportion, with which the greatest deviation is about a size [um]."""
    factor = size / greatest(measured_case(case, case, member, errors))
    return {which: {name: factor * by for name, by in own.items()} for which, own in errors.items()}


@pytest.mark.parametrize(
    ("loop", "size", "limit"),
    [
        ("hobbed, completing, generated", 300.0, 0.002),
        *[
            pytest.param(loop, size, 0.012, marks=pytest.mark.thorough)
            for loop in CORRECTION_LOOPS
            for size in (100.0, 300.0)
            if (loop, size)
            not in (
                ("hobbed, completing, generated", 300.0),
                ("milled, fixed setting", 300.0),
                ("milled, spread blade, Formate", 100.0),
            )
        ],
    ],
)
def test_large_deviations_are_corrected_in_one_pass(loop: str, size: float, limit: float) -> None:
    """Of the first one the tangent plane left 1 %."""
    name, member, errors = CORRECTION_LOOPS[loop]
    case = loop_case(name)
    done = correction_loop(case, member, scaled_errors(case, member, errors, size))
    assert greatest(done.before) == pytest.approx(size, rel=0.1)
    assert done.left < limit
    assert not any(np.any(flank.missing) for found in done.correction.corrections[member] for flank in found.flanks)


def test_a_completing_pinion_with_an_undercut_flank_is_corrected() -> None:
    done = correction_loop(loop_case("fh-design-a completing"), "pinion", dict.fromkeys(SIDES, TILTED), free=[*TILTED])
    assert greatest(done.before) > 30.0
    assert done.left < 0.01


# Errors [mm, rad] with which a completing pinion is undercut at the root of its toe.
UNDERCUT = {"work_offset": 0.2, "machine_center_to_crossing_point": 0.2, "radial_distance": 0.1}
UNDERCUT_BOTH = {"work_offset": 0.5, "machine_center_to_crossing_point": 0.3}


def near_the_root(seen: Member, real: GeneratingSurface, lengthwise: Array, profile: Array) -> tuple[Deviation, int]:
    """Deviation at fractions of a flank, the first row carried on where it is undercut, and how many points these are.

    What a machine finds there is another surface; a measured row looks smooth all the same.
    """
    axial, radial = seen.section.points(*np.meshgrid(lengthwise, profile, indexing="ij"))
    found = RecutFlank.of(seen, axial, radial).distance(real, turned_to_its_middle(seen, real)).reshape(axial.shape)
    missing = int(np.sum(np.isnan(found)))
    assert np.all(np.isnan(found[:missing, 0])) or not missing
    along = np.arange(missing, min(missing + 5, len(found)))
    if missing:
        found[:missing, 0] = np.polyval(np.polyfit(along, found[along, 0], min(3, along.size - 1)), np.arange(missing))
    return Deviation(seen.section, axial, radial, found), missing


@pytest.mark.quick(1)
@pytest.mark.parametrize(("errors", "lost"), [(UNDERCUT, [0, 1]), (UNDERCUT_BOTH, [1, 1])])
def test_points_that_the_flank_with_errors_does_not_have_are_left_out_and_told(
    errors: dict[str, float], lost: list[int]
) -> None:
    case = loop_case("fh-12x41-45 completing")
    seen = views(case, "pinion")
    real = {which: with_errors(seen[which].loaded, errors) for which in SIDES}
    places = np.linspace(0.1, 0.9, 9), np.linspace(0.02, 0.9, 5)
    rows = {which: near_the_root(seen[which], real[which], *places) for which in SIDES}
    assert [rows[which][1] for which in SIDES] == lost
    free = list(errors)
    found = corrective_settings(seen["concave"], rows["concave"][0], opposite=rows["convex"][0], free=free)
    for flank, count in zip(found.flanks, lost, strict=True):
        assert np.all(flank.missing[:count, 0])
        assert flank.missing.sum() == count
        assert np.all(np.isfinite(flank.before))
        np.testing.assert_array_equal(np.isnan(flank.linear), flank.missing)
    assert found.rms < 0.005 * found.rms_before
    executed = {which: with_errors(found.surfaces[which], errors) for which in SIDES}
    before, after = ({which: measured(seen[which], cut[which]) for which in SIDES} for cut in (real, executed))
    assert greatest(before) > 50.0
    assert greatest(after) < 0.006 * greatest(before)
    report = " ".join(correction_report(CaseCorrection(case, {"pinion": (found,)})).split())
    assert "Note: convex flank: 1 of 45 points, the first in row 1, column 1, are left out" in report
    assert ("concave flank: 1 of 45 points" in report) == (lost[0] == 1)
    assert "nan" not in report
    assert not any("nan" in text.get_text() for axes in plot.topography(found).axes for text in axes.texts)


def test_a_quarter_of_the_points_may_be_missing_and_no_more() -> None:
    seen = views(loop_case("fh-12x41-45 completing"), "pinion")["concave"]
    real, rows = with_errors(seen.loaded, {"work_offset": 0.4}), np.array([0.0, 0.05])
    quarter, missing = near_the_root(seen, real, np.linspace(0.1, 0.2, 4), rows)
    assert (missing, quarter.value.size) == (2, 8)
    found = corrective_settings(seen, quarter, shared=False, free=["work_offset"])
    assert found.errors["work_offset"] == pytest.approx(0.4, abs=1e-6)  # of the others alone
    third, missing = near_the_root(seen, real, np.array([0.1, 0.11, 0.2]), rows)
    assert (missing, third.value.size) == (2, 6)
    with pytest.raises(
        GeometryError, match=r"concave flank: settings near .* \d of 6 measured points; .* at most 25 %"
    ):
        corrective_settings(seen, third, shared=False, free=["work_offset"])


def test_slopes_are_the_derivatives_of_departures() -> None:
    """To first order a place of the blade moves along the normal as the flank does; against the flanks cut anew."""
    seen = views(loop_case("fh-12x41-45 completing"), "pinion")
    recut = []
    for which in SIDES:
        grid = departure(seen[which], seen[which].loaded)
        recut.append(RecutFlank.of(seen[which], grid.axial, grid.radial))
    for together in (False, True):
        fit = SetUpFit(tuple(recut), usual_settings(seen["concave"].loaded), together)
        for slope, way in zip(fit.slopes.T, 1e-3 * np.eye(len(fit.unknowns)), strict=True):
            differences = (fit.departure(way) - fit.departure(-way)) / 2e-3
            np.testing.assert_allclose(slope, differences, rtol=0, atol=1e-5 * max(1e-2, np.abs(slope).max()))


@pytest.mark.parametrize(
    ("case", "largest"),
    [("fm-11x41", 0.0), ("fh-12x41-45", 1e-6), ("fm-11x41", 1e-3)],  # [um]
)
def test_a_deviation_below_the_resolution_is_nothing_to_correct(case: str, largest: float) -> None:
    designed = read_case(case)
    gear = views(designed, "gear")["convex"]
    deviation = deviation_from_formula(gear.section, GlobalErrors(spiral_angle=largest, twist=largest), (9, 5))
    found = correct_case(designed, {"gear": deviation}, free=["machine_root_angle", "radial_distance"])
    (correction,) = found.corrections["gear"]
    assert correction.nothing
    assert set(correction.changes.values()) == {0.0}
    assert correction.rms == correction.rms_before
    assert found.case == designed
    report = correction_report(found)
    assert "nothing to correct" in report
    assert report.count("Note:") == 1


def test_a_micrometre_is_felt() -> None:
    gear = views(read_case("fh-12x41-45"), "gear")["convex"]
    felt = deviation_from_formula(gear.section, GlobalErrors(spiral_angle=1.0), (9, 5))
    assert not corrective_settings(gear, felt, free=["machine_root_angle"]).nothing


def test_a_measured_thickness_is_restored() -> None:
    """Spread blade: the slot's width follows from the settings, so both flanks in one position tell its error."""
    case = read_case("fm-11x41")
    gear, errors = views(case, "gear"), {"machine_root_angle": 8e-4, "machine_center_to_crossing_point": 0.12}
    designed = gear["convex"]

    def angle(first: Any, second: Any) -> float:
        return middle_angle(designed.section, first, second)[1]

    def thicker(first: Any, second: Any) -> float:
        """Normal thickness above the designed one [um]."""
        from easeoff.geometry.pair.gear_pair import thickness_per_angle

        by = angle(first, second) - angle(gear["convex"].loaded, gear["concave"].loaded)
        return 1e3 * by * thickness_per_angle(designed)

    wrong = [with_errors(gear[which].loaded, errors) for which in ("convex", "concave")]
    excess = thicker(*wrong)
    assert abs(excess) > 30.0
    sources: Any = {"gear": grids(case, "gear", measured_case(case, case, "gear", dict.fromkeys(SIDES, errors)))}
    found = correct_case(case, sources, thickness={"gear": excess}, free=usual_settings(designed.loaded))
    own = views(found.case, "gear")
    left = thicker(*(with_errors(own[which].loaded, errors) for which in ("convex", "concave")))
    assert found.corrections["gear"][0].rms < 0.03 * found.corrections["gear"][0].rms_before
    assert abs(left) < 0.03 * abs(excess)
    assert tooth_angle(gear_pair(case), "gear") > 0.0


def test_blades_stay_unless_they_are_named_and_each_flank_has_its_own() -> None:
    case = read_case("fh-12x41-45")
    errors: dict[Side, dict[str, float]] = {
        "concave": {"pressure_angle": 2e-3, "radial_distance": 0.05},
        "convex": {"pressure_angle": -1e-3, "radial_distance": 0.05},
    }
    before = measured_case(case, case, "gear", errors)
    sources: Any = {"gear": grids(case, "gear", before)}
    kept = correct_case(case, sources)
    assert kept.corrections["gear"][0].rms > 0.1 * kept.corrections["gear"][0].rms_before
    free = ["pressure_angle", "radial_distance", "machine_root_angle", "cradle_angle"]
    corrected = correct_case(case, sources, free=free)
    (found,) = corrected.corrections["gear"]
    assert found.errors["pressure_angle.concave"] == pytest.approx(2e-3, rel=0.03)
    assert found.errors["pressure_angle.convex"] == pytest.approx(-1e-3, rel=0.03)
    assert found.errors["radial_distance"] == pytest.approx(0.05, rel=0.05)
    after = measured_case(case, corrected.case, "gear", errors)
    assert greatest(after) < 0.03 * greatest(before)


@pytest.mark.thorough
def test_the_closed_loops_of_the_page_are_those_of_the_program() -> None:
    """If not: run docs/make corrections."""
    script = importlib.import_module("make_corrections")
    table = generated(script.PAGE.read_text(encoding="utf-8"), script.PART).splitlines()[2:]
    assert [line.split(" | ")[0] for line in table] == [f"| {name}" for name in CORRECTION_LOOPS]
    for line, (case, member, errors) in zip(table, CORRECTION_LOOPS.values(), strict=True):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        loop = correction_loop(loop_case(case), member, errors)
        assert float(cells[2]) == pytest.approx(greatest(loop.before), abs=0.06)
        assert float(cells[3]) == pytest.approx(greatest(loop.after), abs=0.03)
        assert float(cells[4].split()[0]) <= 1.2  # as README.md says


@pytest.mark.parametrize(
    ("name", "value", "text", "rounded"),
    [
        ("radial_distance", 97.0015914, "97.002", 97.002),
        ("machine_root_angle", np.radians(67.08961), "67.090", np.radians(67.09)),
        ("ratio_of_roll", 3.84285449, "3.842854", 3.842854),
        ("modified_roll_2c", -0.012347, "-0.01235", -0.01235),
        ("blade_curvature", 1.0 / 1234.4, "1234", 1.0 / 1234.0),
        ("blade_curvature", 0.0, "straight", 0.0),
        ("cutter_tilt_motion_1", np.radians(0.12345), "0.123", np.radians(0.123)),
    ],
)
def test_a_setting_is_written_as_it_is_set(name: str, value: float, text: str, rounded: float) -> None:
    resolution = setting_step(name)
    assert resolution.text(value) == text
    assert resolution.rounded(value) == pytest.approx(rounded, rel=1e-12)
    assert resolution.rounded(resolution.rounded(value)) == resolution.rounded(value)


def test_multiples_of_a_step_stay_between_their_bounds() -> None:
    assert nearest_multiple(70.08634, 0.001) == 70.086
    assert nearest_multiple(70.08634, 0.001, high=70.0859) == 70.085
    assert (step_count(0.019, 0.01, high=0.019), step_count(0.019, 0.01, 0.015, 0.019)) == (1, None)
    assert setting_step("sliding_base_motion_1").unit == "mm/rad^1"


def test_settings_that_do_the_same_are_told_and_the_smallest_changes_taken() -> None:
    gear = views(read_case("fm-11x41"), "gear")["convex"]
    measured_flank = departure(gear, with_errors(gear.loaded, {"work_offset": 0.2, "machine_root_angle": 1e-3}))
    free = ["radial_distance", "cradle_angle", "work_offset", "machine_root_angle", "machine_center_to_crossing_point"]
    free.append("sliding_base")
    found = corrective_settings(gear, measured_flank, free=free)
    assert len(found.loose) == 2  # a cone placed by six settings has four that change the flank
    assert {"work_offset", "radial_distance"} <= {name for one in found.loose for name in one.settings}
    assert all(one.effect < 1e-6 for one in found.loose)
    assert found.rms < 0.02 * found.rms_before
    assert np.linalg.norm([found.changes[n] / scale_of(n) for n in free]) < 0.25
    only = corrective_settings(gear, measured_flank, free=["cradle_angle", "sliding_base"])
    assert only.rms > 3.0 * found.rms
    assert only.loose == ()


@cache
def fitted(case: str) -> tuple[SetUpFit, Array]:
    """Fit of a pinion with errors, and its target."""
    seen = views(read_case(case), "pinion")["concave"]
    real = with_errors(seen.loaded, {"radial_distance": 0.02, "machine_root_angle": 3e-4, "cutter_tilt": 2e-4})
    deviation = departure(seen, real)
    fit = SetUpFit((RecutFlank.of(seen, deviation.axial, deviation.radial),), usual_settings(seen.loaded))
    return fit, fit.form([deviation.value.ravel()])


@pytest.mark.parametrize("case", ["fm-11x41", "fh-12x41-45"])
def test_of_nearly_equal_corrections_the_smaller_is_taken(case: str) -> None:
    """Against all that the flank tells, by linear least squares: hardly more is left, with far better condition."""
    fit, target = fitted(case)
    told, taken = fit.effects[1][:, fit.determined], fit.effects[1][:, fit.needed(target)]
    assert 0 < taken.shape[1] < told.shape[1]
    steps = [ways @ np.linalg.lstsq(fit.slopes @ ways, target, rcond=None)[0] for ways in (told, taken, taken[:, :-1])]
    every, found, fewer = (np.linalg.norm(target - fit.slopes @ step) for step in steps)
    given_up = LEAST_GIVEN_UP * np.linalg.norm(target)
    assert every < found < np.hypot(every, given_up) < fewer  # not one combination too many
    assert np.linalg.norm(steps[1]) < np.linalg.norm(steps[0])
    effects = fit.effects[0][fit.determined]
    assert fit.condition(target) < effects[0] / effects[-1]


def test_scattered_points_tell_fewer_combinations_but_cost_no_more_than_the_limit() -> None:
    """Points that scatter tell less: fewer combinations are taken, which leave no more than ``GIVEN_UP`` besides."""
    fit, target = fitted("fh-12x41-45")
    scattered = target + fit.form([0.005 * np.abs(target).max() * np.random.default_rng(3).normal(size=target.size)])
    taken = [fit.effects[1][:, fit.needed(values)] for values in (target, scattered)]
    assert 0 < taken[1].shape[1] < taken[0].shape[1]
    steps = [ways @ np.linalg.lstsq(fit.slopes @ ways, scattered, rcond=None)[0] for ways in taken]
    closer, left = (np.linalg.norm(scattered - fit.slopes @ step) for step in steps)
    assert left < np.hypot(closer, GIVEN_UP * np.linalg.norm(scattered))


def test_large_errors_of_all_settings_are_corrected_in_one_pass_by_multiples_of_the_resolution() -> None:
    """Errors of all settings at once, not those of the loops above."""
    case, random = read_case("nasa-12x36"), np.random.default_rng(3)
    sizes = {"radial_distance": 0.1, "machine_root_angle": 1e-3, "work_offset": 0.1, "sliding_base": 0.1}
    sizes |= {"machine_center_to_crossing_point": 0.1, "ratio_of_roll": 1e-3}
    drawn = {name: size * float(random.normal()) for name, size in sizes.items()}
    convex = views(case, "gear")["convex"]
    largest = float(np.abs(measured(convex, with_errors(convex.loaded, drawn))).max())
    scaled = {name: value * 60.0 / largest for name, value in drawn.items()}
    errors: Any = dict.fromkeys(SIDES, scaled)
    before = measured_case(case, case, "gear", errors)
    corrected, unrounded = (
        correct_case(case, {"gear": grids(case, "gear", before)}, rounded=way) for way in (True, False)
    )
    assert greatest(measured_case(case, corrected.case, "gear", errors)) < 0.01 * greatest(before)
    (rounded,), (exact,) = corrected.corrections["gear"], unrounded.corrections["gear"]
    for name in rounded.changes:
        resolution = setting_step(name)
        steps = resolution.written(get_setting(rounded.surface, name)) / resolution.step
        assert steps == pytest.approx(round(steps), abs=1e-6), name
    assert rounded.rms < exact.rms + 1e-4  # 0.1 um
    assert exact.rms < (GIVEN_UP + 1e-3) * exact.rms_before
    # First derivatives are told beside the flanks cut anew: they agree to second order.
    assert abs(exact.rms_linear - exact.rms) < 0.05 * exact.rms_before


def test_a_modified_roll_that_the_design_has_not_stays_zero_unless_it_is_named() -> None:
    case = read_case("nasa-12x36")
    pinion = views(case, "pinion")["concave"]
    assert get_setting(pinion.loaded, "modified_roll_2c") == 0.0
    assert not {*MODIFIED_ROLL_ORDERS} & {*usual_settings(pinion.loaded)}
    hobbed = views(read_case("fh-12x41-45"), "pinion")["concave"]
    assert {"modified_roll_2c", "modified_roll_6d"} <= {*usual_settings(hobbed.loaded)}
    wrong = departure(pinion, with_errors(pinion.loaded, {"modified_roll_2c": 0.01, "ratio_of_roll": 1e-3}))
    kept = corrective_settings(pinion, wrong)
    assert get_setting(kept.surface, "modified_roll_2c") == 0.0
    named = corrective_settings(pinion, wrong, free=["ratio_of_roll", "modified_roll_2c"])
    assert named.changes["modified_roll_2c"] == pytest.approx(-0.01, rel=0.02)


def test_what_the_flanks_do_not_tell_holds_the_root() -> None:
    """Against the smallest changes with the same effect on the flank."""
    pinion = views(read_case("fm-11x41"), "pinion")["concave"]
    worn = flank_deviation(measured_file("fm-11x41-worn-pinion"), pinion)
    fit = SetUpFit((RecutFlank.of(pinion, worn.axial, worn.radial),), usual_settings(pinion.loaded))
    target = fit.form([worn.value.ravel()])
    told = fit.effects[1][:, fit.determined]
    smallest = told @ np.linalg.lstsq(fit.slopes @ told, target, rcond=None)[0]
    found = fit.steps(target)
    assert len(fit.loose()) == 4
    same = fit.departure(found) - fit.departure(smallest)
    assert np.sqrt(np.mean(same**2)) < 2e-4
    held, free = (np.abs(fit.root_change(0, steps)).max() for steps in (found, smallest))
    assert held < 0.5 * free
    assert abs(fit.root_change(0, found)[1]) < 0.1 * free  # at mid-face
    assert np.linalg.norm(found) < 1.0  # usual steps


def test_the_root_is_held_by_small_steps() -> None:
    """Of large errors it takes steps so long that what the flanks do not tell changes them: 3 % were left."""
    name, member, errors = CORRECTION_LOOPS["milled, fixed setting"]
    seen = views(loop_case(name), member)["concave"]

    def deviation(surface: GeneratingSurface, factor: float) -> float:
        wrong = {name: factor * by for name, by in errors["concave"].items()}
        return float(np.abs(measured(seen, with_errors(surface, wrong))).max())

    factor = 300.0 / deviation(seen.loaded, 1.0)
    real = with_errors(seen.loaded, {name: factor * by for name, by in errors["concave"].items()})
    found = corrective_settings(seen, departure(seen, real))
    before = float(np.abs(measured(seen, real)).max())
    assert before == pytest.approx(300.0, rel=0.1)
    assert deviation(found.surface, factor) < 0.012 * before
    assert np.abs(found.flanks[0].root_change).max() > 0.1


def test_a_rotation_alone_is_nothing_to_correct() -> None:
    pinion = views(read_case("nasa-12x36"), "pinion")["concave"]
    found = corrective_settings(pinion, departure(pinion, with_errors(pinion.loaded, GENERATED)), free=["cradle_angle"])
    assert found.loose[0].settings == ("cradle_angle",)
    assert found.changes["cradle_angle"] == pytest.approx(0.0, abs=1e-5)  # the design, rounded
    assert np.isinf(found.condition)


@pytest.mark.parametrize(
    ("member", "free", "words"),
    [
        (
            "gear",
            ["ratio_of_roll"],
            "'ratio_of_roll': must be one of point_radius, .*; this member is Formate",
        ),
        ("gear", ["modified_roll_2c"], "this member is Formate and has no roll"),
        ("gear", ["sliding_base_motion_1"], "this member is Formate and has no roll"),
        ("gear", ["cutter_tilt"], "the cutter of this machine is not tilted"),
        ("gear", ["rake_angle"], "a face-milling blade sweeps a surface of revolution"),
        ("gear", ["radial_distanse"], "must be one of .*; did you mean 'radial_distance'"),
        ("gear", [], "must name one at least of"),
        ("gear", ["sliding_base", "sliding_base"], "'sliding_base': must be named once"),
        ("pinion", ["sliding_base_motion_7"], "or a motion: radial_distance, .* with _motion_1 to _motion_6"),
    ],
)
def test_settings_that_cannot_be_moved_are_refused_with_those_that_can(member: Any, free: Any, words: str) -> None:
    seen = views(read_case("fm-11x41"), member)["convex"]
    deviation = deviation_from_formula(seen.section, GlobalErrors(spiral_angle=5.0), (9, 5))
    with pytest.raises(InputError, match=words):
        corrective_settings(seen, deviation, free=free)


def test_what_does_not_belong_together_is_refused() -> None:
    case = read_case("fm-11x41")
    pinion, gear = views(case, "pinion")["concave"], views(case, "gear")["convex"]
    on_pinion, on_gear = (
        deviation_from_formula(seen.section, GlobalErrors(spiral_angle=5.0), (9, 5)) for seen in (pinion, gear)
    )
    with pytest.raises(InputError, match="same machine settings; those of this member differ"):
        corrective_settings(pinion, on_pinion, shared=True)
    with pytest.raises(InputError, match="an opposite flank is given for flanks with set-ups of their own"):
        corrective_settings(pinion, on_pinion, opposite=on_pinion)
    with pytest.raises(InputError, match="a thickness is given for flanks with set-ups of their own"):
        corrective_settings(gear, on_gear, shared=False, thickness=0.01)
    with pytest.raises(InputError, match="thickness = 10 um: must go with the deviations of both flanks"):
        corrective_settings(gear, on_gear, thickness=0.01)
    with pytest.raises(InputError, match="thickness pinion = 5 um: must be of a member with measured flanks"):
        correct_case(case, {"gear": on_gear}, thickness={"pinion": 5.0})
    with pytest.raises(InputError, match="gear: free setting = 'ratio_of_roll'"):
        correct_case(case, {"gear": on_gear}, free=["ratio_of_roll"])
    matrix = measured_matrix(gear, 1e3 * on_gear.value.T)
    with pytest.raises(InputError, match="deviation gear: the convex flank comes twice"):
        correct_case(case, {"gear": [matrix, matrix]})
    with pytest.raises(InputError, match="deviation gear: must hold the concave flank, which the coast side has; it"):
        correct_case(case, {"gear": matrix}, flank="coast")


def test_an_unmeasured_flank_of_the_set_up_moves_with_it() -> None:
    case = read_case("fm-11x41")
    found = correct_case(case, {"gear": "fm-11x41-worn-gear"}, free=["machine_root_angle"])
    assert found.case.gear.concave is not None
    assert found.case.gear.convex is not None
    assert case.gear.convex is not None
    assert found.case.gear.concave.machine == found.case.gear.convex.machine != case.gear.convex.machine
    assert found.case.target.drive is None
    assert found.case.target.coast is None
    assert "the concave flank is cut in the same set-up and changes, too" in correction_report(found)
    alone = correct_case(case, {"gear": "fm-11x41-worn-gear"}, free=["machine_root_angle"], shared=False)
    assert alone.case.gear.concave == case.gear.concave
    assert alone.case.target.coast == case.target.coast


def test_a_root_that_moves_far_is_told_and_a_cutter_of_another_radius_holds_it() -> None:
    """Lengthwise crowning of a Formate gear is the cutter's radius, or depth."""
    case = read_case("fm-11x41")
    gear = views(case, "gear")["convex"]
    crowned = deviation_from_formula(gear.section, GlobalErrors(lengthwise_crowning=10.0), (9, 5))
    deep = correct_case(case, {"gear": crowned}).corrections["gear"][0]
    assert np.abs(deep.flanks[0].root_change).max() > gear.section.clearance
    (warning,) = root_warnings(deep)
    for word in ("the root of the convex flank moves by up to 1.1", "a clearance of 0.96 mm", "--free radial_distance"):
        assert word in warning
    assert f"Warning: {warning}" in correction_report(CaseCorrection(case, {"gear": (deep,)}))
    named = warning.rpartition("--free ")[2].split(",")
    held = correct_case(case, {"gear": crowned}, free=named).corrections["gear"][0]
    assert np.abs(held.flanks[0].root_change).max() < 0.02 * np.abs(deep.flanks[0].root_change).max()
    assert held.rms < 1.05 * deep.rms
    assert list(root_warnings(held)) == []


def written(values: Array, which: Side) -> str:
    """A plain matrix of deviations as a file."""
    head = f"# flank: {which}\n# rows: root to tip\n# columns: toe to heel\n# deviation_unit: um\n"
    return head + "\n".join("; ".join(f"{value:.4f}" for value in row) for row in values) + "\n"


@cache
def cut_with_errors() -> dict[Side, Array]:
    """Deviations [um] of both flanks of a spread-blade gear cut with errors."""
    case = read_case("fm-11x41")
    return measured_case(case, case, "gear", dict.fromkeys(SIDES, FORMATE))


@pytest.fixture(scope="module")
def matrices(tmp_path_factory: pytest.TempPathFactory) -> dict[Side, Path]:
    """Files of both flanks of a spread-blade gear cut with errors."""
    folder = tmp_path_factory.mktemp("measured")
    files: dict[Side, Path] = {}
    for which, values in cut_with_errors().items():
        files[which] = folder / f"{which}.txt"
        files[which].write_text(written(values, which), encoding="utf-8")
    return files


def test_the_command_writes_the_corrected_case_and_the_topographies(
    matrices: dict[Side, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Here the name of the picture counts, not what is in it.
    monkeypatch.setattr(FigureCanvasAgg, "print_png", lambda _, path, **__: Path(path).touch())
    given = [word for file in matrices.values() for word in ("--deviation", f"gear={file}")]
    output, folder = tmp_path / "corrected.toml", tmp_path / "pictures"
    said = output_of("correct", "fm-11x41", *given, "-o", output, "--plots", folder)
    assert "gear, convex and concave flanks, one set-up" in said
    for word in ("by derivatives", "cut anew", "sum of squares", "the root moves by", "after the correction"):
        assert word in said
    assert [path.name for path in folder.iterdir()] == ["fm-11x41-gear-convex-concave-topography.png"]
    corrected = read_case(output)
    errors: dict[Side, dict[str, float]] = dict.fromkeys(SIDES, FORMATE)
    case = read_case("fm-11x41")
    assert greatest(measured_case(case, corrected, "gear", errors)) < 0.03 * greatest(cut_with_errors())
    own, tables = ([getattr(one.gear, which) for which in SIDES] for one in (case, corrected))
    assert tables[0].machine == tables[1].machine != own[0].machine
    assert [table.cutter for table in tables] == [table.cutter for table in own]
    assert "Settings to execute, by easeoff correct from fm-11x41" in output.read_text(encoding="utf-8")
    assert corrected.corrected_flanks == ("gear concave", "gear convex")
    assert "Warning" not in output.read_text(encoding="utf-8").partition("[")[0]
    # The file is sealed: it is replaced while nobody has edited it.
    given += ["--free", "machine_root_angle", "--set-up"]
    assert "one set-up" in output_of("correct", "fm-11x41", *given, "shared", "-o", output)
    output.write_text(output.read_text(encoding="utf-8").replace("11x41", "mine"), encoding="utf-8")
    assert "was edited after easeoff wrote it" in refusal_of("correct", "fm-11x41", *given, "shared", "-o", output)
    assert "one set-up" not in output_of("correct", "fm-11x41", *given, "own")


@pytest.mark.parametrize(("size", "more"), [(0.0, ["--plots", "."]), (1e-7, [])])
def test_the_command_tells_that_there_is_nothing_to_correct(
    size: float, more: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    matrix, output = tmp_path / "perfect.txt", tmp_path / "same.toml"
    matrix.write_text(written(np.full((5, 9), size), "convex").replace("0.0000", f"{size:g}"), encoding="utf-8")
    said = output_of(
        "correct", "fm-11x41", "--deviation", f"gear={matrix}", "-o", output, *more, "--free", "work_offset"
    )
    assert "Note: nothing to correct" in said
    assert "hardly pay" not in said
    assert read_case(output).gear == read_case("fm-11x41").gear
    assert read_case(output).corrected_flanks == ()
    assert "Nothing to correct, gear: convex" in output.read_text(encoding="utf-8").partition("[")[0]


def test_sheet_result_and_report_tell_settings_to_execute(tmp_path: Path) -> None:
    """Once each, from the mark in the case file; of load cases once for all."""
    case = small("nasa-12x36", "shell")
    write_case(case.model_copy(update={"corrected_flanks": ("gear convex",)}), tmp_path / "corrected.toml")
    marked = read_case(tmp_path / "corrected.toml")
    tree = easeoff.analyze(marked, torques=[100.0])
    row = easeoff.cases.LoadCase(torque=100.0)
    both = easeoff.study.analyze_load_cases(marked, [row, row.model_copy(update={"torque": 150.0})])
    page = content(report_page({"a": tree}))["results"][0]["notes"]
    for notes in (summary_sheet(marked).notes, result_notes(tree), load_case_notes(both), page):
        assert [note.startswith("Note: the settings of gear convex") for note in notes].count(True) == 1
    assert not any("settings of" in note for note in result_notes(easeoff.analyze(case, torques=[100.0])))
    for value in ('["gear left"]', '"gear convex"'):
        text = f"corrected_flanks = {value}\n{case_toml(case)}"
        with pytest.raises(easeoff.InputError, match="corrected_flanks"):
            easeoff.cases.parse_case(text)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--free", "ratio_of_roll"], "gear: free setting = 'ratio_of_roll': must be one of point_radius"),
        (["--free", ""], "must be names separated by commas"),
        (["--free", "radial_distance,"], "ends in a comma"),
        (["--free", "radial_distance,radial_distance"], "radial_distance comes twice"),
        (["--free", "x" * 3000], "must be one of"),
        (["--set-up", "both"], "'both' is not one of"),
        (["--thickness", "gear"], "must be KEY=NUMBER"),
        (["--thickness", "gear=nan"], "must lie between -1000 and 1000 um"),
        (["--thickness", "wheel=5"], "must be one of pinion, gear"),
        (["--thickness", "pinion=5"], "must be of a member with measured flanks"),
        (["--thickness", "gear=5"], "must go with the deviations of both flanks"),
        (["--flank", "coast"], "must hold the concave flank"),
        (["--force"], "must go with --output"),
        (["-o", "x.nc"], "must be a name that ends in .toml"),
        (["-o", "folder.toml", "--plots", "folder.toml"], "must be another name than that of the file"),
        (["--deviation", "gear=a.csv", "--deviation", "gear=b.csv"], "comes more than twice"),
        (["--deviation", "gear=fm-11x41-worn-gear"], "the convex flank comes twice"),
        (["--deviation", "wheel=fm-11x41-worn-gear"], "must be pinion=FILE or gear=FILE"),
    ],
)
def test_mistakes_on_the_command_line_are_told_and_leave_no_file(
    words: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    own = [] if "-o" in words or "--force" in words else ["-o", "corrected.toml"]
    said = refusal_of("correct", "fm-11x41", "--deviation", "gear=fm-11x41-worn-gear", *words, *own)
    assert told in " ".join(said.split())
    assert "Traceback" not in said
    assert list(tmp_path.iterdir()) == []


def test_the_corrected_file_warns_of_a_root_that_moves_far(tmp_path: Path) -> None:
    seen = views(read_case("fm-11x41"), "gear")["convex"]
    values = GlobalErrors(lengthwise_crowning=10.0)(*np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 5)))
    matrix, output = tmp_path / "crowned.txt", tmp_path / "corrected.toml"
    matrix.write_text(written(values, side(seen.loaded)), encoding="utf-8")
    said = output_of("correct", "fm-11x41", "--deviation", f"gear={matrix}", "-o", output)
    assert "Warning: the root of the convex flank moves by" in said
    comment = [line for line in output.read_text(encoding="utf-8").splitlines() if line.startswith("#")]
    assert any("Warning, gear: the root of the convex flank" in line for line in comment)
    assert read_case(output).gear.number_of_teeth == 41


def test_the_case_that_is_read_is_not_overwritten(matrices: dict[Side, Path], tmp_path: Path) -> None:
    own = tmp_path / "mine.toml"
    write_case(read_case("fm-11x41"), own)
    text = own.read_text(encoding="utf-8")
    said = refusal_of("correct", own, "--deviation", f"gear={matrices['convex']}", "-o", own, "--force")
    assert "is the file that is read" in said
    assert own.read_text(encoding="utf-8") == text


def test_topographies_show_toe_heel_top_and_root_with_signs_and_sizes() -> None:
    case = read_case("nasa-12x36")
    gear = views(case, "gear")["convex"]
    values = GlobalErrors(spiral_angle=5.0)(*np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 5)))
    matrix = measured_matrix(gear, values)
    corrected = correct_case(case, {"gear": matrix}, free=["machine_root_angle"])
    (found,) = corrected.corrections["gear"]
    rest = f"rms {1e3 * found.rms_before:.2f} um, after the correction {1e3 * found.rms:.2f} um"
    assert rest in correction_report(corrected)
    figure = plot.topography(found, title="a title")
    assert len(figure.axes) == 2
    texts = [text.get_text() for text in figure.axes[0].texts]
    for word in ("toe", "heel", "top", "root"):
        assert word in texts
    before = 1e3 * found.flanks[0].before
    assert any(f"sum of squares {np.sum(before**2):.4g}" in text for text in texts)
    places = {text.get_text(): text.get_position() for text in figure.axes[0].texts}
    assert places["toe"][0] < places["heel"][0]
    assert places["root"][1] < places["top"][1]
    lines = [np.asarray(line.get_xydata()) for line in figure.axes[0].lines]
    bars = [line for line in lines if len(line) == 2 and line[0, 0] == line[1, 0]]
    at_toe, at_heel = (pick(bars[:-1], key=lambda bar: bar[0][0]) for pick in (min, max))
    assert at_toe[1][1] < at_toe[0][1]  # less metal: downwards
    assert at_heel[1][1] > at_heel[0][1]
    single = plot.topography(found, parts="after")
    assert len(single.axes) == 1
    with pytest.raises(InputError, match="parts = 'later': must be one of before, after"):
        plot.topography(found, parts="later")
    with pytest.raises(InputError, match="correction = int: must be a Correction"):
        plot.topography(3)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="axes = 1 of Axes: must be 2 Axes"):
        plot.topography(found, axes=single.axes[0])


def test_a_departure_needs_a_flank() -> None:
    gear = views(read_case("fm-11x41"), "gear")["convex"]
    with pytest.raises(GeometryError, match="these settings cut no flank"):
        departure(gear, with_settings(gear.loaded, {"radial_distance": 20.0}))
    assert easeoff.read_case("fm-11x41").gear.number_of_teeth == 41
