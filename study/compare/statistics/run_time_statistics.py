"""Run-time statistics: shifted geometric mean, and growth with the number of segments within one kind of problem."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Shift of the geometric mean of run times [s]; differences far below it do not count.
RUN_TIME_SHIFT = 1e-3
#: Least number of sizes for a fit of the growth, and least ratio of the largest to the smallest.
SIZE_COUNT_MINIMUM, SIZE_RATIO_MINIMUM = 3, 1.5


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
