"""Residual of an answer on the problem as its solver got it: what solvers compare with their own tolerance.

The certificate judges the answer, this the solver. They differ: complementarity in the certificate is the largest of
the smaller one of force and gap, and of n products F_i Y_i the sum is the duality gap, so that a gap of 1e-6 leaves
complementarity of up to 1e-3.
"""

from __future__ import annotations

import math

import numpy as np

from ....contact.problem.answer import Answer
from ....contact.problem.contact_problem import ContactProblem


def posed_residual(problem: ContactProblem, answer: Answer, *, raw: bool = False) -> float:
    """Largest of primal residual, dual residual and duality gap, each over one plus the size of its terms.

    One plus the size: a solver may hold its tolerance as an absolute or as a relative one.

    Parameters
    ----------
    problem
        As it was given.
    answer
        Of the solver, as it left it.
    raw
        Whether the solver got the problem in mm and N, not scaled.

    Returns
    -------
    float
        NaN where there is no answer.

    Examples
    --------
    >>> from easeoff.contact import ContactProblem, solve
    >>> problem = ContactProblem(np.zeros(2), np.full(2, 50.0), 2.0e5, np.diag([2e-6, 2e-6]))
    >>> answer = solve(problem).answer
    >>> posed_residual(problem, answer) < 1e-15
    True
    """
    force, rotation = np.asarray(answer.force, dtype=np.float64), answer.elastic_rotation
    if force.shape != problem.separation.shape or not (math.isfinite(rotation) and np.isfinite(force).all()):
        return math.nan
    with np.errstate(over="ignore", invalid="ignore"):
        if raw:
            rotation, separation = answer.rotation, problem.separation
            deflection, arm, torque = problem.deflection(force), problem.lever_arm, problem.torque
        else:
            scaled, scaling = problem.scaled(), problem.scaling
            force, rotation = force / scaling.force, rotation / scaling.rotation
            separation, arm, torque = scaled.separation, scaled.lever_arm, scaled.torque
            deflection = scaled.deflection(force)
        closing = rotation * arm
        gap = deflection + separation - closing  # the multiplier of F >= 0 where it is not negative
        largest = max(float(np.abs(term).max()) for term in (deflection, separation, closing))
        work, preload = float(force @ deflection), float(force @ separation)
        primal = max(
            abs(float(arm @ force) - torque) / (1.0 + abs(torque)),
            -float(force.min()) / (1.0 + float(np.abs(force).max())),
        )
        dual = -float(gap.min()) / (1.0 + largest)
        surplus = abs(work + preload - rotation * torque) / (1.0 + max(abs(work), abs(preload), abs(rotation * torque)))
    worst = max(primal, dual, surplus)
    return worst if math.isfinite(worst) else math.nan
