"""One contact problem as a quadratic programme for other programs, as a NumPy or a QPS file, read back without loss.

Of a NumPy file `qpsolvers.Problem.load(path)` gives the scaled programme, in the form chosen. Beside the arrays of
qpsolvers, which takes no notice of others, the file holds

- ``contact_separation``, ``contact_lever_arm``, ``contact_torque`` and ``contact_compliance``, or
  ``contact_compliance_diagonal`` and ``contact_compliance_factor``: the problem itself, in mm, N and N mm;
- ``scale_force`` [N], ``scale_rotation`` [rad], ``first_contact_rotation`` [rad]: with the unknowns F and theta of the
  programme, the forces are ``scale_force`` F and the rotation ``first_contact_rotation + scale_rotation`` theta.

In the dense and the lifted form F are the first n unknowns and theta is minus the multiplier of the first equality; in
the dual form F are the first n unknowns and theta is the last.

A QPS file, the format of the Maros-Meszaros test problems, is a quadratic programme as text:

    minimise 1/2 x'Q x + c'x - k   subject to rows of type E, L or G and bounds on x

Sections are ``NAME``, ``ROWS``, ``COLUMNS``, ``RHS``, ``BOUNDS`` and ``QUADOBJ``, which holds the lower triangle of Q
with its diagonal: no entry is halved or doubled. The right side of the objective's row is k, *minus* the constant of
the objective. A column without a bound is not negative. There is no ``OBJSENSE`` in the test problems; a file that has
one must say ``MIN``. ``QMATRIX`` (all of Q) and ``QSECTION`` (as ``QUADOBJ``) are read as well.

Fields are separated by blanks, which is the free format. The fixed format has the same fields in fixed columns of at
most 12 characters, too few for a double; it reads as the free one unless names have blanks.

I. Maros, C. Meszaros, A repository of convex quadratic programming problems, Optimization Methods and Software 11
(1999) 671-681, doi 10.1080/10556789908805768.

For a contact problem the columns ``F1``, ``F2``, ... are the normal forces, not negative; the row ``BALANCE`` is r'F =
T. In the lifted form, for C = diag(d) + V V^T, free columns ``Z1``, ... are the modal amplitudes and the rows ``M1``,
... say V'F - z = 0; Q is then diagonal. Names have at most eight characters without blanks. Numbers are written with as
many digits as determine them, up to 17, for which the fields of the fixed format are too short: the file is in free
format.

The numbers are those of the problem in other units, powers of two chosen so that they are of order one: solvers stop
at absolute tolerances. Neither the zero of the rotation nor any separation is changed, so that no bit is lost. The
comments at the head of the file give the units, and how forces and rotation follow from an answer. The rotation is the
dual of ``BALANCE``, the derivative of the minimum with respect to its right side, T.
"""

from __future__ import annotations

import math
import os
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.array_file import read_arrays
from ....core.arrays import RealArray as Array
from ....core.checks import one_of, shown
from ....core.errors import InputError
from ....core.netcdf_file import unpacked_size_limit
from ....core.output_file import whole_file
from ....core.regular_file import faults_in_words, require_file
from ..contact_problem import ContactProblem, number_names, problem_numbers, problem_of_numbers
from ..programme_forms import dual_qp, lifted_qp
from ..scaled_problem import Units

#: Forms in which the programme can be written.
FORMS = ("dense", "lifted", "dual")
Arrays = Mapping[str, NDArray[Any] | None]


def write_npz(problem: ContactProblem, path: str | os.PathLike[str], *, form: str = "dense") -> None:
    """Write a contact problem as a quadratic programme of qpsolvers (``.npz``), complete or not at all.

    The form is ``dense`` (scaled), ``lifted`` or ``dual``; all matrices dense, as qpsolvers loses sparse constraints.
    """
    programme = _programme(problem, form)
    with whole_file(path) as temporary:
        with temporary.open("wb") as file:
            programme.save(file)
        with zipfile.ZipFile(temporary, "a") as archive:
            scales = {"scale_force": problem.scaling.force, "scale_rotation": problem.scaling.rotation}
            numbers = {f"contact_{name}": values for name, values in problem_numbers(problem).items()}
            first = {"first_contact_rotation": problem.first_contact_rotation}
            for name, values in (scales | first | numbers).items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                    np.lib.format.write_array(entry, np.asarray(values), allow_pickle=False)


