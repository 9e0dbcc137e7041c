"""The modal method as one compiled loop: the same steps as `modal_newton`, ten times faster on small problems.

Needs numba, and is imported only where that is installed. The first use compiles, which takes some seconds; the result
is kept on disk. What differs from the array form: the Gram matrices are updated by the few segments that have opened
or closed, which leaves rounding that the refinement at the end removes.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: The sum in a product may be taken in any order, so that it can use vector registers; nothing else is relaxed.
ORDER_IS_FREE = {"reassoc", "contract"}

#: What `newton` returns instead of a number of iterations.
NOT_SOLVABLE, NOT_ENDED = -1, -2


@njit(cache=True, fastmath=ORDER_IS_FREE, error_model="numpy")
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
    width, size = rank + 2, local.size
    rows = np.empty((blocks, longest, width))
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
    gram, factor = np.zeros((blocks, width, width)), np.empty((blocks, rank, rank))
    solved = np.empty((2, blocks, rank))
    amplitudes, new_amplitudes = np.zeros((blocks, rank)), np.empty((blocks, rank))
    new_gap = gap.copy()
    force = np.zeros(size)
    rotation, energy, has_point = 0.0, 0.0, False
    for iteration in range(1, max_iterations + 1):
        if not _turns(rows, counts, active):
            _close_first(rows, counts, active)
        _update_gram(rows, counts, stiffness, active, entered, gram)
        pivot, level = _solve_blocks(gram, factor, solved)
        if not 0.0 < pivot < np.inf:
            return NOT_SOLVABLE, 0.0, force
        new_rotation = (torque + level) / pivot
        for p in range(blocks):
            for a in range(rank):
                new_amplitudes[p, a] = new_rotation * solved[0, p, a] - solved[1, p, a]
        local_energy = _gaps(rows, counts, stiffness, new_amplitudes, new_rotation, new_gap)
        worst, largest, changed = 0.0, 0.0, 0
        for p in range(blocks):
            for i in range(counts[p]):
                if active[p, i]:
                    largest = max(largest, abs(new_gap[p, i]))
                if (new_gap[p, i] < 0.0) != active[p, i]:
                    changed += 1
                    worst = max(worst, abs(new_gap[p, i]))
        if changed == 0 or worst <= rounding * (largest + abs(new_rotation) * largest_arm):
            rotation = _refine(
                rows, counts, stiffness, gram, factor, solved, pivot, torque, new_amplitudes, new_rotation, new_gap
            )
            for p in range(blocks):
                for i in range(counts[p]):
                    force[index[p, i]] = max(-new_gap[p, i], 0.0) * stiffness[p, i]
            return iteration, rotation, force
        modal_energy = 0.5 * np.sum(new_amplitudes * new_amplitudes)
        new_energy = modal_energy + local_energy - torque * new_rotation
        scale = modal_energy + local_energy + abs(torque * new_rotation)
        length = 1.0
        if has_point and new_energy > energy + rounding * scale:
            length = _exact_step(
                counts, stiffness, amplitudes, new_amplitudes, torque * (new_rotation - rotation), gap, new_gap
            )
        if length == 1.0:
            rotation, energy = new_rotation, new_energy
            amplitudes[:] = new_amplitudes
            gap[:] = new_gap
        else:
            rotation += length * (new_rotation - rotation)
            amplitudes += length * (new_amplitudes - amplitudes)
            gap += length * (new_gap - gap)
            closed = np.minimum(gap, 0.0)
            energy = 0.5 * (np.sum(amplitudes * amplitudes) + np.sum(closed * closed * stiffness)) - torque * rotation
        has_point = True
        for p in range(blocks):
            for i in range(counts[p]):
                active[p, i] = gap[p, i] < 0.0
    return NOT_ENDED, 0.0, force


@njit(cache=True)
def _turns(rows: Array, counts: NDArray[np.intp], active: NDArray[np.bool_]) -> bool:
    """Whether an active segment has a lever arm."""
    arm = rows.shape[2] - 2
    for p in range(rows.shape[0]):
        for i in range(counts[p]):
            if active[p, i] and rows[p, i, arm] != 0.0:
                return True
    return False


@njit(cache=True)
def _close_first(rows: Array, counts: NDArray[np.intp], active: NDArray[np.bool_]) -> None:
    """Make active the segment that touches first as the rigid bodies turn."""
    arm = rows.shape[2] - 2
    best, block, place = np.inf, -1, -1
    for p in range(rows.shape[0]):
        for i in range(counts[p]):
            if rows[p, i, arm] > 0.0 and rows[p, i, arm + 1] / rows[p, i, arm] < best:
                best, block, place = rows[p, i, arm + 1] / rows[p, i, arm], p, i
    active[block, place] = True


@njit(cache=True, fastmath=ORDER_IS_FREE)
def _update_gram(
    rows: Array,
    counts: NDArray[np.intp],
    stiffness: Array,
    active: NDArray[np.bool_],
    entered: NDArray[np.bool_],
    gram: Array,
) -> None:
    """Bring [U r S]'W [U r S] from the segments entered in it to the active ones, block by block."""
    width = rows.shape[2]
    for p in range(rows.shape[0]):
        flips, touching = 0, 0
        for i in range(counts[p]):
            flips += active[p, i] != entered[p, i]
            touching += active[p, i]
        if flips > touching:
            gram[p] = 0.0
            entered[p] = False
        for i in range(counts[p]):
            if active[p, i] == entered[p, i]:
                continue
            entered[p, i] = active[p, i]
            weight = stiffness[p, i] if active[p, i] else -stiffness[p, i]
            row = rows[p, i]
            for a in range(width):
                factor = weight * row[a]
                for b in range(width):
                    gram[p, a, b] += factor * row[b]


