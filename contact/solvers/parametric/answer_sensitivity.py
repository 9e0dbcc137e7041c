"""Sensitivity of an answer: which segments are loaded, which are weak, and the compliance it has there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....core.checks import positive
from ...problem.answer import Answer
from ...problem.compliance_matrix import ComplianceMatrix
from ...problem.contact_problem import ContactProblem
from .sensitivity import Sensitivity
from .weak_segments import dependent_segments, loaded_and_weak

Array = NDArray[np.float64]

#: A force and a gap that are both below this part of their scales count as none.
DEGENERACY_TOLERANCE = 1e-10
#: Deflection, relative to what the most compliant segment has under the largest force, that is taken for rounding.
RIGID_FRACTION = 1e-12


def answer_sensitivity(problem: ContactProblem, answer: Answer, tolerance: float = DEGENERACY_TOLERANCE) -> Sensitivity:
    """Return the derivatives of a proved answer to a contact problem; see `sensitivity`."""
    deflection = problem.deflection(answer.force)
    return tangent_answer_sensitivity(problem, answer, problem.compliance_matrix, deflection, tolerance)


def tangent_answer_sensitivity(
    problem: ContactProblem, answer: Answer, tangent: ComplianceMatrix, deflection: Array, tolerance: float
) -> Sensitivity:
    """Return the derivatives where the compliance depends on the load.

    Parameters
    ----------
    problem, answer, tolerance
        As of `answer_sensitivity`.
    tangent
        Derivative of the deflections by the forces [mm/N].
    deflection
        Deflections under the forces of the answer (n) [mm].
    """
    positive("tolerance", tolerance, zero=True)
    force, gap = answer.force, answer.gap
    scale = abs(answer.elastic_rotation) * float(np.abs(problem.lever_arm[force > 0.0]).max(initial=0.0))
    yielding = float(force.max()) * float(tangent.diagonal.max())
    if scale <= RIGID_FRACTION * yielding:  # what touches is rigid
        scale = yielding or float(np.abs(problem.separation_at_first_contact).max()) or 1.0
    loaded, weak = loaded_and_weak(force, gap, float(force.max()), scale, tolerance)
    dependent = dependent_segments(tangent, problem.lever_arm, loaded, weak)
    loaded, weak = loaded | dependent, weak & ~dependent
    return Sensitivity(problem, force, gap, answer.rotation, loaded, weak, tangent, deflection)
