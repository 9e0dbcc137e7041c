"""The native solver: a cascade of methods, the fast one first, each answer certified before it is believed.

1. Newton's method in the space of bending modes, if the compliance is diagonal plus low rank, from the warm start or
   from the Winkler estimate.
2. Primal-dual active set, from the same start. It comes first where the problem is small, unless the modes are
   compressed already and numba is installed.
3. Primal active set, which cannot cycle.
4. Interior point, with an exact polish on the active set it finds.

The cascade ends at the first answer whose certificate is at rounding level; otherwise the best one is judged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import InputError
from ..problem.scaling import ScaledProblem
from .interior_point import interior_point
from .modal_newton import compiled_kernel, modal_newton
from .polish import polish
from .primal_active_set import primal_active_set
from .primal_dual_active_set import primal_dual_active_set
from .scaled_answer import ScaledAnswer

#: Methods by name, in the order of the cascade.
METHODS = ("modal", "primal_dual_active_set", "primal_active_set", "interior_point")
#: Number of segments up to which the dense active set is faster than numpy's part of the modal method: compressing the
#: modes, and without numba the iteration.
DENSE_FIRST = 200


def answers(problem: ScaledProblem, active: NDArray[np.bool_], settings: dict[str, Any]) -> Iterator[ScaledAnswer]:
    """Yield answers of the methods in turn; the caller stops at the first it accepts.

    Parameters
    ----------
    problem : ScaledProblem
    active : (n) bool array
        Segments thought to touch.
    settings : dict
        ``method``: the name of a single method instead of the cascade.

    Raises
    ------
    InputError
        An unknown setting or method.
    """
    settings = dict(settings)
    method = settings.pop("method", "cascade")
    if settings:
        raise InputError(f"native has no setting {', '.join(sorted(settings))}: the only one is method")
    if method != "cascade" and method not in METHODS:
        raise InputError(f"native has no method {method!r}: choose from cascade, {', '.join(METHODS)}")
    return _answers(problem, active, _cascade(problem) if method == "cascade" else (method,))


def _cascade(problem: ScaledProblem) -> tuple[str, ...]:
    ready = problem.pair is not None and problem.pair.is_compressed and compiled_kernel() is not None
    if problem.separation.size > DENSE_FIRST or ready:
        return METHODS
    modal, dense, *others = METHODS
    return (dense, modal, *others)


def _answers(problem: ScaledProblem, active: NDArray[np.bool_], methods: tuple[str, ...]) -> Iterator[ScaledAnswer]:
    stages: dict[str, Callable[[], Iterator[ScaledAnswer | None]]] = {
        "modal": lambda: iter((modal_newton(problem, active),)),
        "primal_dual_active_set": lambda: iter((primal_dual_active_set(problem, active),)),
        "primal_active_set": lambda: iter((primal_active_set(problem, active) if problem.torque > 0.0 else None,)),
        "interior_point": lambda: _interior_point_answers(problem),
    }
    for method in methods:
        for answer in stages[method]():
            if answer is not None:
                yield answer


def _interior_point_answers(problem: ScaledProblem) -> Iterator[ScaledAnswer | None]:
    result = interior_point(problem)
    if result is None:
        return
    answer, gap = result
    exact = polish(problem, answer, gap)
    if exact is not None:
        yield replace(exact, iterations=answer.iterations + exact.iterations)
    yield answer
