"""Newton's method in the bending modes, compiled: contact problems from the given data to the certificate.

The method is that of ``modal_newton``, one problem after another: the first contact of the rigid bodies, a start from
uncoupled springs, Newton's steps with their line search, gaps and certificate. Three things differ. The unknowns are
modal amplitudes and rotation, whatever the number of segments; so the problem is first solved on a part of the
segments of each block, see ``mode_columns``, each standing for its neighbours, and this answer starts the whole. Where
fewer segments of a block touch than it has modes, its matrix is inverted by Woodbury's identity. As long as the
touching segments of a block stay the same and the law is linear, its factor is kept.

Shared modes stand behind those of a block as its shared columns; their amplitudes in a block, M_b a, follow from the
amplitudes a, which stand behind those of all blocks.

All of it is in this one file, see ``compilation``.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from ....core.compiled.compilation import compiled, readable

MAX_ITERATIONS = 60
MAX_HALVINGS = 20
ROUNDING_RESIDUAL, STALLED_RESIDUAL = 2e-15, 1e-8
ROUNDING_SLOPE = 1e-12
#: Steps on a part of the segments, and the residual at which they end where the law is not linear.
MAX_COARSE_ITERATIONS, COARSE_RESIDUAL = 12, 1e-2
WINKLER_ROW_SUM_FRACTION = 0.4
#: Part of the segments that is taken to touch before anything is known.
TOUCHING_GUESS = 0.4
MAX_INVERSION_STEPS = 30
INVERSION_TOLERANCE = 1e-8
#: Error of the guess, relative to the indentation, up to which its tangent is used.
NEAR = 0.3
CANCELLATION_FLOOR = 1e-5
#: Columns of the parameters of a line contact.
LENGTH, DEPTHS, UNITS, CONTRACTIONS, WIDTH, OVERHANG, FLOOR, START, BEND, CORRECTION, CUT = (
    0,
    1,
    3,
    5,
    7,
    8,
    9,
    10,
    11,
    12,
    13,
)
#: Columns of the numbers of an answer.
ROTATION, ELASTIC, EQUILIBRIUM, NEGATIVE_FORCE, NEGATIVE_GAP, COMPLEMENTARITY, DUALITY, RESOLUTION, CANCELLATION = (
    range(9)
)
STIFFNESS = 9
#: As in ``error_free``, ``first_contact`` and ``residuals``.
UNIT_ROUNDOFF, SPLITTER, UNDERFLOW = 2.0**-53, 134217729.0, 1e-318
ERROR_FREE, PLAIN, MAX_CHANGES = 2.0**-103, 2.0**-51, 4


_sums = compiled(fastmath={"reassoc", "contract", "nsz"})  # sums in any order, by several at a time
_exact = compiled()


@_exact
def _shift(separation: Any, arm: Any, first: int, shifted: Any) -> bool:
    """Separations from the contact of one segment, see ``first_contact``; whether they are finite."""
    size, own = shifted.size, separation[first]
    if own == 0.0:
        shifted[:] = separation
        return True
    scale = math.ldexp(1.0, -math.frexp(arm[first])[1])
    lever, turned = arm[first] * scale, -own
    big = SPLITTER * lever
    high_lever = big - (big - lever)
    low_lever = lever - high_lever
    big = SPLITTER * turned
    high_turned = big - (big - turned)
    low_turned = turned - high_turned
    finite = 0.0
    for i in range(size):
        a, b = separation[i], arm[i] * scale
        p, q = a * lever, b * turned
        big = SPLITTER * a
        high = big - (big - a)
        low = a - high
        rest = low * low_lever - (((p - high * high_lever) - low * high_lever) - high * low_lever)
        big = SPLITTER * b
        high = big - (big - b)
        low = b - high
        rest += low * low_turned - (((q - high * high_turned) - low * high_turned) - high * low_turned)
        total = p + q
        second = total - p
        rest += (p - (total - second)) + (q - second)
        shifted[i] = (total + rest) / lever
        finite += 0.0 * shifted[i]
    shifted[first] = 0.0
    return finite == 0.0


@_exact
def _first_contact(separation: Any, arm: Any, shifted: Any) -> tuple[float, float, float]:
    """Rotation at which the rigid bodies touch, its remainder, and the error; the separations from there."""
    size = shifted.size
    least, first = np.inf, 0
    for i in range(size):
        if arm[i] > 0.0:
            own = separation[i] / arm[i]
            if own < least:
                least, first = own, i
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
    own, lever = separation[first], arm[first]
    rotation = own / lever
    product = rotation * lever
    big, other_big = SPLITTER * rotation, SPLITTER * lever
    high, high_lever = big - (big - rotation), other_big - (other_big - lever)
    low, low_lever = rotation - high, lever - high_lever
    low = low * low_lever - (((product - high * high_lever) - low * high_lever) - high * low_lever)
    remainder = ((own - product) - low) / lever
    return rotation, remainder if math.isfinite(remainder) else 0.0, error


@_exact
def _strip(p: Any, load: float) -> tuple[float, float]:
    """Secant and tangent of the deflection over the line load, see ``weber_line_contact``."""
    if load < p[FLOOR]:
        bend = p[BEND] * max(load, 0.0)
        return p[START] + bend, p[START] + 2.0 * bend
    squared = p[WIDTH] * load
    half, growth, cut, slope = math.sqrt(squared), 0.5, 0.0, 0.0
    e = p[OVERHANG]
    before = e < 0.0 and e > -half
    if e >= 0.0 or before:  # not where it is NaN
        half = squared / (math.sqrt(e * e + 3.0 * squared) + e)
    if e >= 0.0:
        ends, twice = 2.0 * e + 3.0 * half, 2.0 * e + 6.0 * half
        growth, cut = ends / twice, 2.0 * e / ends
        slope = cut * (1.0 - 3.0 * half / twice)
    secant, tangent = p[CORRECTION] + p[CUT] * cut, p[CORRECTION] + p[CUT] * slope
    for body in range(2):
        h, unit, contraction = p[DEPTHS + body], p[UNITS + body], p[CONTRACTIONS + body]
        s = math.sqrt(h * h + half * half)
        logarithm = math.log((h + s) / half) if h > half else math.asinh(h / half)
        share = h / (s + h)
        if before:
            first = -e
            start = math.asinh(h / first) - contraction * h / (math.sqrt(h * h + e * e) + h)
            rest = 0.5 * (1.0 - contraction) * h
            gained = 3.0 * (half * half * (logarithm - contraction * share) - e * e * start)
            gained += 2.0 * e * (half * logarithm + rest * math.asinh(half / h))
            gained -= 2.0 * e * (first * math.asinh(h / first) + rest * math.asinh(first / h))
            secant += unit * (e * e * start + gained) / squared
            tangent += unit * (logarithm - 0.5 * (1.0 + contraction) * h / s)
            continue
        secant += unit * (logarithm - contraction * share)
        drop = share * (1.0 - growth * (s - h) / s)
        tangent += unit * (logarithm - growth * h / s - contraction * drop)
    return secant, tangent


@_exact
def _pressed(p: Any, indentation: float, guess: float) -> tuple[float, float]:
    """Force and stiffness of a line contact at an indentation, from a force of the usual size."""
    length = p[LENGTH]
    load = guess / length
    secant, tangent = _strip(p, load)
    error = indentation - secant * load
    load = load + error / tangent if abs(error) < NEAR * indentation else indentation / secant
    steps = 0
    while abs(error) > INVERSION_TOLERANCE * indentation and steps < MAX_INVERSION_STEPS:
        secant, tangent = _strip(p, load)
        error = indentation - secant * load
        load = max(load + error / tangent, 0.0)
        steps += 1
    return load * length, length / tangent


@_sums
def _add_closing(columns: Any, at: int, count: int, rank: int, amplitudes: Any, c0: int, gap: Any, x0: int) -> None:
    """Add U c to the gaps of one block."""
    # Slices that are read from zero on: compiled indices may be negative otherwise, and loops take one at a time.
    own, a = gap[x0 : x0 + count], 0
    while a + 4 <= rank:
        c, d, e, f = amplitudes[c0 + a], amplitudes[c0 + a + 1], amplitudes[c0 + a + 2], amplitudes[c0 + a + 3]
        p, q = columns[at : at + count], columns[at + count : at + 2 * count]
        r, s = columns[at + 2 * count : at + 3 * count], columns[at + 3 * count : at + 4 * count]
        for j in range(count):
            own[j] += c * p[j] + d * q[j] + e * r[j] + f * s[j]
        a, at = a + 4, at + 4 * count
    while a < rank:
        c, p = amplitudes[c0 + a], columns[at : at + count]
        for j in range(count):
            own[j] += c * p[j]
        a, at = a + 1, at + count


@_sums
def _loads(
    columns: Any, own: int, count: int, rank: int, vector: Any, x0: int, low: int, high: int, result: Any, c0: int
) -> None:
    """U' v of one block."""
    v, a, at, length = vector[low:high], 0, own + low - x0, high - low
    while a + 4 <= rank:
        p, q = columns[at : at + length], columns[at + count : at + count + length]
        r, s = columns[at + 2 * count : at + 2 * count + length], columns[at + 3 * count : at + 3 * count + length]
        s0 = s1 = s2 = s3 = 0.0
        for x in range(length):
            s0 += p[x] * v[x]
            s1 += q[x] * v[x]
            s2 += r[x] * v[x]
            s3 += s[x] * v[x]
        result[c0 + a] = s0
        result[c0 + a + 1] = s1
        result[c0 + a + 2] = s2
        result[c0 + a + 3] = s3
        a, at = a + 4, at + 4 * count
    while a < rank:
        p = columns[at : at + length]
        s0 = 0.0
        for x in range(length):
            s0 += p[x] * v[x]
        result[c0 + a] = s0
        a, at = a + 1, at + count