def read_npz(path: str | os.PathLike[str]) -> ContactProblem:
    """Read a contact problem from a file of `write_npz`, or from another file of qpsolvers that holds one.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    ContactProblem
        Identical to the one written. From a file of another program, P, q, A and b are taken for C, S, r and T as they
        stand: in which units only its author knows.

    Raises
    ------
    InputError
        The file cannot be read, or its programme is no contact problem: one equality and F >= 0.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_npz(springs, Path(folder, "problem.npz"))
    ...     read_npz(Path(folder, "problem.npz")).identical(springs)
    True
    """
    arrays = read_arrays(path)
    try:
        if "contact_separation" not in arrays:
            return problem_of_numbers(_foreign_data(arrays))
        names = number_names("contact_compliance_factor" in arrays)
        return problem_of_numbers({name: arrays[f"contact_{name}"] for name in names})
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    except KeyError as error:
        raise InputError(f"{path} is incomplete: there is no array {error.args[0]!r}") from error


def _programme(problem: ContactProblem, form: str) -> Any:
    one_of("form", form, FORMS)
    if form == "dense":
        return problem.as_qp()
    programme: Any = (lifted_qp(problem) if form == "lifted" else dual_qp(problem)).programme
    for name in ("P", "G", "A"):
        matrix = getattr(programme, name)
        if matrix is not None and not isinstance(matrix, np.ndarray):
            setattr(programme, name, matrix.toarray())
    return programme


def _foreign_data(arrays: Arrays) -> dict[str, Any]:
    """Numbers of a problem from P, q, A and b; qpsolvers stores a missing one as an object."""
    matrix, linear = arrays["P"], arrays["q"]
    row, right = arrays.get("A"), arrays.get("b")
    if row is None or right is None:
        raise InputError("A = none: must be the balance of torque, the one equality A x = b")
    row, right = np.atleast_2d(row), np.atleast_1d(right)
    if row.shape[0] != 1 or right.shape != (1,):
        raise InputError(f"A = {shown(row)}: must be one equality, the balance of torque")
    lower, upper = arrays.get("lb"), arrays.get("ub")
    if lower is None or not _is_numeric(lower) or np.any(lower != 0.0):
        raise InputError(f"lb = {shown(lower)}: must be zero, the lower bounds of the normal forces")
    if arrays.get("G") is not None or (upper is not None and not (_is_numeric(upper) and np.all(upper == np.inf))):
        raise InputError("G, ub: must be left out, a contact problem has no inequalities and no upper bounds")
    return {"separation": linear, "lever_arm": row[0], "torque": right[0], "compliance": matrix}


def _is_numeric(array: NDArray[Any]) -> bool:
    return array.dtype.kind in "biuf"


@dataclass(frozen=True)
class ProblemUnits(Units):
    """Units of force [N], compliance [mm/N] and lever arm [mm] for the numbers of a problem, powers of two.

    Unlike the scaling for solvers (`scaling`), units change neither the zero of the rotation nor any separation: the
    problem can be had back to the bit.
    """

    force: float = 1.0
    compliance: float = 1.0  # [mm/N], a power of four: its root is the unit of V
    lever_arm: float = 1.0

    @classmethod
    def of(cls, problem: ContactProblem) -> ProblemUnits:
        """Units in which the numbers of a problem are of order one; mm and N where those would lose a bit."""
        scale = problem.scaling
        exponent = math.frexp(scale.compliance)[1] - 1
        units = cls(scale.force, math.ldexp(1.0, exponent - exponent % 2), scale.lever_arm)
        numbers = problem_numbers(problem)
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            back = units.restored(units.changed(numbers))
            exact = all(np.array_equal(back[name], values) for name, values in numbers.items())
        return units if exact else cls()

    def changed(self, numbers: Mapping[str, Any]) -> dict[str, Any]:
        """Return the numbers of a problem, see `problem_numbers`, in these units."""
        return {name: values / self._of[name] for name, values in numbers.items()}

    def restored(self, numbers: Mapping[str, Any]) -> dict[str, Any]:
        """Return numbers in these units in mm and N."""
        return {name: values * self._of[name] for name, values in numbers.items()}

    @property
    def _of(self) -> dict[str, float]:
        return {
            "separation": self.gap,
            "lever_arm": self.lever_arm,
            "torque": self.lever_arm * self.force,
            "compliance": self.compliance,
            "compliance_diagonal": self.compliance,
            "compliance_factor": math.sqrt(self.compliance),
        }


