"""Named models of the friction coefficient of a lubricated line contact.

A model is any function from ``ContactConditions`` to friction coefficients.

>>> from easeoff.friction import COEFFICIENTS
>>> list(COEFFICIENTS)
['kolivand_blended', 'kolivand', 'mixed_lubrication', 'xu_kahraman', 'benedict_kelly', 'constant']

To add one: a function from conditions (SI, arrays that broadcast) to coefficients, finite without sliding, roughness
and load; a row in ``COEFFICIENTS`` gives it a name, one in ``RANGE_FLAGS`` the flags of its range, and a row in the
table of ``docs/engineer/guides/friction.md`` says where it is from. ``test_friction_coefficient.py`` tries every
name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..core.arrays import Array
from ..core.checks import array, number, shown
from ..core.errors import InputError
from .conditions import STEEL_MODULUS, ContactConditions
from .kolivand_formula import Flags, combined_flags, formula_coefficient, formula_flags
from .lubricants.lubricant import Lubricant, OutOfRange, lubricant

CoefficientModel = Callable[[ContactConditions], Array]
CONSTANT_COEFFICIENT = 0.05  # Coleman, Machine Design 47, 1975
DEFAULT_COEFFICIENT = "kolivand_blended"
COEFFICIENT_LIMIT = 1.0  # dry clean steel has 0.6 to 0.8 in air (Bowden and Tabor 1950); lubricated gears below 0.2
ROUGHNESS_LIMIT = 1.0  # [um] of the formula of Xu and others
SLIDING_MINIMUM = 0.025  # of the rolling velocity, for the formula of Benedict and Kelly


def xu_kahraman(conditions: ContactConditions) -> Array:
    """Full-film regression of Xu and others, ASME Journal of Mechanical Design 129, 2007 (...).

    In GPa, mPa s, m/s, m and um. Quotations do not say what the roughness of unlike flanks is: here the quadratic mean,
    1 um at most, since the formula grows as exp(exp(roughness)).
    """
    b = (-8.916465, 1.03303, 1.036077, -0.354068, 2.812084, -0.100601, 0.752755, -0.390958, 0.620305)
    c = conditions
    pressure, viscosity, sliding = 1e-9 * c.hertz_pressure, 1e3 * c.viscosity, np.abs(c.slide_to_roll)
    group = sliding * pressure * np.log10(viscosity)
    roughness = np.minimum(1e6 / np.sqrt(2.0) * c.composite_roughness, ROUGHNESS_LIMIT)
    exponent = b[0] + b[3] * group + b[4] * np.exp(-group) + b[8] * np.exp(roughness)
    powers = pressure ** b[1] * sliding ** b[2] * c.rolling_velocity ** b[5] * viscosity ** b[6]
    return np.asarray(np.exp(exponent) * powers * c.equivalent_radius ** b[7])


def benedict_kelly(conditions: ContactConditions) -> Array:
    """Benedict and Kelly, ASLE Trans. 4, 1961 (...), in SI: 0.0127 log10[0.02966 f / (viscosity * Vs * (u1 + u2)^2)].

    The constant is 3.17e8 in lbf/in, mPa s and in/s; u1 + u2 is twice the rolling velocity. Sliding counts as 0.025 of
    the rolling velocity at least; a negative value, of a contact without load, as zero.
    """
    c = conditions
    sliding = np.maximum(c.sliding_velocity, SLIDING_MINIMUM * c.rolling_velocity)
    argument = 0.02966 * c.load / (c.viscosity * sliding * (2.0 * c.rolling_velocity) ** 2)
    return np.asarray(np.maximum(0.0127 * np.log10(argument), 0.0))


def constant(conditions: ContactConditions, value: float = CONSTANT_COEFFICIENT) -> Array:
    """Constant friction coefficient."""
    return np.full((), value)


def mixed_lubrication(conditions: ContactConditions) -> Array:
    """Formula fitted to our own study of mixed films with load sharing (...): ``ehl.study.shipped_formula``."""
    from .ehl.study.friction_formula import shipped_formula

    return shipped_formula().coefficient(conditions)


COEFFICIENTS: Mapping[str, CoefficientModel] = {
    "kolivand_blended": partial(formula_coefficient, blend=True),
    "kolivand": formula_coefficient,
    "mixed_lubrication": mixed_lubrication,
    "xu_kahraman": xu_kahraman,
    "benedict_kelly": benedict_kelly,
    "constant": constant,
}


def _mixed_lubrication_flags(conditions: ContactConditions, coefficient: Array) -> Flags:
    from .ehl.study.friction_formula import shipped_formula

    return shipped_formula().flags(conditions)


def _xu_kahraman_flags(conditions: ContactConditions, coefficient: Array) -> Flags:
    rough = 1e6 / np.sqrt(2.0) * conditions.composite_roughness > ROUGHNESS_LIMIT * (1.0 + 1e-9)
    return combined_flags({4: np.asarray(rough), 16384: conditions.lambda_ratio < 1.0})


def _benedict_kelly_flags(conditions: ContactConditions, coefficient: Array) -> Flags:
    c = conditions
    slow = c.sliding_velocity < SLIDING_MINIMUM * (1.0 - 1e-9) * c.rolling_velocity
    return combined_flags({1: np.asarray(slow), 512: coefficient == 0.0})


#: What of the inputs is beyond the range of a named model (...), from the conditions and the coefficients there.
RANGE_FLAGS: Mapping[str, Callable[[ContactConditions, Array], Flags]] = {
    "kolivand_blended": formula_flags,
    "kolivand": formula_flags,
    "mixed_lubrication": _mixed_lubrication_flags,
    "xu_kahraman": _xu_kahraman_flags,
    "benedict_kelly": _benedict_kelly_flags,
}


def coefficient_model(model: str | float | CoefficientModel) -> CoefficientModel:
    """Friction model from its name, a constant coefficient up to ``COEFFICIENT_LIMIT``, or a function."""
    if callable(model):
        return model
    if isinstance(model, str) and model in COEFFICIENTS:
        return COEFFICIENTS[model]
    if isinstance(model, bool) or not isinstance(model, int | float | np.number):
        raise InputError(
            f"coefficient = {shown(model)}: must be one of {', '.join(COEFFICIENTS)}, a number from 0 to "
            f"{COEFFICIENT_LIMIT:g}, or a function of ContactConditions"
        )
    return partial(constant, value=number("coefficient", model, least=0.0, most=COEFFICIENT_LIMIT))


def checked_coefficient(model: str | float | CoefficientModel, conditions: ContactConditions) -> Array:
    """Friction coefficients (...) by a model; one's own is refused beyond 0 to ``COEFFICIENT_LIMIT``.

    The shape is that to which the conditions broadcast, or broadcasts to it.
    """
    coefficients = coefficient_model(model)(conditions)
    if not callable(model):
        return coefficients
    name, shape = model_name(model), conditions.shape
    try:
        values = np.asarray(coefficients)
    except ValueError:
        values = np.asarray(None)
    if values.dtype.kind not in "fiu":
        raise InputError(f"coefficient = {name}: gives {shown(coefficients)}: must give numbers")
    try:
        fits = np.broadcast_shapes(values.shape, shape) == shape
    except ValueError:
        fits = False
    if not fits:
        raise InputError(
            f"coefficient = {name}: gives an array of shape {values.shape}: must give one number, or numbers of the "
            f"shape {shape} of the conditions"
        )
    wrong = ~((values >= 0.0) & (values <= COEFFICIENT_LIMIT))
    if np.any(wrong):
        everywhere = np.broadcast_to(wrong, shape)
        first = tuple(int(i) for i in np.argwhere(everywhere)[0])
        raise InputError(
            f"coefficient = {name}: gives {float(np.broadcast_to(values, shape)[first]):g} at "
            f"{np.count_nonzero(everywhere)} of {everywhere.size} contacts and conditions, first at "
            f"{conditions.described(first)}: must give numbers from 0 to {COEFFICIENT_LIMIT:g}"
        )
    return values.astype(np.float64)


def model_name(model: str | float | CoefficientModel) -> str:
    """Name of a model of the friction coefficient: its own, that of the function, or the number."""
    if isinstance(model, str):
        return model
    if not callable(model):
        return f"{model:g}"
    function = getattr(model, "func", model)  # of functools.partial
    return str(getattr(function, "__name__", type(function).__name__))


def contact_conditions(
    *,
    hertz_pressure: ArrayLike,
    equivalent_radius: ArrayLike,
    rolling_velocity: ArrayLike,
    slide_to_roll: ArrayLike,
    roughness: ArrayLike | tuple[ArrayLike, ArrayLike],
    temperature: ArrayLike = 90.0,
    oil: str | Lubricant = "75w90",
    sliding_velocity: ArrayLike | None = None,
    contact_modulus: float = STEEL_MODULUS,
    film: str = "pan_hamrock",
    film_heating: str = "none",
    out_of_range: OutOfRange = "error",
) -> ContactConditions:
    """Checked conditions of line contacts, in SI; pressure is Hertz's greatest, roughness Rq of both or a pair.

    Rolling is the mean surface velocity across the contact line, slide-to-roll sliding over it, ``sliding_velocity``
    the whole. The modulus is 2/[(1 - v1^2)/E1 + (1 - v2^2)/E2] [Pa], the temperature in [degC].
    """
    given = roughness if isinstance(roughness, tuple) else (roughness, roughness)
    if len(given) != 2:
        raise InputError(f"roughness = {shown(roughness)}: must be a number, or a tuple (pinion, gear) [m]")
    rolling = array("rolling_velocity", rolling_velocity, "m/s", fewest=1, above=0.0)
    ratio = array("slide_to_roll", slide_to_roll, fewest=1, least=0.0)
    sliding = ratio * rolling if sliding_velocity is None else sliding_velocity
    state = lubricant(oil).at(temperature, out_of_range=out_of_range)
    return ContactConditions(
        hertz_pressure=array("hertz_pressure", hertz_pressure, "Pa", fewest=1, above=0.0),
        equivalent_radius=array("equivalent_radius", equivalent_radius, "m", fewest=1, above=0.0),
        rolling_velocity=rolling,
        sliding_velocity=array("sliding_velocity", sliding, "m/s", fewest=1, least=0.0),
        slide_to_roll=ratio,
        roughness_pinion=array("roughness_pinion", given[0], "m", fewest=1, least=0.0),
        roughness_gear=array("roughness_gear", given[1], "m", fewest=1, least=0.0),
        temperature=np.asarray(temperature, dtype=float),
        viscosity=state.viscosity,
        pressure_viscosity=state.pressure_viscosity,
        temperature_viscosity=state.temperature_viscosity,
        thermal_conductivity=state.thermal_conductivity,
        contact_modulus=contact_modulus,
        film_formula=film,
        film_heating=film_heating,
    )


def friction_coefficient(model: str | float | CoefficientModel = DEFAULT_COEFFICIENT, **conditions: Any) -> Array:
    """Friction coefficient of lubricated line contacts.

    Parameters
    ----------
    model
        Name of a model in ``COEFFICIENTS``, a constant, or a function of ``ContactConditions``.
    **conditions
        Those of ``contact_conditions``: hertz_pressure, equivalent_radius, rolling_velocity, slide_to_roll, roughness,
        temperature, oil and more, in SI.

    Returns
    -------
    Array
        Coefficients, of the shape to which the conditions broadcast.

    Raises
    ------
    InputError
        From model and conditions, or if a function gives other than numbers from 0 to ``COEFFICIENT_LIMIT``.

    Examples
    --------
    >>> mu = friction_coefficient(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
    ...                           slide_to_roll=0.45, roughness=0.8e-6, temperature=90.0)
    >>> print(f"{mu:.5f}")
    0.05119
    """
    return checked_coefficient(model, contact_conditions(**conditions))