@_sums
def _products(z: Any, rank: int, vector: Any, low: int, high: int, result: Any, c0: int) -> None:
    """Z v of one block."""
    v = vector[low:high]
    for a in range(0, rank, 4):
        p, q, r, s = z[a, low:high], z[a + 1, low:high], z[a + 2, low:high], z[a + 3, low:high]
        s0 = s1 = s2 = s3 = 0.0
        for x in range(high - low):
            s0 += p[x] * v[x]
            s1 += q[x] * v[x]
            s2 += r[x] * v[x]
            s3 += s[x] * v[x]
        result[c0 + a] = s0
        result[c0 + a + 1] = s1
        result[c0 + a + 2] = s2
        result[c0 + a + 3] = s3


@_sums
def _gram(z: Any, rank: int, low: int, high: int, gram: Any) -> None:
    """I + Z Z' of one block, the lower triangle."""
    for a in range(0, rank, 4):
        za, zb, zc, zd = z[a, low:high], z[a + 1, low:high], z[a + 2, low:high], z[a + 3, low:high]
        for b in range(0, a + 1, 4):
            ze, zf, zg, zh = z[b, low:high], z[b + 1, low:high], z[b + 2, low:high], z[b + 3, low:high]
            s00 = s01 = s02 = s03 = s10 = s11 = s12 = s13 = 0.0
            s20 = s21 = s22 = s23 = s30 = s31 = s32 = s33 = 0.0
            for x in range(high - low):
                p, q, r, s = za[x], zb[x], zc[x], zd[x]
                t, u, v, w = ze[x], zf[x], zg[x], zh[x]
                s00 += p * t
                s01 += p * u
                s02 += p * v
                s03 += p * w
                s10 += q * t
                s11 += q * u
                s12 += q * v
                s13 += q * w
                s20 += r * t
                s21 += r * u
                s22 += r * v
                s23 += r * w
                s30 += s * t
                s31 += s * u
                s32 += s * v
                s33 += s * w
            gram[a, b], gram[a, b + 1], gram[a, b + 2], gram[a, b + 3] = s00, s01, s02, s03
            gram[a + 1, b], gram[a + 1, b + 1], gram[a + 1, b + 2], gram[a + 1, b + 3] = s10, s11, s12, s13
            gram[a + 2, b], gram[a + 2, b + 1], gram[a + 2, b + 2], gram[a + 2, b + 3] = s20, s21, s22, s23
            gram[a + 3, b], gram[a + 3, b + 1], gram[a + 3, b + 2], gram[a + 3, b + 3] = s30, s31, s32, s33
    for a in range(rank + (-rank) % 4):
        gram[a, a] += 1.0


@_sums
def _mixed_block(mixed: Any, matrix: Any, edge: int, first: int, shared: int, size: int, result: Any) -> None:
    """M' S of one block, S being symmetric and behind the edge of a matrix; the size is a multiple of four."""
    end = first + shared
    for t in range(0, size, 4):
        za, zb = mixed[t, first:end], mixed[t + 1, first:end]
        zc, zd = mixed[t + 2, first:end], mixed[t + 3, first:end]
        for k in range(shared):
            row = matrix[edge + k, edge : edge + shared]
            s0 = s1 = s2 = s3 = 0.0
            for m in range(shared):
                s0 += za[m] * row[m]
                s1 += zb[m] * row[m]
                s2 += zc[m] * row[m]
                s3 += zd[m] * row[m]
            result[t, first + k], result[t + 1, first + k] = s0, s1
            result[t + 2, first + k], result[t + 3, first + k] = s2, s3


@_sums
def _mixed_gram(y: Any, z: Any, size: int, gram: Any) -> None:
    """I + Y Z', the lower triangle; its size is a multiple of four."""
    for a in range(0, size, 4):
        za, zb, zc, zd = y[a], y[a + 1], y[a + 2], y[a + 3]
        for b in range(0, a + 1, 4):
            ze, zf, zg, zh = z[b], z[b + 1], z[b + 2], z[b + 3]
            s00 = s01 = s02 = s03 = s10 = s11 = s12 = s13 = 0.0
            s20 = s21 = s22 = s23 = s30 = s31 = s32 = s33 = 0.0
            for x in range(za.size):
                p, q, r, s = za[x], zb[x], zc[x], zd[x]
                t, u, v, w = ze[x], zf[x], zg[x], zh[x]
                s00 += p * t
                s01 += p * u
                s02 += p * v
                s03 += p * w
                s10 += q * t
                s11 += q * u
                s12 += q * v
                s13 += q * w
                s20 += r * t
                s21 += r * u
                s22 += r * v
                s23 += r * w
                s30 += s * t
                s31 += s * u
                s32 += s * v
                s33 += s * w
            gram[a, b], gram[a, b + 1], gram[a, b + 2], gram[a, b + 3] = s00, s01, s02, s03
            gram[a + 1, b], gram[a + 1, b + 1], gram[a + 1, b + 2], gram[a + 1, b + 3] = s10, s11, s12, s13
            gram[a + 2, b], gram[a + 2, b + 1], gram[a + 2, b + 2], gram[a + 2, b + 3] = s20, s21, s22, s23
            gram[a + 3, b], gram[a + 3, b + 1], gram[a + 3, b + 2], gram[a + 3, b + 3] = s30, s31, s32, s33
    for a in range(size):
        gram[a, a] += 1.0


