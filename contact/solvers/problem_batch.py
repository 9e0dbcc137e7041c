"""Many problems at once: the native solver on arrays of problems, every answer certified as by `solve`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import field
from time import perf_counter
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.arrays import Bools, Integers, RealArray as Array, record
from ...core.checks import array, instance, shown
from ...core.errors import InputError
from ..problem.certificate import EXACT_TOLERANCE, RESOLUTION_LIMIT, Certificate, with_certificate
from ..problem.contact_problem import ContactProblem
from .compiled.compiled_answer import linear_answers
from .registry import ROUNDING_LEVEL, as_mask, compiled_solution, solve
from .solution import ContactSolution, Status, judged, no_solution


@record(frozen=True, eq=False)
class ContactSolutions:
    """Solutions of problems that differ in separations and torques alone, in arrays; a row is a problem.

    Attributes
    ----------
    force
        Normal forces (b, n) [N]; NaN in rows that are not certified.
    rotation
        Rotation of the gear (b) [rad].
    gap
        Gaps left under load (b, n) [mm].
    elastic_rotation
        Rotation beyond the first contact of the rigid bodies (b) [rad].
    certificate
        The five violations of `Certificate` in their order (b, 5).
    status
        Numbers of `Status` (b).
    iterations
        Steps of the solver (b); -1 if unknown.
    problem, separation, torque
        The problem whose lever arms and compliance all share, and what they differ in (b, n) [mm] and (b) [N mm].

    Notes
    -----
    `solutions[row]`, and those that come one after the other, are a `ContactSolution` each, certified anew.

    Examples
    --------
    >>> import numpy as np
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, (np.full(2, 1e-6), np.zeros((2, 1))))
    >>> solutions = solve_many(springs, torque=[8.0e4, 4.0e4])
    >>> solutions.force.tolist(), solutions.certified.all().item()
    ([[1000.0, 1000.0], [500.0, 500.0]], True)
    >>> [round(solution.rotation * 1e6, 6) for solution in solutions]
    [25.0, 12.5]
    """

    force: Array
    rotation: Array
    gap: Array
    elastic_rotation: Array
    certificate: Array
    status: NDArray[np.int8]
    iterations: Integers
    problem: ContactProblem = field(repr=False)
    separation: Array = field(repr=False)
    torque: Array = field(repr=False)

    @property
    def certified(self) -> Bools:
        """True for each answer that is proved (b)."""
        return np.asarray(self.status == Status.CERTIFIED)

    def __len__(self) -> int:
        """Number of problems."""
        return self.status.size

    def __getitem__(self, row: int) -> ContactSolution:
        """Solution of one problem."""
        status, steps = Status(int(self.status[row])), int(self.iterations[row])
        if status is Status.CERTIFIED:
            posed = problem_of_row(self.problem, self.separation[row], self.torque[row])
            answer = with_certificate(posed, self.force[row], float(self.elastic_rotation[row]))
            return judged("native", answer, tolerance=EXACT_TOLERANCE, iterations=steps)
        certificate = Certificate(*self.certificate[row].tolist())
        return no_solution(self.problem.size, status, "native", iterations=steps, certificate=certificate)

    def __iter__(self) -> Iterator[ContactSolution]:
        """Solutions of the problems in turn."""
        return (self[row] for row in range(len(self)))


@overload
def solve_many(
    problems: Iterable[ContactProblem], *, initial_active: Iterable[ArrayLike | None] | None = None
) -> list[ContactSolution]: ...


@overload
def solve_many(
    problems: ContactProblem, *, separation: ArrayLike | None = None, torque: ArrayLike | None = None
) -> ContactSolutions: ...


def solve_many(
    problems: Iterable[ContactProblem] | ContactProblem,
    *,
    initial_active: Iterable[ArrayLike | None] | None = None,
    separation: ArrayLike | None = None,
    torque: ArrayLike | None = None,
) -> list[ContactSolution] | ContactSolutions:
    """Solve contact problems with the native solver, many at once.

    Parameters
    ----------
    problems
        Problems of any size and form, also a generator of them; or one problem, whose lever arms and compliance are
        shared by all.
    initial_active
        Warm start of each of several problems, see `solve`.
    separation
        With one problem: separations of all (b, n) [mm], or one row (n) for all; by default those of the problem.
    torque
        With one problem: torques of all (b) [N mm], or one number; by default that of the problem.

    Returns
    -------
    list of ContactSolution
        In the order of the problems; what `solve` gives for each, up to rounding.
    ContactSolutions
        Where one problem was given.

    Raises
    ------
    InputError
        What was given are no problems; as many warm starts as problems were not given, or one has the wrong shape;
        arrays of different lengths, or numbers that no contact problem can have.

    Examples
    --------
    >>> import numpy as np
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, (np.full(2, 1e-6), np.zeros((2, 1))))
    >>> [solution.force[0].item() for solution in solve_many([springs, springs.with_torque(4.0e4)])]
    [1000.0, 500.0]
    >>> solve_many(springs, separation=[[0.0, 0.0], [0.0, 1.0]], torque=[8.0e4, 4.0e4]).force.tolist()
    [[1000.0, 1000.0], [1000.0, 0.0]]
    """
    if isinstance(problems, ContactProblem):
        if initial_active is not None:
            raise InputError("initial_active: must not be given with arrays of separations and torques")
        return _solve_rows(problems, separation, torque)
    if separation is not None or torque is not None:
        raise InputError("separation, torque: must be given with one problem, not with a sequence of problems")
    given: Any = problems
    problems = list(given) if isinstance(given, Iterable) and getattr(given, "ndim", True) else [given]
    for problem in problems:
        instance("problems", problem, ContactProblem)
    if not (initial_active is None or isinstance(initial_active, Iterable)):
        raise InputError(f"initial_active = {shown(initial_active)}: must be sets of segments, one a problem, or None")
    starts = [None] * len(problems) if initial_active is None else list(initial_active)
    if len(starts) != len(problems):
        raise InputError(f"initial_active = {len(starts)} sets: must be {len(problems)}, one a problem")
    known = [None if start is None else as_mask(start, p.size) for p, start in zip(problems, starts, strict=True)]
    solutions = []
    for problem, active in zip(problems, known, strict=True):
        compiled = compiled_solution(problem, active, perf_counter())
        solutions.append(solve(problem, initial_active=active) if compiled is None else compiled)
    return solutions


def _solve_rows(problem: ContactProblem, separation: ArrayLike | None, torque: ArrayLike | None) -> ContactSolutions:
    """Solve a problem with other separations and torques."""
    gaps = array("separation", problem.separation if separation is None else separation, "mm")
    moments = array("torque", problem.torque if torque is None else torque, "N mm", least=0.0)
    if gaps.ndim not in (1, 2) or gaps.shape[-1] != problem.size or moments.ndim > 1:
        raise InputError(
            f"separation, torque = arrays of shapes {gaps.shape}, {moments.shape}: "
            f"must have the shapes (b, {problem.size}) and (b)"
        )
    counts = {*gaps.shape[:-1], *moments.shape}
    if len(counts) > 1:
        raise InputError(f"separation, torque = {len(gaps)} rows, {moments.size} numbers: must be as many of both")
    count = counts.pop() if counts else 1
    gaps = np.ascontiguousarray(np.broadcast_to(gaps, (count, problem.size)))
    moments = np.ascontiguousarray(np.broadcast_to(moments, (count,)))
    force, gap = np.full((2, count, problem.size), np.nan)
    numbers, status = np.full((count, 7), np.nan), np.full(count, Status.NOT_CONVERGED, dtype=np.int8)
    steps, proved = np.full(count, -1), np.zeros(count, dtype=np.bool_)
    if (together := linear_answers(problem, gaps, moments)) is not None:
        force, gap, numbers, ended = together
        violations, resolution, numbers = numbers[:, 2:7], numbers[:, 7], numbers[:, :7]
        steps = ended[:, 0].copy()
        proved = (ended[:, 1] == 1) & (moments > 0.0) & (violations.max(axis=1) <= ROUNDING_LEVEL)
        proved &= resolution <= RESOLUTION_LIMIT
        status[proved] = Status.CERTIFIED
    others = np.flatnonzero(~proved)
    rest = [problem_of_row(problem, gaps[row], moments[row]) for row in others]
    for row, solution in zip(others, solve_many(rest), strict=True):
        force[row], gap[row], steps[row], status[row] = (
            solution.force, solution.gap, solution.iterations, solution.status,
        )  # fmt: skip
        numbers[row] = solution.rotation, solution.elastic_rotation, *solution.certificate.violations
    for rows in (force, gap):
        rows.setflags(write=False)  # else they would be copied
    return ContactSolutions(
        force, numbers[:, 0].copy(), gap, numbers[:, 1].copy(), numbers[:, 2:].copy(), status, steps,
        problem, gaps, moments,
    )  # fmt: skip


def problem_of_row(problem: ContactProblem, separation: Array, torque: float) -> ContactProblem:
    """Return a problem with other separations (n) [mm] and another torque [N mm]."""
    return ContactProblem(separation, problem.lever_arm, float(torque), problem.compliance_matrix)
