"""Formats of files of contact problems, by suffix: reading any of them, and writing a set of problems in any of them.

``nc`` and ``mat`` hold many problems in one file. Of ``npz``, ``qps`` and ``hdf5`` each file holds one problem: several
make a folder with a file for each. ``mps`` is ``qps`` by another name, the only one by which HiGHS reads it.

A MATLAB file (version 5) is read by ``load`` in MATLAB and Octave and by ``matread`` in Julia. It has one variable,
``problem``, a struct array with one element a problem. Its fields bear the names of the netCDF file: ``separation`` and
``lever_arm`` (n, 1) [mm], ``torque`` [N mm], ``compliance`` (n, n) [mm/N] of a dense problem, ``compliance_diagonal``
(n, 1) and ``compliance_factor`` (n, k) of a structured one, the labels, and of the reference solution
``reference_force`` [N], ``reference_gap`` [mm] (n, 1), ``reference_rotation`` and ``reference_elastic_rotation`` [rad].
Vectors are columns, nothing is padded, and what a problem lacks is empty. Indices are as in netCDF: row i of V belongs
to segment i, whatever the order in memory.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.arrays import RealArray as Array
from ....core.checks import file_path, one_of
from ....core.errors import InputError
from ....core.forked_process import ProcessEndedError, in_forked_process
from ....core.netcdf_file import unpacked_size_limit
from ....core.output_file import check_folder, check_writable, whole_file
from ....core.regular_file import faults_in_words, named, require_file
from ..contact_problem import VARIABLES, ContactProblem, problem_numbers, problem_of_numbers
from . import fclib_file as fclib
from .problem_file import ProblemSet, joined, read_attributes, read_labels, read_problems, write_problems
from .programme_file import read_npz, read_qps, write_npz, write_qps

VARIABLE = "problem"
FIELDS = (*VARIABLES, *fclib.VARIABLES)
FIELD_LENGTH_LIMIT = 31  # of a field's name in version 5


def write_mat(problems: ProblemSet | Sequence[ContactProblem], path: str | os.PathLike[str]) -> None:
    """Write contact problems as a MATLAB file (``.mat``), complete or not at all.

    Labels must be names that MATLAB can take for fields; at most 4 GB a problem.
    """
    from scipy.io import savemat
    from scipy.io.matlab import MatWriteError

    problems = ProblemSet.of(problems)
    fclib.require_answers(problems.problems, problems.answers)
    for name in problems.labels:
        if name in FIELDS or not (name.isidentifier() and name.isascii() and len(name) <= FIELD_LENGTH_LIMIT):
            raise InputError(
                f"label = {name!r}: must be a name of letters, digits and underscores, {FIELD_LENGTH_LIMIT} at most, "
                "that the file does not use itself"
            )
    names = [*VARIABLES, *(fclib.VARIABLES if problems.answers is not None else ()), *problems.labels]
    array = np.zeros((1, len(problems.problems)), dtype=[(name, object) for name in names])
    for i in range(len(problems.problems)):
        fields = _fields(problems, i)
        for name in names:
            array[name][0, i] = fields.get(name, np.zeros((0, 0)))
    with whole_file(path) as temporary:
        try:
            savemat(temporary, {VARIABLE: array}, appendmat=False, format="5", do_compression=True)
        except (MatWriteError, OverflowError) as error:
            raise InputError(f"{path} cannot be written: the format holds 4 GB; write fewer problems") from error


def read_mat(path: str | os.PathLike[str]) -> ProblemSet:
    """Contact problems from a MATLAB file, not of version 7.3.

    Other programs: a struct array ``problem``, or the variables of a single problem; vectors may be rows.
    """
    from scipy.io import loadmat

    require_file(path, unpacked_size_limit())

    def loaded() -> dict[str, Any]:
        with faults_in_words(path, "a MATLAB file of version 5 (save -v7)"):
            return dict(loadmat(os.path.abspath(path), appendmat=False))

    try:
        content = in_forked_process(loaded)
    except ProcessEndedError as error:
        raise InputError(f"{named(path)} is not a MATLAB file, or it is damaged: {error}") from error
    structure = content.get(VARIABLE)
    if structure is not None and structure.dtype.names is not None:
        elements = [{name: item[name] for name in structure.dtype.names} for item in structure.ravel(order="F")]
    else:
        elements = [{name: value for name, value in content.items() if not name.startswith("__")}]
    if not elements:
        raise InputError(f"{path}: problem = empty: must hold at least one contact problem")
    problems = []
    for i, element in enumerate(elements):
        try:
            problems.append(_problem(element))
        except InputError as error:
            raise InputError(f"{path}: problem {i}: {error}") from error
    answers = [fclib.stored_reference(p, element) for p, element in zip(problems, elements, strict=True)]
    whole = [answer for answer in answers if answer is not None]
    return ProblemSet(problems, _labels(elements), whole if len(whole) == len(problems) else None)


def _fields(problems: ProblemSet, i: int) -> dict[str, Any]:
    """Fields of one problem; vectors as columns."""
    answer = problems.answer(i)
    numbers = problem_numbers(problems.problems[i]) | ({} if answer is None else fclib.reference_numbers(answer))
    fields = {name: np.reshape(values, (-1, 1)) if np.ndim(values) == 1 else values for name, values in numbers.items()}
    for name, value in problems.label(i).items():
        fields[name] = str(value) if np.asarray(value).dtype.kind in "OUST" else value
    return fields


def _problem(element: Mapping[str, Any]) -> ContactProblem:
    missing = [name for name in ("separation", "lever_arm", "torque") if not np.size(element.get(name, ()))]
    if missing:
        raise InputError(f"incomplete, without {', '.join(missing)}")
    separation, lever_arm, torque = (_numbers(element[name], name) for name in ("separation", "lever_arm", "torque"))
    if torque.size != 1:
        raise InputError(f"torque = array of shape {torque.shape}: must be one number")
    numbers: dict[str, Any]
    numbers = {"separation": separation.ravel(), "lever_arm": lever_arm.ravel(), "torque": float(torque.ravel()[0])}
    if np.size(element.get("compliance", ())):
        numbers["compliance"] = _numbers(element["compliance"], "compliance")
    elif np.size(element.get("compliance_diagonal", ())) and "compliance_factor" in element:
        factor = _numbers(element["compliance_factor"], "compliance_factor")
        numbers["compliance_factor"] = factor.reshape(separation.size, 0) if factor.size == 0 else factor
        numbers["compliance_diagonal"] = _numbers(element["compliance_diagonal"], "compliance_diagonal").ravel()
    else:
        raise InputError("incomplete, without compliance, or compliance_diagonal and compliance_factor")
    return problem_of_numbers(numbers)


def _numbers(value: Any, name: str) -> Array:
    """A field as an array of numbers; a sparse matrix as a full one."""
    array = np.asarray(value.toarray() if hasattr(value, "toarray") else value)
    if array.dtype.kind not in "biuf":
        raise InputError(f"{name} = array of {array.dtype}: must hold real numbers")
    return array.astype(np.float64)


def _labels(elements: list[dict[str, Any]]) -> dict[str, NDArray[Any]]:
    """Fields beyond those of the problems that are one number or one text in every element."""
    labels = {}
    for name in elements[0]:
        values = [np.ravel(element.get(name, ())) for element in elements]
        text = all(v.dtype.kind == "U" and v.size < 2 for v in values)
        number = all(v.dtype.kind in "biuf" and v.size == 1 for v in values)
        if name not in FIELDS and (text or number):
            labels[name] = np.array([str(v[0]) if v.size else "" for v in values] if text else [v[0] for v in values])
    return labels


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
    return ProblemSet(problems, read_labels(path), fclib.read_references(path, problems), read_attributes(path))


def _read_fclib(path: str | os.PathLike[str]) -> ProblemSet:
    problem, answer = fclib.read_fclib(path)
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
        lambda given, path, _: fclib.write_fclib(given.problems[0], path, answer=given.answer(0), name=_title(given)),
    ),
}
