"""Friction coefficient of a mixed lubricated line contact: the regression of the dissertation, Eq. 5.11.

Printed with lost symbols, the three expressions were restored: see the documentation for what that rests on. In logs:

    L < 1:   a0 + H (a1 SR + a2 G) + a3 L^2 + (a4 ln G + a5 ln Sc) ln SR + (a6 G + a7 L) ln H
             + (a8 ln L + a9 ln Sc) ln L + a10 H ln Seq
    1 to 3:  b0 + b1 SR + (b2 ln U + b3 ln G + b4 ln H + b5 H) ln SR + b6 H ln U + (b7 + b8 ln H) ln G
             + b9 (ln H)^2 + b10 Sc ln L
    from 3:  c0 + c1 G + c2 SR U + (c3 ln G + c4 ln H + c5 H + c6 ln L + c7 ln Sc) ln SR + (c8 G + c9 ln H) ln U
             + c10 G ln H + c11 SR ln Seq

with L the lambda ratio, SR slide-to-roll, H = pressure over contact modulus, Sc = composite roughness and Seq = product
over sum of both roughnesses, over the radius.

Flags tell what was clamped or extrapolated, of this formula and of others, and its part of the power loss.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.arrays import Array, Bools, Integers
from ..core.checks import array, instance
from .conditions import ContactConditions

Flags = NDArray[np.uint16]

#: Flags of all formulas: an input is clamped to the end of its range, or the formula continued beyond it.
FLAGS = {
    1: "slide_to_roll_clamped",
    2: "pressure_clamped",
    4: "roughness_clamped",
    8: "pressure_extrapolated",
    16: "radius_extrapolated",
    32: "rolling_velocity_extrapolated",
    64: "roughness_extrapolated",
    128: "temperature_extrapolated",
    256: "lambda_clamped",
    512: "coefficient_limited",
    1024: "radius_clamped",
    2048: "rolling_velocity_clamped",
    4096: "viscosity_clamped",
    8192: "pressure_viscosity_clamped",
    16384: "lambda_extrapolated",
}
#: Least thinning of the film by heat of the inlet that is told.
TOLD_THINNING = 0.1


def combined_flags(conditions_of: dict[int, Array]) -> Flags:
    """Sum of the flags (...) by the places where each holds."""
    # One after the other, small arrays first: the sum is large.
    total: Any = np.uint16(0)
    for bit, where in sorted(conditions_of.items(), key=lambda item: np.size(item[1])):
        total = total + np.uint16(bit) * where
    return np.asarray(total, dtype=np.uint16)


class LossShares:
    """Parts of the power loss that need a note, over (torque, speed, temperature, roughness), flags first."""

    def __init__(self, shape: tuple[int, int, int, int]) -> None:
        self.whole, self.outside, self.between, self.thinned, self.thinning = (np.zeros(shape) for _ in range(5))
        self.by_flag = np.zeros((len(FLAGS), *shape))

    def add(self, torque: Integers, loss: Array, flags: Flags | None, between: Array, thinning: Array) -> None:
        """Add a block of segments by sorted torque numbers (n), with losses (speed, temperature, roughness, n).

        ``between``: the coefficient is where two expressions of the formula meet; ``thinning``: part lost to inlet
        heat.
        """
        starts = np.flatnonzero(np.diff(torque, prepend=-1))
        at = torque[starts]

        def put(target: Array, values: Array, reduce: np.ufunc = np.add) -> None:
            parts = np.moveaxis(reduce.reduceat(values, starts, axis=-1), -1, 0)
            target[at] = reduce(target[at], parts)

        put(self.whole, loss)
        put(self.thinning, np.broadcast_to(thinning, (*thinning.shape[:-1], loss.shape[-1])), np.maximum)
        thin = thinning > TOLD_THINNING
        if np.any(thin):
            put(self.thinned, loss * thin)
        if np.any(between):
            put(self.between, loss * between)
        present = 0 if flags is None else int(np.bitwise_or.reduce(flags, axis=None))
        if flags is None or not present:
            return
        put(self.outside, loss * (flags > 0))
        for number, bit in enumerate(FLAGS):
            if present & bit:
                put(self.by_flag[number], loss * (flags & bit > 0))

    def variables(self, dimensions: tuple[str, ...], *, ranged: bool, joined: bool) -> dict[str, Any]:
        """The shares as variables of a dataset over torque, speed, temperature and roughness.

        ``ranged``: the formula has a range; ``joined``: it is made of several expressions.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            data: dict[str, Any] = {
                "film_thinning": (dimensions, self.thinning),
                "thinned_share": (dimensions, self.thinned / self.whole),
            }
            if ranged:
                data["extrapolated_share"] = (dimensions, self.outside / self.whole)
                data["flagged_share"] = (("formula_flag", *dimensions), self.by_flag / self.whole)
                data["formula_flag"] = ("formula_flag", np.array(list(FLAGS), dtype=np.uint16))
            if joined:
                data["transition_share"] = (dimensions, self.between / self.whole)
        return data