SECTIONS = ("NAME", "OBJSENSE", "ROWS", "COLUMNS", "RHS", "RANGES", "BOUNDS", "QUADOBJ", "QSECTION", "QMATRIX")
#: Fields of a line by section, without a name of the set that may stand first.
ROW_TYPES = ("N", "E", "L", "G")
#: Bounds without a value, and those with one.
FREE_BOUNDS, VALUE_BOUNDS = ("FR", "MI", "PL"), ("LO", "UP", "FX")


@dataclass
class QpsProgramme:
    """Quadratic programme of a QPS file by names, with bounds where they are not 0 and infinity."""

    name: str = ""
    comments: list[str] = field(default_factory=list)
    objective: str = ""
    row_types: dict[str, str] = field(default_factory=dict)  # E, L or G by row, without the objective
    linear: dict[str, float] = field(default_factory=dict)  # by column, as in the file; zero if not given
    entries: dict[str, dict[str, float]] = field(default_factory=dict)
    right: dict[str, float] = field(default_factory=dict)  # by row; that of the objective is minus its constant
    lower: dict[str, float] = field(default_factory=dict)
    upper: dict[str, float] = field(default_factory=dict)
    quadratic: dict[tuple[str, str], float] = field(default_factory=dict)  # by column pair, in the order of the file


def qps_programme(lines: Iterable[str]) -> QpsProgramme:
    """Programme of the lines of a QPS file; refuses maximisation, ranges and integers."""
    programme, section = QpsProgramme(), ""
    for number, line in enumerate(lines, start=1):
        if line.startswith("*"):
            programme.comments.append(line[1:].strip())
            continue
        words = line.split()
        if not words:
            continue
        if not line[0].isspace():
            section = words[0].upper()
            if section == "ENDATA":
                return programme
            if section not in SECTIONS:
                raise InputError(f"line {number} = {shown(line)}: must be one of the sections {', '.join(SECTIONS)}")
            if section == "NAME":
                programme.name = " ".join(words[1:])
            if section != "OBJSENSE":
                continue
            words = words[1:]
        try:
            _take(programme, section, words)
        except InputError as error:
            raise InputError(f"line {number}: {error}") from error
        except (ValueError, KeyError, IndexError) as error:
            said = shown(" ".join(words))
            raise InputError(f"line {number} = {said}: must be a line of the section {section}") from error
    raise InputError("ends without ENDATA: must be a whole file, this one seems cut off")


def _take(programme: QpsProgramme, section: str, words: list[str]) -> None:
    """Add a line of a section to a programme."""
    if section == "OBJSENSE":
        if words and words[0].upper() not in ("MIN", "MINIMIZE", "MINIMISE"):
            raise InputError(f"OBJSENSE = {shown(words[0])}: must be MIN")
    elif section == "RANGES":
        raise InputError("RANGES: must be left out, a row is an equality or an inequality")
    elif section == "RHS":
        for row, value in _pairs(words[len(words) % 2 :]):
            programme.right[_known(row, {programme.objective, *programme.row_types})] = value
    elif section in ("QUADOBJ", "QSECTION", "QMATRIX"):
        _add_quadratic(programme, words, both=section == "QMATRIX")
    else:
        {"ROWS": _add_row, "COLUMNS": _add_column, "BOUNDS": _add_bound}[section](programme, words)


def _add_row(programme: QpsProgramme, words: list[str]) -> None:
    kind, name = words
    if kind.upper() not in ROW_TYPES or name in programme.row_types:
        raise ValueError(name)
    if kind.upper() != "N":
        programme.row_types[name] = kind.upper()
    elif not programme.objective:
        programme.objective = name


