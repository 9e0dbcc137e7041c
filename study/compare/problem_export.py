"""Files of contact problems that the commands write, test sets of qpbenchmark among them.

A test set there is a Python file with a subclass of ``qpbenchmark.TestSet``, and here a folder ``data`` of files that
``qpsolvers.Problem.load`` reads, as in its set of model predictive control (github.com/qpsolvers/mpc_qpbenchmark). A
table ``problems.csv`` beside it says what each problem is, and the objective and rotation of its reference solution.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from ...contact.problem.contact_problem import ContactProblem
from ...contact.problem.exchange.problem_file import ProblemSet
from ...contact.problem.exchange.problem_formats import FORMATS, export_problems, import_problems, output_format
from ...core.errors import InputError
from ...core.output_file import check_folder, check_writable, whole_file

TEST_SET = "qpbenchmark"
#: Suffixes by which a file is one of contact problems.
SUFFIXES = tuple(f".{name}" for name in FORMATS)


def check_problem_output(
    output: Path, format: str | None, form: str | None, *sources: str | os.PathLike[str], count: int = 1
) -> None:
    """Check before any work that contact problems can be written, over none of the sources; else InputError."""
    for source in sources:
        if os.path.isfile(output) and os.path.isfile(source) and os.path.samefile(output, source):
            check_writable(output, source)
    if format == TEST_SET:
        check_folder(output, "test set")
        if form is not None:
            raise InputError(f"form = {form!r}: must be left out, a test set of qpbenchmark is dense")
        return
    name = output_format(output, format, count)
    if form is not None and form not in FORMATS[name].forms:
        allowed = f"one of {', '.join(FORMATS[name].forms)}" if FORMATS[name].forms else "left out"
        raise InputError(f"form = {form!r}: must be {allowed} in the format {name}")
    if output.suffix.lower() == f".{name}":
        check_writable(output, *sources)


def write_problem_set(problems: ProblemSet, output: Path, format: str | None, form: str | None) -> str:
    """Write contact problems and describe in one line what was written; arguments as of `check_problem_output`."""
    count = len(problems.problems)
    said = f"{count} contact problem{'' if count == 1 else 's'}"
    if format == TEST_SET:
        (script,) = write_test_set(problems, output)
        return f"wrote {script}: {said}"
    (*_, last) = export_problems(problems, output, format, form=form)
    return f"wrote {output}: {said}" + ("" if last == output else ", a file each")


def convert_problems(source: Path, output: Path, format: str | None, form: str | None) -> str:
    """Convert a file or folder of contact problems and describe in one line what was written."""
    check_problem_output(output, format, form, source)
    return write_problem_set(import_problems(source), output, format, form)


SCRIPT = "contact_qpbenchmark.py"
TABLE = "problems.csv"
#: Text of the script, with TIME_LIMIT for the time limit [s].
TEMPLATE = resources.files(__package__) / "contact_qpbenchmark.txt"


def write_test_set(
    problems: ProblemSet | Sequence[ContactProblem], folder: str | os.PathLike[str], *, time_limit: float = 10.0
) -> list[Path]:
    """Write a test set of qpbenchmark: ``contact_qpbenchmark.py``, ``problems.csv`` and a folder ``data``; its script.

    Problems are scaled, as residuals there are absolute, and have their label ``name``, else ``contact_0000`` and so
    on. Those of an earlier test set in the folder are removed. Tolerances there allow the time limit [s].
    """
    given = problems if isinstance(problems, ProblemSet) else ProblemSet(problems)
    if not given.problems:
        raise InputError("problems = []: must hold at least one contact problem")
    target = Path(folder)
    check_folder(target, "test set")
    data, table = target / "data", target / TABLE
    check_writable(data / "contact_0000.npz")
    earlier = _earlier_problems(table, data)
    names = given.file_names("contact")
    written = [data / f"{name}.npz" for name in names]
    for path, problem in zip(written, given.problems, strict=True):
        with whole_file(path) as temporary, temporary.open("wb") as file:
            scaled: Any = problem.as_qp()  # takes an open file too, unlike its type hint
            scaled.save(file)
    for old in earlier.difference(written):
        try:
            old.unlink(missing_ok=True)
        except OSError as error:
            raise InputError(f"{old} cannot be removed: {error.strerror or error}") from error
    with whole_file(table) as temporary, temporary.open("w", newline="", encoding="utf-8") as text:
        rows = [_row(given, i, name) for i, name in enumerate(names)]
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    script = target / SCRIPT
    with whole_file(script) as temporary:
        content = TEMPLATE.read_text(encoding="utf-8").replace("TIME_LIMIT", f"{time_limit:g}")
        temporary.write_text(content, encoding="utf-8")
    return [script]


def _earlier_problems(table: Path, data: Path) -> set[Path]:
    """Problems of an earlier test set in the folder: those of its table, and those numbered."""
    problems = set(data.glob("contact_[0-9][0-9][0-9][0-9].npz"))
    if table.is_file():
        with table.open(newline="", encoding="utf-8", errors="replace") as file:
            names = [row.get("problem") or "" for row in csv.DictReader(file)]
        problems |= {data / f"{name}.npz" for name in names if name and Path(name).name == name}
    return problems


def _row(problems: ProblemSet, i: int, name: str) -> dict[str, Any]:
    """Row of the table: name, sizes, labels, and the reference solution in the numbers of the programme."""
    problem, answer = problems.problems[i], problems.answer(i)
    row: dict[str, Any] = {"problem": name, "unknowns": problem.size}
    row |= {key: value for key, value in problems.label(i).items() if key != "name"}
    if answer is None:
        return row
    scale, force = problem.scaling, answer.force
    separation = problem.separation_at_first_contact
    energy = float(force @ problem.deflection(force)) / 2.0 + float(force @ separation)
    return row | {
        "objective": repr(energy / (scale.force * scale.gap)),
        "rotation": repr(answer.elastic_rotation / scale.rotation),
        "touching": int(np.count_nonzero(force)),
    }
