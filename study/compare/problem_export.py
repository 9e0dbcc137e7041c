"""Files of contact problems that the commands write, those of qpbenchmark among them."""

from __future__ import annotations

import os
from pathlib import Path

from ...contact.problem.exchange.problem_file import ProblemSet
from ...contact.problem.exchange.problem_formats import FORMATS, export_problems, import_problems, output_format
from ...core.errors import InputError
from ...core.output_file import check_folder, check_writable
from .test_set import write_test_set

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
