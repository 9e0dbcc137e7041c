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
    """Write the least gaps of points (n) as gear rotations [rad] to ``least``.

    ``step`` is that of the mesh cycle at the roll angle, ``reach`` [rad] the search beside it at shares ``sample``,
    ``kept`` the least share of its curvature the gap keeps, ``error`` [rad] that of one cycle with both ends.
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
