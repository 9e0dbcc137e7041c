"""Run-time statistics: shifted geometric mean, growth with the number of segments, and who waited for the processor."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]

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
