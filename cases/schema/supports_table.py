"""Supports of the members in a case file: matrices, or shafts on bearings."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from ...core.checks import is_number
from ..mistakes import written
from .load_case_table import NAME_ALLOWED, Name
from .schema_table import Description, InputFile, Table, Title, key, number, optional

STIFFNESS_LIMIT = 1e9  # of a bearing [N/mm]
TILTING_STIFFNESS_LIMIT = 1e13  # of a bearing [N mm/rad]
CURVE_LENGTH_LIMIT = 100  # of a bearing [points]
#: What keys allow that their validators check.
PAIRS = f"2 to {CURVE_LENGTH_LIMIT} pairs, positive and increasing"
STIFFNESS = f"0 to {STIFFNESS_LIMIT:g}, or {PAIRS}"
TILTING_STIFFNESS = f"0 to {TILTING_STIFFNESS_LIMIT:g}, or {PAIRS}"
MATRIX = "symmetric, [positive definite](../guides/supports.md)"
PLACE = "three within ±5000"

Coordinate = Annotated[float, Field(gt=-5000, lt=5000)]
Point = Annotated[tuple[Coordinate, Coordinate, Coordinate], Field(strict=False)]


def _matrix(rows: int) -> Any:
    row = Annotated[tuple[float, ...], Field(strict=False, min_length=rows, max_length=rows)]
    return Annotated[tuple[row, ...], Field(strict=False, min_length=rows, max_length=rows)]


def _pairs(value: Any) -> Any:
    """A curve, refused in one message."""
    rows = [tuple(row) if isinstance(row, list | tuple) else row for row in value] if _is_list(value) else []
    if not 2 <= len(rows) <= CURVE_LENGTH_LIMIT or not all(
        isinstance(row, tuple) and len(row) == 2 and all(is_number(entry) and 0.0 < entry < math.inf for entry in row)
        for row in rows
    ):
        raise ValueError(
            f"{written(value)}: must be 2 to {CURVE_LENGTH_LIMIT} pairs of positive numbers, such as "
            "[[1000.0, 0.004], [5000.0, 0.017]], the load first"
        )
    for (before, _), (load, _) in pairwise(rows):
        if load <= before:
            raise ValueError(f"{written(value)}: loads must increase, and {load:g} follows {before:g}")
    return tuple(rows)


def _stiffness(value: Any) -> Any:
    """A number or a curve, refused in one message: of a union, pydantic reports each of its kinds."""
    if _is_list(value):
        return _pairs(value)
    if value is not None and not (is_number(value) and math.isfinite(value)):
        raise ValueError(f"{written(value)}: must be a number, or pairs of load and load over displacement")
    return value


def _is_list(value: Any) -> bool:
    return isinstance(value, list | tuple)


Pair = tuple[float, float]
Curve = Annotated[tuple[Pair, ...], BeforeValidator(_pairs), Field(strict=False)]
BearingStiffness = Annotated[float | tuple[Pair, ...], BeforeValidator(_stiffness)]


class ShaftSectionTable(Table):
    """A cylindrical section of a shaft."""

    start: float = number("where it begins on the member's axis", "mm", gt=-5000, lt=5000)
    end: float = number("where the next section begins", "mm", gt=-5000, lt=5000)
    outer_diameter: float = number("outer diameter", "mm", ge=1, le=2000)
    inner_diameter: float = number("at most 99 % of the outer one", "mm", default=0.0, ge=0, lt=2000)


class ShaftTable(Table):
    """The shaft of a member. Places are on the member's axis, from its crossing point, positive towards the heel."""

    sections: Annotated[tuple[ShaftSectionTable, ...], Field(strict=False, min_length=1, max_length=200)]
    seat: float | None = optional(
        "where the member is fixed; the middle of the face if left out", "mm", gt=-5000, lt=5000
    )
    torque_position: float | None = optional(
        "where the torque enters, for `wind_up`; pinion only", "mm", gt=-5000, lt=5000
    )
    elastic_modulus: float = number("Young's modulus", "MPa", default=206000.0, gt=500, lt=1e6)
    poisson_ratio: float = number("Poisson's ratio", "1", default=0.3, ge=0, lt=0.5)


class BearingTable(Table):
    """A bearing. Each stiffness is a number, or a curve of loads and stiffness, or one of loads and displacement."""

    name: Name = number("in results", "1", allowed=NAME_ALLOWED)
    position: float = number("on the member's axis; of a taper roller bearing its load centre", "mm", gt=-5000, lt=5000)
    radial_stiffness: BearingStiffness | None = optional(
        "number, or pairs of load [N] and load over displacement", "N/mm", allowed=STIFFNESS
    )
    axial_stiffness: BearingStiffness | None = optional(
        "likewise, in both senses; none if left out", "N/mm", allowed=STIFFNESS
    )
    tilting_stiffness: BearingStiffness | None = optional(
        "likewise, of moments [N mm]; none if left out", "N mm/rad", allowed=TILTING_STIFFNESS
    )
    radial_displacement: Curve | None = optional("instead: pairs of load [N] and displacement", "mm", allowed=PAIRS)
    axial_displacement: Curve | None = optional("instead: pairs of load [N] and displacement", "mm", allowed=PAIRS)
    tilting_displacement: Curve | None = optional("instead: pairs of moment [N mm] and angle", "rad", allowed=PAIRS)

    def _check(self) -> None:
        for name in ("radial", "axial", "tilting"):
            stiffness, curve = getattr(self, f"{name}_stiffness"), getattr(self, f"{name}_displacement")
            if stiffness is not None and curve is not None:
                raise ValueError(f"{name}_stiffness and {name}_displacement are both given: give one of them")
            limit, unit = (TILTING_STIFFNESS_LIMIT, "N mm/rad") if name == "tilting" else (STIFFNESS_LIMIT, "N/mm")
            values = [value for _, value in stiffness] if isinstance(stiffness, tuple) else [stiffness or 0.0]
            for value in values:
                if not 0.0 <= value <= limit:
                    raise ValueError(f"{name}_stiffness = {value:g}: must be from 0 to {limit:g} [{unit}]")
        if all(getattr(self, key) is None for key in type(self).model_fields if key not in ("name", "position")):
            raise ValueError(f"bearing {self.name!r} has no stiffness: give radial_stiffness, axial_stiffness or both")


