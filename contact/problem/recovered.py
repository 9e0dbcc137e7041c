"""From the numbers of a form of the contact problem back to forces, rotation and gaps, with proof."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...core.errors import InputError
from .certificate import NO_CERTIFICATE, Certificate, violations
from .contact_problem import ContactProblem


@dataclass(frozen=True, eq=False, slots=True)
class RecoveredAnswer:
    """An answer in the units of the problem.

    Attributes
    ----------
    force : (n) array
        Normal forces F [N].
    rotation : float
        Rotation theta [rad].
    gap : (n) array
        Gaps Y = C F + S - r theta [mm], of the data as they were given.
    elastic_rotation : float
        Rotation beyond first contact [rad].
    certificate : Certificate
        How well all this solves the contact problem.
    """

    force: NDArray[np.float64]
    rotation: float
    gap: NDArray[np.float64]
    elastic_rotation: float
    certificate: Certificate


def recovered(problem: ContactProblem, force: NDArray[np.float64], rotation: float) -> RecoveredAnswer:
    """Return the answer that scaled forces and a scaled rotation stand for.

    Parameters
    ----------
    problem : ContactProblem
    force : (n) array
        In the scale of `problem.scaling`.
    rotation : float
        Beyond first contact, in that scale.
    """
    scaling = problem.scaling
    return with_certificate(problem, scaling.unscale_force(force), scaling.unscale_elastic_rotation(rotation))


def with_certificate(problem: ContactProblem, force: NDArray[np.float64], elastic_rotation: float) -> RecoveredAnswer:
    """Return forces [N] and the rotation beyond first contact [rad] with the gaps they leave and the proof."""
    rotation = problem.first_contact_rotation + elastic_rotation
    with np.errstate(over="ignore", invalid="ignore"):
        # Not from `gap(force, rotation)`, whose difference of rotations would lose the digits of a light load.
        deflection = problem.deflection(force)
        gap = deflection + problem.separation_at_first_contact - elastic_rotation * problem.lever_arm
    certificate = NO_CERTIFICATE
    if math.isfinite(rotation):
        certificate = violations(problem, force, elastic_rotation, deflection, gap, math.ulp(elastic_rotation))
    return RecoveredAnswer(force, rotation, gap, elastic_rotation, certificate)


def require_convex(problem: ContactProblem) -> None:
    """Refuse a compliance with a negative eigenvalue.

    Raises
    ------
    InputError
        The compliance is not positive semidefinite.
    """
    if not problem.is_positive_semidefinite:
        raise InputError(
            "the compliance has a negative eigenvalue: its contact problem is no minimum and has no other form"
        )


def vector_of(value: object, name: str, size: int) -> NDArray[np.float64]:
    """Return an answer of a solver as an array of the given size; InputError where it is none."""
    array = np.asarray(value, dtype=np.float64)
    if array.shape != (size,):
        raise InputError(f"{name} has the shape {array.shape}, expected ({size},)")
    return array
