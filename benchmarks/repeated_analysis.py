"""Processor time of an analysis, of what is repeated of it in a sweep, and of commands as whole processes.

Usage: python benchmarks/repeated_analysis.py [REPETITIONS]

Least time of all repetitions, BLAS on one thread: as seconds, as a share of the analysis with shells on lines, and in
units of a process that imports numpy, which is measured in the same run.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import platform
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from itertools import count
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from easeoff import analyze, read_case
from easeoff.cases import gear_pair
from easeoff.cases.conversion import elastic_model
from easeoff.cases.conversion import finite_elements
from easeoff.contact import MeshCycle
from easeoff.geometry import Misalignment, pair_geometry
from easeoff.geometry.flanks.flank import mean_parameters, seed_lattice
from tabulate import tabulate

CASE = "fm-11x41"
GRID = (51, 31)
ERRORS = Misalignment(0.1, -0.1, 0.05, 0.001)
PROGRAM = "from easeoff.study.cli import program; program()"
#: What commands are compared with, and the commands; {0} stands for a folder. The first ``run`` makes a result to show.
IMPORTS = ("import numpy", "import xarray")
COMMANDS = (
    f"run {CASE} -o {{0}}/result.nc",
    f"run {CASE} -o {{0}}/drawn.nc --plots {{0}}/pictures",
    "show {0}/result.nc",
    "report {0}/result.nc -o {0}/report.html",
    f"sheet {CASE} -o {{0}}/sheet.html",
    f"vh {CASE} -o {{0}}/vh.nc",
    "design fh-design-a -o {0}/case.toml --force",
    "cases",
    "--help",
)


def forget() -> None:
    """Empty what the geometry remembers of a flank."""
    mean_parameters.cache_clear()
    seed_lattice.cache_clear()


def least(work: Callable[[], Any], repetitions: int) -> float:
    """Least processor time of a call [s]; the first one warms up."""
    work()
    times = []
    for _ in range(repetitions):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def tasks() -> Iterator[tuple[str, Callable[[], Any]]]:
    """What is measured."""
    case = read_case(CASE)
    pair, settings = gear_pair(case), case.contact
    torques, nodes = list(settings.torques), (settings.lengthwise_nodes, settings.profile_nodes)
    shells = case.model_copy(update={"compliance": case.compliance.model_copy(update={"model": "shell"})})

    def analysis(of: Any, *, edges: bool) -> None:
        forget()
        model = elastic_model(of, finite_elements(of, pair))
        cycle = MeshCycle.of(pair_geometry(pair, nodes), model)
        cycle.unloaded()
        cycle.loaded(torques, edge_contact=edges)

    yield "analysis, shells on lines", lambda: analysis(shells, edges=False)
    yield "analysis, solid shells and edges", lambda: analysis(case, edges=True)
    yield "... as analyze, with all its numbers", lambda: analyze(case)
    cycle = MeshCycle.of(pair_geometry(pair, nodes), elastic_model(shells, None))
    cycle.loaded(torques, edge_contact=False)
    steps = count(1)

    def another() -> MeshCycle:
        return cycle.misaligned(Misalignment(offset=1e-3 * next(steps)))

    yield "further misalignment", lambda: another().loaded(torques, edge_contact=False)
    yield "further misalignment, forces alone", lambda: another().solved(torques)
    yield "further torque", lambda: cycle.loaded([100.0 + next(steps)], edge_contact=False)
    yield "further torque, forces alone", lambda: cycle.solved([100.0 + next(steps)])

    def grid() -> None:
        forget()
        pair_geometry(pair.misaligned(ERRORS), GRID)

    yield f"geometry of {GRID[0]} x {GRID[1]} nodes, misaligned", grid


def processes(repetitions: int) -> Iterator[tuple[str, float]]:
    """Processor time of imports and commands as processes [s], least of all."""
    # As users have it: modules are compiled once.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}

    def spent(words: list[str]) -> float:
        before = os.times()
        subprocess.run([sys.executable, "-c", *words], check=True, capture_output=True, env=environment)
        after = os.times()
        return after.children_user + after.children_system - before.children_user - before.children_system

    with TemporaryDirectory() as folder:
        named = {imported: [imported] for imported in IMPORTS}
        named |= {
            f"easeoff {command.replace(' --force', '').replace('{0}/', '')}": [PROGRAM, *command.format(folder).split()]
            for command in COMMANDS
        }
        for name, words in named.items():
            yield name, min(spent(words) for _ in range(repetitions + 1))


def main() -> None:
    """Print the table."""
    repetitions = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    print(f"{CASE}, {platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}\n")
    rows = [(name, least(work, repetitions)) for name, work in tasks()]
    rows += processes(max(repetitions // 3, 1))
    whole, unit = rows[0][1], dict(rows)[IMPORTS[0]]
    shares = [(name, seconds, seconds / whole, seconds / unit) for name, seconds in rows]
    print(tabulate(shares, headers=["", "s", "share", "import numpy"], floatfmt=("", ".4f", ".2f", ".1f")))


if __name__ == "__main__":
    main()
