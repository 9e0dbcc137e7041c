"""Newton's method in the space of bending modes for many problems at once, with any local compliance that is convex.

As `modal_newton`, on arrays with a leading axis of problems, so that the cost of calling numpy is shared. The local law
F = f(indentation) may be nonlinear: with its energy Psi, Psi' = f, the function to be minimised is

    phi(c, theta) = 1/2 c'c + sum Psi(max(0, -g)) - T theta,    g = U c + S - r theta,

convex and once differentiable, with the gradient (c - U'F, r'F - T) and, K being the tangent stiffness of the law, the
Hessian [I + U'K U, -U'K r; -r'K U, r'K r]. A step that passes the minimum along its line is halved until phi surely
falls. With a linear law the iteration ends after finitely many steps, with a smooth one its convergence is quadratic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..problem.modal_basis import ModalBasis

Array = NDArray[np.float64]

MAX_ITERATIONS = 60
#: Halvings of a step before a problem is given up.
MAX_HALVINGS = 20
#: Gradient, relative to its terms, at which only rounding is left; and below which a problem is done when a step gains
#: less than a factor of two.
ROUNDING_RESIDUAL, STALLED_RESIDUAL = 2e-15, 1e-8
#: A slope of phi below this, relative to its terms, is rounding.
ROUNDING_SLOPE = 1e-12


class LocalLaw(Protocol):
    """The local compliance of all segments of all problems, each a spring of its own."""

    def response(self, indentation: Array, chosen: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return force and tangent stiffness (b, p, m), zero where the indentation is zero.

        Parameters
        ----------
        indentation : (b, p, m) array
            Not negative.
        chosen : (b) int array
            Numbers of the problems.
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
class ModalBatch:
    """Several problems in blocks, padded to one size.

    Attributes
    ----------
    sizes : (b) int array
        Number of segments of each problem.
    place : (b, p, m) int array
        Segment that stands here; the number of segments where padded.
    rows : (b, p, m, k + 1) array
        Of each segment: modes, then lever arm; zero where padded.
    separation : (b, p, m) array
        From first contact; positive where padded, so that nothing touches there.
    torque : (b) array
        Positive.
    """

    sizes: NDArray[np.intp]
    place: NDArray[np.intp]
    rows: Array
    separation: Array
    torque: Array

    @classmethod
    def of(
        cls, bases: Sequence[ModalBasis], lever_arms: Sequence[Array], separations: Sequence[Array], torque: Array
    ) -> ModalBatch:
        """Gather problems."""
        blocks, longest, rank = np.array([basis.modes.shape for basis in bases]).max(axis=0)
        sizes = np.array([basis.size for basis in bases])
        place = np.tile(sizes[:, None, None], (1, blocks, longest))
        rows = np.zeros((*place.shape, rank + 1))
        for own, own_rows, basis in zip(place, rows, bases, strict=True):
            p, m, k = basis.modes.shape
            own[:p, :m] = basis.index
            own_rows[:p, :m, :k] = basis.modes
        batch = cls(sizes, place, rows, np.empty(0), np.asarray(torque, dtype=np.float64))
        rows[..., -1] = batch.in_blocks(lever_arms, 0.0)
        return cls(sizes, place, rows, batch.in_blocks(separations, 1.0), batch.torque)

    def in_blocks(self, values: Sequence[Array], padding: float) -> Array:
        """Return values of the segments of every problem in blocks, (b, p, m)."""
        return np.stack([np.append(own, padding)[place] for own, place in zip(values, self.place, strict=True)])

    def by_segments(self, values: Array) -> list[Array]:
        """Return values in blocks (b, p, m) as an array (n) for every problem."""
        result = []
        for size, place, own in zip(self.sizes, self.place, values, strict=True):
            flat = np.zeros(size + 1)
            flat[place] = own
            result.append(flat[:-1])
        return result

    def part(self, chosen: NDArray[Any]) -> ModalBatch:
        """Return some of the problems."""
        return ModalBatch(*(getattr(self, field.name)[chosen] for field in fields(self)))

    def closing(self, amplitudes: Array, rotation: Array) -> Array:
        """Return U c - r theta of every segment, (b, p, m), of amplitudes (b, p, k) and rotations (b)."""
        turn = np.broadcast_to(-rotation[:, None, None], (*amplitudes.shape[:2], 1))
        return np.asarray((self.rows @ np.concatenate([amplitudes, turn], axis=2)[..., None])[..., 0])

    def loads(self, force: Array) -> Array:
        """Return [U r]'F of every block, (b, p, k + 1), of forces (b, p, m)."""
        return (force[..., None, :] @ self.rows)[..., 0, :]

    def start(self, force: Array, deflection: Array) -> tuple[Array, Array]:
        """Return amplitudes (b, p, k) and rotations (b) at which the torque does the work of given forces.

        Parameters
        ----------
        force, deflection : (b, p, m) array
            Forces that balance the torque, not negative, and the local deflections they cause. At least one segment is
            then in contact: the forces weigh the gaps so that their mean is minus the local deflection.
        """
        amplitudes = self.loads(force)[..., :-1]
        work = np.sum(amplitudes**2, axis=(1, 2)) + np.sum(force * (self.separation + deflection), axis=(1, 2))
        return amplitudes, work / self.torque