@_sums
def _factor(matrix: Any, size: int) -> None:
    """Cholesky factor in place, the inverse of its diagonal on the diagonal; the size is a multiple of four."""
    for i in range(0, size, 4):
        za, zb, zc, zd = matrix[i], matrix[i + 1], matrix[i + 2], matrix[i + 3]
        for j in range(0, i + 1, 4):
            s00, s01, s02, s03 = matrix[i, j], matrix[i, j + 1], matrix[i, j + 2], matrix[i, j + 3]
            s10, s11, s12, s13 = matrix[i + 1, j], matrix[i + 1, j + 1], matrix[i + 1, j + 2], matrix[i + 1, j + 3]
            s20, s21, s22, s23 = matrix[i + 2, j], matrix[i + 2, j + 1], matrix[i + 2, j + 2], matrix[i + 2, j + 3]
            s30, s31, s32, s33 = matrix[i + 3, j], matrix[i + 3, j + 1], matrix[i + 3, j + 2], matrix[i + 3, j + 3]
            ze, zf, zg, zh = matrix[j], matrix[j + 1], matrix[j + 2], matrix[j + 3]
            for t in range(j):
                p, q, r, s = za[t], zb[t], zc[t], zd[t]
                k, u, v, w = ze[t], zf[t], zg[t], zh[t]
                s00 -= p * k
                s01 -= p * u
                s02 -= p * v
                s03 -= p * w
                s10 -= q * k
                s11 -= q * u
                s12 -= q * v
                s13 -= q * w
                s20 -= r * k
                s21 -= r * u
                s22 -= r * v
                s23 -= r * w
                s30 -= s * k
                s31 -= s * u
                s32 -= s * v
                s33 -= s * w
            if i == j:
                d0 = 1.0 / math.sqrt(s00)
                l10, l20, l30 = s10 * d0, s20 * d0, s30 * d0
                d1 = 1.0 / math.sqrt(s11 - l10 * l10)
                l21, l31 = (s21 - l20 * l10) * d1, (s31 - l30 * l10) * d1
                d2 = 1.0 / math.sqrt(s22 - l20 * l20 - l21 * l21)
                l32 = (s32 - l30 * l20 - l31 * l21) * d2
                d3 = 1.0 / math.sqrt(s33 - l30 * l30 - l31 * l31 - l32 * l32)
                matrix[i, i], matrix[i + 1, i + 1], matrix[i + 2, i + 2], matrix[i + 3, i + 3] = d0, d1, d2, d3
                matrix[i + 1, i], matrix[i + 2, i], matrix[i + 3, i] = l10, l20, l30
                matrix[i + 2, i + 1], matrix[i + 3, i + 1], matrix[i + 3, i + 2] = l21, l31, l32
            else:
                d0, d1, d2, d3 = matrix[j, j], matrix[j + 1, j + 1], matrix[j + 2, j + 2], matrix[j + 3, j + 3]
                l10, l20, l30 = matrix[j + 1, j], matrix[j + 2, j], matrix[j + 3, j]
                l21, l31, l32 = matrix[j + 2, j + 1], matrix[j + 3, j + 1], matrix[j + 3, j + 2]
                s00, s10, s20, s30 = s00 * d0, s10 * d0, s20 * d0, s30 * d0
                s01, s11 = (s01 - s00 * l10) * d1, (s11 - s10 * l10) * d1
                s21, s31 = (s21 - s20 * l10) * d1, (s31 - s30 * l10) * d1
                s02, s12 = (s02 - s00 * l20 - s01 * l21) * d2, (s12 - s10 * l20 - s11 * l21) * d2
                s22, s32 = (s22 - s20 * l20 - s21 * l21) * d2, (s32 - s30 * l20 - s31 * l21) * d2
                s03 = (s03 - s00 * l30 - s01 * l31 - s02 * l32) * d3
                s13 = (s13 - s10 * l30 - s11 * l31 - s12 * l32) * d3
                s23 = (s23 - s20 * l30 - s21 * l31 - s22 * l32) * d3
                s33 = (s33 - s30 * l30 - s31 * l31 - s32 * l32) * d3
                matrix[i, j], matrix[i, j + 1], matrix[i, j + 2], matrix[i, j + 3] = s00, s01, s02, s03
                matrix[i + 1, j], matrix[i + 1, j + 1] = s10, s11
                matrix[i + 1, j + 2], matrix[i + 1, j + 3] = s12, s13
                matrix[i + 2, j], matrix[i + 2, j + 1] = s20, s21
                matrix[i + 2, j + 2], matrix[i + 2, j + 3] = s22, s23
                matrix[i + 3, j], matrix[i + 3, j + 1] = s30, s31
                matrix[i + 3, j + 2], matrix[i + 3, j + 3] = s32, s33


@_sums
def _reduce(matrix: Any, size: int, whole: int) -> None:
    """Rows below a factored block: L^-1 of their part beside it, and the Schur complement behind; lower triangle."""
    for i in range(size, whole, 4):
        za, zb, zc, zd = matrix[i], matrix[i + 1], matrix[i + 2], matrix[i + 3]
        for j in range(0, i + 1, 4):
            s00, s01, s02, s03 = matrix[i, j], matrix[i, j + 1], matrix[i, j + 2], matrix[i, j + 3]
            s10, s11, s12, s13 = matrix[i + 1, j], matrix[i + 1, j + 1], matrix[i + 1, j + 2], matrix[i + 1, j + 3]
            s20, s21, s22, s23 = matrix[i + 2, j], matrix[i + 2, j + 1], matrix[i + 2, j + 2], matrix[i + 2, j + 3]
            s30, s31, s32, s33 = matrix[i + 3, j], matrix[i + 3, j + 1], matrix[i + 3, j + 2], matrix[i + 3, j + 3]
            ze, zf, zg, zh = matrix[j], matrix[j + 1], matrix[j + 2], matrix[j + 3]
            for t in range(min(j, size)):
                p, q, r, s = za[t], zb[t], zc[t], zd[t]
                k, u, v, w = ze[t], zf[t], zg[t], zh[t]
                s00 -= p * k
                s01 -= p * u
                s02 -= p * v
                s03 -= p * w
                s10 -= q * k
                s11 -= q * u
                s12 -= q * v
                s13 -= q * w
                s20 -= r * k
                s21 -= r * u
                s22 -= r * v
                s23 -= r * w
                s30 -= s * k
                s31 -= s * u
                s32 -= s * v
                s33 -= s * w
            if j < size:
                d0, d1, d2, d3 = matrix[j, j], matrix[j + 1, j + 1], matrix[j + 2, j + 2], matrix[j + 3, j + 3]
                l10, l20, l30 = matrix[j + 1, j], matrix[j + 2, j], matrix[j + 3, j]
                l21, l31, l32 = matrix[j + 2, j + 1], matrix[j + 3, j + 1], matrix[j + 3, j + 2]
                s00, s10, s20, s30 = s00 * d0, s10 * d0, s20 * d0, s30 * d0
                s01, s11 = (s01 - s00 * l10) * d1, (s11 - s10 * l10) * d1
                s21, s31 = (s21 - s20 * l10) * d1, (s31 - s30 * l10) * d1
                s02, s12 = (s02 - s00 * l20 - s01 * l21) * d2, (s12 - s10 * l20 - s11 * l21) * d2
                s22, s32 = (s22 - s20 * l20 - s21 * l21) * d2, (s32 - s30 * l20 - s31 * l21) * d2
                s03 = (s03 - s00 * l30 - s01 * l31 - s02 * l32) * d3
                s13 = (s13 - s10 * l30 - s11 * l31 - s12 * l32) * d3
                s23 = (s23 - s20 * l30 - s21 * l31 - s22 * l32) * d3
                s33 = (s33 - s30 * l30 - s31 * l31 - s32 * l32) * d3
            matrix[i, j], matrix[i, j + 1], matrix[i, j + 2], matrix[i, j + 3] = s00, s01, s02, s03
            matrix[i + 1, j], matrix[i + 1, j + 1] = s10, s11
            matrix[i + 1, j + 2], matrix[i + 1, j + 3] = s12, s13
            matrix[i + 2, j], matrix[i + 2, j + 1] = s20, s21
            matrix[i + 2, j + 2], matrix[i + 2, j + 3] = s22, s23
            matrix[i + 3, j], matrix[i + 3, j + 1] = s30, s31
            matrix[i + 3, j + 2], matrix[i + 3, j + 3] = s32, s33


