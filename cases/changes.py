"""A case with some of its numbers changed, by their dotted keys, and checked again."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import UnionType
from typing import Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from ..core.errors import EaseoffError, InputError
from ..core.suggestion import suggestion
from .conversion import designed_blanks
from .mistakes import count, mistakes
from .schema.case_schema import Case
from .schema.usual_names import usual_name


def numeric_keys() -> dict[str, tuple[str, str]]:
    """Unit and usual name of every number of a case file by its dotted key.

    Examples
    --------
    >>> numeric_keys()["pinion.concave.machine.radial_distance"]
    ('mm', 'radial setting')
    """
    return dict(_every_key())


@cache
def _every_key() -> list[tuple[str, tuple[str, str]]]:
    return _keys(Case, "")


def _keys(table: type[BaseModel], prefix: str) -> list[tuple[str, tuple[str, str]]]:
    found: list[tuple[str, tuple[str, str]]] = []
    for name, field in table.model_fields.items():
        inner = _table(field)
        if inner is not None:
            found += _keys(inner, f"{prefix}{name}.")
        elif _is_number(field):
            extra = field.json_schema_extra
            unit = str(extra["unit"]) if isinstance(extra, dict) else "1"
            found.append((f"{prefix}{name}", (unit, usual_name(name))))
    return found


def _kinds(field: FieldInfo) -> tuple[Any, ...]:
    """The types that a field may have."""
    united = get_origin(field.annotation) in (Union, UnionType)
    return get_args(field.annotation) if united else (field.annotation,)


def _table(field: FieldInfo) -> type[BaseModel] | None:
    return next((kind for kind in _kinds(field) if isinstance(kind, type) and issubclass(kind, BaseModel)), None)


def _is_number(field: FieldInfo) -> bool:
    return any(kind in (int, float) for kind in _kinds(field)) and str not in _kinds(field)


def require_numeric_key(key: str) -> tuple[str, str]:
    """Unit and usual name of a number of a case file.

    Raises
    ------
    InputError
        If there is no number of that key; names the nearest.

    Examples
    --------
    >>> require_numeric_key("gear.blank.face_width")[0]
    'mm'
    """
    keys = numeric_keys()
    if key not in keys:
        raise InputError(f"{key}: must be a number of the case file by its dotted key{suggestion(key, list(keys))}")
    return keys[key]


def changed_case(case: Case, numbers: Mapping[str, float]) -> Case:
    """A case with other numbers.

    Parameters
    ----------
    case
        A checked case.
    numbers
        New values by dotted key, in the units of the case file.

    Raises
    ------
    InputError
        If there is no such key, the case lacks its table, or a value is not possible.
    GeometryError
        If no blanks follow from changed basic data.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> changed_case(read_case("nasa-12x36"), {"gear.blank.face_width": 25.0}).gear.blank.face_width
    25.0
    """
    data = case.model_dump(exclude_unset=True)
    for key, value in numbers.items():
        require_numeric_key(key)
        *tables, name = key.split(".")
        inner: Any = data
        for depth, table in enumerate(tables, start=1):
            if inner.get(table) is None:
                if depth < len(tables) or table in ("blank", "blank_design", "machine", "cutter"):
                    raise InputError(f"{key}: the case has no table [{'.'.join(tables[:depth])}]")
                inner[table] = {}
            inner = inner[table]
        inner[name] = int(value) if float(value).is_integer() and _wants_whole(key) else float(value)
    friction = case.friction
    context = None if friction is None else {"folder": friction._folder, "allow_outside": friction._allow_outside}
    try:
        found = Case.model_validate(data, context=context)
    except ValidationError as error:
        raise InputError(f"the changed case has {count(error)}:\n{mistakes(Case, error)}") from error
    if found.blank_design is not None:
        try:
            designed_blanks(found.blank_design, (found.pinion.number_of_teeth, found.gear.number_of_teeth), found.pair)
        except EaseoffError as error:
            raise type(error)(f"the changed case: {error}") from error
    return found


def _wants_whole(key: str) -> bool:
    table: type[BaseModel] = Case
    *tables, name = key.split(".")
    for one in tables:
        inner = _table(table.model_fields[one])
        assert inner is not None  # ``require_numeric_key`` found it
        table = inner
    return int in _kinds(table.model_fields[name])
