"""Compare all installed solvers on the problem library and on problems of other fields: pages, pictures, measurements.

``python docs/make comparison FOLDER`` makes the small and the medium part of the library, `outside_problems`, and the
comparison in a folder, from which it resumes, and updates ``compare.md`` and a note: half an hour on a quiet machine.
With ``--page`` it only updates them from the comparison in the folder. Measurements and environment of the pages are
kept beside them, in ``docs/researcher/comparison``.

After a change of solvers or of their settings.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from folders import IMAGES, NOTES, RESEARCHER
from generated_part import with_generated
from outside_problems import KINDS, write_outside
from PIL import Image

from easeoff.contact import SOLVERS
from easeoff.study.compare import compare, write_comparison
from easeoff.study.compare.comparison_table import read_table
from easeoff.study.compare.method_statistics import (
    by_problem,
    headline,
    mean_time,
    methods,
    of_method,
)
from easeoff.study.library.library_files import write_library
from easeoff.study.report.comparison_report import milliseconds, ratio, residual, start_table, work_precision_tables

PAGES = (RESEARCHER / "compare.md", NOTES / "contact_solvers.md")
PARTS = ("small", "medium")
OUTSIDE = "outside"  # file of the problems of other fields
KEPT = RESEARCHER / "comparison"  # measurements of the pages
TOLERANCES = (1e-3, 1e-6)
TIME_LIMIT = 60.0  # [s]: all but hopeless attempts end before
REPETITIONS = 2
ACCURACIES = ("1e-08", "1e-12")  # whose shares are listed
STARTS = ("solver", "cold [ms]", "warm [ms]", "ratio", "certified, warm")  # columns of the table of starts
COLOURS = 96
#: Times of the whole call and of the bare one.
TIMES = ("wall_time", "call_time")
#: Certificates that answers at the solvers' own settings are held to.
LEVELS = (1e-3, 1e-5, 1e-7)
PICTURES = ("performance_profile", "data_profile", "pairs", "work_precision", "run_time")


def best_table(table: Any) -> str:
    """Each solver at its best: what is certified, and mean times of the whole call and of the bare one, both ranked."""
    problems, named = statistics(table)
    found = {solver: of_method(problems, (solver, "scaled", "cold")) for solver, _, _ in headline(named)}
    limit = float(table.attrs["time_limit_s"])
    whole, bare = (
        {solver: mean_time(rows[name].where(rows["certified"]), limit) for solver, rows in found.items()}
        for name in TIMES
    )
    rows = []
    for solver, answers in found.items():
        polished = of_method(problems, (solver, "polished", "cold"))
        rows.append(
            [
                solver,
                str(int(answers["certified"].sum())),
                str(int((polished if len(polished) else answers)["exact"].sum())),
                *(f"{milliseconds(means[solver])} ({_rank(means, solver)})" for means in (whole, bare)),
                ratio(float(answers["spread"].median())),
            ]
        )
    count = len(problems.drop_duplicates(["problem_file", "problem"]))
    return _table([f"of {count}", "certified", "exact", "whole [ms] (rank)", "bare [ms] (rank)", "spread"], rows)


def default_table(table: Any) -> str:
    """Each solver at its own settings: its claims, how accurate they are, mean times of what it calls solved."""
    problems, named = statistics(table)
    limit, rows = float(table.attrs["time_limit_s"]), []
    for solver, _, _ in headline(named):
        answers = of_method(problems, (solver, "default", "cold"))
        if not len(answers):
            continue
        solved = answers[answers["claims"]]
        rows.append(
            [
                solver,
                str(len(solved)),
                *(str(int((solved["worst"] <= level).sum())) for level in LEVELS),
                *(milliseconds(mean_time(answers[name].where(answers["claims"]), limit)) for name in TIMES),
            ]
        )
    return _table(["solver", "says solved", *(f"to {level:.0e}" for level in LEVELS), "whole [ms]", "bare [ms]"], rows)


def outside_table(table: Any) -> str:
    """Problems of other fields: how many each solver has certified, and the mean time of the bare call."""
    problems, named = statistics(table)
    limit, rows = float(table.attrs["time_limit_s"]), []
    for solver, _, _ in headline(named):
        row = [solver]
        for kind in KINDS:
            found = of_method(problems, (solver, "scaled", "cold"))
            found = found[found["kind"] == kind]
            count = int(found["certified"].sum())
            time = milliseconds(mean_time(found["call_time"].where(found["certified"]), limit))
            row.append(f"{count}: {time}" if count else "0")
        rows.append(row)
    return _table(["certified: bare [ms]", *KINDS], rows)


def settings_table(_: Any) -> str:
    """Settings of each solver at its best, for its authors to review."""
    rows = []
    for name, entry in SOLVERS.items():
        settings = {key: value for key, value in entry.settings.items() if key != entry.time_setting}
        if settings:
            further = "; where it finds nothing " + _settings(entry.second_attempt) if entry.second_attempt else ""
            rows.append([f"`{name}`", _settings(settings) + further])
    return _table(["solver", "settings"], rows)


def _settings(settings: Any) -> str:
    return ", ".join(f"{key} = {value!r}" for key, value in settings.items())


def _rank(means: dict[str, float], solver: str) -> int:
    return 1 + sum(mean < means[solver] for mean in means.values())


def time_table(table: Any) -> str:
    """Run times of the solvers' own answers to the scaled problem, and share of accurate ones: a row a solver."""
    problems, named = statistics(table)
    precision, _ = work_precision_tables(table, named)
    shares = {str(row[0]): dict(zip(precision.head[1:], map(str, row[1:]), strict=True)) for row in precision.rows}
    limit, rows = float(table.attrs["time_limit_s"]), []
    for method in headline(named):
        found = of_method(problems, method)
        solved = found[found["certified"]]
        mean = mean_time(found["run_time"], limit)
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
    "best": best_table,
    "defaults": default_table,
    "outside": outside_table,
    "settings": settings_table,
    "times": time_table,
    "starts": warm_table,
    "machine": machine_line,
}


