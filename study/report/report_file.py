"""The report of one or several results as one HTML file that needs no network.

It is made of results, V-H checks, wear and load cases, told apart by what they hold. A V-H check has a table and its
prints at toe, middle and heel, and over the grid of V and H.
"""

from __future__ import annotations

import base64
import html
import io
import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import ordered
from ...core.checks import instance
from ...core.errors import InputError, printable
from ...core.output_file import whole_file
from ...friction.operation import named_models
from ..analysis.key_numbers import deviations, model_name, modification
from ..plot.matplotlib_defaults import drawing
from ..plot.panel_grid import evenly_chosen, middle
from ..plot.tooth_view import tooth_view
from ..plot.written_pictures import draw_picture, pictures as pictures_of
from ..result import ACCEPTED, DAMAGED, FAULT_COUNT_LIMIT, GRID, faults, kind_of, require_kind, require_layout
from ..summary import curves
from ..summary.assembly import deflection_tables, misalignment_words, supports_tables
from ..summary.quantities import roughness_words
from ..summary.result_summary import head_rows, result_notes
from ..summary.sweep_report import (
    SIGNS,
    failure_reasons,
    outcome,
    places_table,
    reasons,
    sweep_head,
    sweep_tables,
    sweep_title,
    totals,
)
from ..summary.table import with_signs
from ..sweep.sweep_file import checked_sweep
from . import page_data, report_tables
from .contact_mesh import mesh_scene, stored_case
from .page_data import packed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RESULT_COUNT_LIMIT = 6  # with pictures in one report


@dataclass(frozen=True)
class GivenResults:
    """Parts of a report by name."""

    results: dict[str, xr.DataTree] = field(default_factory=dict)  # those of load cases among them
    checks: dict[str, xr.Dataset] = field(default_factory=dict)
    wear: dict[str, xr.Dataset] = field(default_factory=dict)
    load_cases: dict[str, xr.DataTree] = field(default_factory=dict)  # for their tables
    sweeps: dict[str, xr.Dataset] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)  # on what the report has no pictures of

    @classmethod
    def of(cls, given: Mapping[str, xr.DataTree | xr.Dataset]) -> GivenResults:
        """Parts of what is given by name, which must be results, and not too many."""
        parts = cls()
        joined = {}
        for name, one in given.items():
            kind = kind_of(one)
            if isinstance(one, xr.Dataset) and kind == "sweep":
                parts.sweeps[printable(name)] = checked_sweep(one, name)
            elif isinstance(one, xr.DataTree):
                if "load_cases" in one.children:
                    parts.load_cases[printable(name)] = joined[name] = one
                elif "loaded" in one.children:
                    _require_whole(name, one)
                    parts.results[printable(name)] = one
                else:
                    raise InputError(f"{name}: must be a result of {ACCEPTED}")
            else:
                require_kind(name, kind)
                require_layout(name, one, kind)
                (parts.checks if kind == "V-H check" else parts.wear)[printable(name)] = one
        if not len(parts.results) <= RESULT_COUNT_LIMIT or not given:
            raise InputError(
                f"results = {len(parts.results)} results: must be 1 to {RESULT_COUNT_LIMIT} for one report, and V-H "
                "checks, wear and sweeps besides"
            )
        for name, one in joined.items():
            parts._take_load_cases(name, one, alone=len(given) == 1)
        return parts

    def _take_load_cases(self, name: str, tree: xr.DataTree, *, alone: bool) -> None:
        """Take results of load cases, those of the greatest pressure if there is no room for all."""
        cases = dict(tree.children["results"].children) if "results" in tree.children else {}
        room = RESULT_COUNT_LIMIT - len(self.results)
        peaks = {
            case: float(np.nanmax([*np.ravel(one["loaded"]["max_pressure"]), -1.0])) for case, one in cases.items()
        }
        for case, one in cases.items():
            _require_whole(f"{name}, {case}", one)
        chosen = sorted(cases, key=lambda case: -peaks[case])[:room]
        for case in cases:
            if case in chosen:
                self.results[printable(case if alone else f"{name}, {case}")] = cases[case]
        if len(chosen) < len(cases):
            self.notes.append(
                f"{printable(name)}: pictures of {len(chosen)} of {len(cases)} load cases, those of the greatest "
                f"pressure; the table has all of them."
            )


