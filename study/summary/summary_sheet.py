"""Summary sheet of a pair: what a shop makes, inspects and sets, as text or as a page.

Blanks, teeth, backlash, tolerances, cutters, machine settings and the V-H check.
"""

from __future__ import annotations

import datetime
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from importlib import resources
from importlib.metadata import version
from itertools import zip_longest

import xarray as xr

from ...cases.schema.case_schema import Case, DrawingTable, motion_name, usual_name
from ...cases.schema.cutting_table import FlankSettings
from ...cases.writing import with_blanks
from ...core.checks import instance
from ...core.errors import EaseoffError, InputError
from ...geometry.cutting.named_settings import USUAL_RESOLUTION, MachineResolution
from ...geometry.pair.gear_pair import MEMBERS, FlankName
from ..design.design_check import case_warnings, unusual_set_ups
from ..design.rounded_settings import FLANKS, rounded_case, rounding_effect, step_of_key
from .assembly import misfit, toleranced_backlash
from .blank_drawing import (
    CUTTER_ROWS,
    ROWS,
    TOLERANCES,
    backlash_rows,
    case_backlash,
    case_tolerances,
    implied_dimensions,
)
from .plausibility import execution_note
from .sweep_report import SIGNS as SHIFT_SIGNS, places_table, reasons, totals
from .table import Table, filled

ANGULAR = ("angle", "tilt", "swivel")
LENGTHS = ("distance", "offset", "base", "point", "radius", "depth", "height")
NO_VALUE = "-"
#: Where settings and apexes are positive, alike for both hands; they are those of docs/how_it_works/conventions.md.
SIGNS = (
    "Positive: basic cradle angle, from the root line to the cutter centre; machine root angle, heel away from the "
    "cradle; blank offset, work axis to the side of the cutter centre; sliding base, work withdrawn along the cradle "
    "axis; machine centre to back, crossing point moved along the work axis towards the heel; apexes, beyond the "
    "crossing point; hypoid offset, the pinion's spiral angle the greater. Horizontal and vertical: the radial setting "
    "along and across the root line.",
)


@dataclass(frozen=True)
class SummarySheet:
    """A summary sheet.

    Parameters
    ----------
    title
        Of the pair.
    tables
        Tables by heading, a row of texts each, the first row the head.
    effects
        What rounding changes of the ease-off, a line a side.
    notes
        What the settings are not made for, and what is doubtful of the teeth, a line each, above the tables.
    signs
        What the settings count positive, below the tables.
    head
        Drawing, version and date, a line each.

    Examples
    --------
    >>> sheet = SummarySheet("A pair", {"Blanks": (("", "unit", "pinion"), ("teeth", "", "11"))}, ())
    >>> sheet.text().splitlines()[0]
    'A pair'
    """

    title: str
    tables: Mapping[str, tuple[tuple[str, ...], ...]]
    effects: tuple[str, ...]
    notes: tuple[str, ...] = ()
    signs: tuple[str, ...] = ()
    head: tuple[str, ...] = ()

    def text(self) -> str:
        """The sheet as text."""
        parts = ["\n".join([self.title, *self.head]), *([filled(self.notes)] if self.notes else [])]
        parts += [Table(head, rows, _names(heading), heading).text() for heading, (head, *rows) in self.tables.items()]
        return "\n\n".join([*parts, "\n".join(self.effects), *map(filled, [[line] for line in self.signs])]) + "\n"

    def page(self) -> str:
        """The sheet as an HTML page that needs nothing else."""
        parts = [f"<p>{'<br>'.join(map(escape, self.head))}</p>"] if self.head else []
        parts += [f'<p class="note">{escape(note)}</p>' for note in self.notes]
        for heading, (head, *rows) in self.tables.items():
            parts += [f"<h2>{escape(heading)}</h2>", Table(head, rows, _names(heading)).in_form("html")]
        effects = "".join(f"<p>{escape(line)}</p>" for line in (*self.effects, *self.signs))
        return PAGE.format(title=escape(self.title), body="\n".join([*parts, effects]))


