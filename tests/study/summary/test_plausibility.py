"""A result says how its flanks depart from the design, and where it is unlike any gear; never of ordinary ones."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from pairs import by_the_dissertation
from runs import SHELLS, call, output_of, refusal_of, replaced, small_text, text_file

import easeoff
from easeoff.cases import Case, gear_pair, parse_case, read_case, shipped_cases, write_case
from easeoff.geometry import FlankName, Modification
from easeoff.geometry.pair.tooth_thickness import contradictions
from easeoff.study.design.design_check import case_warnings
from easeoff.study.plot.page import small_print
from easeoff.study.summary.plausibility import COMMON_FLANK_LIMIT, EASE_OFF_LIMIT, PRESSURE_LIMIT, plausibility
from easeoff.study.summary.result_summary import result_summary

COARSE = {"torques": (100.0,), "mesh_positions": 4, "segments_per_line": 5, "lengthwise_nodes": 11, "profile_nodes": 9}


def coarse(name: str, **contact: Any) -> Case:
    return by_the_dissertation(name, **COARSE, **contact)


def without_a_sign(folder: Path, model: Literal["shell", "solid_shell"]) -> Path:
    """A case whose pinion has a work offset of the other sign."""
    data = coarse("fm-11x41", edge_contact=True).model_dump()
    data["compliance"]["model"] = model
    data["pinion"]["concave"]["machine"]["work_offset"] *= -1.0
    write_case(Case.model_validate(data), folder / "slip.toml")
    return folder / "slip.toml"


@cache
def plain() -> xr.DataTree:
    return easeoff.analyze(coarse("fm-11x41", edge_contact=True))


def changed(group: str, change: Callable[[xr.Dataset], xr.Dataset]) -> xr.DataTree:
    groups = dict(plain().to_dict())
    groups[f"/{group}"] = change(plain()[group].to_dataset().copy(deep=True))
    return xr.DataTree.from_dict(groups)


def wide(by: float) -> xr.DataTree:
    """The greatest ease-off on the common flank as many times the limit."""

    def change(ease_off: xr.Dataset) -> xr.Dataset:
        gap = ease_off["ease_off"].where(ease_off["inside"] == 1)
        return ease_off.assign(ease_off=ease_off["ease_off"] * float(by * EASE_OFF_LIMIT / gap.max()))

    return changed("ease_off", change)


def pressed(by: float) -> xr.DataTree:
    return changed("loaded", lambda loaded: loaded.assign(max_pressure=("torque", [by * PRESSURE_LIMIT])))


def shared(by: float) -> xr.DataTree:
    """About as many first nodes on the common flank as make that part of it; those of the toe count half."""

    def change(ease_off: xr.Dataset) -> xr.Dataset:
        inside = np.zeros(ease_off["inside"].size, dtype=np.int8)
        inside[: round(by * COMMON_FLANK_LIMIT * inside.size)] = 1
        return ease_off.assign(inside=(ease_off["inside"].dims, inside.reshape(ease_off["inside"].shape)))

    return changed("ease_off", change)


def unwrapped(tree: xr.DataTree) -> str:
    """The summary of a result in one line."""
    return " ".join(result_summary(tree).split())


@pytest.mark.parametrize("name", shipped_cases())
@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_shipped_cases_are_plausible(name: str, flank: FlankName) -> None:
    assert plausibility(easeoff.analyze(coarse(name), flank=flank)) == []


@pytest.mark.parametrize(
    ("made", "beyond", "within", "words"),
    [
        (wide, 1.1, 0.9, "ease-off reaches 1.1 mm on the common flank"),
        (pressed, 1.1, 0.9, "greatest pressure is 5.5 GPa"),
        (shared, 0.9, 1.1, "flanks share 25 % of the gear flank"),
    ],
)
def test_each_limit_has_its_note(
    made: Callable[[float], xr.DataTree], beyond: float, within: float, words: str
) -> None:
    (note,) = plausibility(made(beyond))
    assert words in note
    assert note in unwrapped(made(beyond))
    assert plausibility(made(within)) == []


@pytest.mark.parametrize(
    ("pattern", "wrong", "words"),
    [
        (r"^shaft_angle = 90.0$", "shaft_angle = 91.0", "pitch cones of pinion and gear are 1.42 mm apart"),
        (r"^hypoid_offset = 0.0$", "hypoid_offset = 15.0", "pitch cones of pinion and gear are"),
        (r"^number_of_teeth = 12$", "number_of_teeth = 13", "module is 3.231 mm at the pinion and 3.502 mm at"),
        (r"^number_of_teeth = 36$", "number_of_teeth = 35", "module is 3.500 mm at the pinion and 3.602 mm at"),
    ],
)
def test_blanks_that_contradict_the_axes_or_the_tooth_numbers_are_noted(pattern: str, wrong: str, words: str) -> None:
    case = parse_case(replaced(small_text("nasa-12x36"), pattern, wrong))
    (found,) = contradictions(gear_pair(case))
    assert words in found


def test_contradicting_blanks_are_noted_wherever_a_result_is_read(tmp_path: Path) -> None:
    text = replaced(small_text("nasa-12x36", SHELLS), r"^shaft_angle = 90.0$", "shaft_angle = 90.5")
    path = text_file(tmp_path / "angle.toml", text)
    words = "Warning: the pitch cones of pinion and gear are 0.71 mm apart"
    assert words.removeprefix("Warning: ") in case_warnings(read_case(path))[1][0]
    assert words in output_of("convert", path, "-o", tmp_path / "angle.rexs")
    out = tmp_path / "angle.nc"
    for output in (output_of("run", path, "-o", out), output_of("show", out)):
        assert words in " ".join(output.split())


def test_a_lost_sign_is_noted_by_run_and_show_and_changes_no_exit_code(tmp_path: Path) -> None:
    """The work offset of the pinion with the other sign still cuts a tooth, and every position is certified."""
    out = tmp_path / "slip.nc"
    assert "Note: the ease-off reaches" in output_of("run", without_a_sign(tmp_path, "shell"), "-o", out)
    assert "Note: the ease-off reaches" in call("show", out).output


def test_a_result_whose_flanks_do_not_touch_without_load_is_read_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Here it counts that all is drawn, not how finely.
    drawn: Any = FigureCanvasAgg.print_png

    def print_coarse(canvas: FigureCanvasAgg, *given: Any, **keywords: Any) -> None:
        canvas.figure.set_dpi(20)
        drawn(canvas, *given, **keywords)

    monkeypatch.setattr(FigureCanvasAgg, "print_png", print_coarse)
    data = coarse("fm-11x41", edge_contact=True).model_dump()
    data["contact"].update(mesh_positions=3, lengthwise_nodes=9, profile_nodes=7)
    data["pinion"]["concave"]["machine"]["work_offset"] *= -1.0
    write_case(Case.model_validate(data), tmp_path / "slip.toml")
    words = "without load the flanks do not touch at 2 of 3 mesh positions"
    out = tmp_path / "slip.nc"
    for output in (output_of("run", tmp_path / "slip.toml", "-o", out), output_of("show", out)):
        assert words in " ".join(output.split())
    output_of("report", out, "-o", tmp_path / "slip.html")
    output_of("plot", out, "-o", tmp_path / "pictures")


def test_a_lost_sign_that_leaves_a_pointed_tooth_is_refused_by_the_solid_shell(tmp_path: Path) -> None:
    """Which tooth, why, and what needs no whole tooth; nothing is written."""
    out = tmp_path / "slip.nc"
    said = refusal_of("run", without_a_sign(tmp_path, "solid_shell"), "-o", out)
    for words in ("the pinion's tooth is pointed", "of the face", '[compliance] model = "shell"'):
        assert words in said
    assert not out.exists()


def test_departures_from_the_design_are_in_report_and_small_print() -> None:
    nothing = result_summary(plain()) + " ".join(small_print(plain().attrs))
    assert "deviating" not in nothing
    assert "modified" not in nothing
    deviations = {m: f"fm-11x41-worn-{m}" for m in ("pinion", "gear")}
    modified = Modification({"lengthwise_crowning": 5.0, "bias": -2.0})
    tree = easeoff.analyze(coarse("fm-11x41"), deviations=deviations, modification=modified)  # type: ignore[arg-type]
    pinion = f"pinion up to {tree.attrs['largest_deviation_pinion_um']:.3g} um, gear up to"
    for words in (pinion, "ease-off updated", "lengthwise crowning +5 um, bias -2 um"):
        assert words in result_summary(tree)
        assert words.replace(" um", " µm").replace(" -", " −") in " ".join(small_print(tree.attrs))


def test_show_says_that_a_closest_approach_was_searched_for() -> None:
    note = "curvature of the flanks changes so quickly that the closest approach was searched for"
    assert note not in unwrapped(plain())
    found = unwrapped(changed("loaded", lambda loaded: loaded.assign_attrs(searched_segments=3)))
    assert note in found
    loaded = plain()["loaded"].to_dataset().isel(torque=0)
    segments = int((loaded["length"].notnull() & loaded["overhang"].isnull()).sum())  # of lines: edges are no closer
    assert f"at 3 of {segments} segments" in found
