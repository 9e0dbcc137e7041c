"""One contact problem as a file of FCLib, the collection of frictional contact problems, with friction zero.

FCLib's local problem is to find velocities u, forces r and multipliers l with

    u = W r + V l + q,   V'r + R l + s = 0,   u and r in the cones of Coulomb friction mu, of every contact.

A contact problem is one with mu = 0: W = C, V = -(lever arms), R = 0, q = S, s = T; then r are the forces F, u the gaps
Y and l is the rotation. Each contact has three directions, the normal one first; FCLib has no problem without the other
two. There W has the diagonal of C, V and q are zero: with mu = 0 forces and displacements in these directions vanish.
Numbers are those of the problem in mm, N and N mm.

The layout is that of ``fclib_write_local`` and ``fclib_write_solution`` of FCLib 3: in the group ``fclib_local`` the
whole number ``spacedim``, the matrices ``W``, ``V`` and ``R``, each a group of ``nzmax``, ``m``, ``n``, ``nz``, ``p``,
``i`` and ``x``, ``vectors`` with ``q``, ``mu`` and ``s``, and texts in ``info``; in the group ``solution``, where a
reference is known, ``u``, ``r`` and ``l``. ``nz`` is -1 for compressed columns, -2 for compressed rows, the number of
entries for triplets. Matrices are written as compressed columns. As W is stored as a matrix, a structured compliance is
kept besides in a group ``easeoff`` of our own, which FCLib does not read.

V. Acary, M. Bremond, T. Koziara, F. Perignon, FCLIB: a collection of discrete 3D frictional contact problems, INRIA
RT-444 (2014), https://inria.hal.science/hal-00945820.

Beside the data of contact problems a file may hold reference solutions: ``reference_force`` [N] and ``reference_gap``
[mm] (problem, segment), ``reference_rotation`` [rad] and ``reference_elastic_rotation`` [rad], the rotation beyond
first contact (problem). NaN where there is no answer.
"""

from __future__ import annotations

import importlib
import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ....core.arrays import RealArray as Array
from ....core.checks import instances, shown
from ....core.errors import InputError, memory_in_words
from ....core.forked_process import ProcessEndedError, in_forked_process
from ....core.netcdf_file import check_links, read_dataset, unpacked_size_limit
from ....core.output_file import whole_file
from ....core.regular_file import faults_in_words, named, require_file
from ..certificate import Answer, no_answer, with_certificate
from ..contact_problem import ContactProblem

#: Dimensions, units and meaning of every variable of a reference solution.
VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "reference_force": (("segment",), "N", "normal force of the reference solution"),
    "reference_gap": (("segment",), "mm", "gap of the reference solution"),
    "reference_rotation": ((), "rad", "rotation of the reference solution"),
    "reference_elastic_rotation": ((), "rad", "rotation of the reference solution beyond first contact"),
}


def require_answers(problems: Sequence[ContactProblem], answers: Sequence[Answer] | None) -> None:
    """Refuse answers of another number or of other sizes than the problems."""
    if answers is None:
        return
    instances("answers", answers, Answer)
    if len(answers) != len(problems):
        raise InputError(f"answers = {len(answers)}: must be one for each of {len(problems)} problems")
    for i, (problem, answer) in enumerate(zip(problems, answers, strict=True)):
        if answer.force.shape != (problem.size,):
            raise InputError(f"answer {i} = {shown(answer.force)}: must have the forces of {problem.size} segments")


def reference_numbers(answer: Answer) -> dict[str, Any]:
    """Numbers of a reference solution by name, as files have them."""
    return {name: getattr(answer, name.removeprefix("reference_")) for name in VARIABLES}


def padded(values: Sequence[ArrayLike | None], *lengths: int) -> Array:
    """Arrays, some of them missing, as one array with a row each, padded with NaN to the same lengths."""
    whole = np.full((len(values), *lengths), np.nan)
    for row, one in enumerate(values):
        if one is not None:
            part: tuple[Any, ...] = (row, *map(slice, np.shape(one)))
            whole[part] = one
    return whole


def reference_variables(answers: Sequence[Answer], width: int) -> dict[str, xr.DataArray]:
    """Return the variables of a file with problems of at most `width` segments, padded with NaN."""
    numbers, variables = [reference_numbers(answer) for answer in answers], {}
    for name, (dimensions, units, meaning) in VARIABLES.items():
        values = padded([one[name] for one in numbers], *(width for _ in dimensions))
        attributes = {"units": units, "long_name": meaning}
        variables[name] = xr.DataArray(values, dims=("problem", *dimensions), attrs=attributes)
    return variables


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
    """Forces (problem, segment) [N] and rotations (problem) beyond first contact [rad] of a file, if any."""
    arrays = []
    for name, width in (("reference_force", widest), ("reference_elastic_rotation", 1)):
        values, units = dataset.get(name), VARIABLES[name][1]
        if values is None and name == "reference_force":
            return None
        if values is None or values.dtype.kind not in "fiu" or values.size % count or values.size < width * count:
            raise InputError(f"{name}: must hold numbers for each of its {count} problems")
        if str(values.attrs.get("units", units)) != units:
            raise InputError(f"units of {name} = {shown(values.attrs['units'])}: must be {units!r}")
        arrays.append(values.to_numpy().astype(np.float64).reshape(count, -1))
    return arrays[0], arrays[1][:, 0]


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


