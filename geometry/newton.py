"""Two equations in two unknowns on all nodes at once: Cramer's rule, and Newton's method by complex steps.

The functions of this package that carry a flank are analytic, so an imaginary step of 1e-30 gives derivatives exact to
rounding (Squire & Trapp 1998, doi:10.1137/S003614459631241X); no step size has to be chosen.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..core.arrays import Array, Bools, Integers

Pair = Sequence[Array] | Array
COMPLEX_STEP = 1e-30
COLUMNS_PER_BLOCK = 1000  # so many that their intermediate results stay in the processor's cache


def complex_steps(
    function: Callable[[Array], Array], parameters: Array, count: int | None = None
) -> tuple[Array, Array]:
    """Values (..., n) and derivatives (count, ..., n) of an analytic function by its first parameters (m, n).

    Its n columns must be independent of one another.
    """
    count, n = parameters.shape[0] if count is None else count, parameters.shape[1]
    if n > COLUMNS_PER_BLOCK:
        starts = range(0, n, COLUMNS_PER_BLOCK)
        blocks = [complex_steps(function, parameters[:, i : i + COLUMNS_PER_BLOCK], count) for i in starts]
        values, slopes = zip(*blocks, strict=True)
        return np.concatenate(values, axis=-1), np.concatenate(slopes, axis=-1)
    stepped = np.empty((parameters.shape[0], count, n), dtype=complex)
    stepped[...] = parameters[:, None]
    for index in range(count):
        stepped.imag[index, index] += COMPLEX_STEP
    result = function(stepped.reshape(len(parameters), count * n))
    derivatives = (result.imag / COMPLEX_STEP).reshape(*result.shape[:-1], count, n)
    return result[..., :n].real, np.moveaxis(derivatives, -2, 0)


def determinant(first: Pair, second: Pair) -> Array:
    """Determinant (...) of matrices with the columns (2, ...) ``first`` and ``second``."""
    return np.asarray(first[0] * second[1] - first[1] * second[0])


def cramers_rule(first: Pair, second: Pair, right: Pair) -> Array:
    """Solution (2, ...) of first * x + second * y = right; infinite or NaN where the matrix is singular."""
    return np.stack([determinant(right, second), -determinant(right, first)]) / determinant(first, second)


@dataclass(frozen=True)
class NewtonResult:
    """Outcome of ``solve``: parameters (2, n), jacobian (coordinate, parameter, n) and where it converged (n)."""

    parameters: Array
    jacobian: Array
    converged: Bools


def solve(
    function: Callable[[Array], Array],
    start: Array,
    target: Array,
    max_step: Array,
    *,
    tolerance: float = 1e-11,
    iterations: int = 20,
) -> NewtonResult:
    """Solve ``function(parameters) = target`` column by column.

    Parameters
    ----------
    function
        Analytic map from (2, n) to (2, n).
    start
        First guess (2, n).
    target
        Right-hand side (2, n).
    max_step
        Largest change of each parameter in one iteration (2).
    tolerance
        Converged where the residual is below this times the size of the targets and the last step was small.
    iterations
        Iteration limit.

    Returns
    -------
    NewtonResult
        NaN parameters never appear; look at ``converged``.
    """
    return solve_by(
        lambda p, _: complex_steps(function, p), start, target, max_step, tolerance=tolerance, iterations=iterations
    )


def solve_by(
    derivatives: Callable[[Array, Integers], tuple[Array, Array]],
    start: Array,
    target: Array,
    max_step: Array,
    *,
    tolerance: float = 1e-11,
    iterations: int = 20,
) -> NewtonResult:
    """As ``solve``, of a function that gives values (2, k) and derivatives (2, 2, k) at parameters (2, k) itself.

    Its second argument holds the numbers (k) of the columns: all first, then those that have not converged.
    """
    parameters = np.array(start, dtype=float)
    count = parameters.shape[1]
    jacobian = np.full((2, 2, count), np.nan)
    converged = np.zeros(count, dtype=bool)
    numbers = np.arange(count)
    active: Any = slice(None)  # of all columns, and then their numbers
    size = tolerance * max(1.0, float(np.max(np.abs(target), initial=0.0)))
    limit = np.asarray(max_step)[:, None]
    with np.errstate(all="ignore"):
        for _ in range(iterations):
            value, (first, second) = derivatives(parameters[:, active], numbers)
            residual = target[:, active] - value
            step = cramers_rule(first, second, residual)
            usable = np.all(np.isfinite(step), axis=0)
            scale = np.maximum(1.0, np.max(np.abs(step) / limit, axis=0))
            step = np.where(usable, step / scale, 0.0)
            jacobian[:, 0, active], jacobian[:, 1, active] = first, second
            parameters[:, active] += step
            # The residual was measured before the step; a converged node has taken one more step than it needed.
            done = usable & (np.max(np.abs(residual), axis=0) < size)
            converged[numbers[done]] = True
            left = usable & ~done
            if not left.all():
                active = numbers = numbers[left]
            if numbers.size == 0:
                break
    return NewtonResult(parameters, jacobian, converged)
