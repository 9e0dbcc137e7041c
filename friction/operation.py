"""Operating conditions of a gear pair (speeds, oil temperatures, roughnesses), and the models of its friction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Literal, get_args

import numpy as np

from ..core.arrays import Array, record
from ..core.checks import array, bounded, check_fields, distinct, instance, number, one_of
from ..core.errors import InputError
from .coefficient import DEFAULT_COEFFICIENT, RANGE_FLAGS, CoefficientModel, coefficient_model, model_name
from .conditions import FILM_FACTORS, THERMAL_FACTORS, film_formula
from .loaded_contacts import SurfaceVelocities
from .lubricants.lubricant import Lubricant, OilState, OutOfRange, lubricant

Numbers = float | Sequence[float] | Array
Roughness = float | tuple[float, float]
ByMember = float | tuple[float, float]
FrameOfRolling = Literal["fixed", "contact_line"]
SPEED_MINIMUM, SPEED_LIMIT = 1e-6, 1e6  # [1/min]; a turn in two years is at rest
ROUGHNESS_LIMIT = 100.0  # [um]
ABSOLUTE_ZERO = -273.15  # [degC]
TEMPERATURE_LIMIT = 400.0  # [degC]; of the tables of lubricants, too
BULK_TEMPERATURE_LIMIT = 1000.0  # [degC]

#: Of steel: thermal conductivity [W/(m K)], density [kg/m^3], specific heat capacity [J/(kg K)].
CONDUCTIVITY, DENSITY, HEAT_CAPACITY = 46.0, 7850.0, 460.0


@dataclass(frozen=True)
class ThermalMaterial:
    """Thermal properties of a member: conductivity, density and specific heat capacity."""

    conductivity: float = field(default=CONDUCTIVITY, metadata=bounded("W/(m K)", least=0.01, most=1e4))
    density: float = field(default=DENSITY, metadata=bounded("kg/m^3", least=10.0, most=1e5))
    heat_capacity: float = field(default=HEAT_CAPACITY, metadata=bounded("J/(kg K)", least=1.0, most=1e5))

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def diffusivity(self) -> float:
        """Conductivity over density and heat capacity [m^2/s]."""
        return self.conductivity / (self.density * self.heat_capacity)

    @property
    def thermal_contact_coefficient(self) -> float:
        """Root of conductivity, density and heat capacity [J/(m^2 K s^0.5)], also called effusivity."""
        return float(np.sqrt(self.conductivity * self.density * self.heat_capacity))


def by_member(name: str, value: Any, unit: str, **bounds: Any) -> tuple[float, float]:
    """Property of pinion and gear, given as one number for both or as a pair; refused out of its bounds."""
    pair = value if isinstance(value, tuple | list) else (value, value)
    if len(pair) != 2:
        raise InputError(f"{name} = {value!r}: must be a number, or a pair for pinion and gear [{unit}]")
    first, second = (number(name, each, unit, **bounds) for each in pair)
    return first, second


def _mean_roughness(pairs: Array) -> Array:
    """Quadratic mean (n) of pairs (n, 2), exactly the value of equal ones."""
    return np.where(pairs[:, 0] == pairs[:, 1], pairs[:, 0], np.sqrt(np.mean(pairs**2, axis=1)))


@record(frozen=True)
class Operation:
    """Speeds, temperatures and roughnesses; every combination is computed.

    Parameters
    ----------
    speed
        Of the pinion [1/min], one or several.
    temperature
        Of the oil at the inlet of the contact [degC], one or several.
    roughness
        RMS height Rq [um]: a number for both flanks, a tuple (pinion, gear), or a list of such.
    oil
        Name of a lubricant, path of its file, or a ``Lubricant``.
    bulk_temperature
        Of the teeth [degC], on top of which the flash temperature comes; that of the oil if left out.

    Raises
    ------
    InputError
        If a value is not possible, or there is no such lubricant.

    Examples
    --------
    >>> Operation(speed=[500.0, 1500.0], temperature=60.0, roughness=[0.8, (0.8, 0.4)]).shape
    (2, 1, 2)
    """

    speed: Numbers
    temperature: Numbers = 90.0
    roughness: Roughness | list[Roughness] | Array = 0.8
    oil: str | Lubricant = "75w90"
    bulk_temperature: float | None = None
    speeds: Array = field(init=False, repr=False)
    temperatures: Array = field(init=False, repr=False)
    roughnesses: Array = field(init=False, repr=False)
    lubricant: Lubricant = field(init=False, repr=False)

    def __post_init__(self) -> None:
        speeds = distinct("speed", self.speed, "1/min", above=0.0, most=SPEED_LIMIT)
        if speeds.min() < SPEED_MINIMUM:
            allowed = f"from {SPEED_MINIMUM:g} to {SPEED_LIMIT:g} [1/min]"
            raise InputError(f"speed = {speeds.min():g}: must be a number {allowed}")
        temperatures = distinct("temperature", self.temperature, "degC", above=ABSOLUTE_ZERO, most=TEMPERATURE_LIMIT)
        given = self.roughness
        many = isinstance(given, list) or (isinstance(given, np.ndarray) and given.ndim > 0)
        entries: list[Any] = list(given) if many else [given]  # type: ignore[arg-type]
        pairs = [entry if isinstance(entry, tuple) else (entry, entry) for entry in entries]
        flat = array("roughness", pairs, "um", ndim=2, least=0.0, most=ROUGHNESS_LIMIT)
        if flat.shape[1] != 2:
            raise InputError(f"roughness = {given!r}: must be a number, a tuple (pinion, gear), or a list of such [um]")
        if np.unique(_mean_roughness(flat)).size != len(flat):
            raise InputError(f"roughness = {given!r}: must be values that differ; of a pair the quadratic mean counts")
        if self.bulk_temperature is not None:
            number("bulk_temperature", self.bulk_temperature, "degC", above=ABSOLUTE_ZERO, most=BULK_TEMPERATURE_LIMIT)
        values = {"speeds": speeds, "temperatures": temperatures, "roughnesses": flat, "lubricant": lubricant(self.oil)}
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def angular_velocity(self) -> Array:
        """Of the pinion [rad/s] (speeds)."""
        return np.asarray(self.speeds * (2.0 * np.pi / 60.0))

    @property
    def bulk_temperatures(self) -> Array:
        """Of the teeth [degC] at each temperature of the oil (temperatures)."""
        if self.bulk_temperature is None:
            return self.temperatures
        return np.full(self.temperatures.shape, float(self.bulk_temperature))

    @property
    def mean_roughnesses(self) -> Array:
        """The quadratic mean of both flanks' roughnesses [um] (roughnesses)."""
        return _mean_roughness(self.roughnesses)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of speeds, temperatures and roughnesses."""
        return self.speeds.size, self.temperatures.size, self.roughnesses.shape[0]


@dataclass(frozen=True)
class FrictionModel:
    """Models of friction coefficient, film thickness and rolling traction, and what conducts the heat of friction.

    Parameters
    ----------
    coefficient
        Name of a model in ``COEFFICIENTS``, a constant, or a function of ``ContactConditions``.
    film
        Name of a formula in ``FILMS``.
    thermal_factor
        Of the rolling traction, a name in ``THERMAL_FACTORS``.
    rolling_frame
        Rolling velocity and slide-to-roll in the ``fixed`` frame, as the dissertation has it, or relative to the moving
        ``contact_line``.
    out_of_range
        Temperatures the oil has no data for: ``error``, or ``clamp`` and flag it.
    film_heating
        Factor by which heat of the inlet thins the film, a name in ``FILM_FACTORS``. The dissertation's formula was
        made with the film without.
    tooth_conductivity, tooth_density, tooth_heat_capacity
        Of the teeth [W/(m K)], [kg/m^3], [J/(kg K)], for the flash temperature: a number, or a tuple (pinion, gear);
        steel if left out.

    Raises
    ------
    InputError
        If a name is unknown, or a number is not possible.

    Examples
    --------
    >>> FrictionModel("benedict_kelly", film="dowson_higginson").name
    'benedict_kelly'
    """

    coefficient: str | float | CoefficientModel = DEFAULT_COEFFICIENT
    film: str = "pan_hamrock"
    thermal_factor: str = "goksem_hargreaves"
    rolling_frame: FrameOfRolling = "fixed"
    out_of_range: OutOfRange = "error"
    film_heating: str = "none"
    tooth_conductivity: ByMember = CONDUCTIVITY
    tooth_density: ByMember = DENSITY
    tooth_heat_capacity: ByMember = HEAT_CAPACITY
    materials: tuple[ThermalMaterial, ThermalMaterial] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        coefficient_model(self.coefficient)
        film_formula(self.film)
        one_of("film_heating", self.film_heating, FILM_FACTORS)
        one_of("thermal_factor", self.thermal_factor, THERMAL_FACTORS)
        one_of("rolling_frame", self.rolling_frame, get_args(FrameOfRolling))
        one_of("out_of_range", self.out_of_range, get_args(OutOfRange))
        names = {f"tooth_{one.name}": one.metadata for one in fields(ThermalMaterial)}
        properties = [by_member(name, getattr(self, name), **bounds) for name, bounds in names.items()]
        pinion, gear = (ThermalMaterial(*each) for each in zip(*properties, strict=True))
        object.__setattr__(self, "materials", (pinion, gear))

    def rolling(self, velocities: SurfaceVelocities) -> Array:
        """Rolling velocity (...), signed as ``SurfaceVelocities.across``, in the chosen frame."""
        return velocities.rolling if self.rolling_frame == "fixed" else velocities.rolling_over_line

    def slide_to_roll(self, velocities: SurfaceVelocities) -> Array:
        """Slide-to-roll ratio (...): sliding across the contact line over the rolling velocity."""
        return np.asarray(np.abs(velocities.sliding_across / self.rolling(velocities)))

    @property
    def name(self) -> str:
        """Name of the model of the coefficient."""
        return model_name(self.coefficient)

    @property
    def has_range(self) -> bool:
        """True if the model of the coefficient has a range that is known."""
        return isinstance(self.coefficient, str) and self.coefficient in RANGE_FLAGS

    @property
    def has_regimes(self) -> bool:
        """True if the model of the coefficient is made of several expressions."""
        return isinstance(self.coefficient, str) and self.coefficient in ("kolivand", "kolivand_blended")

    def oil_states(self, operation: Operation) -> OilState:
        """The oil at all temperatures; raises InputError as ``Lubricant.at``."""
        return operation.lubricant.at(operation.temperatures, out_of_range=self.out_of_range)


def checked_model(operation: Operation, model: FrictionModel | str | float | CoefficientModel | None) -> FrictionModel:
    """Friction model, completed where that of the coefficient alone is given."""
    instance("operation", operation, Operation)
    model = FrictionModel() if model is None else model
    return model if isinstance(model, FrictionModel) else FrictionModel(model)


def named_models(attributes: Mapping[Any, Any]) -> str:
    """Oil and models of a group ``/friction`` in words, from its attributes: those that are not the usual ones."""
    words = [f"oil {attributes['oil']}", f"coefficient {attributes['friction_coefficient']}"]
    for name in ("film", "film_heating", "thermal_factor", "rolling_frame"):
        default = FrictionModel.__dataclass_fields__[name].default
        if attributes.get(name, default) != default:
            words.append(f"{name.replace('_', ' ')} {attributes[name]}")
    return ", ".join(words)
