"""Adapter of CVXPY (Diamond and Boyd 2016): the problem as one would write it on paper, an independent check."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..scaling import ScaledProblem
from .answer import ScaledAnswer
from .backend import NoAnswerError
from .settings import SOLVERS
from .status import Status

_SUSPICIONS = {
    "infeasible": Status.INFEASIBLE,
    "infeasible_inaccurate": Status.INFEASIBLE,
    "unbounded": Status.UNBOUNDED,
    "unbounded_inaccurate": Status.UNBOUNDED,
    "user_limit": Status.TIME_LIMIT,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem; the setting ``backend`` chooses what works behind CVXPY, by default Clarabel."""
    import cvxpy as untyped

    cvxpy: Any = untyped

    chosen = dict(settings)
    backend = str(chosen.pop("backend", "CLARABEL")).upper()
    if backend != "CLARABEL":  # the tolerances of the table are named as Clarabel wants them
        chosen = {name: value for name, value in chosen.items() if name not in SOLVERS["cvxpy"].settings}
    force = cvxpy.Variable(problem.separation.size, nonneg=True)
    balance = problem.lever_arm @ force == problem.torque
    energy = 0.5 * cvxpy.quad_form(force, cvxpy.psd_wrap(problem.compliance)) + problem.separation @ force
    programme = cvxpy.Problem(cvxpy.Minimize(energy), [balance])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        programme.solve(solver=backend, **chosen)
    suspicion = _SUSPICIONS.get(str(programme.status))
    if force.value is None or balance.dual_value is None:
        raise NoAnswerError(str(programme.status), suspicion or Status.SOLVER_FAILED)
    # The Lagrangian of CVXPY adds +dual (r'F - T): the rotation is its negative.
    iterations = programme.solver_stats.num_iters
    return ScaledAnswer(
        np.asarray(force.value, dtype=np.float64),
        -float(np.asarray(balance.dual_value)),
        -1 if iterations is None else int(iterations),
        str(programme.status),
        suspicion,
    )
