"""Load cases: torque, misalignment, speed and share of time, a row each, in a case file or a table of their own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, field_validator
from pydantic_core import PydanticCustomError

from ..mistakes import written
from .schema_table import Table, key, number, optional
from .usual_torques import TORQUE_LIMIT, TORQUE_MINIMUM

LOAD_CASE_COUNT_LIMIT = 1000
NAME = re.compile(r"\w(?:[\w .+=-]{0,58}[\w+=-])?")  # also of a folder of pictures and of a group of a result
NAME_ALLOWED = "text of up to 60 letters, digits, blanks and `. _ + = -`"


def _name(value: str) -> str:
    if not NAME.fullmatch(value):
        raise ValueError(
            f"{written(value)}: must be up to 60 letters, digits, blanks and . _ + = -, and begin with a letter or "
            "digit"
        )
    return value


Name = Annotated[str, AfterValidator(_name)]


def _rows(value: Any) -> Any:
    if isinstance(value, dict):
        raise ValueError("a load case is a table [[load_cases]], with two brackets")
    return value


class LoadCase(Table):
    """One load case. What is left out of the misalignment, the speed and the flank is as in the rest of the analysis.

    Examples
    --------
    >>> LoadCase(torque=250.0, E=0.05, share=0.3).P is None
    True
    """

    name: Name | None = key("in results; its number, from 1, if left out", allowed=NAME_ALLOWED, default=None)
    torque: float = number("at the pinion", "N m", ge=TORQUE_MINIMUM, lt=TORQUE_LIMIT)
    E: float | None = optional("increase of the offset; that of `[misalignment]` if left out", "mm", gt=-10, lt=10)
    P: float | None = optional("pinion away from the crossing point; likewise", "mm", gt=-10, lt=10)
    G: float | None = optional("gear away from the crossing point; likewise", "mm", gt=-10, lt=10)
    Sigma: float | None = optional("increase of the shaft angle; likewise", "deg", gt=-5, lt=5)
    speed: float | None = optional("adds friction; that of `[friction]` if left out", "1/min", ge=1e-6, le=1e6)
    share: float | None = optional("of time, relative to the sum; of every load case or of none", "1", gt=0, le=1e12)
    flank: Literal["drive", "coast"] | None = key("in mesh; that of the analysis if left out", default=None)

    @field_validator("torque", mode="before")
    @classmethod
    def _not_the_other_sense(cls, value: Any) -> Any:
        if isinstance(value, int | float) and value < 0.0:
            raise PydanticCustomError(
                "negative_torque",
                'must be at least {least} [N m]; flank = "coast" takes the flanks of the other sense of the torque',
                {"least": f"{TORQUE_MINIMUM:g}"},
            )
        return value


LoadCases = Annotated[
    tuple[LoadCase, ...], BeforeValidator(_rows), Field(strict=False, max_length=LOAD_CASE_COUNT_LIMIT)
]


def named_load_cases(load_cases: Sequence[LoadCase]) -> dict[str, LoadCase]:
    """Load cases by name, or by number from 1; names differ in more than case, and all have a share or none."""
    cases: dict[str, LoadCase] = {}
    known: set[str] = set()
    for at, load_case in enumerate(load_cases, start=1):
        name = load_case.name or str(at)
        if name.casefold() in known:
            raise ValueError(f"load_cases: name = {name!r} comes twice; give every load case its own name")
        known.add(name.casefold())
        cases[name] = load_case
    without = [name for name, load_case in cases.items() if load_case.share is None]
    if 0 < len(without) < len(cases):
        raise ValueError(f"load_cases: {without[0]!r} has no share: give the share of every load case, or of none")
    return cases
