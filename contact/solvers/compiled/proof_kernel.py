# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Start and end of a solution: first contact of the rigid bodies, springs without coupling, and the proof.

Compiled. The methods are those of ``first_contact``, ``scaled_problem`` and ``certificate``.
"""

from __future__ import annotations

import math
from typing import Any

import cython

if not cython.compiled:
    from math import isfinite, ldexp

    from numpy import sqrt

    def ilogb(x: float) -> int:
        """Exponent of a number."""
        return math.frexp(x)[1] - 1


INFINITY = math.inf
MAX_CHANGES = 4
MAX_WINKLER_STEPS = 60
CANCELLATION_FLOOR = 1e-5
UNIT_ROUNDOFF, SPLITTER, UNDERFLOW = 2.0**-53, 134217729.0, 1e-318
ERROR_FREE, PLAIN = 2.0**-103, 2.0**-51


def _product_error(one: float, other: float, product: float) -> float:
    """Rounding error of a product, by Dekker's splitting."""
    big = SPLITTER * one
    high = big - (big - one)
    low = one - high
    big = SPLITTER * other
    other_high = big - (big - other)
    other_low = other - other_high
    return low * other_low - (((product - high * other_high) - low * other_high) - high * other_low)


def _shift(separation: Any, arm: Any, first: int, shifted: Any) -> bool:
    """Separations from the contact of one segment; whether they are finite."""
    size, turned = shifted.shape[0], -separation[first]
    if turned == 0.0:
        for i in range(size):
            shifted[i] = separation[i]
        return True
    scale = ldexp(1.0, -1 - ilogb(arm[first]))
    lever = arm[first] * scale
    finite = 0.0
    for i in range(size):
        a, b = separation[i], arm[i] * scale
        p, q = a * lever, b * turned
        rest = _product_error(a, lever, p) + _product_error(b, turned, q)
        total = p + q
        second = total - p
        rest += (p - (total - second)) + (q - second)
        shifted[i] = (total + rest) / lever
        finite += 0.0 * shifted[i]
    shifted[first] = 0.0
    return finite == 0.0


def first_contact(separation: Any, arm: Any, shifted: Any) -> tuple[float, float, float]:
    """Rotation at which the rigid bodies touch, its remainder, and the error; the separations from there."""
    size = shifted.shape[0]
    least, first = INFINITY, 0
    for i in range(size):
        if arm[i] > 0.0:
            ratio = separation[i] / arm[i]
            if ratio < least:
                least, first = ratio, i
    error = ERROR_FREE
    for change in range(MAX_CHANGES + 1):
        if not _shift(separation, arm, first, shifted):
            error, turned = PLAIN, separation[first] / arm[first]
            for i in range(size):
                shifted[i] = separation[i] - turned * arm[i]
            shifted[first] = 0.0
        least, other = 0.0, first
        for i in range(size):
            if arm[i] > 0.0 and shifted[i] < 0.0 and shifted[i] / arm[i] < least:
                least, other = shifted[i] / arm[i], i
        if other == first or change == MAX_CHANGES:
            break
        first, error = other, ERROR_FREE
    for i in range(size):
        if arm[i] > 0.0:
            shifted[i] = max(shifted[i], 0.0)
    touching, lever = separation[first], arm[first]
    rotation = touching / lever
    product = rotation * lever
    remainder = ((touching - product) - _product_error(rotation, lever, product)) / lever
    return rotation, remainder if isfinite(remainder) else 0.0, error


def winkler_rotation(stiff: Any, separation: Any, arm: Any, total: int, torque: float) -> float:
    """Rotation at which springs without coupling balance the torque, from above: a convex function of one number."""
    top, bottom = torque, 0.0
    for x in range(total):
        if arm[x] > 0.0:
            weight = stiff[x] * arm[x]
            top += weight * separation[x]
            bottom += weight * arm[x]
    rotation = top / bottom
    for _step in range(MAX_WINKLER_STEPS):
        top, bottom = torque, 0.0
        for x in range(total):
            if arm[x] > 0.0 and rotation * arm[x] > separation[x]:
                weight = stiff[x] * arm[x]
                top += weight * separation[x]
                bottom += weight * arm[x]
        if not bottom > 0.0:
            break
        turned = top / bottom
        if not turned < rotation * (1.0 - 1e-3):
            break
        rotation = turned
    return rotation