DIRECTIONS = 3  # of a contact that is written
ENTRY_SIZE = 12  # of a matrix: a number and its row [byte]
DESCRIPTION = "Contact of gear teeth in mm, N, N mm and rad, written by easeoff: W = C, l = rotation."
MATH_INFO = "Convex: mu = 0. With W positive definite the solution is unique."


def write_fclib(
    problem: ContactProblem,
    path: str | os.PathLike[str],
    *,
    answer: Answer | None = None,
    name: str = "contact problem",
) -> None:
    """Write a contact problem as an HDF5 file of FCLib, complete or not at all, an answer as group ``solution``."""
    import h5py

    size = problem.size
    needed, limit = ENTRY_SIZE * size**2, unpacked_size_limit()
    if needed > limit:
        raise InputError(
            f"size = {size}: FCLib stores the compliance as a matrix, which would take {memory_in_words(needed)}; at "
            f"most {memory_in_words(limit)} are written"
        )
    with whole_file(path) as temporary, h5py.File(temporary, "w") as file:
        local = file.create_group("fclib_local")
        _whole(local, "spacedim", DIRECTIONS)
        _write_columns(local.create_group("W"), *_directions(problem), DIRECTIONS * size)
        normal = np.arange(0, DIRECTIONS * size, DIRECTIONS)
        _write_columns(local.create_group("V"), np.array([0, size]), normal, -problem.lever_arm, DIRECTIONS * size)
        _write_columns(local.create_group("R"), np.array([0, 1]), np.array([0]), np.zeros(1), 1)
        vectors = local.create_group("vectors")
        vectors["q"], vectors["mu"] = _in_directions(problem.separation), np.zeros(size)
        vectors["s"] = np.array([problem.torque])
        info = local.create_group("info")
        _text(info, "title", name)
        _text(info, "description", DESCRIPTION)
        _text(info, "math_info", MATH_INFO)
        if isinstance(problem.compliance, tuple):
            group = file.create_group("easeoff")
            group["compliance_diagonal"], group["compliance_factor"] = problem.compliance
        if answer is not None:
            solution = file.create_group("solution")
            solution["l"] = np.array([answer.rotation])
            solution["u"], solution["r"] = _in_directions(answer.gap), _in_directions(answer.force)
            file.require_group("easeoff")["elastic_rotation"] = np.array([answer.elastic_rotation])


def read_fclib(path: str | os.PathLike[str]) -> tuple[ContactProblem, Answer | None]:
    """Contact problem, and its solution certified anew or None, from an HDF5 file of FCLib.

    Other programs: 2 or 3 directions a contact, friction zero, one equality with R = 0; numbers taken as mm and N.
    """
    limit = unpacked_size_limit()
    require_file(path, limit)
    importlib.import_module("h5py")
    try:  # the library crashes on some damaged files
        arrays = in_forked_process(lambda: _arrays(path, limit))
    except ProcessEndedError as error:
        raise InputError(f"{named(path)} is not an HDF5 file, or it is damaged: {error}") from error
    try:
        return _contact_problem(arrays)
    except KeyError as error:
        raise InputError(
            f"{path} holds no local problem of FCLib with an equality: {error.args[0]} is missing"
        ) from error
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _directions(problem: ContactProblem) -> tuple[NDArray[Any], NDArray[Any], Array]:
    """Column pointers, rows and entries of W in compressed columns, zeros of C left out."""
    size, dense = problem.size, problem.dense_compliance
    pointers, rows, entries = [0], list[Any](), list[Any]()
    for j in range(size):
        filled = np.flatnonzero(dense[:, j])
        rows += [DIRECTIONS * filled, *([DIRECTIONS * j + k] for k in range(1, DIRECTIONS))]
        entries += [dense[filled, j], *([dense[j, j]] for _ in range(1, DIRECTIONS))]
        pointers += [pointers[-1] + filled.size + k for k in range(DIRECTIONS)]
    return np.array(pointers), np.concatenate(rows), np.concatenate(entries)


