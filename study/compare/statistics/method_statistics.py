"""Method statistics: what each method of a comparison did on each problem, and the order of methods in tables."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ....contact.problem.certificate import EXACT_TOLERANCE
from ....contact.solvers.solution import SOLVED
from ..measurement.method import COLD, HEADLINE, SETTINGS, SWEEP
from .run_time_statistics import RUN_TIME_SHIFT, shifted_geometric_mean

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
    """Data frame of all attempts, with what they say and what of it holds.

    The column ``run_time`` is the time that the comparison goes by, see `TIMES`; ``wall_time`` the wall time.

    Columns beside those of the table: ``exact``, ``claims``, ``uncertified`` and ``denied`` as in ``by_problem``, but
    of one attempt; ``missed``, it claims to have solved the problem and misses the tolerance of a sweep.
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
    """Data frame with a row a method and problem, all repetitions together; without the sweep of tolerances.

    Returns
    -------
    DataFrame
        Columns besides method, problem, ``size`` and ``kind``: ``claims``, every repetition claims to have solved the
        problem; ``certified`` and ``exact``, every repetition is certified, to the tolerance of the comparison and to
        ``EXACT_TOLERANCE``; ``uncertified``, some repetition claims so and is not certified; ``denied``, some
        repetition is certified but does not claim so; ``polished``, every answer is polished; ``run_time``, median over
        the repetitions [s], infinite unless certified; ``spread``, the longest over the shortest, NaN of one alone;
        medians of ``iterations`` and of the times in `TIME_COLUMNS` [s].
    """
    frame = attempts_of(dataset)
    groups = frame[frame["settings"] != SWEEP].groupby([*METHOD_COLUMNS, *PROBLEM_COLUMNS], sort=False)
    result = groups.agg(
        size=("size", "first"),
        kind=("kind", "first"),
        claims=("claims", "all"),
        certified=("certified", "all"),
        exact=("exact", "all"),
        polished=("polished", "all"),
        uncertified=("uncertified", "any"),
        denied=("denied", "any"),
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

    Parameters
    ----------
    problems
        Data frame of ``by_problem``.
    time_limit
        Time that counts for a problem without a certified answer [s].

    Returns
    -------
    list
        Within settings and start by the number of certified problems, then by the mean run time. Of those that have
        none, the ones that claim to have are last.
    """
    order = list(SETTINGS)
    found = [tuple(row) for row in problems[METHOD_COLUMNS].drop_duplicates().itertuples(index=False)]
    return sorted(found, key=lambda one: (order.index(one[1]), one[2], merit(problems, one, time_limit)))


def merit(problems: Any, method: MethodName, time_limit: float) -> tuple[float, float, int]:
    """Rank of a method among others, the least first; see ``methods``."""
    found = of_method(problems, method)
    times = found["run_time"].to_numpy(dtype=float)
    mean = shifted_geometric_mean(np.where(np.isfinite(times), times, time_limit), RUN_TIME_SHIFT)
    return -float(found["certified"].mean()), mean, int(found["uncertified"].sum())


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
