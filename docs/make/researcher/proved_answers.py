"""Reference answers of the library of contact problems, proved without the native solver.

An answer is the rotation beyond first contact, theta - min S/r over r > 0, which all solutions of a problem share, and
the number of segments in contact where that is determined. Two methods independent of the native solver prove it:

- the conditions on the touching segments as a linear system, solved by iterative refinement in extended precision, and
  the sign of every force and gap: what satisfies all conditions is the solution;
- Lemke's pivoting, for problems of up to ``LEMKE_SIZE_LIMIT`` segments.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from easeoff.contact import ContactProblem, solve
from easeoff.core.arrays import Bools
from easeoff.core.output_file import whole_file
from easeoff.study.library import ReferenceAnswer

Wide = NDArray[np.longdouble]

LEMKE_SIZE_LIMIT = 600
#: Segments up to which the compliance of a structured problem is formed as a matrix for a proof.
DENSE_SIZE_LIMIT = 6000
#: Force and gap over their scales below which, both, a segment may count as touching or not.
CONTACT_MARGIN = 1e-6
#: Largest force or gap of the wrong sign, over its scale.
SIGN_TOLERANCE = 1e-13
REFINEMENT_STEPS = 30


def write_answers(answers: Iterable[ReferenceAnswer], path: Path) -> None:
    """Write reference answers as a table in CSV."""
    with whole_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(ReferenceAnswer)], lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: _shown(key, value) for key, value in asdict(answer).items()} for answer in answers)


def proved_answer(name: str, problem: ContactProblem) -> ReferenceAnswer:
    """Reference answer of a problem, proved by independent methods; ArithmeticError if that is not possible."""
    solution = solve(problem, "native")
    if not solution.certified:
        raise ArithmeticError(f"{name}: {solution.status.name}")
    rotation = solution.elastic_rotation
    refined = refined_rotation(problem, solution.active)
    by_lemke = solve(problem, "lemke") if problem.size <= LEMKE_SIZE_LIMIT else None
    pivoted = by_lemke.elastic_rotation if by_lemke is not None and by_lemke.certified else math.nan
    best = next((value for value in (refined, pivoted) if math.isfinite(value)), None)
    if best is None:
        raise ArithmeticError(f"{name}: no independent method has an answer")
    scale = solution.force.max(), float(solution.force @ problem.deflection(solution.force)) / solution.force.sum()
    margin = np.maximum(solution.force / scale[0], solution.gap / scale[1]).min()
    determined = math.isfinite(refined) and margin > CONTACT_MARGIN
    touching = int(solution.active.sum()) if determined else -1
    differences = abs(rotation / refined - 1.0), abs(rotation / pivoted - 1.0)
    return ReferenceAnswer(name, problem.size, best, touching, condition_of(problem), *differences)


def refined_rotation(problem: ContactProblem, active: Bools) -> float:
    """Rotation beyond first contact in extended precision [rad], if just these segments (n) touch.

    NaN if the conditions are singular, or another force or gap has a sign wrong by more than ``SIGN_TOLERANCE``.
    """
    touching = np.flatnonzero(active)
    arm, separation = problem.lever_arm.astype(np.longdouble), problem.separation.astype(np.longdouble)
    positive = arm > 0.0
    separation = separation - (separation[positive] / arm[positive]).min() * arm
    torque = np.longdouble(problem.torque)
    lever = problem.lever_arm[touching]
    stiff, long = float(problem.compliance_diagonal[touching].mean()), float(np.abs(lever).mean())
    force_unit, angle_unit = problem.torque / long, problem.torque * stiff / long**2
    correct = bordered_solver(problem, touching, stiff, lever / long)
    if correct is None:
        return math.nan
    force, rotation = np.zeros(problem.size, dtype=np.longdouble), np.longdouble(0.0)
    last = math.inf
    for _ in range(REFINEMENT_STEPS):
        gap = _deflection(problem, force) + separation - rotation * arm
        missing = np.r_[-gap[touching] / (stiff * force_unit), (torque - arm @ force) / torque]
        step = correct(missing.astype(np.float64))
        force[touching] += step[:-1] * np.longdouble(force_unit)
        rotation += step[-1] * np.longdouble(angle_unit)
        size = float(np.abs(step).max() / max(np.abs(force).max() / force_unit, abs(rotation) / angle_unit))
        if not size < 0.1 * last:
            break
        last = size
    gap = _deflection(problem, force) + separation - rotation * arm
    gap_scale = float(force @ _deflection(problem, force) / force.sum())
    residual = float(np.abs(gap[touching]).max())
    wrong = max(-float(force.min() / force.max()), (residual - min(float(gap.min()), 0.0)) / gap_scale)
    return float(rotation) if wrong <= SIGN_TOLERANCE else math.nan


def bordered_solver(
    problem: ContactProblem, touching: NDArray[np.intp], stiff: float, arm: NDArray[np.float64]
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]] | None:
    """Function that solves the conditions on the touching segments (m) for a right side; None where singular.

    The matrix is [C/stiff, -arm; arm', 0], ``stiff`` the unit of compliance [mm/N]. That of a large structured problem
    is not formed: with C = D + V V', Woodbury's identity leaves a system of the size of the modes.
    """
    if problem.size <= DENSE_SIZE_LIMIT or not isinstance(problem.compliance, tuple):
        matrix = problem.dense_compliance[np.ix_(touching, touching)] / stiff
        factors, pivots, singular = dgetrf(np.block([[matrix, -arm[:, None]], [arm[None], np.zeros((1, 1))]]))
        return None if singular else lambda right: np.asarray(dgetrs(factors, pivots, right)[0])
    local, factor = problem.compliance[0][touching] / stiff, problem.compliance[1][touching] / math.sqrt(stiff)
    if not local.min() > 0.0:
        return None
    core = np.eye(factor.shape[1]) + factor.T @ (factor / local[:, None])

    def inverse(right: NDArray[np.float64]) -> NDArray[np.float64]:
        """The matrix C/stiff of the touching segments solved for a right side."""
        return np.asarray((right - factor @ np.linalg.solve(core, factor.T @ (right / local))) / local)

    turned = inverse(arm)
    border = float(arm @ turned)

    def correct(right: NDArray[np.float64]) -> NDArray[np.float64]:
        free = inverse(right[:-1])
        rotation = (right[-1] - float(arm @ free)) / border
        return np.append(free + rotation * turned, rotation)

    return correct


def condition_of(problem: ContactProblem) -> float:
    """Condition number of the compliance of a problem: of a large structured one by Lanczos' method, to four digits."""
    if problem.size <= DENSE_SIZE_LIMIT or not isinstance(problem.compliance, tuple):
        return condition_number(problem.dense_compliance)
    from scipy.sparse.linalg import LinearOperator, eigsh

    local, factor = problem.compliance
    core = np.eye(factor.shape[1]) + factor.T @ (factor / local[:, None])
    start = np.cos(np.arange(problem.size))

    def inverse(right: Any) -> Any:
        return (right - factor @ np.linalg.solve(core, factor.T @ (right / local))) / local

    def greatest(form: Callable[[Any], Any]) -> float:
        operator = LinearOperator((problem.size,) * 2, form, dtype=np.float64)
        return float(eigsh(operator, 1, v0=start, tol=1e-4)[0][0])

    return greatest(problem.deflection) * greatest(inverse)


def condition_number(compliance: NDArray[np.float64]) -> float:
    """Condition number of a compliance: greatest over least eigenvalue, infinite where the least is rounding."""
    eigenvalues = np.linalg.eigvalsh(compliance)
    floor = np.finfo(float).eps * compliance.shape[0] * eigenvalues[-1]
    return float(eigenvalues[-1] / eigenvalues[0]) if eigenvalues[0] > 10.0 * floor else math.inf


def _deflection(problem: ContactProblem, force: Wide) -> Wide:
    """C F in extended precision, without the columns of unloaded segments."""
    loaded = np.flatnonzero(force)
    if isinstance(problem.compliance, tuple):
        diagonal, factor = problem.compliance
        modes = factor[loaded].astype(np.longdouble)
        return np.asarray(diagonal * force + factor.astype(np.longdouble) @ (force[loaded] @ modes))
    return np.asarray(problem.compliance[:, loaded].astype(np.longdouble) @ force[loaded])


def _shown(key: str, value: Any) -> Any:
    """Value as the table shows it: rotations with all digits, others with two."""
    if isinstance(value, float):
        return repr(value) if key == "elastic_rotation" else f"{value:.1e}" if math.isfinite(value) else str(value)
    return value
