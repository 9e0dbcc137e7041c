"""Answers of Newton's method in the bending modes, certified on the problem as it was given; none where it has none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....core.arrays import Bools, Integers, RealArray as Array
from ....core.kernels import kernel
from ...problem.certificate import RESOLUTION_LIMIT, Answer, Certificate, with_certificate
from ...problem.compliance_matrix import ComplianceMatrix, DenseCompliance, ModalCompliance
from ...problem.contact_problem import ContactProblem
from ...problem.modal_basis import ModalBasis, ModeColumns
from ...problem.scaled_problem import ScaledProblem

solve_batch = kernel(".newton_kernel", __package__).solve_batch
solve_dense = kernel(".dense_kernel", __package__).solve_dense

#: Smallest local compliance for which the method is tried, relative to the whole compliance of a segment: digits are
#: lost, and iterations gained, in the ratio of the two.
SMALLEST_LOCAL_FRACTION = 1e-4

#: Most segments with which the active set of a dense matrix is found here: beyond, LAPACK's factors are faster.
LARGEST_DENSE = 300
#: Most segments with which diag(d) + V V^T is formed for it, if V has as many columns: beyond, few modes cost less.
LARGEST_FORMED = 100

_NO_FACTOR, _NO_MASK, _NO_LAW = np.empty(0), np.empty((0, 0), dtype=np.uint8), np.empty((0, 14))


class CompiledAnswer(NamedTuple):
    """An answer, the number of steps, and wall times [s].

    For line contacts their secant compliance (n) [mm/N], and the torque that turns the gear by one radian [N mm/rad].
    """

    answer: Answer
    iterations: int
    secant: Array
    stiffness: float = math.nan
    setup_time: float = math.nan
    solve_time: float = math.nan


def linear_answer(problem: ContactProblem, active: Bools | None = None) -> CompiledAnswer | None:
    """Solve a contact problem of given compliance.

    Parameters
    ----------
    problem
        Of any form.
    active
        Segments assumed in contact (n).

    Returns
    -------
    CompiledAnswer or None
        None where the method cannot be used or did not end.
    """
    matrix = problem.compliance_matrix
    if not isinstance(matrix, ModalCompliance) or not problem.torque > 0.0:
        return None
    if not matrix.local_fraction > SMALLEST_LOCAL_FRACTION:
        return None
    begin, columns = perf_counter(), matrix.modes.columns
    ready = perf_counter()
    mask = _NO_MASK if active is None else active[np.newaxis].view(np.uint8)
    force, gap, _, numbers, counts = _solved(
        columns, np.array([problem.torque]), problem.separation[np.newaxis], problem.lever_arm, matrix.local,
        matrix.diagonal, mask=mask, factor=_given_factor(matrix),
    )  # fmt: skip
    steps, ended = counts[0].tolist()
    if not ended:
        return None
    ended_at = perf_counter()
    times = ready - begin, ended_at - ready
    return CompiledAnswer(answer_of(problem, force[0], gap[0], numbers[0]), steps, _NO_FACTOR, math.nan, *times)


def is_small(matrix: ComplianceMatrix, size: int) -> bool:
    """True if the active set of a dense matrix is the fastest method: of one that was given, or formed of few rows."""
    if isinstance(matrix, ModalCompliance):
        return not isinstance(matrix.modes, ModalBasis) and size <= min(LARGEST_FORMED, matrix.factor.shape[1])
    return isinstance(matrix, DenseCompliance) and size <= LARGEST_DENSE


def dense_answer(problem: ContactProblem, active: Bools | None = None) -> CompiledAnswer | None:
    """Solve a contact problem with a small matrix by the active set, see `linear_answer` and `is_small`."""
    matrix, size = problem.compliance_matrix, problem.size
    if not problem.torque > 0.0:
        return None
    begin = perf_counter()
    if not matrix.is_positive_semidefinite:
        return None
    dense, columns = matrix.dense, matrix.factor.shape[1] if isinstance(matrix, ModalCompliance) else 0
    room, places = np.empty((size + 4) * (size + 9)), np.empty(2 * size, dtype=np.int64)
    force, gap, numbers = np.empty(size), np.empty(size), np.empty(10)
    if active is not None:
        places[:size] = active
    ready = perf_counter()
    steps = solve_dense(
        dense.reshape(-1), columns, problem.torque, problem.separation, problem.lever_arm, active is not None, room,
        places, force, gap, numbers,
    )  # fmt: skip
    if not steps:
        return None
    times = ready - begin, perf_counter() - ready
    return CompiledAnswer(answer_of(problem, force, gap, numbers), steps, _NO_FACTOR, math.nan, *times)


def scaled_answer(problem: ScaledProblem, active: Bools) -> tuple[Array, float, int] | None:
    """Solve a scaled problem: forces (n), rotation and steps; None where the method cannot be used or did not end.

    Parameters
    ----------
    problem
        The scaled problem.
    active
        Segments assumed in contact (n).
    """
    modal = problem.modal
    if modal is None or not modal.compliance.local_fraction > SMALLEST_LOCAL_FRACTION:
        return None
    force, _, _, numbers, counts = _solved(
        modal.basis.columns, np.array([problem.torque]), problem.separation[np.newaxis], problem.lever_arm,
        modal.diagonal, modal.whole_diagonal, mask=active[np.newaxis].view(np.uint8),
    )  # fmt: skip
    steps, ended = counts[0].tolist()
    return (force[0], float(numbers[0, 0]), steps) if ended else None


def linear_answers(problem: ContactProblem, separation: Array, torque: Array) -> tuple[Array, Array, Array, Any] | None:
    """Solve a contact problem with other separations (b, n) and torques (b).

    Returns
    -------
    tuple or None
        Forces and gaps (b, n); rotation, elastic rotation, the numbers of the certificate and one that is NaN (b, 10);
        steps and whether the method ended (b, 2). None where the method cannot be used.
    """
    matrix = problem.compliance_matrix
    if not isinstance(matrix, ModalCompliance) or not matrix.has_few_modes:
        return None
    if not matrix.local_fraction > SMALLEST_LOCAL_FRACTION:
        return None
    force, gap, _, numbers, counts = _solved(
        matrix.modes.columns, torque, separation, problem.lever_arm, matrix.local, matrix.diagonal,
        factor=_given_factor(matrix),
    )  # fmt: skip
    return force, gap, numbers, counts


def line_contact_answers(bendings: Sequence[ContactProblem], law: Array) -> list[CompiledAnswer | None]:
    """Solve contact problems of the same segments with load-dependent line contact at several torques.

    Parameters
    ----------
    bendings
        With the compliance of bending alone; they differ in their torque.
    law
        Parameters of the line contacts (n, 14), see `WeberLineContact.parameters`.

    Returns
    -------
    list
        An answer each, None as of `linear_answer`; the certificate is that of the linear problem with the secant
        compliance.
    """
    first = bendings[0]
    basis, torque = first.modal_basis, np.array([one.torque for one in bendings])
    if basis is None or not torque.min() > 0.0:
        return [None] * len(bendings)
    separation = np.repeat(first.separation[np.newaxis], torque.size, axis=0)
    force, gap, secant, numbers, counts = _solved(
        basis.columns, torque, separation, first.lever_arm, first.separation, first.separation, law=law
    )
    answers: list[CompiledAnswer | None] = []
    for b, (steps, ended) in enumerate(counts.tolist()):
        if not ended:
            answers.append(None)
            continue
        answer = answer_of(bendings[b].with_secant(secant[b]), force[b], gap[b], numbers[b])
        answers.append(CompiledAnswer(answer, steps, secant[b], float(numbers[b, 9])))
    return answers


def answer_of(problem: ContactProblem, force: Array, gap: Array, numbers: Array) -> Answer:
    """Return an answer from forces and gaps (n) and the numbers (10) that the compiled code has of it.

    Where that has bounded the rounding of its certificate too roughly, the certificate is evaluated anew.
    """
    rotation, elastic, *entries, _stiffness = numbers.tolist()
    certificate = Certificate(*entries)
    if not certificate.resolution <= RESOLUTION_LIMIT and certificate.worst <= RESOLUTION_LIMIT:
        return with_certificate(problem, force, elastic)
    return Answer(force, rotation, gap, elastic, certificate, problem)


def _given_factor(matrix: ModalCompliance) -> Array:
    """V row by row where it was given so (n k): the proof is on it; empty for modes that were given compressed."""
    return _NO_FACTOR if isinstance(matrix.modes, ModalBasis) else matrix.factor.reshape(-1)


def _solved(
    modes: ModeColumns, torque: Array, separation: Array, arm: Array, local: Array, diagonal: Array, *,
    law: Array = _NO_LAW, mask: NDArray[np.uint8] = _NO_MASK, factor: Array = _NO_FACTOR,
) -> tuple[Array, Array, Array, Array, Integers]:  # fmt: skip
    """Results of `solve_batch`: forces, gaps, secant compliances of line contacts, numbers and counts."""
    shape = separation.shape
    results = np.empty(shape), np.empty(shape), np.empty(shape if law.size else (0, 0)), np.empty((shape[0], 10))
    counts = np.empty((shape[0], 2), dtype=np.int64)
    solve_batch(tuple(modes), factor, torque, separation, arm, local, diagonal, law, mask, *results, counts)
    return *results, counts
