"""Processor time of the geometry of a misaligned shipped pair, by stage and by size of the grid; BLAS on one thread.

Usage: python benchmarks/geometry.py [CASE] [REPETITIONS]
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import platform
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from easeoff.cases import gear_pair, read_case
from easeoff.geometry import GearPair, Misalignment, pair_geometry
from easeoff.geometry import principal_curvatures
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.flanks.flank import mean_parameters, seed_lattice
from easeoff.geometry.pair.gear_pair import bodies, grid
from tabulate import tabulate

NODES = (51, 31)
GRIDS = ((31, 21), (51, 31), (101, 51), (201, 101), (401, 201))
ERRORS = Misalignment(0.1, -0.1, 0.05, 0.001)


def stages(pair: GearPair, nodes: tuple[int, int]) -> dict[str, Callable[[dict[str, Any]], Any]]:
    """The stages of a pair's geometry in order; each reads the results of those before it by name."""
    t, h = grid(nodes)
    pinion, gear = pair.pinion, pair.gear
    return {
        "first guesses": lambda r: [seed_lattice(m.loaded, m.section) for m in (pinion, gear)],
        "pinion flank": lambda r: pinion.flank(t, h),
        "gear flank": lambda r: gear.flank(t, h),
        "ease-off": lambda r: exact_ease_off(r["gear flank"], pinion.loaded, pinion.section, pair.assembly),
        "curvatures": lambda r: [principal_curvatures(r[name]) for name in ("pinion flank", "gear flank")],
        "teeth": lambda r: bodies(pair),
    }


def forget() -> None:
    """Empty what the geometry remembers of a flank."""
    mean_parameters.cache_clear()
    seed_lattice.cache_clear()


def measure(steps: dict[str, Callable[[dict[str, Any]], Any]], repetitions: int) -> dict[str, list[float]]:
    """Seconds of every stage in every repetition; nothing is remembered from one to the next."""
    times: dict[str, list[float]] = {stage: [] for stage in steps}
    for _ in range(repetitions + 1):
        forget()
        results: dict[str, Any] = {}
        for stage, step in steps.items():
            start = time.process_time()
            results[stage] = step(results)
            times[stage].append(time.process_time() - start)
    return {stage: values[1:] for stage, values in times.items()}  # the first one warms up


def growth(pair: GearPair, repetitions: int) -> tuple[list[tuple[Any, ...]], float, float]:
    """Time of ``pair_geometry`` on ever finer grids, and the exponent of its growth with the nodes.

    The exponent is fitted over all grids, where the work that does not depend on the grid makes it small, and taken
    between the two finest.
    """
    rows: list[tuple[Any, ...]] = []
    for nodes in GRIDS:
        values = []
        for _ in range(repetitions + 1):
            forget()
            start = time.process_time()
            pair_geometry(pair, nodes)
            values.append(time.process_time() - start)
        count = nodes[0] * nodes[1]
        least = min(values[1:])
        rows.append((f"{nodes[0]} x {nodes[1]}", count, least, 1e6 * least / count))
    sizes, times = np.log([row[1] for row in rows]), np.log([row[2] for row in rows])
    return rows, float(np.polyfit(sizes, times, 1)[0]), float(np.diff(times)[-1] / np.diff(sizes)[-1])


def main() -> None:
    """Print both tables."""
    name = sys.argv[1] if len(sys.argv) > 1 else "nasa-12x36"
    repetitions = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    pair = gear_pair(read_case(name)).misaligned(ERRORS)
    times = measure(stages(pair, NODES), repetitions)
    totals = [sum(values[i] for values in times.values()) for i in range(repetitions)]
    total = statistics.median(totals)
    print(f"{name}, misaligned, {NODES[0]} x {NODES[1]} nodes, one BLAS thread, {repetitions} runs")
    print(f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}\n")
    rows = [(stage, statistics.median(v), min(v), 100 * statistics.median(v) / total) for stage, v in times.items()]
    rows.append(("all", total, min(totals), 100.0))
    print(tabulate(rows, headers=["stage", "median s", "least s", "share %"], floatfmt=("", ".4f", ".4f", ".0f")))
    grids, overall, at_the_end = growth(pair, min(repetitions, 3))
    print()
    print(tabulate(grids, headers=["grid", "nodes", "least s", "us per node"], floatfmt=("", "", ".3f", ".1f")))
    print(f"\nThe time grows with the nodes to the power {overall:.2f}, between the two finest grids {at_the_end:.2f}.")


if __name__ == "__main__":
    main()
