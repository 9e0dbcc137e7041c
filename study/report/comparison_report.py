"""Comparison report in Markdown: what each solver claimed and what held, run times, residuals, failures, versions.

A table is rows of texts, as Markdown for the report, as CSV and as LaTeX. Those of answers go by kind of problem; those
of times have run time and its parts, starts, pairs of solvers, growth with size, work against precision.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...contact.problem.certificate import EXACT_TOLERANCE
from ...core.checks import shown
from ...core.errors import InputError
from ...core.output_file import whole_file
from ...core.regular_file import parsed_json
from ..compare import method_statistics as statistics
from ..compare.attempt import COLD, HEADLINE, SETTINGS, STARTING_SOLVERS, WARM, polishes_itself
from ..compare.comparison_table import RESIDUALS
from ..compare.method_statistics import METHOD_COLUMNS, MethodName, by_problem, headline, methods, of_method, time_of

#: What stands for a number that there is not.
NOTHING = "-"


@dataclass(frozen=True, eq=False)
class ReportTable:
    """Table of the report, with files of its own; note and caption in Markdown."""

    name: str  # of its files
    head: Sequence[str]
    rows: Sequence[Sequence[Any]]
    note: str = ""
    caption: str = ""  # empty under a heading of its own
    in_report: bool = True  # not in its files alone
    short_rows: Sequence[Sequence[Any]] | None = None  # those of the report, if those of the files are too long

    @property
    def markdown(self) -> str:
        """The table with caption and note, in Markdown; of one that is too long for the report the note alone."""
        if not self.in_report:
            return f"{self.note}\n"
        caption = f"{self.caption}\n\n" if self.caption else ""
        note = f"\n{self.note}\n" if self.note else ""
        rows = self.rows if self.short_rows is None else self.short_rows
        return f"{caption}{_tabulated(self.head, rows, 'github')}\n{note}"

    @property
    def latex(self) -> str:
        """The table in LaTeX, for the package booktabs."""
        return _tabulated(self.head, self.rows, "latex_booktabs") + "\n"

    def write(self, folder: Path) -> list[Path]:
        """Write the table as ``NAME.csv`` and ``NAME.tex``; returns their paths."""
        paths = [folder / f"{self.name}.csv", folder / f"{self.name}.tex"]
        with whole_file(paths[0]) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([self.head, *self.rows])
        with whole_file(paths[1]) as temporary:
            temporary.write_text(self.latex, encoding="utf-8")
        return paths


def _tabulated(head: Sequence[str], rows: Sequence[Sequence[Any]], form: str) -> str:
    from tabulate import tabulate

    return str(tabulate(rows, head, tablefmt=form, disable_numparse=True))


def milliseconds(seconds: float) -> str:
    """Time [s] in milliseconds, three digits; a dash if it is not finite."""
    if not np.isfinite(seconds):
        return NOTHING
    return f"{1e3 * seconds:.3g}" if seconds < 1.0 else f"{1e3 * seconds:.0f}"


def ratio(value: float) -> str:
    """Ratio with three digits; a dash if it is not finite."""
    return f"{value:.3g}" if np.isfinite(value) else NOTHING


def residual(value: float) -> str:
    """Residual with two digits; a dash if it is not finite."""
    return f"{value:.1e}" if np.isfinite(value) else NOTHING


def quantiles(values: Any, levels: Sequence[float] = (0.5, 0.9, 1.0)) -> list[float]:
    """Quantiles of the finite values of a column; NaN if there are none."""
    known = values.to_numpy(dtype=float)
    known = known[np.isfinite(known)]
    return np.quantile(known, levels).tolist() if known.size else [float("nan")] * len(levels)


def median(values: Any) -> float:
    """Median of the finite values of a column; NaN if there are none."""
    return quantiles(values, [0.5])[0]


def by_method(records: Any, named: Sequence[MethodName], cells: Callable[[Any], Sequence[Any]]) -> list[list[Any]]:
    """Rows of a table, one a method: its name and the cells of its records."""
    return [[*method, *cells(of_method(records, method))] for method in named]


#: Problems that a line of failures names.
NAMED_PROBLEM_LIMIT = 3
#: Head of the column of problems whose file gives them no kind.
WITHOUT_KIND = "without a kind"


def success_tables(problems: Any, named: list[MethodName]) -> list[ReportTable]:
    """Claims against certificates, a table for each settings."""
    columns = ["problems", "says solved", "certified", "%", "exact", "polished", "says solved, not certified", "denied"]

    def cells(records: Any) -> list[Any]:
        counted = ("claims", "certified", "exact", "polished", "uncertified", "denied")
        claims, certified, *others = (int(records[name].sum()) for name in counted)
        return [len(records), claims, certified, f"{100.0 * records['certified'].mean():.4g}", *others]

    tables = []
    for settings in dict.fromkeys(method[1] for method in named):
        rows = by_method(problems, [one for one in named if one[1] == settings], cells)
        caption = f"`{settings}`: {SETTINGS[settings]}."
        tables.append(ReportTable(f"answers_{settings}", [*METHOD_COLUMNS, *columns], rows, "", caption))
    return tables


def success_note(dataset: xr.Dataset) -> str:
    """Meaning of the columns of the success tables, in Markdown."""
    return (
        f"*Certified*: the largest violation of a condition on the problem as it was given is at most "
        f"{dataset.attrs['tolerance']:g}, *exact*: at most {EXACT_TOLERANCE:g}, in every repetition. *Polished*: the "
        "answer is that of one linear solve on the active set that the solver found, without exchange of segments; if "
        "the set was wrong, the answer stays as it was. *Says solved, not certified*: the solver may have kept its own "
        "criterion, which is another: it bounds the sum of the products of force and gap (duality gap), the "
        "certificate the smaller one of the two on every segment, which goes like the root of that. *Denied*: "
        "certified, but does not say solved. The best are first.\n"
    )


def kind_table(problems: Any, named: list[MethodName]) -> ReportTable | None:
    """Certified problems by kind, where the files have kinds."""
    kinds = [kind for kind in dict.fromkeys(problems["kind"]) if kind]
    if not kinds:
        return None
    heads = list(kinds)
    if (problems["kind"] == "").any():
        kinds, heads = [*kinds, ""], [*kinds, WITHOUT_KIND]

    def cells(records: Any) -> list[str]:
        of_kind = [records[records["kind"] == kind]["certified"] for kind in kinds]
        return [f"{int(one.sum())} of {len(one)}" if len(one) else NOTHING for one in of_kind]

    rows = by_method(problems, named, cells)
    return ReportTable("certified_by_kind", [*METHOD_COLUMNS, *heads], rows, "", "Certified, by kind of problem:")


def residual_tables(dataset: xr.Dataset, named: list[MethodName]) -> list[ReportTable]:
    """Certificates and errors of rotation, and which condition is violated."""
    frame: Any = dataset.to_dataframe()

    def cells(records: Any) -> list[Any]:
        shown = (quantiles(records[name]) for name in ("worst_residual", "posed_residual", "rotation_error"))
        return [int(records["worst_residual"].notna().sum()), *map(residual, chain.from_iterable(shown))]

    rows = by_method(frame, named, cells)
    parts = by_method(frame, named, lambda one: [residual(quantiles(one[name])[2]) for name in RESIDUALS])
    levels = ["median", "90 %", "worst"]
    posed_head, rotation_head = ([f"{name}, {level}" for level in levels] for name in ("as posed", "rotation"))
    head = [*METHOD_COLUMNS, "answers", *levels, *posed_head, *rotation_head]
    note = (
        "Largest entry of the certificate; *as posed*: largest of primal residual, dual residual and duality gap on "
        "the problem as the solver got it, each over one plus the size of its terms, for comparison with its own "
        "tolerance; relative error of the rotation beyond first contact. Over all attempts with an answer, certified "
        "or not."
    )
    conditions = [name.replace("_", " ") for name in RESIDUALS]
    return [
        ReportTable("residuals", head, rows, note),
        ReportTable("violations", [*METHOD_COLUMNS, *conditions], parts, "", "Which condition is violated, at worst:"),
    ]


def failure_table(dataset: xr.Dataset, named: list[MethodName]) -> ReportTable | None:
    """Attempts that are not certified, by claim and words; None if there are none."""
    frame: Any = dataset.to_dataframe()
    rows: list[list[Any]] = []
    short: list[list[Any]] = []
    for method in named:
        records = of_method(frame, method)
        failed = records[records["certified"] == 0]
        for (claim, message), group in failed.groupby(["claim", "message"], sort=False):
            words = str(message).replace("|", "/").replace("`", "'")
            problems = group.drop_duplicates(["problem_file", "problem"])
            counted = [*method, claim, words, len(group), len(problems)]
            names = [row.problem_name or f"{row.problem_file} {row.problem}" for row in problems.itertuples()]
            rows.append([*counted, ", ".join(names)])
            more = ", ..." if len(names) > NAMED_PROBLEM_LIMIT else ""
            short.append([*counted, ", ".join(names[:NAMED_PROBLEM_LIMIT]) + more])
    if not rows:
        return None
    head = [*METHOD_COLUMNS, "says", "its words", "attempts", "problems", "which"]
    note = "Attempts that are not certified; `tables/failures.csv` names all their problems."
    return ReportTable("failures", head, rows, note, short_rows=short)


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

    def cells(records: Any) -> list[str]:
        mean = statistics.mean_time(records["run_time"], limit)
        spread = quantiles(records["spread"][records["certified"]], (0.5, 0.9))
        return [*map(milliseconds, [mean, *quantiles(records["run_time"])]), *map(ratio, spread)]

    rows = by_method(problems, named, cells)
    head = ["mean [ms]", "median [ms]", "90 % [ms]", "longest [ms]", "spread", "spread, 90 %"]
    note = (
        f"Time: {statistics.TIMES[time_of(dataset)]}. *Mean*: shifted geometric mean over the problems, shift "
        f"{1e3 * statistics.RUN_TIME_SHIFT:g} ms, each with the median of "
        "its repetitions; one that is not certified counts with the time limit, "
        f"{1e3 * limit:g} ms. The other columns are over certified problems. *Spread*: longest over shortest run time "
        "of the repetitions of a problem, its median and 90 % quantile; a dash where there is one repetition."
    )
    return ReportTable("run_time", [*METHOD_COLUMNS, *head], rows, note)


def waiting_note(dataset: xr.Dataset) -> str | None:
    """Warning that the machine was busy, naming the solvers that waited; None where none did."""
    waited = statistics.waiting_solvers(dataset)
    if not waited:
        return None
    named = ", ".join(f"{solver} {factor:.3g}" for solver, factor in waited.items())
    advice = "" if time_of(dataset) == statistics.PROCESSOR else "; measure anew, or compare by --time processor"
    return f"The machine was busy: median of wall over processor time, which is 1 on an idle one: {named}{advice}."


def time_parts(problems: Any, named: list[MethodName], sources: dict[MethodName, str]) -> ReportTable:
    """Medians of the parts of the run time, over certified problems."""
    rows = []
    for method in named:
        records = of_method(problems, method)
        records = records[records["certified"]]
        columns = ("wall_time", "processor_time", "call_time", "setup_time", "solve_time", "polish_time")
        whole = median(records["wall_time"] / records["call_time"])
        times = [milliseconds(median(records[name])) for name in columns]
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
    """Origin of the measured set-up and solve times, by method."""
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
        cold, warm = (
            of_method(problems, (solver, settings, one)).set_index(statistics.PROBLEM_COLUMNS) for one in (COLD, WARM)
        )
        both = warm.join(cold.add_suffix("_cold"), how="inner")
        solved = both[both["certified"] & both["certified_cold"]]
        counts = [len(both), *(int(both[name].sum()) for name in ("certified_cold", "certified"))]
        times = [milliseconds(median(solved[name])) for name in ("run_time_cold", "run_time")]
        gain = median(solved["run_time"] / solved["run_time_cold"])
        iterations = [median(solved[name][solved[name] >= 0]) for name in ("iterations_cold", "iterations")]
        rows.append([solver, *counts, *times, *map(ratio, [gain, *iterations])])
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
    times = statistics.run_time_table(problems, chosen).to_numpy(dtype=float).T
    shares = [statistics.pairwise_matrix(times, factor) for factor in PAIR_FACTORS]
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
        records = of_method(problems, method)
        fits = [
            statistics.growth(
                *(records[group_of(records) == group][name].to_numpy(dtype=float) for name in ("size", "run_time"))
            )
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
    for group, records in problems.groupby(group_of(problems), sort=False):
        sizes = np.unique(records["size"].to_numpy(dtype=float))
        if sizes.size >= statistics.SIZE_COUNT_MINIMUM and (sizes[1:] / sizes[:-1]).max() <= LARGEST_SIZE_STEP:
            widths[str(group)] = float(sizes[-1] / sizes[0])
    return sorted((name for name in widths if widths[name] >= SIZE_SPAN_MINIMUM), key=lambda name: -widths[name])


def work_precision_tables(dataset: xr.Dataset, named: list[MethodName]) -> list[ReportTable]:
    """Time and share of problems by certified accuracy, and the outcome at each tolerance."""
    rank = {method[0]: number for number, method in enumerate(headline(named))}
    curves = sorted(statistics.work_precision(dataset), key=lambda one: rank[one.solver])
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
            *map(residual, (point.posed, point.median, point.worst)),
            milliseconds(point.run_time),
        ]
        for point in sorted(statistics.sweep_points(dataset), key=lambda one: (rank[one.solver], -one.tolerance))
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
            "problem as the solver got it, over one plus the size of its terms, exceeds "
            f"{statistics.MISS_FACTOR:g} times the tolerance; *worst as posed* is the largest of them. *Median*, "
            "*worst*: certificates.",
            "Outcome at each tolerance:",
        ),
    ]


def own_polish_note(named: list[MethodName]) -> str | None:
    """Note on solvers of a sweep that polish their own answers at every tolerance; None if none does."""
    polishing = [f"`{name}`" for name in dict.fromkeys(one[0] for one in named) if polishes_itself(name)]
    if not polishing:
        return None
    return (
        f"The tolerance replaces that of the table, the other settings stay: {', '.join(polishing)} polishes its own "
        "answer, so its certificates hardly depend on the tolerance.\n"
    )


def _work(curve: statistics.WorkPrecision, i: int) -> str:
    return f"{milliseconds(float(curve.run_time[i]))} ({100.0 * curve.share[i]:.0f} %)"


#: Folder of the tables beside the report.
TABLE_FOLDER = "tables"
#: Folder of the figures beside the report.
FIGURE_FOLDER = "figures"
#: Formats of every figure, by suffix.
FIGURE_FORMATS = ("png", "pdf", "svg")
NO_GROWTH = (
    "Neither tabulated nor drawn: no kind of problem has three sizes or more that span a factor of "
    f"{SIZE_SPAN_MINIMUM:g}, each within a factor of {LARGEST_SIZE_STEP:g} of the next.\n"
)


@dataclass(frozen=True)
class Picture:
    """Picture of the report."""

    section: str
    file: str  # PNG, from the folder of the report
    caption: str


@dataclass(frozen=True, eq=False)
class Section:
    """A section of the report: a heading, then tables and texts in their order."""

    heading: str
    parts: Sequence[ReportTable | str | None]


def report_sections(dataset: xr.Dataset) -> list[Section]:
    """Sections of the report, without those that have nothing to tell."""
    problems = by_problem(dataset)
    named = methods(problems, float(dataset.attrs["time_limit_s"]))
    failures, waited = failure_table(dataset, named), waiting_note(dataset)
    sections = [
        Section("Answers", [*success_tables(problems, named), success_note(dataset), kind_table(problems, named)]),
        Section("Run time", [waited and f"**{waited}**\n", run_time_summary(dataset, problems, named)]),
        Section("Parts of the run time", [time_parts(problems, named, time_sources(dataset, named))]),
        Section("Cold and warm starts", [start_table(problems, named)]),
        Section("Pairs of solvers", [pair_table(problems, named)]),
        Section("Work and precision", _work_and_precision(dataset, named)),
        Section("Growth", [growth_table(problems, named) if size_groups(problems) else NO_GROWTH]),
        Section("Residuals", residual_tables(dataset, named)),
        Section("Failures", [failures if failures is not None else "None: every attempt is certified.\n"]),
        Section("Made with", [_made_with(dataset)]),
    ]
    return [section for section in sections if any(part is not None for part in section.parts)]


def _work_and_precision(dataset: xr.Dataset, named: list[MethodName]) -> list[ReportTable | str | None]:
    return [*work_precision_tables(dataset, named), own_polish_note(named)] if statistics.has_sweep(dataset) else []


def comparison_report(dataset: xr.Dataset, pictures: Sequence[Picture] = ()) -> str:
    """Report of a comparison, in Markdown."""
    lines = ["# Comparison of solvers\n", _subject(dataset, by_problem(dataset))]
    for section in report_sections(dataset):
        lines.append(f"## {section.heading}\n")
        lines += [f"![{one.caption}]({one.file})\n" for one in pictures if one.section == section.heading]
        lines += [
            part.markdown if isinstance(part, ReportTable) else part for part in section.parts if part is not None
        ]
    return "\n".join(lines)


def write_report(dataset: xr.Dataset, folder: Path, pictures: Sequence[Picture] = ()) -> list[Path]:
    """Write the report as ``report.md``, and its tables as CSV and LaTeX; returns their paths, the report first."""
    path = folder / "report.md"
    with whole_file(path) as temporary:
        temporary.write_text(comparison_report(dataset, pictures), encoding="utf-8")
    tables = [part for section in report_sections(dataset) for part in section.parts if isinstance(part, ReportTable)]
    return [path, *(written for table in tables for written in table.write(folder / TABLE_FOLDER))]


def _subject(dataset: xr.Dataset, problems: Any) -> str:
    unique = problems.drop_duplicates(["problem_file", "problem"])
    lines = [
        f"- {len(group)} contact problems of `{file}`, {_range(group['size'])} segments"
        for file, group in unique.groupby("problem_file", sort=False)
    ]
    attempts = dataset.sizes["attempt"]
    said = f"{attempts} attempt" if attempts == 1 else f"{attempts} attempts"
    lines.append(f"- In all {len(unique)} problems, {_range(unique['size'])} segments, {said}")
    return "\n".join(lines) + "\n"


def _made_with(dataset: xr.Dataset) -> str:
    machine, versions = (_table_of(dataset, name) for name in ("machine", "solver_versions"))
    rows = [*machine.items(), *((f"solver `{solver}`", version) for solver, version in versions.items())]
    table = ReportTable("made_with", ["what", "which"], rows)
    return (
        f"{table.markdown}\nA process for each solver, up to {dataset.attrs['repetitions']} repetitions, time limit "
        f"{dataset.attrs['time_limit_s']:g} s an attempt. Each call gets the separations and the torque multiplied by "
        "another factor between 1 and 1.5 (`load_factor`), so that an answer kept from an earlier call is wrong. "
        "`native` is measured with its own answer alone, and is the reference of the error of rotation.\n"
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


def _range(sizes: Any) -> str:
    low, high = int(sizes.min()), int(sizes.max())
    return f"{low}" if low == high else f"{low} to {high}"
