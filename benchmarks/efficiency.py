"""Time of friction and efficiency after the contact solution, over torques, speeds, temperatures and roughnesses.

Usage: python benchmarks/efficiency.py [CASE] [REPETITIONS]
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import platform
import statistics
import sys
import time

import easeoff
import numpy as np
from easeoff.friction import FrictionModel, Operation, friction
from easeoff.friction.loaded_contacts import loaded_contacts
from easeoff.study.analysis.contact_analysis import contact_analysis
from easeoff.study import CaseInMesh
from tabulate import tabulate

TORQUES = np.linspace(100.0, 1000.0, 10)
OPERATION = Operation(np.linspace(150.0, 3000.0, 20), [30.0, 50.0, 75.0, 100.0], [0.1, 0.35, 0.6, 0.85, 1.0])
MODELS = ("kolivand_blended", "kolivand", "mixed_lubrication", "xu_kahraman", "benedict_kelly", "constant")


def main() -> None:
    """Print the table."""
    name = sys.argv[1] if len(sys.argv) > 1 else "fh-design-a"
    repetitions = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    start = time.perf_counter()
    tree = contact_analysis(CaseInMesh.of(easeoff.read_case(name)), tuple(TORQUES)).tree
    contact = time.perf_counter() - start
    contacts = loaded_contacts(tree).force.size
    conditions = int(np.prod(OPERATION.shape))
    print(f"{name}: {TORQUES.size} torques x {' x '.join(map(str, OPERATION.shape))}, one BLAS thread")
    print(f"{contacts} loaded segments, {contacts * conditions / 1e6:.1f} million friction coefficients")
    print(f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}\n")
    rows = []
    for model in MODELS:
        times = []
        for _ in range(repetitions + 1):
            start = time.perf_counter()
            friction(tree, OPERATION, FrictionModel(model), segment_fields=False)
            times.append(time.perf_counter() - start)
        median = statistics.median(times[1:])
        rows.append((model, median, min(times[1:]), 1e9 * median / (contacts * conditions), median / contact))
    headers = ["coefficient", "median s", "least s", "ns each", "of the analysis"]
    print(tabulate(rows, headers=headers, floatfmt=("", ".2f", ".2f", ".0f", ".2f")))


if __name__ == "__main__":
    main()
