"""Misalignment in a case file: assembly errors, and a table of deflections over the torque."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from ...core.errors import InputError
from ...geometry.pair.assembly import Misalignment
from ..deflections import ERRORS, SYMBOLS, Deflections
from .schema_table import Number, Table, number
from .usual_torques import TORQUE_LIMIT

DEFLECTION_ROW_COUNT_LIMIT = 1000


class DeflectionRow(Table):
    """A row of a table of deflections. A key must be in all rows or in none, where it counts as zero.

    Examples
    --------
    >>> DeflectionRow(torque=250.0, E=0.05).P is None
    True
    """

    torque: Number = number("at the pinion, rising", "N m", ge=0, lt=TORQUE_LIMIT)
    E: Number | None = number("increase of the offset", "mm", default=None, gt=-10, lt=10)
    P: Number | None = number("pinion away from the crossing point", "mm", default=None, gt=-10, lt=10)
    G: Number | None = number("gear away from the crossing point", "mm", default=None, gt=-10, lt=10)
    Sigma: Number | None = number("increase of the shaft angle", "deg", default=None, gt=-5, lt=5)
    flank: Literal["drive", "coast"] | None = Field(default=None, description="in mesh; both if left out")


def _rows(value: Any) -> Any:
    if isinstance(value, dict):
        raise ValueError("a row of deflections is a table [[misalignment.deflections]], with two brackets")
    return value


DeflectionRows = Annotated[
    tuple[DeflectionRow, ...], BeforeValidator(_rows), Field(strict=False, max_length=DEFLECTION_ROW_COUNT_LIMIT)
]


class MisalignmentTable(Table):
    """Assembly errors; with deflections those are added to them."""

    offset: Number = number("E: increase of the offset", "mm", default=0.0, gt=-10, lt=10)
    pinion_axial: Number = number("P: pinion away from the crossing point", "mm", default=0.0, gt=-10, lt=10)
    gear_axial: Number = number("G: gear away from the crossing point", "mm", default=0.0, gt=-10, lt=10)
    shaft_angle: Number = number("Sigma: increase of the shaft angle", "deg", default=0.0, gt=-5, lt=5)
    deflections: DeflectionRows = ()

    @model_validator(mode="after")
    def _has_a_curve(self) -> Self:
        if self.deflections:
            deflections_of(self.deflections)
        return self


def deflections_of(rows: Sequence[DeflectionRow], constant: Misalignment | None = None) -> Deflections:
    """Deflections from rows of a table, in rad.

    Parameters
    ----------
    rows
        One or more, of each flank in the order of their torques.
    constant
        Added at every torque; none if left out.

    Raises
    ------
    ValueError
        If a key is in some rows and not in others, or torques do not rise.

    Examples
    --------
    >>> deflections_of([DeflectionRow(torque=0.0, Sigma=0.0), DeflectionRow(torque=300.0, Sigma=180.0 / 100)]).at(300.0)
    Misalignment(offset=0.0, pinion_axial=0.0, gear_axial=0.0, shaft_angle=0.031415926535897934)
    """
    columns: dict[str, list[Any]] = {}
    for symbol in (*SYMBOLS, "flank"):
        values = [getattr(row, symbol) for row in rows]
        without = [row.torque for row, value in zip(rows, values, strict=True) if value is None]
        if 0 < len(without) < len(rows):
            raise ValueError(
                f"{symbol} is in some rows of the deflections and not in that of torque = {without[0]:g}: give it in "
                "every row, or in none"
            )
        columns[symbol] = [] if without else values
    columns["Sigma"] = [math.radians(value) for value in columns["Sigma"]]
    own = {error: columns[symbol] for error, symbol in zip(ERRORS, SYMBOLS, strict=True)}
    try:
        torques = [row.torque for row in rows]
        return Deflections(torques, **own, flank=columns["flank"], constant=constant or Misalignment())
    except InputError as error:
        raise ValueError(str(error)) from error