def by_name(results: Sequence[xr.DataTree | xr.Dataset]) -> dict[str, xr.DataTree | xr.Dataset]:
    """Results by what distinguishes them: title, flank, misalignment, torques and so on; else by flank and a number."""
    words = [_distinctions(one) for one in results]
    names = [each["kind"] for each in words]
    for key in words[0] if words else ():
        if len(set(names)) < len(names) or not all(names):
            of_kinds = {
                each["kind"]: {other[key] for other in words if other["kind"] == each["kind"]} for each in words
            }
            told = [each[key] if len(of_kinds[each["kind"]]) > 1 else "" for each in words]
            names = [", ".join(filter(None, both)) for both in zip(names, told, strict=True)]
    names = [name or each["flank"] for name, each in zip(names, words, strict=True)]
    if len(set(names)) < len(names):
        names = [f"{number}: {name}" for number, name in enumerate(names, 1)]
    return dict(zip(names, results, strict=True))


def _distinctions(one: xr.DataTree | xr.Dataset) -> dict[str, str]:
    """What results may differ by, in words, the most telling first."""
    attributes, torques = one.attrs, np.zeros(0)
    if isinstance(one, xr.DataTree) and "loaded" in one.children:
        torques = np.asarray(one["loaded"]["torque"].values)
    span = f"{torques.min():g} to {torques.max():g} N m" if torques.size > 1 else "".join(f"{t:g} N m" for t in torques)
    return {
        "title": printable(str(attributes.get("title", ""))),
        "flank": printable(str(attributes.get("flank", ""))),
        "misalignment": misalignment_words(attributes) or "aligned",
        "supports": printable(str(attributes.get("supports_name", ""))),
        "deviations": deviations(attributes),
        "modification": modification(attributes) and "modified",
        "model": model_name(attributes),
        "torques": span,
        "kind": "" if kind_of(one) in ("result", "other") else kind_of(one),
    }


def _require_whole(name: str, tree: xr.DataTree) -> None:
    """Refuse a result that lacks something, or has it in another form."""
    defects = faults(tree)
    if defects:
        words = "; ".join(defects[:FAULT_COUNT_LIMIT])
        raise InputError(f"{name} {DAMAGED}: {words}; make it anew with 'easeoff run' or 'easeoff modify'")


COARSER = 2  # prints of the grid, which are drawn small
MARGIN = 0.04  # around a print, of its length


def vh_part(name: str, check: xr.Dataset) -> dict[str, Any]:
    """V-H check for the page."""
    plane = ordered(check, "in_plane", "plane_axis", *GRID)
    (left, bottom), (right, top) = plane.min(axis=(1, 2)), plane.max(axis=(1, 2))
    margin = MARGIN * (right - left)
    window = [left - margin, right + margin, bottom - margin, top + margin]
    return {
        "name": name,
        "title": str(check.attrs.get("title", "")),
        "flank": str(check.attrs.get("flank", "")),
        "thickness": float(check.attrs.get("separation", np.nan)),
        "flanks": {"gear": {"plane": _bilinear(plane).tolist(), "window": window, "common": []}},
        "table": places_table(check).page(),
        "total": "; ".join([totals(check), *SIGNS]),
        "reasons": reasons(check),
        "places": [_place(check.sel(place=place)) for place in check["place"].values],
        "grid": _grid(check) if "grid_print_excess" in check else None,
    }


def _bilinear(plane: Array) -> Array:
    """Coefficients (2, 4) of 1, t, h and t h of a bilinear grid (2, m, n), from its corners."""
    first, along, up, both = plane[:, 0, 0], plane[:, -1, 0], plane[:, 0, -1], plane[:, -1, -1]
    return np.stack([first, along - first, up - first, both - along - up + first], axis=1)


def _place(one: xr.Dataset) -> dict[str, Any]:
    excess = ordered(one, "print_excess", *GRID)
    return {
        "name": str(one["place"].values),
        "v": _finite(one["v"]),
        "h": _finite(one["h"]),
        "print": _print(excess),
        "wanted": [_finite(one[f"place_{name}"]) for name in GRID],
        "centre": [_finite(one[f"pattern_centre_{name}"]) for name in GRID],
    }


def _grid(check: xr.Dataset) -> dict[str, Any]:
    """Prints over V and H, row by row of H from the greatest one down."""
    prints = ordered(check, "grid_print_excess", "v_grid", "h_grid", *GRID)
    centre = [ordered(check, f"grid_pattern_centre_{name}", "v_grid", "h_grid") for name in GRID]
    drawn = prints[..., ::COARSER, ::COARSER]
    cells = [
        [
            {"print": _print(drawn[i, j]), "centre": [_finite(values[i, j]) for values in centre]}
            for i in range(prints.shape[0])
        ]
        for j in reversed(range(prints.shape[1]))
    ]
    return {"v": check["v_grid"].values.tolist(), "h": check["h_grid"].values[::-1].tolist(), "cells": cells}