def _names(heading: str) -> int:
    """Columns of a table that name its rows: name and unit, or the place of a V-H check."""
    return 1 if heading.startswith("V-H") else 2


PAGE = resources.files(__package__).joinpath("sheet_page.html").read_text(encoding="utf-8")


def summary_sheet(
    case: Case,
    resolution: MachineResolution | None = None,
    *,
    vh_checks: Mapping[FlankName, xr.Dataset] | None = None,
) -> SummarySheet:
    """Summary sheet of a case, its settings rounded to a resolution.

    Parameters
    ----------
    case
        A checked case.
    resolution
        Steps; the usual ones if left out.
    vh_checks
        V-H checks by flank, as of ``study.vh_check``, that the sheet is to show.

    Returns
    -------
    SummarySheet
        Blanks, teeth and backlash, tolerances by accuracy grade, cutters and machine settings of every flank, with the
        resolution of each setting, what rounding changes of the ease-off, and notes on set-ups and teeth.

    Raises
    ------
    GeometryError
        If the rounded flanks do not meet.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case = read_case("fm-11x41")
    >>> shells = case.compliance.model_copy(update={"model": "shell"})
    >>> sheet = summary_sheet(case.model_copy(update={"compliance": shells}))
    >>> list(sheet.tables)
    ['Blanks', 'Dimensions', 'Cutters', 'Machine settings', 'Teeth and slots']
    >>> sheet.tables["Blanks"][4]
    ('hypoid offset', 'mm', '20.0000', '20.0000')
    """
    instance("case", case, Case)
    steps, checks = USUAL_RESOLUTION if resolution is None else resolution, vh_checks or {}
    rounded = with_blanks(rounded_case(case, steps))
    effect = rounding_effect(case, rounded_case(case, steps))
    spaces, warnings = case_warnings(rounded)
    dimensions = implied_dimensions(rounded)
    tolerances, backlash, doubts = _tolerances_and_backlash(rounded, dimensions)
    return SummarySheet(
        case.title,
        {
            "Blanks": tuple(_blanks(rounded)),
            "Dimensions": tuple(_dimensions(rounded, dimensions)),
            **({"Tolerances by ISO 17485": tolerances} if tolerances else {}),
            **({"Backlash": backlash} if backlash else {}),
            "Cutters": tuple(_settings(rounded, steps, "cutter")),
            "Machine settings": tuple(_settings(rounded, steps, "machine")),
            **({"Teeth and slots": tuple(spaces.rows())} if spaces is not None else {}),
            **{f"V-H check, {flank}": tuple(_vh_rows(check)) for flank, check in checks.items()},
        },
        (
            *(effect_line(side, value) for side, value in effect.items()),
            *(f"V-H {flank}: {line}" for flank, check in checks.items() for line in (*reasons(check), totals(check))),
        ),
        (
            *execution_note(case.corrected_flanks),
            *unusual_set_ups(case),
            *doubts,
            *(f"Warning: {text}" for text in warnings),
        ),
        SIGNS + ("; ".join(SHIFT_SIGNS) + ".",) * bool(checks),
        tuple(_head(case.drawing)),
    )


def _head(drawing: DrawingTable) -> Iterator[str]:
    """Drawing, accuracy grade, version and date."""
    names = {"drawing": drawing.drawing_number, "revision": drawing.revision, "ISO 17485 grade": drawing.accuracy_grade}
    if words := ", ".join(f"{name} {value}" for name, value in names.items() if value):
        yield words
    yield f"{datetime.date.today().isoformat()}, easeoff {version('easeoff')}"


