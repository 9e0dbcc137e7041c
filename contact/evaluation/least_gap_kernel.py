# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Least gap beside the contact of points: the search of ``marking_print``, one point after another. Compiled."""

from __future__ import annotations

import math
from typing import Any

import cython

if not cython.compiled:
    from math import floor, isnan

INFINITY = math.inf


def least_beside(
    ease_off: Any, curvature: Any, skew: Any, step: Any, reach: Any, sample: Any,
    steps_per_rotation: float, per_cycle: float, kept: float, error: Any, rounds: int, least: Any,
) -> None:  # fmt: skip
    """Least gaps as gear rotations.

    Parameters
    ----------
    ease_off, curvature, skew, step, reach
        Of the points (n): ease-off [rad], separation curvature and skew, the step of the mesh cycle at their roll
        angle, and how far beside it is searched [rad].
    sample
        Shares of the reach at which the gap is looked at (k).
    steps_per_rotation, per_cycle
        Steps per pinion rotation [1/rad], and of a mesh cycle.
    kept
        Least share of its curvature that the gap must keep.
    error
        Least transmission error over one mesh cycle, evenly spaced, with both ends (m) [rad].
    rounds
        Of the search.
    least
        For the results (n) [rad].
    """
    last, tried = error.shape[0] - 1, sample.shape[0]
    density = last / per_cycle
    for n in range(least.shape[0]):
        best, way, lowest = 0.0, reach[n], INFINITY
        for _ in range(rounds):
            lowest, place = INFINITY, best + sample[0] * way
            for k in range(tried):
                beyond = best + sample[k] * way
                if not (beyond == 0.0 or curvature[n] + min(skew[n] * beyond, 0.0) > kept * curvature[n]):
                    continue
                x = step[n] + beyond * steps_per_rotation
                x = (x - floor(x / per_cycle) * per_cycle) * density
                j = int(min(x, last - 1.0)) if x > 0.0 else 0
                carried = error[j] + (error[j + 1] - error[j]) * (x - j)
                gap = ease_off[n] + beyond * beyond * (0.5 * curvature[n] + beyond * skew[n] / 6.0) - carried
                if not gap >= lowest:
                    lowest, place = gap, beyond
                    if isnan(gap):
                        break
            best, way = place, 2.0 * way / (tried - 1)
        least[n] = lowest
