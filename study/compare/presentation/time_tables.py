"""Time tables: run time, its parts, starts, pairs of solvers, growth with size, work against precision."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ..measurement.method import COLD, HEADLINE, STARTING_SOLVERS, WARM, polishes_itself
from ..statistics.method_statistics import (
    METHOD_COLUMNS,
    MISS_FACTOR,
    PROBLEM_COLUMNS,
    PROCESSOR,
    TIMES,
    MethodName,
    headline,
    of_method,
    run_time_table,
    time_of,
)
from ..statistics.profiles import pairwise_matrix
from ..statistics.run_time_statistics import (
    RUN_TIME_SHIFT,
    SIZE_COUNT_MINIMUM,
    growth,
    shifted_geometric_mean,
    waiting_solvers,
)
from ..statistics.work_precision import WorkPrecision, sweep_points, work_precision
from .report_table import NOTHING, ReportTable, median, milliseconds, quantiles, ratio, residual

#: Factors at which the pairwise profile is tabulated.
PAIR_FACTORS = (0.5, 1.0, 2.0, 10.0)
#: Largest ratio of a size to the next smaller one where growth is measured.
LARGEST_SIZE_STEP = 10.0
#: Least ratio of the largest size to the smallest where growth is tabulated and drawn.
SIZE_SPAN_MINIMUM = 3.0
#: Every this many accuracies one is a column of the work-precision table.
ACCURACY_STEP = 2


def run_time_summary(dataset: xr.Dataset, problems: Any, named: list[MethodName]) -> ReportTable:
    """Run time of each method."""
    limit = float(dataset.attrs["time_limit_s"])
    rows = []
    for method in named:
        found = of_method(problems, method)
        times = found["run_time"].to_numpy(dtype=float)
        mean = shifted_geometric_mean(np.where(np.isfinite(times), times, limit), RUN_TIME_SHIFT)
        spread = quantiles(found["spread"][found["certified"]], (0.5, 0.9))
        rows.append([*method, *map(milliseconds, [mean, *quantiles(found["run_time"])]), *map(ratio, spread)])
    head = ["mean [ms]", "median [ms]", "90 % [ms]", "longest [ms]", "spread", "spread, 90 %"]
    note = (
        f"Time: {TIMES[time_of(dataset)]}. *Mean*: shifted geometric mean over the problems, shift "
        f"{1e3 * RUN_TIME_SHIFT:g} ms, each with the median of "
        "its repetitions; one that is not certified counts with the time limit, "
        f"{1e3 * limit:g} ms. The other columns are over certified problems. *Spread*: longest over shortest run time "
        "of the repetitions of a problem, its median and 90 % quantile; a dash where there is one repetition."
    )
    return ReportTable("run_time", [*METHOD_COLUMNS, *head], rows, note)


def waiting_note(dataset: xr.Dataset) -> str | None:
    """Warning that the machine was busy, naming the solvers that waited; None where none did."""
    waited = waiting_solvers(dataset)
    if not waited:
        return None
    named = ", ".join(f"{solver} {factor:.3g}" for solver, factor in waited.items())
    advice = "" if time_of(dataset) == PROCESSOR else "; measure anew, or compare by --time processor"
    return f"The machine was busy: median of wall over processor time, which is 1 on an idle one: {named}{advice}."


def time_parts(problems: Any, named: list[MethodName], sources: dict[MethodName, str]) -> ReportTable:
    """Medians of the parts of the run time, over certified problems."""
    rows = []
    for method in named:
        found = of_method(problems, method)
        found = found[found["certified"]]
        columns = ("wall_time", "processor_time", "call_time", "setup_time", "solve_time", "polish_time")
        whole = median(found["wall_time"] / found["call_time"])
        times = [milliseconds(median(found[name])) for name in columns]
        rows.append([*method, *times, ratio(whole), sources.get(method, "") or NOTHING])
    head = ["whole [ms]", "processor [ms]", "bare call [ms]", "set-up [ms]", "solve [ms]", "polish [ms]"]
    note = (
        "Medians over certified problems. *Whole*: wall time of the call through the package, with check, scaling, "
        "conversion, polish and certificate; *processor*: its processor time; *bare call*: wall time of the solver "
        "with its data in its form; *whole / bare*: median of their ratio. Set-up and solve are in the solver's own "
        "measurement where it has one (*by* solver), or else measured around them (interface)."
    )
    return ReportTable("time_parts", [*METHOD_COLUMNS, *head, "whole / bare", "by"], rows, note)


def time_sources(dataset: xr.Dataset, named: list[MethodName]) -> dict[MethodName, str]:
    """Who measured set-up and solve time, by method."""
    frame: Any = dataset.to_dataframe()
    return {
        method: ", ".join(source for source in dict.fromkeys(of_method(frame, method)["time_source"]) if source)
        for method in named
    }


def start_table(problems: Any, named: list[MethodName]) -> ReportTable | None:
    """Cold against warm starts, over the problems that have both; None where no problem has a warm start."""
    warm_methods = [method for method in named if method[2] == WARM]
    if not warm_methods:
        return None
    rows = []
    for solver, settings, _ in warm_methods:
        pair = [of_method(problems, (solver, settings, start)).set_index(PROBLEM_COLUMNS) for start in (COLD, WARM)]
        both = pair[1].join(pair[0].add_suffix("_cold"), how="inner")
        solved = both[both["certified"] & both["certified_cold"]]
        iterations = [median(solved[name][solved[name] >= 0]) for name in ("iterations_cold", "iterations")]
        rows.append(
            [
                solver,
                len(both),
                int(both["certified_cold"].sum()),
                int(both["certified"].sum()),
                milliseconds(median(solved["run_time_cold"])),
                milliseconds(median(solved["run_time"])),
                ratio(median(solved["run_time"] / solved["run_time_cold"])),
                *map(ratio, iterations),
            ]
        )
    ignoring = sorted({solver for solver, _, _ in named} - set(STARTING_SOLVERS))
    note = (
        "Problems with a problem of the same size before them in their file, whose answer is the warm start; times are "
        "medians over those certified both ways, *ratio* is the median of warm over cold."
    )
    if any(solver == "native" for solver, _, _ in warm_methods):
        note += (
            " Steps of `native` are those with all segments: from a cold start it has first made others with every "
            "fourth or sixteenth of them, which are not counted."
        )
    if ignoring:
        note += f" Not measured, because they take no start or ignore it: {', '.join(ignoring)}."
    head = ["solver", "problems", "certified, cold", "certified, warm", "cold [ms]", "warm [ms]", "ratio"]
    return ReportTable("starts", [*head, "iterations, cold", "iterations, warm"], rows, note)


def pair_table(problems: Any, named: list[MethodName]) -> ReportTable | None:
    """Pairwise profile of the headline methods; None where there is one alone."""
    chosen = headline(named)
    if len(chosen) < 2:
        return None
    times = run_time_table(problems, chosen).to_numpy(dtype=float).T
    shares = [pairwise_matrix(times, factor) for factor in PAIR_FACTORS]
    rows = [
        [first[0], second[0], *(f"{100.0 * share[i, j]:.1f}" for share in shares)]
        for i, first in enumerate(chosen)
        for j, second in enumerate(chosen)
        if i != j
    ]
    head = ["solver", "against", *(f"within {factor:g} [%]" for factor in PAIR_FACTORS)]
    note = (
        "Share of problems that the row certifies in at most the time of the column; what it alone certifies counts "
        "for it. Two solvers compare the same whichever others are in the comparison. `tables/pairs.csv` has the "
        "shares within half, twice and ten times that time, too."
    )
    return ReportTable("pairs", head, rows, note, in_report=False)


def growth_table(problems: Any, named: list[MethodName]) -> ReportTable | None:
    """Exponents of the growth of run time within each kind of problem; None where no kind has sizes enough."""
    groups = size_groups(problems)
    rows = []
    for method in headline(named):
        found = of_method(problems, method)
        fits = [
            growth(*(found[group_of(found) == group][name].to_numpy(dtype=float) for name in ("size", "run_time")))
            for group in groups
        ]
        rows.append([method[0], *(NOTHING if fit is None else f"{fit[1]:.2f}" for fit in fits)])
    if not any(cell != NOTHING for row in rows for cell in row[1:]):
        return None
    note = (
        "Power of the number of segments with which the run time grows within one kind of problem, over the larger "
        "half of its sizes; a dash where they are too few or too close together."
    )
    return ReportTable("growth", ["solver", *groups], rows, note)


def group_of(problems: Any) -> Any:
    """Group within which sizes are compared: the kind of a problem, or its file where it has none."""
    return problems["kind"].where(problems["kind"] != "", problems["problem_file"])


def size_groups(problems: Any) -> list[str]:
    """Groups with at least three sizes over a factor of three, none far from the next; the widest range first."""
    widths = {}
    for group, found in problems.groupby(group_of(problems), sort=False):
        sizes = np.unique(found["size"].to_numpy(dtype=float))
        if sizes.size >= SIZE_COUNT_MINIMUM and (sizes[1:] / sizes[:-1]).max() <= LARGEST_SIZE_STEP:
            widths[str(group)] = float(sizes[-1] / sizes[0])
    return sorted((name for name in widths if widths[name] >= SIZE_SPAN_MINIMUM), key=lambda name: -widths[name])


def work_precision_tables(dataset: xr.Dataset, named: list[MethodName]) -> list[ReportTable]:
    """Time and share of problems by certified accuracy, and the outcome at each tolerance."""
    rank = {method[0]: number for number, method in enumerate(headline(named))}
    curves = sorted(work_precision(dataset), key=lambda one: rank[one.solver])
    columns = range(1, curves[0].accuracy.size, ACCURACY_STEP)
    head = ["solver", *(f"{curves[0].accuracy[i]:.0e}" for i in columns)]
    rows = [[curve.solver, *(_work(curve, i) for i in columns)] for curve in curves]
    note = (
        "Median over the problems of the time [ms] of the fastest run with a certificate of at most that accuracy, a "
        "dash where half of the problems have none; in brackets the share of problems that have one. Runs: those of "
        "the sweep and of the headline."
    )
    points = [
        [
            point.solver,
            f"{point.tolerance:g}" if point.tolerance else "table",
            point.problems,
            point.claimed,
            point.missed if point.tolerance else NOTHING,
            residual(point.posed),
            residual(point.median),
            residual(point.worst),
            milliseconds(point.run_time),
        ]
        for point in sorted(sweep_points(dataset), key=lambda one: (rank[one.solver], -one.tolerance))
    ]
    counts, residuals = ["problems", "says solved", "misses it"], ["worst as posed", "median", "worst"]
    return [
        ReportTable("work_precision", head, rows, note),
        ReportTable(
            "sweep",
            ["solver", "tolerance", *counts, *residuals, "median time [ms]"],
            points,
            f"*Tolerance*: given to the solver; *table*: its settings of `{HEADLINE}`. Solvers without a tolerance "
            "have that row alone. *Misses it*: says solved, but primal residual, dual residual or duality gap on the "
            f"problem as the solver got it, over one plus the size of its terms, exceeds {MISS_FACTOR:g} times the "
            "tolerance; *worst as posed* is the largest of them. *Median*, *worst*: certificates.",
            "Outcome at each tolerance:",
        ),
    ]


def own_polish_note(named: list[MethodName]) -> str | None:
    """Which solvers of a sweep polish their own answers at every tolerance; None if none does."""
    polishing = [f"`{name}`" for name in dict.fromkeys(one[0] for one in named) if polishes_itself(name)]
    if not polishing:
        return None
    return (
        f"The tolerance replaces that of the table, the other settings stay: {', '.join(polishing)} polishes its own "
        "answer, so its certificates hardly depend on the tolerance.\n"
    )


def _work(curve: WorkPrecision, i: int) -> str:
    return f"{milliseconds(float(curve.run_time[i]))} ({100.0 * curve.share[i]:.0f} %)"
