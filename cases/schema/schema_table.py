"""Base classes of the tables of case and design files."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Self, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, model_validator
from pydantic.fields import FieldInfo

from ...core.errors import InputError
from ..mistakes import refusal

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:  # it has no public name
    ModelMetaclass = type(BaseModel)


class _Checked(ModelMetaclass):
    """Class of tables: values that one built in Python cannot have are an ``InputError``, as those of a file."""

    if not TYPE_CHECKING:  # which knows the keys of a table by pydantic's own

        def __call__(cls, *values: Any, **named: Any) -> Any:  # noqa: N805  # of a class of classes
            """A table of keys by name."""
            if values:
                raise InputError(f"{cls.__name__}: values must be given by name, as in {cls.__name__}(key=...)")
            try:
                return super().__call__(**named)
            except ValidationError as error:
                raise refusal(cls.__name__, cls, error) from error


class Table(BaseModel, metaclass=_Checked):
    """A table of a case file: frozen, no unknown keys, no NaN, no text or truth value for a number.

    A whole number of TOML is a number, too.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True, defer_build=True)

    @model_validator(mode="after")
    def _checked(self) -> Self:
        self._check()
        return self

    def _check(self) -> None:
        """Refuse values that do not go together by a ``ValueError``."""

    def with_tables(self, **tables: Mapping[str, Any]) -> Self:
        """A copy with other values, unchecked, for some keys of the tables in it."""
        changed = {name: getattr(self, name).model_copy(update=values) for name, values in tables.items()}
        return self.model_copy(update=changed)


#: Keys that every file has.
Title = Annotated[str, Field(min_length=1, max_length=200, description="one line for lists and plots")]
Description = Annotated[str, Field(description="where the numbers come from")]


class InputFile(Table):
    """A whole case or design file."""

    _text: str = PrivateAttr(default="")
    _name: str = PrivateAttr(default="")

    @property
    def text(self) -> str:
        """The file as it was read; empty if it was built or changed in Python."""
        return self._text

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy, with other values for some keys; the text of the file is then no longer its own."""
        copy = super().model_copy(update=update, deep=deep)
        if update:
            copy._text = ""
        return copy

    @property
    def name(self) -> str:
        """Name of the shipped file, or of the user's file without its suffix; empty if it was built in Python."""
        return self._name


def key(description: str, *, allowed: str = "", unit: str = "", **options: Any) -> Any:
    """A key: its meaning, and what it allows where neither its type nor its limits say so."""
    extra: Any = {name: text for name, text in (("allowed", allowed), ("unit", unit)) if text}
    return Field(description=description, json_schema_extra=extra, **options)


def number(description: str, unit: str, **options: Any) -> Any:
    """A key that holds numbers: its meaning, its unit and its limits."""
    return key(f"{description} [{unit}]", unit=unit, **options)


def optional(description: str, unit: str, **options: Any) -> Any:
    """A number that may be left out, and is ``None`` then."""
    return number(description, unit, default=None, **options)


def extra_of(field: FieldInfo, name: str) -> str:
    """Text that ``key`` was given as ``allowed`` or ``unit``; empty if none."""
    extra = field.json_schema_extra
    return str(extra.get(name, "")) if isinstance(extra, dict) else ""


def kinds(annotation: Any, *, listed: bool = False) -> tuple[Any, ...]:
    """Types that a value of a key may have, or if ``listed`` an entry of its list."""
    several = (Union, UnionType, tuple) if listed else (Union, UnionType)
    return get_args(annotation) if get_origin(annotation) in several else (annotation,)


def inner_table(annotation: Any, *, listed: bool = False) -> type[BaseModel] | None:
    """The table that a key opens, or if ``listed`` a list of them, too; ``None`` if it holds a value."""
    options = kinds(annotation, listed=listed)
    return next((kind for kind in options if isinstance(kind, type) and issubclass(kind, BaseModel)), None)


@cache
def angle_keys(table: type[Table]) -> frozenset[str]:
    """Keys of a table that hold degrees."""
    return frozenset(name for name, field in table.model_fields.items() if extra_of(field, "unit") == "deg")


def in_radians(table: Table) -> dict[str, Any]:
    """Values of a table by key, those in degrees in rad."""
    angles = angle_keys(type(table))
    return {name: math.radians(value) if name in angles and value is not None else value for name, value in table}
