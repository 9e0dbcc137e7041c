"""Compare all installed solvers on the problem library: tables and pictures of ``compare.md`` and of a note.

``python docs/make comparison FOLDER`` makes the small and the medium part of the library and the comparison in a
folder, from which it resumes, and updates the pages: some ten minutes on two cores. With ``--page`` it only updates
them from the comparison in the folder.

After a change of solvers or of their settings.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from folders import IMAGES, NOTES, RESEARCHER
from generated_part import with_generated
from PIL import Image

from easeoff.study.compare import compare, write_comparison
from easeoff.study.compare.comparison_table import read_table
from easeoff.study.compare.method_statistics import (
    RUN_TIME_SHIFT,
    by_problem,
    headline,
    methods,
    of_method,
    shifted_geometric_mean,
)
from easeoff.study.library.library_files import write_library
from easeoff.study.report.comparison_report import milliseconds, ratio, residual, start_table, work_precision_tables

PAGES = (RESEARCHER / "compare.md", NOTES / "contact_solvers.md")
PARTS = ("small", "medium")
TOLERANCES = (1e-3, 1e-6, 1e-9)
TIME_LIMIT = 2.0  # [s]
ACCURACIES = ("1e-08", "1e-12")  # whose shares are listed
STARTS = ("solver", "cold [ms]", "warm [ms]", "ratio", "certified, warm")  # columns of the table of starts
COLOURS = 96
#: What is counted of the answers with each settings.
COUNTS = {"scaled": ("certified",), "polished": ("exact",), "raw": ("claims", "uncertified")}
PICTURES = ("performance_profile", "data_profile", "pairs", "work_precision", "run_time")


def claim_table(table: Any) -> str:
    """What each solver said, and what is certified: a row a solver."""
    problems, named = statistics(table)
    rows = []
    for solver, _, _ in headline(named):
        row = [solver]
        for settings in COUNTS:
            found = of_method(problems, (solver, settings, "cold"))
            row += [str(int(found[name].sum())) if len(found) else "" for name in COUNTS[settings]]
        rows.append(row)
    count = len(problems.drop_duplicates(["problem_file", "problem"]))
    words = {"claims": "says solved", "uncertified": "says solved, not certified"}
    heads = [f"{settings}: {words.get(name, name)}" for settings, names in COUNTS.items() for name in names]
    return _table([f"of {count}", *heads], rows)


def time_table(table: Any) -> str:
    """Run times of the solvers' own answers to the scaled problem, and share of accurate ones: a row a solver."""
    problems, named = statistics(table)
    precision, _ = work_precision_tables(table, named)
    shares = {str(row[0]): dict(zip(precision.head[1:], map(str, row[1:]), strict=True)) for row in precision.rows}
    limit, rows = float(table.attrs["time_limit_s"]), []
    for method in headline(named):
        found = of_method(problems, method)
        times = found["run_time"].to_numpy(dtype=float)
        solved = found[found["certified"]]
        mean = shifted_geometric_mean(np.where(np.isfinite(times), times, limit), RUN_TIME_SHIFT)
        worst = table["worst_residual"].values[
            (table["solver"].values == method[0]) & (table["settings"].values == "scaled")
        ]
        rows.append(
            [
                method[0],
                *map(milliseconds, [mean, solved["run_time"].median(), float(solved["run_time"].max())]),
                ratio(float((solved["run_time"] / solved["call_time"]).median())),
                residual(float(np.nanmax(worst))) if np.isfinite(worst).any() else "-",
                *(shares[method[0]][accuracy].partition("(")[2].rstrip(")") for accuracy in ACCURACIES),
            ]
        )
    head = ["[ms]", "mean", "median", "longest", "whole / bare", "worst certificate"]
    return _table([*head, *(f"within {accuracy}" for accuracy in ACCURACIES)], rows)


def warm_table(table: Any) -> str:
    """Cold and warm starts."""
    found = start_table(*statistics(table))
    assert found is not None
    chosen = [found.head.index(name) for name in STARTS]
    return _table(list(STARTS), [[str(row[k]) for k in chosen] for row in found.rows])


def machine_line(table: Any) -> str:
    """Number of attempts and the versions they were made with."""
    machine, versions = (json.loads(table.attrs[name]) for name in ("machine", "solver_versions"))
    solvers = ", ".join(f"{name} {version}" for name, version in versions.items())
    names = ("processor", "Python", "numpy", "scipy", "BLAS of numpy", "BLAS of scipy")
    parts = ", ".join(machine[name] if name in ("processor", "Python") else f"{name} {machine[name]}" for name in names)
    return f"{table.sizes['attempt']} attempts; {parts}, one thread; {solvers}."


def statistics(table: Any) -> tuple[Any, list[tuple[str, str, str]]]:
    """Problems and methods of a comparison."""
    problems = by_problem(table)
    return problems, methods(problems, float(table.attrs["time_limit_s"]))


def _table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


TABLES = {
    "claims": claim_table,
    "times": time_table,
    "starts": warm_table,
    "machine": machine_line,
}


def updated(page: str, table: Any) -> str:
    """A page with its generated parts, each between two comments, made anew."""
    for name, made in TABLES.items():
        page = with_generated(page, name, made(table))
    return page


def main() -> None:
    """Measure if that is wanted, and update pages and pictures."""
    arguments = [argument for argument in sys.argv[1:] if argument != "--page"]
    if len(arguments) != 1:
        raise SystemExit(__doc__)
    folder = Path(arguments[0])
    if "--page" not in sys.argv:
        measure(folder)
    table = read_table(folder / "comparison" / "results.nc")
    for name in PICTURES:
        # A palette takes a third of the room; there are not many colours.
        picture = Image.open(folder / "comparison" / "figures" / f"{name}.png").convert("RGB").quantize(COLOURS)
        picture.save(IMAGES / "compare" / f"compare_{name}.png", optimize=True)
    for page in PAGES:
        page.write_text(updated(page.read_text(encoding="utf-8"), table), encoding="utf-8")


def measure(folder: Path) -> None:
    """Make the files of the library that there are not yet, and the comparison."""
    files = [folder / f"{part}.nc" for part in PARTS]
    if not all(file.exists() for file in files):
        write_library(folder, PARTS)
    table = compare(
        files,
        folder / "comparison",
        repetitions=1,
        time_limit=TIME_LIMIT,
        polish=True,
        raw=True,
        tolerances=TOLERANCES,
        progress=lambda done, total: print(f"\r{done} of {total}", end="", flush=True),
    )
    print()
    write_comparison(table, folder / "comparison")


if __name__ == "__main__":
    main()
