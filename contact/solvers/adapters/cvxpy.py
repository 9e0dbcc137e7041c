"""Adapter of CVXPY (Diamond and Boyd 2016): the problem as one would write it on paper, an independent check.

Most of the time of a call goes into translating what is written into what a solver takes. Where that pays, it is
written with every number a parameter, translated once and used again for other numbers: see `cvxpy_programme`.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...problem.scaled_problem import ScaledProblem
from ..backend import NoAnswerError
from ..scaled_answer import ScaledAnswer
from ..solution import Status
from ..solver_table import SOLVERS
from .cvxpy_programme import Root, compliance_root, parametrised

#: Largest number of segments for which the parametrised form of a dense problem is faster: it cannot have the
#: compliance as it is, but only its root, with which the solver has twice the unknowns.
LARGEST_DENSE = 90

_SUSPICIONS = {
    "infeasible": Status.INFEASIBLE,
    "infeasible_inaccurate": Status.INFEASIBLE,
    "unbounded": Status.UNBOUNDED,
    "unbounded_inaccurate": Status.UNBOUNDED,
    "user_limit": Status.TIME_LIMIT,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem.

    Settings besides those of the solver behind CVXPY: ``backend``, its name, by default Clarabel; ``parametrised``,
    whether to use a programme that is kept for more than one problem, by default where that is faster.
    """
    chosen = dict(settings)
    lifted = chosen.pop("form", "dense") == "lifted"
    backend = str(chosen.pop("backend", "CLARABEL")).upper()
    reuse = bool(chosen.pop("parametrised", lifted or problem.separation.size <= LARGEST_DENSE))
    if backend != "CLARABEL":  # the tolerances of the table are named as Clarabel wants them
        chosen = {name: value for name, value in chosen.items() if name not in SOLVERS["cvxpy"].settings}
    root = compliance_root(problem, lifted=lifted) if lifted or reuse else None
    if root is None or not reuse:
        return _solve(_written_out(problem, root), backend, chosen)
    with parametrised(root, backend) as programme:
        programme.set_values(problem, root)
        return _solve(programme.programme, backend, chosen)


def _written_out(problem: ScaledProblem, root: Root | None) -> Any:
    """Return the problem with its numbers, with the compliance as it is or by its root."""
    import cvxpy as untyped

    cvxpy: Any = untyped
    force = cvxpy.Variable(problem.separation.size)
    if root is None:
        quadratic = cvxpy.quad_form(force, cvxpy.psd_wrap(problem.compliance))
    else:
        quadratic = cvxpy.sum_squares(root.matrix.T @ force)
    energy = 0.5 * quadratic + problem.separation @ force
    return cvxpy.Problem(cvxpy.Minimize(energy), [problem.lever_arm @ force == problem.torque, force >= 0.0])


def _solve(programme: Any, backend: str, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve a programme whose constraints are the balance and the bounds, in that order."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # No warm start: the same problem has the same answer independent of earlier solves.
        programme.solve(solver=backend, warm_start=False, **settings)
    status = str(programme.status)
    suspicion = _SUSPICIONS.get(status)
    count = programme.solver_stats.num_iters
    if suspicion is Status.TIME_LIMIT and count is not None and count >= settings.get("max_iter", math.inf):
        suspicion = Status.NOT_CONVERGED
    (force,), (balance, bounds) = programme.variables(), programme.constraints
    if force.value is None or balance.dual_value is None:
        raise NoAnswerError(status, suspicion or Status.SOLVER_FAILED)
    # The Lagrangian of CVXPY adds +dual (r'F - T): the rotation is its negative.
    return ScaledAnswer(
        np.asarray(force.value, dtype=np.float64),
        -float(np.asarray(balance.dual_value)),
        -1 if count is None else int(count),
        status,
        suspicion,
        None if bounds.dual_value is None else np.asarray(bounds.dual_value, dtype=np.float64),
    )
