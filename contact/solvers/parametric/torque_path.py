"""The solution of a contact problem as a function of the torque: exact, piecewise affine, with every change of contact.

For given separations the segments that touch change at certain torques only; between two of these forces, gaps and
rotation are affine in the torque. The path is the list of these torques and pieces.

A piece ends where a force or a gap vanishes. One segment then leaves or enters; where several are at zero together, the
small complementarity problem of `weak_segments` decides. Where rounding leaves that in doubt, a certified solution just
beyond shows the set; it is taken only if the piece that belongs to it reaches back to the event.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from ....core.arrays import Bools, Integers, RealArray as Array, record
from ....core.attributes import labelled
from ....core.checks import array, instance
from ....core.errors import InputError
from ...problem.certificate import EXACT_TOLERANCE, Answer, with_certificate
from ...problem.contact_problem import ContactProblem
from ..registry import solve
from ..solution import ContactSolution, Status, judged
from .touching_form import TouchingSystem, touching_system
from .weak_segments import loaded_and_weak, system_in_direction

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


@record(frozen=True, eq=False, slots=True)
class PathPiece:
    """A part of the path with one touching set (a), from the torque where it begins."""

    torque: float  # [N mm]
    index: Integers
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
        # What must not become negative: forces of the touching segments, gaps of the others.
        self._value = np.where(self.active, self.force, self.gap)
        self._rate = np.where(self.active, self.force_rate, self.gap_rate)
        # Scales: the largest force, and the way that the rotation closes.
        turned = np.abs(problem.lever_arm[self.active]).max(initial=0.0)
        self._scale = np.where(self.active, np.abs(self.force).max(), abs(self.rotation) * turned)
        force_rates = float(np.abs(self.force_rate).max())
        yielding = force_rates * float(problem.compliance_diagonal.max())
        gap_rates = max(float(np.abs(self.rotation_rate) * turned), yielding)
        self._least_rate = np.where(self.active, force_rates, gap_rates) * SMALLEST_RATE

    def falling(self) -> tuple[Integers, Array]:
        """Return the segments whose force or gap falls, and how far off the torque is at which it vanishes."""
        index = np.flatnonzero(self._rate < -self._least_rate)
        return index, np.maximum(self._value[index], 0.0) / -self._rate[index]

    def holds(self) -> bool:
        """True if all signs are right here, and stay so just beyond."""
        if not (np.isfinite(self._value).all() and np.isfinite(self._rate).all()):
            return False
        at_zero = self._value <= TIE_TOLERANCE * self._scale
        right = self._value >= -WRONG_SIGN_TOLERANCE * self._scale
        return bool((right & ~(at_zero & (self._rate < -self._least_rate))).all())

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
        if (point := _beyond(problem, point, falling[distance == step], step)) is None:
            path.failure = f"the segments that touch beyond {torque:.6g} N mm cannot be told"
            return path
        _note(path, torque, before, point.active)
    return path


def _note(path: FollowedPath, torque: float, before: Bools, after: Bools) -> None:
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
    strong, weak = loaded_and_weak(force, gap, scale, TIE_TOLERANCE)
    point = _resolved(problem, strong, weak, torque) or _sought(problem, torque, torque or high)
    if point is None:
        path.failure = f"the forces at {torque:.6g} N mm are not unique, or the segments that touch cannot be told"
        return None
    _note(path, torque, strong, point.active)
    return point


def _beyond(problem: ContactProblem, point: _Point, vanishing: Integers, step: float) -> _Point | None:
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


def _resolved(problem: ContactProblem, loaded: Bools, weak: Bools, torque: float) -> _Point | None:
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


@record(frozen=True, eq=False)
class PathOverTorque(ABC):
    """Ends, events and status of a path, in the direction of travel; of linear or of load-dependent contact."""

    start: float
    end: float
    torque: Array
    segment: Integers
    enters: Bools
    status: Status
    message: str

    @property
    def certified(self) -> bool:
        """True if the path was followed from start to end, and all of it is proved."""
        return self.status is Status.CERTIFIED

    @property
    @abstractmethod
    def covered(self) -> tuple[float, float]:
        """Least and greatest torque at which the path is known [N mm]; NaN if it is at none."""

    def _torque_on(self, torque: float) -> float:
        """Check that the path is known at a torque [N mm]."""
        given = float(array("torque", torque, "N mm", ndim=0))
        low, high = self.covered
        if not low <= given <= high:
            reason = f"; {self.message}" if self.message else ""
            raise InputError(f"torque = {given:g}: must be from {low:g} to {high:g} N mm, the known path{reason}")
        return given

    def _table(self, size: int, torque: Array, solutions: Sequence[ContactSolution], **attributes: Any) -> xr.Dataset:
        """Events, and solutions at the breakpoints (b) [N mm], as a Dataset with units."""
        per_segment = ("breakpoint", "segment")
        data: Mapping[str, Any] = {
            "event_torque": ("event", self.torque),
            "event_segment": ("event", self.segment),
            "event_enters": ("event", self.enters.astype(np.int8)),
            "path_torque": ("breakpoint", torque),
            "path_rotation": ("breakpoint", np.array([one.rotation for one in solutions])),
            "path_force": (per_segment, np.array([one.force for one in solutions]).reshape(-1, size)),
            "path_gap": (per_segment, np.array([one.gap for one in solutions]).reshape(-1, size)),
            "worst_residual": ("breakpoint", np.array([one.certificate.worst for one in solutions])),
        }
        status = {"status": self.status.name.lower(), "message": self.message}
        return labelled(xr.Dataset(data, attrs=status | attributes))


def path_ends(start: float, end: float) -> tuple[float, float]:
    """Check the torques between which a path is asked for [N mm]."""
    first, last = (array(name, value, "N mm", ndim=0, least=0.0) for name, value in (("start", start), ("end", end)))
    return float(first), float(last)


def path_fields(start: float, end: float, changes: Sequence[tuple[float, int, bool]], failure: str) -> dict[str, Any]:
    """Fields of a `PathOverTorque` of changes (torque, segment, enters) in the order of a rising torque."""
    if start > end:
        changes = [(torque, segment, not enters) for torque, segment, enters in reversed(changes)]
    torque, segment, enters = zip(*changes, strict=True) if changes else ((), (), ())
    return {
        "start": start,
        "end": end,
        "torque": np.array(torque, dtype=np.float64),
        "segment": np.array(segment, dtype=np.int64),
        "enters": np.array(enters, dtype=np.bool_),
        "status": Status.NOT_CONVERGED if failure else Status.CERTIFIED,
        "message": failure,
    }


METHOD = "torque_path"


@record(frozen=True, eq=False)
class TorquePath(PathOverTorque):
    """Solutions of a contact problem between two torques.

    Attributes
    ----------
    problem
        The contact problem; its own torque plays no part.
    start, end
        Torques between which the path was asked for [N mm], in the direction of travel.
    torque
        Torque of every event (e) [N mm], in the direction of travel.
    segment
        Segment that enters or leaves the contact there (e).
    enters
        Whether it enters (e).
    status
        `Status.CERTIFIED` if the path was followed from start to end and the answer at every event is proved.
    message
        Why it was not followed to the end; empty if it was.

    Notes
    -----
    All conditions are convex, or equations, in forces and gaps: where both ends of a piece are certified, so is all
    between them.

    Examples
    --------
    Two springs, the second with a gap of 1 um:

    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, torque_path
    >>> springs = ContactProblem([0.0, 1e-3], [40.0, 40.0], 0.0, np.diag([1e-6, 1e-6]))
    >>> path = torque_path(springs, 0.0, 1e5)
    >>> path.torque.round(6).tolist(), path.segment.tolist(), path.at(8e4).force.round(6).tolist()
    ([0.0, 40000.0], [0, 1], [1500.0, 500.0])
    """

    problem: ContactProblem
    _pieces: Sequence[PathPiece] = field(repr=False)
    _reached: float = field(repr=False)

    @property
    def covered(self) -> tuple[float, float]:
        """Least and greatest torque at which the path is known [N mm]; NaN if it is at none."""
        return (self._pieces[0].torque, self._reached) if self._pieces else (np.nan, np.nan)

    def at(self, torque: float) -> ContactSolution:
        """Return the certified solution at a torque.

        Parameters
        ----------
        torque
            Torque about the gear axis [N mm], in `covered`.

        Raises
        ------
        InputError
            The path is not known at that torque.
        """
        given = self._torque_on(torque)
        piece = self._pieces[max(bisect_right(self._torques, given) - 1, 0)]
        answer = piece.answer(self.problem, given)
        solution = judged("native", answer, tolerance=EXACT_TOLERANCE, iterations=0, method=METHOD, message=METHOD)
        if solution.certified:
            return solution
        return solve(self.problem.with_torque(given), initial_active=piece.index)

    @property
    def breakpoints(self) -> Array:
        """Torques at which pieces meet, and both ends (b) [N mm], in the direction of travel."""
        if not self._pieces:
            return np.empty(0)
        torques = np.array([*self._torques, self._reached][: len(self._pieces) + (self._reached > self._torques[-1])])
        return torques if self.start <= self.end else torques[::-1]

    def to_dataset(self) -> xr.Dataset:
        """Return the whole path with units.

        Returns
        -------
        xarray.Dataset
            ``event_torque``, ``event_segment``, ``event_enters`` (event); ``path_force``, ``path_gap`` (breakpoint,
            segment), ``path_rotation`` and ``worst_residual`` (breakpoint) at the torques ``path_torque``
            (breakpoint): between these everything is linear.
        """
        return self._table(self.problem.size, self.breakpoints, [self.at(torque) for torque in self.breakpoints])

    @cached_property
    def _torques(self) -> list[float]:
        return [piece.torque for piece in self._pieces]


def torque_path(problem: ContactProblem, start: float, end: float) -> TorquePath:
    """Follow the solution of a contact problem over the torque.

    Parameters
    ----------
    problem
        The contact problem; its own torque plays no part.
    start, end
        Torques between which it is followed [N mm], not negative, either of them the greater.

    Returns
    -------
    TorquePath
        With all events; with a status and a message where the path could not be followed to the end.

    Raises
    ------
    InputError
        A torque is negative or not finite, or the compliance is not positive semidefinite.

    Examples
    --------
    A Winkler bed: each spring takes part from the torque on at which the rotation has closed its gap.

    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> bed = ContactProblem([0.0, 1e-3, 3e-3], [50.0] * 3, 0.0, np.diag([1e-6] * 3))
    >>> torque_path(bed, 0.0, 4e5).torque.round(6).tolist()
    [0.0, 50000.0, 250000.0]
    >>> torque_path(bed, 4e5, 2e5).enters.tolist()
    [False]
    """
    instance("problem", problem, ContactProblem)
    first, last = path_ends(start, end)
    if not problem.is_positive_semidefinite:
        raise InputError("compliance: must be positive semidefinite")
    path = follow(problem, min(first, last), max(first, last))
    fields = path_fields(first, last, path.changes, path.failure)
    return TorquePath(**fields, problem=problem, _pieces=tuple(path.pieces), _reached=path.reached)
