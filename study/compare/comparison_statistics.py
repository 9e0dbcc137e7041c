"""Numbers of a comparison: success, run times, residuals, performance profile, growth with size."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.problem.certificate import EXACT_TOLERANCE
from ...contact.solvers.solution import SOLVED
from .attempt import SETTINGS

Array = NDArray[np.float64]

#: Shift of the geometric mean of run times [s]: differences far below it do not count.
SHIFT = 1e-3
#: Sizes a fit of the growth needs: how many, and the least ratio of the largest to the smallest.
FEWEST_SIZES, LEAST_RATIO = 3, 1.5

#: What is compared: a solver with settings and a start.
METHOD = ["solver", "settings", "start"]
PROBLEM = ["problem_file", "problem"]


def by_problem(dataset: xr.Dataset) -> Any:
    """Return a data frame with one row a method and problem, its repetitions taken together.

    Columns
    -------
    size : int
    kind : str
    claims : bool
        Every repetition says it solved the problem.
    certified, exact : bool
        Every repetition is certified, at the tolerance of the comparison and at `EXACT_TOLERANCE`.
    false_claim : bool
        Some repetition says it solved the problem and is not certified.
    denied : bool
        Some repetition is certified though it does not say solved.
    polished : bool
        Every repetition gave a polished answer.
    run_time : float
        Median over the repetitions [s]; infinite unless certified.
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
    groups = frame.groupby([*METHOD, *PROBLEM], sort=False)
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
    """Solver, settings and start of every method of `by_problem`: by settings, then in the order of the table."""
    found = [tuple(row) for row in problems[METHOD].drop_duplicates().itertuples(index=False)]
    solvers, settings = list(dict.fromkeys(problems["solver"])), list(SETTINGS)
    return sorted(found, key=lambda m: (settings.index(m[1]), solvers.index(m[0]), m[2]))


def of_method(frame: Any, method: tuple[str, str, str]) -> Any:
    """Rows of one method."""
    solver, settings, start = method
    return frame[(frame["solver"] == solver) & (frame["settings"] == settings) & (frame["start"] == start)]


def shifted_geometric_mean(values: Array, shift: float) -> float:
    """Geometric mean of values shifted up, shifted back: small values do not dominate as in the plain one.

    Parameters
    ----------
    values : (n) array
        Not negative. Of one kind only; a mean of residuals says nothing, because the shift would drown them.
    shift : float
        In the unit of the values.

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
    run_time : (methods, problems) array
        [s]; infinite where the problem was not solved.

    Returns
    -------
    factor : (m) array
        From 1 upwards; where any of the curves steps.
    share : (methods, m) array
        Share of all problems solved within this factor, those that nobody solved included.

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

    Small problems show the cost of the call, whatever the method. Half is meant on the logarithmic scale: the fit
    begins at the geometric mean of the smallest and the largest size.

    Parameters
    ----------
    size, run_time : (n) array
        Problems without a finite time are left out.

    Returns
    -------
    (factor, exponent) or None
        None where there are too few sizes, or they are too close together, to tell.

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
    if sizes.size < FEWEST_SIZES or sizes[-1] < LEAST_RATIO * sizes[0]:
        return None
    exponent, offset = np.polyfit(np.log(size), np.log(run_time), 1)
    return float(np.exp(offset)), float(exponent)
