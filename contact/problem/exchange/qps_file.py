"""One contact problem as a QPS file, the text that most programs for quadratic programmes read, and back without loss.

The columns ``F1``, ``F2``, ... are the normal forces, not negative; the row ``BALANCE`` is r'F = T. In the lifted form,
for C = diag(d) + V V^T, free columns ``Z1``, ... are the modal amplitudes and the rows ``M1``, ... say V'F - z = 0;
Q is then diagonal. Names have at most eight characters without blanks. Numbers are written with as many digits as
determine them, up to 17, for which the fields of the fixed format are too short: the file is in free format.

The numbers are those of the problem in other units, powers of two chosen so that they are of order one: solvers stop
at absolute tolerances. Neither the zero of the rotation nor any separation is changed, so that no bit is lost. The
comments at the head of the file give the units, and how forces and rotation follow from an answer. The rotation is the
dual of ``BALANCE``, the derivative of the minimum with respect to its right side, T.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.checks import one_of, shown
from ....core.errors import InputError
from ....core.netcdf_file import unpacked_size_limit
from ....core.output_file import whole_file
from ....core.regular_file import faults_in_words, require_file
from ..contact_problem import ContactProblem
from .problem_units import ProblemUnits, problem_data
from .qps_sections import QpsProgramme, qps_programme

Array = NDArray[np.float64]

#: Forms in which a problem can be written; ``auto`` is the lifted one where the compliance is structured.
QPS_FORMS = ("auto", "dense", "lifted")
UNIT = "easeoff unit of "


def write_qps(
    problem: ContactProblem, path: str | os.PathLike[str], *, form: str = "auto", name: str = "contact"
) -> None:
    """Write a contact problem as a QPS file.

    Parameters
    ----------
    problem
        The contact problem.
    path
        The file, replaced if it exists. It appears complete or not at all.
    form
        ``"dense"``, the matrix C; ``"lifted"``, sparse, for a structured compliance; ``"auto"``, lifted where the
        compliance is structured.
    name
        Name of the problem in the file; blanks become underscores.

    Raises
    ------
    InputError
        An unknown form, or one the problem cannot have; the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_qps(springs, Path(folder, "problem.qps"))
    ...     Path(folder, "problem.qps").read_text().split("ROWS")[1].split("RHS")[0].split()[:4]
    ['N', 'ENERGY', 'E', 'BALANCE']
    """
    one_of("form", form, QPS_FORMS)
    if form == "lifted" and not problem.is_structured:
        raise InputError("form = 'lifted': must be dense for a single dense matrix; the lifted form needs (d, V)")
    with whole_file(path) as temporary, temporary.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(_lines(problem, form, name))


def read_qps(path: str | os.PathLike[str]) -> ContactProblem:
    """Read a contact problem from a QPS file.

    Parameters
    ----------
    path
        A file of `write_qps`, or of another program: columns that are not negative, one equality, and no other row but
        those of the lifted form. Numbers of another program are taken for mm and N.

    Returns
    -------
    ContactProblem
        Identical to the one written; after the dense form of a structured one, with one matrix.

    Raises
    ------
    InputError
        The file cannot be read, or its programme is no contact problem.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_qps(springs, Path(folder, "problem.qps"))
    ...     read_qps(Path(folder, "problem.qps")).identical(springs)
    True
    """
    require_file(path, unpacked_size_limit())
    try:
        with faults_in_words(path, "a QPS file"), open(path, encoding="utf-8") as file:
            programme = qps_programme(file)
        return ContactProblem(*_units(programme).restored(*_contact_data(programme)))
    except InputError as error:
        raise InputError(str(error) if str(path) in str(error) else f"{path}: {error}") from error


def _lines(problem: ContactProblem, form: str, name: str) -> Iterator[str]:
    units = ProblemUnits.of(problem)
    separation, arm, torque, compliance = units.changed(*problem_data(problem))
    if form == "dense" and problem.is_structured:
        compliance = problem.dense_compliance / units.compliance
    size = problem.size
    yield "* Contact problem: minimise 1/2 F'C F + S'F subject to r'F = T, F >= 0. Written by easeoff.\n"
    yield "* Columns: F1.. forces; Z1.. amplitudes z = V'F, if C = diag(d) + V V'.\n"
    yield f"*{UNIT}force [N] = {units.force!r}\n"
    yield f"*{UNIT}compliance [mm/N] = {units.compliance!r}\n"
    yield f"*{UNIT}lever_arm [mm] = {units.lever_arm!r}\n"
    yield f"* In N: F times {units.force!r}. Rotation in rad: the dual of BALANCE, the derivative of the minimum with\n"
    yield f"* respect to T, times {units.rotation!r}.\n"
    yield f"* Problem: {_word(name)}\n"
    yield f"NAME {_word(name)}\nROWS\n N ENERGY\n E BALANCE\n"
    factor = compliance[1] if isinstance(compliance, tuple) else np.zeros((size, 0))
    modes = factor.shape[1]
    yield from (f" E M{k + 1}\n" for k in range(modes))
    yield "COLUMNS\n"
    for i in range(size):
        # Every column has an entry, or it would not exist.
        yield f" F{i + 1} ENERGY {float(separation[i])!r}\n"
        if arm[i] != 0.0:
            yield f" F{i + 1} BALANCE {float(arm[i])!r}\n"
        yield from (f" F{i + 1} M{k + 1} {float(factor[i, k])!r}\n" for k in np.flatnonzero(factor[i]))
    yield from (f" Z{k + 1} M{k + 1} -1.0\n" for k in range(modes))
    yield f"RHS\n RHS BALANCE {float(torque)!r}\n"
    if modes:
        yield "BOUNDS\n"
        yield from (f" FR BND Z{k + 1}\n" for k in range(modes))
    yield "QUADOBJ\n"
    if isinstance(compliance, tuple):
        diagonal = compliance[0]
        yield from (f" F{i + 1} F{i + 1} {float(diagonal[i])!r}\n" for i in np.flatnonzero(diagonal))
        yield from (f" Z{k + 1} Z{k + 1} 1.0\n" for k in range(modes))
    else:
        for j in range(size):
            below = j + np.flatnonzero(compliance[j:, j])
            yield from (f" F{j + 1} F{i + 1} {float(compliance[i, j])!r}\n" for i in below)
    yield "ENDATA\n"


def _contact_data(programme: QpsProgramme) -> tuple[Array, Array, float, Any]:
    """Separation, lever arm, torque and compliance, in the units of the file."""
    columns = list(programme.linear)
    free = [c for c in columns if programme.lower.get(c, 0.0) == -math.inf]
    for column in columns:
        lower, upper = programme.lower.get(column, 0.0), programme.upper.get(column, math.inf)
        if lower not in (0.0, -math.inf) or upper != math.inf:
            raise InputError(f"bounds of {column} = {lower:g}, {upper:g}: must be 0 and infinity, or none")
    for row, kind in programme.row_types.items():
        if kind != "E":
            raise InputError(f"type of the row {row} = {kind}: must be E, a contact problem has no inequalities")
    amplitude = {c: k for k, c in enumerate(free)}
    force = {c: i for i, c in enumerate(c for c in columns if c not in amplitude)}
    rows = {row: programme.entries.get(row, {}) for row in programme.row_types}
    balances = [row for row, entries in rows.items() if not any(c in amplitude for c in entries)]
    if len(balances) != 1 or len(rows) != 1 + len(free):
        raise InputError("rows: must be one equality, the balance of torque, and one for each free column")
    (balance,) = balances
    arm = np.zeros(len(force))
    for column, value in rows.pop(balance).items():
        arm[force[column]] = value
    separation = np.array([programme.linear[c] for c in force])
    torque = programme.right.get(balance, 0.0)
    if not free:
        return separation, arm, torque, _dense(programme, force)
    return separation, arm, torque, _structured(programme, force, amplitude, rows)


def _dense(programme: QpsProgramme, force: dict[str, int]) -> Array:
    matrix = np.zeros((len(force), len(force)))
    for (a, b), value in programme.quadratic.items():
        matrix[force[a], force[b]] = matrix[force[b], force[a]] = value
    return matrix


def _structured(
    programme: QpsProgramme, force: dict[str, int], amplitude: dict[str, int], rows: dict[str, dict[str, float]]
) -> tuple[Array, Array]:
    diagonal, weight = np.zeros(len(force)), np.zeros(len(amplitude))
    for (a, b), value in programme.quadratic.items():
        if a != b:
            raise InputError(
                f"QUADOBJ, entry of {a} and {b} = {value:g}: must be none, in the lifted form Q is diagonal"
            )
        if a in force:
            diagonal[force[a]] = value
        else:
            weight[amplitude[a]] = value
    factor, seen = np.zeros((len(force), len(amplitude))), set()
    for row, entries in rows.items():
        own = [c for c in entries if c in amplitude]
        if len(own) != 1 or own[0] in seen or programme.right.get(row, 0.0) != 0.0 or programme.linear[own[0]] != 0.0:
            raise InputError(f"row {row}: must define one free column, V'F - z = 0")
        seen.add(own[0])
        mode = amplitude[own[0]]
        if not weight[mode] > 0.0:
            raise InputError(f"QUADOBJ, entry of {own[0]} = {weight[mode]:g}: must be positive")
        scale = -math.sqrt(weight[mode]) / entries[own[0]]
        for column, value in entries.items():
            if column in force:
                factor[force[column], mode] = scale * value
    return diagonal, factor


def _units(programme: QpsProgramme) -> ProblemUnits:
    """Units that the comments of a file name; mm and N without them."""
    found: dict[str, float] = {}
    for comment in programme.comments:
        if comment.startswith(UNIT):
            name, _, value = comment.removeprefix(UNIT).partition("=")
            try:
                number = float(value)
            except ValueError:
                number = math.nan
            if not 0.0 < number < math.inf:
                raise InputError(f"{UNIT}{name.strip()} = {shown(value.strip())}: must be a positive number")
            found[name.split()[0] if name.split() else ""] = number
    return ProblemUnits(found.get("force", 1.0), found.get("compliance", 1.0), found.get("lever_arm", 1.0))


def _word(name: str) -> str:
    """A name without blanks, in ASCII."""
    return "_".join(name.encode("ascii", "replace").decode().split()) or "contact"
