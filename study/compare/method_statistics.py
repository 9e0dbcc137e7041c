"""Method statistics: what each method of a comparison did on each problem, and the order of methods in tables.

Run times make performance, data and pairwise profiles, a shifted geometric mean, and growth with the number of
segments; who waited for the processor is told.

Work against precision is the time a solver needs for a certified accuracy, from a sweep of its tolerances. What a
solver calls its tolerance is compared with quantities of its own. So the precision is read off the certificate, the
same for all: for each accuracy, the time of the fastest of a solver's runs whose certificate reaches it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from ...contact.problem.certificate import EXACT_TOLERANCE
from ...contact.solvers.solution import SOLVED
from ...core.arrays import RealArray as Array
from .attempt import COLD, HEADLINE, SETTINGS, SWEEP


def performance_profile(run_time: Array) -> tuple[Array, Array]:
    """Factors (m) over the fastest, and share (methods, m) of all problems that each method solves within them.

    Run times (methods, problems) [s] are infinite where unsolved. Dolan and More 2002, doi 10.1007/s101070100263. A
    third method can change the order of two (doi 10.1145/2950048), but not their ``pairwise_share``.
    """
    best = run_time.min(axis=0)
    with np.errstate(invalid="ignore"):
        ratio = np.where(np.isfinite(run_time), run_time / best, np.inf)
    factor = np.unique(np.concatenate([[1.0], ratio[np.isfinite(ratio)]]))
    return factor, _shares(ratio, factor)


def data_profile(run_time: Array) -> tuple[Array, Array]:
    """Run times (m) [s], and share (methods, m) of all problems that each method solves within them.

    Run times (methods, problems) are infinite where unsolved. The curve of a method does not depend on the others. More
    and Wild 2009, doi 10.1137/080724083, with the run time as the budget.
    """
    budget = np.unique(run_time[np.isfinite(run_time)])
    return budget, _shares(run_time, budget)


def pairwise_share(first: Array, second: Array, factor: float = 1.0) -> float:
    """Share of all problems that the first of two methods solves within a factor of the time of the second.

    Run times (problems) [s] are infinite where unsolved; a problem that the first alone solves counts for it. The share
    is that of a performance profile of these two methods, which no third can change.
    """
    solved = np.isfinite(first)
    with np.errstate(invalid="ignore"):
        return float(np.mean(solved & (first <= factor * second)))


def pairwise_matrix(run_time: Array, factor: float = 1.0) -> Array:
    """Pairwise shares (methods, methods), row against column, of run times (methods, problems) [s]."""
    return np.array([[pairwise_share(first, second, factor) for second in run_time] for first in run_time])


def _shares(values: Array, limits: Array) -> Array:
    """Share of each row of values (methods, n) that does not exceed each limit (m): (methods, m)."""
    counts = [np.searchsorted(np.sort(row), limits, side="right") for row in values]
    return np.asarray(np.array(counts) / max(values.shape[1], 1))


#: Shift of the geometric mean of run times [s]; differences far below it do not count.
RUN_TIME_SHIFT = 1e-3
#: Least number of sizes for a fit of the growth, and least ratio of the largest to the smallest.
SIZE_COUNT_MINIMUM, SIZE_RATIO_MINIMUM = 3, 1.5

#: Part by which wall time exceeds processor time where a solver waited for the processor.
WAITING_EXCESS = 0.2


def shifted_geometric_mean(values: Array, shift: float) -> float:
    """Geometric mean of shifted values, shifted back; small values do not dominate it."""
    return float(np.exp(np.mean(np.log(values + shift))) - shift)


def mean_time(times: Any, time_limit: float) -> float:
    """Shifted geometric mean of times [s]; one that is not finite counts with the time limit."""
    values = np.asarray(times, dtype=float)
    return shifted_geometric_mean(np.where(np.isfinite(values), values, time_limit), RUN_TIME_SHIFT)


def waiting_solvers(dataset: xr.Dataset) -> dict[str, float]:
    """Median of wall over processor time by solver, where above ``1 + WAITING_EXCESS``: other work took its turn.

    Of calls with an answer; empty where solvers had more than one thread.
    """
    if int(dataset.attrs.get("threads", 1)) != 1:
        return {}
    medians = {}
    ratios = dataset["run_time"].values / np.maximum(dataset["processor_time"].values, 1e-9)
    answered = np.isfinite(ratios) & np.isfinite(dataset["worst_residual"].values)
    for solver in dict.fromkeys(dataset["solver"].values.tolist()):
        solver_ratios = ratios[answered & (dataset["solver"].values == solver)]
        if solver_ratios.size and np.median(solver_ratios) > 1.0 + WAITING_EXCESS:
            medians[str(solver)] = float(np.median(solver_ratios))
    return medians


def growth(size: Array, run_time: Array) -> tuple[float, float] | None:
    """Factor and exponent of run_time = factor size^exponent, by least squares of the logarithms; else ``None``.

    Fitted above the geometric mean of least and greatest size, to three sizes at least, as small problems show the cost
    of the call; infinite times are left out. ``None`` if sizes are too few or too close.
    """
    known = np.isfinite(run_time)
    if not known.any():
        return None
    sizes = np.unique(size[known])
    upper = int(np.count_nonzero(sizes >= np.sqrt(sizes[0] * sizes[-1])))
    sizes = sizes[-max(SIZE_COUNT_MINIMUM, upper) :]
    if sizes.size < SIZE_COUNT_MINIMUM or sizes[-1] < SIZE_RATIO_MINIMUM * sizes[0]:
        return None
    known &= size >= sizes[0]
    size, run_time = size[known], run_time[known]
    exponent, offset = np.polyfit(np.log(size), np.log(run_time), 1)
    return float(np.exp(offset)), float(exponent)


#: A method in tables and figures: solver, settings and start.
MethodName = tuple[str, str, str]
#: Columns that name a method: a solver with settings and a start.
METHOD_COLUMNS = ["solver", "settings", "start"]
#: Factor of a tolerance by which an answer that says it is solved misses it: solvers take norms and sizes each in
#: its own way.
MISS_FACTOR = 10.0
#: Times that tables and profiles can go by, and what they are.
TIMES = {
    "wall": "wall time of a call, the package's share included",
    "processor": "processor time of a call, the package's share included",
}
WALL, PROCESSOR = TIMES
#: Columns that name a problem.
PROBLEM_COLUMNS = ["problem_file", "problem"]
#: Columns of times, of which the median over repetitions is taken.
TIME_COLUMNS = ("wall_time", "processor_time", "call_time", "setup_time", "solve_time", "polish_time")


def time_of(dataset: xr.Dataset) -> str:
    """The time that order, tables and profiles of a comparison go by, one of `TIMES`."""
    time = str(dataset.attrs.get("time", WALL))
    return time if time in TIMES else WALL


def attempts_of(dataset: xr.Dataset) -> Any:
    """Data frame of all attempts, with their claims and certificates.

    ``run_time`` is the time to compare, see `TIMES`, beside ``wall_time``; ``exact``, ``claims``, ``uncertified``,
    ``denied`` as in ``by_problem``; ``missed``: claimed as solved, but beyond the tolerance of a sweep.
    """
    frame: Any = dataset.to_dataframe()
    certified, solved = frame["certified"] == 1, frame["claim"] == SOLVED
    given = frame["solver_tolerance"]
    return frame.assign(
        wall_time=frame["run_time"],
        run_time=frame["processor_time" if time_of(dataset) == PROCESSOR else "run_time"],
        claims=solved,
        certified=certified,
        exact=frame["worst_residual"] <= EXACT_TOLERANCE,
        uncertified=solved & ~certified,
        missed=solved & (given > 0.0) & ~(frame["posed_residual"] <= MISS_FACTOR * given),
        denied=certified & ~solved,
    )


def by_problem(dataset: xr.Dataset) -> Any:
    """Data frame with a row for each method and problem, repetitions together, without the sweep of tolerances.

    ``claims``, ``certified``, ``exact``, ``polished`` hold for every repetition, ``uncertified`` or ``denied`` (claim
    or certificate alone) for some; medians, ``run_time`` infinite unless certified; ``spread``: longest over shortest.
    """
    frame = attempts_of(dataset)
    groups = frame[frame["settings"] != SWEEP].groupby([*METHOD_COLUMNS, *PROBLEM_COLUMNS], sort=False)
    result = groups.agg(
        size=("size", "first"),
        kind=("kind", "first"),
        **{name: (name, "all") for name in ("claims", "certified", "exact", "polished")},
        **{name: (name, "any") for name in ("uncertified", "denied")},
        worst=("worst_residual", "max"),
        run_time=("run_time", "median"),
        shortest=("run_time", "min"),
        longest=("run_time", "max"),
        repetitions=("run_time", "count"),
        iterations=("iterations", "median"),
        **{name: (name, "median") for name in TIME_COLUMNS},
    ).reset_index()
    result["spread"] = (result["longest"] / result["shortest"]).where(result["repetitions"] > 1)
    result["run_time"] = result["run_time"].where(result["certified"] & result["run_time"].notna(), np.inf)
    return result.drop(columns=["shortest", "longest", "repetitions"])


def methods(problems: Any, time_limit: float) -> list[MethodName]:
    """Solver, settings and start of every method of ``by_problem``: by settings and start, then the best first.

    The best certify most problems, then have the least mean run time, a problem without a certified answer counting
    with the time limit [s]. Of those that certify none, the ones that claim to have solved some are last.
    """
    order = list(SETTINGS)
    names = [tuple(row) for row in problems[METHOD_COLUMNS].drop_duplicates().itertuples(index=False)]
    return sorted(names, key=lambda one: (order.index(one[1]), one[2], merit(problems, one, time_limit)))


def merit(problems: Any, method: MethodName, time_limit: float) -> tuple[float, float, int]:
    """Rank of a method among others, the least first; see ``methods``."""
    rows = of_method(problems, method)
    return -float(rows["certified"].mean()), mean_time(rows["run_time"], time_limit), int(rows["uncertified"].sum())


def headline(named: list[MethodName]) -> list[MethodName]:
    """Methods of the headline: the solvers' own answers to the scaled problem, from a cold start."""
    return [method for method in named if method[1:] == (HEADLINE, COLD)]


