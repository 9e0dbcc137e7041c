"""Formats of files of contact problems, by suffix: reading any of them, and writing a set of problems in any of them.

``nc`` and ``mat`` hold many problems in one file. Of ``npz``, ``qps`` and ``hdf5`` each file holds one problem: several
make a folder with a file for each. ``mps`` is ``qps`` by another name, the only one by which HiGHS reads it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ....core.checks import file_path, one_of
from ....core.errors import InputError
from ....core.output_file import check_folder, check_writable
from ..contact_problem import ContactProblem
from .fclib_file import read_fclib, read_references, write_fclib
from .matlab_file import read_mat, write_mat
from .problem_file import ProblemSet, joined, read_attributes, read_labels, read_problems, write_problems
from .programme_file import read_npz, read_qps, write_npz, write_qps


@dataclass(frozen=True)
class ProblemFormat:
    """Format of a file of contact problems."""

    title: str
    read: Callable[[str | os.PathLike[str]], ProblemSet]
    write: Callable[[ProblemSet, Path, str], None]  # form empty for the usual one
    forms: tuple[str, ...] = ()  # of the quadratic programme; none for the problem itself
    single: bool = True


def export_problems(
    problems: ProblemSet | Sequence[ContactProblem],
    output: str | os.PathLike[str],
    format: str | None = None,
    *,
    form: str | None = None,
) -> list[Path]:
    """Write contact problems in a format of other programs.

    Parameters
    ----------
    problems
        The problems, with labels and reference solutions as a `ProblemSet`.
    output
        The file. For several problems in a format with one problem a file, the folder; its files are named by the label
        ``name``, or numbered.
    format
        ``"nc"``, netCDF; ``"mat"``, MATLAB; ``"npz"``, qpsolvers; ``"qps"`` or
        ``"mps"``, Maros-Meszaros; ``"hdf5"``, FCLib. If left out, the suffix of the file.
    form
        Form of the quadratic programme in ``npz``, ``qps`` and ``mps``: ``"dense"``, ``"lifted"`` or, in ``npz``,
        ``"dual"``. If left out, dense in ``npz`` and, where the compliance is structured, lifted in the others.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        No problems, an unknown format or form, or a file that cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in export_problems([springs, springs], folder, "qps")]
    ['problem_0000.qps', 'problem_0001.qps']
    """
    given = ProblemSet.of(problems)
    path = file_path("output", output)
    name = output_format(path, format, len(given.problems))
    kind = FORMATS[name]
    if form is not None:
        if not kind.forms:
            raise InputError(f"form = {form!r}: must be left out, {kind.title} holds the problem itself")
        one_of("form", form, kind.forms)
    if not is_folder(path, name):
        kind.write(given, path, form or "")
        return [path]
    paths = [path / f"{stem}.{name}" for stem in given.file_names()]
    for i, file in enumerate(paths):
        kind.write(one_problem(given, i), file, form or "")
    return paths


def import_problems(path: str | os.PathLike[str]) -> ProblemSet:
    """Read contact problems from a file of any format, or from a folder of files of one format.

    Parameters
    ----------
    path
        A file with the suffix ``.nc``, ``.mat``, ``.npz``, ``.qps``, ``.mps`` or ``.hdf5``, or a folder of such files
        of single problems, which are read in the order of their names and get these as the label ``name``.

    Raises
    ------
    InputError
        The suffix is unknown, or a file cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = export_problems([springs, springs], folder, "hdf5")
    ...     import_problems(folder).labels["name"].tolist()
    ['problem_0000', 'problem_0001']
    """
    source = file_path("path", path)
    if not source.is_dir():
        return FORMATS[_suffix(source)].read(source)
    suffixes = [f".{name}" for name, kind in FORMATS.items() if kind.single]
    files = sorted(f for f in source.iterdir() if f.suffix.lower() in suffixes)
    kinds = sorted({f.suffix.lower() for f in files})
    if len(kinds) != 1:
        contents = f"files of {', '.join(kinds)}" if kinds else "none"
        raise InputError(f"{source}: must hold files with one of the suffixes {', '.join(suffixes)}; it has {contents}")
    read = [FORMATS[kinds[0][1:]].read(file) for file in files]
    return replace(joined(read), labels={"name": np.array([file.stem for file in files])})


def output_format(output: Path, format: str | None, count: int) -> str:
    """Checked name of the format for a number of problems; several do not go into a file that holds one."""
    name = _suffix(output) if format is None else one_of("format", format, tuple(FORMATS))
    kind = FORMATS[name]
    if is_folder(output, name):
        check_folder(output, "problems")
        return name
    if not kind.single and output.suffix.lower() != f".{name}":
        raise InputError(f"{output}: must be a file whose name ends in .{name}, which holds all problems")
    if kind.single and count > 1:
        raise InputError(
            f"{output}: must be a folder, and the format {name} be given: a file of {kind.title} holds one problem, "
            "and there are several"
        )
    check_writable(output)
    return name


def is_folder(output: Path, format: str) -> bool:
    """True if problems go to a folder: the format holds one problem a file, and the output has no suffix."""
    return FORMATS[format].single and output.suffix.lower() != f".{format}"


def one_problem(problems: ProblemSet, i: int) -> ProblemSet:
    """Return the set of problem i alone."""
    answer = problems.answer(i)
    labels = {name: np.asarray(values)[i : i + 1] for name, values in problems.labels.items()}
    return ProblemSet([problems.problems[i]], labels, None if answer is None else [answer])


def _suffix(path: Path) -> str:
    """Format of a file by its suffix."""
    name = path.suffix[1:].lower()
    if name not in FORMATS:
        others = ", ".join(f".{known}" for known in FORMATS if known != "nc")
        raise InputError(f"{path}: must be a file whose name ends in .nc, for netCDF, or in one of {others}")
    return name


def _title(problems: ProblemSet) -> str:
    return str(problems.label(0).get("name", "contact problem"))


def _read_nc(path: str | os.PathLike[str]) -> ProblemSet:
    problems = read_problems(path)
    return ProblemSet(problems, read_labels(path), read_references(path, problems), read_attributes(path))


def _read_fclib(path: str | os.PathLike[str]) -> ProblemSet:
    problem, answer = read_fclib(path)
    return ProblemSet([problem], {}, None if answer is None else [answer])


_QPS = ProblemFormat(
    "QPS",
    lambda path: ProblemSet([read_qps(path)]),
    lambda given, path, form: write_qps(given.problems[0], path, form=form or "auto", name=_title(given)),
    ("dense", "lifted"),
)
#: Formats by name, which is the suffix of their files.
FORMATS = {
    "nc": ProblemFormat(
        "netCDF",
        _read_nc,
        lambda given, path, _: write_problems(
            given.problems, path, given.labels, given.attributes, answers=given.answers
        ),
        single=False,
    ),
    "mat": ProblemFormat("MATLAB", read_mat, lambda given, path, _: write_mat(given, path), single=False),
    "npz": ProblemFormat(
        "qpsolvers",
        lambda path: ProblemSet([read_npz(path)]),
        lambda given, path, form: write_npz(given.problems[0], path, form=form or "dense"),
        ("dense", "lifted", "dual"),
    ),
    "qps": _QPS,
    "mps": _QPS,
    "hdf5": ProblemFormat(
        "FCLib",
        _read_fclib,
        lambda given, path, _: write_fclib(given.problems[0], path, answer=given.answer(0), name=_title(given)),
    ),
}
