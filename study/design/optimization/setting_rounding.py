"""Settings rounded to the steps of the machine, the way that the model of their analysis likes best.

The nearest steps may pass a limit that the settings keep. Neighbouring ones are tried by the model alone, as far as the
ease-off stays what it is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .analysed_settings import AnalysedSettings
from .step_programme import LIMIT_MARGIN, SINGLE_REACH, VIOLATION_PRICE, judged_objective

Array = NDArray[np.float64]

#: Numbers of steps that one setting is moved by, and the most rounds through all settings.
STEP_COUNTS = (64, 16, 4, 1)
ROUND_COUNT_LIMIT = 50
#: Largest change of the ease-off by rounding [um], unless the nearest steps change it more.
ROUNDING_REACH = 0.3


def rounded_settings(point: AnalysedSettings) -> Array:
    """Settings (n) that can be set, near analysed ones, in the units of the case file.

    Parameters
    ----------
    point
        The analysed settings.
    """
    space, units = point.workshop.space, point.workshop.units
    model, judgement = point.model(1.0), point.judgement

    def reach(values: Array) -> float:
        """Change of the ease-off [um]; that by one setting alone counts as in a programme."""
        step = (values - point.values) / units
        return float(max(np.abs(model.reach @ step).max(), np.abs(step).max() / SINGLE_REACH))

    def merit(values: Array) -> float:
        step = (values - point.values) / units
        ratios = [np.array([one.value(step) for one in group]) for group in model.objectives]
        passed = [max(one.value(step) for one in group) - 1.0 + 0.5 * LIMIT_MARGIN for group in model.limits]
        price = VIOLATION_PRICE * sum(max(0.0, excess) for excess in passed)
        return judged_objective(ratios, judgement.weights, judgement.aim.form) + price

    best = space.nearest(point.values)
    least, most = merit(best), max(reach(best), ROUNDING_REACH)
    for _ in range(ROUND_COUNT_LIMIT):
        before = least
        for number, step in enumerate(space.steps):
            for count in (sign * size for size in STEP_COUNTS for sign in (1, -1)):
                tried = best.copy()
                tried[number] += count * step
                tried = space.nearest(tried)
                if reach(tried) > most:
                    continue
                found = merit(tried)
                if found < least - 1e-9:
                    best, least = tried, found
        if least == before:
            break
    return best
