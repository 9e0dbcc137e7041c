"""Solvers that misbehave, each in its own way: what a comparison has to survive."""

from __future__ import annotations

import ctypes
import os
import sys
import time
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

import numpy as np

from easeoff.contact import Status
from easeoff.contact.problem.scaled_problem import ScaledProblem
from easeoff.contact.solvers.primal_dual_active_set import primal_dual_active_set
from easeoff.contact.solvers.solution import ScaledAnswer


def declared(solver: Callable[[ScaledProblem, Mapping[str, Any]], Any]) -> Callable[..., Any]:
    """Let a solver be called as an adapter, (problem, settings), or as a user's function, (programme, **settings)."""

    def called(problem: Any, settings: Mapping[str, Any] | None = None, **keywords: Any) -> Any:
        if not isinstance(problem, ScaledProblem):
            problem = ScaledProblem(problem.P, problem.q, problem.A[0], float(problem.b[0]))
        return solver(problem, keywords if settings is None else settings)

    called.__name__ = solver.__name__
    return called


@declared
def leave(problem: ScaledProblem, settings: Mapping[str, Any]) -> NoReturn:
    """End the process without a word."""
    os._exit(3)


@declared
def fault(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Touch memory that is not ours."""
    ctypes.string_at(0)
    raise AssertionError


@declared
def hang(problem: ScaledProblem, settings: Mapping[str, Any]) -> NoReturn:
    """Take for ever, whatever the time limit says."""
    time.sleep(3600.0)
    raise AssertionError(settings)


@declared
def fail(problem: ScaledProblem, settings: Mapping[str, Any]) -> NoReturn:
    """Raise."""
    raise RuntimeError("no\x1b[2J luck | today")


@declared
def lie(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Give equal forces that balance the torque, and say that this is the solution."""
    force = np.full(problem.separation.size, problem.torque / problem.lever_arm.sum())
    return ScaledAnswer(force, 1.0, 7, "solved")


@declared
def zero(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Do nothing, and say that this is the solution."""
    return ScaledAnswer(np.zeros(problem.separation.size), 0.0, 1, "solved")


@declared
def start(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Give the start back, at the rotation that its forces ask for."""
    force = np.array(settings.get("initvals", np.zeros(problem.separation.size)))
    work = force @ (problem.compliance @ force) + force @ problem.separation
    return ScaledAnswer(force, float(work / problem.torque) if problem.torque else 0.0, 1, "solved")


_kept: dict[int, ScaledAnswer] = {}


@declared
def stale(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Give the right answer to the call before with as many segments, and keep that to this one."""
    size = problem.separation.size
    right = primal_dual_active_set(problem, np.ones(size, dtype=bool))
    answer = _kept.get(size) or lie(problem, settings)
    if right is not None:
        _kept[size] = right
    return answer


@declared
def deny(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Print a lot, give the right answer, and say that there is none."""
    print("noise " * 1000)  # noqa: T201
    print("noise", file=sys.stderr)  # noqa: T201
    right = primal_dual_active_set(problem, np.ones(problem.separation.size, dtype=bool))
    assert right is not None
    return ScaledAnswer(right.force, right.rotation, 2, "no solution", Status.INFEASIBLE)


@declared
def nonsense(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Give an answer of the wrong length."""
    return ScaledAnswer(np.ones(1), 1.0, 1, "solved")
