"""What every table of a case or design file is made of."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field


class Table(BaseModel):
    """A table of a case file: frozen, no unknown keys, no NaN."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)


def number(description: str, unit: str, **limits: Any) -> Any:
    """A key that holds a number: its meaning, its unit and its limits."""
    return Field(description=f"{description} [{unit}]", json_schema_extra={"unit": unit}, **limits)


Number = Annotated[float, Field(strict=False)]
Integer = Annotated[int, Field(strict=True)]
