"""Design report: blanks, moved settings, remaining ease-off and warnings, as text."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ...geometry.design.blank import BlankDimensions
from ...geometry.pair.gear_pair import FlankName
from ..design.design_check import DesignReport, SideReport
from .table import Table

ANGLES = (
    "pressure_angle",
    "rake_angle",
    "hook_angle",
    "cradle_angle",
    "machine_root_angle",
    "cutter_tilt",
    "cutter_swivel",
)
MEMBER_ROWS = (
    ("pitch angle [deg]", "pitch_angle"),
    ("face angle [deg]", "face_angle"),
    ("root angle [deg]", "root_angle"),
    ("mean spiral angle [deg]", "mean_spiral_angle"),
    ("outer cone distance [mm]", "outer_cone_distance"),
    ("face width [mm]", "face_width"),
    ("outer pitch diameter [mm]", "outer_pitch_diameter"),
    ("mean addendum [mm]", "mean_addendum"),
    ("mean dedendum [mm]", "mean_dedendum"),
    ("mean normal thickness [mm]", "mean_normal_thickness"),
)


def design_report(report: DesignReport) -> str:
    """Report of a design."""
    parts = [Table(("", "pinion", "gear"), list(_blank_rows(report.blank)), 3, "Blanks").text()]
    for side, item in report.sides.items():
        parts += [f"{side.capitalize()} side: {remaining_ease_off(item)}", _moved(item), _root(item)]
    if report.spaces is not None:
        head, *rows = report.spaces.rows()
        parts.append(Table(head, rows, title="Teeth and slots").text())
    return "\n\n".join([*parts, *warning_lines(report)])


def summary_lines(report: DesignReport) -> list[str]:
    """Summary of a design: a line a side, and the warnings."""
    sides: dict[FlankName, SideReport] = dict(report.sides)
    return [*(f"{side}: {remaining_ease_off(item)}" for side, item in sides.items()), *warning_lines(report)]


def warning_lines(report: DesignReport) -> list[str]:
    """Warnings of a design, a line each."""
    return [f"Warning: {warning}" for warning in report.warnings]


def remaining_ease_off(item: SideReport) -> str:
    """Remaining ease-off of a side after the fit, in one line."""
    within = (
        f"ease-off within {1e3 * item.largest_residual:.2f} um of the target (rms {1e3 * item.rms_residual:.2f} um)"
    )
    common = f"{100 * item.common_flank:.0f} % of the gear flank"
    return f"{within}, up to {1e3 * item.largest_ease_off:.1f} um on the common flank, {common}"


def _root(item: SideReport) -> str:
    gaps = " / ".join(f"{gap:+.3f}" if math.isfinite(gap) else "no flank" for gap in item.root_gap)
    return (
        "Pinion's blade tip above the root cone in the positions that cut the fit's nodes near the root, "
        f"at toe / middle / heel: {gaps} mm"
    )


def _blank_rows(blank: BlankDimensions) -> Iterator[tuple[str, str, str]]:
    for label, name in MEMBER_ROWS:
        values = [getattr(member, name) for member in (blank.pinion, blank.gear)]
        if "[deg]" in label:
            values = [math.degrees(value) for value in values]
        yield label, f"{values[0]:.4f}", f"{values[1]:.4f}"
    module = f"{blank.mean_normal_module:.4f}"
    yield "mean normal module [mm]", module, module
    for side in ("drive", "coast"):
        angle = f"{math.degrees(getattr(blank, f'generated_{side}_pressure_angle')):.4f}"
        yield f"{side} pressure angle [deg]", angle, angle


def unit_of(name: str) -> str:
    """Unit in which a free setting is printed; empty for a ratio."""
    if name == "blade_curvature":
        return "1/mm"
    if name == "ratio_of_roll" or name.startswith("modified_roll_"):
        return ""
    base, _, order = name.partition("_motion_")
    unit = "deg" if base in ANGLES else "mm"
    return f"{unit}/rad^{order}" if order else unit


def _moved(item: SideReport) -> str:
    rows = []
    for name, (start, end) in item.moved.items():
        unit = unit_of(name)
        factor = math.degrees(1.0) if unit.startswith("deg") else 1.0
        values = [f"{factor * value:.5f}" for value in (start, end, end - start)]
        rows.append((f"{name} [{unit}]" if unit else name, *values))
    return Table(("pinion setting", "start", "fitted", "change"), rows).text()