@_sums
def _forward(factor: Any, size: int, right: Any, c0: int) -> None:
    """Solve with the factor L, in place."""
    for i in range(0, size, 4):
        s0, s1, s2, s3 = right[c0 + i], right[c0 + i + 1], right[c0 + i + 2], right[c0 + i + 3]
        for t in range(i):
            v = right[c0 + t]
            s0 -= factor[i, t] * v
            s1 -= factor[i + 1, t] * v
            s2 -= factor[i + 2, t] * v
            s3 -= factor[i + 3, t] * v
        s0 *= factor[i, i]
        s1 = (s1 - s0 * factor[i + 1, i]) * factor[i + 1, i + 1]
        s2 = (s2 - s0 * factor[i + 2, i] - s1 * factor[i + 2, i + 1]) * factor[i + 2, i + 2]
        s3 -= s0 * factor[i + 3, i] + s1 * factor[i + 3, i + 1] + s2 * factor[i + 3, i + 2]
        s3 *= factor[i + 3, i + 3]
        right[c0 + i], right[c0 + i + 1], right[c0 + i + 2], right[c0 + i + 3] = s0, s1, s2, s3


@_sums
def _backward(factor: Any, size: int, right: Any, c0: int) -> None:
    """Solve with the transpose of the factor L, in place."""
    for i in range(size - 4, -1, -4):
        s3 = right[c0 + i + 3] * factor[i + 3, i + 3]
        s2 = (right[c0 + i + 2] - s3 * factor[i + 3, i + 2]) * factor[i + 2, i + 2]
        s1 = (right[c0 + i + 1] - s3 * factor[i + 3, i + 1] - s2 * factor[i + 2, i + 1]) * factor[i + 1, i + 1]
        s0 = right[c0 + i] - s3 * factor[i + 3, i] - s2 * factor[i + 2, i] - s1 * factor[i + 1, i]
        s0 *= factor[i, i]
        right[c0 + i], right[c0 + i + 1], right[c0 + i + 2], right[c0 + i + 3] = s0, s1, s2, s3
        for t in range(i):
            right[c0 + t] -= s0 * factor[i, t] + s1 * factor[i + 1, t] + s2 * factor[i + 2, t] + s3 * factor[i + 3, t]


@_sums
def _solve(factor: Any, size: int, right: Any, c0: int) -> None:
    """Solve with the factor, in place."""
    _forward(factor, size, right, c0)
    _backward(factor, size, right, c0)


@_sums
def _dot(a: Any, b: Any) -> float:
    total = 0.0
    for x in range(a.size):
        total += a[x] * b[x]
    return total


@_sums
def _combination(z: Any, size: int, factor: Any, rank: int, result: Any, c0: int) -> None:
    """Z' v of one block of few rows."""
    result[c0 : c0 + rank] = 0.0
    _add_combination(z, size, factor, rank, result, c0)


@_sums
def _add_combination(z: Any, size: int, factor: Any, rank: int, result: Any, c0: int) -> None:
    """Add Z' v."""
    own = result[c0 : c0 + rank]
    for i in range(0, size, 4):
        p, q, r, s = z[i], z[i + 1], z[i + 2], z[i + 3]
        c, d, e, f = factor[i], factor[i + 1], factor[i + 2], factor[i + 3]
        for a in range(rank):
            own[a] += c * p[a] + d * q[a] + e * r[a] + f * s[a]


@_sums
def _spread(blocks: Any, width: int, mixing: Any, plain: bool, shared: Any, result: Any) -> None:
    """Amplitudes of the shared columns in every block, M_b a."""
    first, count, local = blocks.shape[0] * width, mixing.shape[2], mixing.shape[1]
    own = shared[first : first + count]
    for q in range(blocks.shape[0]):
        c0 = q * width + blocks[q, 3]
        if plain:
            for t in range(count):
                result[c0 + t] = own[t]
            continue
        rows = mixing[q]
        for k in range(local):
            total = 0.0
            for t in range(count):
                total += rows[k, t] * own[t]
            result[c0 + k] = total


@_sums
def _gather(blocks: Any, width: int, mixing: Any, plain: bool, loads: Any) -> None:
    """Loads of the shared modes from those of the shared columns in every block, the sum of M_b' x."""
    first, count, local = blocks.shape[0] * width, mixing.shape[2], mixing.shape[1]
    own = loads[first : first + count]
    own[:] = 0.0
    for q in range(blocks.shape[0]):
        c0 = q * width + blocks[q, 3]
        if plain:
            for t in range(count):
                own[t] += loads[c0 + t]
            continue
        rows = mixing[q]
        for k in range(local):
            load = loads[c0 + k]
            for t in range(count):
                own[t] += load * rows[k, t]


@_sums
def _point(blocks: Any, columns: Any, law: Any, linear: bool, given: Any, at: Any, state: Any, work: Any) -> Any:
    """Gaps, forces and their sums at a point.

    Returns moment of the forces, sum of stiffness times squared arm, and whether the touching set has changed; blocks
    in which it has are marked.
    """
    separation, arm, stiffness, segment = given
    amplitudes, rotation = at
    gap, root, pull, lever, force, z = state
    loads, spans, mixing, plain = work
    width, shared = z.shape[0], mixing.shape[1]
    if shared:
        _spread(blocks, width, mixing, plain, amplitudes, amplitudes)
    moment, pivot, changed = 0.0, 0.0, not linear
    for q in range(blocks.shape[0]):
        x0, count, own, rank = blocks[q, 0], blocks[q, 1], blocks[q, 2], blocks[q, 3]
        x1 = x0 + count
        for x in range(x0, x1):
            gap[x] = separation[x] - rotation * arm[x]
        _add_closing(columns, own, count, rank + shared, amplitudes, q * width, gap, x0)
        low, high = x1, x0
        different = not linear
        if linear:
            for x in range(x0, x1):
                if gap[x] < 0.0:
                    if root[x] == 0.0:
                        different = True
                    root[x] = stiffness[x]
                    low, high = min(low, x), x + 1
                else:
                    if root[x] != 0.0:
                        different = True
                    root[x] = 0.0
                pull[x] = -gap[x] * root[x]
        else:
            weight = stiffness[x0]
            for x in range(x0, x1):
                if gap[x] < 0.0:
                    force[x], tangent = _pressed(law[segment[x]], -gap[x], force[x])
                    root[x] = math.sqrt(weight * tangent)
                    pull[x] = weight * force[x] / root[x]
                    low, high = min(low, x), x + 1
                else:
                    root[x] = pull[x] = 0.0
        if different:
            changed = True
            low = min(low, high)
            spans[q, 0], spans[q, 1], spans[q, 2] = low, high, 1
            for x in range(low, high):
                lever[x] = root[x] * arm[x]
        low, high = spans[q, 0], spans[q, 1]
        for x in range(low, high):
            moment += pull[x] * lever[x]
            pivot += lever[x] * lever[x]
            pull[x] *= root[x]
        _loads(columns, own, count, rank + shared, pull, x0, low, high, loads, q * width)
    if shared:
        _gather(blocks, width, mixing, plain, loads)
    return moment, pivot, changed


@_exact
def _fill(columns: Any, own: int, count: int, rank: int, root: Any, x0: int, low: int, high: int, z: Any) -> None:
    """Modes of a block times the roots of the stiffness."""
    stiff = root[low:high]
    for a in range(rank):
        first, target = own + a * count - x0 + low, z[a, low:high]
        mode = columns[first : first + high - low]
        for x in range(high - low):
            target[x] = mode[x] * stiff[x]
    for a in range(rank, rank + (-rank) % 4):
        z[a, low:high] = 0.0


