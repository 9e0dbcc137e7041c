"""Contact with load-dependent line contact at many mesh positions and torques, by Newton's method in the bending modes.

That method asks for a force at an indentation, the line contact gives the indentation for a force: it is inverted
segment by segment, see ``line_deflection``. As its compliance falls with the load, the deflection is a concave function
of the force: Newton's method on it comes from below after the first step, and never overshoots.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ...core.arrays import RealArray as Array
from ..compliance.weber_line_contact import WeberLineContact
from ..problem.certificate import EXACT_TOLERANCE
from ..problem.contact_problem import ContactProblem
from ..solvers import ContactSolution, SolverChoice
from ..solvers.compiled.compiled_answer import CompiledAnswer, line_contact_answers
from ..solvers.registry import chosen_solver
from ..solvers.solution import judged
from ..solvers.solver_declaration import ChosenSolver
from .line_contact_solution import solve_on_bending

_Found = tuple[ContactSolution, ContactProblem]


def solve_at_torques(
    bendings: Sequence[ContactProblem],
    contacts: Sequence[WeberLineContact],
    torques: Array,
    solver: SolverChoice = "auto",
    **options: Any,
) -> Iterator[list[_Found]]:
    """Solutions at rising torques (t) [N mm], each from the one before; the torque of the problems is of no account."""
    solver = chosen_solver(solver)
    at_torques = [[one.with_torque(torque) for one in bendings] for torque in torques.tolist()]
    known: list[list[_Found | None]] = [[None] * len(at_torques)] * len(bendings)
    if solver.is_native and not options:
        by_problem = zip(*at_torques, strict=True)
        known = [_compiled_answers(series, contact) for series, contact in zip(by_problem, contacts, strict=True)]
    starts: list[Array | None] = [None] * len(bendings)
    for number, problems in enumerate(at_torques):
        found = [answers[number] for answers in known]
        solved = list(_completed(problems, contacts, starts, found, solver, **options))
        starts = [solution.force if solution.certified else None for solution, _ in solved]
        yield solved


def solve_line_contacts(
    bendings: Sequence[ContactProblem],
    contacts: Sequence[WeberLineContact],
    starts: Sequence[Array | None],
    solver: SolverChoice = "auto",
    **options: Any,
) -> Iterator[_Found]:
    """Solve contact problems with load-dependent line contact, and prove the answers; one result a problem.

    Linear programmes solve what the native solver without options leaves uncertified, and all of other solvers.
    ``bendings`` have bending compliance alone and a positive torque; ``starts`` are forces (n) [N].
    """
    known: Sequence[_Found | None] = [None] * len(bendings)
    solver = chosen_solver(solver)
    if solver.is_native and not options and len(bendings) > 0:
        known = [_compiled_answers([one], contact)[0] for one, contact in zip(bendings, contacts, strict=True)]
    yield from _completed(bendings, contacts, starts, known, solver, **options)


def _completed(
    bendings: Sequence[ContactProblem],
    contacts: Sequence[WeberLineContact],
    starts: Sequence[Array | None],
    known: Sequence[_Found | None],
    solver: ChosenSolver,
    **options: Any,
) -> Iterator[_Found]:
    """Answers that are known, and those of the other problems, solved one by one."""
    for bending, contact, start, answer in zip(bendings, contacts, starts, known, strict=True):
        yield answer or solve_on_bending(bending, contact, solver, initial_force=start, **options)


def _compiled_answers(bendings: Sequence[ContactProblem], contact: WeberLineContact) -> list[_Found | None]:
    """Answers of the compiled method at several torques, which needs no start; None where it has no certified one."""
    return [
        None if outcome is None or not outcome.answer.certificate.passes(EXACT_TOLERANCE) else _judged(bending, outcome)
        for bending, outcome in zip(bendings, line_contact_answers(bendings, contact.parameters), strict=True)
    ]


def _judged(bending: ContactProblem, found: CompiledAnswer) -> _Found:
    solution = judged(
        "native",
        found.answer,
        tolerance=EXACT_TOLERANCE,
        iterations=found.iterations,
        method="modal",
        message=f"modal Newton's method on the line contacts themselves, {found.iterations} steps",
        stiffness=found.stiffness,
    )
    return solution, found.answer.problem or bending.with_secant(found.secant)