# Kolivand 2009, Table 5.3; row i of the table holds index i - 1.
A = (-0.62538, -51.411, -0.0371532, 2.06770, -0.031750, -0.046276, -7.754e-5, 1.18821, 0.170432, -0.136892, -7.8882)
B = (16.1512, -0.60156, -0.0466305, -0.348239, -0.358514, 22.568, -11.2295, -6.49095, -1.31986, -0.881279, -4398.1)
C = (5.0435, -0.00576307, 248228480.0, -0.396002, -0.405254, 35.618, -0.109382, -0.112364, -0.00016056, -0.0690238,
     -0.00038810, 0.052821)  # fmt: skip

# What the regression was made from (Table 5.1); no sliding below 0.025 of the rolling.
STUDY_RANGES = {
    "slide_to_roll": (0.025, 1.0),
    "hertz_pressure": (0.5e9, 2.5e9),
    "equivalent_radius": (5e-3, 40e-3),
    "rolling_velocity": (1.0, 20.0),
    "roughness": (0.1e-6, 1.0e-6),
    "temperature": (25.0, 100.0),
}
LAMBDA_MINIMUM = 0.0266  # of the study: 2.5 GPa, 5 mm, 1 m/s, 100 degC, 1 um on both flanks
# Least and greatest coefficient over the whole study, rounded outwards. Far outside the expressions give anything.
COEFFICIENT_LIMITS = (0.00088, 0.1601)
LAMBDA_BOUNDARIES = (1.0, 3.0)
BLEND_WINDOWS = ((0.9, 1.1), (2.7, 3.3))


@dataclass(frozen=True)
class _Groups:
    """Arguments of the three expressions, within the ranges they need."""

    slide_to_roll: Array
    pressure: Array
    speed: Array
    material: Array
    composite: Array
    log_equivalent: Array


def _mixed(g: _Groups, log_ratio: Array) -> Array:
    """Logarithm of the friction coefficient for lambda below 1 (Eq. 5.11a)."""
    log_pressure, ratio = np.log(g.pressure), np.exp(log_ratio)
    log_composite = np.log(g.composite)
    still = (
        A[0]
        + g.pressure * (A[1] * g.slide_to_roll + A[2] * g.material)
        + (A[4] * np.log(g.material) + A[5] * log_composite) * np.log(g.slide_to_roll)
        + A[6] * g.material * log_pressure
        + A[10] * g.pressure * g.log_equivalent
    )
    by_ratio = (A[3] * ratio + A[7] * log_pressure) * ratio
    return np.asarray(still + by_ratio + (A[8] * log_ratio + A[9] * log_composite) * log_ratio)


