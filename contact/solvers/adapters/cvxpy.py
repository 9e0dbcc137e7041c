"""Adapter of CVXPY (Diamond and Boyd 2016): the problem as one would write it on paper, an independent check.

Most of the time of a call goes into translating what is written into what a solver takes. Where that pays, it is
written with every number a parameter, translated once and used again for other numbers, see `ParametrisedProgramme`.

The contact problem in CVXPY with every number a parameter: translated once, used for many problems.

    minimise 1/2 |W'F|^2 + S'F   subject to   r'F = T,  F >= 0,      C = W W'

By the rules of disciplined parametrised programming (Agrawal et al. 2019, doi 10.48550/arXiv.1910.12430) a matrix that
is a parameter may stand in a linear expression, not in a quadratic form: hence the root W of the compliance. Of W the
pattern is fixed, and zeros are left out: the lower triangle of a Cholesky factor, or the blocks of the
tooth pairs and a diagonal.

Programmes are kept by this pattern and the solver they are for, the last few that were used. Whoever uses one takes it
out of the shelf and puts it back; in the meantime others in the same process make their own. So no two threads ever
share one, without locks, which a fork could leave closed for ever. One that was left by an exception is not put back.
"""

from __future__ import annotations

import contextlib
import math
import warnings
from collections import OrderedDict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....core.arrays import Integers, RealArray as Array
from ...problem.scaled_problem import ScaledProblem
from ..backend import NoAnswerError
from ..solution import ScaledAnswer, Status
from ..solver_table import SOLVERS

#: Programmes kept in a process. Along a mesh cycle there are two or three numbers of segments.
MAX_KEPT_PROGRAMMES = 8

_shelf: OrderedDict[tuple[Any, ...], ParametrisedProgramme] = OrderedDict()


@dataclass(frozen=True, eq=False, slots=True)
class Root:
    """A sparse matrix W with C = W W', entry by entry."""

    shape: tuple[int, int]
    rows: Integers
    columns: Integers
    values: Array

    @property
    def matrix(self) -> Any:
        """W in compressed sparse rows."""
        from scipy.sparse import csr_array

        return csr_array((self.values, (self.rows, self.columns)), shape=self.shape)


def compliance_root(problem: ScaledProblem, *, lifted: bool) -> Root:
    """Return a root of the compliance: modes and local part of a structured one if `lifted`, or a Cholesky factor."""
    size = problem.separation.size
    if lifted:
        assert problem.modal is not None
        basis, local = problem.modal.basis, np.arange(size)
        blocks, _, rank = basis.modes.shape
        filled = basis.index < size
        # All entries of a block, also where its modes happen to vanish: other problems will have numbers there.
        rows = np.broadcast_to(basis.index[:, :, np.newaxis], basis.modes.shape)[filled].ravel()
        mode = np.arange(blocks * rank).reshape(blocks, 1, rank)
        columns = np.broadcast_to(mode, basis.modes.shape)[filled].ravel()
        shared = basis.shared_factor
        every, wide = np.indices(shared.shape).reshape(2, -1), blocks * rank + shared.shape[1]
        return Root(
            (size, wide + size),
            np.concatenate([rows, every[0], local]),
            np.concatenate([columns, blocks * rank + every[1], wide + local]),
            np.concatenate([basis.modes[filled].ravel(), shared.ravel(), np.sqrt(problem.modal.diagonal)]),
        )
    try:
        root = np.linalg.cholesky(problem.compliance)
        rows, columns = np.tril_indices(size)
    except np.linalg.LinAlgError:  # singular to rounding
        values, vectors = np.linalg.eigh(problem.compliance)
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        rows, columns = (index.ravel() for index in np.indices(root.shape))
    return Root((size, size), rows, columns, root[rows, columns])


class ParametrisedProgramme:
    """A contact problem whose numbers can be set, for a compliance of the root's shape and pattern."""

    def __init__(self, root: Root) -> None:
        import cvxpy as untyped
        from scipy.sparse import csr_array

        cvxpy: Any = untyped
        size, width = root.shape
        count = root.values.size
        self._values = cvxpy.Parameter(count)
        self._separation, self._lever_arm = cvxpy.Parameter(size), cvxpy.Parameter(size)
        self._torque = cvxpy.Parameter()
        # CVXPY has sparse parameters, but takes long to check them.
        pattern = (root.columns + width * root.rows, np.arange(count))
        spread = csr_array((np.ones(count), pattern), shape=(width * size, count))
        transposed = cvxpy.reshape(spread @ self._values, (width, size), order="F")
        force = cvxpy.Variable(size)
        energy = 0.5 * cvxpy.sum_squares(transposed @ force) + self._separation @ force
        constraints = [self._lever_arm @ force == self._torque, force >= 0.0]
        #: The `cvxpy.Problem`; its constraints are the balance and the bounds.
        self.programme = cvxpy.Problem(cvxpy.Minimize(energy), constraints)

    def set_values(self, problem: ScaledProblem, root: Root) -> None:
        """Set all numbers to those of a problem."""
        self._values.value = root.values
        self._separation.value, self._lever_arm.value = problem.separation, problem.lever_arm
        self._torque.value = problem.torque


