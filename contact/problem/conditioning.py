"""Conditioning of an answer: whether its forces are the only ones, and how far they and the rotation may be off.

A certificate bounds violations, not errors: where C is nearly singular on the segments that touch, forces far apart
satisfy all conditions to the last digit. The bound. Let F and theta be an answer, F* and theta* the solution. Split F
and its gaps Y into complementary ones and small rests,

    F = F^ + f,  Y = Y^ + y,  F^ >= 0,  Y^ >= 0,  F^'Y^ = 0,  r'F^ = T,

with D = F^ - F* and g = y - C f. Then Y^ - Y* = C D - r (theta - theta*) - g, and since (F^ - F*)'(Y^ - Y*) <= 0 and
r'D = 0,

    D'C D <= D'g .

So with weights s > 0 and lambda the smallest eigenvalue of C / (s s') on r'D = 0 and on the segments that may carry
load, |s D| <= |g / s| / lambda: linear in the residuals, whether or not segments are only just in contact. Where C is
singular, D'C D is still bounded by g and the forces, which bounds the rotation by the root of the residuals.
With C D, the product of the first equation with F^ and with F* bounds T (theta - theta*), and its rows show which
segments are certainly open.

A problem may have no solution. The torque can always be carried, for some lever arm is positive. So a problem has no
solution only if its energy has no lower bound: if forces D >= 0 without moment, r'D = 0, meet no compliance, D'C D = 0,
and gain energy, S'D < 0. Such forces are found by a linear programme and proved in rational numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ...core.arrays import Bools, RealArray as Array, record
from .certificate import exact_gap_error, exact_residuals
from .compliance_matrix import ModalCompliance, OperatorCompliance
from .contact_problem import ContactProblem
from .first_contact import UNIT_ROUNDOFF, dot_terms

#: Segments of a structured compliance from which on its eigenvalues are bounded by the local part alone.
EIGENVALUE_SIZE_LIMIT = 1000
#: Rounds of finding open segments, and of sharper bounds with the others.
ROUNDS = 3
#: Forces above this part of the greatest carry load, where the question is whether others do so as well.
LOADED_FRACTION = 1e-6
#: The bounds are raised by this much, for their own rounding.
MARGIN = 1.0 + 1e-6


@record(frozen=True, eq=False)
class Conditioning:
    """Uniqueness of a contact problem's solution and error bounds, from an answer.

    ``unique`` is False if other forces satisfy the conditions up to the rounding of C, on segments that carry load;
    None where segments only just in contact, or rounding, leave it open.
    """

    unique: bool | None
    may_touch: Bools  # (n), not shown to be open in every solution
    #: Of C scaled to a unit diagonal, on segments that may touch and forces without moment, less rounding; zero where
    #: forces are not determined, infinite where equilibrium alone determines them.
    smallest_eigenvalue: float
    force_error: Array  # (n) [N]; infinite unless unique
    rotation_error: float  # beyond first contact [rad]; infinite where there is none


def unknown_conditioning(size: int) -> Conditioning:
    """Return what is known without an answer: nothing."""
    return Conditioning(None, np.ones(size, dtype=np.bool_), 0.0, np.full(size, np.inf), math.inf)


def conditioning(problem: ContactProblem, force: Array, elastic_rotation: float) -> Conditioning:
    """Bound the errors of an answer, from the rotation beyond first contact [rad].

    Costs the cube of the number of segments that may touch; a structured compliance of more than 1000 of them is
    bounded by its local part.
    """
    unknown = unknown_conditioning(force.size)
    products = isinstance(problem.compliance_matrix, OperatorCompliance)  # nothing is known of their eigenvalues
    if products or not (np.isfinite(force).all() and math.isfinite(elastic_rotation)):
        return unknown
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        try:
            split = _Split.of(problem, force, elastic_rotation)
        except (OverflowError, ValueError):
            return unknown
        return unknown if split is None else _conditioning(problem, split)


def _conditioning(problem: ContactProblem, split: _Split) -> Conditioning:
    force, weight, residual = split.force, split.weight, split.residual / split.weight
    may_touch = np.ones(force.size, dtype=np.bool_)
    least = _smallest_eigenvalue(problem, weight, may_touch)
    energy, error, rotation = split.energy_bound(problem), math.inf, math.inf
    for _ in range(ROUNDS):
        if least > 0.0:
            left = float(np.linalg.norm(residual[may_touch])) * MARGIN
            error, energy = min(error, left / least), min(energy, left / math.sqrt(least))
        rotation = min(rotation, split.rotation_bound(problem, energy, error))
        closed = split.gap - split.root * energy - np.abs(problem.lever_arm) * rotation - split.residual
        narrower = may_touch & (~(closed > 0.0) | (force > 0.0))
        if np.array_equal(narrower, may_touch):
            break
        may_touch, least = narrower, _smallest_eigenvalue(problem, weight, narrower)
    force_error = np.where(may_touch, error / weight, 0.0) + split.rest
    unique: bool | None = True if math.isfinite(error) else None
    if unique is None:
        loaded = force > LOADED_FRACTION * float(force.max())
        if np.count_nonzero(loaded) > 1 and not _smallest_eigenvalue(problem, weight, loaded) > 0.0:
            unique = False
    return Conditioning(unique, may_touch, max(least, 0.0), force_error, rotation)


@dataclass(frozen=True, eq=False, slots=True)
class _Split:
    """Complementary forces and gaps near an answer (n), and bounds of what is left over."""

    force: Array
    gap: Array
    rest: Array  # bound of |f|
    residual: Array  # bound of |g|
    weight: Array
    root: Array
    norm: float  # energy norm of the forces

    @classmethod
    def of(cls, problem: ContactProblem, given: Array, elastic_rotation: float) -> _Split | None:
        """Split an answer; None where no part of its forces balances the torque."""
        gap = exact_residuals(problem, given, elastic_rotation).gap
        unknown = exact_gap_error(problem, gap)
        root = np.sqrt(problem.compliance_diagonal)
        # A small force beside a larger gap counts as a force in error, else the gap does.
        loaded = (given > 0.0) & ~(gap > root**2 * given)
        force = np.where(loaded, given, 0.0)
        # Forces with a positive lever arm are scaled to balance the others and the torque.
        arm = problem.lever_arm
        driving, resisting = (math.fsum(dot_terms(force[side], arm[side])) for side in (arm > 0.0, arm < 0.0))
        if driving > 0.0:
            force = np.where(arm > 0.0, force * ((problem.torque - resisting) / driving), force)
        elif problem.torque - resisting > 0.0:
            return None
        size = 8.0 * UNIT_ROUNDOFF * force
        rest = np.where(loaded, np.abs(given - force) + size, np.abs(given))
        residual = np.where(loaded, np.abs(gap), np.maximum(-gap, 0.0)) + unknown + root * float(root @ rest)
        positive = root[root > 0.0]
        weight = np.where(root > 0.0, root, positive.max() if positive.size else 1.0)
        work = float(force @ problem.deflection(force))
        norm = math.sqrt(max(work, 0.0) + 1e-12 * float(root @ force) ** 2)
        return cls(force, np.where(loaded, 0.0, np.maximum(gap, 0.0)), rest, residual, weight, root, norm)

    def energy_bound(self, problem: ContactProblem) -> float:
        """Bound of the energy norm of D without eigenvalues: the forces of a solution are at most T / r, if r > 0."""
        if problem.first_contact.signs:
            return math.inf
        pressed = problem.torque * float((self.residual / problem.lever_arm).max())
        return math.sqrt((float(self.force @ self.residual) + pressed) * MARGIN)

    def rotation_bound(self, problem: ContactProblem, energy: float, error: float) -> float:
        """Bound of the error of the rotation [rad] from that of the energy norm and of the weighted forces."""
        arm, bound = np.abs(problem.lever_arm), math.inf
        if problem.torque > 0.0:
            work = self.norm * energy + float(self.force @ self.residual)
            work += min(error * float(np.linalg.norm(self.residual / self.weight)), self.energy_bound(problem) ** 2)
            bound = work / problem.torque
        touches = (self.force > MARGIN * error / self.weight) & (arm > 0.0)  # in every solution
        if touches.any():
            bounds = (self.root * energy + self.residual)[touches] / arm[touches]
            bound = min(bound, float(bounds.min()))
        return bound * MARGIN


def _smallest_eigenvalue(problem: ContactProblem, weight: Array, chosen: Bools) -> float:
    """Lower bound of the smallest eigenvalue of C / (s s') on chosen segments (n) and on r'D = 0."""
    matrix, scale = problem.compliance_matrix, weight[chosen]
    size = scale.size
    if isinstance(matrix, ModalCompliance):
        local = matrix.local[chosen] / scale**2
        if size > EIGENVALUE_SIZE_LIMIT:
            return float(local.min()) / MARGIN
        factor = matrix.factor[chosen] / scale[:, np.newaxis]
        scaled = factor @ factor.T
        scaled[np.diag_indices(size)] += local
        terms = factor.shape[1] + 4
    else:
        scaled = matrix.dense[np.ix_(chosen, chosen)] / scale / scale[:, np.newaxis]
        terms = 4
    normal = problem.lever_arm[chosen] / scale
    length = float(np.linalg.norm(normal))
    if length > 0.0:
        if size == 1:
            return math.inf
        # Householder's reflection takes r to the first axis; what is left of the others is orthogonal to r.
        normal = normal / length
        normal[0] += math.copysign(1.0, normal[0])
        normal /= float(np.linalg.norm(normal))
        scaled = scaled - 2.0 * np.outer(normal, normal @ scaled)
        scaled = (scaled - 2.0 * np.outer(scaled @ normal, normal))[1:, 1:]
    if not np.isfinite(scaled).all():
        return 0.0
    least = np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[0]
    return float(least - UNIT_ROUNDOFF * size * (terms + 10))


Row = list[Fraction]

#: Parts of the direction that are rounding, relative to the greatest; and gain of energy that is none.
SUPPORT_TOLERANCE, GAIN_TOLERANCE = 1e-9, 1e-6
#: Segments in the direction up to which rational numbers are tried.
SUPPORT_LIMIT = 60


def is_unbounded(problem: ContactProblem) -> bool:
    """True if it is proved that a problem has no solution."""
    scaled = problem.scaled()
    if not scaled.is_finite or scaled.separation.min() >= 0.0:
        return False  # the energy of every admissible load is bounded below by zero
    from scipy.optimize import linprog

    rows = np.vstack([scaled.compliance, scaled.lever_arm[np.newaxis, :]])
    solution = linprog(scaled.separation, A_eq=rows, b_eq=np.zeros(rows.shape[0]), bounds=(0.0, 1.0))
    least = -GAIN_TOLERANCE * float(np.abs(scaled.separation).max())
    if solution.status != 0 or solution.x is None or not float(solution.fun or 0.0) < least:
        return False
    support = np.flatnonzero(solution.x > SUPPORT_TOLERANCE * solution.x.max())
    return support.size <= SUPPORT_LIMIT and _is_proved(problem, support.tolist(), solution.x)


def _is_proved(problem: ContactProblem, support: list[int], near: Array) -> bool:
    """True if a direction near a given one has neither moment nor deflection, and gains energy.

    Where there are several directions, segments leave until there is one.
    """
    matrix = problem.compliance_matrix
    while support:
        if isinstance(matrix, ModalCompliance):
            support = [number for number in support if matrix.local[number] == 0.0]
            rows = matrix.factor[support].T
        else:
            rows = matrix.dense[np.ix_(support, support)]
        given = np.vstack([rows, problem.lever_arm[support]])
        direction = _null_vector([[Fraction(value) for value in row] for row in given.tolist()], len(support))
        if direction is None:
            return False
        separation = problem.separation[support].tolist()
        gain = sum(part * Fraction(distance) for part, distance in zip(direction, separation, strict=True))
        if gain > 0 or (gain == 0 and min(direction) >= 0):
            gain, direction = -gain, [-part for part in direction]
        if min(direction) >= 0:
            return gain < 0
        parts = list(zip(support, direction, strict=True))
        steps = {number: near[number] / -float(part) for number, part in parts if part < 0}
        near, step = near.copy(), min(steps.values())
        for number, part in parts:
            near[number] += step * float(part)
        support = [number for number in support if number != min(steps, key=lambda number: steps[number])]
    return False


def _null_vector(rows: list[Row], size: int) -> Row | None:
    """A vector, not zero, that a rational matrix takes to zero; None if there is none."""
    pivots: list[int] = []
    for column in range(size):
        done = len(pivots)
        pivot = next((i for i in range(done, len(rows)) if rows[i][column]), None)
        if pivot is None:
            continue
        rows[done], rows[pivot] = rows[pivot], rows[done]
        head = rows[done][column]
        rows[done] = [value / head for value in rows[done]]
        for i, row in enumerate(rows):
            if i != done and row[column]:
                factor = row[column]
                rows[i] = [value - factor * entry for value, entry in zip(row, rows[done], strict=True)]
        pivots.append(column)
    free = [column for column in range(size) if column not in pivots]
    if not free:
        return None
    vector = [Fraction(0)] * size
    vector[free[0]] = Fraction(1)
    for i, column in enumerate(pivots):
        vector[column] = -rows[i][free[0]]
    return vector