def _add_column(programme: QpsProgramme, words: list[str]) -> None:
    column = words[0]
    if "'MARKER'" in words:
        raise InputError("MARKER: must be left out, all columns are real numbers")
    programme.linear.setdefault(column, 0.0)
    for row, value in _pairs(words[1:]):
        if row == programme.objective:
            programme.linear[column] = value
        elif row in programme.row_types:
            programme.entries.setdefault(row, {})[column] = value


def _add_bound(programme: QpsProgramme, words: list[str]) -> None:
    kind = words[0].upper()
    if kind in FREE_BOUNDS:
        column = _known(words[-1], programme.linear) if len(words) < 4 else _known(words[2], programme.linear)
        if kind != "PL":
            programme.lower[column] = -math.inf
        if kind != "MI":
            programme.upper[column] = math.inf
        return
    if kind not in VALUE_BOUNDS:
        raise InputError(f"bound = {shown(kind)}: must be one of {', '.join((*FREE_BOUNDS, *VALUE_BOUNDS))}")
    column, value = _known(words[-2], programme.linear), _number(words[-1])
    if kind != "UP":
        programme.lower[column] = value
    if kind != "LO":
        programme.upper[column] = value


def _add_quadratic(programme: QpsProgramme, words: list[str], both: bool) -> None:
    first, known = _known(words[0], programme.linear), programme.linear
    for second, value in _pairs(words[1:]):
        pair, mirrored = (first, _known(second, known)), (second, first)
        if both and programme.quadratic.get(mirrored, value) != value:
            raise InputError(f"entry of {first} and {second}: must be that of {second} and {first}")
        if pair in programme.quadratic or (not both and mirrored in programme.quadratic):
            raise InputError(f"entry of {first} and {second}: must come once")
        if not (both and mirrored in programme.quadratic):
            programme.quadratic[pair] = value


def _pairs(words: list[str]) -> Iterator[tuple[str, float]]:
    """Names and numbers in turn."""
    if not words or len(words) % 2:
        raise ValueError(words)
    for name, value in zip(words[::2], words[1::2], strict=True):
        yield name, _number(value)


def _number(word: str) -> float:
    """A number as C or Fortran writes it."""
    value = float(word.upper().replace("D", "E"))
    if math.isnan(value):
        raise ValueError(word)
    return value


def _known(name: str, names: Iterable[str]) -> str:
    if name not in names:
        raise InputError(f"{shown(name)}: must be declared before")
    return name


#: Forms in which a problem can be written; ``auto`` is the lifted one where the compliance is structured.
QPS_FORMS = ("auto", "dense", "lifted")
UNIT = "easeoff unit of "


def write_qps(
    problem: ContactProblem, path: str | os.PathLike[str], *, form: str = "auto", name: str = "contact"
) -> None:
    """Write a contact problem as a QPS file, complete or not at all.

    The form ``dense`` has the matrix C; ``lifted`` is sparse, for a structured compliance, and ``auto`` takes it there.
    Blanks in the name become underscores.
    """
    one_of("form", form, QPS_FORMS)
    if form == "lifted" and not problem.is_structured:
        raise InputError("form = 'lifted': must be dense for a single dense matrix; the lifted form needs (d, V)")
    with whole_file(path) as temporary, temporary.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(_lines(problem, form, name))


def read_qps(path: str | os.PathLike[str]) -> ContactProblem:
    """Contact problem from a QPS file; one matrix after the dense form of a structured compliance.

    Other programs: columns not negative, one equality, no rows but those of the lifted form; numbers taken as mm and N.
    """
    require_file(path, unpacked_size_limit())
    try:
        with faults_in_words(path, "a QPS file"), open(path, encoding="utf-8") as file:
            programme = qps_programme(file)
        return problem_of_numbers(_units(programme).restored(_contact_data(programme)))
    except InputError as error:
        raise InputError(str(error) if str(path) in str(error) else f"{path}: {error}") from error


