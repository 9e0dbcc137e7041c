"""Quantities that a sweep can vary: their names, units and meanings, and what has to be computed anew for each."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any, get_args

from ...cases.deflections import ERROR_FIELDS
from ...cases.writing import numeric_keys, require_numeric_key
from ...core.checks import number, one_of, shown
from ...core.errors import InputError, suggestion
from ...geometry.pair.gear_pair import FlankName
from ...geometry.pair.modification import TERM_POWERS


class Stage(IntEnum):
    """First stage to compute anew where a quantity changes; the lower, the more is computed."""

    PAIR = 0
    ASSEMBLY = 1
    EASE_OFF = 2
    LOAD = 3
    FRICTION = 4
    NOTHING = 5


@dataclass(frozen=True)
class SweptQuantity:
    """A quantity that a sweep can vary."""

    name: str
    units: str
    long_name: str
    stage: Stage
    words: bool = False  # True if values are words, such as files, and not numbers

    def checked(self, value: Any) -> float | str:
        """A possible value of the quantity, or else InputError."""
        if self.words:
            if not isinstance(value, str) or not value:
                raise InputError(f"{self.name} = {shown(value)}: must be a word")
            return one_of("flank", value, get_args(FlankName)) if self.name == "flank" else value
        limit = ERROR_LIMITS.get(self.name)
        return number(self.name, value, self.units, above=None if limit is None else -limit, below=limit)


ASSEMBLY = {
    "E": ("mm", "assembly error E: increase of the offset"),
    "P": ("mm", "assembly error P: pinion away from the crossing point"),
    "G": ("mm", "assembly error G: gear away from the crossing point"),
    "Sigma": ("degree", "assembly error Sigma: increase of the shaft angle"),
}
ERROR_LIMITS = {"E": 10.0, "P": 10.0, "G": 10.0, "Sigma": 5.0}  # as in the case file
CONDITIONS = ("speed", "temperature", "roughness")
_NAMED = {
    **{name: SweptQuantity(name, *words, Stage.ASSEMBLY) for name, words in ASSEMBLY.items()},
    "torque": SweptQuantity("torque", "N m", "torque at the pinion", Stage.LOAD),
    "speed": SweptQuantity("speed", "1/min", "rotational speed of the pinion", Stage.FRICTION),
    "temperature": SweptQuantity(
        "temperature", "degC", "temperature of the oil at the inlet of the contact", Stage.FRICTION
    ),
    "roughness": SweptQuantity("roughness", "um", "RMS roughness Rq of the flanks", Stage.FRICTION),
    "oil": SweptQuantity("oil", "", "lubricant", Stage.FRICTION, words=True),
    "flank": SweptQuantity("flank", "", "flanks in mesh", Stage.PAIR, words=True),
    "deviation.pinion": SweptQuantity("deviation.pinion", "", "deviation of the pinion flank", Stage.PAIR, words=True),
    "deviation.gear": SweptQuantity("deviation.gear", "", "deviation of the gear flank", Stage.PAIR, words=True),
    **{
        f"modification.{term}": SweptQuantity(
            f"modification.{term}", "um", f"modification of the ease-off: {term.replace('_', ' ')}", Stage.EASE_OFF
        )
        for term in TERM_POWERS
    },
}
#: Columns of load cases that say something of them and change nothing.
REMARKS = {
    "share": SweptQuantity("share", "1", "share of the time at the load case", Stage.NOTHING),
    "name": SweptQuantity("name", "", "name of the load case", Stage.NOTHING, words=True),
}
#: Keys of the case that are swept under another name.
ALIASES = {
    **{f"misalignment.{key}": name for name, key in ERROR_FIELDS.items()},
    "contact.torques": "torque",
    **{f"friction.{name}": name for name in (*CONDITIONS, "oil")},
}


def swept_quantity(name: str) -> SweptQuantity:
    """A quantity that a sweep can vary, by its name or the dotted key of a number in the case file."""
    if name in _NAMED or name in REMARKS:
        return _NAMED.get(name) or REMARKS[name]
    if name in ALIASES:
        raise InputError(f"{name}: is swept as {ALIASES[name]}")
    if name not in numeric_keys():
        known = [*_NAMED, *numeric_keys()]
        plain = ", ".join(one for one in _NAMED if "." not in one)
        raise InputError(
            f"{name}: must be one of {plain}, deviation.MEMBER, modification.TERM, or the dotted key of a number of "
            f"the case file{suggestion(name, known)}"
        )
    units, long_name = require_numeric_key(name)
    return SweptQuantity(name, {"deg": "degree"}.get(units, units), long_name, Stage.PAIR)
