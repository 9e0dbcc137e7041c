"""The contact problem in displacements instead of forces: Dorn's dual of the quadratic programme.

For a dense positive definite C the unknowns are (u, theta):

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
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ....core.checks import instance
from ....core.errors import InputError
from ..answer import Answer, require_convex, unscaled, vector_of
from ..contact_problem import ContactProblem
from .lifted_form import diagonal_matrix

if TYPE_CHECKING:
    import qpsolvers


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

    scaled = problem.scaled()
    size = problem.size
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
    return DualQP(
        qpsolvers.Problem(
            diagonal_matrix(np.concatenate([diagonal, np.full(modes, weight), [0.0]])),
            np.append(np.zeros(size + modes), -scaled.torque),
            G=csc_matrix(inequality),
            h=scaled.separation,
        ),
        problem,
    )


def _require_definite(problem: ContactProblem) -> None:
    from scipy.linalg.lapack import dpotrf

    require_convex(problem)
    if dpotrf(problem.dense_compliance.T, lower=1, clean=0)[1] != 0:
        raise InputError(
            "compliance = singular matrix: must be positive definite in the dual form; use the QP or the LCP"
        )
