"""Comparison statistics: certified problems, run times, performance profile, growth with size."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.problem.certificate import EXACT_TOLERANCE
from ...contact.solvers.solution import SOLVED
from .attempt import SETTINGS

Array = NDArray[np.float64]

#: Shift of the geometric mean of run times [s]; differences far below it do not count.
RUN_TIME_SHIFT = 1e-3
#: Least number of sizes for a fit of the growth, and least ratio of the largest to the smallest.
SIZE_COUNT_MINIMUM, SIZE_RATIO_MINIMUM = 3, 1.5

#: Columns that name a method: a solver with settings and a start.
METHOD_COLUMNS = ["solver", "settings", "start"]
#: Columns that name a problem.
PROBLEM_COLUMNS = ["problem_file", "problem"]


def by_problem(dataset: xr.Dataset) -> Any:
    """Data frame with a row a method and problem, all repetitions together.

    Returns
    -------
    DataFrame
        Columns besides method, problem, ``size`` and ``kind``: ``claims``, every repetition claims to have solved the
        problem; ``certified`` and ``exact``, every repetition is certified, to the tolerance of the comparison and to
        ``EXACT_TOLERANCE``; ``false_claim``, some repetition claims so and is not certified; ``denied``, some
        repetition is certified but does not claim so; ``polished``, every answer is polished; ``run_time``, median over
        the repetitions [s], infinite unless certified.
    """
    frame: Any = dataset.to_dataframe()
    certified, solved = frame["certified"] == 1, frame["claim"] == SOLVED
    frame = frame.assign(
        claims=solved,
        certified=certified,
        exact=frame["worst_residual"] <= EXACT_TOLERANCE,
        false_claim=solved & ~certified,
        denied=certified & ~solved,
    )
    groups = frame.groupby([*METHOD_COLUMNS, *PROBLEM_COLUMNS], sort=False)
    result = groups.agg(
        size=("size", "first"),
        kind=("kind", "first"),
        claims=("claims", "all"),
        certified=("certified", "all"),
        exact=("exact", "all"),
        polished=("polished", "all"),
        false_claim=("false_claim", "any"),
        denied=("denied", "any"),
        run_time=("run_time", "median"),
    ).reset_index()
    result["run_time"] = result["run_time"].where(result["certified"] & result["run_time"].notna(), np.inf)
    return result


def methods(problems: Any) -> list[tuple[str, str, str]]:
    """Solver, settings and start of every method of ``by_problem``, by settings, then in the order of the table."""
    found = [tuple(row) for row in problems[METHOD_COLUMNS].drop_duplicates().itertuples(index=False)]
    solvers, settings = list(dict.fromkeys(problems["solver"])), list(SETTINGS)
    return sorted(found, key=lambda m: (settings.index(m[1]), solvers.index(m[0]), m[2]))


def of_method(frame: Any, method: tuple[str, str, str]) -> Any:
    """Rows of a method."""
    solver, settings, start = method
    return frame[(frame["solver"] == solver) & (frame["settings"] == settings) & (frame["start"] == start)]


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
    order of two methods can change when a third is taken away (Gould and Scott 2016, doi 10.1145/2950048).

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
    share = (ratio[:, :, np.newaxis] <= factor).mean(axis=1)
    return factor, share


def growth(size: Array, run_time: Array) -> tuple[float, float] | None:
    """Fit run_time = factor size^exponent by least squares of the logarithms, over the larger half of the sizes.

    Small problems show the cost of the call, not of the method. The larger half is that of the logarithmic scale,
    from the geometric mean of the smallest and the largest size.

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
    known &= size >= np.sqrt(size[known].min() * size[known].max())
    size, run_time = size[known], run_time[known]
    sizes = np.unique(size)
    if sizes.size < SIZE_COUNT_MINIMUM or sizes[-1] < SIZE_RATIO_MINIMUM * sizes[0]:
        return None
    exponent, offset = np.polyfit(np.log(size), np.log(run_time), 1)
    return float(np.exp(offset)), float(exponent)
