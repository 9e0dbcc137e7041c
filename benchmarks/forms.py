"""Time of the sparse backends on structured contact problems in the dense and in the lifted form, BLAS on one thread.

Usage: python benchmarks/forms.py [SIZE ...]
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import statistics
import sys
import time

import numpy as np
from easeoff.contact import ContactProblem, available_solvers, solve
from easeoff.contact.problem.modal_basis import modal_basis
from easeoff.contact import SOLVERS
from tabulate import tabulate

PAIRS, MODES, REPETITIONS = 3, 40, 3


def structured_problem(size: int, rng: np.random.Generator) -> ContactProblem:
    """Three tooth pairs under inclined contact lines, with modes along the face times powers of the height."""
    per_pair = size // PAIRS
    along = np.linspace(-1.0, 1.0, per_pair)
    factor, separation = np.zeros((PAIRS * per_pair, PAIRS * MODES)), []
    for pair in range(PAIRS):
        height = np.clip(0.5 + 0.4 * along + 0.25 * (pair - 1), 0.0, 1.0)
        shapes = np.polynomial.legendre.legvander(along, 7) / (1.0 + np.arange(8))
        modes = [shapes * ((0.15 + height**1.5) * height**power)[:, None] for power in range(MODES // 8)]
        rows = slice(pair * per_pair, (pair + 1) * per_pair)
        factor[rows, pair * MODES : (pair + 1) * MODES] = np.sqrt(3e-6) * np.hstack(modes)
        separation.append(0.032 * (along - 0.2) ** 2 + 0.018 * (2.0 * height - 1.0) ** 2 + 0.004 * (pair - 1) ** 2)
    n = PAIRS * per_pair
    diagonal = 3e-6 * rng.uniform(0.7, 1.5, n) * n / 60.0  # a shorter segment yields more
    return ContactProblem(np.concatenate(separation), rng.normal(42.0, 1.0, n), 5e5, (diagonal, factor))


def milliseconds(problem: ContactProblem, name: str, form: str) -> float:
    """Median time of one unpolished call; the matrix C and the scales are known beforehand."""
    times = []
    for _ in range(REPETITIONS):
        start = time.process_time()
        solve(problem, name, form=form, polish=False)
        times.append(1e3 * (time.process_time() - start))
    return statistics.median(times)


def main() -> None:
    """Print the table."""
    sizes = [int(word) for word in sys.argv[1:]] or [60, 150, 240, 399, 600, 999]
    names = [name for name in available_solvers() if name in SOLVERS and SOLVERS[name].lifted_from is not None]
    rows = []
    for size in sizes:
        problem = structured_problem(size, np.random.default_rng(1))
        assert solve(problem).certified
        kept = modal_basis(problem.compliance[1]).factor.shape[1]
        cells = [
            " -> ".join(f"{milliseconds(problem, name, form):.1f}" for form in ("dense", "lifted")) for name in names
        ]
        rows.append([problem.size, kept, *cells])
    print(tabulate(rows, headers=["n", "modes kept", *names]))


if __name__ == "__main__":
    main()
