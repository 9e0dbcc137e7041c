"""Reference solutions in a file of contact problems: forces, gaps and rotation of each problem beside its data.

Variables: ``reference_force`` [N] and ``reference_gap`` [mm] (problem, segment), ``reference_rotation`` [rad] and
``reference_elastic_rotation`` [rad], the rotation beyond first contact (problem). NaN where there is no answer.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.checks import instances, shown
from ....core.errors import InputError
from ....core.netcdf_file import read_dataset
from ..answer import Answer, no_answer, with_certificate
from ..contact_problem import ContactProblem

Array = NDArray[np.float64]

ATTRIBUTES: dict[str, dict[str, str]] = {
    "reference_force": {"units": "N", "long_name": "normal force of the reference solution"},
    "reference_gap": {"units": "mm", "long_name": "gap of the reference solution"},
    "reference_rotation": {"units": "rad", "long_name": "rotation of the reference solution"},
    "reference_elastic_rotation": {
        "units": "rad",
        "long_name": "rotation of the reference solution beyond first contact",
    },
}


def require_answers(problems: Sequence[ContactProblem], answers: Sequence[Answer] | None) -> None:
    """Refuse answers of another number or of other sizes than the problems.

    Raises
    ------
    InputError
        The message names the first that does not fit.
    """
    if answers is None:
        return
    instances("answers", answers, Answer)
    if len(answers) != len(problems):
        raise InputError(f"answers = {len(answers)}: must be one for each of {len(problems)} problems")
    for i, (problem, answer) in enumerate(zip(problems, answers, strict=True)):
        if answer.force.shape != (problem.size,):
            raise InputError(f"answer {i} = {shown(answer.force)}: must have the forces of {problem.size} segments")


def reference_variables(answers: Sequence[Answer], width: int) -> dict[str, xr.DataArray]:
    """Return the variables of a file with problems of at most `width` segments, padded with NaN."""
    force, gap = np.full((len(answers), width), np.nan), np.full((len(answers), width), np.nan)
    for i, answer in enumerate(answers):
        force[i, : answer.force.size], gap[i, : answer.gap.size] = answer.force, answer.gap
    values: dict[str, tuple[tuple[str, ...], Array]] = {
        "reference_force": (("problem", "segment"), force),
        "reference_gap": (("problem", "segment"), gap),
        "reference_rotation": (("problem",), np.array([a.rotation for a in answers])),
        "reference_elastic_rotation": (("problem",), np.array([a.elastic_rotation for a in answers])),
    }
    return {name: xr.DataArray(array, dims=dims, attrs=ATTRIBUTES[name]) for name, (dims, array) in values.items()}


def read_references(path: str | os.PathLike[str], problems: Sequence[ContactProblem]) -> list[Answer] | None:
    """Read the reference solutions of a netCDF file, and certify them anew.

    Parameters
    ----------
    path
        The file.
    problems
        Its problems, from `read_problems`.

    Returns
    -------
    list of Answer or None
        None if the file has none.

    Raises
    ------
    InputError
        The file cannot be read, or its solutions do not belong to these problems.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, read_problems, solve, write_problems
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "problems.nc")
    ...     write_problems([springs], path, answers=[solve(springs).answer])
    ...     [answer.force.tolist() for answer in read_references(path, read_problems(path))]
    [[1000.0, 1000.0]]
    """
    try:
        given = reference_arrays(read_dataset(path, square=True), len(problems), max(p.size for p in problems))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    if given is None:
        return None
    return [reference(p, f[: p.size], float(r)) for p, f, r in zip(problems, *given, strict=True)]


def reference_arrays(dataset: xr.Dataset, count: int, widest: int) -> tuple[Array, Array] | None:
    """Forces (problem, segment) [N] and rotations (problem) beyond first contact [rad] of a file; None if it has none.

    Raises
    ------
    InputError
        One of them is missing, holds no numbers for each of `count` problems, or has other units.
    """
    found = []
    for name, width in (("reference_force", widest), ("reference_elastic_rotation", 1)):
        values, units = dataset.get(name), ATTRIBUTES[name]["units"]
        if values is None and name == "reference_force":
            return None
        if values is None or values.dtype.kind not in "fiu" or values.size % count or values.size < width * count:
            raise InputError(f"{name}: must hold numbers for each of its {count} problems")
        if str(values.attrs.get("units", units)) != units:
            raise InputError(f"units of {name} = {shown(values.attrs['units'])}: must be {units!r}")
        found.append(values.to_numpy().astype(np.float64).reshape(count, -1))
    return found[0], found[1][:, 0]


def reference(problem: ContactProblem, force: Array, elastic_rotation: float) -> Answer:
    """Return stored forces [N] and a rotation beyond first contact [rad] as an answer, certified anew."""
    if not (math.isfinite(elastic_rotation) and np.isfinite(force).all()):
        return no_answer(problem.size)
    return with_certificate(problem, np.array(force, dtype=np.float64), elastic_rotation)


def stored_reference(problem: ContactProblem, fields: Mapping[str, Any]) -> Answer | None:
    """Return the reference solution among the fields of one problem; None if there is none."""
    force, elastic = fields.get("reference_force"), fields.get("reference_elastic_rotation")
    if force is None or elastic is None or np.size(force) != problem.size or np.size(elastic) != 1:
        return None
    return reference(problem, np.asarray(force, dtype=np.float64).ravel(), float(np.ravel(elastic)[0]))
