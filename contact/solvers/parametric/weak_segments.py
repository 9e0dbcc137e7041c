"""Segments that touch without a force: which of them carry load when the data change in a given direction.

Where F = Y = 0 the solution has a kink. Its change in a direction solves a contact problem of its own: the loaded
segments keep contact, with forces of any sign of change, the open ones stay open, and for the weak ones

    dY >= 0,    dF >= 0,    dF'dY = 0.

With the loaded segments eliminated that is a linear complementarity problem in the weak ones alone, mostly one or two.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ....core.arrays import Bools, Integers, RealArray as Array
from ...problem.certificate import Answer
from ...problem.complementary_pivoting import lemke
from ...problem.compliance_matrix import ComplianceMatrix
from ...problem.contact_problem import ContactProblem
from ...problem.programme_forms import lcp
from ..touching_system import DEPENDENCE_TOLERANCE
from .touching_form import TouchingSystem, part_of, touching_system

#: A change of force of a weak segment below this, relative to the largest, is rounding.
SMALLEST_CHANGE = 1e-12


def loaded_and_weak(force: Array, gap: Array, gap_scale: float, tolerance: float) -> tuple[Bools, Bools]:
    """Masks (n) of segments that carry load, and of those that neither carry load nor are open.

    Forces and gaps up to the tolerance times the greatest force and the scale of gaps [mm] count as none.
    """
    force_scale = float(force.max())
    none = force <= tolerance * force_scale
    shut = gap <= tolerance * gap_scale
    return np.asarray(~none & (force * gap_scale > gap * force_scale)), np.asarray(none & shut)


def answer_by_pivoting(problem: ContactProblem) -> Answer | None:
    """Return the answer of Lemke's method; None where it has none."""
    form = lcp(problem)
    result = lemke(form.matrix, form.vector)
    return form.recover(result.z) if result.ended == "solved" else None


def system_in_direction(
    matrix: ComplianceMatrix,
    lever_arm: Array,
    loaded: Bools,
    weak: Bools,
    closing: Array,
    torque: float,
    first_contact: Callable[[ContactProblem], Answer | None] = answer_by_pivoting,
) -> TouchingSystem | None:
    """System of the segments that carry load as the data begin to change by g (n) and T; None if none is found.

    ``first_contact`` solves the contact problem of the weak segments, where nothing carries load yet.
    """
    segments = np.flatnonzero(weak)
    if lever_arm[loaded].any():
        return _with_weak(touching_system(matrix, lever_arm, loaded), lever_arm, segments, closing, torque)
    arm = lever_arm[segments]
    if torque < 0.0 or not segments.size or not arm.max() > 0.0:
        return None
    answer = first_contact(ContactProblem(-closing[segments], arm, torque, part_of(matrix, segments)))
    if answer is None or not answer.certificate.passes():
        return None
    active = np.zeros(lever_arm.size, dtype=np.bool_)
    active[segments] = answer.force > 0.0
    if not active.any():  # without a torque: the first to touch
        active[segments[arm > 0.0][np.argmin(answer.gap[arm > 0.0])]] = True
    return touching_system(matrix, lever_arm, active)


def _with_weak(
    system: TouchingSystem, lever_arm: Array, segments: Integers, closing: Array, torque: float
) -> TouchingSystem | None:
    """Let those of the weak segments enter that carry load."""
    if not segments.size:
        return system
    yielding, sizes = _yielding(system, lever_arm, segments)
    free = yielding.diagonal() > DEPENDENCE_TOLERANCE * sizes
    segments, yielding, sizes = segments[free], yielding[np.ix_(free, free)], sizes[free]
    opening = system.solve(closing[:, None], np.array([torque])).gap[segments, 0]
    unit = 1.0 / np.sqrt(sizes)
    vector, yielding = opening * unit, yielding * np.outer(unit, unit)
    level = float(np.abs(vector).max(initial=0.0))
    if level == 0.0:
        return system
    result = lemke(yielding, vector / level)
    if result.ended != "solved":
        return None
    for segment in segments[result.z > SMALLEST_CHANGE * max(float(result.z.max()), 1.0)]:
        if not system.enter(int(segment)):
            return None
    return system


def dependent_segments(matrix: ComplianceMatrix, lever_arm: Array, loaded: Bools, weak: Bools) -> Bools:
    """Return the weak segments that could take over load at no cost: the forces are not unique, (n)."""
    result = np.zeros(weak.size, dtype=np.bool_)
    if weak.any() and lever_arm[loaded].any():
        segments = np.flatnonzero(weak)
        yielding, sizes = _yielding(touching_system(matrix, lever_arm, loaded), lever_arm, segments)
        result[segments] = yielding.diagonal() <= DEPENDENCE_TOLERANCE * sizes
    return result


def _yielding(system: TouchingSystem, lever_arm: Array, segments: Integers) -> tuple[Array, Array]:
    """Compliance among some open segments while the touching ones yield (w, w), and the size of its terms (w)."""
    columns = system.columns(segments)
    gap = system.solve(-columns, -lever_arm[segments]).gap[segments]
    diagonal = columns[segments, np.arange(segments.size)]
    return 0.5 * (gap + gap.T), np.maximum(diagonal, np.abs(diagonal - gap.diagonal()))
