"""Derivatives of a solution with load-dependent line contact: those of the problem with the tangent compliance.

The conditions are B F + delta(F) + S - r theta = 0 on the touching segments. Their derivative has the tangent
d delta / dF on the diagonal, where the linear problem that certifies the solution has the secant delta / F: this has
the same solution, but not the same derivatives.
"""

from __future__ import annotations

from ...core.checks import instance
from ...core.errors import InputError
from ..problem.certificate import certify
from ..problem.contact_problem import ContactProblem
from ..solvers import ContactSolution
from ..solvers.parametric.answer_sensitivity import DEGENERACY_TOLERANCE, tangent_answer_sensitivity
from ..solvers.parametric.sensitivity import Sensitivity
from .line_contact_newton import LineContact


def line_contact_sensitivity(
    bending: ContactProblem,
    line_contact: LineContact,
    solution: ContactSolution,
    *,
    tolerance: float = DEGENERACY_TOLERANCE,
) -> Sensitivity:
    """Return the derivatives of a certified solution with load-dependent line contact.

    Parameters
    ----------
    bending
        The contact problem with the compliance of bending alone, B.
    line_contact
        The local part.
    solution
        Of `solve_line_contact`.
    tolerance
        As of `sensitivity`.

    Returns
    -------
    Sensitivity
        With respect to the torque, S, r and B. A change of the local deflections under the same forces, as by a
        parameter of the line contact, is a change of S by that much. The energy is that of bending and line contact
        together, 1/2 F'BF plus the integrals of delta.

    Raises
    ------
    InputError
        The solution is not certified, or is that of another problem.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, Material
    >>> from easeoff.contact.compliance.weber_line_contact import WeberLineContact
    >>> from easeoff.contact.line_contact.line_contact_solution import solve_line_contact
    >>> steel = Material(206000.0, 0.3)
    >>> line_contact = WeberLineContact(*(np.full(3, value) for value in (1.5, 30.0, 3.0, 3.0)), steel, steel)
    >>> bending = ContactProblem([0.01, 0.0, 0.01], [40.0] * 3, 1.2e5, (np.zeros(3), np.full((3, 1), 1e-3)))
    >>> solution, _ = solve_line_contact(
    ...     bending.separation, bending.lever_arm, bending.torque, bending.compliance, line_contact
    ... )
    >>> slope = line_contact_sensitivity(bending, line_contact, solution)
    >>> round(1e-6 / slope.forward(torque=1.0).rotation, 3)  # mesh stiffness [N mm/urad]
    474.66
    """
    instance("bending", bending, ContactProblem)
    instance("line_contact", line_contact, LineContact)
    instance("solution", solution, ContactSolution)
    if not solution.certified:
        raise InputError(f"solution = {solution.status.name.lower()}: must be certified to have derivatives")
    force = solution.force
    secant = bending.with_added_compliance(line_contact.secant(force))
    if not certify(secant, force, solution.rotation, solution.elastic_rotation).passes(solution.tolerance):
        raise InputError("solution: must be that of this problem; its forces and rotation do not solve it")
    return tangent_sensitivity(bending, line_contact, solution, tolerance)


def tangent_sensitivity(
    bending: ContactProblem, line_contact: LineContact, solution: ContactSolution, tolerance: float
) -> Sensitivity:
    """As `line_contact_sensitivity`, for a solution that is known to be that of the problem."""
    force = solution.force
    tangent = bending.compliance_matrix.with_added(line_contact.tangent(force))
    deflection = bending.deflection(force) + line_contact.deflection(force)
    return tangent_answer_sensitivity(bending, solution.answer, tangent, deflection, tolerance)