@contextlib.contextmanager
def parametrised(root: Root, backend: str) -> Iterator[ParametrisedProgramme]:
    """Take a backend's programme for roots of this form off the shelf, or make one; put it back after success."""
    key = (root.shape, root.rows.tobytes(), root.columns.tobytes(), backend)
    programme = _shelf.pop(key, None) or ParametrisedProgramme(root)
    yield programme
    _shelf[key] = programme
    while len(_shelf) > MAX_KEPT_PROGRAMMES:
        with contextlib.suppress(KeyError):  # another thread was quicker
            _shelf.popitem(last=False)


#: Largest number of segments for which the parametrised form of a dense problem is faster: it cannot have the
#: compliance as it is, but only its root, with which the solver has twice the unknowns.
LARGEST_DENSE = 90

#: Meanings of ends without an answer, by their names without ``_inaccurate``.
_SUSPICIONS = {"infeasible": Status.INFEASIBLE, "unbounded": Status.UNBOUNDED, "user_limit": Status.TIME_LIMIT}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem.

    Settings beside the backend's own: ``backend``, by default Clarabel, and ``parametrised``, whether to use a
    programme that is kept for several problems, by default where that is faster.
    """
    chosen = dict(settings)
    lifted = chosen.pop("form", "dense") == "lifted"
    backend = str(chosen.pop("backend", "CLARABEL")).upper()
    reuse = bool(chosen.pop("parametrised", lifted or problem.separation.size <= LARGEST_DENSE))
    if backend != "CLARABEL":  # the tolerances of the table are named as Clarabel wants them
        chosen = {name: value for name, value in chosen.items() if name not in SOLVERS["cvxpy"].settings}
    root = compliance_root(problem, lifted=lifted) if lifted or reuse else None
    if root is None or not reuse:
        return _solve(_written_out(problem, root), backend, chosen)
    with parametrised(root, backend) as programme:
        programme.set_values(problem, root)
        return _solve(programme.programme, backend, chosen)


def _written_out(problem: ScaledProblem, root: Root | None) -> Any:
    """Return the problem with its numbers, with the compliance as it is or by its root."""
    import cvxpy as untyped

    cvxpy: Any = untyped
    force = cvxpy.Variable(problem.separation.size)
    if root is None:
        quadratic = cvxpy.quad_form(force, cvxpy.psd_wrap(problem.compliance))
    else:
        quadratic = cvxpy.sum_squares(root.matrix.T @ force)
    energy = 0.5 * quadratic + problem.separation @ force
    return cvxpy.Problem(cvxpy.Minimize(energy), [problem.lever_arm @ force == problem.torque, force >= 0.0])


def _solve(programme: Any, backend: str, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve a programme whose constraints are the balance and the bounds, in that order."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # No warm start: the same problem has the same answer independent of earlier solves.
        programme.solve(solver=backend, warm_start=False, **settings)
    status = str(programme.status)
    suspicion = _SUSPICIONS.get(status.removesuffix("_inaccurate"))
    count = programme.solver_stats.num_iters
    if suspicion is Status.TIME_LIMIT and count is not None and count >= settings.get("max_iter", math.inf):
        suspicion = Status.NOT_CONVERGED
    (force,), (balance, bounds) = programme.variables(), programme.constraints
    if force.value is None or balance.dual_value is None:
        raise NoAnswerError(status, suspicion or Status.SOLVER_FAILED)
    # The Lagrangian of CVXPY adds +dual (r'F - T): the rotation is its negative.
    rotation, steps = -float(np.asarray(balance.dual_value)), -1 if count is None else int(count)
    gap = None if bounds.dual_value is None else np.asarray(bounds.dual_value, dtype=np.float64)
    return ScaledAnswer(np.asarray(force.value, dtype=np.float64), rotation, steps, status, suspicion, gap)
