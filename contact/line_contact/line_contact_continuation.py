"""Continuation of the solution with load-dependent line contact over the torque, every point certified.

The indentation h = r theta - S - B F of a segment by its local contact is positive where it touches, and minus the gap
elsewhere. Between two changes of the touching set it is a smooth function of the torque, with the derivative of
`line_contact_sensitivity`. A step is accepted if the same segments touch at both ends, and if no cubic through values
and derivatives there crosses zero between them; else it is divided, at the first zero of the cubics, until the torque
of each change lies between two certified points as close as the tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...core.errors import InputError
from ..compliance.weber_line_contact import WeberLineContact
from ..problem.contact_problem import ContactProblem
from ..solvers import ContactSolution
from .line_contact_law import solve_line_contacts
from .line_contact_newton import LineContact
from .line_contact_sensitivity import tangent_sensitivity
from .line_contact_solution import solve_on_bending

Array = NDArray[np.float64]

#: A force and a gap that are both below this part of their scales are rounding.
WEAK_TOLERANCE = 1e-13
#: First step, as a part of the greatest torque, and the greatest growth of the torque in a step.
FIRST_STEP, LARGEST_GROWTH = 1e-3, 1.5
#: A step goes so many times the way to the first change that the derivatives foretell.
OVERSHOOT = 1.05
#: Places between the ends of a step at which the cubics are looked at.
CUBIC_PLACES = np.linspace(0.0, 1.0, 17)[1:-1]
#: Divisions of one step at the zeros of the cubics, before it is halved; and in all.
MAX_GUIDED_DIVISIONS, MAX_DIVISIONS = 12, 200


@frozen_arrays
@dataclass(frozen=True, eq=False)
class PathNode:
    """A certified point of the path.

    Attributes
    ----------
    torque
        About the gear axis [N mm].
    solution
        Of the contact problem there.
    force_rate, rotation_rate
        Derivatives of forces (n) and rotation by the torque.
    indentation, indentation_rate
        Of the segments by their local contact (n) [mm], and its derivative.
    touching
        Segments that carry load (n).
    """

    torque: float
    solution: ContactSolution
    force_rate: Array
    rotation_rate: float
    indentation: Array
    indentation_rate: Array
    touching: NDArray[np.bool_]


@dataclass(eq=False)
class ContinuedPath:
    """What was followed: points, changes of the touching set (torque, segment, enters), and why it ended early."""

    nodes: list[PathNode] = field(default_factory=list)
    changes: list[tuple[float, int, bool]] = field(default_factory=list)
    failure: str = ""


def solved_at(
    bending: ContactProblem, line_contact: LineContact, torque: float, start: Array | None
) -> ContactSolution:
    """Return the solution at a torque [N mm], from forces near it (n) [N] if they are known."""
    problem = bending.with_torque(torque)
    if isinstance(line_contact, WeberLineContact) and problem.is_structured and torque > 0.0:
        return next(solve_line_contacts([problem], [line_contact], [start]))[0]
    return solve_on_bending(problem, line_contact, initial_force=start)[0]


def continue_path(
    bending: ContactProblem, line_contact: LineContact, low: float, high: float, tolerance: float
) -> ContinuedPath:
    """Follow the solution from one torque to a higher one [N mm].

    Parameters
    ----------
    bending, line_contact
        As of `line_contact_sensitivity`.
    low, high
        Torques [N mm].
    tolerance
        Largest distance of the two points between which a change lies, relative to its torque.
    """
    path = ContinuedPath()

    def node(torque: float, start: Array | None) -> PathNode | None:
        try:
            return _node(bending, line_contact, torque, start)
        except _NotFollowedError as error:
            path.failure = str(error)
            return None

    first = node(low, None)
    if first is None:
        return path
    path.nodes.append(first)
    carried = first.solution.active
    path.changes += [(low, int(i), True) for i in np.flatnonzero(first.touching & ~carried)]
    while path.nodes[-1].torque < high:
        here = path.nodes[-1]
        target = min(high, here.torque + _step(here, high))
        beyond = node(target, _foretold(here, target))
        if beyond is None or not _reach(path, node, beyond, tolerance):
            path.failure = path.failure or f"changes of contact beyond {here.torque:.6g} N mm cannot be told apart"
            return path
    return path


class _NotFollowedError(InputError):
    """No certified solution, or one without derivatives."""


def _node(bending: ContactProblem, line_contact: LineContact, torque: float, start: Array | None) -> PathNode:
    solution = solved_at(bending, line_contact, torque, start)
    if not solution.certified:
        name = solution.status.name.lower()
        raise _NotFollowedError(f"no certified solution at {torque:.6g} N mm: {name}; {solution.message}")
    slope = tangent_sensitivity(bending.with_torque(torque), line_contact, solution, WEAK_TOLERANCE)
    change = slope.forward(torque=1.0)
    if not np.isfinite(change.force).all():
        raise _NotFollowedError(f"no derivative by the torque at {torque:.6g} N mm: {change.message}")
    force = solution.force
    touching = solution.active | (change.active & slope.weak)
    local = line_contact.tangent(force) * change.force
    indentation = np.where(touching, line_contact.deflection(force), -np.maximum(solution.gap, 0.0))
    rate = np.where(touching, local, -change.gap)
    return PathNode(torque, solution, change.force, change.rotation, indentation, rate, touching)


def _step(here: PathNode, high: float) -> float:
    """Length of the next step [N mm]."""
    limit = max((LARGEST_GROWTH - 1.0) * here.torque, FIRST_STEP * high)
    closing = np.where(here.touching, -here.indentation_rate, here.indentation_rate)
    index = np.flatnonzero(closing > 0.0)
    distance = np.abs(here.indentation[index]) / closing[index]
    return min(limit, max(OVERSHOOT * float(distance.min(initial=np.inf)), 1e-2 * limit))


def _foretold(here: PathNode, torque: float) -> Array:
    """Forces at a torque by the derivatives (n) [N]."""
    return np.maximum(here.solution.force + (torque - here.torque) * here.force_rate, 0.0)


def _reach(
    path: ContinuedPath,
    node: Callable[[float, Array | None], PathNode | None],
    target: PathNode,
    tolerance: float,
) -> bool:
    """Add certified points up to the target, so close that every change is located; False where that fails."""
    waiting, divisions = [target], 0
    while waiting:
        left, right = path.nodes[-1], waiting[-1]
        width, nearest = right.torque - left.torque, tolerance * right.torque
        changed = np.flatnonzero(left.touching ^ right.touching)
        zero = _first_zero(left, right)
        if zero is None or width <= nearest:
            path.changes += sorted((_crossing(left, right, int(i)), int(i), bool(right.touching[i])) for i in changed)
            path.nodes.append(waiting.pop())
            divisions = 0
            continue
        divisions += 1
        place = left.torque + zero * width
        place += nearest / 3.0 if place + nearest / 2.0 < right.torque else -nearest / 3.0
        if divisions > MAX_GUIDED_DIVISIONS or not left.torque < place < right.torque:
            place = left.torque + 0.5 * width
        if divisions > MAX_DIVISIONS or not left.torque < place < right.torque:
            return False
        between = node(place, _foretold(left, place))
        if between is None:
            return False
        waiting.append(between)
    return True


def _first_zero(left: PathNode, right: PathNode) -> float | None:
    """Place from 0 to 1 of the first zero between two points, by the cubics; None if no segment has one there."""
    width, places = right.torque - left.torque, CUBIC_PLACES[:, None]
    ends = left.indentation, right.indentation, width * left.indentation_rate, width * right.indentation_rate
    values = _cubic(places, *ends)
    table = np.vstack([np.where(left.touching, 1.0, -1.0), values, np.where(right.touching, 1.0, -1.0)])
    crossing = np.signbit(table[1:]) != np.signbit(table[:-1])
    found = np.flatnonzero(crossing.any(axis=0))
    if not found.size:
        return None
    grid = np.concatenate([[0.0], CUBIC_PLACES, [1.0]])
    whole = np.vstack([left.indentation, values, right.indentation])
    zeros = []
    for segment in found:
        number = int(np.argmax(crossing[:, segment]))
        own = [end[segment] for end in ends]
        low, high = grid[number], grid[number + 1]
        first = whole[number, segment]
        for _ in range(50):
            middle = 0.5 * (low + high)
            if (_cubic(middle, *own) > 0.0) == (first > 0.0):
                low = middle
            else:
                high = middle
        zeros.append(0.5 * (low + high))
    return float(min(zeros))


def _cubic(place: Array | float, left: Array, right: Array, left_slope: Array, right_slope: Array) -> Array:
    """Cubic with these values and slopes at 0 and 1."""
    rest = 1.0 - place
    value = rest * rest * (left * (1.0 + 2.0 * place) + left_slope * place)
    return np.asarray(value + place * place * (right * (1.0 + 2.0 * rest) - right_slope * rest))


def _crossing(left: PathNode, right: PathNode, segment: int) -> float:
    """Torque at which the indentation vanishes between two near points, by the chord."""
    ends = abs(left.indentation[segment]), abs(right.indentation[segment])
    share = ends[0] / sum(ends) if sum(ends) > 0.0 else 1.0
    return float(left.torque + share * (right.torque - left.torque))
