"""The verdict on an answer: certified on the problem as the user gave it, or refused."""

from __future__ import annotations

from ..problem.recovered import RecoveredAnswer
from .scaled_answer import ScaledAnswer
from .solution import ContactSolution, Status, no_solution


def judge(
    solver: str,
    answer: RecoveredAnswer,
    *,
    tolerance: float,
    iterations: int = -1,
    polished: bool = False,
    message: str = "",
    suspicion: Status | None = None,
) -> ContactSolution:
    """Return the solution that an answer is, or the record of a refusal.

    Parameters
    ----------
    solver : str
    answer : RecoveredAnswer
        In the units of the problem, with its certificate.
    tolerance : float
        What the certificate must reach.
    iterations, polished, message
        Passed on to the solution.
    suspicion : Status, optional
        The status of a refused answer; `Status.NOT_CERTIFIED` by default.
    """
    if not answer.certificate.passes(tolerance):
        return no_solution(
            answer.force.size,
            Status.NOT_CERTIFIED if suspicion is None else suspicion,
            solver,
            message=message,
            iterations=iterations,
            certificate=answer.certificate,
            tolerance=tolerance,
        )
    return ContactSolution(
        force=answer.force,
        rotation=answer.rotation,
        gap=answer.gap,
        status=Status.CERTIFIED,
        solver=solver,
        iterations=iterations,
        certificate=answer.certificate,
        elastic_rotation=answer.elastic_rotation,
        polished=polished,
        tolerance=tolerance,
        message=message,
    )


def judge_scaled(
    solver: str, answer: ScaledAnswer, result: RecoveredAnswer, tolerance: float, *, polished: bool = False
) -> ContactSolution:
    """Judge what became of an answer; iterations and words stay those of the solver that gave it."""
    return judge(
        solver,
        result,
        tolerance=tolerance,
        iterations=answer.iterations,
        polished=polished,
        message=answer.message,
        suspicion=answer.suspicion,
    )
