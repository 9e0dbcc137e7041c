"""Work against precision: the time a solver needs for a certified accuracy, from a sweep of its tolerances.

What a solver calls its tolerance is compared with quantities of its own. So the precision is read off the certificate,
the same for all: for each accuracy, the time of the fastest of a solver's runs whose certificate reaches it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..measurement.method import COLD, HEADLINE, SWEEP
from .method_statistics import PROBLEM_COLUMNS, attempts_of

Array = NDArray[np.float64]

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
