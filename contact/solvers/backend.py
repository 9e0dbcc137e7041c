"""What all backends behind qpsolvers share: the call, and reading off forces and rotation.

To add a backend: a row in the table of `settings`, and a module named after it with a function
``solve_scaled(problem, settings) -> ScaledAnswer``. The answer may be anything; it is certified by the caller.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..scaling import ScaledProblem
from .answer import ScaledAnswer
from .settings import SOLVERS
from .status import Status


class NoAnswerError(Exception):
    """A backend ended without numbers; carries what it said. Never leaves this folder."""

    def __init__(self, message: str, suspicion: Status | None = None) -> None:
        super().__init__(message)
        self.suspicion = suspicion


def run_qpsolvers(name: str, problem: ScaledProblem, settings: Mapping[str, Any]) -> Any:
    """Solve with the named backend and return the `qpsolvers.Solution`, found or not."""
    import qpsolvers

    with warnings.catch_warnings():
        # "Not found" comes as a warning too; here it becomes a status.
        warnings.simplefilter("ignore")
        return qpsolvers.solve_problem(
            problem.as_qp(sparse=SOLVERS[name].sparse), solver=name, verbose=False, **settings
        )


def read_answer(
    solution: Any, *, iterations: int = -1, message: str = "", suspicion: Status | None = None
) -> ScaledAnswer:
    """Take forces and rotation from a `qpsolvers.Solution`.

    qpsolvers writes P x + q + A'y + z_box = 0, so the rotation is -y. A rotation that is missing is recovered from
    the forces: on the loaded segments the gap is zero, hence theta T = F'CF + S'F.

    Raises
    ------
    NoAnswerError
        There are no numbers.
    """
    if not message:
        message = "found" if solution.found else "not found"
    if not solution.found and suspicion is None:
        suspicion = Status.SOLVER_FAILED
    if solution.x is None or not np.isfinite(solution.x).all():
        raise NoAnswerError(message, suspicion)
    force = np.asarray(solution.x, dtype=np.float64)
    rotation = math.nan if solution.y is None or len(solution.y) == 0 else -float(solution.y[0])
    if not math.isfinite(rotation):
        problem = solution.problem
        torque = float(problem.b[0])
        if not torque > 0.0:
            raise NoAnswerError(message, suspicion)
        rotation = float(force @ (problem.P @ force) + problem.q @ force) / torque
    return ScaledAnswer(force, rotation, iterations, message, None if solution.found else suspicion)
