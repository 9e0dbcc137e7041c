"""What it saves to translate a contact problem for CVXPY once and then set its numbers, by size; BLAS on one thread.

Usage: python benchmarks/parametrised.py [SIZE ...]
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import statistics
import sys
import time
from typing import Any

import numpy as np
from easeoff.contact import ContactProblem, solve
from easeoff.contact import SOLVERS
from easeoff.contact.solvers.adapters.cvxpy import solve_scaled
from forms import structured_problem
from tabulate import tabulate

REPETITIONS = 9
LARGEST_DENSE = 200  # beyond, the root of a dense compliance takes too long


def milliseconds(problem: ContactProblem, **settings: Any) -> tuple[float, float]:
    """Time of the first call, and the median of the others."""
    scaled = problem.scaled()
    times = []
    for _ in range(REPETITIONS):
        start = time.process_time()
        solve_scaled(scaled, {**SOLVERS["cvxpy"].settings, **settings})
        times.append(1e3 * (time.process_time() - start))
    return times[0], statistics.median(times[1:])


def main() -> None:
    """Print the table: the dense form written out as the unit of every row."""
    sizes = [int(word) for word in sys.argv[1:]] or [15, 30, 60, 93, 150, 240, 399, 999]
    solve(structured_problem(9, np.random.default_rng(1)), "cvxpy", parametrised=False)  # loads CVXPY
    rows = []
    for size in sizes:
        problem = structured_problem(size, np.random.default_rng(1))
        _, unit = milliseconds(problem, parametrised=False)
        row: list[object] = [problem.size, f"{unit:.1f}"]
        for settings in ({"form": "dense"}, {"form": "lifted"}):
            if settings["form"] == "dense" and problem.size > LARGEST_DENSE:
                row += ["", ""]
                continue
            first, again = milliseconds(problem, parametrised=True, **settings)
            row += [f"{first / unit:.1f}", f"{again / unit:.2f}"]
        rows.append(row)
    heads = ["dense: first", "dense: again", "lifted: first", "lifted: again"]
    print(tabulate(rows, headers=["n", "written out [ms]", *heads], disable_numparse=True))


if __name__ == "__main__":
    main()
