"""Points of the pinion opposite points of the gear, in conjugate contact and some rotation from it.

Opposite a point of the gear that is in conjugate contact at the pinion rotation Q stands, at the rotation q, the pinion
point p + p' (q - Q) + p'' (q - Q)^2 / 2, with the derivatives that ``rolling.drift`` finds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...geometry.newton import cramers_rule, determinant
from .flank_splines import VALUE_AND_SLOPES, FlankSplines

Array = NDArray[Any]

EXTRAPOLATION_LIMIT = 0.05  # fraction of the flank by which a search may leave it
CORRECTION_ITERATIONS = 3  # of Newton's method from an estimate of second order
SEARCH_ITERATIONS, SEARCH_TOLERANCE = 12, 1e-13  # [fraction of the flank]; seven are usual
POSITION_TOLERANCE = 1e-6  # fraction of the flank
PINION_FRACTIONS = ("pinion_lengthwise", "pinion_profile")
#: Of the geometry's ``ease_off``, beside what ``contact_splines`` takes: how the pinion passes a point of the gear.
PASSING_FIELDS = tuple(f"{name}_{order}" for order in ("rate", "acceleration") for name in PINION_FRACTIONS)


@frozen_arrays
@dataclass(frozen=True)
class OppositePoints:
    """Fractions on the pinion flank opposite points (n) of the gear.

    Parameters
    ----------
    fractions
        In conjugate contact (2, n).
    slopes
        Their derivatives by the fractions of the point (2, 2, n).
    rate, acceleration
        Their derivatives by the pinion rotation (2, n) [1/rad, 1/rad^2].
    """

    fractions: Array
    slopes: Array
    rate: Array
    acceleration: Array

    @classmethod
    def of(cls, splines: FlankSplines, points: Array) -> OppositePoints:
        """Opposite points (2, n)."""
        passing = np.stack(list(splines.evaluate(list(PASSING_FIELDS), points).values()))
        return cls(*_in_conjugate_contact(splines, points), passing[:2], passing[2:])

    def after(self, left: Array) -> Array:
        """Fractions (2, ..., n) when the pinion is ``left`` (..., n) [rad] beyond conjugate contact."""
        first, rate, second = (
            np.reshape(v, (2, *[1] * (left.ndim - 1), -1)) for v in (self.fractions, self.rate, self.acceleration)
        )
        return np.asarray(first + rate * left + 0.5 * second * left**2)


def _in_conjugate_contact(splines: FlankSplines, points: Array) -> tuple[Array, Array]:
    """Fractions (2, n) of the pinion in conjugate contact with points (2, n) of the gear, their slopes (2, 2, n)."""
    found = splines.derivatives(PINION_FRACTIONS, points, VALUE_AND_SLOPES)
    fractions, *by_fraction = (np.stack(list(each.values())) for each in found)
    return fractions, np.stack(by_fraction, axis=1)


def conjugate_points(splines: FlankSplines, nodes: Array, near: Array | None = None) -> Array:
    """Points (2, k) on the gear in conjugate contact with points (2, k) of the pinion; NaN where there is none.

    They are searched from points ``near`` (2, k) if given, where these are not NaN.
    """
    points = _searched(splines, nodes, _nearest_of_lattice(splines, nodes) if near is None else near)
    there = np.stack(list(splines.evaluate(list(PINION_FRACTIONS), points).values()))
    found = np.max(np.abs(nodes - there), axis=0) < POSITION_TOLERANCE
    return np.where(found, points, np.nan)


def pinion_points(splines: FlankSplines, points: Array, rotations: Array) -> Array:
    """Where on the gear the pinion points opposite points (2, ...) at pinion rotations (...) are in conjugate contact.

    At a rotation other than that of its conjugate contact a point of the gear faces another point of the pinion than
    in it. What is known of the pinion on the gear flank is to be read where this function says.
    """
    flat = np.reshape(points, (2, -1))
    left = np.reshape(np.broadcast_to(rotations, np.shape(points)[1:]), -1) - splines("roll_angle", flat)
    opposite = OppositePoints.of(splines, flat).after(left)
    return _searched(splines, opposite, flat).reshape(np.shape(points))


def _searched(splines: FlankSplines, nodes: Array, points: Array) -> Array:
    """Points (2, k) on the gear or near it in conjugate contact with pinion points (2, k), from others near them."""
    for _ in range(SEARCH_ITERATIONS):
        before, (fractions, slopes) = points, _in_conjugate_contact(splines, points)
        points = _near_flank(points + solved(slopes, nodes - fractions))
        if not np.any(np.abs(points - before) > SEARCH_TOLERANCE):
            break
    return points


def _nearest_of_lattice(splines: FlankSplines, nodes: Array) -> Array:
    """Points (2, k) of a lattice on the gear opposite which pinion points come nearest to given ones (2, k)."""
    lattice = np.stack(np.meshgrid(np.linspace(0, 1, 31), np.linspace(0, 1, 21), indexing="ij")).reshape(2, -1)
    there = splines.evaluate(list(PINION_FRACTIONS), lattice).values()
    away = [np.subtract.outer(side, node) ** 2 for side, node in zip(there, nodes, strict=True)]
    return np.asarray(lattice[:, np.argmin(away[0] + away[1], axis=0)])


def points_below(splines: FlankSplines, wanted: Array, points: Array, rotations: Array) -> Array:
    """Points (2, n) on the gear opposite pinion points (2, n) at pinion rotations (n), from points near them."""
    for _ in range(CORRECTION_ITERATIONS):
        opposite = OppositePoints.of(splines, points)
        roll = splines.derivatives(["roll_angle"], points, VALUE_AND_SLOPES)
        roll_angle, *by_fraction = (each["roll_angle"] for each in roll)
        gradient, left = np.stack(by_fraction), rotations - roll_angle
        passing = opposite.rate + opposite.acceleration * left
        slopes = opposite.slopes - passing[:, None] * gradient[None]
        points = _near_flank(points + solved(slopes, wanted - opposite.after(left)))
    return points


def _near_flank(points: Array) -> Array:
    return np.clip(points, -EXTRAPOLATION_LIMIT, 1.0 + EXTRAPOLATION_LIMIT)


def solved(matrix: Array, right: Array) -> Array:
    """Solutions (2, n) of systems (2, 2, n), zero where there is none."""
    columns = matrix[:, 0], matrix[:, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(determinant(*columns) != 0.0, cramers_rule(*columns, right), 0.0)
