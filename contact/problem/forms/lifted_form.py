"""The contact problem with the modal amplitudes as unknowns of their own: sparse, with a diagonal Hessian.

For C = diag(d) + V V^T and z = V^T F,

    minimise 1/2 F'diag(d) F + 1/2 z'z + S'F   subject to   r'F = T,  V'F - z = 0,  F >= 0.

No matrix has more than n k entries beside a diagonal. Interior-point and splitting methods for sparse matrices then
take O(n) operations a step where the dense form costs them O(n^3). The multiplier of the first equality is minus theta,
those of the bounds of F are minus the gaps: with the multipliers y of the other equalities, stationarity in z says
y = z, and stationarity in F then reads C F + S - theta r = Y.

V often has far fewer directions than columns: along a line of contact, a sum of smooth modes is a polynomial of low
degree. The compressed form has those that matter, see `modal_basis`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....core.checks import instance, truth
from ....core.errors import InputError
from ..answer import Answer, unscaled, vector_of
from ..contact_problem import ContactProblem
from ..scaled_problem import ScaledProblem

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


def diagonal_matrix(diagonal: NDArray[np.float64]) -> Any:
    """Return a diagonal matrix in compressed sparse columns, zeros on the diagonal stored as well."""
    from scipy.sparse import csc_matrix

    size = diagonal.size
    return csc_matrix((diagonal, np.arange(size), np.arange(size + 1)), shape=(size, size))