@dataclass(frozen=True, eq=False)
class BatchAnswer:
    """Where the iteration ended.

    Attributes
    ----------
    amplitudes : (b, p, k) array
    rotation : (b) array
    force : (b, p, m) array
    iterations : (b) int array
    ended : (b) bool array
        False where the method gave up; the rest means little there.
    """

    amplitudes: Array
    rotation: Array
    force: Array
    iterations: NDArray[np.intp]
    ended: NDArray[np.bool_]


def newton_batch(batch: ModalBatch, law: LocalLaw, amplitudes: Array, rotation: Array) -> BatchAnswer:
    """Solve all problems of a batch.

    Parameters
    ----------
    batch : ModalBatch
    law : LocalLaw
        Local compliance.
    amplitudes, rotation : (b, p, k) and (b) array
        Where to begin.
    """
    count = rotation.size
    best = np.full(count, np.inf)
    answer = BatchAnswer(
        np.array(amplitudes),
        np.array(rotation),
        np.zeros(batch.place.shape),
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
            answer.amplitudes[kept], answer.rotation[kept] = point.amplitudes[better], point.rotation[better]
            answer.force[kept] = point.force[better]
            done = (residual <= ROUNDING_RESIDUAL) | (~(residual < 0.5 * before) & (before < STALLED_RESIDUAL))
            answer.ended[chosen[done]] = True
            going = ~done & np.isfinite(residual)
            if not going.any():
                break
            if not going.all():
                chosen, batch, point = chosen[going], batch.part(going), point.part(going)
            point = _step(batch, law, chosen, point)
    return answer


@dataclass(frozen=True, eq=False)
class _Point:
    """A point of the iteration: amplitudes (b, p, k), rotation (b), gap, force, stiffness (b, p, m), loads."""

    amplitudes: Array
    rotation: Array
    gap: Array
    force: Array
    stiffness: Array
    loads: Array

    def part(self, chosen: NDArray[Any]) -> _Point:
        return _Point(*(getattr(self, field.name)[chosen] for field in fields(self)))


def _point(batch: ModalBatch, law: LocalLaw, chosen: NDArray[np.intp], amplitudes: Array, rotation: Array) -> _Point:
    gap = batch.closing(amplitudes, rotation) + batch.separation
    force, stiffness = law.response(np.maximum(-gap, 0.0), chosen)
    return _Point(amplitudes, rotation, gap, force, stiffness, batch.loads(force))


def _residual(batch: ModalBatch, point: _Point) -> Array:
    """Gradient of phi relative to its terms, (b)."""
    imbalance = np.abs(batch.torque - point.loads[..., -1].sum(axis=1)) / batch.torque
    amplitude = np.abs(point.amplitudes).max(axis=(1, 2), initial=0.0)
    left = np.abs(point.loads[..., :-1] - point.amplitudes).max(axis=(1, 2), initial=0.0)
    return np.asarray(np.maximum(imbalance, left / np.where(amplitude > 0.0, amplitude, 1.0)))


def _newton_direction(batch: ModalBatch, point: _Point) -> tuple[Array, Array]:
    """Change of amplitudes and rotation at which the gradient of phi would vanish if it were linear."""
    gram = (batch.rows * point.stiffness[..., None]).swapaxes(2, 3) @ batch.rows
    hessian = gram[..., :-1, :-1] + np.eye(gram.shape[-1] - 1)
    border = gram[..., :-1, -1]
    solved = np.linalg.solve(hessian, np.stack([border, point.loads[..., :-1] - point.amplitudes], axis=-1))
    pivot = gram[..., -1, -1].sum(axis=1) - np.sum(border * solved[..., 0], axis=(1, 2))
    imbalance = batch.torque - point.loads[..., -1].sum(axis=1)
    turn = (imbalance + np.sum(border * solved[..., 1], axis=(1, 2))) / pivot
    return solved[..., 1] + turn[:, None, None] * solved[..., 0], turn


def _step(batch: ModalBatch, law: LocalLaw, chosen: NDArray[np.intp], point: _Point) -> _Point:
    """Take Newton's step, or a half, a quarter ... of it: the longest along which phi surely falls.

    The slope of a convex function never decreases, so over a step a its change is at most a/2 (slope(a/2) + slope(a)).
    """
    change, turn = _newton_direction(batch, point)
    end = _point(batch, law, chosen, point.amplitudes + change, point.rotation + turn)
    slope, rounding = _slope(batch, end, change, turn)
    long = np.flatnonzero(slope > rounding)
    length = 1.0
    for _ in range(MAX_HALVINGS):
        if not long.size:
            break
        length *= 0.5
        part, begin, away, rotated = batch.part(long), point.part(long), change[long], turn[long]
        middle = _point(part, law, chosen[long], begin.amplitudes + length * away, begin.rotation + length * rotated)
        half_slope, _ = _slope(part, middle, away, rotated)
        shorten = half_slope + slope[long] > 0.0
        for field in fields(end):
            getattr(end, field.name)[long[shorten]] = getattr(middle, field.name)[shorten]
        slope[long] = half_slope
        long = long[shorten & (half_slope > rounding[long])]
    return end


def _slope(batch: ModalBatch, here: _Point, change: Array, turn: Array) -> tuple[Array, Array]:
    """Slope of phi at a point along a line, and what of it is rounding, (b)."""
    closing = batch.closing(change, turn)
    bending, local = np.sum(change * here.amplitudes, axis=(1, 2)), np.sum(here.force * closing, axis=(1, 2))
    work = batch.torque * turn
    return bending - local - work, ROUNDING_SLOPE * (np.abs(bending) + np.abs(local) + np.abs(work))