def _transition(g: _Groups, log_ratio: Array) -> Array:
    """Logarithm of the friction coefficient for lambda between 1 and 3 (Eq. 5.11b)."""
    log_pressure, log_speed, log_material = np.log(g.pressure), np.log(g.speed), np.log(g.material)
    still = (
        B[0]
        + B[1] * g.slide_to_roll
        + (B[2] * log_speed + B[3] * log_material + B[4] * log_pressure + B[5] * g.pressure) * np.log(g.slide_to_roll)
        + B[6] * g.pressure * log_speed
        + (B[7] + B[8] * log_pressure) * log_material
        + B[9] * log_pressure**2
    )
    return np.asarray(still + (B[10] * g.composite) * log_ratio)


def _full_film(g: _Groups, log_ratio: Array) -> Array:
    """Logarithm of the friction coefficient for lambda from 3 on (Eq. 5.11c)."""
    log_pressure, log_sliding = np.log(g.pressure), np.log(g.slide_to_roll)
    # What varies with the speed and what varies with the roughness apart: their sum is large.
    by_speed = (
        C[0]
        + C[1] * g.material
        + C[2] * g.slide_to_roll * g.speed
        + (C[3] * np.log(g.material) + C[4] * log_pressure + C[5] * g.pressure) * log_sliding
        + (C[8] * g.material + C[9] * log_pressure) * np.log(g.speed)
        + C[10] * g.material * log_pressure
    )
    by_roughness = C[7] * np.log(g.composite) * log_sliding + C[11] * g.slide_to_roll * g.log_equivalent
    return np.asarray(by_speed + by_roughness + (C[6] * log_sliding) * log_ratio)


def _step(log_ratio: Array, window: tuple[float, float]) -> Array:
    """Smooth step (...) from 0 to 1 over a window of lambda."""
    low, high = np.log(window)
    share = np.clip((log_ratio - low) / (high - low), 0.0, 1.0)
    return np.asarray(share**2 * (3.0 - 2.0 * share))


def _roughnesses(conditions: ContactConditions) -> tuple[Array, Array]:
    """Roughnesses of pinion and gear (...) [m], at least the lowest of the study."""
    lowest = STUDY_RANGES["roughness"][0]
    return np.maximum(conditions.roughness_pinion, lowest), np.maximum(conditions.roughness_gear, lowest)


def _arguments(conditions: ContactConditions) -> tuple[Array, _Groups, _Groups]:
    """Logarithm of lambda (...), and the other arguments as the mixed regime takes them and as the other two do."""
    roughness = _roughnesses(conditions)
    composite = np.hypot(*roughness)
    with np.errstate(divide="ignore"):  # a film that heat thins to nothing
        log_ratio = np.maximum(np.log(conditions.film_thickness) - np.log(composite), np.log(LAMBDA_MINIMUM))
    radius = conditions.equivalent_radius
    in_both = {
        "slide_to_roll": np.clip(conditions.slide_to_roll, *STUDY_RANGES["slide_to_roll"]),
        "speed": conditions.speed_parameter,
        "material": conditions.material_parameter,
        "composite": composite / radius,
        "log_equivalent": np.log(roughness[0] * roughness[1] / (roughness[0] + roughness[1]) / radius),
    }
    low, high = (limit / conditions.contact_modulus for limit in STUDY_RANGES["hertz_pressure"])
    gentle = _Groups(pressure=np.minimum(conditions.pressure_parameter, high), **in_both)
    strict = _Groups(pressure=np.clip(conditions.pressure_parameter, low, high), **in_both)
    return log_ratio, gentle, strict