@_exact
def _fill_rows(columns: Any, own: int, count: int, rank: int, root: Any, x0: int, low: int, high: int, z: Any) -> None:
    """As `_fill`, one segment after the other."""
    padded, size = rank + (-rank) % 4, high - low
    for x in range(size):
        row, stiff, at = z[x], root[low + x], own + low + x - x0
        for a in range(rank):
            row[a] = columns[at] * stiff
            at += count
        row[rank:padded] = 0.0
    for x in range(size, size + (-size) % 4):
        z[x, :padded] = 0.0


@_sums
def _direction(
    blocks: Any, columns: Any, balance: Any, at: Any, state: Any, work: Any, factors: Any, change: Any
) -> float:
    """Newton's change of amplitudes; returns that of the rotation.

    The matrix of a block is I + Z Z'. Where fewer segments touch than there are modes, it is solved by Woodbury's
    identity: its inverse is I - Z (I + Z'Z)^-1 Z'.
    """
    amplitudes, _ = at
    _, root, _, lever, _, z = state
    loads, spans, _, _ = work
    grams, border, solved, rows, few, _, _, _ = factors
    imbalance, pivot = balance
    width = z.shape[0]
    for q in range(blocks.shape[0]):
        rank, c0 = blocks[q, 3], q * width
        low, high = spans[q, 0], spans[q, 1]
        padded, size = rank + (-rank) % 4, high - low + (low - high) % 4
        segments = size < padded
        if spans[q, 2] == 1:
            spans[q, 2] = 0
            if segments:
                _fill_rows(columns, blocks[q, 2], blocks[q, 1], rank, root, blocks[q, 0], low, high, rows[q])
                _gram(rows[q], size, 0, padded, grams[q])
                _factor(grams[q], size)
                few[:size] = 0.0
                few[: high - low] = lever[low:high]
                _combination(rows[q], size, few, padded, border, c0)
                _solve(grams[q], size, few, 0)
                _combination(rows[q], size, few, padded, solved, c0)
            else:
                _fill(columns, blocks[q, 2], blocks[q, 1], rank, root, blocks[q, 0], low, high, z)
                _gram(z, rank, low, high, grams[q])
                _factor(grams[q], padded)
                _products(z, rank, lever, low, high, border, c0)
                solved[c0 : c0 + padded] = border[c0 : c0 + padded]
                _solve(grams[q], padded, solved, c0)
        for a in range(c0, c0 + padded):
            change[a] = loads[a] - amplitudes[a]
        if segments:
            _products(rows[q], size, change[c0 : c0 + padded], 0, padded, few, 0)
            _solve(grams[q], size, few, 0)
            for i in range(size):
                few[i] = -few[i]
            _add_combination(rows[q], size, few, padded, change, c0)
        else:
            _solve(grams[q], padded, change, c0)
        for a in range(c0, c0 + rank):
            pivot -= border[a] * solved[a]
            imbalance += border[a] * change[a]
    turn: float = imbalance / pivot
    for q in range(blocks.shape[0]):
        for a in range(q * width, q * width + blocks[q, 3]):
            change[a] += turn * solved[a]
    return turn


@_sums
def _shared_direction(
    blocks: Any, columns: Any, imbalance: float, at: Any, state: Any, work: Any, factors: Any, change: Any
) -> float:
    """As `_direction`, with shared modes.

    Below the matrix of a block stand its shared columns and the lever arm: their rows become H = [G r]'Z' L^-T, what
    is behind them the Schur complement, with the rotation last. Of Woodbury's matrix I + Z'Z the rows are those of G
    and r themselves, and the Schur complement is H H'.
    """
    amplitudes, _ = at
    _, root, _, lever, _, z = state
    loads, spans, mixing, plain = work
    grams, held, local, rows, _, whole, mixed, stiff = factors
    width, count, shared = z.shape[0], mixing.shape[2], mixing.shape[1]
    first, extended = blocks.shape[0] * width, shared + 1 + (-shared - 1) % 4
    padded_count = count + (-count) % 4
    stale = False
    rest = change[first : first + padded_count]
    for t in range(count):
        rest[t] = loads[first + t] - amplitudes[first + t]
    rest[count:] = 0.0
    for q in range(blocks.shape[0]):
        x0, own, stride, rank, c0 = blocks[q, 0], blocks[q, 2], blocks[q, 1], blocks[q, 3], q * width
        low, high = spans[q, 0], spans[q, 1]
        padded, size = rank + (-rank) % 4, high - low + (low - high) % 4
        segments = size < padded
        matrix, edge = grams[q], size if segments else padded
        if spans[q, 2] == 1:
            spans[q, 2], stale = 0, True
            if high == low:
                matrix[edge : edge + extended, : edge + extended] = 0.0
            elif segments:
                _fill_rows(columns, own, stride, rank, root, x0, low, high, rows[q])
                _gram(rows[q], size, 0, padded, matrix)
                _factor(matrix, size)
                at_shared = own + rank * stride + low - x0
                for k in range(shared):
                    row, mode = matrix[edge + k], columns[at_shared + k * stride : at_shared + k * stride + high - low]
                    for x in range(high - low):
                        row[x] = mode[x] * root[low + x]
                matrix[edge + shared, : high - low] = lever[low:high]
                matrix[edge : edge + extended, high - low : edge + extended] = 0.0
                matrix[edge + shared + 1 : edge + extended, :edge] = 0.0
                _reduce(matrix, edge, edge + extended)
                for k in range(edge, edge + extended):
                    for t in range(edge, k + 1):
                        matrix[k, t] = -matrix[k, t]
            else:
                _fill(columns, own, stride, rank, root, x0, low, high, z)
                at_shared = own + rank * stride + low - x0
                for k in range(shared):
                    row, mode = z[edge + k], columns[at_shared + k * stride : at_shared + k * stride + high - low]
                    for x in range(high - low):
                        row[low + x] = mode[x] * root[low + x]
                z[edge + shared, low:high] = lever[low:high]
                z[edge + shared + 1 : edge + extended, low:high] = 0.0
                _gram(z, edge + extended, low, high, matrix)
                for k in range(edge, edge + extended):
                    matrix[k, k] = _dot(z[k, low:high], z[k, low:high])
                _factor(matrix, edge)
                _reduce(matrix, edge, edge + extended)
        for a in range(c0, c0 + padded):
            change[a] = loads[a] - amplitudes[a] if a < c0 + rank else 0.0
        y = held[c0 : c0 + edge]
        if segments:
            _products(rows[q], size, change[c0 : c0 + padded], 0, padded, held, c0)
        else:
            y[:] = change[c0 : c0 + padded]
        _forward(matrix, edge, held, c0)
        for k in range(shared + 1):
            local[c0 + k] = _dot(matrix[edge + k, :edge], y)
        imbalance += local[c0 + shared]
        if plain:
            for t in range(count):
                rest[t] -= local[c0 + t]
        else:
            mixing_rows = mixing[q]
            for k in range(shared):
                load = local[c0 + k]
                for t in range(count):
                    rest[t] -= load * mixing_rows[k, t]
    end, turning = whole[:padded_count], whole[padded_count]
    if stale:
        end[:] = 0.0
        turning[:] = 0.0
        whole[padded_count + 1, 0] = 0.0
        for t in range(padded_count):
            end[t, t] = 1.0
        for q in range(blocks.shape[0]):
            low, high, rank = spans[q, 0], spans[q, 1], blocks[q, 3]
            if high == low:
                if not plain:
                    stiff[:count, q * shared : (q + 1) * shared] = 0.0
                continue
            padded, size = rank + (-rank) % 4, high - low + (low - high) % 4
            matrix, edge = grams[q], min(size, padded)
            last = matrix[edge + shared]
            whole[padded_count + 1, 0] += last[edge + shared]
            if plain:
                for t in range(count):
                    turning[t] += last[edge + t]
                    for k in range(t + 1):
                        end[t, k] += matrix[edge + t, edge + k]
                continue
            for k in range(shared):
                for m in range(k):
                    matrix[edge + m, edge + k] = matrix[edge + k, edge + m]
            mixing_rows = mixing[q]
            for k in range(shared):
                moved = last[edge + k]
                for t in range(count):
                    turning[t] += moved * mixing_rows[k, t]
            _mixed_block(mixed, matrix, edge, q * shared, shared, padded_count, stiff)
        if not plain:
            _mixed_gram(mixed, stiff, padded_count, end)
        _factor(end, padded_count)
        _forward(end, padded_count, turning, 0)
        whole[padded_count + 1, 0] -= _dot(turning[:padded_count], turning[:padded_count])
    _forward(end, padded_count, rest, 0)
    turn: float = (imbalance + _dot(turning[:padded_count], rest)) / whole[padded_count + 1, 0]
    for t in range(padded_count):
        rest[t] += turn * turning[t]
    _backward(end, padded_count, rest, 0)
    _spread(blocks, width, mixing, plain, change, change)
    for q in range(blocks.shape[0]):
        rank, c0 = blocks[q, 3], q * width
        low, high = spans[q, 0], spans[q, 1]
        if high == low:
            continue
        padded, size = rank + (-rank) % 4, high - low + (low - high) % 4
        segments = size < padded
        matrix, edge = grams[q], size if segments else padded
        y = held[c0 : c0 + edge]
        if segments:
            for x in range(edge):
                y[x] = -y[x]
        for k in range(shared):
            factor, row = change[c0 + rank + k], matrix[edge + k]
            for x in range(edge):
                y[x] -= factor * row[x]
        row = matrix[edge + shared]
        for x in range(edge):
            y[x] += turn * row[x]
        _backward(matrix, edge, held, c0)
        if segments:
            _add_combination(rows[q], size, y, rank, change, c0)
        else:
            change[c0 : c0 + rank] = y[:rank]
    return turn


