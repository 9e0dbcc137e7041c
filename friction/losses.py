"""Friction, film and power loss of loaded contacts at many operating conditions, a block of contacts at a time.

Arrays over (speed, temperature, roughness, contact): the contacts last, so that the innermost loops are long. What does
not depend on a dimension has length one there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .coefficient import coefficient_model
from .conditions import ContactConditions
from .loaded_contacts import LoadedContacts
from .operation import FrictionModel, Operation
from .rolling_traction import rolling_traction

Array = NDArray[Any]
BLOCK_SIZE = 200_000  # values: intermediate arrays stay in the processor's cache


@dataclass(frozen=True)
class Losses:
    """Friction coefficient and power loss of a block of contacts.

    Parameters
    ----------
    contacts
        Which contacts (c).
    conditions
        Their operating conditions.
    coefficient
        Friction coefficient (speed, temperature, roughness, c).
    sliding_loss, rolling_loss
        Power loss [W], the second of length one over the roughness.
    """

    contacts: slice
    conditions: ContactConditions
    coefficient: Array
    sliding_loss: Array
    rolling_loss: Array


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
        **by_temperature,
    )


def losses(contacts: LoadedContacts, operation: Operation, model: FrictionModel) -> Iterator[Losses]:
    """Friction coefficient and power loss of all contacts (Kolivand 2009, Eq. 5.10 to 5.12), block by block.

    The sliding loss is the friction force times the whole sliding velocity, the rolling loss the rolling traction times
    length and rolling velocity.
    """
    coefficient = coefficient_model(model.coefficient)
    per_contact = int(np.prod(operation.shape))
    step = max(1, BLOCK_SIZE // per_contact)
    for start in range(0, contacts.force.size, step):
        block = slice(start, min(start + step, contacts.force.size))
        conditions = conditions_of(contacts, operation, model, block)
        friction = np.broadcast_to(coefficient(conditions), (*operation.shape, block.stop - start))
        sliding = (contacts.force[block] * conditions.sliding_velocity) * friction
        traction = rolling_traction(conditions, model.thermal_factor) * contacts.length[block]
        yield Losses(block, conditions, friction, sliding, traction * conditions.rolling_velocity)
