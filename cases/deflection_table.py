"""Tables of deflections as text in columns, and what else may say how a pair is misaligned."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ..core.checks import shown
from ..core.errors import InputError, suggestion
from ..core.regular_file import named
from ..geometry.pair.assembly import Misalignment
from .deflections import SYMBOLS, Deflections, with_errors
from .schema.case_schema import DEFLECTION_ROW_COUNT_LIMIT, DeflectionRow, deflections_of
from .table_rows import read_schema_rows, schema_row

ALLOWED = 'a mapping such as {"E": 0.05, "Sigma": 0.1}, a Misalignment, Deflections, or the path of a table of them'

#: Misalignment as a user may give it: constant, by letter, over the torque, or the path of a table of deflections.
MisalignmentSource = Misalignment | Deflections | Mapping[str, float] | str | Path


def read_deflections(path: str | os.PathLike[str]) -> Deflections:
    r"""Deflections of a table: a head with the names of the columns, then a row a torque.

    Columns are ``torque`` and those of ``E``, ``P``, ``G``, ``Sigma`` [mm, degrees] and ``flank`` that are needed, in
    any order. They are separated by commas, semicolons, tabs or blanks; beside commas a decimal has a point. No cell
    is empty; lines that begin with ``#`` are comments.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        If the file cannot be read as such; naming line, column, value and what is allowed.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "axle.csv")
    ...     _ = table.write_text("torque,E,P\n0,0,0\n100,0.02,-0.01\n300,0.05,-0.03\n")
    ...     read_deflections(table).at(300.0).pinion_axial
    -0.03
    """
    limit, head = DEFLECTION_ROW_COUNT_LIMIT, "torque,E,P,G,Sigma"
    rows = read_schema_rows(path, DeflectionRow, count_limit=limit, complete=True, what="row", head=head)
    try:
        return deflections_of(rows)
    except ValueError as error:
        raise InputError(f"{named(path)}: {error}") from error


def misalignment_of(source: MisalignmentSource) -> Misalignment | Deflections:
    """Misalignment from an object, a mapping of E, P, G [mm] and Sigma [degrees], or the path of a table."""
    if isinstance(source, Misalignment | Deflections):
        return source
    if isinstance(source, Mapping):
        return _constant(source)
    if isinstance(source, str) and "=" in source and not os.path.exists(source):
        raise InputError(f"misalignment = {shown(source)}: must be {ALLOWED}")
    if isinstance(source, str | os.PathLike):
        return read_deflections(source)
    raise InputError(f"misalignment: {type(source).__name__}: must be {ALLOWED}")


def misalignments_of(sources: Any) -> list[Misalignment | Deflections]:
    """Misalignments from a list of what ``misalignment_of`` takes. Raises as that."""
    if not isinstance(sources, Iterable) or isinstance(sources, str | bytes | Mapping):
        raise InputError(f"misalignments = {shown(sources)}: must be a list of misalignments")
    return [misalignment_of(one) for one in sources]


def _constant(values: Mapping[str, float]) -> Misalignment:
    """Misalignment by the letters of its parts [mm, degrees]."""
    for name in values:
        if name not in SYMBOLS:
            near = suggestion(str(name), SYMBOLS)
            raise InputError(f"misalignment: {shown(name)}: must be one of {', '.join(SYMBOLS)}{near}")
    try:
        row = schema_row(DeflectionRow, {"torque": 0.0, **values})
    except ValueError as error:
        raise InputError(f"misalignment: {error}") from error
    return with_errors(Misalignment(), row.model_dump(include=set(SYMBOLS)))
