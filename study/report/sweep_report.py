"""Report of a sweep: its points, percentiles of the main numbers, sensitivities and worst points, as text."""

from __future__ import annotations

import textwrap
from collections import Counter
from typing import Any

import numpy as np
import xarray as xr
from tabulate import tabulate

from ...core.errors import InputError
from ...core.printable import printable
from ..sweep.batch_analysis import PointStatus
from ..sweep.reductions import LOADS, numbers, percentiles, sensitivities, swept_names, worst_points
from .summary.contact_tables import WIDTH

#: Numbers that are shown, where a sweep has them.
MAIN_NUMBERS = (
    "peak_to_peak",
    "max_pressure",
    "contact_ratio",
    "max_edge_share",
    "pattern_centre_lengthwise",
    "pattern_centre_profile",
    "pattern_length",
    "max_root_stress",
    "efficiency",
    "min_film_thickness",
    "max_flash_temperature",
)
SENSITIVE_NUMBERS = ("peak_to_peak", "max_pressure", "pattern_centre_lengthwise")
SHOWN_PERCENT = (0.0, 5.0, 50.0, 95.0, 100.0)
SHOWN_LOADS = 3  # torques, and combinations of conditions, that tables show one by one
REASON_COUNT_LIMIT = 5
WORST_COUNT = 3


def outcome(dataset: xr.Dataset) -> str:
    """Outcome of a sweep in one line: how many points are certified, and how the others ended.

    Examples
    --------
    >>> import easeoff
    >>> outcome(easeoff.sweep("nasa-12x36", {"E": [0.0, 0.05]}, torques=[100.0]))
    '2 of 2 points certified'
    """
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
    """Summary of a sweep.

    Parameters
    ----------
    dataset
        From ``sweep`` or ``read_sweep``.

    Examples
    --------
    >>> import easeoff
    >>> print(sweep_summary(easeoff.sweep("nasa-12x36", {"E": [0.0, 0.05]}, torques=[100.0])).splitlines()[3])
    E             2 values from 0 to 0.05 mm
    """
    title = textwrap.wrap(printable(str(dataset.attrs.get("title", "untitled"))), WIDTH) or ["untitled"]
    parts = ["\n".join(title), "=" * max(map(len, title)), "", _coordinates(dataset), "", outcome(dataset)]
    parts += _reasons(dataset)
    known = [name for name in MAIN_NUMBERS if name in numbers(dataset) and bool(dataset[name].notnull().any())]
    if known:
        parts += ["", "Percentiles over the points", "", _percentile_table(dataset, known)]
        parts += _sensitivity_tables(dataset)
        parts += _worst(dataset)
    return "\n".join(parts)


def _coordinates(dataset: xr.Dataset) -> str:
    """The swept coordinates, one a line."""
    lines = []
    for name in swept_names(dataset):
        values, units = dataset[name].values, dataset[name].attrs.get("units", "")
        units = "" if units == "1" else f" {units}"
        over = dataset[name].dims[0] if dataset[name].dims else ""
        what = "values" if over == name else f"{str(over).replace('_', ' ')}s"
        if values.dtype.kind == "f":
            said = f"{values.size} {what} from {values.min():.6g} to {values.max():.6g}{units}"
        else:
            said = f"{values.size} {what}: {', '.join(map(str, values[:SHOWN_LOADS]))}" + " ..." * (
                values.size > SHOWN_LOADS
            )
        lines.append(f"{name:<13} {printable(said)}")
    if "deflections" in dataset.attrs:
        lines.append(f"{'deflections':<13} {printable(str(dataset.attrs['deflections']))}")
    if "seed" in dataset.attrs:
        lines.append(
            f"{'samples':<13} {dataset.attrs.get('sampler', '')}, seed {dataset.attrs['seed']}: "
            f"{printable(str(dataset.attrs.get('distributions', '')))}"
        )
    return "\n".join(lines)


def _reasons(dataset: xr.Dataset) -> list[str]:
    """The most frequent reasons of failures."""
    found = Counter(str(reason) for reason in dataset["reason"].values.ravel() if reason)
    lines = [
        textwrap.fill(f"{count} x {printable(reason)}", WIDTH)
        for reason, count in found.most_common(REASON_COUNT_LIMIT)
    ]
    left = len(found) - len(lines)
    return [
        *([""] if lines else []),
        *lines,
        *([f"... and {left} more reasons in the variable reason"] if left > 0 else []),
    ]


