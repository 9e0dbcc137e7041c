"""Friction, film and power loss of loaded contacts at many operating conditions, a block of contacts at a time.

Arrays over (speed, temperature, roughness, contact): the contacts last, so that the innermost loops are long. What does
not depend on a dimension has length one there.

The hottest contact of a mesh cycle, at every operating condition, is found on the way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from ..core.arrays import Array, Integers
from ..core.checks import instance, one_of
from .coefficient import RANGE_FLAGS, checked_coefficient
from .conditions import THERMAL_FACTORS, ContactConditions
from .contact_temperature import flash_temperature
from .kolivand_formula import Flags, between_regimes
from .loaded_contacts import LoadedContacts
from .operation import FrictionModel, Operation

TOLD_FACTOR = "gupta_cheng"  # by which the film's thinning is told where the model leaves it out
OPERATING_DIMENSIONS = ("torque", "speed", "temperature", "roughness")
BLOCK_SIZE = 200_000  # values: intermediate arrays stay in the processor's cache


@dataclass(frozen=True)
class Losses:
    """Friction and power loss of contacts (speed, temperature, roughness, c); edges have NaN temperatures."""

    contacts: slice
    conditions: ContactConditions
    coefficient: Array
    sliding_loss: Array  # [W]
    rolling_loss: Array  # [W], length one over the roughness
    flags: Flags | None  # beyond the formula's range, sums of FLAGS; None without one
    between_regimes: Array
    film_thinning: Array  # by inlet heat, by the model's factor, or Gupta's
    flash_temperature: Array  # [K]
    pressure_velocity: Array  # Hertz pressure times sliding velocity [W/m^2], (speed, 1, 1, c)


def conditions_of(
    contacts: LoadedContacts, operation: Operation, model: FrictionModel, block: slice
) -> ContactConditions:
    """Conditions of a block of contacts, over (speed, temperature, roughness, contact)."""
    v = contacts.velocities.chosen(block)
    omega = operation.angular_velocity[:, None, None, None]
    oil = model.oil_states(operation)
    by_temperature = {
        name: np.asarray(getattr(oil, name))[:, None, None]
        for name in ("viscosity", "pressure_viscosity", "temperature_viscosity")
    }
    return ContactConditions(
        hertz_pressure=contacts.hertz_pressure[block],
        equivalent_radius=contacts.equivalent_radius[block],
        rolling_velocity=np.abs(model.rolling(v)) * omega,
        sliding_velocity=v.sliding_speed * omega,
        slide_to_roll=model.slide_to_roll(v),
        temperature=operation.temperatures[:, None, None],
        roughness_pinion=1e-6 * operation.roughnesses[:, :1],
        roughness_gear=1e-6 * operation.roughnesses[:, 1:],
        thermal_conductivity=oil.thermal_conductivity,
        contact_modulus=contacts.contact_modulus,
        film_formula=model.film,
        film_heating=model.film_heating,
        **by_temperature,
    )


def losses(contacts: LoadedContacts, operation: Operation, model: FrictionModel) -> Iterator[Losses]:
    """Friction coefficient and power loss of all contacts (Kolivand 2009, Eq. 5.10 to 5.12), block by block.

    Sliding loss is friction force times whole sliding velocity, rolling loss rolling traction times length and
    velocity.
    """
    materials = model.materials
    heating = TOLD_FACTOR if model.film_heating == "none" else model.film_heating
    per_contact = int(np.prod(operation.shape))
    step = max(1, BLOCK_SIZE // per_contact)
    for start in range(0, contacts.force.size, step):
        block = slice(start, min(start + step, contacts.force.size))
        conditions = conditions_of(contacts, operation, model, block)
        coefficient = checked_coefficient(model.coefficient, conditions)
        friction = np.broadcast_to(coefficient, (*operation.shape, block.stop - start))
        sliding = (contacts.force[block] * conditions.sliding_velocity) * friction
        traction = rolling_traction(conditions, model.thermal_factor) * contacts.length[block]
        velocities = contacts.velocities.chosen(block)
        over_line = [each * operation.angular_velocity[:, None, None, None] for each in velocities.over_line]
        # What rolling costs is sheared in the inlet and carried away by the oil.
        heat = sliding / np.where(contacts.on_line[block], contacts.length[block], np.nan)
        yield Losses(
            block,
            conditions,
            friction,
            sliding,
            traction * conditions.rolling_velocity,
            RANGE_FLAGS[model.name](conditions, friction) if model.has_range else None,
            between_regimes(conditions) if model.has_regimes else np.zeros((), dtype=bool),
            1.0 - THERMAL_FACTORS[heating](conditions),
            flash_temperature(heat, contacts.half_width[block], (over_line[0], over_line[1]), materials),
            np.where(contacts.on_line[block], conditions.hertz_pressure * conditions.sliding_velocity, np.nan),
        )


def isothermal_traction(conditions: ContactConditions) -> Array:
    """Rolling traction without heating of the inlet [N/m of contact length] (...).

    4.318 (G U)^0.658 W^0.0126 R / alpha: Goksem and Hargreaves 1978, doi 10.1115/1.3453183; Kolivand 2009, Eq. 5.10.
    """
    c = conditions
    scale = 4.318 * c.equivalent_radius / c.pressure_viscosity
    return np.asarray(scale * (c.material_parameter * c.speed_parameter) ** 0.658 * c.load_parameter**0.0126)


def rolling_traction(conditions: ContactConditions, thermal_factor: str = "goksem_hargreaves") -> Array:
    """Rolling traction [N/m of contact length] (...). Times rolling velocity and length it is the rolling power loss.

    Parameters
    ----------
    conditions
        Operating conditions of the contacts.
    thermal_factor
        Name of the factor for the inlet's heating, see ``THERMAL_FACTORS``.

    Raises
    ------
    InputError
        If there is no factor of that name.

    Examples
    --------
    >>> from easeoff.friction.coefficient import contact_conditions
    >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
    ...                              slide_to_roll=0.45, roughness=0.8e-6)
    >>> print(f"{rolling_traction(contact):.1f} N/m")
    67.5 N/m
    """
    instance("conditions", conditions, ContactConditions)
    factor = THERMAL_FACTORS[one_of("thermal_factor", thermal_factor, THERMAL_FACTORS)]
    return np.asarray(isothermal_traction(conditions) * factor(conditions))


class HottestContacts:
    """The hottest contact over (torque, speed, temperature, roughness), found a block of contacts at a time."""

    def __init__(self, shape: tuple[int, int, int, int]) -> None:
        self.flash, self.pressure_velocity = np.full(shape, -np.inf), np.full(shape, -np.inf)
        self.contact: Integers = np.zeros(shape, dtype=np.int64)

    def add(self, torque: Integers, block: Losses) -> None:
        """Add a block of contacts by their sorted torque numbers (c); a flash temperature of NaN does not count."""
        starts = np.flatnonzero(np.diff(torque, prepend=-1))
        flash, product = (
            np.where(np.isnan(values), -np.inf, values) for values in (block.flash_temperature, block.pressure_velocity)
        )
        for start, end in zip(starts, [*starts[1:], torque.size], strict=True):
            at = torque[start]
            hottest = np.argmax(flash[..., start:end], axis=-1)
            greatest = np.take_along_axis(flash[..., start:end], hottest[..., None], axis=-1)[..., 0]
            hotter = greatest > self.flash[at]
            self.flash[at] = np.where(hotter, greatest, self.flash[at])
            self.contact[at] = np.where(hotter, block.contacts.start + start + hottest, self.contact[at])
            self.pressure_velocity[at] = np.maximum(self.pressure_velocity[at], product[..., start:end].max(axis=-1))

    def variables(self, loaded: xr.Dataset, index: Integers, bulk_temperature: Array) -> dict[str, Any]:
        """Variables of the group ``/friction``, NaN where no contact line carries; bulk temperature in [degC].

        Contacts are numbered by torque, mesh position and segment (3, n), which come first in ``/loaded``.
        """
        known = np.isfinite(self.flash)
        values: dict[str, Array] = {
            "max_flash_temperature": self.flash,
            "max_contact_temperature": self.flash + bulk_temperature[:, None],
            "max_pressure_velocity": 1e-6 * self.pressure_velocity,
        }
        if index.size:
            at = tuple(index[:, self.contact])
            values["max_flash_position"] = loaded["mesh_position"].values[at[1]]
            for name in ("lengthwise", "profile"):
                values[f"max_flash_{name}"] = loaded[name].values[at]
        else:
            nowhere = ("position", "lengthwise", "profile")
            values |= {f"max_flash_{name}": np.full(self.flash.shape, np.nan) for name in nowhere}
        return {name: (OPERATING_DIMENSIONS, np.where(known, value, np.nan)) for name, value in values.items()}
