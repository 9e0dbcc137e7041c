"""Time of the whole analysis of a shipped case, stage by stage, with BLAS pinned to one thread.

Usage: python benchmarks/analysis.py [CASE] [REPETITIONS]
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported
os.environ["EASEOFF_CACHE"] = ""  # elastic teeth are built every time

import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from easeoff.cases import gear_pair, read_case
from easeoff.cases.conversion import elastic_model, finite_elements
from easeoff.contact import lines_in_mesh, unloaded_contact
from easeoff.contact.loaded import loaded_splines
from easeoff.contact.compliance.elastic_model import ElasticTeeth
from easeoff.contact.loaded import CycleSolver
from easeoff.contact.segments import CycleSegments, LineSegments
from easeoff.geometry import pair_geometry
from easeoff.geometry.flanks.flank import mean_parameters, seed_lattice
from tabulate import tabulate

THESIS_SECONDS_PER_TORQUE = 45.0  # Kolivand 2009, section 3.4, on a 3.0 GHz PC


def stages(name: str) -> dict[str, Callable[[dict[str, Any]], Any]]:
    """The stages of an analysis in order; each reads the results of those before it by name."""
    case = read_case(name)
    pair = gear_pair(case)
    settings = case.contact
    torques = np.array(settings.torques)
    pitch, ratio = pair.assembly.pinion_pitch, pair.assembly.ratio
    nodes = (settings.lengthwise_nodes, settings.profile_nodes)

    def segments(r: dict[str, Any]) -> CycleSegments:
        teeth = ElasticTeeth(r["geometry"].teeth, r["elastic teeth"])
        on_lines = LineSegments(r["splines"], r["contact lines"], teeth, settings.segments_per_line)
        found = CycleSegments(r["splines"], on_lines)
        assert found.by_position
        return found

    return {
        "geometry": lambda r: pair_geometry(pair, nodes),
        "splines": lambda r: loaded_splines(r["geometry"].flanks, r["geometry"].ease_off, r["geometry"].teeth),
        "contact lines": lambda r: lines_in_mesh(r["splines"], pitch, settings.mesh_positions),
        "unloaded": lambda r: unloaded_contact(r["geometry"], r["splines"], r["contact lines"]),
        "elastic teeth": lambda r: elastic_model(case, finite_elements(case, pair)),
        "compliance": segments,
        "solve": lambda r: CycleSolver(ratio, settings.edge_contact).loaded(r["compliance"], torques),
    }


def measure(name: str, repetitions: int) -> dict[str, list[float]]:
    """Seconds of every stage in every repetition; nothing is remembered from one to the next."""
    steps = stages(name)
    times: dict[str, list[float]] = {stage: [] for stage in steps}
    for _ in range(repetitions + 1):
        mean_parameters.cache_clear()
        seed_lattice.cache_clear()
        results: dict[str, Any] = {}
        for stage, step in steps.items():
            start = time.perf_counter()
            results[stage] = step(results)
            times[stage].append(time.perf_counter() - start)
    return {stage: values[1:] for stage, values in times.items()}  # the first one warms up


def help_seconds(repetitions: int) -> float:
    """Median time of `easeoff --help` as a process."""
    command = [str(Path(sys.executable).parent / "easeoff"), "--help"]
    values = []
    for _ in range(repetitions + 1):
        start = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        values.append(time.perf_counter() - start)
    return statistics.median(values[1:])


def main() -> None:
    """Print the table."""
    name = sys.argv[1] if len(sys.argv) > 1 else "fm-11x41"
    repetitions = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    case = read_case(name)
    times = measure(name, repetitions)
    totals = [sum(values[i] for values in times.values()) for i in range(repetitions)]
    total = statistics.median(totals)
    torques = len(case.contact.torques)
    positions = case.contact.mesh_positions
    print(f"{name}: {torques} torques x {positions} mesh positions, one BLAS thread, {repetitions} runs")
    print(f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}\n")
    rows = [(stage, statistics.median(v), min(v), 100 * statistics.median(v) / total) for stage, v in times.items()]
    rows.append(("all", total, min(totals), 100.0))
    print(tabulate(rows, headers=["stage", "median s", "least s", "share %"], floatfmt=("", ".3f", ".3f", ".0f")))
    ratio = torques * THESIS_SECONDS_PER_TORQUE / total
    print(f"\nThe dissertation's {THESIS_SECONDS_PER_TORQUE:g} s per torque is {ratio:.0f} times as long.")
    print(f"easeoff --help: {help_seconds(5):.2f} s")


if __name__ == "__main__":
    main()