def of_method(frame: Any, method: MethodName) -> Any:
    """Rows of a method."""
    solver, settings, start = method
    return frame[(frame["solver"] == solver) & (frame["settings"] == settings) & (frame["start"] == start)]


def run_time_table(problems: Any, named: list[MethodName]) -> Any:
    """Run times (problems, methods) [s] of a list of methods, infinite where a problem was not solved."""
    # Not a pivot table: that would have a row for every number in every file.
    table = problems.set_index([*PROBLEM_COLUMNS, *METHOD_COLUMNS])["run_time"].unstack(METHOD_COLUMNS)
    return table[named]


#: Accuracies of the diagram.
ACCURACIES = 10.0 ** -np.arange(1.0, 13.0)


@dataclass(frozen=True, eq=False)
class WorkPrecision:
    """Work and precision of one solver."""

    solver: str
    accuracy: Array  # certificates that are asked for (m)
    share: Array  # of problems on which some run reaches it (m)
    run_time: Array  # median of the fastest such run (m) [s]; infinite if half have none


@dataclass(frozen=True)
class SweepPoint:
    """Runs of one solver with one tolerance; certificates and residuals are infinite without an answer."""

    solver: str
    tolerance: float  # zero for the settings of the headline
    problems: int
    claimed: int
    missed: int  # claimed, but beyond the tolerance given, see `MISS_FACTOR`
    median: float  # certificate
    worst: float  # certificate
    posed: float  # largest residual on the problems as it got them
    run_time: float


