"""The verdict on an answer: certified on the problem as the user gave it, or refused."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..certificate import certify
from ..problem import ContactProblem
from .status import ContactSolution, Status, no_solution


def judge(
    problem: ContactProblem,
    solver: str,
    force: NDArray[np.float64],
    elastic_rotation: float,
    *,
    tolerance: float,
    iterations: int = -1,
    polished: bool = False,
    message: str = "",
    suspicion: Status | None = None,
) -> ContactSolution:
    """Certify an answer and return the solution, or the record of a refusal.

    Parameters
    ----------
    problem : ContactProblem
        In its original units.
    solver : str
    force : (n) array
        [N].
    elastic_rotation : float
        Rotation beyond first contact [rad].
    tolerance : float
        What the certificate must reach.
    iterations, polished, message
        Passed on to the solution.
    suspicion : Status, optional
        The status of a refused answer; `Status.NOT_CERTIFIED` by default.
    """
    rotation = problem.first_contact_rotation + elastic_rotation
    certificate = certify(problem, force, rotation, elastic_rotation)
    if not certificate.passes(tolerance):
        return no_solution(
            problem.size,
            Status.NOT_CERTIFIED if suspicion is None else suspicion,
            solver,
            message=message,
            iterations=iterations,
            certificate=certificate,
            tolerance=tolerance,
        )
    gap = problem.deflection(force)
    gap += problem.separation_at_first_contact
    gap -= elastic_rotation * problem.lever_arm
    return ContactSolution(
        force=force,
        rotation=rotation,
        gap=gap,
        status=Status.CERTIFIED,
        solver=solver,
        iterations=iterations,
        certificate=certificate,
        elastic_rotation=elastic_rotation,
        polished=polished,
        tolerance=tolerance,
        message=message,
    )
