"""The modal method as one compiled loop: the same steps as `modal_newton`, ten times faster on small problems.

Needs numba, and is imported only where that is installed. The first use compiles, which takes some twenty seconds; the
result is kept on disk. What differs from the array form: the Gram matrices are updated by the few segments that have
opened or closed, until the last set is found.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: The sum in a product may be taken in any order, so that it can use vector registers; nothing else is relaxed.
ORDER_IS_FREE = {"reassoc", "contract"}

#: Rows are padded with zeros to a multiple of this, so that no loop over a row has a rest.
VECTOR = 8

Function = TypeVar("Function", bound=Callable[..., Any])


def _compiled(**options: Any) -> Callable[[Function], Function]:
    """Numba's decorator, with the type of the function kept and the compiled code kept on disk."""

    def compile_function(function: Function) -> Function:
        return cast(Function, njit(cache=True, **options)(function))

    return compile_function


#: What `newton` returns instead of a number of iterations.
NOT_SOLVABLE, NOT_ENDED = -1, -2


@_compiled(fastmath=ORDER_IS_FREE, error_model="numpy")
def newton(
    index: NDArray[np.intp],
    modes: Array,
    mode_unit: float,
    local: Array,
    lever_arm: Array,
    separation: Array,
    torque: float,
    start: NDArray[np.bool_],
    max_iterations: int,
    rounding: float,
) -> tuple[int, float, Array]:
    """Return the iterations (negative on failure), the rotation and the forces (n); arguments as in `ModalSystem`."""
    blocks, longest, rank = modes.shape
    size = local.size
    width = -(-(rank + 2) // VECTOR) * VECTOR
    rows = np.zeros((blocks, longest, width))
    counts = np.zeros(blocks, dtype=np.intp)
    stiffness, gap = np.zeros((blocks, longest)), np.ones((blocks, longest))
    active, entered = np.zeros((blocks, longest), dtype=np.bool_), np.zeros((blocks, longest), dtype=np.bool_)
    largest_arm = 0.0
    for p in range(blocks):
        for i in range(longest):
            segment = index[p, i]
            if segment == size:
                break
            counts[p] += 1
            for a in range(rank):
                rows[p, i, a] = mode_unit * modes[p, i, a]
            rows[p, i, rank] = lever_arm[segment]
            rows[p, i, rank + 1] = separation[segment]
            stiffness[p, i] = 1.0 / local[segment]
            active[p, i] = start[segment]
            largest_arm = max(largest_arm, abs(lever_arm[segment]))
    gram = np.zeros((blocks, width, width))
    factor, inverse_diagonal = np.empty((blocks, rank, width)), np.empty((blocks, rank))
    weights, new_weights = np.zeros((blocks, width)), np.zeros((blocks, width))
    new_gap = gap.copy()
    force = np.zeros(size)
    rotation, energy, has_point = 0.0, 0.0, False
    for iteration in range(1, max_iterations + 1):
        if not _turns(rows, counts, active, rank):
            _close_first(rows, counts, active, rank)
        _update_gram(rows, counts, stiffness, active, entered, gram, rank + 2)
        pivot, new_rotation = _newton_point(gram, factor, inverse_diagonal, torque, new_weights)
        if not 0.0 < pivot < np.inf:
            return NOT_SOLVABLE, 0.0, force
        local_energy = _gaps(rows, counts, stiffness, new_weights, new_gap)
        worst, largest, changed = 0.0, 0.0, 0
        for p in range(blocks):
            for i in range(counts[p]):
                if active[p, i]:
                    largest = max(largest, abs(new_gap[p, i]))
                if (new_gap[p, i] < 0.0) != active[p, i]:
                    changed += 1
                    worst = max(worst, abs(new_gap[p, i]))
        if changed == 0 or worst <= rounding * (largest + abs(new_rotation) * largest_arm):
            if iteration > 1:
                # From the sums of the last set alone: then the answer does not depend on the start, to the bit.
                gram[:] = 0.0
                entered[:] = False
                _update_gram(rows, counts, stiffness, active, entered, gram, rank + 2)
                pivot, new_rotation = _newton_point(gram, factor, inverse_diagonal, torque, new_weights)
                _gaps(rows, counts, stiffness, new_weights, new_gap)
            rotation = _refine(
                rows, counts, stiffness, factor, inverse_diagonal, pivot, torque, new_weights, new_rotation, new_gap
            )
            for p in range(blocks):
                for i in range(counts[p]):
                    force[index[p, i]] = max(-new_gap[p, i], 0.0) * stiffness[p, i]
            return iteration, rotation, force
        modal_energy = 0.5 * np.sum(new_weights[:, :rank] ** 2)
        new_energy = modal_energy + local_energy - torque * new_rotation
        scale = modal_energy + local_energy + abs(torque * new_rotation)
        length = 1.0
        if has_point and new_energy >= energy - rounding * scale:
            length = _exact_step(
                counts,
                stiffness,
                weights[:, :rank],
                new_weights[:, :rank],
                torque * (new_rotation - rotation),
                gap,
                new_gap,
            )
        if length == 1.0:
            rotation, energy = new_rotation, new_energy
            weights, new_weights = new_weights, weights
            gap, new_gap = new_gap, gap
        else:
            rotation += length * (new_rotation - rotation)
            weights += length * (new_weights - weights)
            gap += length * (new_gap - gap)
            closed = np.minimum(gap, 0.0)
            energy = 0.5 * (np.sum(weights[:, :rank] ** 2) + np.sum(closed**2 * stiffness)) - torque * rotation
        has_point = True
        for p in range(blocks):
            for i in range(counts[p]):
                active[p, i] = gap[p, i] < 0.0
    return NOT_ENDED, 0.0, force


@_compiled()
def _turns(rows: Array, counts: NDArray[np.intp], active: NDArray[np.bool_], arm: int) -> bool:
    """Whether an active segment has a lever arm."""
    for p in range(rows.shape[0]):
        for i in range(counts[p]):
            if active[p, i] and rows[p, i, arm] != 0.0:
                return True
    return False


@_compiled()
def _close_first(rows: Array, counts: NDArray[np.intp], active: NDArray[np.bool_], arm: int) -> None:
    """Make active the segment that touches first as the rigid bodies turn."""
    best, block, place = np.inf, -1, -1
    for p in range(rows.shape[0]):
        for i in range(counts[p]):
            if rows[p, i, arm] > 0.0 and rows[p, i, arm + 1] / rows[p, i, arm] < best:
                best, block, place = rows[p, i, arm + 1] / rows[p, i, arm], p, i
    active[block, place] = True


@_compiled(fastmath=ORDER_IS_FREE)
def _update_gram(
    rows: Array,
    counts: NDArray[np.intp],
    stiffness: Array,
    active: NDArray[np.bool_],
    entered: NDArray[np.bool_],
    gram: Array,
    used: int,
) -> None:
    """Bring [U r S]'W [U r S] from the segments entered in it to the active ones, block by block."""
    width = rows.shape[2]
    flipped, sign = np.empty(rows.shape[1] + 3, dtype=np.intp), np.empty(rows.shape[1] + 3)
    for p in range(rows.shape[0]):
        flips, touching = 0, 0
        for i in range(counts[p]):
            flips += active[p, i] != entered[p, i]
            touching += active[p, i]
        if flips > touching:
            gram[p] = 0.0
            entered[p] = False
        flips = 0
        for i in range(counts[p]):
            if active[p, i] != entered[p, i]:
                flipped[flips], sign[flips] = i, stiffness[p, i] if active[p, i] else -stiffness[p, i]
                entered[p, i] = active[p, i]
                flips += 1
        # Four rows at a time: the matrix is loaded and stored a fourth as often. The last few count with weight zero.
        for extra in range(3):
            flipped[flips + extra], sign[flips + extra] = 0, 0.0
        for four in range(0, flips, 4):
            r0, r1, r2, r3 = (
                rows[p, flipped[four]],
                rows[p, flipped[four + 1]],
                rows[p, flipped[four + 2]],
                rows[p, flipped[four + 3]],
            )
            for a in range(used):
                f0, f1, f2, f3 = (
                    sign[four] * r0[a],
                    sign[four + 1] * r1[a],
                    sign[four + 2] * r2[a],
                    sign[four + 3] * r3[a],
                )
                line = gram[p, a]
                for b in range(width):
                    line[b] += f0 * r0[b] + f1 * r1[b] + f2 * r2[b] + f3 * r3[b]


@_compiled(fastmath=ORDER_IS_FREE, error_model="numpy")
def _factor_blocks(gram: Array, factor: Array, inverse_diagonal: Array) -> tuple[float, float]:
    """Factor I + U'WU of every block, bordered by lever arm and separation; return pivot and level of the rotation.

    The factor is R, upper triangular, with R'R the block; the two columns beyond hold R'^-1 U'W r and R'^-1 U'W S.
    Below the diagonal there is rounding: loops over whole rows are faster than triangular ones.
    """
    blocks, rank, width = factor.shape
    pivot, level = 0.0, 0.0
    for p in range(blocks):
        upper, inverse = factor[p], inverse_diagonal[p]
        for b in range(rank):
            line = upper[b]
            for a in range(width):
                line[a] = gram[p, b, a]
            line[b] += 1.0
            k = 0
            while k + 3 < b:
                f0, f1, f2, f3 = upper[k, b], upper[k + 1, b], upper[k + 2, b], upper[k + 3, b]
                for a in range(width):
                    line[a] -= f0 * upper[k, a] + f1 * upper[k + 1, a] + f2 * upper[k + 2, a] + f3 * upper[k + 3, a]
                k += 4
            while k < b:
                f0 = upper[k, b]
                for a in range(width):
                    line[a] -= f0 * upper[k, a]
                k += 1
            inverse[b] = 1.0 / np.sqrt(line[b])
            for a in range(width):
                line[a] *= inverse[b]
        pivot += gram[p, rank, rank]
        level += gram[p, rank, rank + 1]
        for a in range(rank):
            pivot -= upper[a, rank] * upper[a, rank]
            level -= upper[a, rank] * upper[a, rank + 1]
    return pivot, level


@_compiled(fastmath=ORDER_IS_FREE, error_model="numpy")
def _newton_point(
    gram: Array, factor: Array, inverse_diagonal: Array, torque: float, weights: Array
) -> tuple[float, float]:
    """Set amplitudes, -theta and 1 at which phi would be least if no segment opened or closed; return pivot, theta."""
    blocks, rank, _ = factor.shape
    pivot, level = _factor_blocks(gram, factor, inverse_diagonal)
    rotation = (torque + level) / pivot
    for p in range(blocks):
        for a in range(rank):
            weights[p, a] = rotation * factor[p, a, rank] - factor[p, a, rank + 1]
        _back_substitute(factor[p], inverse_diagonal[p], weights[p])
        weights[p, rank] = -rotation
        weights[p, rank + 1] = 1.0
    return pivot, rotation


@_compiled(fastmath=ORDER_IS_FREE)
def _back_substitute(upper: Array, inverse: Array, side: Array) -> None:
    """Solve R x = side in place; what `side` has beyond the size of R is left alone."""
    rank = inverse.size
    for a in range(rank - 1, -1, -1):
        value = side[a]
        for k in range(a + 1, rank):
            value -= upper[a, k] * side[k]
        side[a] = value * inverse[a]


@_compiled(fastmath=ORDER_IS_FREE)
def _gaps(rows: Array, counts: NDArray[np.intp], stiffness: Array, weights: Array, gap: Array) -> float:
    """Set the gaps, the rows weighted by amplitudes, -theta and 1, and return the energy of the local compliance."""
    width = rows.shape[2]
    energy = 0.0
    for p in range(rows.shape[0]):
        weight = weights[p]
        for i in range(counts[p]):
            row = rows[p, i]
            value = 0.0
            for a in range(width):
                value += row[a] * weight[a]
            gap[p, i] = value
            closed = min(value, 0.0)
            energy += 0.5 * stiffness[p, i] * closed * closed
    return energy


@_compiled(fastmath=ORDER_IS_FREE)
def _refine(
    rows: Array,
    counts: NDArray[np.intp],
    stiffness: Array,
    factor: Array,
    inverse_diagonal: Array,
    pivot: float,
    torque: float,
    weights: Array,
    rotation: float,
    gap: Array,
) -> float:
    """Take one step of refinement on the gradient of phi, and return the rotation."""
    blocks, width = weights.shape
    rank = inverse_diagonal.shape[1]
    residual, imbalance = np.zeros((blocks, width)), torque
    for p in range(blocks):
        side, upper = residual[p], factor[p]
        for a in range(rank):
            side[a] = -weights[p, a]
        for i in range(counts[p]):
            if gap[p, i] < 0.0:
                force, row = -gap[p, i] * stiffness[p, i], rows[p, i]
                for a in range(width):
                    side[a] += force * row[a]
        imbalance -= side[rank]
        for a in range(rank):
            side[a] *= inverse_diagonal[p, a]
            for k in range(a + 1, rank):
                side[k] -= upper[a, k] * side[a]
            imbalance += upper[a, rank] * side[a]
    turn = imbalance / pivot
    for p in range(blocks):
        for a in range(rank):
            residual[p, a] += turn * factor[p, a, rank]
        _back_substitute(factor[p], inverse_diagonal[p], residual[p])
        for a in range(rank):
            weights[p, a] += residual[p, a]
        weights[p, rank] = -(rotation + turn)
    _gaps(rows, counts, stiffness, weights, gap)
    return rotation + turn


@_compiled(error_model="numpy")
def _exact_step(
    counts: NDArray[np.intp],
    stiffness: Array,
    amplitudes: Array,
    new_amplitudes: Array,
    work: float,
    gap: Array,
    new_gap: Array,
) -> float:
    """Return the step length that minimises phi; see `modal_newton.exact_step`."""
    change = new_amplitudes - amplitudes
    level, growth = np.sum(amplitudes * change) - work, np.sum(change * change)
    place, levels, growths = np.empty(gap.size), np.empty(gap.size), np.empty(gap.size)
    kinks = 0
    for p in range(gap.shape[0]):
        for i in range(counts[p]):
            slope = new_gap[p, i] - gap[p, i]
            closed = gap[p, i] < 0.0 or (gap[p, i] == 0.0 and slope < 0.0)
            own_level, own_growth = stiffness[p, i] * gap[p, i] * slope, stiffness[p, i] * slope * slope
            if closed:
                level += own_level
                growth += own_growth
            if (closed and new_gap[p, i] > 0.0) or (not closed and new_gap[p, i] < 0.0):
                sign = -1.0 if closed else 1.0
                place[kinks], levels[kinks], growths[kinks] = -gap[p, i] / slope, sign * own_level, sign * own_growth
                kinks += 1
    begin = 0.0
    for kink in np.argsort(place[:kinks]):
        if level + growth * place[kink] >= 0.0:
            return min(max(-level / growth, begin), place[kink]) if growth > 0.0 else begin
        level += levels[kink]
        growth += growths[kink]
        begin = place[kink]
    if level + growth >= 0.0 and growth > 0.0:
        return min(max(-level / growth, begin), 1.0)
    return 1.0
