"""Method statistics: what each method of a comparison did on each problem, and the order of methods in tables.

Profiles of run times: performance profile, data profile and pairwise profile.

Run-time statistics: shifted geometric mean, growth with the number of segments, and who waited for the processor.

Work against precision: the time a solver needs for a certified accuracy, from a sweep of its tolerances.

What a solver calls its tolerance is compared with quantities of its own. So the precision is read off the certificate,
the same for all: for each accuracy, the time of the fastest of a solver's runs whose certificate reaches it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.problem.certificate import EXACT_TOLERANCE
from ...contact.solvers.solution import SOLVED
from .attempt import COLD, HEADLINE, SETTINGS, SWEEP

Array = NDArray[np.float64]


def performance_profile(run_time: Array) -> tuple[Array, Array]:
    """Share of problems that each method solves within a factor of the fastest.

    Parameters
    ----------
    run_time
        Run times (methods, problems) [s]; infinite where the problem was not solved.

    Returns
    -------
    tuple
        Factors (m) from 1 upwards at which the curves step, and the share (methods, m) of all problems, unsolved ones
        included, that each method solves within the factor.

    Notes
    -----
    Dolan and More 2002, doi 10.1007/s101070100263. The curve of a method tells how far it is from the best, but the
    order of two methods can change when a third is taken away (Gould and Scott 2016, doi 10.1145/2950048): that of
    ``pairwise_share`` cannot.

    Examples
    --------
    >>> import numpy as np
    >>> factor, share = performance_profile(np.array([[1.0, 4.0], [2.0, np.inf]]))
    >>> factor.tolist(), share.tolist()
    ([1.0, 2.0], [[1.0, 1.0], [0.0, 0.5]])
    """
    best = run_time.min(axis=0)
    with np.errstate(invalid="ignore"):
        ratio = np.where(np.isfinite(run_time), run_time / best, np.inf)
    factor = np.unique(np.concatenate([[1.0], ratio[np.isfinite(ratio)]]))
    return factor, _shares(ratio, factor)


def data_profile(run_time: Array) -> tuple[Array, Array]:
    """Share of problems that each method solves within a run time.

    Parameters
    ----------
    run_time
        Run times (methods, problems) [s]; infinite where the problem was not solved.

    Returns
    -------
    tuple
        Run times (m) [s] at which the curves step, and the share (methods, m) of all problems that each method solves
        within that time. The curve of a method does not depend on the others.

    Notes
    -----
    More and Wild 2009, doi 10.1137/080724083, with the run time as the budget.

    Examples
    --------
    >>> import numpy as np
    >>> budget, share = data_profile(np.array([[1.0, 4.0], [2.0, np.inf]]))
    >>> budget.tolist(), share.tolist()
    ([1.0, 2.0, 4.0], [[0.5, 0.5, 1.0], [0.0, 0.5, 0.5]])
    """
    budget = np.unique(run_time[np.isfinite(run_time)])
    return budget, _shares(run_time, budget)


def pairwise_share(first: Array, second: Array, factor: float = 1.0) -> float:
    """Share of problems that the first of two methods solves within a factor of the time of the second.

    Parameters
    ----------
    first, second
        Run times of the two methods (problems) [s]; infinite where the problem was not solved.
    factor
        The factor; at one, the first is at least as fast.

    Returns
    -------
    float
        Share of all problems. What the first alone solves counts for it, whatever the factor. The value at the factor t
        is that of a performance profile of these two methods, which no third can change.

    Examples
    --------
    >>> import numpy as np
    >>> first, second = np.array([1.0, 3.0, np.inf, 9.0]), np.array([2.0, 1.0, 1.0, np.inf])
    >>> pairwise_share(first, second), pairwise_share(second, first), pairwise_share(first, second, 5.0)
    (0.5, 0.5, 0.75)
    """
    solved = np.isfinite(first)
    with np.errstate(invalid="ignore"):
        return float(np.mean(solved & (first <= factor * second)))


def pairwise_matrix(run_time: Array, factor: float = 1.0) -> Array:
    """Pairwise shares (methods, methods), row against column, of run times (methods, problems) [s].

    Examples
    --------
    >>> import numpy as np
    >>> pairwise_matrix(np.array([[1.0, 4.0], [2.0, np.inf]])).tolist()
    [[1.0, 1.0], [0.0, 0.5]]
    """
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
    """Geometric mean of shifted values, shifted back; small values do not dominate it.

    Parameters
    ----------
    values
        Values (n), not negative.
    shift
        Shift, in the unit of the values.

    Examples
    --------
    >>> import numpy as np
    >>> round(shifted_geometric_mean(np.array([1.0, 7.0]), 1.0), 12)
    3.0
    """
    return float(np.exp(np.mean(np.log(values + shift))) - shift)


def waiting_solvers(dataset: xr.Dataset) -> dict[str, float]:
    """Solvers whose wall time exceeds their processor time by more than `WAITING_EXCESS`: other work took their turn.

    Parameters
    ----------
    dataset
        Result of ``compare``.

    Returns
    -------
    dict
        Median of wall over processor time of calls with an answer, by solver; empty where solvers had more than one
        thread.
    """
    if int(dataset.attrs.get("threads", 1)) != 1:
        return {}
    found = {}
    ratios = dataset["run_time"].values / np.maximum(dataset["processor_time"].values, 1e-9)
    answered = np.isfinite(ratios) & np.isfinite(dataset["worst_residual"].values)
    for solver in dict.fromkeys(dataset["solver"].values.tolist()):
        own = ratios[answered & (dataset["solver"].values == solver)]
        if own.size and np.median(own) > 1.0 + WAITING_EXCESS:
            found[str(solver)] = float(np.median(own))
    return found


def growth(size: Array, run_time: Array) -> tuple[float, float] | None:
    """Fit run_time = factor size^exponent by least squares of the logarithms, over the larger half of the sizes.

    Small problems show the cost of the call, not of the method. The larger half is that of the logarithmic scale,
    from the geometric mean of the smallest and the largest size, but at least three sizes.

    Parameters
    ----------
    size
        Numbers of segments (n).
    run_time
        Run times (n) [s]; infinite ones are left out.

    Returns
    -------
    tuple or None
        Factor and exponent; ``None`` if the sizes are too few or too close together.

    Examples
    --------
    >>> import numpy as np
    >>> factor, exponent = growth(np.array([1.0, 10.0, 20.0, 40.0]), np.array([9.0, 1.0, 4.0, 16.0]))
    >>> round(factor, 12), round(exponent, 12)
    (0.01, 2.0)
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


