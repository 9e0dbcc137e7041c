"""Newton's method in the space of bending modes: the fast first stage of the native solver for C = diag(d) + U U^T.

With forces eliminated, the unknowns are the modal amplitudes c = U^T F, a dozen per tooth pair, and the rotation:

    g = U c + S - r theta,    F = max(0, -g) / d,
    minimise  phi(c, theta) = 1/2 c'c + 1/2 sum max(0, -g)^2 / d - T theta .

phi is convex, continuously differentiable and piecewise quadratic; its gradient vanishes where U^T F = c and r'F = T.
Newton's method on it is the primal-dual active set (a segment is active where g < 0), but with a function that must
fall: a full step that does not lower it gives way to the exact minimum along the step, where g is linear. The method
therefore ends, whatever the start. The Hessian is block-diagonal, I + U_A^T d_A^-1 U_A for each tooth pair, with theta
as a border: an iteration costs O(n m^2) for m modes a pair, and C is never formed.

Signs and complementarity of the forces are exact by construction; what is left is rounding in c and theta, of which
one step of refinement removes most. Digits are lost, and iterations gained, in the ratio of the bending to the local
compliance, so the method declines where that is extreme.

Where numba is installed, the same steps run as one compiled loop; the message of the answer says so.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..problem.scaling import ScaledPair, ScaledProblem
from .active_set_system import first_contact_index
from .modal_system import Array, ModalPoint, ModalSystem, has_modal_form, modal_system
from .scaled_answer import ScaledAnswer

#: Iterations before giving up; two to eight are usual.
MAX_ITERATIONS = 60
#: A gap or a fall of phi below this, relative to its largest term, is rounding.
ROUNDING = 1e-14


def modal_newton(
    problem: ScaledProblem, active: NDArray[np.bool_], *, max_iterations: int = MAX_ITERATIONS
) -> ScaledAnswer | None:
    """Solve the scaled problem from a starting set.

    Parameters
    ----------
    problem : ScaledProblem
    active : (n) bool array
        Segments thought to touch.
    max_iterations : int
        Linear systems solved before giving up.

    Returns
    -------
    ScaledAnswer or None
        None if the compliance has not the structure that this method lives on, or if it did not end.
    """
    if not has_modal_form(problem):
        return None
    kernel = compiled_kernel()
    if kernel is None:
        return _iterate(modal_system(problem), problem, active, max_iterations)
    pair = problem.given_compliance
    assert isinstance(pair, ScaledPair)
    basis = pair.modal_basis
    iterations, rotation, force = kernel(
        basis.index,
        basis.modes,
        pair.mode_unit,
        pair.diagonal,
        problem.lever_arm,
        problem.separation,
        problem.torque,
        np.array(active, dtype=np.bool_, order="C"),  # one kind of array, one compilation
        max_iterations,
        ROUNDING,
    )
    return ScaledAnswer(force, rotation, iterations, "modal, compiled") if iterations > 0 else None


@cache
def compiled_kernel() -> Callable[..., Any] | None:
    """Return the compiled loop, or None where numba is missing or does not work."""
    if importlib.util.find_spec("numba") is None:
        return None
    try:
        from .modal_kernel import newton
    except Exception:  # numba refuses some versions of numpy when it is imported, in more than one way
        return None
    return newton  # type: ignore[no-any-return, unused-ignore]


def _iterate(
    system: ModalSystem, problem: ScaledProblem, start: NDArray[np.bool_], max_iterations: int
) -> ScaledAnswer | None:
    active = system.to_blocks(start)
    point: ModalPoint | None = None
    for iteration in range(1, max_iterations + 1):
        if not system.lever_arm[active].any():
            active = active | (system.index == first_contact_index(problem))
        newton = system.newton_system(active)
        if newton is None:
            return None
        target = newton.solution()
        new_active = target.gap < 0.0
        changed = new_active != active
        level = ROUNDING * float(np.abs(target.gap[active]).max() + abs(target.rotation) * system.largest_arm)
        if not changed.any() or float(np.abs(target.gap[changed]).max()) <= level:
            refined = newton.refined(target)
            return ScaledAnswer(system.from_blocks(refined.force), refined.rotation, iteration, "modal")
        if point is not None and target.energy >= point.energy - ROUNDING * target.energy_scale:
            target = system.towards(point, target, exact_step(system, point, target))
            new_active = target.gap < 0.0
        point, active = target, new_active
    return None


def exact_step(system: ModalSystem, point: ModalPoint, target: ModalPoint) -> float:
    """Return the step length in [0, 1] from a point to another that minimises phi.

    The slope of phi along the step is piecewise linear and never falls; its kinks are where a segment opens or closes.
    """
    change = target.gap - point.gap
    turn = target.rotation - point.rotation
    amplitude = target.amplitudes - point.amplitudes
    closed = (point.gap < 0.0) | ((point.gap == 0.0) & (change < 0.0))
    level_of, growth_of = system.stiffness * point.gap * change, system.stiffness * change * change
    level = float(np.vdot(point.amplitudes, amplitude)) - system.torque * turn + float(level_of[closed].sum())
    growth = float(np.vdot(amplitude, amplitude)) + float(growth_of[closed].sum())
    kinked = np.where(closed, target.gap > 0.0, target.gap < 0.0)
    place = -point.gap[kinked] / change[kinked]
    order = np.argsort(place)
    sign = np.where(closed[kinked], -1.0, 1.0)[order]
    levels = level + np.concatenate([[0.0], np.cumsum(sign * level_of[kinked][order])])
    growths = growth + np.concatenate([[0.0], np.cumsum(sign * growth_of[kinked][order])])
    ends: Array = np.append(place[order], 1.0)
    rising = np.flatnonzero(levels + growths * ends >= 0.0)
    if not rising.size:
        return 1.0
    piece = int(rising[0])
    begin = 0.0 if piece == 0 else float(ends[piece - 1])
    if not growths[piece] > 0.0:
        return begin
    return float(np.clip(-levels[piece] / growths[piece], begin, ends[piece]))
