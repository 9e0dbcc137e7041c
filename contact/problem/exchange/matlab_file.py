"""Contact problems as a MATLAB file (version 5), read by ``load`` in MATLAB and Octave and by ``matread`` in Julia.

The file has one variable, ``problem``, a struct array with one element a problem. Its fields bear the names of the
netCDF file: ``separation`` and ``lever_arm`` (n, 1) [mm], ``torque`` [N mm], ``compliance`` (n, n) [mm/N] of a dense
problem, ``compliance_diagonal`` (n, 1) and ``compliance_factor`` (n, k) of a structured one, the labels, and of the
reference solution ``reference_force`` [N], ``reference_gap`` [mm] (n, 1), ``reference_rotation`` and
``reference_elastic_rotation`` [rad]. Vectors are columns, nothing is padded, and what a problem lacks is empty. Indices
are as in netCDF: row i of V belongs to segment i, whatever the order in memory.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.arrays import RealArray as Array
from ....core.errors import InputError
from ....core.forked_process import ProcessEndedError, in_forked_process
from ....core.netcdf_file import unpacked_size_limit
from ....core.output_file import whole_file
from ....core.regular_file import faults_in_words, named, require_file
from ..contact_problem import VARIABLES, ContactProblem, problem_numbers, problem_of_numbers
from .fclib_file import VARIABLES as REFERENCE_VARIABLES, reference_numbers, require_answers, stored_reference
from .problem_file import ProblemSet

VARIABLE = "problem"
FIELDS = (*VARIABLES, *REFERENCE_VARIABLES)
FIELD_LENGTH_LIMIT = 31  # of a field's name in version 5


def write_mat(problems: ProblemSet | Sequence[ContactProblem], path: str | os.PathLike[str]) -> None:
    """Write contact problems as a MATLAB file (``.mat``), complete or not at all.

    Labels must be names that MATLAB can take for fields; at most 4 GB a problem.
    """
    from scipy.io import savemat
    from scipy.io.matlab import MatWriteError

    problems = ProblemSet.of(problems)
    require_answers(problems.problems, problems.answers)
    for name in problems.labels:
        if name in FIELDS or not (name.isidentifier() and name.isascii() and len(name) <= FIELD_LENGTH_LIMIT):
            raise InputError(
                f"label = {name!r}: must be a name of letters, digits and underscores, {FIELD_LENGTH_LIMIT} at most, "
                "that the file does not use itself"
            )
    names = [*VARIABLES, *(REFERENCE_VARIABLES if problems.answers is not None else ()), *problems.labels]
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
    answers = [stored_reference(p, element) for p, element in zip(problems, elements, strict=True)]
    whole = [answer for answer in answers if answer is not None]
    return ProblemSet(problems, _labels(elements), whole if len(whole) == len(problems) else None)


def _fields(problems: ProblemSet, i: int) -> dict[str, Any]:
    """Fields of one problem; vectors as columns."""
    answer = problems.answer(i)
    numbers = problem_numbers(problems.problems[i]) | ({} if answer is None else reference_numbers(answer))
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
