"""Base classes of the tables of case and design files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr


class Table(BaseModel):
    """A table of a case file: frozen, no unknown keys, no NaN, no text or truth value for a number."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)


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


def number(description: str, unit: str, **limits: Any) -> Any:
    """A key that holds a number: its meaning, its unit and its limits."""
    return Field(description=f"{description} [{unit}]", json_schema_extra={"unit": unit}, **limits)


# A whole number of TOML is a number too; true, false and text are none.
Number = float
Integer = int