def _lines(problem: ContactProblem, form: str, name: str) -> Iterator[str]:
    units = ProblemUnits.of(problem)
    numbers, size = units.changed(problem_numbers(problem)), problem.size
    lifted = problem.is_structured and form != "dense"
    separation, arm, torque = numbers["separation"], numbers["lever_arm"], numbers["torque"]
    yield "* Contact problem: minimise 1/2 F'C F + S'F subject to r'F = T, F >= 0. Written by easeoff.\n"
    yield "* Columns: F1.. forces; Z1.. amplitudes z = V'F, if C = diag(d) + V V'.\n"
    yield f"*{UNIT}force [N] = {units.force!r}\n"
    yield f"*{UNIT}compliance [mm/N] = {units.compliance!r}\n"
    yield f"*{UNIT}lever_arm [mm] = {units.lever_arm!r}\n"
    yield f"* In N: F times {units.force!r}. Rotation in rad: the dual of BALANCE, the derivative of the minimum with\n"
    yield f"* respect to T, times {units.rotation!r}.\n"
    yield f"* Problem: {_word(name)}\n"
    yield f"NAME {_word(name)}\nROWS\n N ENERGY\n E BALANCE\n"
    factor = numbers["compliance_factor"] if lifted else np.zeros((size, 0))
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
    if lifted:
        diagonal = numbers["compliance_diagonal"]
        yield from (f" F{i + 1} F{i + 1} {float(diagonal[i])!r}\n" for i in np.flatnonzero(diagonal))
        yield from (f" Z{k + 1} Z{k + 1} 1.0\n" for k in range(modes))
    else:
        compliance = problem.dense_compliance / units.compliance
        for j in range(size):
            below = j + np.flatnonzero(compliance[j:, j])
            yield from (f" F{j + 1} F{i + 1} {float(compliance[i, j])!r}\n" for i in below)
    yield "ENDATA\n"


def _contact_data(programme: QpsProgramme) -> dict[str, Any]:
    """Numbers of the contact problem by name, in the units of the file."""
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
    rigid = {"separation": separation, "lever_arm": arm, "torque": programme.right.get(balance, 0.0)}
    return rigid | (_structured(programme, force, amplitude, rows) if free else _dense(programme, force))


def _dense(programme: QpsProgramme, force: dict[str, int]) -> dict[str, Array]:
    matrix = np.zeros((len(force), len(force)))
    for (a, b), value in programme.quadratic.items():
        matrix[force[a], force[b]] = matrix[force[b], force[a]] = value
    return {"compliance": matrix}


def _structured(
    programme: QpsProgramme, force: dict[str, int], amplitude: dict[str, int], rows: dict[str, dict[str, float]]
) -> dict[str, Array]:
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
        columns = [c for c in entries if c in amplitude]
        constants = [programme.right.get(row, 0.0), *(programme.linear[c] for c in columns)]
        if len(columns) != 1 or columns[0] in seen or any(constants):
            raise InputError(f"row {row}: must define one free column, V'F - z = 0")
        seen.add(columns[0])
        mode = amplitude[columns[0]]
        if not weight[mode] > 0.0:
            raise InputError(f"QUADOBJ, entry of {columns[0]} = {weight[mode]:g}: must be positive")
        scale = -math.sqrt(weight[mode]) / entries[columns[0]]
        for column, value in entries.items():
            if column in force:
                factor[force[column], mode] = scale * value
    return {"compliance_diagonal": diagonal, "compliance_factor": factor}


def _units(programme: QpsProgramme) -> ProblemUnits:
    """Units that the comments of a file name; mm and N without them."""
    units: dict[str, float] = {}
    for comment in programme.comments:
        if comment.startswith(UNIT):
            name, _, value = comment.removeprefix(UNIT).partition("=")
            try:
                number = float(value)
            except ValueError:
                number = math.nan
            if not 0.0 < number < math.inf:
                raise InputError(f"{UNIT}{name.strip()} = {shown(value.strip())}: must be a positive number")
            units[name.split()[0] if name.split() else ""] = number
    return ProblemUnits(units.get("force", 1.0), units.get("compliance", 1.0), units.get("lever_arm", 1.0))


def _word(name: str) -> str:
    """A name without blanks, in ASCII."""
    return "_".join(name.encode("ascii", "replace").decode().split()) or "contact"
