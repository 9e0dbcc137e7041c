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
    """Check, before any work, that contact problems can be written.

    Parameters
    ----------
    output
        The file or folder.
    format, form
        As in `export_problems`, or the format ``"qpbenchmark"``.
    *sources
        Files that must not be overwritten.
    count
        Number of problems, as far as it is known.

    Raises
    ------
    InputError
        If they cannot.

    Examples
    --------
    >>> check_problem_output(Path("problems.qps"), "mat", None)
    Traceback (most recent call last):
    easeoff.core.errors.InputError: problems.qps: must be a file whose name ends in .mat, which holds all problems
    """
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
    """Write contact problems, and say in one line what was written; parameters as in `check_problem_output`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.contact import ContactProblem
    >>> problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    >>> with TemporaryDirectory() as folder:
    ...     write_problem_set(ProblemSet([problem]), Path(folder), "qps", None).split(": ")[1]
    '1 contact problem, a file each'
    """
    count = len(problems.problems)
    said = f"{count} contact problem{'' if count == 1 else 's'}"
    if format == TEST_SET:
        (script,) = write_test_set(problems, output)
        return f"wrote {script}: {said}"
    (*_, last) = export_problems(problems, output, format, form=form)
    return f"wrote {output}: {said}" + ("" if last == output else ", a file each")


def convert_problems(source: Path, output: Path, format: str | None, form: str | None) -> str:
    """Convert a file or folder of contact problems, and say in one line what was written.

    Raises
    ------
    InputError
        If the source cannot be read, or the output not be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.contact import ContactProblem, write_problems
    >>> problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    >>> with TemporaryDirectory() as folder:
    ...     write_problems([problem], Path(folder, "one.nc"))
    ...     convert_problems(Path(folder, "one.nc"), Path(folder, "one.mat"), None, None).endswith("1 contact problem")
    True
    """
    check_problem_output(output, format, form, source)
    return write_problem_set(import_problems(source), output, format, form)