def has_sweep(dataset: xr.Dataset) -> bool:
    """True if a comparison has a sweep of tolerances."""
    return bool((dataset["settings"].values == SWEEP).any())


def work_precision(dataset: xr.Dataset) -> list[WorkPrecision]:
    """Work and precision of every solver of a comparison, in the order of the table, its headline runs included."""
    runs = _runs(dataset)
    result = []
    for solver in dict.fromkeys(runs["solver"]):
        solver_runs = runs[runs["solver"] == solver]
        problems = [solver_runs[column] for column in PROBLEM_COLUMNS]
        reached = [solver_runs["run_time"].where(solver_runs["worst"] <= a, np.inf) for a in ACCURACIES]
        best = np.array([run_time.groupby(problems).min() for run_time in reached])
        result.append(WorkPrecision(solver, ACCURACIES, np.isfinite(best).mean(axis=1), _medians(best)))
    return result


def sweep_points(dataset: xr.Dataset) -> list[SweepPoint]:
    """Outcome of every solver at every tolerance, in the order of the table."""
    runs = _runs(dataset)
    result = []
    for (solver, tolerance), solver_runs in runs.groupby(["solver", "solver_tolerance"], sort=False):
        ended = solver_runs["run_time"].to_numpy(dtype=float)
        ended = ended[np.isfinite(ended)]
        worst = solver_runs["worst"].to_numpy(dtype=float)
        numbers = len(solver_runs), int(solver_runs["claims"].sum()), int(solver_runs["missed"].sum())
        certificates = float(_medians(worst[np.newaxis])[0]), float(worst.max()), float(solver_runs["posed"].max())
        run_time = float(np.median(ended)) if ended.size else np.inf
        result.append(SweepPoint(str(solver), float(tolerance), *numbers, *certificates, run_time))
    return result


def _runs(dataset: xr.Dataset) -> Any:
    """A row a solver, tolerance and problem: worst certificate of the repetitions, and their median run time."""
    frame = attempts_of(dataset)
    chosen = frame[frame["settings"].isin([SWEEP, HEADLINE]) & (frame["start"] == COLD)]
    columns = {"worst": "worst_residual", "posed": "posed_residual", "run_time": "run_time"}
    chosen = chosen.assign(**{name: chosen[column].fillna(np.inf) for name, column in columns.items()})
    groups = chosen.groupby(["solver", "solver_tolerance", *PROBLEM_COLUMNS], sort=False)
    return groups.agg(
        worst=("worst", "max"),
        run_time=("run_time", "median"),
        claims=("claims", "all"),
        missed=("missed", "any"),
        posed=("posed", "max"),
    ).reset_index()


def _medians(values: Array) -> Array:
    """Medians of rows (m, n); the upper one of two, so that an infinite half is infinite."""
    return np.sort(values, axis=1)[:, values.shape[1] // 2]