def updated(page: str, table: Any) -> str:
    """A page with its generated parts, each between two comments, made anew."""
    for name, made in TABLES.items():
        page = with_generated(page, name, made(table))
    return page


def keep(folder: Path) -> None:
    """Keep measurements and environment beside the pages: all attempts, the machine, versions, files of problems."""
    KEPT.mkdir(exist_ok=True)
    attempts = pd.read_csv(folder / "comparison" / "results.csv")
    attempts.to_csv(KEPT / "results.csv.xz", float_format="%.5g", index=False, lineterminator="\n")
    attributes = dict(read_table(folder / "comparison" / "results.nc").attrs)
    environment = {name: _plain(value) for name, value in attributes.items()}
    environment["files"] = {
        f"{part}.nc": hashlib.sha256((folder / f"{part}.nc").read_bytes()).hexdigest() for part in (*PARTS, OUTSIDE)
    }
    text = json.dumps(environment, indent=2) + "\n"
    (KEPT / "environment.json").write_text(text, encoding="utf-8")


def _plain(value: Any) -> Any:
    """An attribute as JSON has it; texts of JSON as what they say."""
    if isinstance(value, str):
        return json.loads(value) if value.startswith("{") else value
    return value.item() if isinstance(value, np.generic) else value


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
    keep(folder)
    for page in PAGES:
        page.write_text(updated(page.read_text(encoding="utf-8"), table), encoding="utf-8")


def measure(folder: Path) -> None:
    """Make the files of the library that there are not yet, and the comparison."""
    files = [folder / f"{part}.nc" for part in (*PARTS, OUTSIDE)]
    if not all(file.exists() for file in files):
        write_library(folder, PARTS)
        write_outside(files[-1])
    table = compare(
        files,
        folder / "comparison",
        repetitions=REPETITIONS,
        time_limit=TIME_LIMIT,
        polish=True,
        defaults=True,
        tolerances=TOLERANCES,
        progress=lambda done, total: print(f"\r{done} of {total}", end="", flush=True),
    )
    print()
    write_comparison(table, folder / "comparison")


if __name__ == "__main__":
    main()
