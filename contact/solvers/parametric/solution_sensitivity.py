"""Sensitivity of a certified solution: which segments are loaded, which are weak, and the compliance it has there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....core.errors import InputError
from ...problem.certificate import certify
from ...problem.compliance_matrix import ComplianceMatrix
from ...problem.contact_problem import ContactProblem
from ..solution import ContactSolution
from .sensitivity import Sensitivity
from .weak_segments import dependent_segments, loaded_and_weak

Array = NDArray[np.float64]

#: A force and a gap that are both below this part of their scales count as none.
DEGENERACY_TOLERANCE = 1e-10
#: Deflection, relative to what the most compliant segment has under the largest force, that is taken for rounding.
RIGID_FRACTION = 1e-12


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
    _require_solution(problem, solution)
    deflection = problem.deflection(solution.force)
    return sensitivity_of(problem, solution, problem.compliance_matrix, deflection, tolerance)


def sensitivity_of(
    problem: ContactProblem,
    solution: ContactSolution,
    tangent: ComplianceMatrix,
    deflection: Array,
    tolerance: float = DEGENERACY_TOLERANCE,
) -> Sensitivity:
    """Return the derivatives where the compliance depends on the load.

    Parameters
    ----------
    problem, solution, tolerance
        As of `sensitivity`.
    tangent
        Derivative of the deflections by the forces [mm/N].
    deflection
        Deflections under the forces of the solution (n) [mm].
    """
    force, gap = solution.force, solution.gap
    scale = abs(solution.elastic_rotation) * float(np.abs(problem.lever_arm[solution.active]).max(initial=0.0))
    yielding = float(force.max()) * float(tangent.diagonal.max())
    if scale <= RIGID_FRACTION * yielding:  # what touches is rigid
        scale = yielding or float(np.abs(problem.separation_at_first_contact).max()) or 1.0
    loaded, weak = loaded_and_weak(force, gap, float(force.max()), scale, tolerance)
    dependent = dependent_segments(tangent, problem.lever_arm, loaded, weak)
    loaded, weak = loaded | dependent, weak & ~dependent
    return Sensitivity(problem, force, gap, solution.rotation, loaded, weak, tangent, deflection)


def _require_solution(problem: ContactProblem, solution: ContactSolution) -> None:
    if not solution.certified:
        raise InputError(f"solution = {solution.status.name.lower()}: must be certified to have derivatives")
    certificate = certify(problem, solution.force, solution.rotation, solution.elastic_rotation)
    if not certificate.passes(solution.tolerance):
        raise InputError("solution: must be that of this problem; its forces and rotation do not solve it")
