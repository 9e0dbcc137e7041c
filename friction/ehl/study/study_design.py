"""Design of the parameter study (the dissertation's tables 5.1 and 5.2): levels, oil, and space-filling subsets."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from ....core import checks
from ....core.errors import InputError
from ...conditions import STEEL_MODULUS
from ...lubricants.lubricant import lubricant
from ..rolling_contact.lubricated_contact import PRESSURE_PARAMETER_LIMIT, LubricatedContact
from ..rolling_contact.oil import Oil

#: Not in the dissertation: Eyring stress of a usual gear oil [Pa].
EYRING_STRESS = 5e6
#: Units of the parameters, the temperatures that the oil is known at, and the pressure beyond which nothing is a Hertz
#: contact of steel (``LubricatedContact`` refuses it), in these units.
LEVEL_UNITS = {
    "hertz_pressure": "GPa",
    "equivalent_radius": "mm",
    "rolling_velocity": "m/s",
    "slide_to_roll": "1",
    "temperature": "degC",
    "roughness": "um",
    "roughness_1": "um",
    "roughness_2": "um",
}
TEMPERATURE_RANGE = (25.0, 100.0)
PRESSURE_LIMIT = PRESSURE_PARAMETER_LIMIT * STEEL_MODULUS * 1e-9


def oil_75w90(temperature: float) -> Oil:
    """Return the oil of the dissertation (its table 5.2) at a temperature from 25 to 100 degC.

    Raises
    ------
    InputError
        If the temperature is beyond the table.
    """
    checks.number("temperature", temperature, "degC")
    return Oil.of(
        # As the stored studies have it, in which levels between the temperatures of the table count.
        lubricant("75w90").at(temperature, interpolation="log_linear"),
        eyring_stress=EYRING_STRESS,
        law="two_slope",
        inlet_temperature=temperature,
    )


def _level(name: str, value: Any) -> float:
    """Return a level of a parameter, checked."""
    if name == "slide_to_roll":
        return checks.number(name, value, least=-2.0, most=2.0)
    if name == "temperature":
        return checks.number(name, value, LEVEL_UNITS[name], least=TEMPERATURE_RANGE[0], most=TEMPERATURE_RANGE[1])
    if name == "hertz_pressure":
        return checks.number(name, value, LEVEL_UNITS[name], above=0.0, most=PRESSURE_LIMIT)
    return checks.positive(name, value, LEVEL_UNITS[name])


@dataclass(frozen=True)
class Condition:
    """One combination of the study, in its units.

    Parameters
    ----------
    hertz_pressure
        [GPa].
    equivalent_radius
        [mm].
    rolling_velocity
        [m/s].
    slide_to_roll
        [1].
    temperature
        Of the oil in the inlet [degC].
    roughness_1, roughness_2
        Rms heights of the surfaces [um].

    Raises
    ------
    InputError
        If a number is not positive, or not in the range of a contact or of the oil.

    Examples
    --------
    >>> condition = Condition(0.5, 5.0, 20.0, 0.5, 50.0, roughness_1=0.3, roughness_2=0.4)
    >>> print(f"{condition.composite_roughness:.1e} m")
    5.0e-07 m
    """

    hertz_pressure: float
    equivalent_radius: float
    rolling_velocity: float
    slide_to_roll: float
    temperature: float
    roughness_1: float
    roughness_2: float

    def __post_init__(self) -> None:
        for field in fields(self):
            _level(field.name, getattr(self, field.name))

    @property
    def contact(self) -> LubricatedContact:
        """The line contact between steel bodies."""
        return LubricatedContact(
            hertz_pressure=1e9 * self.hertz_pressure,
            equivalent_radius=1e-3 * self.equivalent_radius,
            rolling_velocity=self.rolling_velocity,
            oil=oil_75w90(self.temperature),
            slide_to_roll=self.slide_to_roll,
            contact_modulus=STEEL_MODULUS,
        )

    @property
    def composite_roughness(self) -> float:
        """Root of the sum of the squares of both rms heights [m]."""
        return 1e-6 * math.hypot(self.roughness_1, self.roughness_2)


@dataclass(frozen=True)
class Design:
    """Levels of a study; by default those of the dissertation, 31,500 combinations.

    Each pair of roughnesses occurs once, the smoother surface first: 15 pairs of 5 levels.

    Raises
    ------
    InputError
        If a parameter has no levels, or one that a ``Condition`` cannot have.

    Examples
    --------
    >>> Design().size, Design(temperature=(90.0,)).size
    (31500, 7875)
    """

    hertz_pressure: tuple[float, ...] = (0.5, 1.0, 1.5, 2.0, 2.5)
    equivalent_radius: tuple[float, ...] = (5.0, 20.0, 40.0)
    rolling_velocity: tuple[float, ...] = (1.0, 5.0, 10.0, 15.0, 20.0)
    slide_to_roll: tuple[float, ...] = (0.025, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0)
    temperature: tuple[float, ...] = (25.0, 50.0, 75.0, 100.0)
    roughness: tuple[float, ...] = (0.1, 0.35, 0.6, 0.85, 1.0)

    def __post_init__(self) -> None:
        for field in fields(self):
            levels = getattr(self, field.name)
            if not isinstance(levels, list | tuple | np.ndarray) or getattr(levels, "ndim", 1) != 1 or not len(levels):
                raise InputError(f"{field.name} = {checks.shown(levels)}: must be levels in a row, such as (1.0, 2.0)")
            object.__setattr__(self, field.name, tuple(_level(field.name, level) for level in levels))

    @cached_property
    def _axes(self) -> tuple[tuple[Any, ...], ...]:
        pairs = tuple(combinations_with_replacement(self.roughness, 2))
        return (
            self.hertz_pressure,
            self.equivalent_radius,
            self.rolling_velocity,
            self.slide_to_roll,
            self.temperature,
            pairs,
        )

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of levels of each parameter; the last is that of the pairs of roughnesses."""
        return tuple(len(axis) for axis in self._axes)

    @property
    def size(self) -> int:
        """Number of combinations."""
        return math.prod(self.shape)

    def condition(self, number: int) -> Condition:
        """Return a combination by its number, from 0; the last parameter changes fastest.

        Raises
        ------
        InputError
            If there is no such combination.
        """
        levels = np.unravel_index(checks.whole("number", number, 0, self.size - 1), self.shape)
        *single, pair = (axis[int(level)] for axis, level in zip(self._axes, levels, strict=True))
        return Condition(*single, *pair)

    def subset(self, size: int, seed: int = 0) -> NDArray[np.int_]:
        """Choose combinations that fill the space of the parameters evenly.

        Parameters
        ----------
        size
            Number of combinations.
        seed
            Of the scrambling.

        Returns
        -------
        (size) int array
            Their numbers, all different, in the order of a scrambled Sobol sequence over the levels (points that fall
            on a combination again are skipped): the first of a long subset are a good short one.

        Raises
        ------
        InputError
            If more than there are, or none; or the seed is no whole number.
        """
        size = checks.whole("size", size, 1, self.size)
        checks.whole("seed", seed, 0)
        if size == self.size:
            return np.arange(size)
        sequence = qmc.Sobol(len(self.shape), seed=seed)
        chosen: dict[int, None] = {}
        while len(chosen) < size:
            levels = (sequence.random(1024) * self.shape).astype(int)
            for number in np.ravel_multi_index(tuple(levels.T), self.shape):
                chosen.setdefault(int(number))
        return np.array(list(chosen)[:size])


