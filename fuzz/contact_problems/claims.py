"""Judgement of what is claimed about drawn contact problems: certificates, bounds of errors, other statuses."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
from easeoff.contact import ContactProblem, ContactSolution, Status, certify, solve, solve_many
from easeoff.contact.problem.certificate import EXACT_TOLERANCE, resolved_rotation
from easeoff.contact.problem.conditioning import is_unbounded

from .drawn_problem import drawn_problem
from .rational_solution import RationalProblem, has_one_solution, is_semidefinite, solution

#: Methods of the native solver, one a seed.
METHODS: tuple[dict[str, Any], ...] = ({}, {"method": "primal_dual_active_set"}, {"method": "primal_active_set"})
#: One seed of so many is solved in rational numbers, up to so many segments.
SOLVED_SHARE, SOLVED_SIZE = 5, 6
#: The scales of the rational residuals are doubles.
ROUNDING = 1.0 + 1e-9


def judge(seed: int) -> tuple[str, list[str]]:
    """Return what a seed was, and what was claimed falsely about it.

    Parameters
    ----------
    seed
        Of the problem. A part of them is solved in rational numbers.
    """
    name, problem = drawn_problem(seed)
    exact = RationalProblem.of(problem)
    found = solve(problem, **METHODS[seed % len(METHODS)]) if seed % 2 else solve(problem)
    faults = _residual_faults(exact, problem, found, seed)
    if problem.is_structured:
        faults += _batch_faults(exact, problem)
    what = f"{name} {found.status.name}"
    if seed % SOLVED_SHARE == 0 and problem.size <= SOLVED_SIZE and problem.torque > 0.0:
        faults += _solution_faults(exact, problem, found)
        what += f", solved, unique {found.conditioning.unique}" if found.certified else ", solved"
    if found.status is Status.NOT_POSITIVE_SEMIDEFINITE and is_semidefinite(exact):
        faults.append("the compliance is said to have a negative eigenvalue, and has none")
    return what, faults


def _residual_faults(exact: RationalProblem, problem: ContactProblem, found: ContactSolution, seed: int) -> list[str]:
    """What certificates claim falsely: of the answer, of its rotation as one double, and of answers that are wrong."""
    faults = []
    force, rotation, elastic = found.answer.force, found.answer.rotation, found.answer.elastic_rotation
    if found.certified:
        worst = exact.worst_violation(force, Fraction(elastic))
        if not worst <= EXACT_TOLERANCE * ROUNDING:
            faults.append(f"certified at {found.certificate.worst:.1e}, violation {worst:.1e}")
        if not worst <= (found.certificate.worst + found.certificate.resolution) * ROUNDING:
            faults.append(f"violation {worst:.1e}, said to be {found.certificate}")
        if problem.lever_arm.min() < 0.0 and is_unbounded(problem):
            faults.append("certified, and there is no minimum")
    if not (np.isfinite(force).all() and math.isfinite(rotation)):
        return faults
    if problem.torque > 0.0 and certify(problem, force, rotation).passes():
        resolved = resolved_rotation(problem, force, rotation, problem.deflection(force))
        off = abs(exact.contact + Fraction(resolved) - Fraction(rotation))
        if float(off) > 0.5 * math.ulp(rotation) * ROUNDING + 1e-15 * abs(resolved):
            faults.append(f"rotation certified that is {float(off):.1e} from the one given")
        worst = exact.worst_violation(force, Fraction(resolved))
        if not worst <= EXACT_TOLERANCE * ROUNDING:
            faults.append(f"rotation in one double certified, violation {worst:.1e}")
    rng = np.random.default_rng([20, seed])
    size = 10.0 ** rng.uniform(-17.0, -7.0)
    wrong = force * (1.0 + size * rng.standard_normal(force.size))
    turned = elastic * (1.0 + size * float(rng.standard_normal()) * float(rng.integers(0, 2)))
    if certify(problem, wrong, problem.whole_rotation(turned), turned).passes():
        worst = exact.worst_violation(wrong, Fraction(turned))
        if not worst <= EXACT_TOLERANCE * ROUNDING:
            faults.append(f"wrong answer certified, violation {worst:.1e}")
    return faults


def _batch_faults(exact: RationalProblem, problem: ContactProblem) -> list[str]:
    """What is claimed falsely where the problem is solved as one of a batch."""
    rows = solve_many(problem, separation=[problem.separation], torque=[problem.torque])
    if not rows.certified[0]:
        return []
    worst = exact.worst_violation(rows.force[0], Fraction(rows.elastic_rotation[0]))
    return [] if worst <= EXACT_TOLERANCE * ROUNDING else [f"certified in a batch, violation {worst:.1e}"]


def _solution_faults(exact: RationalProblem, problem: ContactProblem, found: ContactSolution) -> list[str]:
    """What is claimed falsely about the solution itself."""
    if not is_semidefinite(exact):
        return []  # to rounding alone: its conditions may have several rotations
    right = solution(exact, np.flatnonzero(np.nan_to_num(found.answer.force) > 0.0).tolist())
    if right is None:
        return ["certified, and there is no solution"] if found.certified else []
    if found.status in (Status.UNBOUNDED, Status.INFEASIBLE):
        return [f"said to be {found.status.name}, and there is a solution"]
    if not found.certified:
        return []
    faults, known = [], found.conditioning
    if known.unique and not has_one_solution(exact, right):
        faults.append("forces said to be unique, and other forces may do")
    if known.unique:
        for number, force in enumerate(right.force):
            error = abs(Fraction(found.force[number]) - force)
            if error and not float(error) <= known.force_error[number]:
                faults.append(f"force {number} wrong by {float(error):.1e}, bound {known.force_error[number]:.1e}")
    error = abs(Fraction(found.elastic_rotation) - right.rotation)
    if error and not float(error) <= known.rotation_error:
        faults.append(f"rotation wrong by {float(error):.1e}, bound {known.rotation_error:.1e}")
    if any(right.gap[i] == 0 or right.force[i] > 0 for i in np.flatnonzero(~known.may_touch)):
        faults.append("a segment said to be open touches")
    return faults
