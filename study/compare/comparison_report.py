"""Comparison report in Markdown: machine and versions, certified answers, run time, residuals, failures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...contact.problem.certificate import EXACT_TOLERANCE
from ...core.checks import shown
from ...core.errors import InputError
from ...core.reading.json_text import parsed_json
from ...core.writing.output_file import whole_file
from .attempt import SETTINGS
from .comparison_statistics import RUN_TIME_SHIFT, by_problem, growth, methods, of_method, shifted_geometric_mean
from .comparison_table import RESIDUALS

Method = tuple[str, str, str]

#: Problems that a line of failures names.
NAMED_PROBLEM_LIMIT = 3


def comparison_report(dataset: xr.Dataset, pictures: Sequence[str] = ()) -> str:
    """Report of a comparison, in Markdown.

    Parameters
    ----------
    dataset
        Result of ``compare``.
    pictures
        Names of the picture files beside the report with their captions: ``name.png|caption``.
    """
    problems = by_problem(dataset)
    named = methods(problems)
    parts = [
        "# Comparison of solvers\n",
        _subject(dataset, problems),
        "## Made with\n",
        _made_with(dataset, named),
        "## Who was right\n",
        _success(dataset, problems, named),
        *_by_kind(problems, named),
        "## Run time\n",
        _run_time(dataset, problems, named),
        *(f"![{caption}]({name})\n" for name, _, caption in (picture.partition("|") for picture in pictures)),
        "## Residuals\n",
        _residuals(dataset, named),
        "## Failures\n",
        _failures(dataset, named),
    ]
    return "\n".join(parts)


def write_report(dataset: xr.Dataset, folder: Path, pictures: Sequence[str] = ()) -> Path:
    """Write the report as ``report.md``; returns its path."""
    path = folder / "report.md"
    with whole_file(path) as temporary:
        temporary.write_text(comparison_report(dataset, pictures), encoding="utf-8")
    return path


def _subject(dataset: xr.Dataset, problems: Any) -> str:
    unique = problems.drop_duplicates(["problem_file", "problem"])
    sizes = unique["size"]
    lines = [
        f"- {len(group)} contact problems of `{file}`, {_range(group['size'])} segments"
        for file, group in unique.groupby("problem_file", sort=False)
    ]
    lines.append(
        f"- In all {len(unique)} problems, {_range(sizes)} segments, {_count(dataset.sizes['attempt'], 'attempt')}"
    )
    return "\n".join(lines) + "\n"


def _made_with(dataset: xr.Dataset, named: list[Method]) -> str:
    machine, versions = (_table_of(dataset, name) for name in ("machine", "solver_versions"))
    lines = _table(["what", "which"], [*machine.items(), *((f"solver `{s}`", v) for s, v in versions.items())])
    used = [name for name in SETTINGS if any(settings == name for _, settings, _ in named)]
    meanings = "\n".join(f"- `{name}`: {SETTINGS[name]}" for name in used)
    return (
        f"{lines}\nOne BLAS thread, a process for each solver, up to {dataset.attrs['repetitions']} repetitions, time "
        f"limit {dataset.attrs['time_limit_s']:g} s an attempt. Settings:\n\n{meanings}\n\n`native` has no other than "
        "`default`, and needs no polish. It is also the reference of the error of rotation.\n"
    )


def _table_of(dataset: xr.Dataset, name: str) -> dict[str, Any]:
    """Table in an attribute, as JSON; InputError if it holds none."""
    try:
        table = parsed_json(str(dataset.attrs.get(name, "{}")))
    except ValueError:
        table = None
    if not isinstance(table, dict):
        raise InputError(f"attribute {name} = {shown(dataset.attrs[name])}: must be a table in JSON")
    return table


def _success(dataset: xr.Dataset, problems: Any, named: list[Method]) -> str:
    rows = []
    for method in named:
        found = of_method(problems, method)
        rows.append(
            [
                *method,
                len(found),
                int(found["claims"].sum()),
                int(found["certified"].sum()),
                f"{100.0 * found['certified'].mean():.4g}",
                int(found["exact"].sum()),
                int(found["polished"].sum()),
                int(found["false_claim"].sum()),
                int(found["denied"].sum()),
            ]
        )
    tolerance = dataset.attrs["tolerance"]
    kinds = ["problems", "says solved", "certified", "%", "exact", "polished", "false claims", "denied"]
    head = ["solver", "settings", "start", *kinds]
    return (
        f"{_table(head, rows)}\n*Certified*: the largest violation of a condition on the problem as it was given is "
        f"at most {tolerance:g}, *exact*: at most {EXACT_TOLERANCE:g}, in every repetition. *Polished*: the answer is "
        "that of one exact solve on the active set the solver found, which can also save a poor one. *False claim*: "
        "says solved, but is not certified. *Denied*: certified, but does not say solved.\n"
    )


def _by_kind(problems: Any, named: list[Method]) -> list[str]:
    """Certified problems by kind, where the files have kinds."""
    kinds = [kind for kind in dict.fromkeys(problems["kind"]) if kind]
    if not kinds:
        return []
    rows = []
    for method in named:
        found = of_method(problems, method)
        of_kind = [found[found["kind"] == kind]["certified"] for kind in kinds]
        rows.append([*method, *(f"{int(one.sum())} of {len(one)}" for one in of_kind)])
    return ["Certified, by kind of problem:\n", _table(["solver", "settings", "start", *kinds], rows)]


def _run_time(dataset: xr.Dataset, problems: Any, named: list[Method]) -> str:
    limit = float(dataset.attrs["time_limit_s"])
    rows = []
    for method in named:
        found = of_method(problems, method)
        times = found["run_time"].to_numpy(dtype=float)
        solved = times[np.isfinite(times)]
        quantiles = [_ms(value) for value in np.quantile(solved, [0.5, 0.9, 1.0])] if solved.size else ["-"] * 3
        mean = shifted_geometric_mean(np.where(np.isfinite(times), times, limit), RUN_TIME_SHIFT)
        fit = growth(found["size"].to_numpy(dtype=float), times)
        rows.append([*method, _ms(mean), *quantiles, "-" if fit is None else f"{fit[1]:.2f}"])
    head = ["solver", "settings", "start", "mean [ms]", "median [ms]", "90 % [ms]", "longest [ms]", "exponent"]
    return (
        f"{_table(head, rows)}\n*Mean*: shifted geometric mean over the problems, shift {1e3 * RUN_TIME_SHIFT:g} ms, "
        "each with the median of its repetitions; one that is not certified counts with the time limit, "
        f"{1e3 * limit:g} ms. The other columns are over certified problems. *Exponent*: power of the number of "
        "segments with which the run time grows over the larger half of the sizes; a dash where they are too few or "
        "too close together.\n"
    )


def _residuals(dataset: xr.Dataset, named: list[Method]) -> str:
    frame: Any = dataset.to_dataframe()
    rows: list[list[Any]] = []
    parts: list[list[Any]] = []
    for method in named:
        found = of_method(frame, method)
        rows.append(
            [
                *method,
                int(found["worst_residual"].notna().sum()),
                *_quantiles(found["worst_residual"]),
                *_quantiles(found["rotation_error"]),
            ]
        )
        parts.append([*method, *(_quantiles(found[name])[2] for name in RESIDUALS)])
    kinds = ["median", "90 %", "worst"]
    head = [*("solver", "settings", "start", "answers"), *kinds, *(f"rotation, {kind}" for kind in kinds)]
    return (
        f"{_table(head, rows)}\nLargest entry of the certificate, and relative error of the rotation beyond first "
        "contact, over all attempts with an answer, certified or not. Which condition is violated, at worst:\n\n"
        f"{_table(['solver', 'settings', 'start', *(name.replace('_', ' ') for name in RESIDUALS)], parts)}"
    )


def _failures(dataset: xr.Dataset, named: list[Method]) -> str:
    frame: Any = dataset.to_dataframe()
    rows = []
    for method in named:
        found = of_method(frame, method)
        failed = found[found["certified"] == 0]
        for (claim, message), group in failed.groupby(["claim", "message"], sort=False):
            words = str(message).replace("|", "/").replace("`", "'")
            problems = group.drop_duplicates(["problem_file", "problem"])
            rows.append([*method, claim, words, len(group), len(problems), _which(problems)])
    if not rows:
        return "None: every attempt is certified.\n"
    head = ["solver", "settings", "start", "says", "its words", "attempts", "problems", "which"]
    return f"{_table(head, rows)}\nAttempts that are not certified.\n"


def _which(problems: Any) -> str:
    """First few problems, by name or else by number."""
    few = [
        row.problem_name or f"{row.problem_file} {row.problem}"
        for row in problems.head(NAMED_PROBLEM_LIMIT).itertuples()
    ]
    return ", ".join(few) + (", ..." if len(problems) > NAMED_PROBLEM_LIMIT else "")


def _table(head: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    from tabulate import tabulate

    return str(tabulate(rows, head, tablefmt="github", disable_numparse=True)) + "\n"


def _quantiles(values: Any) -> list[str]:
    known = values.dropna().to_numpy(dtype=float)
    return [f"{value:.1e}" for value in np.quantile(known, [0.5, 0.9, 1.0])] if known.size else ["-"] * 3


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.3g}" if seconds < 1.0 else f"{1e3 * seconds:.0f}"


def _range(sizes: Any) -> str:
    low, high = int(sizes.min()), int(sizes.max())
    return f"{low}" if low == high else f"{low} to {high}"


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
