"""An answer to a contact problem in the units of the problem, with its certificate."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...core.checks import array, frozen_arrays, shown
from ...core.errors import InputError
from .certificate import NO_CERTIFICATE, Certificate, resolved_rotation, violations
from .contact_problem import ContactProblem

Array = NDArray[np.float64]


@frozen_arrays
@dataclass(frozen=True, eq=False, slots=True)
class Answer:
    """Forces, rotation and gaps, right or wrong: the certificate tells.

    Attributes
    ----------
    force
        Normal forces F (n) [N].
    rotation
        Rotation theta [rad].
    gap
        Gaps Y = C F + S - r theta (n) [mm], of the data as they were given.
    elastic_rotation
        Rotation beyond first contact [rad].
    certificate
        Violations of the conditions of the contact problem, with the elastic rotation.
    problem
        The problem that the certificate is about; None where there is no answer.
    """

    force: Array
    rotation: float
    gap: Array
    elastic_rotation: float
    certificate: Certificate
    problem: ContactProblem | None = field(default=None, repr=False)


def no_answer(size: int, certificate: Certificate = NO_CERTIFICATE) -> Answer:
    """Return the answer of a solve without one: NaN for every segment."""
    return Answer(np.full(size, np.nan), math.nan, np.full(size, np.nan), math.nan, certificate)


def unscaled(problem: ContactProblem, force: Array, rotation: float) -> Answer:
    """Return the answer of scaled forces and a scaled rotation.

    Parameters
    ----------
    problem
        The contact problem.
    force
        Forces (n) in the scale of `problem.scaling`.
    rotation
        Beyond first contact, in that scale.
    """
    scaling = problem.scaling
    return with_certificate(problem, scaling.unscale_force(force), scaling.unscale_elastic_rotation(rotation))


def with_certificate(problem: ContactProblem, force: Array, elastic_rotation: float) -> Answer:
    """Return forces [N] and the rotation beyond first contact [rad] with the gaps they leave and the proof."""
    return _answer(problem, force, problem.whole_rotation(elastic_rotation), elastic_rotation)


def of_whole_rotation(problem: ContactProblem, force: Array, rotation: float) -> Answer:
    """Return forces [N] of any shape and a rotation from zero [rad] with the proof, if there is one; see `certify`."""
    force = np.asarray(force, dtype=np.float64)
    if force.shape != problem.separation.shape or not (math.isfinite(rotation) and np.isfinite(force).all()):
        return Answer(force, rotation, no_answer(problem.size).gap, math.nan, NO_CERTIFICATE)
    with np.errstate(over="ignore", invalid="ignore"):
        elastic_rotation = resolved_rotation(problem, force, rotation, problem.deflection(force))
    return _answer(problem, force, rotation, elastic_rotation)


def _answer(problem: ContactProblem, force: Array, rotation: float, elastic_rotation: float) -> Answer:
    with np.errstate(over="ignore", invalid="ignore"):
        # Not from `gap(force, rotation)`, whose difference of rotations would lose the digits of a light load.
        deflection = problem.deflection(force)
        gap = deflection + problem.separation_at_first_contact - elastic_rotation * problem.lever_arm
    certificate = NO_CERTIFICATE
    if math.isfinite(rotation):
        certificate = violations(problem, force, elastic_rotation, deflection, gap)
    return Answer(force, rotation, gap, elastic_rotation, certificate, problem)


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


def vector_of(value: object, name: str, size: int) -> Array:
    """Return an answer of a solver as an array of the given size; InputError where it is none."""
    found = array(name, value, anything=True)
    if found.shape != (size,):
        raise InputError(f"{name} = {shown(found)}: must have the shape ({size},)")
    return found
