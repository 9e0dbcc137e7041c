"""Profiles of run times: performance profile, data profile and pairwise profile."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
