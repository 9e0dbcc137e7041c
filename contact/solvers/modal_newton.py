"""Newton's method in the space of bending modes, for one contact problem or many at once.

With forces eliminated the unknowns are the modal amplitudes c = U^T F, a dozen per tooth pair, and the rotation. The
local law F = f(indentation) may be any that is convex; with its energy Psi, Psi' = f, the function to be minimised is

    phi(c, theta) = 1/2 c'c + sum Psi(max(0, -g)) - T theta,    g = U c + S - r theta,

convex and once differentiable, with the gradient (c - U'F, r'F - T) and, K being the tangent stiffness of the law, the
Hessian [I + U'K U, -U'K r; -r'K U, r'K r]: one small block a tooth pair, with theta as a border. An iteration costs
O(n m^2) for m modes a pair, and C is never formed. Modes that all pairs share, W_i = G_i M_b in block b, add their
amplitudes a = W'F to the border. In a block these have no more directions than G has columns: the block leaves the
Schur complement of its modes on [G r], and M_b takes that to a and theta.

A step that passes the minimum along its line is halved until phi surely falls. With a linear law the iteration ends
after finitely many steps, with a smooth one its convergence is quadratic. Signs and complementarity of the forces are
exact by construction; what is left is rounding in c, a and theta.

Problems stand side by side in arrays with a leading axis, so that they share the cost of calling numpy. None feels the
company of the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..problem.scaled_problem import ScaledModes, ScaledProblem
from .active_set.active_set_system import first_contact_index
from .modal_batch import Amplitudes, Loads, ModalBatch
from .scaled_answer import ScaledAnswer
from .solver_limits import StepBudget

Array = NDArray[np.float64]

MAX_ITERATIONS = 60
#: Halvings of a step before a problem is given up.
MAX_HALVINGS = 20
#: Gradient, relative to its terms, at which only rounding is left; and below which a problem is done when a step gains
#: less than a factor of two.
ROUNDING_RESIDUAL, STALLED_RESIDUAL = 2e-15, 1e-8
#: A slope of phi below this, relative to its terms, is rounding.
ROUNDING_SLOPE = 1e-12
#: Smallest local compliance for which the method is tried, relative to the whole compliance of a segment: digits are
#: lost, and iterations gained, in the ratio of the two.
SMALLEST_LOCAL_FRACTION = 1e-4
#: Padding the blocks to one size may cost this many times the memory of the factor.
LARGEST_PADDING = 4


class LocalLaw(Protocol):
    """The local compliance of all segments of all problems, each a spring of its own."""

    def response(self, indentation: Array, chosen: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return force and tangent stiffness (b, p, m), zero where the indentation is zero.

        Parameters
        ----------
        indentation
            Of every segment (b, p, m), not negative.
        chosen
            Numbers of the problems (b).
        """
        ...


@dataclass(frozen=True, eq=False)
class LinearLaw:
    """Springs of constant stiffness (b, p, m)."""

    stiffness: Array

    def response(self, indentation: Array, chosen: NDArray[np.intp]) -> tuple[Array, Array]:
        """See `LocalLaw`."""
        stiffness = self.stiffness[chosen]
        return indentation * stiffness, np.where(indentation > 0.0, stiffness, 0.0)


@dataclass(frozen=True, eq=False)
class BatchAnswer:
    """Where the iteration ended.

    Attributes
    ----------
    amplitudes
        Of the modes.
    rotation
        Beyond first contact (b).
    force
        Of every segment (b, p, m).
    iterations
        Steps to the best point met (b).
    ended
        False where the method gave up (b); the rest means little there.
    """

    amplitudes: Amplitudes
    rotation: Array
    force: Array
    iterations: NDArray[np.intp]
    ended: NDArray[np.bool_]


def has_modal_form(problem: ScaledProblem) -> bool:
    """Whether the modal method can be used.

    It cannot if the compliance is a dense matrix, if some segment has (nearly) no compliance of its own, or if
    blocks of very different sizes would be mostly padding.
    """
    modal = problem.modal
    if modal is None or not modal.compliance.local_fraction > SMALLEST_LOCAL_FRACTION:
        return False
    padded = modal.compliance.modes.basis.modes.size
    return padded <= LARGEST_PADDING * problem.separation.size * (modal.mode_count + 1)


def modal_newton(
    problems: Sequence[ScaledProblem], active: Sequence[NDArray[np.bool_]], budget: StepBudget | None = None
) -> list[ScaledAnswer | None]:
    """Solve scaled problems that have the modal form.

    Parameters
    ----------
    problems
        The scaled problems.
    active
        Segments of each that are assumed in contact (n).
    budget
        Limits of the whole solve; a step of all problems together is one.

    Returns
    -------
    list of ScaledAnswer or None
        None for a problem in which the method did not end.
    """
    if budget is not None and not budget.step():
        return [None] * len(problems)
    given = [problem.given_compliance for problem in problems]
    modes = [modal for modal in given if isinstance(modal, ScaledModes)]
    batch = ModalBatch.of(
        [modal.basis for modal in modes],
        [problem.lever_arm for problem in problems],
        [problem.separation for problem in problems],
        np.array([problem.torque for problem in problems]),
    )
    law = LinearLaw(batch.in_blocks([1.0 / modal.diagonal for modal in modes], 0.0))
    touching = [_touching(problem, mask) for problem, mask in zip(problems, active, strict=True)]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        start = _minimum_on(batch, law.stiffness * batch.in_blocks(touching, 0.0))
    found = newton_batch(batch, law, *start, budget)
    return [
        ScaledAnswer(force, float(found.rotation[i]), int(found.iterations[i]) + 1, "modal") if found.ended[i] else None
        for i, force in enumerate(batch.by_segments(found.force))
    ]


