"""Residuals and solutions of contact problems in rational numbers, from the data and answers as doubles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

import numpy as np
from easeoff.contact import ContactProblem
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = list[Fraction]

ZERO = Fraction(0)


def rationals(values: Array) -> Numbers:
    """Return the numbers of an array (n)."""
    return [Fraction(value) for value in values.tolist()]


def dot(a: Numbers, b: Numbers) -> Fraction:
    """Return the sum of products."""
    return sum((x * y for x, y in zip(a, b, strict=True)), ZERO)


@dataclass(frozen=True)
class RationalProblem:
    """A contact problem in rational numbers.

    Attributes
    ----------
    separation, lever_arm, torque
        S, r and T.
    local, modes
        d and the columns of V; None for a dense compliance.
    matrix
        C by rows; None for a structured compliance, until it is asked for.
    contact
        Rotation of first contact, min S/r over r > 0.
    """

    separation: Numbers
    lever_arm: Numbers
    torque: Fraction
    local: Numbers | None
    modes: list[Numbers]
    matrix: list[Numbers]
    contact: Fraction

    @classmethod
    def of(cls, problem: ContactProblem) -> RationalProblem:
        """Take over the data of a problem."""
        separation, arm = rationals(problem.separation), rationals(problem.lever_arm)
        contact = min(s / r for s, r in zip(separation, arm, strict=True) if r > 0)
        local, modes, matrix = None, [], []
        if isinstance(problem.compliance, tuple):
            local, modes = rationals(problem.compliance[0]), [rationals(column) for column in problem.compliance[1].T]
        else:
            matrix = [rationals(row) for row in problem.compliance]
        return cls(separation, arm, Fraction(problem.torque), local, modes, matrix, contact)

    @property
    def rows(self) -> list[Numbers]:
        """C by rows."""
        if self.local is None:
            return self.matrix
        size = len(self.local)
        return [
            [sum((mode[i] * mode[j] for mode in self.modes), self.local[i] if i == j else ZERO) for j in range(size)]
            for i in range(size)
        ]

    def deflection(self, force: Numbers) -> Numbers:
        """Return C F."""
        if self.local is None:
            return [dot(row, force) for row in self.matrix]
        deflection = [d * f for d, f in zip(self.local, force, strict=True)]
        for mode in self.modes:
            amplitude = dot(mode, force)
            deflection = [own + amplitude * part for own, part in zip(deflection, mode, strict=True)]
        return deflection

    def worst_violation(self, force: Array, elastic_rotation: Fraction) -> float:
        """Return the largest violation of the conditions, relative to the scales of the certificate."""
        forces = rationals(force)
        deflection = self.deflection(forces)
        rotation = self.contact + elastic_rotation
        gap = [y + s - rotation * r for y, s, r in zip(deflection, self.separation, self.lever_arm, strict=True)]
        shifted = [s - self.contact * r for s, r in zip(self.separation, self.lever_arm, strict=True)]
        sizes = [abs(f) for f in forces]
        total, largest = sum(sizes), max(sizes)
        moments = sum(f * abs(r) for f, r in zip(sizes, self.lever_arm, strict=True))
        gap_scale = 0.0
        if total:
            diagonal = self._diagonal()
            roots = sum(float(f) * math.sqrt(c) for f, c in zip(sizes, diagonal, strict=True))
            mean = float(sum(f * abs(y) for f, y in zip(sizes, deflection, strict=True)) / total)
            if max(mean, roots):
                preload = float(sum(f * abs(s) for f, s in zip(sizes, shifted, strict=True)))
                terms = max(roots**2, preload, float(abs(elastic_rotation) * moments))
                gap_scale = max(mean, 1e-5 * terms / float(total))
        if not gap_scale:
            gap_scale = float(max(map(abs, shifted))) or 1.0
        energy = float(total) * gap_scale + float(sum(f * abs(s) for f, s in zip(sizes, shifted, strict=True)))
        surplus = dot(forces, deflection) + dot(forces, shifted) - elastic_rotation * self.torque
        balance, balance_scale = abs(dot(forces, self.lever_arm) - self.torque), max(self.torque, moments / 100000)
        worst = float(balance / balance_scale) if balance_scale else float(bool(balance))
        if largest:
            worst = max(worst, float(-min(forces) / largest))
        worst = max(worst, float(-min(gap)) / gap_scale)
        for f, y in zip(forces, gap, strict=True):
            worst = max(worst, min(float(f / largest) if largest else float(f), float(y) / gap_scale))
        if surplus:
            worst = max(worst, abs(float(surplus)) / energy if energy else math.inf)
        return worst

    def _diagonal(self) -> list[float]:
        if self.local is None:
            return [float(self.matrix[i][i]) for i in range(len(self.matrix))]
        return [float(d + sum(mode[i] ** 2 for mode in self.modes)) for i, d in enumerate(self.local)]


@dataclass(frozen=True)
class RationalSolution:
    """A solution: forces, rotation beyond first contact, gaps."""

    force: Numbers
    rotation: Fraction
    gap: Numbers


def solution(problem: RationalProblem, guess: list[int]) -> RationalSolution | None:
    """Return a solution with positive torque; None if there is none.

    Of all solutions one with the fewest forces has a regular system of equations, so that trying all sets of segments
    finds it.

    Parameters
    ----------
    problem
        Of few segments.
    guess
        Segments that seem to touch: the set that is tried first.
    """
    rows = problem.rows
    for active in _sets(len(rows), guess):
        found = _on(problem, rows, active)
        if found is not None:
            return found
    return None


def _sets(size: int, guess: list[int]) -> Iterator[list[int]]:
    yield guess
    subsets = (set(chosen) for count in range(1, size + 1) for chosen in combinations(range(size), count))
    yield from (sorted(own) for own in sorted(subsets, key=lambda own: len(own ^ set(guess))))


def _on(problem: RationalProblem, rows: list[Numbers], active: list[int]) -> RationalSolution | None:
    """The solution in which exactly some segments may carry load."""
    arm, shifted = problem.lever_arm, [
        s - problem.contact * r for s, r in zip(problem.separation, problem.lever_arm, strict=True)
    ]  # fmt: skip
    system = [[*(rows[i][j] for j in active), -arm[i], -shifted[i]] for i in active]
    system.append([*(arm[j] for j in active), ZERO, problem.torque])
    reduced, pivots = reduce(system, len(active) + 1)
    if len(pivots) <= len(active):
        return None
    values = [row[-1] for row in reduced]
    if any(value < 0 for value in values[:-1]):
        return None
    force = [ZERO] * len(rows)
    for number, value in zip(active, values[:-1], strict=True):
        force[number] = value
    deflection = problem.deflection(force)
    gap = [y + s - values[-1] * r for y, s, r in zip(deflection, shifted, arm, strict=True)]
    return None if min(gap) < 0 else RationalSolution(force, values[-1], gap)


def reduce(rows: list[Numbers], columns: int) -> tuple[list[Numbers], list[int]]:
    """Return a matrix in reduced echelon form in its first columns, and the columns with a pivot."""
    rows = [list(row) for row in rows]
    pivots: list[int] = []
    for column in range(columns):
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
                rows[i] = [value - factor * own for value, own in zip(row, rows[done], strict=True)]
        pivots.append(column)
    return rows, pivots


def has_one_solution(problem: RationalProblem, found: RationalSolution) -> bool:
    """Whether no direction without moment and deflection lies in the segments whose gap is zero.

    That proves that the forces are unique; where a force among them is zero it is more than needed.
    """
    touching = [i for i, gap in enumerate(found.gap) if gap == 0]
    rows = problem.rows
    system = [[rows[i][j] for j in touching] for i in range(len(rows))]
    system.append([problem.lever_arm[j] for j in touching])
    return len(reduce(system, len(touching))[1]) == len(touching)


def is_semidefinite(problem: RationalProblem) -> bool:
    """Whether C has no negative eigenvalue: by elimination with symmetric pivots."""
    rows = [list(row) for row in problem.rows]
    left = list(range(len(rows)))
    while left:
        pivot = max(left, key=lambda i: rows[i][i])
        if rows[pivot][pivot] < 0 or min(rows[i][i] for i in left) < 0:
            return False
        if rows[pivot][pivot] == 0:
            return not any(rows[i][j] for i in left for j in left)
        left.remove(pivot)
        for i in left:
            factor = rows[i][pivot] / rows[pivot][pivot]
            if factor:
                for j in left:
                    rows[i][j] -= factor * rows[pivot][j]
    return True