def _dimensions(case: Case, dimensions: Mapping[str, Mapping[str, float]]) -> Iterator[tuple[str, ...]]:
    """Rows of dimensions of blanks and teeth, mounting and material; cutters stand in a table of their own."""
    yield "", "unit", *MEMBERS
    members = case.pinion, case.gear
    drawing = case.drawing
    mounting = [getattr(drawing, f"{name}_mounting_distance") for name in MEMBERS]
    if any(mounting):
        within = f" ± {drawing.mounting_tolerance:g}" if drawing.mounting_tolerance else ""
        yield "mounting distance", "mm", *(NO_VALUE if each is None else f"{each:.3f}{within}" for each in mounting)
    supports = [getattr(case.supports, name, None) for name in MEMBERS]
    seats = [[f"{b.name} {b.position:.3f}" for b in (each.bearings if each is not None else ())] for each in supports]
    for bearings in zip_longest(*seats, fillvalue=NO_VALUE):
        yield "bearing from the crossing point", "mm", *bearings
    steels = [f"E {each.material.elastic_modulus:g}, nu {each.material.poisson_ratio:g}" for each in members]
    yield "material", "MPa, 1", *steels
    for key, (name, unit) in ROWS.items():
        values = [each.get(key, math.nan) for each in dimensions.values()]
        if key not in CUTTER_ROWS and any(map(math.isfinite, values)):
            yield name, unit.replace("°", "deg"), *(f"{value:.4f}" for value in values)


def _tolerances_and_backlash(
    case: Case, dimensions: Mapping[str, Mapping[str, float]]
) -> tuple[tuple[tuple[str, ...], ...], tuple[tuple[str, ...], ...], list[str]]:
    """Tables of the tolerances and of the backlash, empty where there are none, and notes on what is not known."""
    doubts, tolerances = [], {}
    try:
        tolerances = case_tolerances(case, dimensions)
    except InputError as error:
        doubts.append(f"Note: no tolerances: {error}")
    table: list[tuple[str, ...]] = [("", "unit", *MEMBERS)]
    for key, name in TOLERANCES.items():
        if values := [each[key] for each in tolerances.values() if key in each]:
            table.append((name, "um", *(f"{value:g}" for value in values)))
    try:
        play = case_backlash(case)
    except EaseoffError as error:
        return (tuple(table) if tolerances else ()), (), [*doubts, f"Note: {error}"]
    pressure = [each[f"{side}_pressure_angle"] for each in dimensions.values() for side in FLANKS]
    run_out = 1e-3 * sum(each.get("run_out", 0.0) for each in tolerances.values())
    run_out *= math.sin(math.radians(sum(map(abs, pressure)) / 4.0))
    within = toleranced_backlash(play, case.drawing.mounting_tolerance, case.drawing.thickness_tolerance, run_out)
    rows = backlash_rows(play, within, dimensions["gear"]["outer_transverse_module"])
    return tuple(table) if tolerances else (), (("", "unit", "least", "greatest"), *rows), [*doubts, *misfit(play)]


def _vh_rows(check: xr.Dataset) -> Iterator[tuple[str, ...]]:
    """Rows of a V-H check, a place each, under their heads."""
    table = places_table(check)
    yield tuple(head if isinstance(head, str) else head.column or head.head for head in table.heads)
    yield from map(tuple, table.rows)


def effect_line(side: FlankName, effect: float) -> str:
    """Effect [mm] of rounding on the ease-off of a side, in one line."""
    return f"{side}: rounding the settings changes the ease-off by up to {1e3 * effect:.2f} um"


def _blanks(case: Case) -> Iterator[tuple[str, ...]]:
    yield "", "unit", "pinion", "gear"
    members = case.pinion, case.gear
    hand = case.pinion.hand_of_spiral
    yield "number of teeth", "", *(str(member.number_of_teeth) for member in members)
    yield "hand of spiral", "", hand, "left" if hand == "right" else "right"
    yield "shaft angle", "deg", *(f"{case.pair.shaft_angle:.4f}",) * 2
    yield "hypoid offset", "mm", *(f"{case.pair.hypoid_offset:.4f}",) * 2
    tables = [member.blank.model_dump() if member.blank is not None else {} for member in members]
    for key in tables[0]:
        if all(table.get(key) is not None for table in tables):
            unit = "deg" if key.endswith("angle") else "mm"
            yield key.replace("_", " "), unit, *(f"{table[key]:.4f}" for table in tables)