#: Accuracies of the diagram.
ACCURACIES = 10.0 ** -np.arange(1.0, 13.0)


@dataclass(frozen=True, eq=False)
class WorkPrecision:
    """Work and precision of one solver.

    Attributes
    ----------
    solver
        Its name.
    accuracy
        Certificates that are asked for (m).
    share
        Share of problems on which some run reaches the accuracy (m).
    run_time
        Median over all problems of the time of the fastest such run (m) [s]; infinite where half of them have none.
    """

    solver: str
    accuracy: Array
    share: Array
    run_time: Array


@dataclass(frozen=True)
class SweepPoint:
    """Runs of one solver with one tolerance.

    Attributes
    ----------
    solver
        Its name.
    tolerance
        Given to the solver; zero for its settings of the headline.
    problems
        Number of problems.
    claimed, missed
        Problems that it says it solved, and those of them on which it misses the tolerance that it was given, see
        `MISS_FACTOR`; none where it was given none.
    median, worst
        Median and largest certificate; infinite without an answer.
    posed
        Largest residual on the problems as it got them; infinite without an answer.
    run_time
        Median run time of all runs that ended [s].
    """

    solver: str
    tolerance: float
    problems: int
    claimed: int
    missed: int
    median: float
    worst: float
    posed: float
    run_time: float


def has_sweep(dataset: xr.Dataset) -> bool:
    """Whether a comparison has a sweep of tolerances."""
    return bool((dataset["settings"].values == SWEEP).any())


def work_precision(dataset: xr.Dataset) -> list[WorkPrecision]:
    """Work and precision of every solver of a comparison, in the order of the table, its headline runs included."""
    runs = _runs(dataset)
    result = []
    for solver in dict.fromkeys(runs["solver"]):
        own = runs[runs["solver"] == solver]
        best = np.array(
            [
                own["run_time"].where(own["worst"] <= accuracy, np.inf).groupby([own[c] for c in PROBLEM_COLUMNS]).min()
                for accuracy in ACCURACIES
            ]
        )
        result.append(WorkPrecision(solver, ACCURACIES, np.isfinite(best).mean(axis=1), _medians(best)))
    return result


def sweep_points(dataset: xr.Dataset) -> list[SweepPoint]:
    """Outcome of every solver at every tolerance, in the order of the table."""
    runs = _runs(dataset)
    result = []
    for (solver, tolerance), found in runs.groupby(["solver", "solver_tolerance"], sort=False):
        ended = found["run_time"].to_numpy(dtype=float)
        ended = ended[np.isfinite(ended)]
        worst = found["worst"].to_numpy(dtype=float)
        result.append(
            SweepPoint(
                str(solver),
                float(tolerance),
                len(found),
                int(found["claims"].sum()),
                int(found["missed"].sum()),
                _median(worst),
                float(worst.max()),
                float(found["posed"].max()),
                float(np.median(ended)) if ended.size else np.inf,
            )
        )
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


def _median(values: Array) -> float:
    return float(_medians(values[np.newaxis])[0])