def _print(excess: Array) -> dict[str, Any] | None:
    """Gap minus thickness of the compound, so negative in the print; ``None`` where the flanks do not meet."""
    return packed(np.clip(excess, -1.0, 1.0)) if np.any(np.isfinite(excess)) else None


def _finite(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None


TORQUE_COUNT, SPEED_COUNT = 12, 9  # with pictures of the flanks, of all results together
TORQUE_LIMIT, SPEED_LIMIT = 6, 3  # with pictures of the flanks, of each result
HISTORY_TIME = re.compile(r"^(\d{4}-\d\d-\d\d)T(\d\d:\d\d)\S*Z")
PARTS = ("reading.js", "charts.js", "flanks.js", "teeth.js", "page.js")

#: Nothing may be loaded from anywhere.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
Given = xr.DataTree | xr.Dataset


def write_report(
    results: Given | Sequence[Given] | Mapping[str, Given],
    path: str | os.PathLike[str],
    *,
    author: str = "",
    limits: Sequence[str] = (),
) -> None:
    """Write the report of one or several results: tables, charts, flank pictures and turnable teeth in one HTML file.

    Parameters
    ----------
    results
        One or up to six results of ``analyze``, ``modify``, ``optimize`` or ``read_result``; by the name that the
        report gives them, or in a sequence, of which the report takes what distinguishes them: title, flank, torques...
        Of one of load cases, those of the greatest pressure have pictures, and all are in a table. V-H checks of
        ``study.vh_check``, histories of ``study.wear`` and sweeps may be among them, or alone.
    path
        File to write, replaced if it exists; missing folders are made.
    author
        Who made the report, for its head.
    limits
        Limits of its numbers, such as ``max_pressure<=1500`` or ``efficiency>=96``, in the units of the report.

    Raises
    ------
    InputError
        If a limit has another form, there is no result or too many, one is none of these, or the file cannot be
        written.

    Examples
    --------
    >>> import easeoff
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> with TemporaryDirectory() as folder:
    ...     write_report(tree, f"{folder}/report.html")
    ...     Path(f"{folder}/report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    True
    """
    instance("author", author, str)
    given = [results] if isinstance(results, xr.DataTree | xr.Dataset) else results
    instance("results", given, Mapping | list | tuple)
    for one in given.values() if isinstance(given, Mapping) else given:
        instance("one of the results", one, xr.DataTree | xr.Dataset)
    named = given if isinstance(given, Mapping) else by_name(given)
    text = report_page(named, author, limits)
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def report_page(results: Mapping[str, Given], author: str = "", limits: Sequence[str] = ()) -> str:
    """Text of the page with results by name, who made it, and limits of its numbers."""
    given = GivenResults.of(results)
    compared = report_tables.limit_table(limits, given.results)
    data: dict[str, Any] = {
        "results": [_content(name, tree, len(given.results)) for name, tree in given.results.items()],
        "checks": [vh_part(name, check) for name, check in given.checks.items()],
        "wear": [page_data.wear_part(name, worn) for name, worn in given.wear.items()],
        "load_cases": [{"name": name, **report_tables.load_case_rows(tree)} for name, tree in given.load_cases.items()],
        "sweeps": [sweep_part(name, swept) for name, swept in given.sweeps.items()],
        "limits": None if compared is None else compared.page(),
        "notes": given.notes,
    }
    title = " · ".join(dict.fromkeys(str(one.attrs.get("title", "")) for one in results.values()))
    version = next(iter(results.values())).attrs.get("easeoff_version", "")
    data |= {"title": printable(title), "version": printable(str(version)), "author": printable(author)}
    try:  # "<" would end the element that holds the data, or open a comment
        text = json.dumps(data, allow_nan=False, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    except ValueError as error:
        words = "a number that every result has is not finite; make it anew with 'easeoff run'"
        raise InputError(f"{', '.join(results)}: {words}") from error
    folder = resources.files(__package__) / "web"
    style = folder.joinpath("page.css").read_text(encoding="utf-8")
    script = "\n".join(folder.joinpath(name).read_text(encoding="utf-8") for name in PARTS)
    heading = html.escape(f"Contact report: {data['title']}")
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{heading}</title>\n'
        f"<style>\n{style}</style></head>\n<body><noscript>This report draws its tables and pictures by JavaScript, "
        f"which is switched off here.</noscript>\n"
        f'<script type="application/json" id="data">{text}</script>\n<script>\n"use strict";\n{script}</script>\n'
        f"</body></html>\n"
    )


def sweep_part(name: str, swept: xr.Dataset) -> dict[str, Any]:
    """Sweep for the page: head, tables, and pictures as they are in its files."""
    with drawing(None):
        pictures = [_embedded(draw_picture(swept, picture)) for picture in pictures_of(swept)]
    return {
        "name": name,
        "title": sweep_title(swept),
        "head": [[left, with_signs(right)] for left, right in sweep_head(swept)],
        "outcome": outcome(swept),
        "reasons": failure_reasons(swept),
        "tables": [table.page() for table in sweep_tables(swept)],
        "pictures": pictures,
    }


def _embedded(figure: Figure) -> str:
    """A figure as the address of a picture that it holds itself."""
    stream = io.BytesIO()
    figure.savefig(stream, format="svg")
    return f"data:image/svg+xml;base64,{base64.b64encode(stream.getvalue()).decode()}"


def _content(name: str, tree: xr.DataTree, count: int) -> dict[str, Any]:
    """Everything that the page shows of one result."""
    case = stored_case(tree)
    loaded = tree["loaded"].to_dataset()
    under_load = report_tables.loaded_numbers(tree, case)
    views = (tooth_view(tree), tooth_view(tree, "pinion"))
    chosen = evenly_chosen(loaded["torque"].values, min(TORQUE_LIMIT, max(2, TORQUE_COUNT // count)))
    radius = None if case is None else report_tables.mean_pitch_radius(case)
    content: dict[str, Any] = {
        "name": name,
        "title": printable(str(tree.attrs["title"])),
        "flank": str(tree.attrs["flank"]),
        "head": [[left, with_signs(printable(right))] for left, right in [*head_rows(tree), *_analysed(tree)]],
        "notes": [with_signs(printable(note)) for note in result_notes(tree)],
        "misalignment": [table.page() for table in deflection_tables(tree)],
        "case": [] if case is None else report_tables.case_tables(case),
        "unloaded_numbers": report_tables.unloaded_numbers(tree),
        "loaded_numbers": under_load,
        "supports": [table.page() for table in supports_tables(tree)],
        "deviations": page_data.deviation_fields(tree, case, views),
        "modification": page_data.modification_part(tree),
        "teeth": int(tree.attrs["pinion_teeth"]),
        "torques": loaded["torque"].values[chosen].tolist(),
        "torque_count": loaded.sizes["torque"],
        "positions": loaded["mesh_position"].values.tolist(),
        "flanks": page_data.outlines(views),
        "fields": page_data.surface_fields(tree, views),
        "marks": page_data.unloaded_marks(tree, views),
        "pressure": page_data.pressure_fields(loaded, chosen, views),
        "segments": page_data.segments(loaded, chosen, views),
        "charts": {
            "error": curves.transmission_error_charts(tree["unloaded"].to_dataset(), loaded, chosen, radius),
            "contact": curves.contact_charts(tree, chosen),
        },
        "over_torque": page_data.over_torque(tree),
        "scene": None if case is None else mesh_scene(tree, case),
        "friction": None,
    }
    condition = None
    if "supports" in tree.children:
        content["charts"]["supports"] = curves.supports_charts(tree, chosen)
    if "root_stress" in tree.children:
        content["charts"]["root"] = curves.root_stress_charts(tree["root_stress"].to_dataset(), chosen)
    if "friction" in tree.children:
        friction = tree["friction"].to_dataset()
        speeds = evenly_chosen(friction["speed"].values, min(SPEED_LIMIT, max(1, SPEED_COUNT // count)))
        at = {key: middle(friction[key].values) for key in ("temperature", "roughness")}
        all_at = {"speed": middle(friction["speed"].values), **at}
        condition = {key: float(friction[key].values[number]) for key, number in all_at.items()}
        content["charts"]["friction"] = curves.friction_charts(tree, chosen, all_at)
        content["friction"] = {
            "models": printable(named_models(friction.attrs)),
            "condition": condition | {"roughness": roughness_words(friction, at["roughness"])},
            "speeds": friction["speed"].values[speeds].tolist(),
            "fields": page_data.friction_fields(tree, chosen, speeds, at, views[0]),
            "map": page_data.efficiency_map(friction, at),
            "table": report_tables.efficiency_rows(friction, loaded),
        }
    content["charts"] = {part: list(map(page_data.packed_chart, charts)) for part, charts in content["charts"].items()}
    content["first_numbers"] = report_tables.first_numbers(tree, under_load, condition)
    return content


def _analysed(tree: xr.DataTree) -> list[tuple[str, str]]:
    """Time and version of a result's analysis, from its history."""
    history = str(tree.attrs.get("history", "")).splitlines()
    if not history or not history[-1].strip():
        return []
    return [("analysed", HISTORY_TIME.sub(r"\1 \2 UTC,", history[-1]))]
