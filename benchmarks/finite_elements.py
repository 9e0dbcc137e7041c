"""Finite elements of generated teeth: cost, convergence, and the shell beside them. Prints Markdown tables.

``python benchmarks/finite_elements.py [cost] [shell] [body] [split] [figure] [reference]``: all of them if none is
named. The last one writes what ``test_solid_shell.py`` compares with.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import resource
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from tabulate import tabulate

from easeoff.contact import ElasticModel
from easeoff.contact.compliance.elastic_model import shells
from easeoff.contact import ElasticFoundation
from easeoff.contact.compliance.finite_elements.finite_element_tooth import usual_size
from easeoff.contact.compliance.shell_kinematics import five_field
from easeoff.core.output_file import whole_file
from easeoff.geometry import pair_geometry
from easeoff.geometry.tooth.tooth_flanks import named_member
from easeoff.geometry import LatticeSize
from easeoff.geometry.tooth.tooth_lattice import usual_depth

from finite_element_split import split
from finite_element_teeth import (
    CASES,
    GRID,
    MEMBERS,
    MIDDLE,
    Tooth,
    difference,
    pair_of,
    patches,
    reference,
    shell_of,
    solid_tooth,
    tooth,
)
from free_edge import figure  # which also finds the helpers of the tests
from thesis_shell import thesis_kinematics

REFERENCE = Path(__file__).parents[1] / "tests" / "data" / "finite_element_teeth.npz"
HEAD = ("free edge %", "matrix %", "uniform load %")


def at_200_points(one: Tooth) -> float:
    """CPU time for 200 points of the flank [s]."""
    seconds = one.seconds
    return seconds["lattice"] + seconds["assembly and factor"] + seconds["solves"] * 200 / one.lattice.flank.size


def cost() -> None:
    """Convergence and cost."""
    rows = []
    for name in CASES:
        for member in MEMBERS:
            usual = usual_size(pair_of(name), member)
            for label, size in (("half", usual.finer(0.5)), ("0.7", usual.finer(0.7)), ("usual", usual)):
                one = tooth(name, member, size)
                numbers = difference(one.matrix, one.edge, reference(name, member))
                rows.append([name, member, label, one.dofs, one.lattice.flank.size, *numbers, at_200_points(one)])
            best = reference(name, member)
            rows.append([name, member, "reference", best.dofs, best.lattice.flank.size, 0, 0, 0, ""])
    print(tabulate(rows, ["case", "member", "bricks", "unknowns", "points", *HEAD, "CPU s for 200"], "github", ".1f"))
    print(f"largest memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB")


def shell() -> None:
    """The shell against finite elements, per tooth and choice."""
    models = {
        "Weber (default)": ElasticModel(),
        "Weber, fitted plate": ElasticModel(plate="fitted"),
        "0.8 O'Donnell, fitted plate": ElasticModel(plate="fitted", foundation=ElasticFoundation("odonnell", 0.8)),
        "0.8 O'Donnell": ElasticModel(foundation=ElasticFoundation("odonnell", 0.8)),
        "clamped": ElasticModel(foundation=None),
        "thesis form, clamped": ElasticModel(foundation=None),
    }
    rows = []
    for name in CASES:
        for member in MEMBERS:
            best = reference(name, member)
            for fineness in (0.7, 1.0, 1.4):
                one = solid_tooth(name, member, fineness)
                label = "solid shell" + ("" if fineness == 1.0 else f", fineness {fineness}")
                numbers = difference(one.matrix, one.edge, best)
                rows.append([name, member, label, one.dofs, *numbers, sum(one.seconds.values())])
            for label, model in models.items():
                teeth = pair_geometry(pair_of(name), (7, 7)).teeth
                one_shell = shells(teeth, model)[MEMBERS.index(member)]
                start = time.process_time()
                one_shell = replace(one_shell, assumption=thesis_kinematics if "thesis" in label else five_field)
                seconds = time.process_time() - start
                matrix, edge = shell_of(name, member, one_shell, best.lattice.lengthwise)
                rows.append([name, member, label, one_shell.size, *difference(matrix, edge, best), seconds])
    print(tabulate(rows, ["case", "member", "shell", "unknowns", *HEAD, "CPU s"], "github", "+.1f"))


def write_reference() -> None:
    """Compliance between the patches and largest deflection of the free edge, of all teeth on the finest lattice."""
    arrays: dict[str, Any] = {}
    for name in CASES:
        for member in MEMBERS:
            best = reference(name, member)
            of_grid, of_middle = (patches(name, member, *where)[:2] for where in (GRID, MIDDLE))
            found = {"matrix": best.matrix, "edge": best.edge.max(), "patches": of_grid[0], "middle": of_middle[0]}
            arrays |= {f"{name} {member} {key}": value for key, value in found.items()} | {"weights": of_grid[1]}
    with whole_file(REFERENCE) as temporary, open(temporary, "wb") as stream:
        np.savez_compressed(stream, **arrays)


def body() -> None:
    """What the depth of the body does, and where it ends beyond toe and heel."""
    rows = []
    for name in CASES:
        for member in MEMBERS:
            one = tooth(name, member)
            depth = usual_depth(named_member(pair_of(name), member).section)
            bodies_: dict[str, tuple[LatticeSize | None, float | None]] = {
                f"{factor * depth:.1f} mm deep": (None, factor * depth) for factor in (0.5, 2.0)
            }
            bodies_["ends flush with the tooth"] = (replace(usual_size(pair_of(name), member), overhang=0), None)
            for label, (size, own_depth) in bodies_.items():
                other = tooth(name, member, size, own_depth)
                rows.append([name, member, label, *difference(other.matrix, other.edge, one)])
    print(tabulate(rows, ["case", "member", "body", *HEAD], "github", "+.1f"))


if __name__ == "__main__":
    parts = {
        "cost": cost,
        "shell": shell,
        "body": body,
        "split": split,
        "figure": figure,
        "reference": write_reference,
    }
    for part in sys.argv[1:] or parts:
        parts[part]()
        print()