@_exact
def _stiffness(
    blocks: Any, columns: Any, law: Any, given: Any, amplitudes: Any, state: Any, work: Any, factors: Any, change: Any
) -> float:
    """Torque that turns the gear by one radian while the touching segments keep contact, at a solution.

    Newton's change of the rotation for a torque of one more. The amplitudes must be the loads, so that these are in
    balance; the tangents of the line contacts are those at the forces themselves.
    """
    _, arm, _, segment = given
    _, root, _, lever, force, _ = state
    spans, mixing = work[1], work[2]
    pivot = 0.0
    for q in range(blocks.shape[0]):
        spans[q, 2] = 1
        for x in range(spans[q, 0], spans[q, 1]):
            if root[x] > 0.0:
                own = law[segment[x]]
                root[x] = math.sqrt(own[LENGTH] / _strip(own, force[x] / own[LENGTH])[1])
            lever[x] = root[x] * arm[x]
            pivot += lever[x] * lever[x]
    at = (amplitudes, 0.0)
    if mixing.shape[1]:
        return 1.0 / _shared_direction(blocks, columns, 1.0, at, state, work, factors, change)
    return 1.0 / _direction(blocks, columns, (1.0, pivot), at, state, work, factors, change)


@_sums
def _stuck(blocks: Any, columns: Any, given: Any, touching: Any, state: Any, work: Any) -> Any:
    """As `_point` at amplitudes and rotation zero, where chosen segments stick together and no others touch."""
    separation, arm, stiffness, _ = given
    _, root, pull, lever, _, z = state
    loads, spans, mixing, plain = work
    width, shared = z.shape[0], mixing.shape[1]
    moment, pivot = 0.0, 0.0
    for q in range(blocks.shape[0]):
        x0, count, own, rank = blocks[q, 0], blocks[q, 1], blocks[q, 2], blocks[q, 3]
        low, high = x0 + count, x0
        for x in range(x0, x0 + count):
            root[x] = 0.0
            if touching[x]:
                root[x] = stiffness[x]
                low, high = min(low, x), x + 1
            pull[x] = -separation[x] * root[x]
            lever[x] = root[x] * arm[x]
            moment += pull[x] * lever[x]
            pivot += lever[x] * lever[x]
        low = min(low, high)
        spans[q, 0], spans[q, 1], spans[q, 2] = low, high, 1
        for x in range(low, high):
            pull[x] *= root[x]
        _loads(columns, own, count, rank + shared, pull, x0, low, high, loads, q * width)
    if shared:
        _gather(blocks, width, mixing, plain, loads)
    return moment, pivot


@_sums
def _slope(
    blocks: Any, width: int, shared: int, torque: float, moment: float, loads: Any, amplitudes: Any, step: Any
) -> Any:
    """Slope of phi along a step, and what of it is rounding."""
    change, turn = step
    bending, local = 0.0, -turn * moment
    for q in range(blocks.shape[0]):
        for a in range(q * width, q * width + blocks[q, 3]):
            bending += change[a] * amplitudes[a]
            local += change[a] * loads[a]
    for a in range(blocks.shape[0] * width, blocks.shape[0] * width + shared):
        bending += change[a] * amplitudes[a]
        local += change[a] * loads[a]
    work = torque * turn
    return bending - local - work, ROUNDING_SLOPE * (abs(bending) + abs(local) + abs(work))


@_exact
def _iterate(
    blocks: Any, columns: Any, law: Any, linear: bool, coarse: bool, given: Any, torque: float, rotation: float,
    amplitudes: Any, state: Any, work: Any, factors: Any, spare: Any,
) -> Any:  # fmt: skip
    """Newton's method from amplitudes and a rotation; returns rotation, steps and whether it ended."""
    loads, width, shared = work[0], state[5].shape[0], work[2].shape[2]
    change, begin, best = spare
    least, steps, ended, kept, current = np.inf, 0, False, rotation, 0
    moment, pivot, changed = _point(blocks, columns, law, linear, given, (amplitudes, rotation), state, work)
    for iteration in range(MAX_COARSE_ITERATIONS if coarse else MAX_ITERATIONS):
        current = iteration
        amplitude, left = 0.0, 0.0
        for q in range(blocks.shape[0]):
            for a in range(q * width, q * width + blocks[q, 3]):
                amplitude = max(amplitude, abs(amplitudes[a]))
                left = max(left, abs(loads[a] - amplitudes[a]))
        residual = abs(torque - moment) / torque
        if amplitude > 0.0:
            left /= amplitude
        residual = max(residual, left)
        if shared:
            left = 0.0
            for a in range(blocks.shape[0] * width, blocks.shape[0] * width + shared):
                amplitude = max(amplitude, abs(amplitudes[a]))
                left = max(left, abs(loads[a] - amplitudes[a]))
            if amplitude > 0.0:
                left /= amplitude
            residual = max(residual, left)
        if coarse and (residual < COARSE_RESIDUAL or (linear and iteration > 0 and not changed)):
            return rotation, iteration, True
        before = least
        if residual < least:
            least, steps, kept = residual, iteration, rotation
            best[:] = amplitudes
        if residual <= ROUNDING_RESIDUAL or (not residual < 0.5 * before and before < STALLED_RESIDUAL):
            ended = True
            break
        if not math.isfinite(residual):
            break
        if shared:
            turn = _shared_direction(
                blocks, columns, torque - moment, (amplitudes, rotation), state, work, factors, change
            )
        else:
            turn = _direction(
                blocks, columns, (torque - moment, pivot), (amplitudes, rotation), state, work, factors, change
            )
        begin[:] = amplitudes
        at_begin = rotation
        for a in range(change.size):
            amplitudes[a] = begin[a] + change[a]
        rotation = at_begin + turn
        moment, pivot, changed = _point(blocks, columns, law, linear, given, (amplitudes, rotation), state, work)
        if coarse:
            continue
        slope, rounding = _slope(blocks, width, shared, torque, moment, loads, amplitudes, (change, turn))
        length = 1.0
        for _ in range(MAX_HALVINGS):
            if not slope > rounding:
                break
            for a in range(change.size):
                amplitudes[a] = begin[a] + 0.5 * length * change[a]
            rotation = at_begin + 0.5 * length * turn
            moment, pivot, changed = _point(blocks, columns, law, linear, given, (amplitudes, rotation), state, work)
            half_slope, _ = _slope(blocks, width, shared, torque, moment, loads, amplitudes, (change, turn))
            if not half_slope + slope > 0.0:  # the longer step it is
                for a in range(change.size):
                    amplitudes[a] = begin[a] + length * change[a]
                rotation = at_begin + length * turn
                moment, pivot, changed = _point(
                    blocks, columns, law, linear, given, (amplitudes, rotation), state, work
                )
                break
            length, slope = 0.5 * length, half_slope
    if coarse:
        return rotation, current, True
    if steps != current:
        amplitudes[:] = best
        rotation = kept
        _point(blocks, columns, law, linear, given, (amplitudes, rotation), state, work)
    return rotation, steps, ended


