"""Problem changes: degenerate and badly conditioned problems made from real ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ...contact.problem.contact_problem import ContactProblem
from ...contact.solvers import solve
from .library_entries import PINION_LAG

Array = NDArray[np.float64]


def parts(problem: ContactProblem) -> tuple[Array, Array, float, Array, Array]:
    """Separation, lever arm, torque, local compliance and factor of a structured problem."""
    assert isinstance(problem.compliance, tuple)
    return problem.separation, problem.lever_arm, problem.torque, *problem.compliance


def zero_separation(problem: ContactProblem, _: float) -> ContactProblem:
    """All segments touch without load: S = 0."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(np.zeros_like(s), r, t, (d, v))


def tied_separations(problem: ContactProblem, step: float) -> ContactProblem:
    """Separations rounded to multiples of a step [mm]."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(step * np.round(s / step), r, t, (d, v))


def next_contact(problem: ContactProblem, _: float) -> ContactProblem:
    """Torque at which the next segment enters or leaves contact: F = Y = 0 there.

    Not below the problem's own. As long as the same segments touch, forces, gaps and rotation are linear in the torque.
    """
    active = solve(problem, "native").active
    touching = np.flatnonzero(active)
    arm, matrix = problem.lever_arm, problem.dense_compliance
    bordered = np.block(
        [
            [matrix[np.ix_(touching, touching)], -arm[touching, None]],
            [arm[None, touching], np.zeros((1, 1))],
        ]
    )
    rate = np.linalg.solve(bordered, np.r_[np.zeros(touching.size), 1.0])
    now = np.linalg.solve(bordered, np.r_[-problem.separation_at_first_contact[touching], problem.torque])
    force, force_rate = now[:-1], rate[:-1]
    gap = matrix[:, touching] @ force + problem.separation_at_first_contact - now[-1] * arm
    gap_rate = matrix[:, touching] @ force_rate - rate[-1] * arm
    level = np.where(active, 0.0, gap)
    slope = np.where(active, 0.0, gap_rate)
    level[touching], slope[touching] = force, force_rate
    falling = slope < 0.0
    if not falling.any():
        return problem
    return problem.with_torque(problem.torque + float((-level[falling] / slope[falling]).min()))


def scaled_torque(problem: ContactProblem, factor: float) -> ContactProblem:
    """Torque multiplied by a factor."""
    return problem.with_torque(factor * problem.torque)


def remote_segment(problem: ContactProblem, distance: float) -> ContactProblem:
    """Last segment farther away by a distance [mm]."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(np.r_[s[:-1], s[-1] + distance], r, t, (d, v))


def shifted_rotation(problem: ContactProblem, rotation: float) -> ContactProblem:
    """Rotation counted from another zero [rad]."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(s + rotation * r, r, t, (d, v))


def scaled_local_compliance(problem: ContactProblem, factor: float) -> ContactProblem:
    """Local compliance multiplied by a factor."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(s, r, t, (factor * d, v))


def twin_segments(problem: ContactProblem, _: float) -> ContactProblem:
    """Every segment twice at the same point, each with a local compliance of its own."""
    s, r, t, d, v = parts(problem)
    twice = np.repeat(np.arange(problem.size), 2)
    return ContactProblem(s[twice], r[twice], t, (d[twice], v[twice]))


def copied_segments(problem: ContactProblem, _: float) -> ContactProblem:
    """Every segment twice with the same row of C: singular."""
    s, r, t, _d, _v = parts(problem)
    twice = np.repeat(np.arange(problem.size), 2)
    return ContactProblem(s[twice], r[twice], t, problem.dense_compliance[np.ix_(twice, twice)])


def copied_tooth_pairs(problem: ContactProblem, _: float) -> ContactProblem:
    """Every tooth pair twice, each with bending of its own."""
    s, r, t, d, v = parts(problem)
    nothing = np.zeros_like(v)
    return ContactProblem(np.tile(s, 2), np.tile(r, 2), t, (np.tile(d, 2), np.block([[v, nothing], [nothing, v]])))


def several_pinions(problem: ContactProblem, count: float) -> ContactProblem:
    """Several pinions on one gear, each 20 urad behind the one before."""
    s, r, t, d, v = parts(problem)
    number = int(count)
    separation = np.concatenate([s + lag * PINION_LAG * r for lag in range(number)])
    factor = np.kron(np.eye(number), v)
    return ContactProblem(separation, np.tile(r, number), number * t, (np.tile(d, number), factor))


def rigid_segment(problem: ContactProblem, _: float) -> ContactProblem:
    """No local compliance of the segment with the greatest force."""
    s, r, t, d, v = parts(problem)
    d = d.copy()
    d[np.argmax(solve(problem, "native").force)] = 0.0
    return ContactProblem(s, r, t, (d, v))


def rigid_half(problem: ContactProblem, _: float) -> ContactProblem:
    """No local compliance of every other segment."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(s, r, t, (np.where(np.arange(s.size) % 2 == 0, d, 0.0), v))


def no_local_compliance(problem: ContactProblem, _: float) -> ContactProblem:
    """No local compliance: C = V V^T, of low rank."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(s, r, t, (np.zeros_like(d), v))


def single_segment(problem: ContactProblem, _: float) -> ContactProblem:
    """Segment with the greatest force alone."""
    s, r, t, d, v = parts(problem)
    one = [int(np.argmax(solve(problem, "native").force))]
    return ContactProblem(s[one], r[one], t, (d[one], v[one]))


#: Changes by name: from a problem with structured compliance and an amount to another problem.
CHANGES: dict[str, Callable[[ContactProblem, float], ContactProblem]] = {
    change.__name__: change
    for change in (
        zero_separation,
        tied_separations,
        next_contact,
        scaled_torque,
        remote_segment,
        shifted_rotation,
        scaled_local_compliance,
        twin_segments,
        copied_segments,
        copied_tooth_pairs,
        several_pinions,
        rigid_segment,
        rigid_half,
        no_local_compliance,
        single_segment,
    )
}
