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
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ....core.attributes import units_of
from ....core.checks import instance, shown
from ....core.errors import InputError
from ....core.netcdf_file import read_dataset, write_netcdf
from ..answer import Answer
from ..contact_problem import ContactProblem
from ..problem_arrays import problem_arrays, require_arrays
from ..problem_dataset import ATTRIBUTES
from ..problem_dataset import FORMAT as SINGLE_FORMAT
from .problem_set import require_problems
from .reference_solutions import ATTRIBUTES as REFERENCE_ATTRIBUTES
from .reference_solutions import reference_arrays, reference_variables, require_answers

FORMAT = "easeoff contact problems"
FORMAT_VERSION = 1

_OWN_NAMES = (
    frozenset(ATTRIBUTES)
    | frozenset(REFERENCE_ATTRIBUTES)
    | {"size", "structured", "mode_count", "problem", "segment", "segment_other", "mode"}
)


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
    taken = sorted(set(attributes) & set(dataset.attrs))
    if taken:
        raise InputError(f"attribute = {taken[0]!r}: must be another name, the file has an attribute of this one")
    dataset.attrs.update(attributes)
    encoding: dict[str, dict[str, Any]] = {
        str(name): {"zlib": True, "complevel": 1, "_FillValue": None}
        for name, variable in dataset.variables.items()
        if variable.dtype.kind in "fi"
    }
    write_netcdf(dataset, path, encoding)


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
    """Read what else a file says of each problem: the labels it was written with, each an array of one entry a problem.

    Raises
    ------
    InputError
        As `read_problems`.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_problems([springs], Path(folder, "problems.nc"), labels={"name": ["two springs"]})
    ...     [str(name) for name in read_labels(Path(folder, "problems.nc"))["name"]]
    ['two springs']
    """
    dataset = _opened(path)
    problem = dataset["torque"].dims
    labels = [str(name) for name in dataset.variables if name not in _OWN_NAMES and dataset[name].dims == problem]
    found = {name: np.atleast_1d(dataset[name].to_numpy()) for name in labels}
    for name, values in found.items():
        if values.dtype.kind not in "fiu" and units_of(name) is not None:
            raise InputError(f"{path}: label {name} = {shown(values)}: must hold numbers")
    return {name: values.astype(str) if values.dtype.kind == "O" else values for name, values in found.items()}


def _dataset(problems: Sequence[ContactProblem]) -> xr.Dataset:
    count, widest = len(problems), max(problem.size for problem in problems)
    modes = [problem.compliance[1].shape[1] if isinstance(problem.compliance, tuple) else 0 for problem in problems]
    structured = np.array([problem.is_structured for problem in problems], dtype=np.int8)
    data: dict[str, tuple[tuple[str, ...], NDArray[Any]]] = {
        "separation": (("problem", "segment"), np.full((count, widest), np.nan)),
        "lever_arm": (("problem", "segment"), np.full((count, widest), np.nan)),
        "torque": (("problem",), np.array([problem.torque for problem in problems])),
    }
    if structured.any():
        data["compliance_diagonal"] = (("problem", "segment"), np.full((count, widest), np.nan))
        data["compliance_factor"] = (("problem", "segment", "mode"), np.full((count, widest, max(modes)), np.nan))
    if not structured.all():
        data["compliance"] = (("problem", "segment", "segment_other"), np.full((count, widest, widest), np.nan))
    for i, problem in enumerate(problems):
        n = problem.size
        data["separation"][1][i, :n] = problem.separation
        data["lever_arm"][1][i, :n] = problem.lever_arm
        if isinstance(problem.compliance, tuple):
            data["compliance_diagonal"][1][i, :n] = problem.compliance[0]
            data["compliance_factor"][1][i, :n, : modes[i]] = problem.compliance[1]
        else:
            data["compliance"][1][i, :n, :n] = problem.dense_compliance
    dataset = xr.Dataset(
        {name: (dims, values, ATTRIBUTES[name]) for name, (dims, values) in data.items()},
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
    n = int(data["size"][i])
    compliance: Any
    if data["structured"][i]:
        factor = data["compliance_factor"][i, :n, : int(data["mode_count"][i])]
        compliance = (data["compliance_diagonal"][i, :n], factor)
    else:
        compliance = data["compliance"][i, :n, :n]
    try:
        return ContactProblem(data["separation"][i, :n], data["lever_arm"][i, :n], data["torque"][i], compliance)
    except InputError as error:
        raise InputError(f"problem {i}: {error}") from error


def read_attributes(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read the global attributes of a file but those of its format.

    Raises
    ------
    InputError
        As `read_problems`.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_problems([springs], Path(folder, "problems.nc"), attributes={"title": "springs"})
    ...     read_attributes(Path(folder, "problems.nc"))
    {'title': 'springs'}
    """
    own = {"format", "format_version", "Conventions"}
    return {str(name): value for name, value in _opened(path).attrs.items() if name not in own}


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