@_sums
def _winkler_rotation(separation: Any, arm: Any, weight: Any, torque: float) -> float:
    """Rotation at which springs without coupling balance the torque, from above: a convex function of one number."""
    top, bottom = torque, 0.0
    for x in range(separation.size):
        if arm[x] > 0.0:
            stiff = weight[x] * arm[x]
            top += stiff * separation[x]
            bottom += stiff * arm[x]
    rotation = top / bottom
    for _ in range(MAX_ITERATIONS):
        top, bottom = torque, 0.0
        for x in range(separation.size):
            if arm[x] > 0.0 and rotation * arm[x] > separation[x]:
                stiff = weight[x] * arm[x]
                top += stiff * separation[x]
                bottom += stiff * arm[x]
        if not bottom > 0.0:
            break
        turned = top / bottom
        if not turned < rotation * (1.0 - 1e-3):
            break
        rotation = turned
    return rotation


@_sums
def _certificate(
    force: Any, deflection: Any, gap: Any, shifted: Any, arm: Any, whole: Any, torque: float, known: Any, numbers: Any
) -> None:
    """Violations of the conditions of the contact problem and their rounding, see ``certificate.violations``.

    ``known`` has the terms of a deflection, and the error of the shift over the lever arm.
    """
    terms, shift_error = known
    elastic = numbers[ELASTIC]
    total = moment = size_of_moment = strain = work = preload = rooted = 0.0
    largest, least_force, far, softest, longest = 0.0, np.inf, 0.0, 0.0, 0.0
    finite = math.isfinite(numbers[ROTATION])
    for i in range(force.size):
        own = abs(force[i])
        total += own
        moment += force[i] * arm[i]
        size_of_moment += own * abs(arm[i])
        strain += own * abs(deflection[i])
        work += force[i] * (deflection[i] + shifted[i])
        preload += own * abs(shifted[i])
        if own > 0.0:
            rooted += own * math.sqrt(whole[i])
        largest = max(largest, own)
        least_force = min(least_force, force[i])
        far = max(far, abs(shifted[i]))
        softest, longest = max(softest, whole[i]), max(longest, abs(arm[i]))
        finite = finite and math.isfinite(gap[i]) and math.isfinite(force[i])
    if not finite:
        numbers[EQUILIBRIUM : CANCELLATION + 1] = np.inf
        return
    scale, cancellation = 0.0, 1.0
    if total > 0.0:
        mean, uncancelled = strain / total, rooted * rooted / total
        if max(mean, uncancelled) > 0.0:
            uncancelled = max(uncancelled, preload / total, abs(elastic) * size_of_moment / total)
            scale, cancellation = max(mean, CANCELLATION_FLOOR * uncancelled), max(uncancelled / mean, 1.0)
    if not scale > 0.0:
        scale = far if far > 0.0 else 1.0
    penetration, shared = 0.0, 0.0
    for i in range(force.size):
        penetration = max(penetration, -gap[i])
        shared = max(shared, min(force[i] / largest if largest > 0.0 else force[i], gap[i] / scale))
    moment_scale, energy_scale = max(torque, CANCELLATION_FLOOR * size_of_moment), total * scale + preload
    numbers[EQUILIBRIUM] = _relative(abs(moment - torque), moment_scale)
    numbers[NEGATIVE_FORCE] = _relative(max(-least_force, 0.0), largest)
    numbers[NEGATIVE_GAP] = penetration / scale
    numbers[COMPLEMENTARITY] = shared
    numbers[DUALITY] = _relative(abs(work - elastic * torque), energy_scale)
    # Rounding: see ``residuals.rounded_residuals``.
    unknown = terms * UNIT_ROUNDOFF * rooted * math.sqrt(softest) + UNDERFLOW
    unknown += (6.0 * UNIT_ROUNDOFF * abs(elastic) + shift_error) * longest
    rounding = (force.size + 4) * UNIT_ROUNDOFF
    of_work = total * unknown + rounding * (strain + preload + abs(elastic * torque))
    resolution = max(unknown / scale, _relative(rounding * size_of_moment, moment_scale))
    numbers[RESOLUTION] = max(resolution, _relative(of_work, energy_scale) if total > 0.0 else 0.0)
    numbers[CANCELLATION] = max(cancellation, size_of_moment / torque if torque > 0.0 else 1.0)


@_exact
def _relative(error: float, scale: float) -> float:
    if error == 0.0:
        return 0.0
    return error / scale if scale > 0.0 else np.inf


_vector, _table, _whole = readable(numba.f8, 1), readable(numba.f8, 2), readable(numba.i8, 1)
_modes = numba.types.Tuple((_whole, readable(numba.i8, 3), _whole, _vector, _table, readable(numba.f8, 3)))
_results = (numba.f8[:, ::1],) * 4