def certificate(
    force: Any, deflection: Any, gap: Any, shifted: Any, arm: Any, diagonal: Any, torque: float, terms: float,
    shift_error: float, numbers: Any,
) -> None:  # fmt: skip
    """Violations of the conditions of the contact problem, and their rounding.

    Parameters
    ----------
    force, deflection, gap
        Of the answer (n).
    shifted, arm
        Separation from first contact, lever arm (n).
    diagonal
        Of the compliance (n).
    torque
        About the gear axis.
    terms, shift_error
        Terms of a deflection, and the error of the shift over the lever arm.
    numbers
        Of the answer (10), the first two given: rotation, that beyond first contact, moment, force, gap,
        complementarity, duality, resolution, cancellation.
    """
    size, elastic, finite = force.shape[0], numbers[1], isfinite(numbers[0])
    total = moment = size_of_moment = strain = work = preload = rooted = 0.0
    largest, least_force, far, softest, longest = 0.0, INFINITY, 0.0, 0.0, 0.0
    for i in range(size):
        magnitude = abs(force[i])
        total += magnitude
        moment += force[i] * arm[i]
        size_of_moment += magnitude * abs(arm[i])
        strain += magnitude * abs(deflection[i])
        work += force[i] * (deflection[i] + shifted[i])
        preload += magnitude * abs(shifted[i])
        if magnitude > 0.0:
            rooted += magnitude * sqrt(diagonal[i])
        largest = max(largest, magnitude)
        least_force = min(least_force, force[i])
        far = max(far, abs(shifted[i]))
        softest, longest = max(softest, diagonal[i]), max(longest, abs(arm[i]))
        finite = finite and isfinite(gap[i]) and isfinite(force[i])
    if not finite:
        for k in range(2, 9):
            numbers[k] = INFINITY
        return
    scale, cancellation = 0.0, 1.0
    if total > 0.0:
        mean, uncancelled = strain / total, rooted * rooted / total
        if max(mean, rooted) > 0.0:  # the square of small roots may be none
            uncancelled = max(max(uncancelled, preload / total), abs(elastic) * size_of_moment / total)
            scale = max(mean, CANCELLATION_FLOOR * uncancelled)
            cancellation = max(uncancelled / mean, 1.0) if mean > 0.0 else INFINITY
    if not scale > 0.0:
        scale = far if far > 0.0 else 1.0
    penetration, shared = 0.0, 0.0
    for i in range(size):
        penetration = max(penetration, -gap[i])
        shared = max(shared, min(force[i] / largest if largest > 0.0 else force[i], gap[i] / scale))
    moment_scale, energy_scale = max(torque, CANCELLATION_FLOOR * size_of_moment), total * scale + preload
    numbers[2] = _relative(abs(moment - torque), moment_scale)
    numbers[3] = _relative(max(-least_force, 0.0), largest)
    numbers[4] = penetration / scale
    numbers[5] = shared
    numbers[6] = _relative(abs(work - elastic * torque), energy_scale)
    # Rounding: see ``certificate.rounded_residuals``.
    unknown = terms * UNIT_ROUNDOFF * rooted * sqrt(softest) + UNDERFLOW
    unknown += (6.0 * UNIT_ROUNDOFF * abs(elastic) + shift_error) * longest
    rounding = (size + 4) * UNIT_ROUNDOFF
    of_work = total * unknown + rounding * (strain + preload + abs(elastic * torque))
    resolution = max(unknown / scale, _relative(rounding * size_of_moment, moment_scale))
    numbers[7] = max(resolution, _relative(of_work, energy_scale) if total > 0.0 else 0.0)
    numbers[8] = max(cancellation, size_of_moment / torque if torque > 0.0 else 1.0)


def _relative(error: float, scale: float) -> float:
    if error == 0.0:
        return 0.0
    return error / scale if scale > 0.0 else INFINITY
