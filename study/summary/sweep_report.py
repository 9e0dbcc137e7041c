"""Reports of sweeps, wear and V-H checks, as text.

That of a sweep has its points, percentiles of the main numbers, sensitivities and worst points; that of wear has
revolutions and steps, greatest depths, and the transmission error before and after.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import xarray as xr

from ...core.errors import InputError, printable
from ...geometry.pair.gear_pair import MEMBERS
from ..result import PATTERN
from ..sweep.reductions import LOADS, numbers, percentiles, sensitivities, swept_names, worst_points
from ..sweep.sweep_file import PointStatus
from .assembly import error_values
from .quantities import LOADED, TABLES, WEAR_DEPTH, with_percent
from .table import Table, filled, underlined

#: Numbers that are shown, where a sweep has them.
MAIN_NUMBERS: list[str] = TABLES["lists"]["of_sweeps"]
SENSITIVE_NUMBERS = ("peak_to_peak", "max_pressure", "pattern_centre_lengthwise")
SHOWN_PERCENT = (0.0, 5.0, 50.0, 95.0, 100.0)
SHOWN_LOADS = 3  # torques, and combinations of conditions, that tables show one by one
REASON_COUNT_LIMIT = 5
WORST_NUMBER, WORST_COUNT = "max_pressure", 3
SENSITIVITY_NOTE = (
    "scale: standard deviation of the samples, or half the range of the grid; effect: change of the number with one "
    "scale of the coordinate; slope: change with one unit of it"
)


def outcome(dataset: xr.Dataset) -> str:
    """Outcome of a sweep in one line: number of points that are certified, and of others by their end."""
    status = dataset["status"].values
    counts = {one: int(np.count_nonzero(status == one)) for one in PointStatus}
    said = [f"{counts[PointStatus.CERTIFIED]} of {status.size} points certified"]
    said += [
        f"{count} {one.name.lower().replace('_', ' ')}"
        for one, count in counts.items()
        if count and one != PointStatus.CERTIFIED
    ]
    return ", ".join(said)


def sweep_summary(dataset: xr.Dataset) -> str:
    """Summary of a sweep, from ``sweep`` or ``read_sweep``."""
    head = "\n".join(f"{name:<13} {words}" for name, words in sweep_head(dataset))
    parts = [underlined(sweep_title(dataset)), head, outcome(dataset)]
    if reasons := failure_reasons(dataset):
        parts.append(filled(reasons))
    return "\n\n".join([*parts, *(table.text() for table in sweep_tables(dataset))])


def sweep_title(dataset: xr.Dataset) -> str:
    """Title of the pair that is swept."""
    return printable(str(dataset.attrs.get("title", "untitled")))


def shown_numbers(dataset: xr.Dataset) -> list[str]:
    """Main numbers that a sweep has."""
    return [name for name in MAIN_NUMBERS if name in numbers(dataset) and bool(dataset[name].notnull().any())]


def sweep_tables(dataset: xr.Dataset) -> list[Table]:
    """Tables of a sweep: percentiles, sensitivities and worst points; none without a certified point."""
    known, dataset = shown_numbers(dataset), with_percent(dataset)
    if not known:
        return []
    return [_percentile_table(dataset, known), *_sensitivity_tables(dataset), *_worst(dataset)]


def sweep_head(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """Swept coordinates, then what was held: torques, conditions, flank and assembly errors; names and words."""
    swept = swept_names(dataset)
    rows = [(name, _values(dataset, name)) for name in swept]
    rows += [(name, _values(dataset, name)) for name in LOADS if name in dataset.coords and name not in swept]
    attrs = dataset.attrs
    if "flank" in attrs and "flank" not in swept:
        rows.append(("flank", f"{attrs['flank']}, held"))
    if errors := error_values(attrs):
        words = ", ".join(error.words(value, "+g" if value else ".0f") for error, value in errors.items())
        rows.append(("misalignment", f"{words}, held"))
    for name in ("deflections", "supports"):
        if said := str(attrs.get(name, "")):
            rows.append((name, printable(said)))
    if "seed" in attrs:
        sampler = f"{attrs.get('sampler', '')}, seed {attrs['seed']}: {attrs.get('distributions', '')}"
        rows.append(("samples", printable(sampler)))
    return rows


def _values(dataset: xr.Dataset, name: str) -> str:
    """Values of a coordinate in words; of a single one that it was held."""
    values, units = dataset[name].values, dataset[name].attrs.get("units", "")
    units = "" if units == "1" else f" {units}"
    if name not in swept_names(dataset) and values.size == 1:
        return printable(f"{values.ravel()[0]:.6g}{units}, held")
    over = dataset[name].dims[0] if dataset[name].dims else ""
    what = "values" if over == name else f"{str(over).replace('_', ' ')}s"
    if values.dtype.kind == "f":
        return printable(f"{values.size} {what} from {values.min():.6g} to {values.max():.6g}{units}")
    more = " ..." * (values.size > SHOWN_LOADS)
    return printable(f"{values.size} {what}: {', '.join(map(str, values[:SHOWN_LOADS]))}{more}")


def failure_reasons(dataset: xr.Dataset) -> list[str]:
    """The most frequent reasons of failures, a line each."""
    counts = Counter(str(reason) for reason in dataset["reason"].values.ravel() if reason)
    lines = [f"{count} x {printable(reason)}" for reason, count in counts.most_common(REASON_COUNT_LIMIT)]
    left = len(counts) - len(lines)
    return lines + [f"... and {left} more reasons in the variable reason"] * (left > 0)


def _cases(variable: xr.DataArray) -> list[tuple[dict[Any, int], str]]:
    """Selections of torque and conditions to show one by one, with their words; of many the first and the last."""
    dims = [dim for dim in variable.dims if dim in LOADS]
    sizes = [variable.sizes[dim] for dim in dims]
    places = list(np.ndindex(*sizes))
    if len(places) > SHOWN_LOADS:
        places = [places[0], places[-1]]
    cases = []
    for place in places:
        words = ", ".join(
            f"{variable[dim].values[i]:g} {variable[dim].attrs.get('units', '')}"
            for dim, i in zip(dims, place, strict=True)
        )
        cases.append((dict(zip(dims, place, strict=True)), words))
    return cases


def _percentile_table(dataset: xr.Dataset, names: list[str]) -> Table:
    reduced = percentiles(dataset, SHOWN_PERCENT, names)
    rows = []
    for name in names:
        for at, words in _cases(reduced[name]):
            values = reduced[name].isel(at)
            extra = [dim for dim in values.dims if dim != "percentile"]
            shown = values.isel(dict.fromkeys(extra, 0)).values
            rows.append([name, reduced[name].attrs.get("units", ""), words, *(f"{value:.4g}" for value in shown)])
    heads = ["number", "unit", "at", "least", "5 %", "median", "95 %", "greatest"]
    return Table(heads, rows, 3, "Percentiles over the points")


def _sensitivity_tables(dataset: xr.Dataset) -> list[Table]:
    """Tables of first-order sensitivities, one a number; the first says what the columns are."""
    tables: list[Table] = []
    for name in SENSITIVE_NUMBERS:
        try:
            sensitivity = sensitivities(dataset, name)
        except InputError:
            continue
        at, words = _cases(sensitivity["effect"])[-1]
        chosen = sensitivity.isel(at)
        units = str(dataset[name].attrs.get("units", "1"))
        rows: list[list[str]] = []
        for i in np.argsort(-np.abs(np.nan_to_num(chosen["effect"].values))):
            coordinate = str(chosen["coordinate"].values[i])
            unit = str(dataset[coordinate].attrs.get("units", "1"))
            names = ("scale", "effect", "slope", "variance_share")
            scale, effect, slope, share = (chosen[one].values[i] for one in names)
            sizes = [f"{scale:.3g} {unit}".removesuffix(" 1"), f"{effect:+.3g} {units}".removesuffix(" 1")]
            part = "" if np.isnan(share) else f"{100 * share:.0f} %"
            rows.append([coordinate, *sizes, f"{slope:+.4g} {_per(units, unit)}".rstrip(), part])
        heads = ["coordinate", "scale", "effect", "slope", "of variance"]
        if not any(row[-1] for row in rows):
            heads, rows = heads[:-1], [row[:-1] for row in rows]
        where = f" at {words}" if words else ""
        title = f"First-order sensitivities of {name}{where}"
        tables.append(Table(heads, rows, 1, title, "" if tables else SENSITIVITY_NOTE))
    return tables


def _per(units: str, unit: str) -> str:
    """Unit of a slope."""
    if unit in ("", "1"):
        return "" if units == "1" else units
    return f"{units}/{unit}" if "/" not in unit else f"{units}/({unit})"


def _worst(dataset: xr.Dataset) -> list[Table]:
    """Points with the greatest pressure."""
    name = WORST_NUMBER
    if name not in numbers(dataset):
        return []
    points = worst_points(dataset, name, WORST_COUNT)
    columns = list(dict.fromkeys(one for one in (*swept_names(dataset), "torque") if one in points))
    rows = [
        [*(_word(points[one].values[i]) for one in columns), f"{points[name].values[i]:.5g}"]
        for i in range(points.sizes["rank"])
    ]
    units = [dataset[one].attrs.get("units", "") if one in dataset else "" for one in (*columns, name)]
    heads = [
        f"{one} [{unit}]" if unit not in ("", "1") else one for one, unit in zip((*columns, name), units, strict=True)
    ]
    return [Table(heads, rows, len(columns), f"Points with the greatest {name}")]


def _word(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, float | np.floating) else printable(str(value))


def wear_summary(history: xr.Dataset) -> str:
    """Lines on a history of wear, those of ``easeoff wear`` and ``easeoff show``."""
    last = history.isel(step=-1)
    depths = ", ".join(f"{m} {WEAR_DEPTH.written(float(last['largest_depth'].sel(member=m)))} um" for m in MEMBERS)
    steps = history.sizes["step"] - 1
    lines = [
        f"{history.attrs.get('stop', 'ended')}, {float(last['revolutions']):.4g} revolutions in {steps} steps",
        f"{WEAR_DEPTH.label}: {depths}",
        "contact on lines alone, without tooth edges",
    ]
    if "deflections" in history.attrs:
        lines.append(f"deflections: {history.attrs['deflections']}")
    for torque in history["torque"].values:
        at = history.sel(torque=torque)
        first, final = (float(at["peak_to_peak"][step]) for step in (0, -1))
        lines.append(f"peak to peak at {torque:g} N m: {first:.1f} to {final:.1f} urad")
        pressures = [float(at["max_pressure"][step]) for step in (0, -1)]
        lines.append(f"greatest pressure at {torque:g} N m: {pressures[0]:.0f} to {pressures[1]:.0f} MPa")
    return "\n".join(lines)


HEADERS = ("", "V\nmm", "H\nmm", "centre at\ntoe, root %", "from, to\ntoe %", "height\n%", LOADED["peak_to_peak"])
VARIABLES = ("v", "h", *PATTERN[:2], "pattern_from", "pattern_to", PATTERN[3], "peak_to_peak")
#: What V and H are positive for, one phrase each.
SIGNS = ("V positive: the offset grows (E)", "H positive: pinion away from the crossing point (P)")


def vh_table(check: xr.Dataset) -> str:
    """V and H at toe, middle and heel with the patterns there, their totals, and why a place was not reached."""
    return "\n".join([places_table(check).text(), *reasons(check), "", totals(check)])


def places_table(check: xr.Dataset) -> Table:
    """V and H and the pattern, a row a place; of one that was not reached its name and these words alone."""
    rows: list[tuple[str, ...]] = []
    for place in check["place"].values:
        one = check.sel(place=place)
        value = {str(name): variable.item() for name, variable in one.data_vars.items() if not variable.ndim}
        if np.isnan(value["v"]):
            rows.append((str(place), "not reached", *[""] * (len(HEADERS) - 2)))
            continue
        along, up, first, last, height = (100.0 * value[name] for name in VARIABLES[2:7])
        pattern = (f"{along:.1f}, {up:.1f}", f"{first:.0f}, {last:.0f}", f"{height:.0f}")
        rows.append((str(place), f"{value['v']:+.3f}", f"{value['h']:+.3f}", *pattern, f"{value['peak_to_peak']:.1f}"))
    return Table(HEADERS, rows, variables=VARIABLES)


def reasons(check: xr.Dataset) -> list[str]:
    """Lines on the places that were not reached."""
    names = [f"reason_{place}" for place in check["place"].values]
    return [f"{name.removeprefix('reason_')}: {check.attrs[name]}" for name in names if name in check.attrs]


def totals(check: xr.Dataset) -> str:
    """Total V, total H and H/V in one line."""
    v, h, ratio = (float(check[name]) for name in ("total_v", "total_h", "h_over_v"))
    if np.isnan(v):
        return "toe to heel: unknown, as toe and heel were not both reached"
    return f"toe to heel: total V {v:+.3f} mm, total H {h:+.3f} mm, H/V {ratio:+.3f}"
