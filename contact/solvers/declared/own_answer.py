"""Reading of what a function of one's own returned; whatever is no answer becomes a status with a reason."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.checks import shown
from ...problem.forms.complementarity_form import forces_and_rotation
from ...problem.scaled_problem import ScaledProblem
from ..backend import NoAnswerError, read_answer
from ..scaled_answer import ScaledAnswer
from ..solution import SOLVED, CallTimes, Status

Array = NDArray[np.float64]


def own_answer(returned: Any, problem: ScaledProblem, form: str, posed: Any) -> ScaledAnswer:
    """Return the answer that a function of one's own gave.

    Parameters
    ----------
    returned
        A `qpsolvers.Solution`, a `ScaledAnswer`, the pair of unknowns and rotation, or the unknowns alone.
    problem
        The scaled problem.
    form
        In which the function got it.
    posed
        What it got.

    Raises
    ------
    NoAnswerError
        There are no finite numbers of the right shape.
    """
    if isinstance(returned, ScaledAnswer):
        size = problem.separation.size
        force = _numbers(returned.force, "forces", (size,))
        turned = _rotation(returned.rotation, problem, force)
        gap = None if returned.gap is None else _numbers(returned.gap, "gaps", (size,))
        status: Any = returned.suspicion
        times: Any = returned.times
        if not isinstance(status, Status | None) or not isinstance(times, CallTimes | None):
            raise _refused("it returned a ScaledAnswer whose suspicion is no Status, or whose times are no CallTimes")
        return ScaledAnswer(force, turned, int(returned.iterations), str(returned.message), status, gap, times)
    if all(hasattr(returned, name) for name in ("x", "y", "z_box", "found")):
        return _of_solution(returned, problem, posed)
    if returned is None:
        raise NoAnswerError("it returned no answer", Status.SOLVER_FAILED)
    rotation = None
    if isinstance(returned, tuple):
        if len(returned) != 2:
            raise _refused(f"it returned {len(returned)} values: must be the unknowns, or these and the rotation")
        returned, rotation = returned
    if form == "lcp":
        if rotation is not None:
            raise _refused("it returned two values: must be z alone for the form lcp, which has the rotation in it")
        z = _unknowns(returned, problem, form, posed)
        return ScaledAnswer(*forces_and_rotation(problem, posed.eliminated, z), -1)
    unknowns = _unknowns(returned, problem, form, posed)
    force = unknowns[: problem.separation.size].copy()
    return ScaledAnswer(force, _rotation(rotation, problem, force), -1)


def _unknowns(returned: Any, problem: ScaledProblem, form: str, posed: Any) -> Array:
    size = problem.separation.size
    sizes = {(size,), (posed.q.size,)} if form == "lifted" else {(size,)}
    return _numbers(returned, "unknowns", *sizes)


def _of_solution(returned: Any, problem: ScaledProblem, posed: Any) -> ScaledAnswer:
    """The answer in a `qpsolvers.Solution`."""
    if returned.x is None:
        raise NoAnswerError("it found no answer", Status.SOLVER_FAILED)
    unknowns = _numbers(returned.x, "unknowns", (posed.q.size,))
    iterations = getattr(returned, "extras", {}).get("iter", -1)
    multiplier = None if returned.y is None or np.size(returned.y) == 0 else np.asarray(returned.y).ravel()[0]
    if multiplier is not None and math.isfinite(multiplier):
        return read_answer(returned, iterations=int(iterations))
    force = unknowns[: problem.separation.size].copy()
    claim = None if returned.found else Status.SOLVER_FAILED
    words = "found" if returned.found else "not found"
    return ScaledAnswer(force, _rotation(None, problem, force), int(iterations), words, claim)


def _rotation(given: Any, problem: ScaledProblem, force: Array) -> float:
    """The rotation, or where none was given that at which the torque does the work of the forces."""
    if given is None:
        if not problem.torque > 0.0:
            raise _refused("it returned no rotation, which does not follow from the forces without a torque")
        return float(force @ problem.deflection(force) + problem.separation @ force) / problem.torque
    if np.size(given) != 1 or np.asarray(given).dtype.kind not in "fiu":
        raise _refused(f"it returned the rotation {shown(given)}: must be a number")
    rotation = float(np.asarray(given).ravel()[0])
    if not math.isfinite(rotation):
        raise _refused(f"it returned the rotation {shown(rotation)}: must be finite")
    return rotation


def _numbers(returned: Any, what: str, *shapes: tuple[int, ...]) -> Array:
    """Finite numbers of one of some shapes; a column is a vector, too."""
    try:
        found = np.asarray(returned)
    except (TypeError, ValueError) as error:
        raise _refused(f"it returned {what} of the type {type(returned).__name__}: must be an array") from error
    if found.dtype.kind not in "fiu" or np.ma.is_masked(returned):
        raise _refused(f"it returned {what} of the type {type(returned).__name__}, {found.dtype.name}: must be floats")
    if found.ndim == 2 and 1 in found.shape:
        found = found.ravel()
    if found.shape not in shapes:
        wanted = " or ".join(map(str, sorted(shapes)))
        raise _refused(f"it returned {what} of the shape {found.shape}: must have {wanted}")
    numbers = found.astype(np.float64)
    wrong = np.count_nonzero(~np.isfinite(numbers))
    if wrong:
        raise _refused(f"{wrong} of {numbers.size} {what} are not finite")
    return numbers


def _refused(message: str) -> NoAnswerError:
    """The function said that it had solved the problem, and what it returned is no answer."""
    return NoAnswerError(message, Status.SOLVER_FAILED, claim=SOLVED)
