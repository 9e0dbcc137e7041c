"""Equivalent forms of the contact problem: lifted, dual, and as a linear complementarity problem.

Lifted, it is sparse with a diagonal Hessian: the modal amplitudes are unknowns of their own. With z = V^T F, for C =
diag(d) + V V^T,

    minimise 1/2 F'diag(d) F + 1/2 z'z + S'F   subject to   r'F = T,  V'F - z = 0,  F >= 0.

No matrix has more than n k entries beside a diagonal. Interior-point and splitting methods for sparse matrices then
take O(n) operations a step where the dense form costs them O(n^3). The multiplier of the first equality is minus theta,
those of the bounds of F are minus the gaps: with the multipliers y of the other equalities, stationarity in z says
y = z, and stationarity in F then reads C F + S - theta r = Y.

V often has far fewer directions than columns: along a line of contact, a sum of smooth modes is a polynomial of low
degree. The compressed form has those that matter, see `modal_basis`.

The dual form has displacements instead of forces, by Dorn's dual of the quadratic programme. For a dense positive
definite C the unknowns are (u, theta):

    minimise 1/2 u'C u - T theta   subject to   C u - theta r + S >= 0.

For C = diag(d) + V V^T with d > 0 they are (u, z, theta), and no matrix is denser than V:

    minimise 1/2 u'diag(d) u + 1/2 z'z - T theta   subject to   d u + V z - theta r + S >= 0.

The objective is the deformation energy less the work of the torque, z the modal amplitudes, and the left side of the
constraint the gaps Y: it is the principle of minimum potential energy, without penetration. At the minimum u = F, theta
is the rotation itself, and the multipliers of the constraint are F once more. No matrix is inverted. The minimal value
is minus that of the primal.

The Hessian is singular in theta, which is free: methods that need a positive definite one cannot take this form;
interior-point and splitting methods can, and active-set methods that regularise.

W. S. Dorn, Duality in quadratic programming, Quarterly of Applied Mathematics 18 (1960) 155-162.

The third form is a square linear complementarity problem, with theta eliminated.

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
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array, record
from ...core.checks import instance, truth
from ...core.errors import InputError
from .certificate import Answer, require_convex, unscaled, vector_of
from .contact_problem import ContactProblem
from .scaled_problem import ScaledProblem

if TYPE_CHECKING:
    import qpsolvers


@dataclass(frozen=True, eq=False, slots=True)
class LiftedQP:
    """Lifted form of a contact problem; `lifted_qp` makes it.

    Attributes
    ----------
    programme
        Scaled; its unknowns are the n forces, then the modal amplitudes. Matrices in compressed sparse columns.
    problem
        The contact problem from which the form was made.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, (np.full(2, 1e-6), np.zeros((2, 1))))
    >>> form, scale = lifted_qp(springs), springs.scaling
    >>> form.recover([1e3 / scale.force, 1e3 / scale.force, 0.0], [-2.5e-5 / scale.rotation, 0.0]).certificate.worst
    0.0
    """

    programme: qpsolvers.Problem
    problem: ContactProblem

    def recover(self, x: ArrayLike, y: ArrayLike) -> Answer:
        """Return forces, rotation and gaps from an answer to the programme.

        Parameters
        ----------
        x
            Its unknowns (n + k).
        y
            Multipliers of the equalities (1 + k), in the sign of qpsolvers: P x + q + A'y + z_box = 0.

        Raises
        ------
        InputError
            An array of the wrong shape.
        """
        unknowns = vector_of(x, "x", self.programme.q.size)
        multipliers = vector_of(y, "y", unknowns.size - self.problem.size + 1)
        return unscaled(self.problem, unknowns[: self.problem.size], -float(multipliers[0]))


def lifted_qp(problem: ContactProblem, *, compress: bool = False) -> LiftedQP:
    """Return the lifted form of a structured contact problem.

    Parameters
    ----------
    problem
        With a compliance diag(d) + V V^T.
    compress
        Replace V by the directions that matter; C then changes by rounding.

    Raises
    ------
    InputError
        The compliance is one dense matrix.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, (np.full(2, 1e-6), np.zeros((2, 1))))
    >>> lifted_qp(springs).programme.A.shape
    (2, 3)
    """
    instance("problem", problem, ContactProblem)
    truth("compress", compress)
    return LiftedQP(lifted_programme(problem.scaled(), compress=compress), problem)


def lifted_programme(problem: ScaledProblem, *, compress: bool) -> qpsolvers.Problem:
    """Return the lifted form of a scaled problem; raises as `lifted_qp`."""
    import qpsolvers
    from scipy.sparse import csc_matrix

    if problem.modal is None:
        what = "dense matrix" if problem.has_matrix else "LinearOperator"
        raise InputError(f"compliance = {what}: must be the pair (d, V) of C = diag(d) + V V^T in the lifted form")
    structure = problem.modal
    factor = structure.compressed_factor if compress else structure.factor
    size, modes = factor.shape
    # Filled as one array and converted once: joining sparse blocks costs more than solving a small problem.
    equalities = np.zeros((1 + modes, size + modes))
    equalities[0, :size] = problem.lever_arm
    equalities[1:, :size] = factor.T
    equalities[1:, size:] = -np.eye(modes)
    diagonal = np.concatenate([structure.diagonal, np.full(modes, structure.weight)])
    return qpsolvers.Problem(
        diagonal_matrix(diagonal),
        np.concatenate([problem.separation, np.zeros(modes)]),
        A=csc_matrix(equalities),
        b=np.concatenate([[problem.torque], np.zeros(modes)]),
        lb=np.concatenate([np.zeros(size), np.full(modes, -np.inf)]),
    )


def diagonal_matrix(diagonal: Array) -> Any:
    """Return a diagonal matrix in compressed sparse columns, zeros on the diagonal stored as well."""
    from scipy.sparse import csc_matrix

    size = diagonal.size
    return csc_matrix((diagonal, np.arange(size), np.arange(size + 1)), shape=(size, size))


@dataclass(frozen=True, eq=False, slots=True)
class DualQP:
    """Dual form of a contact problem; `dual_qp` makes it.

    Attributes
    ----------
    programme
        Scaled, with inequalities G x <= h alone. Its unknowns are u (n), the modal amplitudes z (k, structured
        compliance only), theta. Matrices in compressed sparse columns where the compliance is structured.
    problem
        The contact problem from which the form was made.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> form = dual_qp(springs)
    >>> scale = springs.scaling
    >>> form.recover([1e3 / scale.force, 1e3 / scale.force, 2.5e-5 / scale.rotation]).certificate.worst < 1e-15
    True
    """

    programme: qpsolvers.Problem
    problem: ContactProblem

    def recover(self, x: ArrayLike, z: ArrayLike | None = None) -> Answer:
        """Return forces, rotation and gaps from an answer to the programme.

        Parameters
        ----------
        x
            Its unknowns (n + k + 1), or (n + 1) where C is dense.
        z
            Multipliers of the inequalities (n), not negative, in the sign of qpsolvers: P x + q + G'z = 0. They are the
            forces, and more exact than those in `x` where d is small; without them the forces are taken from `x`.

        Raises
        ------
        InputError
            An array of the wrong shape.
        """
        size = self.problem.size
        unknowns = vector_of(x, "x", self.programme.q.size)
        force = unknowns[:size] if z is None else vector_of(z, "z", size)
        return unscaled(self.problem, force, float(unknowns[-1]))


def dual_qp(problem: ContactProblem) -> DualQP:
    """Return the dual form of a contact problem.

    Parameters
    ----------
    problem
        Its compliance diag(d) + V V^T with d > 0, or dense and positive definite.

    Raises
    ------
    InputError
        Some segment has no compliance of its own, or the matrix is not positive definite: u would not be unique.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> dual_qp(springs).programme.P.shape
    (3, 3)
    """
    instance("problem", problem, ContactProblem)
    import qpsolvers
    from scipy.sparse import csc_matrix

    scaled, size = problem.scaled(), problem.size
    if scaled.modal is None:
        _require_definite(problem)
        hessian = np.zeros((size + 1, size + 1))
        hessian[:size, :size] = scaled.compliance
        inequality = np.column_stack([-scaled.compliance, scaled.lever_arm])
        linear = np.append(np.zeros(size), -scaled.torque)
        return DualQP(qpsolvers.Problem(hessian, linear, G=inequality, h=scaled.separation), problem)
    diagonal, factor, weight = scaled.modal.diagonal, scaled.modal.factor, scaled.modal.weight
    if not diagonal.min() > 0.0:
        raise InputError(
            "compliance diagonal: must be positive in the dual form, and is zero for "
            f"{np.count_nonzero(diagonal <= 0.0)} segments; use the lifted form or the LCP"
        )
    modes = factor.shape[1]
    inequality = np.zeros((size, size + modes + 1))
    inequality[np.arange(size), np.arange(size)] = -diagonal
    inequality[:, size:-1] = -weight * factor
    inequality[:, -1] = scaled.lever_arm
    hessian = diagonal_matrix(np.concatenate([diagonal, np.full(modes, weight), [0.0]]))
    linear = np.append(np.zeros(size + modes), -scaled.torque)
    return DualQP(qpsolvers.Problem(hessian, linear, G=csc_matrix(inequality), h=scaled.separation), problem)


def _require_definite(problem: ContactProblem) -> None:
    from scipy.linalg.lapack import dpotrf

    require_convex(problem)
    if dpotrf(problem.dense_compliance.T, lower=1, clean=0)[1] != 0:
        raise InputError(
            "compliance = singular matrix: must be positive definite in the dual form; use the QP or the LCP"
        )


@record(frozen=True, eq=False, slots=True)
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

    matrix: Array
    vector: Array
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


def eliminated_system(problem: ScaledProblem) -> tuple[Array, Array, int]:
    """Return M, q and the eliminated segment of a scaled problem."""
    arm, compliance, separation = problem.lever_arm, problem.compliance, problem.separation
    k = first_contact_segment(problem)
    ratio, share = arm / arm[k], problem.torque / arm[k]
    column = compliance[:, k] - compliance[k, k] * ratio
    matrix = compliance - np.outer(compliance[:, k], ratio) - np.outer(ratio, column)
    vector = separation - ratio * separation[k] + share * column
    matrix[:, k], matrix[k] = ratio, -ratio
    matrix[k, k], vector[k] = 0.0, share
    return matrix, vector, k


def forces_and_rotation(problem: ScaledProblem, k: int, solution: Array) -> tuple[Array, float]:
    """Return scaled forces and rotation from z."""
    force = solution.copy()
    force[k] = 0.0
    force[k] = (problem.torque - float(problem.lever_arm @ force)) / problem.lever_arm[k]
    closed = float(problem.compliance[k] @ force) + problem.separation[k] - float(solution[k])
    return force, float(closed / problem.lever_arm[k])


def first_contact_segment(problem: ScaledProblem) -> int:
    """Return the segment that touches first as the rigid bodies turn; of several, that with the longest lever arm."""
    positive = np.flatnonzero(problem.lever_arm > 0.0)
    rotation = problem.separation[positive] / problem.lever_arm[positive]
    touching = positive[rotation <= rotation.min()]
    return int(touching[np.argmax(problem.lever_arm[touching])])
