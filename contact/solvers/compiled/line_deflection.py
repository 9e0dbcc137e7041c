# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Line contact of segments: deflection over line load, and the force at an indentation, see ``weber_line_contact``.

Of a strip that is cut by an edge, see ``weber_line_contact``, the half-width a stands for b, and where the bodies come
closest beyond the edge the deflection is that of the overhang more. Compiled; the columns of the parameters are those
of `WeberLineContact.parameters`.
"""

from __future__ import annotations

from typing import Any

import cython

if not cython.compiled:
    from math import asinh, log

    from numpy import sqrt

MAX_INVERSION_STEPS = 30
INVERSION_TOLERANCE = 1e-8
#: Error of the guess, relative to the indentation, up to which its tangent is used.
NEAR = 0.3


def strip(law: Any, i: int, load: float) -> tuple[float, float]:
    """Secant and tangent of the deflection of segment ``i`` over the line load."""
    width, e, floor, least, rise, correction, cutting = (
        law[i, 7], law[i, 8], law[i, 9], law[i, 10], law[i, 11], law[i, 12], law[i, 13],
    )  # fmt: skip
    if load < floor:
        bend = rise * max(load, 0.0)
        return least + bend, least + 2.0 * bend
    squared = width * load
    half, growth, cut, slope = sqrt(squared), 0.5, 0.0, 0.0
    before = e < 0.0 and e > -half
    if e >= 0.0 or before:  # not where it is NaN
        half = squared / (sqrt(e * e + 3.0 * squared) + e)
    if e >= 0.0:
        ends, twice = 2.0 * e + 3.0 * half, 2.0 * e + 6.0 * half
        growth, cut = ends / twice, 2.0 * e / ends
        slope = cut * (1.0 - 3.0 * half / twice)
    secant, tangent = correction + cutting * cut, correction + cutting * slope
    for body in range(2):
        h, unit, contraction = law[i, 1 + body], law[i, 3 + body], law[i, 5 + body]
        s = sqrt(h * h + half * half)
        logarithm = log((h + s) / half) if h > half else asinh(h / half)
        share = h / (s + h)
        if before:
            first = -e
            start = asinh(h / first) - contraction * h / (sqrt(h * h + e * e) + h)
            rest = 0.5 * (1.0 - contraction) * h
            gained = 3.0 * (half * half * (logarithm - contraction * share) - e * e * start)
            gained += 2.0 * e * (half * logarithm + rest * asinh(half / h))
            gained -= 2.0 * e * (first * asinh(h / first) + rest * asinh(first / h))
            secant += unit * (e * e * start + gained) / squared
            tangent += unit * (logarithm - 0.5 * (1.0 + contraction) * h / s)
        else:
            secant += unit * (logarithm - contraction * share)
            drop = share * (1.0 - growth * (s - h) / s)
            tangent += unit * (logarithm - growth * h / s - contraction * drop)
    return secant, tangent


def pressed(law: Any, i: int, indentation: float, guess: float) -> tuple[float, float]:
    """Force and stiffness of segment ``i`` at an indentation, from a force of the usual size."""
    length = law[i, 0]
    load = guess / length
    secant, tangent = strip(law, i, load)
    error = indentation - secant * load
    load = load + error / tangent if abs(error) < NEAR * indentation else indentation / secant
    steps = 0
    while abs(error) > INVERSION_TOLERANCE * indentation and steps < MAX_INVERSION_STEPS:
        secant, tangent = strip(law, i, load)
        error = indentation - secant * load
        load = max(load + error / tangent, 0.0)
        steps += 1
    return load * length, length / tangent


def tangent_root(law: Any, i: int, force: float) -> float:
    """Root of the stiffness of segment ``i`` at a force."""
    length = law[i, 0]
    _secant, tangent = strip(law, i, force / length)
    root: float = sqrt(length / tangent)
    return root


def deflections(law: Any, segment: Any, load: Any, slopes: Any) -> None:
    """Secants and tangents (2, m) of the deflection at line loads (m) of segments (m)."""
    for k in range(load.shape[0]):
        secant, tangent = strip(law, segment[k], load[k])
        slopes[0, k], slopes[1, k] = secant, tangent