@njit(cache=True, fastmath=ORDER_IS_FREE, error_model="numpy")
def _solve_blocks(gram: Array, factor: Array, solved: Array) -> tuple[float, float]:
    """Factor I + U'WU of every block, solve for both borders, and return pivot and level of the rotation."""
    rank = factor.shape[1]
    pivot, level = 0.0, 0.0
    for p in range(gram.shape[0]):
        lower = factor[p]
        for a in range(rank):
            for b in range(a + 1):
                value = gram[p, a, b]
                for k in range(b):
                    value -= lower[a, k] * lower[b, k]
                lower[a, b] = np.sqrt(1.0 + value) if a == b else value / lower[b, b]
        for side in range(2):
            for a in range(rank):
                solved[side, p, a] = gram[p, rank + side, a]
            _substitute(lower, solved[side, p])
        pivot += gram[p, rank, rank]
        level += gram[p, rank, rank + 1]
        for a in range(rank):
            pivot -= gram[p, rank, a] * solved[0, p, a]
            level -= gram[p, rank, a] * solved[1, p, a]
    return pivot, level


@njit(cache=True, fastmath=ORDER_IS_FREE)
def _substitute(lower: Array, side: Array) -> None:
    """Solve L L' x = side in place."""
    rank = side.size
    for a in range(rank):
        value = side[a]
        for k in range(a):
            value -= lower[a, k] * side[k]
        side[a] = value / lower[a, a]
    for a in range(rank - 1, -1, -1):
        side[a] /= lower[a, a]
        for k in range(a):
            side[k] -= lower[a, k] * side[a]


@njit(cache=True, fastmath=ORDER_IS_FREE)
def _gaps(
    rows: Array, counts: NDArray[np.intp], stiffness: Array, amplitudes: Array, rotation: float, gap: Array
) -> float:
    """Set the gaps at given amplitudes and rotation, and return the energy of the local compliance."""
    rank = amplitudes.shape[1]
    energy = 0.0
    for p in range(rows.shape[0]):
        for i in range(counts[p]):
            value = 0.0
            for a in range(rank):
                value += rows[p, i, a] * amplitudes[p, a]
            value += rows[p, i, rank + 1] - rotation * rows[p, i, rank]
            gap[p, i] = value
            if value < 0.0:
                energy += 0.5 * stiffness[p, i] * value * value
    return energy


@njit(cache=True, fastmath=ORDER_IS_FREE)
def _refine(
    rows: Array,
    counts: NDArray[np.intp],
    stiffness: Array,
    gram: Array,
    factor: Array,
    solved: Array,
    pivot: float,
    torque: float,
    amplitudes: Array,
    rotation: float,
    gap: Array,
) -> float:
    """Take one step of refinement on the gradient of phi, and return the rotation."""
    blocks, rank = amplitudes.shape
    residual, imbalance = -amplitudes, torque
    for p in range(blocks):
        for i in range(counts[p]):
            if gap[p, i] < 0.0:
                force = -gap[p, i] * stiffness[p, i]
                for a in range(rank):
                    residual[p, a] += force * rows[p, i, a]
                imbalance -= force * rows[p, i, rank]
    for p in range(blocks):
        _substitute(factor[p], residual[p])
        for a in range(rank):
            imbalance += gram[p, rank, a] * residual[p, a]
    turn = imbalance / pivot
    amplitudes += residual + turn * solved[0]
    rotation += turn
    _gaps(rows, counts, stiffness, amplitudes, rotation, gap)
    return rotation


@njit(cache=True, error_model="numpy")
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
