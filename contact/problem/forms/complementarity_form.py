"""The contact problem as a square linear complementarity problem, with theta eliminated.

    w = M z + q >= 0,   z >= 0,   w'z = 0

The conditions of contact are such a problem but for theta, which is free, and the balance r'F = T. Both are eliminated
exactly with one segment, k, the one that touches first: its force follows from the balance and theta from its gap,

    F_k = t - p'F_j,   theta = (C_k F + S_k - Y_k) / r_k,   t = T / r_k,   p = r_j / r_k,

j being all other segments. What remains are n unknowns z = (F_j, Y_k) with the complements w = (Y_j, F_k):

    M = [ C_jj - C_jk p' - p C_kj + C_kk p p'   p ]       q = [ S_j - p S_k + t (C_jk - C_kk p) ]
        [ -p'                                   0 ],          [ t                               ].

The upper left block is B'C B, where B maps F_j to forces in balance without torque: M is positive semidefinite, for
any signs of the lever arms. Splitting theta into two positive parts would need no such segment, but makes n + 2
unknowns and a set of solutions without bound. The start z = 0 is the state in which segment k carries all, and q_j < 0
the penetration it leaves. As r_k > 0 and T >= 0, the problem has a solution wherever the programme is bounded below.

R. W. Cottle, J.-S. Pang, R. E. Stone, The Linear Complementarity Problem (1992), doi 10.1137/1.9780898719000.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....core.checks import frozen_arrays, instance
from ..answer import Answer, require_convex, unscaled, vector_of
from ..contact_problem import ContactProblem
from ..scaled_problem import ScaledProblem


@frozen_arrays
@dataclass(frozen=True, eq=False, slots=True)
class LCP:
    """Linear complementarity form of a contact problem, scaled; `lcp` makes it.

    Attributes
    ----------
    matrix
        M (n, n), positive semidefinite, not symmetric.
    vector
        q (n).
    eliminated
        The segment k. Entry k of z is its gap and entry k of w its force; every other entry of z is the force of its
        segment and of w its gap: no segment is renumbered.
    problem
        The contact problem from which the form was made.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> form = lcp(springs)
    >>> form.recover([0.0, form.vector[0] / 2]).force.tolist()
    [1000.0, 1000.0]
    """

    matrix: NDArray[np.float64]
    vector: NDArray[np.float64]
    eliminated: int
    problem: ContactProblem

    def recover(self, z: ArrayLike) -> Answer:
        """Return forces, rotation and gaps from a solution.

        Parameters
        ----------
        z
            Solution of the linear complementarity problem (n).

        Raises
        ------
        InputError
            An array of the wrong shape.
        """
        solution = vector_of(z, "z", self.problem.size)
        return unscaled(self.problem, *forces_and_rotation(self.problem.scaled(), self.eliminated, solution))


def lcp(problem: ContactProblem) -> LCP:
    """Return the linear complementarity form of a contact problem.

    Parameters
    ----------
    problem
        Dense or structured; the matrix is dense in any case.

    Raises
    ------
    InputError
        The compliance has a negative eigenvalue.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> lcp(springs).matrix.shape
    (2, 2)
    """
    instance("problem", problem, ContactProblem)
    require_convex(problem)
    return LCP(*eliminated_system(problem.scaled()), problem)


def eliminated_system(problem: ScaledProblem) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Return M, q and the eliminated segment of a scaled problem."""
    arm, compliance, separation = problem.lever_arm, problem.compliance, problem.separation
    k = first_contact_segment(problem)
    ratio = arm / arm[k]
    share = problem.torque / arm[k]
    column = compliance[:, k] - compliance[k, k] * ratio
    matrix = compliance - np.outer(compliance[:, k], ratio) - np.outer(ratio, column)
    vector = separation - ratio * separation[k] + share * column
    matrix[:, k], matrix[k] = ratio, -ratio
    matrix[k, k], vector[k] = 0.0, share
    return matrix, vector, k


def forces_and_rotation(
    problem: ScaledProblem, k: int, solution: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Return scaled forces and rotation from z."""
    force = solution.copy()
    force[k] = 0.0
    force[k] = (problem.torque - float(problem.lever_arm @ force)) / problem.lever_arm[k]
    gap = float(solution[k])
    rotation = (float(problem.compliance[k] @ force) + problem.separation[k] - gap) / problem.lever_arm[k]
    return force, float(rotation)


def first_contact_segment(problem: ScaledProblem) -> int:
    """Return the segment that touches first as the rigid bodies turn; of several, that with the longest lever arm."""
    positive = np.flatnonzero(problem.lever_arm > 0.0)
    rotation = problem.separation[positive] / problem.lever_arm[positive]
    touching = positive[rotation <= rotation.min()]
    return int(touching[np.argmax(problem.lever_arm[touching])])