def described_flanks(case: Case) -> dict[str, FlankSettings]:
    """Settings of the flanks that a case describes, by member and side."""
    members = (("pinion", case.pinion), ("gear", case.gear))
    flanks = {f"{name} {side}": getattr(member, side) for name, member in members for side in FLANKS}
    return {name: settings for name, settings in flanks.items() if settings is not None}


def _settings(case: Case, steps: MachineResolution, table: str) -> Iterator[tuple[str, ...]]:
    """Rows of the settings that a flank has, with their names, units and resolutions."""
    flanks = described_flanks(case)
    yield "setting", "REXS, case file", "unit", "step", *flanks
    if table == "cutter":
        yield "blade", "", "", "", *("outside" if name.endswith("concave") else "inside" for name in flanks)
    tables = {name: getattr(settings, table).model_dump() for name, settings in flanks.items()}
    for key in next(iter(tables.values())):
        if key == "motions":
            yield from _motions(flanks, steps)
            continue
        values = [each[key] for each in tables.values()]
        if not any(values):
            continue
        unit = "deg" if key.endswith(ANGULAR) else "mm" if key.endswith(LENGTHS) else ""
        yield usual_name(key), key, unit, *_row(values, step_of_key(steps, table, key))
    if table == "cutter":
        yield from _point_width(case)
    else:
        yield from _formate_position(flanks, steps)


def _motions(flanks: Mapping[str, FlankSettings], steps: MachineResolution) -> Iterator[tuple[str, ...]]:
    motions = [settings.machine.motions.model_dump() for settings in flanks.values()]
    for key in motions[0]:
        for order in range(max(len(each[key]) for each in motions)):
            values = [each[key][order] if order < len(each[key]) else 0.0 for each in motions]
            name, unit = f"{motion_name(key)}, order {order + 1}", "deg" if key.endswith(ANGULAR) else "mm"
            yield name, f"motions.{key}", f"{unit}/rad^{order + 1}", *_row(values, step_of_key(steps, "motions", key))


def _formate_position(flanks: Mapping[str, FlankSettings], steps: MachineResolution) -> Iterator[tuple[str, ...]]:
    """Place of the cutter centre of Formate members, as their machines have it, where it is given by other settings."""
    step = step_of_key(steps, "machine", "radial_distance")
    machines = [settings.machine for settings in flanks.values()]
    for name, part in (("horizontal", math.cos), ("vertical", math.sin)):
        places: list[float | int | None] = [
            None
            if machine.ratio_of_roll is not None or machine.radial_distance is None or machine.cradle_angle is None
            else machine.radial_distance * part(math.radians(machine.cradle_angle))
            for machine in machines
        ]
        if any(place is not None for place in places):
            yield f"{name} (Formate)", "", "mm", *_row(places, step)


def _point_width(case: Case) -> Iterator[tuple[str, ...]]:
    """Point width of the members whose flanks one face-milling cutter cuts."""
    widths = []
    for member in (case.pinion, case.gear):
        outside, inside = member.concave, member.convex
        if outside is None or inside is None:
            widths += [NO_VALUE]
        elif outside.machine != inside.machine or outside.cutter.number_of_blade_groups:
            widths += [NO_VALUE, NO_VALUE]
        else:
            widths += [f"{outside.cutter.blade_point_radius - inside.cutter.blade_point_radius:.3f}"] * 2
    if any(width != NO_VALUE for width in widths):
        yield "point width", "", "mm", "", *widths


def _row(values: list[float | int | None], step: float | None) -> tuple[str, ...]:
    """Resolution and values with as many decimals as it has."""
    if step is None:
        return NO_VALUE, *(NO_VALUE if value is None else f"{value:g}" for value in values)
    places = max(0, len(f"{step:.10f}".rstrip("0").partition(".")[2]))
    return f"{step:g}", *(NO_VALUE if value is None else f"{value:.{places}f}" for value in values)
