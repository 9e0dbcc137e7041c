"""How a gear pair runs: speeds, oil temperatures and roughnesses, and by which models its friction is computed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ..core.errors import InputError
from .coefficient import CoefficientModel, coefficient_model
from .film_thickness import film
from .loaded_contacts import RadiusDirection
from .lubricant import Lubricant, OilState, OutOfRange, lubricant
from .rolling_traction import THERMAL_FACTORS
from .surface_velocities import SurfaceVelocities

Array = NDArray[Any]
Numbers = float | Sequence[float] | Array
Roughness = float | tuple[float, float]
FrameOfRolling = Literal["fixed", "contact_line"]
SlidingOfRatio = Literal["across", "whole"]
HIGHEST_SPEED = 1e6
CHOICES = {
    "rolling_frame": get_args(FrameOfRolling),
    "sliding_of_ratio": get_args(SlidingOfRatio),
    "radius_direction": get_args(RadiusDirection),
    "out_of_range": get_args(OutOfRange),
}


def _numbers(name: str, values: Any, low: float, high: float, allowed: str) -> Array:
    try:
        array = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} = {values!r}: must be a number or a list of numbers") from error
    if array.ndim != 1 or array.size == 0:
        raise InputError(f"{name} = {values!r}: must be a number or a list of numbers")
    bad = ~((array >= low) & (array <= high))
    if np.any(bad):
        raise InputError(f"{name} = {array[bad][0]:g}: must be {allowed}")
    if np.unique(array).size != array.size:
        raise InputError(f"{name} = {array.tolist()}: a value comes twice")
    return array


def _mean_roughness(pairs: Array) -> Array:
    """Quadratic mean (n) of pairs (n, 2), exactly the value of equal ones."""
    return np.where(pairs[:, 0] == pairs[:, 1], pairs[:, 0], np.sqrt(np.mean(pairs**2, axis=1)))


@dataclass(frozen=True)
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

    Raises
    ------
    InputError
        If a value is not possible, or there is no such lubricant.
    """

    speed: Numbers
    temperature: Numbers = 90.0
    roughness: Roughness | list[Roughness] | Array = 0.8
    oil: str | Lubricant = "75w90"
    speeds: Array = field(init=False, repr=False)
    temperatures: Array = field(init=False, repr=False)
    roughnesses: Array = field(init=False, repr=False)
    lubricant: Lubricant = field(init=False, repr=False)

    def __post_init__(self) -> None:
        tiny = np.finfo(float).tiny
        speeds = _numbers("speed", self.speed, tiny, HIGHEST_SPEED, f"above 0 and at most {HIGHEST_SPEED:g} per minute")
        temperatures = _numbers("temperature", self.temperature, -273.15, np.inf, "above -273.15 degC")
        given = self.roughness
        many = isinstance(given, list) or (isinstance(given, np.ndarray) and given.ndim > 0)
        entries: list[Any] = list(given) if many else [given]  # type: ignore[arg-type]
        pairs = [entry if isinstance(entry, tuple) else (entry, entry) for entry in entries]
        try:
            flat = np.array(pairs, dtype=float)
        except (TypeError, ValueError):
            flat = np.zeros(0)
        if flat.ndim != 2 or flat.shape[1] != 2:
            raise InputError(
                f"roughness = {given!r}: must be a number in um, a tuple (pinion, gear), or a list of such"
            )
        if not np.all((flat >= 0.0) & (flat <= 100.0)):
            raise InputError(f"roughness = {given!r}: every value must be within 0 and 100 um")
        if np.unique(_mean_roughness(flat)).size != len(flat):
            raise InputError(f"roughness = {given!r}: a value comes twice; of a pair its quadratic mean counts")
        for name, value in (
            ("speeds", speeds),
            ("temperatures", temperatures),
            ("roughnesses", flat),
            ("lubricant", lubricant(self.oil)),
        ):
            object.__setattr__(self, name, value)

    @property
    def angular_velocity(self) -> Array:
        """Of the pinion [rad/s] (speeds)."""
        return np.asarray(self.speeds * (2.0 * np.pi / 60.0))

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
    """By which models friction is computed.

    Parameters
    ----------
    coefficient
        Name of a model in ``coefficient.COEFFICIENTS``, a constant, or a function of ``ContactConditions``.
    film
        Name of a formula in ``film.FILMS``.
    thermal_factor
        Of the rolling traction, a name in ``rolling.THERMAL_FACTORS``.
    rolling_frame
        Rolling velocity and slide-to-roll in the ``fixed`` frame, as the dissertation has it, or relative to the moving
        ``contact_line``.
    sliding_of_ratio
        Whether the sliding in slide-to-roll is that ``across`` the contact line, as the dissertation's figures have it,
        or the ``whole`` sliding. The power loss is that of the whole sliding in either case.
    radius_direction
        Equivalent radius, and the Hertz pressure that goes with it, ``across`` the contact line, where the flanks
        roll, or ``along`` it, as the dissertation's figures seem to have it (``line_radius``). The
        latter is there to compare with the dissertation, not for use.
    out_of_range
        Temperatures the oil has no data for: ``error``, or ``clamp`` and flag it.

    Raises
    ------
    InputError
        If a name is unknown.
    """

    coefficient: str | float | CoefficientModel = "kolivand"
    film: str = "pan_hamrock"
    thermal_factor: str = "goksem_hargreaves"
    rolling_frame: FrameOfRolling = "fixed"
    sliding_of_ratio: SlidingOfRatio = "across"
    radius_direction: RadiusDirection = "across"
    out_of_range: OutOfRange = "error"

    def __post_init__(self) -> None:
        coefficient_model(self.coefficient)
        film(self.film)
        if self.thermal_factor not in tuple(THERMAL_FACTORS):
            raise InputError(f"thermal_factor = {self.thermal_factor!r}: must be one of {', '.join(THERMAL_FACTORS)}")
        for name, allowed in CHOICES.items():
            if getattr(self, name) not in allowed:
                raise InputError(f"{name} = {getattr(self, name)!r}: must be {' or '.join(map(repr, allowed))}")

    def rolling(self, velocities: SurfaceVelocities) -> Array:
        """Rolling velocity (...), signed as ``SurfaceVelocities.across``, in the chosen frame."""
        return velocities.rolling if self.rolling_frame == "fixed" else velocities.rolling_over_line

    def slide_to_roll(self, velocities: SurfaceVelocities) -> Array:
        """Slide-to-roll ratio (...), as chosen."""
        across = self.sliding_of_ratio == "across"
        sliding = velocities.sliding_across if across else velocities.sliding_speed
        return np.asarray(np.abs(sliding / self.rolling(velocities)))

    @property
    def name(self) -> str:
        """The coefficient's model in words."""
        if isinstance(self.coefficient, str):
            return self.coefficient
        return getattr(self.coefficient, "__name__", "own") if callable(self.coefficient) else f"{self.coefficient:g}"

    @property
    def is_formula(self) -> bool:
        """Whether the coefficient is that of Eq. 5.11, with its ranges."""
        return isinstance(self.coefficient, str) and self.coefficient in ("kolivand", "kolivand_blended")

    def oil_states(self, operation: Operation) -> OilState:
        """The oil at all temperatures; raises InputError as ``Lubricant.at``."""
        return operation.lubricant.at(operation.temperatures, out_of_range=self.out_of_range)


def checked_model(operation: Operation, model: FrictionModel | str | float | CoefficientModel | None) -> FrictionModel:
    """The model, from that of the coefficient alone if that is given.

    Raises
    ------
    InputError
        If the operation is none, or there is no such model.
    """
    if not isinstance(operation, Operation):
        raise InputError(f"operation = {operation!r}: must be an Operation, as Operation(speed=1500)")
    if model is None:
        return FrictionModel()
    return model if isinstance(model, FrictionModel) else FrictionModel(model)


def named_models(attributes: Mapping[Any, Any]) -> str:
    """Oil and models of a group ``/friction`` in words, from its attributes: those that are not the usual ones."""
    usual = {"film": "film", "thermal_factor": "thermal factor", "rolling_frame": "rolling frame",
             "sliding_of_ratio": "sliding of the ratio", "radius_direction": "radius"}  # fmt: skip
    words = [f"oil {attributes['oil']}", f"coefficient {attributes['friction_coefficient']}"]
    for name, word in usual.items():
        default = FrictionModel.__dataclass_fields__[name].default
        if attributes.get(name, default) != default:
            words.append(f"{word} {attributes[name]}")
    return ", ".join(words)
