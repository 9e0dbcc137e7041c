"""Misalignment that depends on the torque: rows of a table of deflections, and the curve through them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ..core.arrays import Array, record
from ..core.checks import array, one_of, words
from ..core.errors import InputError
from ..geometry.pair.assembly import Misalignment
from .schema.usual_torques import TORQUE_LIMIT

if TYPE_CHECKING:
    from ..geometry.pair.gear_pair import FlankName


#: Fields of ``Misalignment`` by the symbols of assembly errors.
ERROR_FIELDS = {"E": "offset", "P": "pinion_axial", "G": "gear_axial", "Sigma": "shaft_angle"}
SYMBOLS, ERRORS = tuple(ERROR_FIELDS), tuple(ERROR_FIELDS.values())
UNITS = {"offset": "mm", "pinion_axial": "mm", "gear_axial": "mm", "shaft_angle": "rad"}
#: Beyond these no row may lie, nor what is continued beyond the last [mm, rad].
ERROR_LIMITS = (10.0, 10.0, 10.0, float(np.radians(5.0)))
NONE = Misalignment()
FLANKS: tuple[FlankName, ...] = ("drive", "coast")


@record(frozen=True)
class Deflections:
    """Misalignment over the torque, as deflections of shafts, bearings and housing make it.

    Each of E, P, G and Sigma is a monotone cubic curve through the rows (PCHIP): between two rows it does not leave
    their values. Below the first row its values hold; a row at torque zero says what is there without load. Beyond the
    last row the curve goes straight on, with the slope it ends with.

    Parameters
    ----------
    torque
        At the pinion, rising from row to row (n) [N m].
    offset, pinion_axial, gear_axial
        E, P and G (n) [mm]; zero if left out.
    shaft_angle
        Sigma (n) [rad]; zero if left out.
    flank
        Flanks in mesh of each row (n) or of all, whose torques rise for themselves; both if left out.
    constant
        Added at every torque.

    Examples
    --------
    >>> deflections = Deflections([0.0, 100.0, 300.0], offset=[0.0, 0.02, 0.05])
    >>> deflections.at(100.0).offset, round(deflections.at(400.0).offset, 4)
    (0.02, 0.0617)
    """

    torque: Sequence[float] | Array
    offset: Sequence[float] | Array = ()
    pinion_axial: Sequence[float] | Array = ()
    gear_axial: Sequence[float] | Array = ()
    shaft_angle: Sequence[float] | Array = ()
    flank: FlankName | Sequence[FlankName] = ()
    constant: Misalignment = NONE

    def __post_init__(self) -> None:
        torque = array("torque", self.torque, "N m", ndim=1, fewest=1, least=0.0)
        object.__setattr__(self, "torque", tuple(torque.tolist()))
        if torque.max() >= TORQUE_LIMIT:
            raise InputError(f"torque = {torque.max():g}: must be below {TORQUE_LIMIT:g} [N m]")
        for name, limit in zip(ERRORS, ERROR_LIMITS, strict=True):
            values = array(name, getattr(self, name), UNITS[name], ndim=1)
            values = values if values.size else np.zeros(torque.size)
            if values.size != torque.size:
                raise InputError(f"{name}: has {values.size} values: must have {torque.size}, one a torque")
            if np.abs(values).max() >= limit:
                worst = values[np.argmax(np.abs(values))]
                raise InputError(f"{name} = {worst:g}: must lie between {-limit:.4g} and {limit:.4g} [{UNITS[name]}]")
            object.__setattr__(self, name, tuple(values.tolist()))
        given = (self.flank,) * torque.size if isinstance(self.flank, str) else words("flank", self.flank)
        flanks = tuple(one_of("flank", one, FLANKS) for one in given)
        if flanks and len(flanks) != torque.size:
            raise InputError(f"flank: has {len(flanks)} values: must have {torque.size}, one a torque, or none")
        object.__setattr__(self, "flank", flanks)
        for flank in self._flanks or FLANKS[:1]:
            for before, after in pairwise(self._rows(flank)[0].tolist()):
                if after <= before:
                    of_flank = f" of the {flank} flanks" if flanks else ""
                    said = "comes twice" if after == before else f"comes after {before:g}"
                    raise InputError(f"torque = {after:g}: {said}: torques{of_flank} must rise from row to row [N m]")

    def at(self, torque: float, flank: FlankName = "drive") -> Misalignment:
        """Misalignment at a torque [N m].

        Raises
        ------
        InputError
            If there are rows of the other flanks alone, or the curve goes out of the range of a misalignment.
        """
        rows, values = self._rows(flank)
        known = np.flatnonzero(rows == torque)
        if known.size:
            deflection = values[known[0]]
        elif torque <= rows[0] or rows.size == 1:
            deflection = values[0]
        elif torque < rows[-1]:
            deflection = self._curves[flank](torque)
        else:
            deflection = values[-1] + (torque - rows[-1]) * self._curves[flank](rows[-1], 1)
        whole = deflection + np.array([getattr(self.constant, name) for name in ERRORS])
        for symbol, value, limit in zip(SYMBOLS, whole, ERROR_LIMITS, strict=True):
            if abs(value) >= limit:
                units, shown = ("deg", np.degrees([value, limit])) if symbol == "Sigma" else ("mm", (value, limit))
                raise InputError(
                    f"torque = {torque:g}: {symbol} = {shown[0]:.4g} there: must lie between {-shown[1]:g} and "
                    f"{shown[1]:g} [{units}]; the table of deflections ends at {rows[-1]:g} N m"
                )
        return Misalignment(*whole.tolist())

    def torque_range(self, flank: FlankName = "drive") -> tuple[float, float]:
        """First and last torque of the rows [N m].

        Raises
        ------
        InputError
            If there are rows of the other flanks alone.
        """
        rows, _ = self._rows(flank)
        return float(rows[0]), float(rows[-1])

    def with_constant(self, constant: Misalignment) -> Deflections:
        """The same rows, with this added at every torque in place of what was."""
        return replace(self, constant=constant)

    @property
    def _flanks(self) -> tuple[FlankName, ...]:
        """Flanks that have rows of their own; none if the rows are of both."""
        return tuple(flank for flank in FLANKS if flank in self.flank)

    def _rows(self, flank: FlankName) -> tuple[Array, Array]:
        """Torques (n) and values (n, 4) of the rows of a flank."""
        mask = np.array([one == flank for one in self.flank] if self._flanks else [True] * len(self.torque))
        if not mask.any():
            raise InputError(
                f"misalignment: the table of deflections has rows of the {self._flanks[0]} flanks alone: give rows of "
                f"the {flank} flanks, too"
            )
        return np.array(self.torque)[mask], np.array([getattr(self, name) for name in ERRORS]).T[mask]

    @cached_property
    def _curves(self) -> dict[FlankName, Any]:
        """Curves through the rows of every flank that has two or more."""
        from scipy.interpolate import PchipInterpolator

        tables = {flank: self._rows(flank) for flank in self._flanks or FLANKS}
        return {flank: PchipInterpolator(*rows) for flank, rows in tables.items() if rows[0].size > 1}


def with_errors(misalignment: Misalignment, errors: Mapping[str, float | None]) -> Misalignment:
    """A misalignment with other errors by symbol [mm, degree]; ``None`` leaves one as it is."""
    given = {ERROR_FIELDS[symbol]: value for symbol, value in errors.items() if value is not None}
    if "shaft_angle" in given:
        given["shaft_angle"] = math.radians(given["shaft_angle"])
    return replace(misalignment, **given)


def assembly_columns(assemblies: Sequence[Misalignment]) -> dict[str, tuple[str, list[float]]]:
    """Errors of assemblies as variables of a dataset over ``assembly``."""
    return {f"{error}_error": ("assembly", [getattr(one, error) for one in assemblies]) for error in ERRORS}


def misalignment_at(given: Misalignment | Deflections, torque: float, flank: FlankName) -> Misalignment:
    """A constant misalignment, or that of deflections at a torque [N m]."""
    return given if isinstance(given, Misalignment) else given.at(torque, flank)
