"""Which solvers a test tries, on what form of a problem, what they must reach, and what they say unjudged."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from easeoff.contact import SOLVERS, ContactProblem, available_solvers, solve
from easeoff.contact.solvers.backend_solution import adapter_of
from easeoff.contact.solvers.solution import ScaledAnswer

Array = NDArray[np.float64]

BACKENDS = [name for name in SOLVERS if name != "native"]
LIFTING = [name for name in BACKENDS if SOLVERS[name].lifted_from is not None]

#: Agreement with the native solver, unpolished: of the rotation from the multiplier of the balance, relative, and of
#: the gaps from the multipliers of the bounds, over the greatest deflection. It holds for all classes of problems and
#: the problem library; the worst are segments at the brink of contact, rigid ones, and hardly any local compliance.
AGREEMENT = {
    "clarabel": (1e-6, 1e-4),
    "osqp": (1e-5, 1e-8),
    "daqp": (1e-6, 1e-8),
    "piqp": (1e-6, 1e-4),
    "proxqp": (1e-8, 1e-5),
    "highs": (1e-12, 1e-11),
    "scs": (1e-7, 1e-6),
    "sip": (1e-7, 1e-4),
    "pyqpmad": (1e-5, 1e-4),
    "qpalm": (1e-7, 1e-6),
    "quadprog": (1e-5, 1e-4),
    "cvxopt": (1e-6, 1e-4),
    "ecos": (1e-4, 1e-3),
    "cvxpy": (1e-6, 1e-4),
    "lemke": (1e-12, 1e-11),
}
POLISHED_AGREEMENT = 1e-13

#: Classes whose compliance may be singular to rounding, on which a method that begins with a Cholesky factor may fail.
NEARLY_SINGULAR = {"weak_local", "nearly_singular", "spread_local", "random_dense"}
CHOLESKY = {"pyqpmad", "quadprog"}


def installed(name: str) -> str:
    """Return the name of a solver; the test is skipped where it is not installed."""
    if name not in available_solvers():
        pytest.skip(f"{name} is not installed")
    return name


def dense(problem: ContactProblem) -> ContactProblem:
    """The same problem with its matrix, whatever it was made of."""
    return ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.dense_compliance)


def answer_of(name: str, problem: ContactProblem, **settings: Any) -> ScaledAnswer:
    """What the backend answers to the scaled problem, before anybody judges it."""
    scaled = problem.scaled()
    return adapter_of(name)(scaled, {**SOLVERS[name].settings, **settings})


def rotation_and_gap(problem: ContactProblem) -> tuple[float, Array, float]:
    """Rotation and gaps of the native solver in scaled numbers, and the greatest deflection."""
    reference, scaled = solve(problem), problem.scaled()
    rotation = reference.elastic_rotation / problem.scaling.rotation
    deflection = scaled.compliance @ (reference.force / problem.scaling.force)
    return rotation, deflection + scaled.separation - rotation * scaled.lever_arm, float(np.abs(deflection).max())