#: The levels of the dissertation and others between them: what a formula needs that holds between the former as well.
REFINED = Design(
    hertz_pressure=(0.5, 0.6, 0.75, 0.9, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5),
    equivalent_radius=(5.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0),
    rolling_velocity=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 12.0, 15.0, 17.0, 20.0),
    slide_to_roll=(0.025, 0.035, 0.05, 0.07, 0.1, 0.15, 0.25, 0.35, 0.5, 0.75, 1.0),
    temperature=(25.0, 30.0, 37.5, 45.0, 50.0, 55.0, 62.5, 70.0, 75.0, 82.5, 90.0, 100.0),
    roughness=(0.1, 0.15, 0.2, 0.35, 0.5, 0.6, 0.7, 0.85, 1.0),
)


def numbers(design: Design, wanted: Iterable[int] | int | None) -> NDArray[np.int_]:
    """Numbers of the combinations that are wanted: given, a subset of a size, or all.

    Raises
    ------
    InputError
        If a number is not whole, or there is none.
    """
    if wanted is None:
        return np.arange(design.size)
    if _is_whole(wanted):
        return design.subset(operator.index(wanted))  # type: ignore[arg-type]
    try:
        given = list(wanted)  # type: ignore[arg-type]
    except TypeError:
        given = []
    if not given or not all(map(_is_whole, given)):
        raise InputError(
            f"wanted = {checks.shown(wanted)}: must be a number of cases, numbers of combinations, or None for all"
        )
    return np.array([operator.index(number) for number in given], dtype=int)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)
