"""Sections of a QPS file, the format of the Maros-Meszaros test problems: a quadratic programme as text.

    minimise 1/2 x'Q x + c'x - k   subject to rows of type E, L or G and bounds on x

Sections are ``NAME``, ``ROWS``, ``COLUMNS``, ``RHS``, ``BOUNDS`` and ``QUADOBJ``, which holds the lower triangle of Q
with its diagonal: no entry is halved or doubled. The right side of the objective's row is k, *minus* the constant of
the objective. A column without a bound is not negative. There is no ``OBJSENSE`` in the test problems; a file that has
one must say ``MIN``. ``QMATRIX`` (all of Q) and ``QSECTION`` (as ``QUADOBJ``) are read as well.

Fields are separated by blanks, which is the free format. The fixed format has the same fields in fixed columns of at
most 12 characters, too few for a double; it reads as the free one unless names have blanks.

I. Maros, C. Meszaros, A repository of convex quadratic programming problems, Optimization Methods and Software 11
(1999) 671-681, doi 10.1080/10556789908805768.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from ....core.checks import shown
from ....core.errors import InputError

SECTIONS = ("NAME", "OBJSENSE", "ROWS", "COLUMNS", "RHS", "RANGES", "BOUNDS", "QUADOBJ", "QSECTION", "QMATRIX")
#: Fields of a line by section, without a name of the set that may stand first.
ROW_TYPES = ("N", "E", "L", "G")
#: Bounds without a value, and those with one.
FREE_BOUNDS, VALUE_BOUNDS = ("FR", "MI", "PL"), ("LO", "UP", "FX")


@dataclass
class QpsProgramme:
    """Quadratic programme of a QPS file, by names.

    Attributes
    ----------
    name
        Of the problem.
    comments
        Lines that begin with an asterisk, without it.
    objective
        Name of the objective's row.
    row_types
        By the name of each other row: ``E``, ``L`` or ``G``.
    linear
        Coefficients c by column, in the order of the file; zero where none is given.
    entries
        Coefficients of the other rows by row and column.
    right
        Right sides by row; that of the objective among them, minus its constant.
    lower, upper
        Bounds by column, where they are not 0 and infinity.
    quadratic
        Q by pair of columns, the first not before the second in the file.
    """

    name: str = ""
    comments: list[str] = field(default_factory=list)
    objective: str = ""
    row_types: dict[str, str] = field(default_factory=dict)
    linear: dict[str, float] = field(default_factory=dict)
    entries: dict[str, dict[str, float]] = field(default_factory=dict)
    right: dict[str, float] = field(default_factory=dict)
    lower: dict[str, float] = field(default_factory=dict)
    upper: dict[str, float] = field(default_factory=dict)
    quadratic: dict[tuple[str, str], float] = field(default_factory=dict)


def qps_programme(lines: Iterable[str]) -> QpsProgramme:
    r"""Return the programme that the lines of a QPS file describe.

    Raises
    ------
    InputError
        A line that is none of the format, a name that was not declared, a maximisation, ranges or integers.

    Examples
    --------
    >>> text = "ROWS\n N e\n E b\nCOLUMNS\n x e 1 b 2\nRHS\n b 4\nQUADOBJ\n x x 3\nENDATA"
    >>> found = qps_programme(text.splitlines())
    >>> found.linear, found.entries, found.right, found.quadratic
    ({'x': 1.0}, {'b': {'x': 2.0}}, {'b': 4.0}, {('x', 'x'): 3.0})
    """
    programme, section, both, ended = QpsProgramme(), "", False, False
    for number, line in enumerate(lines, start=1):
        if line.startswith("*"):
            programme.comments.append(line[1:].strip())
            continue
        words = line.split()
        if not words:
            continue
        if not line[0].isspace():
            section, both = words[0].upper(), words[0].upper() == "QMATRIX"
            ended = section == "ENDATA"
            if ended:
                break
            if section not in SECTIONS:
                raise InputError(f"line {number} = {shown(line)}: must be one of the sections {', '.join(SECTIONS)}")
            if section == "NAME":
                programme.name = " ".join(words[1:])
            if section != "OBJSENSE":
                continue
            words = words[1:]
        try:
            _take(programme, section, words, both)
        except InputError as error:
            raise InputError(f"line {number}: {error}") from error
        except (ValueError, KeyError, IndexError) as error:
            said = shown(" ".join(words))
            raise InputError(f"line {number} = {said}: must be a line of the section {section}") from error
    if not ended:
        raise InputError("ends without ENDATA: must be a whole file, this one seems cut off")
    return programme


def _take(programme: QpsProgramme, section: str, words: list[str], both: bool) -> None:
    """Add a line of a section to a programme."""
    if section == "OBJSENSE":
        if words and words[0].upper() not in ("MIN", "MINIMIZE", "MINIMISE"):
            raise InputError(f"OBJSENSE = {shown(words[0])}: must be MIN")
    elif section == "ROWS":
        _add_row(programme, words)
    elif section == "COLUMNS":
        _add_column(programme, words)
    elif section == "RHS":
        for row, value in _pairs(words[len(words) % 2 :]):
            programme.right[_known(row, {programme.objective, *programme.row_types})] = value
    elif section == "RANGES":
        raise InputError("RANGES: must be left out, a row is an equality or an inequality")
    elif section == "BOUNDS":
        _add_bound(programme, words)
    elif section in ("QUADOBJ", "QSECTION", "QMATRIX"):
        _add_quadratic(programme, words, both)
    else:
        raise ValueError(section)


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