def _touching(problem: ScaledProblem, active: NDArray[np.bool_]) -> Array:
    """One for segments assumed in contact that turn the gear (n), at least one of them; zero for the others."""
    touching = active & (problem.lever_arm > 0.0)
    if not touching.any():
        touching[first_contact_index(problem)] = True
    return touching.astype(np.float64)


def _minimum_on(batch: ModalBatch, stiffness: Array) -> tuple[Amplitudes, Array]:
    """Return amplitudes and rotation that minimise phi if the segments with a stiffness (b, p, m) stuck together."""
    count, blocks = stiffness.shape[:2]
    rotation = np.zeros(count)
    amplitudes = Amplitudes(np.zeros((count, blocks, batch.rank)), np.zeros((count, batch.mixing.shape[3])))
    force = -stiffness * batch.separation
    here = _Point(amplitudes, rotation, batch.separation, force, stiffness, batch.loads(force))
    return _newton_direction(batch, here)


def newton_batch(
    batch: ModalBatch, law: LocalLaw, amplitudes: Amplitudes, rotation: Array, budget: StepBudget | None = None
) -> BatchAnswer:
    """Solve all problems of a batch.

    Parameters
    ----------
    batch
        The problems.
    law
        Local compliance.
    amplitudes, rotation
        Where to begin; rotations (b).
    budget
        Limits of the whole solve.
    """
    count = rotation.size
    best = np.full(count, np.inf)
    answer = BatchAnswer(
        Amplitudes(np.array(amplitudes.own), np.array(amplitudes.shared)),
        np.array(rotation),
        np.zeros(batch.segment.shape),
        np.zeros(count, dtype=np.intp),
        np.zeros(count, dtype=np.bool_),
    )
    chosen = np.arange(count)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        point = _point(batch, law, chosen, amplitudes, rotation)
        for iteration in range(MAX_ITERATIONS):
            residual = _residual(batch, point)
            before = best[chosen]
            better = residual < before
            kept = chosen[better]
            best[kept], answer.iterations[kept] = residual[better], iteration
            answer.amplitudes.put(kept, point.amplitudes.part(better))
            answer.rotation[kept], answer.force[kept] = point.rotation[better], point.force[better]
            done = (residual <= ROUNDING_RESIDUAL) | (~(residual < 0.5 * before) & (before < STALLED_RESIDUAL))
            answer.ended[chosen[done]] = True
            going = ~done & np.isfinite(residual)
            if not going.any():
                break
            if not going.all():
                chosen, batch, point = chosen[going], batch.part(going), point.part(going)
            if budget is not None and not budget.step():
                break
            point = _step(batch, law, chosen, point)
    return answer


@dataclass(frozen=True, eq=False)
class _Point:
    """A point of the iteration: amplitudes, rotation (b), gap, force, stiffness (b, p, m), loads."""

    amplitudes: Amplitudes
    rotation: Array
    gap: Array
    force: Array
    stiffness: Array
    loads: Loads

    def part(self, chosen: NDArray[Any]) -> _Point:
        loads = Loads(self.loads.amplitudes.part(chosen), self.loads.moment[chosen])
        gap, force, stiffness = self.gap[chosen], self.force[chosen], self.stiffness[chosen]
        return _Point(self.amplitudes.part(chosen), self.rotation[chosen], gap, force, stiffness, loads)

    def put(self, chosen: NDArray[Any], other: _Point, others: NDArray[Any]) -> None:
        """Replace some of the problems by some of other points."""
        self.amplitudes.put(chosen, other.amplitudes.part(others))
        self.loads.amplitudes.put(chosen, other.loads.amplitudes.part(others))
        self.loads.moment[chosen], self.rotation[chosen] = other.loads.moment[others], other.rotation[others]
        self.gap[chosen], self.force[chosen], self.stiffness[chosen] = (
            other.gap[others], other.force[others], other.stiffness[others],
        )  # fmt: skip


def _point(
    batch: ModalBatch, law: LocalLaw, chosen: NDArray[np.intp], amplitudes: Amplitudes, rotation: Array
) -> _Point:
    gap = batch.closing(amplitudes, rotation) + batch.separation
    force, stiffness = law.response(np.maximum(-gap, 0.0), chosen)
    return _Point(amplitudes, rotation, gap, force, stiffness, batch.loads(force))


