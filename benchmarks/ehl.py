"""Processor time of the film model: growth with the nodes, and the dense Jacobian beside the hierarchical one.

Usage: python benchmarks/ehl.py [NODES ...]
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from easeoff.friction.ehl import (
    Asperities,
    LubricatedContact,
    Oil,
    generated_profile,
    mixed_film,
    rough_passage,
    smooth_film,
)
from easeoff.friction.ehl import hierarchical_matrix as hierarchical
from easeoff.friction.ehl.hierarchical_matrix import Deflection, logarithm_of_hats
from easeoff.friction.ehl.reynolds_equation import balance
from scipy.linalg import lu_factor, lu_solve, toeplitz
from tabulate import tabulate

CONTACT = LubricatedContact(1e9, 0.02, 5.0, Oil(0.0499, 13.9e-9), slide_to_roll=0.25)
REPETITIONS, ROUGH_STEPS = 5, 8
LARGEST_DENSE, LARGEST_ROUGH = 2049, 1025


def milliseconds(call: Callable[..., object], *arguments: Any) -> float:
    """Least processor time of some calls."""
    times = []
    for _ in range(REPETITIONS):
        start = time.process_time()
        call(*arguments)
        times.append(time.process_time() - start)
    return 1e3 * min(times)


def smooth(nodes: int) -> object:
    """One smooth film."""
    return smooth_film(CONTACT, nodes=nodes)


def mixed(nodes: int) -> object:
    """One film with asperities that share the load."""
    return mixed_film(CONTACT, Asperities(1e-6, 20e-6), nodes=nodes)


def rough(nodes: int) -> object:
    """A few steps of rough surfaces."""
    profiles = [generated_profile(0.3e-6, 30e-6, 10e-3, seed) for seed in (1, 2)]
    return rough_passage(CONTACT, *profiles, steps=ROUGH_STEPS, nodes=nodes, ramp=0, settle=0)


def dense_solve(a: Any, c: Any, influence: Any, sides: Any) -> object:
    """Solve with a dense Jacobian: bands times influence, one LU factorisation."""
    n = sides.shape[0]
    matrix = np.zeros((n, n))
    for k, offset in enumerate(hierarchical.OFFSETS):
        rows = np.arange(max(0, -offset), n - max(0, offset))
        matrix[rows] += c[k, rows, None] * influence[rows + offset]
        matrix[rows, rows + offset] += a[k, rows]
    return lu_solve(lu_factor(matrix, overwrite_a=True, check_finite=False), sides, check_finite=False)


def measured(nodes: int) -> list[float]:
    """Times of a smooth and a mixed film, a linear solve, a deflection, a dense solve, a rough step and a passage."""
    film = smooth_film(CONTACT, nodes=nodes)
    assert film.certified
    point, spacing = film.outcome.point, film.problem.deflection.spacing
    flow = balance(CONTACT, spacing, point.pressure, point.film)
    a, c = flow.by_pressure, -spacing / np.pi * flow.by_film
    a[2, [0, -1]] = 1.0
    sides = np.random.default_rng(0).normal(size=(nodes, 2))
    deflection = Deflection(nodes, spacing)
    times = [
        milliseconds(smooth, nodes),
        milliseconds(mixed, nodes),
        milliseconds(hierarchical.solve, a, c, sides),
        milliseconds(deflection, point.pressure),
        np.nan,
        np.nan,
        np.nan,
    ]
    if nodes <= LARGEST_DENSE:
        times[4] = milliseconds(dense_solve, a, c, toeplitz(logarithm_of_hats(np.arange(nodes))), sides)
    if nodes <= LARGEST_ROUGH:
        times[5] = (milliseconds(rough, nodes) - times[0]) / ROUGH_STEPS
        times[6] = times[0] + nodes * times[5]  # once through the domain, one node a step
    return times


def main() -> None:
    """Print times in milliseconds, and the exponents of their growth."""
    sizes = [int(word) for word in sys.argv[1:]] or [129, 257, 513, 1025, 2049, 4097]
    times = np.array([measured(nodes) for nodes in sizes])
    names = ["smooth film", "mixed film", "linear solve", "deflection", "dense solve", "rough step", "passage"]
    print(tabulate([[n, *row] for n, row in zip(sizes, times, strict=True)], ["nodes", *names], floatfmt=".3g"))
    growth = np.diff(np.log(times), axis=0) / np.diff(np.log(sizes))[:, None]
    rows = [[f"{n} to {m}", *row] for n, m, row in zip(sizes, sizes[1:], growth, strict=False)]
    print(tabulate(rows, ["exponent", *names], floatfmt=".2f"))


if __name__ == "__main__":
    main()
