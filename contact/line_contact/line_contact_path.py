"""The solution with load-dependent line contact as a function of the torque, with every change of contact.

Derivatives of a solution are those of the problem with the tangent compliance. The conditions are B F + delta(F) + S -
r theta = 0 on the touching segments. Their derivative has the tangent d delta / dF on the diagonal, where the linear
problem that certifies the solution has the secant delta / F: this has the same solution, but not the same derivatives.

The path is continued over the torque from one certified point to the next. The indentation h = r theta - S - B F of a
segment by its local contact is positive where it touches, and minus the gap elsewhere. Between two changes of the
touching set it is a smooth function of the torque, with the derivative of `line_contact_sensitivity`. A step is
accepted if the same segments touch at both ends, and if no cubic through values and derivatives there crosses zero
between them; else it is divided, at the first zero of the cubics, until the torque of each change lies between two
certified points as close as the tolerance.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from ...core.arrays import Bools, RealArray as Array, record
from ...core.checks import instance, number
from ...core.errors import InputError
from ..compliance.weber_line_contact import WeberLineContact
from ..problem.certificate import certify
from ..problem.contact_problem import ContactProblem
from ..solvers import ContactSolution
from ..solvers.parametric.sensitivity import DEGENERACY_TOLERANCE, Sensitivity, tangent_answer_sensitivity
from ..solvers.parametric.torque_path import PathOverTorque, path_ends, path_fields
from .line_contact_solution import LineContact, solve_line_contacts, solve_on_bending


def line_contact_sensitivity(
    bending: ContactProblem,
    line_contact: LineContact,
    solution: ContactSolution,
    *,
    tolerance: float = DEGENERACY_TOLERANCE,
) -> Sensitivity:
    """Return the derivatives of a certified solution with load-dependent line contact.

    Parameters
    ----------
    bending
        The contact problem with the compliance of bending alone, B.
    line_contact
        The local part.
    solution
        Of `solve_on_bending`.
    tolerance
        As of `sensitivity`.

    Returns
    -------
    Sensitivity
        With respect to the torque, S, r and B. A change of the local deflections under the same forces, as by a
        parameter of the line contact, is a change of S by that much. The energy is that of bending and line contact
        together, 1/2 F'BF plus the integrals of delta.

    Raises
    ------
    InputError
        The solution is not certified, or is that of another problem.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, Material
    >>> from easeoff.contact.compliance.weber_line_contact import WeberLineContact
    >>> from easeoff.contact.line_contact.line_contact_solution import solve_on_bending
    >>> steel = Material(206000.0, 0.3)
    >>> line_contact = WeberLineContact(*(np.full(3, value) for value in (1.5, 30.0, 3.0, 3.0)), steel, steel)
    >>> bending = ContactProblem([0.01, 0.0, 0.01], [40.0] * 3, 1.2e5, (np.zeros(3), np.full((3, 1), 1e-3)))
    >>> solution, _ = solve_on_bending(bending, line_contact)
    >>> slope = line_contact_sensitivity(bending, line_contact, solution)
    >>> round(1e-6 / slope.forward(torque=1.0).rotation, 3)  # mesh stiffness [N mm/urad]
    474.66
    """
    instance("bending", bending, ContactProblem)
    instance("line_contact", line_contact, LineContact)
    instance("solution", solution, ContactSolution)
    if not solution.certified:
        raise InputError(f"solution = {solution.status.name.lower()}: must be certified to have derivatives")
    force = solution.force
    secant = bending.with_added_compliance(line_contact.secant(force))
    if not certify(secant, force, solution.rotation, solution.elastic_rotation).passes(solution.tolerance):
        raise InputError("solution: must be that of this problem; its forces and rotation do not solve it")
    return tangent_sensitivity(bending, line_contact, solution, tolerance)


def tangent_sensitivity(
    bending: ContactProblem, line_contact: LineContact, solution: ContactSolution, tolerance: float
) -> Sensitivity:
    """As `line_contact_sensitivity`, for a solution that is known to be that of the problem."""
    force = solution.force
    tangent = bending.compliance_matrix.with_added(line_contact.tangent(force))
    deflection = bending.deflection(force) + line_contact.deflection(force)
    return tangent_answer_sensitivity(bending, solution.answer, tangent, deflection, tolerance)


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


@record(frozen=True, eq=False)
class PathNode:
    """A certified point of the path, rates by the torque about the gear axis."""

    torque: float  # [N mm]
    solution: ContactSolution
    force_rate: Array
    rotation_rate: float
    indentation: Array  # by local contact (n) [mm]
    indentation_rate: Array
    touching: Bools


@dataclass(eq=False)
class ContinuedPath:
    """Points, changes of the touching set (torque, segment, enters), and the reason why the path ended early."""

    nodes: list[PathNode] = field(default_factory=list)
    changes: list[tuple[float, int, bool]] = field(default_factory=list)
    failure: str = ""


def solved_at(bending: ContactProblem, local: LineContact, torque: float, start: Array | None) -> ContactSolution:
    """Return the solution at a torque [N mm], from forces near it (n) [N] if they are known."""
    problem = bending.with_torque(torque)
    if isinstance(local, WeberLineContact) and problem.is_structured and torque > 0.0:
        return next(solve_line_contacts([problem], [local], [start]))[0]
    return solve_on_bending(problem, local, initial_force=start)[0]


def continue_path(
    bending: ContactProblem, line_contact: LineContact, low: float, high: float, tolerance: float
) -> ContinuedPath:
    """Follow the solution to a higher torque [N mm], changes within ``tolerance`` relative to their torque."""
    path = ContinuedPath()

    def node(torque: float, start: Array | None) -> PathNode | None:
        try:
            return _node(bending, line_contact, torque, start)
        except _NotFollowedError as error:
            path.failure = str(error)
            return None

    if (first := node(low, None)) is None:
        return path
    path.nodes.append(first)
    carried = first.solution.active
    path.changes += [(low, int(i), True) for i in np.flatnonzero(first.touching & ~carried)]
    while path.nodes[-1].torque < high:
        point = path.nodes[-1]
        target = min(high, point.torque + _step(point, high))
        beyond = node(target, _foretold(point, target))
        if beyond is None or not _reach(path, node, beyond, tolerance):
            path.failure = path.failure or f"changes of contact beyond {point.torque:.6g} N mm cannot be told apart"
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


def _step(node: PathNode, high: float) -> float:
    """Length of the next step [N mm]."""
    limit = max((LARGEST_GROWTH - 1.0) * node.torque, FIRST_STEP * high)
    closing = np.where(node.touching, -node.indentation_rate, node.indentation_rate)
    index = np.flatnonzero(closing > 0.0)
    distance = np.abs(node.indentation[index]) / closing[index]
    return min(limit, max(OVERSHOOT * float(distance.min(initial=np.inf)), 1e-2 * limit))


def _foretold(node: PathNode, torque: float) -> Array:
    """Forces at a torque by the derivatives (n) [N]."""
    return np.maximum(node.solution.force + (torque - node.torque) * node.force_rate, 0.0)


def _reach(
    path: ContinuedPath, node: Callable[[float, Array | None], PathNode | None], target: PathNode, tolerance: float
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
        if (between := node(place, _foretold(left, place))) is None:
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
    segments = np.flatnonzero(crossing.any(axis=0))
    if not segments.size:
        return None
    grid = np.concatenate([[0.0], CUBIC_PLACES, [1.0]])
    whole = np.vstack([left.indentation, values, right.indentation])
    number = np.argmax(crossing[:, segments], axis=0)
    low, high, cubics = grid[number], grid[number + 1], [end[segments] for end in ends]
    first = whole[number, segments] > 0.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        before = (_cubic(middle, *cubics) > 0.0) == first
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return float(np.min(0.5 * (low + high)))


def _cubic(place: Array, left: Array, right: Array, left_slope: Array, right_slope: Array) -> Array:
    """Cubic with these values and slopes at 0 and 1."""
    rest = 1.0 - place
    value = rest * rest * (left * (1.0 + 2.0 * place) + left_slope * place)
    return np.asarray(value + place * place * (right * (1.0 + 2.0 * rest) - right_slope * rest))


def _crossing(left: PathNode, right: PathNode, segment: int) -> float:
    """Torque at which the indentation vanishes between two near points, by the chord."""
    ends = abs(left.indentation[segment]), abs(right.indentation[segment])
    share = ends[0] / sum(ends) if sum(ends) > 0.0 else 1.0
    return float(left.torque + share * (right.torque - left.torque))


#: Part of its torque within which a change of contact is located.
TORQUE_TOLERANCE = 1e-9


@record(frozen=True, eq=False)
class LineContactPath(PathOverTorque):
    """Solutions of a contact problem with load-dependent line contact between two torques.

    Attributes
    ----------
    bending
        The contact problem with the compliance of bending alone; its own torque plays no part.
    line_contact
        The local part.
    start, end
        Torques between which the path was asked for [N mm], in the direction of travel.
    tolerance
        Part of its torque within which each event is located.
    torque
        Torque of every event (e) [N mm], in the direction of travel.
    segment
        Segment that enters or leaves the contact there (e).
    enters
        Whether it enters (e).
    status
        `Status.CERTIFIED` if the path was followed from start to end; every point of it is then certified.
    message
        Why it was not followed to the end; empty if it was.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, Material, line_contact_path
    >>> from easeoff.contact.compliance.weber_line_contact import WeberLineContact
    >>> steel = Material(206000.0, 0.3)
    >>> line_contact = WeberLineContact(*(np.full(2, value) for value in (1.5, 30.0, 3.0, 3.0)), steel, steel)
    >>> bending = ContactProblem([0.0, 1e-3], [40.0, 40.0], 0.0, (np.zeros(2), np.full((2, 1), 1e-3)))
    >>> path = line_contact_path(bending, line_contact, 0.0, 1e5)
    >>> path.segment.tolist(), path.at(5e4).certified
    ([0, 1], True)

    The first segment has the indentation 1 um when the second touches:

    >>> round(float(line_contact.deflection(np.array([path.torque[1] / 40.0, 0.0]))[0]), 9)
    0.001
    """

    bending: ContactProblem
    line_contact: LineContact
    tolerance: float
    _nodes: Sequence[PathNode] = field(repr=False)

    @property
    def covered(self) -> tuple[float, float]:
        """Least and greatest torque between which the path was followed [N mm]; NaN if it was nowhere."""
        return (self._nodes[0].torque, self._nodes[-1].torque) if self._nodes else (np.nan, np.nan)

    def at(self, torque: float) -> ContactSolution:
        """Return the certified solution at a torque, found from the one below it on the path.

        Parameters
        ----------
        torque
            Torque about the gear axis [N mm], in `covered`.

        Raises
        ------
        InputError
            The path was not followed to that torque.
        """
        given = self._torque_on(torque)
        below = self._nodes[bisect_right([node.torque for node in self._nodes], given) - 1]
        if below.torque == given:
            return below.solution
        return solved_at(self.bending, self.line_contact, given, _foretold(below, given))

    def to_dataset(self) -> xr.Dataset:
        """Return events and certified points with units.

        Returns
        -------
        xarray.Dataset
            ``event_torque``, ``event_segment``, ``event_enters`` (event); ``path_force``, ``path_gap`` (breakpoint,
            segment), ``path_rotation``, ``worst_residual`` (breakpoint) at the torques ``path_torque`` (breakpoint).
            Between these nothing is linear: `at` solves there.
        """
        nodes = self._nodes if self.start <= self.end else self._nodes[::-1]
        torque = np.array([node.torque for node in nodes])
        solutions = [node.solution for node in nodes]
        return self._table(self.bending.size, torque, solutions, event_tolerance=self.tolerance)


def line_contact_path(
    bending: ContactProblem, line_contact: LineContact, start: float, end: float, *, tolerance: float = TORQUE_TOLERANCE
) -> LineContactPath:
    """Follow the solution of a contact problem with load-dependent line contact over the torque.

    Parameters
    ----------
    bending
        The contact problem with the compliance of bending alone, as `solve_on_bending` takes it.
    line_contact
        The local part.
    start, end
        Torques between which it is followed [N mm], not negative, either of them the greater.
    tolerance
        Part of its torque within which each event is located.

    Returns
    -------
    LineContactPath
        With a status and a message where the path could not be followed to the end.

    Raises
    ------
    InputError
        A torque is negative or not finite, or the tolerance is not between 1e-12 and 0.1.

    Notes
    -----
    A segment that enters and leaves again (or leaves and enters) between two neighbouring points is noticed if a cubic
    through their values and derivatives shows it. Steps grow the torque by half at the most.

    Examples
    --------
    One mesh position of a pair, from no load to 300 N m at the pinion:

    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=7)
    >>> segments = cycle.segments.by_position[0]
    >>> path = line_contact_path(segments.bending_problem, segments.line_contact, 0.0, 3e5 * cycle.ratio)
    >>> path.certified, bool(path.enters[0]), path.torque[0].item()
    (True, True, 0.0)
    """
    instance("bending", bending, ContactProblem)
    instance("line_contact", line_contact, LineContact)
    first, last = path_ends(start, end)
    number("tolerance", tolerance, least=1e-12, most=0.1)
    path = continue_path(bending, line_contact, min(first, last), max(first, last), tolerance)
    fields, nodes = path_fields(first, last, path.changes, path.failure), tuple(path.nodes)
    return LineContactPath(**fields, bending=bending, line_contact=line_contact, tolerance=tolerance, _nodes=nodes)