def _residual(batch: ModalBatch, point: _Point) -> Array:
    """Gradient of phi relative to its terms, (b)."""
    level = batch.torque
    if not level.all():  # without a torque, segments press against each other
        level = np.where(level > 0.0, level, np.sum(point.force * np.abs(batch.rows[..., -1]), axis=(1, 2)))
    imbalance = np.abs(batch.torque - point.loads.moment.sum(axis=1)) / level
    (own, shared), (own_load, shared_load) = point.amplitudes, point.loads.amplitudes
    amplitude = np.abs(own).max(axis=(1, 2), initial=0.0)
    left = np.abs(own_load - own).max(axis=(1, 2), initial=0.0)
    residual = np.asarray(np.maximum(imbalance, left / np.where(amplitude > 0.0, amplitude, 1.0)))
    if shared.shape[1]:
        amplitude = np.maximum(amplitude, np.abs(shared).max(axis=1))
        left = np.abs(shared_load - shared).max(axis=1)
        residual = np.maximum(residual, left / np.where(amplitude > 0.0, amplitude, 1.0))
    return residual


def _newton_direction(batch: ModalBatch, point: _Point) -> tuple[Amplitudes, Array]:
    """Change of amplitudes and rotation at which the gradient of phi would vanish if it were linear."""
    rank, mixing = batch.rank, batch.mixing
    gram = (batch.rows * point.stiffness[..., None]).swapaxes(2, 3) @ batch.rows
    hessian = gram[..., :rank, :rank] + np.eye(rank)
    border, left = gram[..., :rank, -1], point.loads.amplitudes.own - point.amplitudes.own
    sides = np.concatenate([border[..., None], left[..., None], gram[..., :rank, rank:-1]], axis=-1)
    solved = np.linalg.solve(hessian, sides)
    pivot = gram[..., -1, -1].sum(axis=1) - np.sum(border * solved[..., 0], axis=(1, 2))
    imbalance = batch.torque - point.loads.moment.sum(axis=1)
    imbalance = imbalance + np.sum(border * solved[..., 1], axis=(1, 2))
    if not mixing.shape[3]:
        turn = imbalance / pivot
        return Amplitudes(solved[..., 1] + turn[:, None, None] * solved[..., 0], point.amplitudes.shared), turn
    # What a block leaves on its shared columns and the lever arm, mixed to the shared amplitudes and the rotation.
    local = gram[..., rank:-1, rank:] - gram[..., :rank, rank:-1].swapaxes(2, 3) @ np.concatenate(
        [solved[..., 2:], solved[..., :1]], axis=-1
    )
    stiff = np.eye(mixing.shape[3]) + (mixing.swapaxes(2, 3) @ (local[..., :-1] @ mixing)).sum(axis=1)
    turned = batch.mixed(local[..., -1])
    pulled = batch.mixed((gram[..., :rank, rank:-1].swapaxes(2, 3) @ solved[..., 1, None])[..., 0])
    rest = point.loads.amplitudes.shared - point.amplitudes.shared - pulled
    ends = np.linalg.solve(stiff, np.stack([turned, rest], axis=-1))
    turn = (imbalance + np.sum(turned * ends[..., 1], axis=1)) / (pivot - np.sum(turned * ends[..., 0], axis=1))
    shared = ends[..., 1] + turn[:, None] * ends[..., 0]
    own = solved[..., 1] + turn[:, None, None] * solved[..., 0]
    own -= (solved[..., 2:] @ (mixing @ shared[:, None, :, None]))[..., 0]
    return Amplitudes(own, shared), turn


def _step(batch: ModalBatch, law: LocalLaw, chosen: NDArray[np.intp], point: _Point) -> _Point:
    """Take Newton's step, or a half, a quarter ... of it: the longest along which phi surely falls.

    The slope of a convex function never decreases, so over a step a its change is at most a/2 (slope(a/2) + slope(a)).
    """
    change, turn = _newton_direction(batch, point)
    end = _point(batch, law, chosen, point.amplitudes.moved(change), point.rotation + turn)
    slope, rounding = _slope(batch, end, change, turn)
    long = np.flatnonzero(slope > rounding)
    length = 1.0
    for _ in range(MAX_HALVINGS):
        if not long.size:
            break
        length *= 0.5
        part, begin, away, rotated = batch.part(long), point.part(long), change.part(long), turn[long]
        middle = _point(
            part, law, chosen[long], begin.amplitudes.moved(away, length), begin.rotation + length * rotated
        )
        half_slope, _ = _slope(part, middle, away, rotated)
        shorten = half_slope + slope[long] > 0.0
        end.put(long[shorten], middle, shorten)
        slope[long] = half_slope
        long = long[shorten & (half_slope > rounding[long])]
    return end


def _slope(batch: ModalBatch, here: _Point, change: Amplitudes, turn: Array) -> tuple[Array, Array]:
    """Slope of phi at a point along a line, and what of it is rounding, (b)."""
    closing = batch.closing(change, turn)
    bending, local = change.dot(here.amplitudes), np.sum(here.force * closing, axis=(1, 2))
    work = batch.torque * turn
    return bending - local - work, ROUNDING_SLOPE * (np.abs(bending) + np.abs(local) + np.abs(work))
