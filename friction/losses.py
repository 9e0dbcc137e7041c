"""Friction, film and power loss of loaded contacts at many operating conditions, a block of contacts at a time.

Arrays over (speed, temperature, roughness, contact): the contacts last, so that the innermost loops are long. What does
not depend on a dimension has length one there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..core.arrays import Array
from .coefficient import RANGE_FLAGS, checked_coefficient
from .conditions import ContactConditions
from .contact_temperature import flash_temperature
from .film_thickness import THERMAL_FACTORS
from .kolivand_formula import Flags, between_regimes
from .loaded_contacts import LoadedContacts
from .operation import FrictionModel, Operation
from .rolling_traction import rolling_traction

TOLD_FACTOR = "gupta_cheng"  # by which the film's thinning is told where the model leaves it out
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
