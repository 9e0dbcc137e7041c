"""The symbols of ISO 23509 and the fields that hold them, for people who know the standard.

Symbols are written in plain letters: ``beta_m2`` is the mean spiral angle of the gear, ``tzF1`` the distance of the
pinion's face apex beyond the crossing point. In :data:`ISO_SYMBOLS` a field of a member is written ``pinion.face_apex``
or ``gear.face_apex``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, get_type_hints

from easeoff import InputError
from easeoff.geometry import BlankDesign, BlankDimensions
from easeoff.geometry.design.iso23509.blank_dimensions import MemberBlank


def _symbols(owner: type) -> dict[str, str]:
    """Symbol -> field of a class whose fields are annotated with their symbols."""
    hints = get_type_hints(owner, include_extras=True).items()
    return {symbol: field for field, hint in hints for symbol in getattr(hint, "__metadata__", ())}


ISO_SYMBOLS: dict[str, str] = {
    **{f"{symbol}1": f"pinion.{field}" for symbol, field in _symbols(MemberBlank).items()},
    **{f"{symbol}2": f"gear.{field}" for symbol, field in _symbols(MemberBlank).items()},
    **_symbols(BlankDimensions),
}
"""Symbol of a result -> field of :class:`BlankDimensions`."""

ISO_INPUT_SYMBOLS = _symbols(BlankDesign)
"""Symbol of a basic datum -> field of :class:`BlankDesign`; ``z1`` and ``z2`` together are ``number_of_teeth``."""

_GREEK_ANGLES = ("Sigma", "delta", "theta", "beta", "zeta", "alpha", "lambda", "nu")


def is_angle(symbol: str) -> bool:
    """True if a symbol stands for an angle."""
    return symbol.startswith(_GREEK_ANGLES)


def dimensions_by_symbol(dimensions: BlankDimensions, *, degrees: bool = False) -> dict[str, float]:
    """Value of every symbol of ``ISO_SYMBOLS`` [mm, rad or degrees]."""
    values: dict[str, float] = {}
    for symbol, path in ISO_SYMBOLS.items():
        owner, _, field = path.rpartition(".")
        value = float(getattr(getattr(dimensions, owner) if owner else dimensions, field))
        values[symbol] = math.degrees(value) if degrees and is_angle(symbol) else value
    return values


def blank_design_from_symbols(values: Mapping[str, Any], *, degrees: bool = False) -> BlankDesign:
    """Basic data from ``z1``, ``z2``, ``ISO_INPUT_SYMBOLS`` [mm, rad or degrees], fields of ``BlankDesign``."""
    fields: dict[str, Any] = {}
    if "z1" not in values or "z2" not in values:
        raise InputError("z1, z2: both numbers of teeth are needed")
    unwanted = "beta_m2" if values.get("method") == 1 else "beta_m1"
    if unwanted in values:
        raise InputError(f"{unwanted}: method {values.get('method')} takes the other member's mean spiral angle")
    for name, value in values.items():
        if name in ("z1", "z2"):
            continue
        field = ISO_INPUT_SYMBOLS.get(name, name)
        if field not in BlankDesign.__dataclass_fields__:
            raise InputError(f"{name}: no such basic datum; known are {', '.join(ISO_INPUT_SYMBOLS)}")
        angle = degrees and (is_angle(name) or (field == name and name.endswith("_angle")))
        fields[field] = math.radians(value) if angle and isinstance(value, (int, float)) else value
    try:
        return BlankDesign(number_of_teeth=(values["z1"], values["z2"]), **fields)
    except TypeError as error:  # a required field is missing
        raise InputError(str(error).replace("BlankDesign.__init__() ", "basic data: ")) from None