def _cases(variable: xr.DataArray) -> list[tuple[dict[Any, int], str]]:
    """Selections of torque and conditions to show one by one, with their words; of many the first and the last."""
    dims = [dim for dim in variable.dims if dim in LOADS]
    sizes = [variable.sizes[dim] for dim in dims]
    places = list(np.ndindex(*sizes))
    if len(places) > SHOWN_LOADS:
        places = [places[0], places[-1]]
    found = []
    for place in places:
        words = ", ".join(
            f"{variable[dim].values[i]:g} {variable[dim].attrs.get('units', '')}"
            for dim, i in zip(dims, place, strict=True)
        )
        found.append((dict(zip(dims, place, strict=True)), words))
    return found


def _percentile_table(dataset: xr.Dataset, names: list[str]) -> str:
    reduced = percentiles(dataset, SHOWN_PERCENT, names)
    rows = []
    for name in names:
        for at, words in _cases(reduced[name]):
            values = reduced[name].isel(at)
            extra = [dim for dim in values.dims if dim != "percentile"]
            shown = values.isel(dict.fromkeys(extra, 0)).values
            rows.append((name, reduced[name].attrs.get("units", ""), words, *(f"{value:.4g}" for value in shown)))
    headers = ["number", "unit", "at", "least", "5 %", "median", "95 %", "greatest"]
    return tabulate(rows, headers=headers, disable_numparse=True, colalign=("left", "left", "left", *["right"] * 5))


def _sensitivity_tables(dataset: xr.Dataset) -> list[str]:
    """Tables of first-order sensitivities, one a number."""
    parts: list[str] = []
    for name in SENSITIVE_NUMBERS:
        try:
            found = sensitivities(dataset, name)
        except InputError:
            continue
        at, words = _cases(found["effect"])[-1]
        chosen = found.isel(at)
        order = np.argsort(-np.abs(np.nan_to_num(chosen["effect"].values)))
        rows: list[tuple[str, ...]] = []
        for i in order:
            share = chosen["variance_share"].values[i]
            unit = dataset[str(chosen["coordinate"].values[i])].attrs.get("units", "")
            scale = f"{chosen['scale'].values[i]:.3g} {unit}"
            effect, slope = chosen["effect"].values[i], chosen["slope"].values[i]
            rows.append(
                (
                    str(chosen["coordinate"].values[i]),
                    scale,
                    f"{effect:+.3g}",
                    f"{slope:+.4g}",
                    "" if np.isnan(share) else f"{100 * share:.0f} %",
                )
            )
        units = dataset[name].attrs.get("units", "")
        units = "" if units == "1" else f" [{units}]"
        headers = ["coordinate", "scale", f"effect{units}", "slope", "of variance"]
        if not any(row[-1] for row in rows):
            headers, rows = headers[:-1], [row[:-1] for row in rows]
        where = f" at {words}" if words else ""
        parts += ["", f"First-order sensitivities of {name}{where}", ""]
        parts.append(
            tabulate(rows, headers=headers, disable_numparse=True, colalign=("left", *["right"] * (len(headers) - 1)))
        )
    return parts


def _worst(dataset: xr.Dataset) -> list[str]:
    """Points with the greatest pressure."""
    name = "max_pressure"
    if name not in numbers(dataset):
        return []
    found = worst_points(dataset, name, WORST_COUNT)
    shown = [one for one in (*swept_names(dataset), "torque") if one in found]
    columns = list(dict.fromkeys(shown))
    rows = [
        (*(_word(found[one].values[i]) for one in columns), f"{found[name].values[i]:.5g}")
        for i in range(found.sizes["rank"])
    ]
    headers = [*columns, f"{name} [{dataset[name].attrs.get('units', '')}]"]
    return ["", f"Points with the greatest {name}", "", tabulate(rows, headers=headers, disable_numparse=True)]


def _word(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, float | np.floating) else printable(str(value))
