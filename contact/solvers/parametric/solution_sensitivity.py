"""Sensitivity of a certified solution of any solver."""

from __future__ import annotations

from ....core.checks import instance
from ....core.errors import InputError
from ...problem.certificate import certify
from ...problem.contact_problem import ContactProblem
from ..solution import ContactSolution
from .sensitivity import DEGENERACY_TOLERANCE, Sensitivity, answer_sensitivity


def sensitivity(
    problem: ContactProblem, solution: ContactSolution, *, tolerance: float = DEGENERACY_TOLERANCE
) -> Sensitivity:
    """Return the derivatives of a certified solution by the data of its contact problem.

    Parameters
    ----------
    problem
        The contact problem.
    solution
        Its certified solution, of any solver.
    tolerance
        A force and a gap that are both below this part of the largest force and of the closed way count as none: the
        segment then touches without a force, and derivatives are one-sided.

    Raises
    ------
    InputError
        The solution is not certified, or is that of another problem.

    Examples
    --------
    Forces in proportion: torque and separations twice as large make all forces twice as large.

    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, solve
    >>> problem = ContactProblem([0.0, 1e-3, 2e-3], [40.0, 41.0, 42.0], 4e5, np.diag([1e-6, 2e-6, 2e-6]) + 1e-7)
    >>> solution = solve(problem)
    >>> slope = sensitivity(problem, solution)
    >>> change = slope.forward(torque=problem.torque, separation=problem.separation)
    >>> np.allclose(change.force, solution.force), bool(np.isclose(change.rotation, solution.rotation))
    (True, True)

    All data that the force of the first segment depends on, by one more linear system:

    >>> gradient = slope.adjoint(force=[1.0, 0.0, 0.0])
    >>> bool(np.isclose(gradient.torque, slope.forward(torque=1.0).force[0])), gradient.compliance.shape
    (True, (3, 3))
    """
    instance("problem", problem, ContactProblem)
    instance("solution", solution, ContactSolution)
    if not solution.certified:
        raise InputError(f"solution = {solution.status.name.lower()}: must be certified to have derivatives")
    certificate = certify(problem, solution.force, solution.rotation, solution.elastic_rotation)
    if not certificate.passes(solution.tolerance):
        raise InputError("solution: must be that of this problem; its forces and rotation do not solve it")
    return answer_sensitivity(problem, solution.answer, tolerance)
