"""Following the solution of a contact problem over the torque, from one change of the touching set to the next.

While the set is the same, forces, rotation and gaps are affine in the torque. A piece ends where a force or a gap
vanishes. One segment then leaves or enters; where several are at zero together, the small complementarity problem
of `weak_segments` decides. Where rounding leaves that in doubt, a certified solution just beyond shows the set; it is
taken only if the piece that belongs to it reaches back to the event.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from ...problem.certificate import EXACT_TOLERANCE, Answer, with_certificate
from ...problem.contact_problem import ContactProblem
from ..registry import solve
from ..touching_system import TouchingSystem
from .touching_form import touching_system
from .weak_segments import loaded_and_weak, system_in_direction

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: Forces and gaps that vanish within this part of their scales at an event vanish together.
TIE_TOLERANCE = 1e-13
#: A rate below this, relative to the largest of its kind, is rounding.
SMALLEST_RATE = 1e-12
#: Force and gap that a piece may have on the wrong side at its beginning, relative to their scales.
WRONG_SIGN_TOLERANCE = 1e-9
#: Steps beyond an event, relative to its torque, at which its set is sought where the event itself leaves it open;
#: where the path begins without a torque, relative to that of its end.
STEPS_BEYOND = (1e-10, 1e-8, 1e-6)
#: Events for each segment before the path is given up.
MAX_EVENTS_PER_SEGMENT = 50


@frozen_arrays
@dataclass(frozen=True, eq=False, slots=True)
class PathPiece:
    """A part of the path with one touching set (a), from the torque where it begins."""

    torque: float  # [N mm]
    index: NDArray[np.intp]
    force: Array
    force_rate: Array  # by the torque (a) [1/mm]
    rotation: float  # beyond first contact [rad]
    rotation_rate: float  # by the torque [1/(N mm)]

    def begun_at(self, torque: float) -> PathPiece:
        """Return the rest of the piece from a torque on [N mm]."""
        force, turn = (torque - self.torque) * self.force_rate, (torque - self.torque) * self.rotation_rate
        return replace(self, torque=torque, force=self.force + force, rotation=self.rotation + turn)

    def answer(self, problem: ContactProblem, torque: float) -> Answer:
        """Return the answer at a torque [N mm], with its certificate."""
        force, length = np.zeros(problem.size), torque - self.torque
        force[self.index] = np.maximum(self.force + length * self.force_rate, 0.0)
        return with_certificate(problem.with_torque(torque), force, self.rotation + length * self.rotation_rate)


@dataclass(eq=False)
class FollowedPath:
    """Followed pieces, changes of the touching set, and the reason of an early end."""

    pieces: list[PathPiece] = field(default_factory=list)
    changes: list[tuple[float, int, bool]] = field(default_factory=list)  # torque [N mm], segment, True if it enters
    reached: float = 0.0  # torque up to which the path is proved [N mm]
    failure: str = ""  # empty if it was followed to the end


class _Point:
    """Forces, gaps and rotation at a torque, and their rates, for the touching set of a system."""

    def __init__(self, problem: ContactProblem, system: TouchingSystem, torque: float) -> None:
        nothing = np.zeros(problem.size)
        sides = np.column_stack([-problem.separation_at_first_contact, nothing]), np.array([torque, 1.0])
        answer = system.solve(*sides)
        self.torque, self.system, self.active = torque, system, system.active
        self.force, self.rotation, self.gap = answer.column(0)
        self.force_rate, self.rotation_rate, self.gap_rate = answer.column(1)
        turned = np.abs(problem.lever_arm[self.active]).max(initial=0.0)
        # Scales: the largest force, and the way that the rotation closes.
        self.force_scale = float(np.abs(self.force).max())
        self.gap_scale = float(abs(self.rotation) * turned)
        self.force_rates = float(np.abs(self.force_rate).max())
        yielding = float(problem.compliance_diagonal.max())
        self.gap_rates = max(float(np.abs(self.rotation_rate) * turned), self.force_rates * yielding)

    def falling(self) -> tuple[NDArray[np.intp], Array]:
        """Return the segments whose force or gap falls, and how far off the torque is at which it vanishes."""
        value = np.where(self.active, self.force, self.gap)
        rate = np.where(self.active, self.force_rate, self.gap_rate)
        least = np.where(self.active, self.force_rates, self.gap_rates) * SMALLEST_RATE
        index = np.flatnonzero(rate < -least)
        return index, np.maximum(value[index], 0.0) / -rate[index]

    def holds(self) -> bool:
        """True if all signs are right here, and stay so just beyond."""
        value = np.where(self.active, self.force, self.gap)
        rate = np.where(self.active, self.force_rate, self.gap_rate)
        scale = np.where(self.active, self.force_scale, self.gap_scale)
        rates = np.where(self.active, self.force_rates, self.gap_rates)
        if not (np.isfinite(value).all() and np.isfinite(rate).all()):
            return False
        at_zero = value <= TIE_TOLERANCE * scale
        right = (value >= -WRONG_SIGN_TOLERANCE * scale) & ~(at_zero & (rate < -SMALLEST_RATE * rates))
        return bool(right.all())

    def piece(self) -> PathPiece:
        index = np.flatnonzero(self.active)
        force, rate = self.force[index], self.force_rate[index]
        return PathPiece(self.torque, index, force, rate, self.rotation, self.rotation_rate)


def follow(problem: ContactProblem, low: float, high: float) -> FollowedPath:
    """Follow the solution from one torque to a higher one [N mm]; from zero on, where the first has no solution."""
    path = _followed(problem, low, high)
    if path.pieces or low == 0.0:
        return path
    whole = _followed(problem, 0.0, high)
    if not whole.pieces or whole.reached < low:
        return path
    whole.changes = [change for change in whole.changes if change[0] > low]
    *_, first = (piece for piece in whole.pieces if piece.torque <= low)
    whole.pieces = [first.begun_at(low), *(piece for piece in whole.pieces if piece.torque > low)]
    return whole


def _followed(problem: ContactProblem, low: float, high: float) -> FollowedPath:
    path = FollowedPath(reached=low)
    point = _first(problem, low, high, path)
    patience = MAX_EVENTS_PER_SEGMENT * problem.size
    while point is not None:
        answer = point.piece().answer(problem, point.torque)
        if not answer.certificate.passes(EXACT_TOLERANCE):
            path.failure = f"the answer at {point.torque:.6g} N mm has a certificate of {answer.certificate.worst:.1e}"
            return path
        if path.pieces and path.pieces[-1].torque == point.torque:
            path.pieces.pop()
        path.pieces.append(point.piece())
        path.reached = point.torque
        falling, distance = point.falling()
        step = float(distance.min(initial=np.inf))
        if point.torque + step >= high:
            end = path.pieces[-1].answer(problem, high)
            if end.certificate.passes(EXACT_TOLERANCE):
                path.reached = high
            else:
                path.failure = f"the answer at {high:.6g} N mm has a certificate of {end.certificate.worst:.1e}"
            return path
        patience -= 1
        if not patience:
            path.failure = f"more than {MAX_EVENTS_PER_SEGMENT} events a segment up to {point.torque:.6g} N mm"
            return path
        before, torque = point.active, point.torque + step
        point = _beyond(problem, point, falling[distance == step], step)
        if point is None:
            path.failure = f"the segments that touch beyond {torque:.6g} N mm cannot be told"
            return path
        _note(path, torque, before, point.active)
    return path


def _note(path: FollowedPath, torque: float, before: Mask, after: Mask) -> None:
    path.changes += [(torque, int(segment), bool(after[segment])) for segment in np.flatnonzero(before ^ after)]


def _first(problem: ContactProblem, torque: float, high: float, path: FollowedPath) -> _Point | None:
    """The point at which a path to a higher torque begins."""
    solution = solve(problem.with_torque(torque))
    if not solution.certified:
        path.failure = f"no certified solution at {torque:.6g} N mm: {solution.status.name.lower()}"
        return None
    force, gap = solution.force, solution.gap
    loaded = force > 0.0
    scale = abs(solution.elastic_rotation) * float(np.abs(problem.lever_arm[loaded]).max(initial=0.0))
    strong, weak = loaded_and_weak(force, gap, float(force.max()), scale, TIE_TOLERANCE)
    point = _resolved(problem, strong, weak, torque) or _sought(problem, torque, torque or high)
    if point is None:
        path.failure = f"the forces at {torque:.6g} N mm are not unique, or the segments that touch cannot be told"
        return None
    _note(path, torque, strong, point.active)
    return point


def _beyond(problem: ContactProblem, point: _Point, vanishing: NDArray[np.intp], step: float) -> _Point | None:
    """The point at an event, with the set that touches beyond it."""
    torque = point.torque + step
    force, gap = point.force + step * point.force_rate, point.gap + step * point.gap_rate
    rotation = point.rotation + step * point.rotation_rate
    scales = float(force.max()), abs(rotation) * float(np.abs(problem.lever_arm[point.active]).max())
    tied = np.where(point.active, force <= TIE_TOLERANCE * scales[0], gap <= TIE_TOLERANCE * scales[1])
    tied[vanishing] = True
    if np.count_nonzero(tied) == 1:
        segment, system = int(vanishing[0]), point.system
        changed = system.leave(segment) if point.active[segment] else system.enter(segment)
        if changed:
            simple = _Point(problem, system, torque)
            if simple.holds():
                return simple
    return _resolved(problem, point.active & ~tied, tied, torque) or _sought(problem, torque, torque)


def _resolved(problem: ContactProblem, loaded: Mask, weak: Mask, torque: float) -> _Point | None:
    """The point where the weak segments are told apart by the direction of a rising torque."""
    matrix, arm = problem.compliance_matrix, problem.lever_arm
    nothing = np.zeros(problem.size)
    system = system_in_direction(matrix, arm, loaded, weak, nothing, 1.0, lambda first: solve(first).answer)
    if system is None or not arm[system.active].any():
        return None
    point = _Point(problem, system, torque)
    return point if point.holds() else None


def _sought(problem: ContactProblem, torque: float, level: float) -> _Point | None:
    """The point with the set of a certified solution just beyond it, at steps of a level, if its piece reaches back."""
    for step in STEPS_BEYOND:
        solution = solve(problem.with_torque(torque + step * level))
        if solution.certified and problem.lever_arm[solution.active].any():
            system = touching_system(problem.compliance_matrix, problem.lever_arm, solution.active)
            point = _Point(problem, system, torque)
            if point.holds():
                return point
    return None