class MemberSupportTable(Table):
    """The support of a member: a matrix at a reference point, or a shaft on bearings."""

    reference: Point | None = optional("x, y, z in the pair's frame, where a matrix holds", "mm", allowed=PLACE)
    stiffness: _matrix(6) | None = optional(  # type: ignore[valid-type]
        "6 rows of 6: force [N] and moment [N mm] for translation [mm] and rotation [rad] of the reference, "
        "each x, y, z",
        "N/mm, N, N mm/rad",
        allowed=MATRIX,
    )
    compliance: _matrix(6) | None = optional(  # type: ignore[valid-type]
        "instead: the inverse", "mm/N, 1/N, rad/(N mm)", allowed=MATRIX
    )
    shaft: ShaftTable | None = None
    bearings: Annotated[tuple[BearingTable, ...], Field(strict=False, max_length=20)] = ()

    def _check(self) -> None:
        names = [bearing.name.casefold() for bearing in self.bearings]
        twice = next((bearing.name for bearing in self.bearings if names.count(bearing.name.casefold()) > 1), None)
        if twice is not None:
            raise ValueError(f"bearings: name = {written(twice)} comes twice; give every bearing its own name")
        given = [key for key in ("stiffness", "compliance", "shaft") if getattr(self, key) is not None]
        if len(given) != 1:
            kinds = " and ".join(given) if given else "none"
            raise ValueError(f"{kinds} given: give one of stiffness, compliance, or a shaft with bearings")
        if self.shaft is None and self.reference is None:
            raise ValueError(f"reference is missing: give the point at which the {given[0]} holds")
        if self.shaft is None and self.bearings:
            raise ValueError(f"bearings go with a shaft: leave them out, the {given[0]} contains them")
        if self.shaft is not None and self.reference is not None:
            raise ValueError("reference goes with a matrix: leave it out, that of a shaft is the middle of the face")
        if self.shaft is not None and not self.bearings:
            raise ValueError("bearings are missing: give the bearings of the shaft")


class HousingTable(Table):
    """One matrix for both members, coupled by a housing."""

    pinion_reference: Point = number("x, y, z in the pair's frame", "mm", allowed=PLACE)
    gear_reference: Point = number("x, y, z in the pair's frame", "mm", allowed=PLACE)
    stiffness: _matrix(12) | None = optional(  # type: ignore[valid-type]
        "12 rows of 12: those of a member for the pinion, then the gear, coupled", "N/mm, N, N mm/rad", allowed=MATRIX
    )
    compliance: _matrix(12) | None = optional(  # type: ignore[valid-type]
        "instead: the inverse", "mm/N, 1/N, rad/(N mm)", allowed=MATRIX
    )

    def _check(self) -> None:
        if (self.stiffness is None) == (self.compliance is None):
            raise ValueError("stiffness, compliance: give one of them")


class SupportsTable(Table):
    """Supports of both members. A member that is left out does not give way.

    Examples
    --------
    >>> from easeoff.cases import read_supports
    >>> [bearing.name for bearing in read_supports("axle-fm-11x41").pinion.bearings]
    ['head', 'tail']
    """

    wind_up: bool = key(
        "the pinion turns about its axis by its support's compliance; else this rotation is held, as the gear's always "
        "is",
        default=False,
    )
    rounds: Literal["none", "mean", "position"] = key(
        "assembly for which the ease-off is computed anew: mean of the mesh cycle, every mesh position, or none (first "
        "order)",
        default="mean",
    )
    pinion: MemberSupportTable | None = None
    gear: MemberSupportTable | None = None
    housing: HousingTable | None = None

    def _check(self) -> None:
        members = [name for name in ("pinion", "gear") if getattr(self, name) is not None]
        if self.housing is not None and members:
            raise ValueError(
                f"[supports.housing] and [supports.{members[0]}] are both given: the matrix of a housing holds for "
                "both members with their shafts and bearings, so give either"
            )
        if self.housing is None and not members:
            raise ValueError("no support is given: give [supports.pinion], [supports.gear] or [supports.housing]")
        if self.gear is not None and self.gear.shaft is not None and self.gear.shaft.torque_position is not None:
            raise ValueError(
                "gear.shaft.torque_position: must be left out: the rotation of the gear is that of the mesh"
            )
        pinion = self.pinion.shaft if self.pinion is not None else None
        if self.wind_up and pinion is not None and pinion.torque_position is None:
            raise ValueError("wind_up = true: must go with torque_position in [supports.pinion.shaft]")
        if self.wind_up and self.pinion is None and self.housing is None:
            raise ValueError("wind_up = true: must go with [supports.pinion] or [supports.housing]")


class SupportFile(InputFile):
    """A file with the supports of a pair, for ``--supports``."""

    easeoff_support: Literal[1] = key("version of the format")
    title: Title
    description: Description = ""
    supports: SupportsTable
