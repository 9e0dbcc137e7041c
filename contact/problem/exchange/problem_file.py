"""Exchange of contact problems: many of them, of different sizes, in one netCDF-4 file.

The file needs nothing of this package. Dimensions are `problem`, `segment`, `segment_other` and `mode`; arrays are
padded with NaN behind the first ``size[i]`` segments of problem i. Variables, in mm, N and N mm:

- ``size`` (problem), ``torque`` (problem), ``separation`` and ``lever_arm`` (problem, segment);
- ``compliance`` (problem, segment, segment_other), the matrix C, where ``structured`` is 0;
- ``compliance_diagonal`` (problem, segment) and ``compliance_factor`` (problem, segment, mode), with ``mode_count[i]``
  modes, for C = diag(d) + V V^T, where ``structured`` is 1.

A file with problems of one form holds the variables of that form only. Labels such as the mesh position are further
variables (problem). To read problem i with xarray and numpy alone:

    ds = xarray.open_dataset("problems.nc", engine="netcdf4")
    n = int(ds["size"][i])
    separation = ds["separation"][i, :n].values
    lever_arm = ds["lever_arm"][i, :n].values
    torque = float(ds["torque"][i])
    if ds["structured"][i] == 0:
        C = ds["compliance"][i, :n, :n].values
    else:
        V = ds["compliance_factor"][i, :n, : int(ds["mode_count"][i])].values
        C = numpy.diag(ds["compliance_diagonal"][i, :n].values) + V @ V.T

The checksum of a problem is that of its numbers, whatever file, compression or padding holds them.

A file from another program may be incomplete. Entries that follow from the numbers may be missing: without ``size`` a
problem ends where its separations do, without ``structured`` the form is that of the compliance that is there, without
``mode_count`` the factor ends where its numbers do. Dimensions may come in another order or have other names; a file
with a single problem need not have that of the problem. Where nothing was written a number may be NaN, the variable's
``_FillValue`` or netCDF's own. Units may be left out or be spelt otherwise, but other units are refused, not guessed
at.

With its problems come their labels and reference solutions.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ....core.arrays import Bools, Integers, record
from ....core.attributes import units_of
from ....core.checks import instance, shown
from ....core.errors import InputError
from ....core.netcdf_file import read_dataset, write_netcdf
from ..certificate import Answer
from ..contact_problem import (
    ATTRIBUTES,
    DIMENSIONS as PROBLEM_DIMENSIONS,
    FORMAT as SINGLE_FORMAT,
    ContactProblem,
    number_names,
    problem_numbers,
    problem_of_numbers,
)
from .fclib_file import VARIABLES as REFERENCE_VARIABLES, padded, reference_arrays, reference_variables, require_answers


def problem_checksum(problem: ContactProblem) -> str:
    """Return the SHA-256 of the numbers of a problem, in hexadecimal digits.

    The digest is over the doubles, little endian, row by row: T; S; r; then C, or d and V. Negative zeros count as
    zeros. Problems that are identical have the same checksum; so have the same numbers in another file or program.

    Examples
    --------
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> problem_checksum(springs)[:8]
    'cf7e0c8f'
    """
    instance("problem", problem, ContactProblem)
    numbers = problem_numbers(problem)
    digest = hashlib.sha256()
    for array in (numbers.pop("torque"), *numbers.values()):
        digest.update((np.ascontiguousarray(array, dtype="<f8") + 0.0).tobytes())
    return digest.hexdigest()


def set_checksum(names: Sequence[str], problems: Sequence[ContactProblem]) -> str:
    """SHA-256 of the lines ``name checksum`` of problems in order, in hexadecimal digits."""
    lines = (f"{name} {problem_checksum(problem)}\n" for name, problem in zip(names, problems, strict=True))
    return hashlib.sha256("".join(lines).encode()).hexdigest()


#: Dimensions of every array of a file, in the order in which they are read.
DIMENSIONS: dict[str, tuple[str, ...]] = {
    **{name: ("problem", *dimensions) for name, dimensions in PROBLEM_DIMENSIONS.items()},
    **dict.fromkeys(("size", "structured", "mode_count"), ("problem",)),
}

#: Value of netCDF where nothing was written to a variable of floating point numbers without its own fill value.
NETCDF_FILL = 9.969209968386869e36

#: Other spellings of units, without blanks and asterisks.
SPELLINGS = {
    "mm": ("millimeter", "millimetre"),
    "N mm": ("N.mm", "mmN", "mm.N"),
    "mm/N": ("mmN-1", "mm.N-1", "mmN^-1"),
    "(mm/N)^0.5": ("(mm/N)0.5", "(mm/N)^(1/2)", "mm^0.5N^-0.5", "sqrt(mm/N)"),
}


def require_arrays(dataset: xr.Dataset) -> None:
    """Refuse a Dataset that lacks variables that nothing can replace."""
    missing = [name for name in ("separation", "lever_arm", "torque") if name not in dataset.variables]
    parts = [name for name in ("compliance_diagonal", "compliance_factor") if name not in dataset.variables]
    if "compliance" not in dataset.variables and parts:
        missing += ["compliance"] if len(parts) == 2 else parts
    if missing:
        raise InputError(f"incomplete, without {', '.join(missing)}")


def problem_arrays(dataset: xr.Dataset) -> dict[str, NDArray[Any]]:
    """Arrays of `DIMENSIONS` in a complete Dataset; `size`, `structured` and `mode_count` are added if missing."""
    single = dataset["torque"].ndim == 0
    data = {name: _array(dataset, name, single) for name in DIMENSIONS if name in dataset.variables}
    separation, factor = data["separation"], data.get("compliance_factor")
    if not separation.size:
        raise InputError(f"separation = {shown(separation)}: must hold one problem of one segment, or more")
    count = separation.shape[0]
    for name, array in data.items():
        if array.shape[0] != count:
            raise InputError(f"{name} = {shown(array)}: must hold {count} problems, as separation")
    sizes = data.get("size", _length(np.isfinite(separation)))
    data["size"] = _counts(sizes, "size", 1, separation.shape[1])
    if "structured" not in data:
        # Where both forms are there, each problem has numbers in one of them.
        diagonal = data.get("compliance_diagonal")
        data["structured"] = np.zeros(count) if diagonal is None else np.isfinite(diagonal).any(axis=1)
    data["structured"] = _counts(data["structured"], "structured", 0, 1)
    for flag, name in ((0, "compliance"), (1, "compliance_diagonal"), (1, "compliance_factor")):
        if name not in data and (data["structured"] == flag).any():
            number = int(np.argmax(data["structured"] == flag))
            raise InputError(
                f"structured of problem {number} = {flag}: must go with the variable {name}, which is missing"
            )
    if factor is not None:
        modes = data.get("mode_count", _length(np.isfinite(factor).any(axis=1)))
        data["mode_count"] = _counts(modes, "mode_count", 0, factor.shape[2])
    return data


def _array(dataset: xr.Dataset, name: str, single: bool) -> NDArray[Any]:
    variable, expected = dataset[name], DIMENSIONS[name][1 if single else 0 :]
    if sorted(map(str, variable.dims)) == sorted(expected):
        variable = variable.transpose(*expected)
    elif variable.ndim != len(expected):
        dimensions = ", ".join(map(str, variable.dims))
        raise InputError(f"{name} = array over ({dimensions}): must have the dimensions ({', '.join(expected)})")
    units = str(variable.attrs.get("units", "")).translate(str.maketrans("", "", " *"))
    wanted = ATTRIBUTES.get(name, {}).get("units", "1")
    if units not in ("", "1", wanted.replace(" ", ""), *SPELLINGS.get(wanted, ())):
        raise InputError(f"units of {name} = {variable.attrs['units']!r}: must be {wanted!r}; convert the file")
    array = variable.to_numpy()
    if array.dtype.kind not in "biuf":
        raise InputError(f"{name} = array of {array.dtype}: must hold numbers")
    if array.dtype.kind == "f":
        array = np.where(array == NETCDF_FILL, np.nan, array.astype(np.float64, copy=False))
    return array[np.newaxis] if single else array


def _counts(values: NDArray[Any], name: str, least: int, most: int) -> Integers:
    """Return whole numbers within limits; InputError otherwise."""
    wrong = ~((values >= least) & (values <= most) & (values == np.floor(values)))
    if wrong.any():
        number = int(np.argmax(wrong))
        given = shown(values[number])
        raise InputError(f"{name} of problem {number} = {given}: must be a whole number from {least} to {most}")
    return values.astype(np.intp)


def _length(present: Bools) -> Integers:
    """Length of each row up to its last entry that is present; an empty row counts as one, to be refused later."""
    width = present.shape[1]
    if not width:  # no modes
        return np.zeros(present.shape[0], dtype=np.intp)
    length: Integers = np.where(present.any(axis=1), width - np.argmax(present[:, ::-1], axis=1), 1)
    return length


@record(frozen=True, eq=False)
class ProblemSet:
    """Contact problems with labels and reference solutions.

    Attributes
    ----------
    problems
        The problems.
    labels
        By name an array of one entry a problem, such as ``name``, ``kind`` and ``mesh_position``.
    answers
        Reference solutions, one a problem; None if there are none.
    attributes
        What holds for all problems, text or numbers by name; formats other than netCDF have no place for it.

    Examples
    --------
    >>> import numpy as np
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> ProblemSet([springs, springs], {"name": np.array(["one spring/mm", ""])}).file_names()
    ['one_spring_mm', 'problem_0001']
    """

    problems: Sequence[ContactProblem]
    labels: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    answers: Sequence[Answer] | None = None
    attributes: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, problems: ProblemSet | Sequence[ContactProblem]) -> ProblemSet:
        """Problems as a set, if they are not one already.

        Raises
        ------
        InputError
            No problems.
        """
        given = problems if isinstance(problems, ProblemSet) else cls(problems)
        require_problems(given.problems)
        return given

    def answer(self, i: int) -> Answer | None:
        """Reference solution of problem i; None if there is none."""
        return None if self.answers is None else self.answers[i]

    def label(self, i: int) -> dict[str, Any]:
        """Labels of problem i."""
        return {name: np.asarray(values)[i] for name, values in self.labels.items()}

    def file_names(self, stem: str = "problem") -> list[str]:
        """Names for files of single problems: the labels ``name``; stem and number where these are missing or alike."""
        numbers = [f"{stem}_{i:04d}" for i in range(len(self.problems))]
        if "name" not in self.labels:
            return numbers
        names = ["".join(c if c.isalnum() or c in "-+." else "_" for c in str(n)) for n in self.labels["name"]]
        return [
            name if name.strip("_.") and names.count(name) == 1 else number
            for name, number in zip(names, numbers, strict=True)
        ]


def require_problems(problems: object) -> None:
    """Refuse anything but a sequence of contact problems, at least one."""
    if isinstance(problems, str | os.PathLike | ContactProblem) or not isinstance(problems, Sequence):
        raise InputError(f"problems = {shown(problems)}: must be a list of contact problems, the file comes after it")
    if not problems:
        raise InputError("problems = []: must hold at least one contact problem")
    for i, one in enumerate(problems):
        if not isinstance(one, ContactProblem):
            raise InputError(f"problems[{i}] = {shown(one)}: must be a ContactProblem")


def joined(sets: Sequence[ProblemSet]) -> ProblemSet:
    """Problems of several sets as one, with the labels that all have, and answers if all have them."""
    names = [name for name in sets[0].labels if all(name in one.labels for one in sets)]
    answers = [one.answers for one in sets if one.answers is not None]
    return ProblemSet(
        [problem for one in sets for problem in one.problems],
        {name: np.concatenate([np.asarray(one.labels[name]) for one in sets]) for name in names},
        [answer for some in answers for answer in some] if len(answers) == len(sets) else None,
    )


FORMAT = "easeoff contact problems"
FORMAT_VERSION = 1

_OWN_NAMES = {*DIMENSIONS, *REFERENCE_VARIABLES, "problem", "segment", "segment_other", "mode"}


def write_problems(
    problems: Sequence[ContactProblem],
    path: str | os.PathLike[str],
    labels: Mapping[str, ArrayLike | xr.DataArray] | None = None,
    attributes: Mapping[str, str | int | float] | None = None,
    *,
    answers: Sequence[Answer] | None = None,
) -> None:
    """Write contact problems to a netCDF-4 file, without loss.

    Parameters
    ----------
    problems
        At least one.
    path
        The file, replaced if it exists. It appears complete or not at all.
    labels
        Labels of the problems, for instance ``torque_index`` and ``mesh_position``: by name an array (number of
        problems) of numbers or text. A DataArray brings its attributes along, such as units.
    attributes
        Further global attributes of the file, text or numbers by name.
    answers
        Reference solutions, one a problem, as ``solve(problem).answer``; see `reference_variables`.

    Raises
    ------
    InputError
        No problems, a label of the wrong length or with the name of a variable of the file, answers that are not those
        of the problems, or an attribute with the name of one of the file.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_problems([springs], Path(folder, "problems.nc"), labels={"mesh_position": [0.25]})
    ...     read_labels(Path(folder, "problems.nc"))["mesh_position"].tolist()
    [0.25]
    """
    require_problems(problems)
    require_answers(problems, answers)
    dataset = _dataset(problems)
    if answers is not None:
        dataset = dataset.assign(reference_variables(answers, dataset.sizes["segment"]))
    labels, attributes = {} if labels is None else labels, {} if attributes is None else attributes
    instance("labels", labels, Mapping)
    instance("attributes", attributes, Mapping)
    for name, values in labels.items():
        described = values.attrs if isinstance(values, xr.DataArray) else None
        dataset.coords[name] = ("problem", _label(name, values, len(problems)), described)
    if taken := sorted(set(attributes) & set(dataset.attrs)):
        raise InputError(f"attribute = {taken[0]!r}: must be another name, the file has an attribute of this one")
    dataset.attrs.update(attributes)
    write_netcdf(dataset, path, packed=True)


def read_problems(path: str | os.PathLike[str]) -> list[ContactProblem]:
    """Read the contact problems of a file, identical to those written.

    A file that another program wrote may leave out the global attributes, the units, ``size``, ``structured``,
    ``mode_count`` and, with a single problem, the dimension of the problem; see `problem_arrays`.

    Raises
    ------
    InputError
        The file cannot be read, lacks a variable, has other units, or holds data that are no contact problem.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_problems([springs], Path(folder, "problems.nc"))
    ...     read_problems(Path(folder, "problems.nc"))[0].identical(springs)
    True
    """
    dataset = _opened(path)
    try:
        data = problem_arrays(dataset)
        problems = [_problem(data, i) for i in range(data["separation"].shape[0])]
        reference_arrays(dataset, len(problems), max(problem.size for problem in problems))
        return problems
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def read_labels(path: str | os.PathLike[str]) -> dict[str, NDArray[Any]]:
    """Labels that a file of problems was written with, each an array of one entry a problem."""
    dataset = _opened(path)
    problem = dataset["torque"].dims
    labels = [str(name) for name in dataset.variables if name not in _OWN_NAMES and dataset[name].dims == problem]
    arrays = {name: np.atleast_1d(dataset[name].to_numpy()) for name in labels}
    for name, values in arrays.items():
        if values.dtype.kind not in "fiu" and units_of(name) is not None:
            raise InputError(f"{path}: label {name} = {shown(values)}: must hold numbers")
    return {name: values.astype(str) if values.dtype.kind == "O" else values for name, values in arrays.items()}


def _dataset(problems: Sequence[ContactProblem]) -> xr.Dataset:
    numbers = [problem_numbers(problem) for problem in problems]
    modes = [one["compliance_factor"].shape[1] if "compliance_factor" in one else 0 for one in numbers]
    structured = np.array([problem.is_structured for problem in problems], dtype=np.int8)
    widest = max(problem.size for problem in problems)
    lengths = {"segment": widest, "segment_other": widest, "mode": max(modes)}
    data = {
        name: padded([one.get(name) for one in numbers], *(lengths[along] for along in dimensions))
        for name, dimensions in PROBLEM_DIMENSIONS.items()
        if any(name in one for one in numbers)
    }
    dataset = xr.Dataset(
        {name: (DIMENSIONS[name], values, ATTRIBUTES[name]) for name, values in data.items()},
        attrs={"format": FORMAT, "format_version": FORMAT_VERSION, "Conventions": "CF-1.11"},
    )
    dataset["size"] = ("problem", np.array([p.size for p in problems], dtype=np.int32), _count("number of segments"))
    dataset["mode_count"] = ("problem", np.array(modes, dtype=np.int32), _count("number of modes of the factor"))
    meaning = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "dense diagonal_plus_factor"}
    dataset["structured"] = ("problem", structured, {**_count("form of the compliance"), **meaning})
    return dataset


def _count(long_name: str) -> dict[str, str]:
    return {"units": "1", "long_name": long_name}


def _label(name: str, values: ArrayLike, count: int) -> NDArray[Any]:
    if name in _OWN_NAMES:
        raise InputError(f"label = {name!r}: must be another name, the file has a variable of this one")
    array = np.asarray(values)
    if array.shape != (count,):
        raise InputError(f"label {name} = {shown(array)}: must have the shape ({count},)")
    if array.dtype.kind == "b":
        return array.astype(np.int8)
    if array.dtype.kind not in "ifuU":
        raise InputError(f"label {name} = array of {array.dtype}: must hold numbers or text")
    return array


def _problem(data: Mapping[str, NDArray[Any]], i: int) -> ContactProblem:
    structured = bool(data["structured"][i])
    ends = {"segment": int(data["size"][i]), "mode": int(data["mode_count"][i]) if structured else 0}
    ends["segment_other"] = ends["segment"]
    names = number_names(structured)
    numbers = {name: data[name][i][tuple(slice(ends[along]) for along in PROBLEM_DIMENSIONS[name])] for name in names}
    try:
        return problem_of_numbers(numbers)
    except InputError as error:
        raise InputError(f"problem {i}: {error}") from error


def read_attributes(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Global attributes of a file but those of its format."""
    format_names = {"format", "format_version", "Conventions"}
    return {str(name): value for name, value in _opened(path).attrs.items() if name not in format_names}


def _opened(path: str | os.PathLike[str]) -> xr.Dataset:
    """A file of contact problems in memory; InputError if it is none."""
    dataset = read_dataset(path, square=True)
    if str(dataset.attrs.get("format", FORMAT)) not in (FORMAT, SINGLE_FORMAT):
        raise InputError(f"{path} holds no contact problems: its attribute 'format' is not {FORMAT!r}")
    version, known = dataset.attrs.get("format_version", FORMAT_VERSION), False
    with contextlib.suppress(TypeError, ValueError):
        known = float(version) == FORMAT_VERSION
    if not known:
        raise InputError(f"{path} is of format version {shown(version)}; this program reads {FORMAT_VERSION}")
    try:
        require_arrays(dataset)
    except InputError as error:
        raise InputError(f"{path} holds no contact problems: {error}") from error
    return dataset
