"""Operating conditions and friction models in a case or design file."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PrivateAttr, ValidationInfo, model_validator

from ...core.checks import is_number
from ...core.errors import InputError, printable, shortened
from ...core.regular_file import leads_outside
from ..mistakes import written
from .schema_table import Table, key, number, optional

if TYPE_CHECKING:
    from ...friction import FrictionModel, Operation


def _listed(value: Any) -> Any:
    """One number counts as a list of one."""
    return value if isinstance(value, list | tuple) else (value,)


def _is_finite(value: Any) -> bool:
    return is_number(value) and math.isfinite(value)


def _roughnesses(value: Any) -> Any:
    """The entries of a list of roughnesses, each a number or a pair; one number counts as a list of one."""
    entries = tuple(tuple(entry) if isinstance(entry, list) else entry for entry in _listed(value))
    for entry in entries:
        pair = entry if isinstance(entry, tuple) else (entry, entry)
        if len(pair) != 2 or not all(_is_finite(height) for height in pair):
            raise ValueError(
                f"{list(entry) if isinstance(entry, tuple) else written(entry)}: give a number in um or a "
                "list of such, in which [0.8, 0.4] as an entry is pinion and gear"
            )
    return entries


def _pair(value: Any) -> Any:
    """A number, or a pair for pinion and gear, refused in one message."""
    pair = tuple(value) if isinstance(value, list | tuple) else (value, value)
    if len(pair) != 2 or not all(_is_finite(each) for each in pair):
        raise ValueError(f"{written(value)}: must be a number, or a list of two for pinion and gear")
    return pair if isinstance(value, list | tuple) else value


def _coefficient(value: Any) -> Any:
    """A name or a number, refused in one message: of a union, pydantic reports each of its kinds."""
    if isinstance(value, str) or _is_finite(value):
        return value
    from ...friction.coefficient import COEFFICIENT_LIMIT, COEFFICIENTS

    models = ", ".join(COEFFICIENTS)
    raise ValueError(f"{written(value)}: must be one of {models}, or a number from 0 to {COEFFICIENT_LIMIT:g}")


SEVERAL = Field(strict=False, min_length=1, max_length=1000)
Numbers = Annotated[tuple[float, ...], BeforeValidator(_listed), SEVERAL]
OneOrPair = float | Annotated[tuple[float, float], Field(strict=False)]
ByMember = Annotated[OneOrPair, BeforeValidator(_pair)]
Roughnesses = Annotated[tuple[OneOrPair, ...], BeforeValidator(_roughnesses), SEVERAL]


class FrictionTable(Table):
    """Operating conditions and friction models, checked by ``friction.Operation`` and ``friction.FrictionModel``."""

    speed: Numbers = number("of the pinion", "1/min", allowed="one or a list, 1e-6 to 1e6")
    temperature: Numbers = number(
        "of the oil at the inlet",
        "degC",
        allowed="one or a list, within the oil's data; clamped to them, ≤ 400",
        default=(90.0,),
    )
    roughness: Roughnesses = number(
        "RMS; in a list `[0.8, 0.4]` may stand for pinion and gear",
        "um",
        allowed="one or a list, 0 to 100",
        default=(0.8,),
    )
    oil: str = key("lubricant, or path of a TOML file inside the folder of this one", default="75w90")
    coefficient: Annotated[str | float, BeforeValidator(_coefficient)] = number(
        "model or number", "1", default="kolivand_blended"
    )
    film: str = key("formula for the least film thickness", default="pan_hamrock")
    film_heating: str = key("thinning of the film by heat of the inlet", default="none")
    thermal_factor: str = key("decrease of the rolling traction by heat of the inlet", default="goksem_hargreaves")
    rolling_frame: Literal["fixed", "contact_line"] = key("frame of the rolling velocity", default="fixed")
    out_of_range: Literal["error", "clamp"] = key(
        "temperature without oil data: an error, or the end of the data with a flag", default="error"
    )
    bulk_temperature: float | None = optional(
        "of the teeth; that of the oil if left out", "degC", allowed="> -273.15, ≤ 1000"
    )
    tooth_conductivity: ByMember = number(
        "thermal; in a list of pinion and gear", "W/(m K)", allowed="one or two, 0.01 to 1e4", default=46.0
    )
    tooth_density: ByMember = number("likewise", "kg/m3", allowed="one or two, 10 to 1e5", default=7850.0)
    tooth_heat_capacity: ByMember = number(
        "specific, likewise", "J/(kg K)", allowed="one or two, 1 to 1e5", default=460.0
    )
    feedback: bool = key("friction takes its part of the torque from the normal forces", default=False)
    _folder: Path | None = PrivateAttr(default=None)
    _allow_outside: bool | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _possible(self, info: ValidationInfo) -> Self:
        # The folder of the file is no key of it: the reader hands it over beside the keys. A table that goes from a
        # design to a case is checked again and has it already.
        if info.context:
            if info.context["folder"] is not None:
                self._folder = Path(info.context["folder"]).absolute()
            if self._allow_outside is None:
                self._allow_outside = info.context["allow_outside"]
        self.model().oil_states(self.operation())
        return self

    def operation(self, **changed: Any) -> Operation:
        """The operating conditions, some of them changed.

        A relative path of an oil starts from the folder of the case; a changed one from the working folder.
        """
        from ...friction import Operation
        from ...friction.lubricants.lubricant import lubricant

        conditions: dict[str, Any] = {
            "speed": self.speed,
            "temperature": self.temperature,
            "roughness": list(self.roughness),
            "bulk_temperature": self.bulk_temperature,
        }
        if "oil" not in changed:
            self._require_inside()
            conditions["oil"] = lubricant(self.oil, self._folder)
        return Operation(**(conditions | changed))

    @property
    def is_outside(self) -> bool:
        """True if the oil's file is outside the folder of the case, wherever links lead."""
        from ...friction.lubricants.lubricant import is_shipped

        return not is_shipped(self.oil) and leads_outside(self._folder or "", self.oil)

    def _require_inside(self) -> None:
        """Refuse an oil of a file that may be anybody's, and say nothing of the place it names."""
        from ...friction.lubricants.lubricant import is_shipped

        if self._allow_outside is not False or is_shipped(self.oil):
            return
        quoted = printable(shortened(repr(self.oil)))
        if self.is_outside:
            start = "the working folder" if self._folder is None else "the folder of the case"
            raise InputError(
                f"oil = {quoted}: must be the name of a lubricant, or a file inside {start}; if you trust the case, "
                "--allow-outside (in Python allow_outside=True) opens files elsewhere"
            )
        if Path(self.oil).suffix.lower() != ".toml" and os.path.exists(self.oil_file):
            raise InputError(f"oil = {quoted}: must be the name of a lubricant, or of a file that ends in .toml")

    @property
    def oil_file(self) -> Path:
        """Path of the oil's file, if it is not shipped."""
        return Path(self._folder or "", self.oil)

    def seen_from(self, folder: Path) -> Self:
        """The table as a case in another folder has it: with the relative path of an oil from there."""
        from ...friction.lubricants.lubricant import is_shipped

        moved = self.model_copy()
        if not is_shipped(self.oil) and not Path(self.oil).is_absolute():
            file = self.oil_file.absolute()
            try:
                oil = Path(os.path.relpath(file, folder.absolute()))
            except ValueError:  # no way leads from one drive of Windows to another
                oil = file
            moved = self.model_copy(update={"oil": oil.as_posix()})
        moved._folder = folder.absolute()
        return moved

    def model(self, **changed: Any) -> FrictionModel:
        """The friction models, some of them changed."""
        from ...friction import FrictionModel

        return FrictionModel(**(self.model_dump(include=set(FrictionModel.__dataclass_fields__)) | changed))
