"""Which places of the pinion stand opposite places of the gear, in conjugate contact and some rotation from it.

Opposite a place of the gear that is in conjugate contact at the pinion rotation Q stands, at the rotation q, the pinion
point p + p' (q - Q) + p'' (q - Q)^2 / 2, with the derivatives that ``geometry.rolling.drift`` finds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.newton import cramers_rule, determinant
from .flank_splines import FlankFields

Array = NDArray[Any]

BEYOND = 0.05  # of the flank; how far the splines are followed in search of a place
STEPS = 3  # of Newton's method from an estimate of second order
SEARCH_STEPS = 12
FOUND = 1e-6  # of the flank
FRACTIONS = ("pinion_lengthwise", "pinion_profile")
#: Of the geometry's ``ease_off``, beside what ``contact_fields`` takes: how the pinion passes a place of the gear.
PASSING = tuple(f"{name}_{order}" for order in ("rate", "acceleration") for name in FRACTIONS)


@dataclass(frozen=True)
class Opposite:
    """Fractions on the pinion flank opposite places (n) of the gear.

    Parameters
    ----------
    fractions
        In conjugate contact (2, n).
    slopes
        Their derivatives by the fractions of the place (2, 2, n).
    rate, acceleration
        Their derivatives by the pinion rotation (2, n) [1/rad, 1/rad^2].
    """

    fractions: Array
    slopes: Array
    rate: Array
    acceleration: Array

    @classmethod
    def of(cls, fields: FlankFields, places: Array) -> Opposite:
        """Opposite places (2, n)."""
        value = np.stack(list(fields.evaluate([*FRACTIONS, *PASSING], places).values()))
        by_place = [fields.evaluate(list(FRACTIONS), places, d) for d in ((1, 0), (0, 1))]
        slopes = np.stack([[slope[name] for slope in by_place] for name in FRACTIONS])
        return cls(value[:2], slopes, value[2:4], value[4:])

    def after(self, left: Array) -> Array:
        """Fractions (2, ..., n) when the pinion is ``left`` (..., n) [rad] beyond conjugate contact."""
        first, rate, second = (
            np.reshape(v, (2, *[1] * (left.ndim - 1), -1)) for v in (self.fractions, self.rate, self.acceleration)
        )
        return np.asarray(first + rate * left + 0.5 * second * left**2)


def conjugate_places(fields: FlankFields, nodes: Array) -> Array:
    """Places (2, k) on the gear in conjugate contact with places (2, k) of the pinion; NaN where there is none."""
    lattice = np.stack(np.meshgrid(np.linspace(0, 1, 31), np.linspace(0, 1, 21), indexing="ij")).reshape(2, -1)
    there = Opposite.of(fields, lattice).fractions
    near = np.argmin(np.sum((there[:, :, None] - nodes[:, None, :]) ** 2, axis=0), axis=0)
    places = lattice[:, near]
    for _ in range(SEARCH_STEPS):
        opposite = Opposite.of(fields, places)
        places = _within_reach(places + solved(opposite.slopes, nodes - opposite.fractions))
    found = np.max(np.abs(nodes - Opposite.of(fields, places).fractions), axis=0) < FOUND
    return np.where(found, places, np.nan)


def places_below(fields: FlankFields, wanted: Array, places: Array, rotations: Array) -> Array:
    """Places (2, n) on the gear opposite pinion places (2, n) at pinion rotations (n), from places near them."""
    for _ in range(STEPS):
        opposite = Opposite.of(fields, places)
        gradient = np.stack([fields("roll_angle", places, d) for d in ((1, 0), (0, 1))])
        left = rotations - fields("roll_angle", places)
        passing = opposite.rate + opposite.acceleration * left
        slopes = opposite.slopes - passing[:, None] * gradient[None]
        places = _within_reach(places + solved(slopes, wanted - opposite.after(left)))
    return places


def _within_reach(places: Array) -> Array:
    return np.clip(places, -BEYOND, 1.0 + BEYOND)


def solved(matrix: Array, right: Array) -> Array:
    """Solutions (2, n) of systems (2, 2, n), zero where there is none."""
    columns = matrix[:, 0], matrix[:, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(determinant(*columns) != 0.0, cramers_rule(*columns, right), 0.0)