def formula_coefficient(conditions: ContactConditions, *, blend: bool = False) -> Array:
    """Friction coefficient (...) in three regimes, Kolivand 2009, Eq. 5.11 and Table 5.3; see ``formula_flags``.

    Slide-to-roll is kept to 0.025-1, pressure below 2.5 GPa and, from lambda = 1 on, above 0.5 GPa, roughness above 0.1
    um, lambda above 0.0266. ``blend`` smooths the jumps, up to twofold, at lambda 0.9-1.1 and 2.7-3.3.
    """
    log_ratio, gentle, strict = _arguments(conditions)
    windows = BLEND_WINDOWS if blend else [(at, at) for at in LAMBDA_BOUNDARIES]
    ends = [0.0, *(float(end) for window in windows for end in np.log(window)), 0.0]
    result: Any = 0.0
    # An expression explodes far from its own regime: its lambda stays within it and the windows beside it.
    least, most = float(np.min(log_ratio)), float(np.max(log_ratio))
    if least < ends[2]:
        result = _mixed(gentle, np.minimum(log_ratio, ends[2]))
    if most >= ends[1] and least < ends[4]:
        between = _transition(strict, np.clip(log_ratio, ends[1], ends[4]))
        weight = _step(log_ratio, windows[0]) if blend else log_ratio >= ends[1]
        result = _joined(result, between, weight)
    if most >= ends[3]:
        full = _full_film(strict, np.maximum(log_ratio, ends[3]))
        weight = _step(log_ratio, windows[1]) if blend else log_ratio >= ends[3]
        result = _joined(result, full, weight)
    return np.asarray(np.clip(np.exp(result), *COEFFICIENT_LIMITS))


def _joined(below: Array, above: Array, weight: Array) -> Array:
    """From one logarithm to the next, by a condition or a weight (...)."""
    return np.where(weight, above, below) if weight.dtype == bool else below + weight * (above - below)


def between_regimes(conditions: ContactConditions) -> Bools:
    """True where lambda (...) is within one of the ``BLEND_WINDOWS``, about the steps of the formula."""
    ratio = conditions.film_thickness / np.hypot(*_roughnesses(conditions))
    return np.asarray(np.any([(low < ratio) & (ratio < high) for low, high in BLEND_WINDOWS], axis=0))


def formula_flags(conditions: ContactConditions, coefficient: Array | None = None) -> Flags:
    """Flags (...) of the inputs that ``formula_coefficient`` clamped, and of those outside the regression's data.

    Parameters
    ----------
    conditions
        Operating conditions of the contacts.
    coefficient
        What the formula gives there, if it is known.

    Returns
    -------
    Array
        Sums of the keys of ``FLAGS``.

    Examples
    --------
    >>> from easeoff.friction.kolivand_formula import FLAGS
    >>> from easeoff.friction.coefficient import contact_conditions
    >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
    ...                              slide_to_roll=0.45, roughness=0.8e-6)
    >>> [name for bit, name in FLAGS.items() if formula_flags(contact) & bit]
    ['radius_extrapolated']
    """
    instance("conditions", conditions, ContactConditions)

    def outside(name: str, values: Array, below: bool = True, above: bool = True) -> Bools:
        low, high = STUDY_RANGES[name]
        slack = 1e-9  # a range's end that went through a change of units is within
        under, over = values < low * (1.0 - slack), values > high * (1.0 + slack)
        return np.asarray((under & below) | (over & above))

    rough = (conditions.roughness_pinion, conditions.roughness_gear)
    composite = np.hypot(*_roughnesses(conditions))
    pressure = conditions.hertz_pressure
    thick = conditions.film_thickness >= LAMBDA_BOUNDARIES[0] * composite
    light = outside("hertz_pressure", pressure, above=False)
    given = formula_coefficient(conditions) if coefficient is None else coefficient
    coefficients = array("coefficient", given, anything=True)
    return combined_flags(
        {
            1: outside("slide_to_roll", conditions.slide_to_roll),
            2: (light & thick) | outside("hertz_pressure", pressure, below=False),
            4: outside("roughness", rough[0], above=False) | outside("roughness", rough[1], above=False),
            8: light & ~thick,
            16: outside("equivalent_radius", conditions.equivalent_radius),
            32: outside("rolling_velocity", conditions.rolling_velocity),
            64: outside("roughness", rough[0], below=False) | outside("roughness", rough[1], below=False),
            128: outside("temperature", conditions.temperature),
            256: conditions.film_thickness < LAMBDA_MINIMUM * composite,
            512: np.isin(coefficients, COEFFICIENT_LIMITS),
        }
    )
