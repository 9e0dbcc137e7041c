"""Test set of qpbenchmark: contact problems for comparisons with that program.

A test set there is a Python file with a subclass of ``qpbenchmark.TestSet``, and here a folder ``data`` of files that
``qpsolvers.Problem.load`` reads, as in its set of model predictive control (github.com/qpsolvers/mpc_qpbenchmark).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...contact.problem.contact_problem import ContactProblem
from ...core.errors import InputError
from ...core.writing.output_file import check_folder, check_writable, whole_file

SCRIPT = "contact_qpbenchmark.py"

_TEXT = '''"""Contact problems of gear teeth as a test set of qpbenchmark; made by easeoff.

    python contact_qpbenchmark.py run

Each problem: minimise 1/2 F'C F + S'F subject to r'F = T, F >= 0, in scaled numbers, all of order one.
"""

from collections.abc import Iterator
from pathlib import Path

import qpbenchmark
from qpbenchmark.benchmark import main

HERE = Path(__file__).resolve().parent


class ContactQpbenchmark(qpbenchmark.TestSet):
    """Contact problems of gear teeth."""

    @property
    def title(self) -> str:
        """Title of the report."""
        return "Contact problems of gear teeth"

    @property
    def description(self) -> str:
        """Description of the problems."""
        return "Load distribution over the contact lines of gear teeth: dense, one equality, lower bounds."

    @property
    def sparse_only(self) -> bool:
        """The matrices are dense."""
        return False

    def define_tolerances(self) -> None:
        """Limits on residuals and run time, by settings."""
        levels = {"default": 1.0, "low_accuracy": 1e-3, "mid_accuracy": 1e-6, "high_accuracy": 1e-9}
        self.tolerances = {
            name: qpbenchmark.Tolerance(primal=limit, dual=limit, gap=limit, runtime=TIME_LIMIT)
            for name, limit in levels.items()
        }

    def __iter__(self) -> Iterator[qpbenchmark.Problem]:
        """Read the problems, in the order of their names."""
        for path in sorted((HERE / "data").glob("*.npz")):
            yield qpbenchmark.Problem.load(str(path))


if __name__ == "__main__":
    main(test_set_path=str(Path(__file__).resolve()), results_path=str(HERE / "results.csv"))
'''


def write_test_set(
    problems: Sequence[ContactProblem], folder: str | os.PathLike[str], *, time_limit: float = 10.0
) -> list[Path]:
    """Write problems as a test set of qpbenchmark: ``contact_qpbenchmark.py`` and ``data/contact_0000.npz`` onwards.

    Parameters
    ----------
    problems
        At least one problem. They are written scaled, because the residuals of that program are absolute.
    folder
        Folder for the files; made if it does not exist. Problems of an earlier test set there are removed.
    time_limit
        Run time that its tolerances allow [s].

    Returns
    -------
    list of Path
        The script.

    Raises
    ------
    InputError
        If there are no problems, or the folder cannot be written to.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.contact import ContactProblem
    >>> problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    >>> with TemporaryDirectory() as folder:
    ...     write_test_set([problem], folder)[0].name
    'contact_qpbenchmark.py'
    """
    if not problems:
        raise InputError("problems = []: must hold at least one contact problem")
    target = Path(folder)
    check_folder(target, "test set")
    data = target / "data"
    check_writable(data / "contact_0000.npz")
    written = [data / f"contact_{number:04d}.npz" for number in range(len(problems))]
    for path, problem in zip(written, problems, strict=True):
        with whole_file(path) as temporary, temporary.open("wb") as file:
            scaled: Any = problem.as_qp()  # takes an open file too, unlike its type hint
            scaled.save(file)
    for old in set(data.glob("contact_*.npz")).difference(written):
        try:
            old.unlink()
        except OSError as error:
            raise InputError(f"{old} cannot be removed: {error.strerror or error}") from error
    script = target / SCRIPT
    with whole_file(script) as temporary:
        temporary.write_text(_TEXT.replace("TIME_LIMIT", f"{time_limit:g}"), encoding="utf-8")
    return [script]
