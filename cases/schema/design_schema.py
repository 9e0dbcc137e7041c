"""The schema of a design file: basic data and wanted ease-offs, from which a case file is made."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from ...geometry.cutting.named_settings import scale_of
from .blank_design_table import BlankDesignTable
from .case_schema import ComplianceTable, ContactTable, PairTable, Steel, TargetTable
from .friction_table import FrictionTable
from .misalignment_table import MisalignmentTable
from .schema_table import InputFile, Integer, Number, Table, number

EDGE_RADIUS = (
    "edge radius of its cutters' blades, which cuts the fillet; a quarter of the mean normal module, less where "
    "clearance or slot do not allow it, if left out"
)


class DesignedGear(Table):
    """The gear, cut by one spread-blade cutter or hobbed."""

    number_of_teeth: Integer = number("number of teeth", "1", ge=3, le=500)
    generation: Literal["formate", "generated"] = "formate"
    basic_settings: Literal["mean_point", "root_line"] = "mean_point"
    tool_edge_radius: Number | None = number(EDGE_RADIUS, "mm", default=None, gt=0, lt=20)
    material: Steel = Steel()


class DesignedPinion(Table):
    """The generated pinion."""

    number_of_teeth: Integer = number("number of teeth", "1", ge=3, le=500)
    hand_of_spiral: Literal["left", "right"]
    tool_edge_radius: Number | None = number(EDGE_RADIUS, "mm", default=None, gt=0, lt=20)
    follow_root: bool = True
    free_settings: Annotated[tuple[str, ...], Field(strict=False, min_length=1, max_length=40)] | None = None
    material: Steel = Steel()

    @field_validator("free_settings")
    @classmethod
    def _known(cls, names: tuple[str, ...] | None) -> tuple[str, ...] | None:
        for name in names or ():
            scale_of(name)
        return names


class DesignTargets(Table):
    """Wanted ease-off of both sides, in the misalignment of the design."""

    drive: TargetTable
    coast: TargetTable


class Design(InputFile):
    """A whole design file.

    Examples
    --------
    >>> from easeoff.cases import read_design
    >>> design = read_design("fm-11x41")
    >>> design.pinion.number_of_teeth, design.blank_design.process
    (11, 'face_milled')
    """

    easeoff_design: Literal[1]
    title: Annotated[str, Field(min_length=1, max_length=200)]
    description: str = ""
    pair: PairTable
    blank_design: BlankDesignTable
    pinion: DesignedPinion
    gear: DesignedGear
    misalignment: MisalignmentTable = MisalignmentTable()
    contact: ContactTable = ContactTable()
    compliance: ComplianceTable = ComplianceTable()
    friction: FrictionTable | None = None
    target: DesignTargets