def _write_columns(group: Any, pointers: NDArray[Any], rows: NDArray[Any], entries: Array, height: int) -> None:
    for name, value in (("nzmax", entries.size), ("m", height), ("n", pointers.size - 1), ("nz", -1)):
        _whole(group, name, value)
    group["p"], group["i"] = pointers.astype(np.int32), rows.astype(np.int32)
    group["x"] = entries


def _whole(group: Any, name: str, value: int) -> None:
    group[name] = np.array([value], dtype=np.int32)


def _text(group: Any, name: str, value: str) -> None:
    """Text as C reads it, of fixed length with a zero at its end."""
    content = value.encode("ascii", "replace")
    group[name] = np.array(content, dtype=f"S{len(content) + 1}")


def _in_directions(normal: Array) -> Array:
    whole = np.zeros(DIRECTIONS * normal.size)
    whole[::DIRECTIONS] = normal
    return whole


def _arrays(path: str | os.PathLike[str], limit: int) -> dict[str, NDArray[Any]]:
    """Numbers of the file by path within it."""
    import h5py

    arrays: dict[str, NDArray[Any]] = {}

    def take(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "iuf":
            arrays[name] = item

    with faults_in_words(path, "an HDF5 file"):
        check_links(path)
        with h5py.File(os.fspath(path), "r") as file:
            file.visititems(take)
            size = sum(8 * int(item.size) for item in arrays.values())
            if size > limit:
                raise InputError(f"{named(path)} would take {memory_in_words(size)}: at most {memory_in_words(limit)}")
            return {name: np.asarray(item[()]) for name, item in arrays.items()}


def _contact_problem(arrays: dict[str, NDArray[Any]]) -> tuple[ContactProblem, Answer | None]:
    directions = int(arrays["fclib_local/spacedim"].ravel()[0])
    if directions not in (2, 3):
        raise InputError(f"spacedim = {directions}: must be 2 or 3")
    vectors = {name: arrays[f"fclib_local/vectors/{name}"].ravel() for name in ("q", "mu", "s")}
    if np.any(vectors["mu"] != 0.0):
        raise InputError(f"mu = {shown(vectors['mu'])}: must be zero, a contact problem here has no friction")
    w, v, r = (_matrix(arrays, f"fclib_local/{name}") for name in ("W", "V", "R"))
    size = w.shape[0] // directions
    if v.shape != (w.shape[0], 1) or vectors["s"].size != 1 or r.count_nonzero():
        raise InputError("V, R, s: must be one equality with R = 0, the balance of torque")
    if w.shape[0] != w.shape[1] or w.shape[0] != directions * size or vectors["q"].size != w.shape[0]:
        raise InputError(f"W = matrix of shape {w.shape}: must be square, with {directions} rows a contact, as q")
    normal = slice(0, None, directions)
    names = tuple(f"easeoff/compliance_{part}" for part in ("diagonal", "factor"))
    compliance: Any = tuple(arrays[n] for n in names) if set(names) <= arrays.keys() else _normal(w, directions)
    arm = -v.toarray().ravel()[normal]
    problem = ContactProblem(vectors["q"][normal], arm, float(vectors["s"][0]), compliance)
    if "solution/r" not in arrays or arrays["solution/r"].size != w.shape[0]:
        return problem, None
    elastic = arrays.get("easeoff/elastic_rotation")
    rotation = float(arrays["solution/l"].ravel()[0])
    beyond = rotation - problem.first_contact_rotation if elastic is None else float(elastic.ravel()[0])
    return problem, reference(problem, arrays["solution/r"].ravel()[normal], beyond)


def _normal(matrix: Any, directions: int) -> Array:
    """Entries of the normal directions as a full matrix."""
    return np.asarray(matrix.tocsr()[::directions].tocsc()[:, ::directions].toarray(), dtype=np.float64)


def _matrix(arrays: dict[str, NDArray[Any]], name: str) -> Any:
    """A matrix of FCLib as one of scipy."""
    from scipy.sparse import coo_array, csc_array, csr_array

    height, width, kind = (int(arrays[f"{name}/{key}"].ravel()[0]) for key in ("m", "n", "nz"))
    pointers, indices, entries = (arrays[f"{name}/{key}"].ravel() for key in ("p", "i", "x"))
    shape = (height, width)
    try:
        if kind >= 0:
            return coo_array((entries[:kind], (pointers[:kind], indices[:kind])), shape=shape)
        form = {-1: csc_array, -2: csr_array}[kind]
        count = int(pointers[-1]) if pointers.size else 0
        matrix = form((entries[:count].astype(np.float64), indices[:count], pointers), shape=shape)
        matrix.check_format(full_check=True)
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(f"{name}: must be a matrix in compressed columns or rows, or triplets ({error})") from error
    return matrix