@compiled(
    numba.void(_modes, _vector, _table, _vector, _vector, _table, readable(numba.b1, 2), *_results, numba.i8[:, ::1])
)
def solve_batch(
    modes: Any, torque: Any, separation: Any, arm: Any, local: Any, law: Any, mask: Any,
    force_of: Any, gap_of: Any, secant_of: Any, numbers: Any, counts: Any,
) -> None:  # fmt: skip
    """Solve problems of one compliance one after another.

    Parameters
    ----------
    modes
        See ``mode_columns``.
    torque
        Of every problem (b) [N mm].
    separation
        Of every problem (b, n) [mm].
    arm, local
        Of the segments (n) [mm], [mm/N].
    law
        Parameters of line contacts (n, 14), empty where the local compliances are given.
    mask
        Of every problem, segments that are assumed in contact (b, n); empty for none.
    force_of, gap_of
        For the results (b, n).
    secant_of
        For the secant compliance of line contacts (b, n); empty if there are none.
    numbers, counts
        For the numbers (b, 10), and steps and whether the method ended (b, 2). The stiffness is that of line contacts,
        see ``_stiffness``.
    """
    places, blocks_of, order, columns, sums, mixing = modes
    bending, row_sum = sums[0], sums[1]
    linear = law.shape[0] == 0
    most, wide, blocks_most = arm.size, 4, blocks_of.shape[1]
    for q in range(blocks_most):
        wide = max(wide, 4 * ((blocks_of[0, q, 3] + 3) // 4))
    shared, count = mixing.shape[1], mixing.shape[2]
    padded_count, plain = 4 * ((count + 3) // 4), shared == count
    if shared:
        wide += 4 * ((shared + 4) // 4)
        for q in range(blocks_most):
            for k in range(shared):
                for t in range(count):
                    plain = plain and mixing[q, k, t] == (1.0 if k == t else 0.0)
    vectors = np.empty((10, most))
    shifted, sep, lev, stiff, gap, root, pull, lever, force, local_here = (
        vectors[0], vectors[1], vectors[2], vectors[3], vectors[4], vectors[5], vectors[6], vectors[7], vectors[8],
        vectors[9],
    )  # fmt: skip
    segment, touching = np.empty(most, np.int64), np.empty(most, np.bool_)
    z = np.empty((wide, most))
    small = np.zeros((7, blocks_most * wide + padded_count))
    amplitudes, loads, change, begin, best, border, solved = (
        small[0], small[1], small[2], small[3], small[4], small[5], small[6],
    )  # fmt: skip
    spans = np.zeros((blocks_most, 3), np.int64)
    grams, rows = np.empty((blocks_most, wide, wide)), np.empty((blocks_most, wide, wide))
    few = np.empty(max(wide, padded_count))
    whole_matrix = np.empty((padded_count + 2, max(padded_count, 1)))
    mixed = np.zeros((2 * padded_count, 0 if plain else blocks_most * shared))
    mixed, stiff_mixed = mixed[:padded_count], mixed[padded_count:]
    if not plain:
        for q in range(blocks_most):
            for k in range(shared):
                for t in range(count):
                    mixed[t, q * shared + k] = mixing[q, k, t]
    size = most
    for b in range(torque.size):
        first_contact, remainder, shift_error = _first_contact(separation[b], arm, shifted)
        factors = (grams, border, solved, rows, few, whole_matrix, mixed, stiff_mixed)
        spare = (change, begin, best)
        rotation, steps, ended = 0.0, 0, False
        guess = 0.0
        if not linear:
            positive, sum_positive = 0, 0.0
            for i in range(size):
                if arm[i] > 0.0:
                    positive += 1
                    sum_positive += arm[i]
            guess = torque[b] / (sum_positive * TOUCHING_GUESS)
        top = 0 if mask.size > 0 else places.size - 1
        winkler = 0.0
        for level in range(top, -1, -1):
            blocks = blocks_of[level]
            total = blocks[-1, 0] + blocks[-1, 1]
            first_place = places[level]
            for q in range(blocks.shape[0]):
                weight = blocks_of[0, q, 1] / blocks[q, 1]
                for x in range(blocks[q, 0], blocks[q, 0] + blocks[q, 1]):
                    i = order[first_place + x]
                    segment[x], sep[x], lev[x] = i, shifted[i], arm[i]
                    if linear:
                        local_here[x] = local[i]
                    elif level == top:
                        local_here[x] = _strip(law[i], guess / law[i, LENGTH])[0] / law[i, LENGTH]
                    stiff[x] = math.sqrt(weight / local_here[x]) if linear or level == top else weight
                    root[x] = 0.0
                spans[q, 2] = 1
                spans[q, 0] = spans[q, 1] = blocks[q, 0]
            given = (sep[:total], lev[:total], stiff, segment)
            state, work = (gap, root, pull, lever, force, z), (loads, spans, mixing, plain)
            if level == top:
                any_touches = False
                if mask.size > 0:
                    for x in range(total):
                        touching[x] = mask[b, segment[x]] and lev[x] > 0.0
                        any_touches = any_touches or touching[x]
                    if not any_touches:
                        for x in range(total):
                            touching[x] = sep[x] == 0.0 and lev[x] > 0.0
                else:
                    for q in range(blocks.shape[0]):
                        weight = blocks_of[0, q, 1] / blocks[q, 1]
                        for x in range(blocks[q, 0], blocks[q, 0] + blocks[q, 1]):
                            i = segment[x]
                            whole = max(
                                WINKLER_ROW_SUM_FRACTION * (row_sum[i] + local_here[x]), local_here[x] + bending[i]
                            )
                            gap[x] = weight / whole
                    winkler = _winkler_rotation(sep[:total], lev[:total], gap, torque[b])
                    for x in range(total):
                        touching[x] = lev[x] > 0.0 and winkler * lev[x] > sep[x]
                amplitudes[:] = 0.0
                moment, pivot = _stuck(blocks, columns, given, touching, state, work)
                if shared:
                    rotation = _shared_direction(
                        blocks, columns, torque[b] - moment, (amplitudes, 0.0), state, work, factors, change
                    )
                else:
                    rotation = _direction(
                        blocks, columns, (torque[b] - moment, pivot), (amplitudes, 0.0), state, work, factors, change
                    )
                amplitudes[:] = change
                if not math.isfinite(rotation):
                    amplitudes[:] = 0.0
                    rotation = winkler
                if not linear:
                    rotation, _, _ = _iterate(
                        blocks, columns, law, True, True, given, torque[b], rotation, amplitudes, state, work,
                        factors, spare,
                    )  # fmt: skip
                    for q in range(blocks.shape[0]):
                        for x in range(blocks[q, 0], blocks[q, 0] + blocks[q, 1]):
                            stiff[x] = blocks_of[0, q, 1] / blocks[q, 1]
            if not linear:
                if level == top:
                    force[:total] = guess
                else:  # that of the nearest segment of the level above
                    for q in range(blocks.shape[0]):
                        for j in range(blocks[q, 1]):
                            above = blocks_of[level + 1, q, 0] + j * blocks_of[level + 1, q, 1] // blocks[q, 1]
                            force[blocks[q, 0] + j] = local_here[above]
            rotation, steps, ended = _iterate(
                blocks, columns, law, linear, level > 0, given, torque[b], rotation, amplitudes, state, work,
                factors, spare,
            )  # fmt: skip
            if level > 0:
                if not (math.isfinite(rotation) and math.isfinite(amplitudes.sum())):
                    amplitudes[:] = 0.0
                    rotation = winkler
                for x in range(total):
                    local_here[x] = force[x]
        counts[b, 0], counts[b, 1] = steps + 1, ended
        numbers[b, STIFFNESS] = np.nan
        if not linear:
            amplitudes[:] = loads
            numbers[b, STIFFNESS] = _stiffness(
                blocks_of[0], columns, law, given, amplitudes, state, work, factors, change
            )
        # Forces and gaps in the order of the segments, and the deflection from the forces themselves.
        blocks = blocks_of[0]
        forces, gaps = force_of[b], gap_of[b]
        for x in range(size):
            if linear:
                sep[x] = pull[x] if root[x] > 0.0 else 0.0  # never -0
            else:
                sep[x] = force[x] if gap[x] < 0.0 else 0.0
            gap[x] = 0.0
        if shared:
            _spread(blocks, wide, mixing, plain, loads, loads)
        for q in range(blocks.shape[0]):
            rank = blocks[q, 3] + shared
            _add_closing(columns, blocks[q, 2], blocks[q, 1], rank, loads, q * wide, gap, blocks[q, 0])
        spread = 1.0
        for x in range(size):
            i = segment[x]
            forces[i] = sep[x]
            if linear:
                own_compliance = local[i]
            else:
                own_compliance = _strip(law[i], sep[x] / law[i, LENGTH])[0] / law[i, LENGTH]
                secant_of[b, i] = own_compliance
            pull[i] = own_compliance * sep[x] + gap[x]
            lever[i] = own_compliance + bending[i]
            if shared:  # terms that cancel in W leave more rounding than its diagonal tells
                terms = lever[i] + sums[3, i]
                lever[i] += sums[2, i]
                spread = max(spread, terms / lever[i])
        numbers[b, ROTATION], numbers[b, ELASTIC] = first_contact + (remainder + rotation), rotation
        for i in range(size):
            gaps[i] = pull[i] + shifted[i] - rotation * arm[i]
        known = (spread * (size + wide + 10.0 + shared + count), shift_error * abs(first_contact))
        _certificate(forces, pull, gaps, shifted, arm, lever, torque[b], known, numbers[b])
