"""The schema of a design file: basic data and wanted ease-offs, from which a case file is made."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, field_validator

from ...geometry.cutting.named_settings import scale_of
from ...geometry.design.iso23509.usual_proportions import DefaultValue
from ...geometry.design.pinion_method import PinionMethod
from .blank_design_table import BlankDesignTable
from .case_schema import (
    ComplianceTable,
    ContactTable,
    DrawingTable,
    HandOfSpiral,
    MisalignmentTable,
    PairTable,
    Steel,
    TargetTable,
)
from .friction_table import FrictionTable
from .schema_table import Description, InputFile, Table, Title, key, number, optional

EDGE_RADIUS = (
    "edge radius of its cutters' blades, which cuts the fillet; a quarter of the mean normal module, less where "
    "clearance or slot do not allow it, if left out"
)


class DesignedGear(Table):
    """The gear, cut by one spread-blade cutter or hobbed."""

    number_of_teeth: int = number("number of teeth", "1", ge=3, le=500)
    generation: Literal["formate", "generated"] = key(
        "whether the gear is rolled while it is cut, or only indexed; if left out it is generated below a ratio of "
        "2.5, at other shaft angles than 90 degrees below the pitch angle of that",
        default="formate",
    )
    basic_settings: Literal["mean_point", "root_line"] = key(
        "whether the gear's settings are corrected until its flanks have the blank's angles at the mean point, or "
        "follow from the root line by the closed form",
        default="mean_point",
    )
    tool_edge_radius: float | None = optional(EDGE_RADIUS, "mm", gt=0, lt=20)
    material: Steel = Steel()


class LimitsTable(Table):
    """Limits of the settings of a pinion that is cut by a method of the shop; zero takes a setting out of use."""

    cutter_tilt: float = number("largest tilt of the cutter axis", "deg", default=30.0, ge=0, le=60)
    cutter_swivel: float = number("largest swivel to either side", "deg", default=180.0, gt=0, le=180)
    machine_root_angle: float = number(
        "with tilt: largest difference of machine root angle and root angle of the blank",
        "deg",
        default=30.0,
        ge=0,
        le=60,
    )
    sliding_base: float | None = optional(
        "with tilt: largest sliding base; half the cutter radius if left out", "mm", gt=0, lt=1000
    )
    modified_roll_2c: float = number("largest second-order modified roll, 2C", "1", default=0.5, ge=0, lt=10)
    modified_roll_6d: float = number("largest third-order modified roll, 6D", "1", default=1.0, ge=0, lt=100)
    modified_roll_24e: float = number("largest fourth-order modified roll, 24E", "1", default=0.0, ge=0, lt=1000)
    modified_roll_120f: float = number("largest fifth-order modified roll, 120F", "1", default=0.0, ge=0, lt=1e4)
    helical_motion: float | None = optional(
        "completing: largest first derivative of the sliding base by the cradle rotation; half the cutter radius if "
        "left out",
        "mm/rad",
        ge=0,
        lt=1000,
    )
    blade_point_radius: float = number(
        "largest difference of the radius of the blade tip and the mean cutter radius, over the latter",
        "1",
        default=0.2,
        gt=0,
        lt=0.9,
    )
    smallest_blade_pressure_angle: float = number("smallest blade angle", "deg", default=5.0, ge=0, lt=45)
    largest_blade_pressure_angle: float = number("largest blade angle", "deg", default=40.0, gt=0, lt=60)

    def _check(self) -> None:
        low, high = self.smallest_blade_pressure_angle, self.largest_blade_pressure_angle
        if not low < high:
            raise ValueError(
                f"smallest_blade_pressure_angle = {low}: must be below largest_blade_pressure_angle = {high}"
            )


class DesignedPinion(Table):
    """The generated pinion."""

    number_of_teeth: int = number("number of teeth", "1", ge=3, le=500)
    hand_of_spiral: HandOfSpiral
    tool_edge_radius: float | None = optional(EDGE_RADIUS, "mm", gt=0, lt=20)
    method: PinionMethod = key(
        "how the pinion is cut, see [methods](design_file.md#methods-of-the-pinion)", default="closest_fit"
    )
    limits: LimitsTable = LimitsTable()
    follow_root: bool = key(
        "closest fit: whether the tips of the pinion's blades shall run along its root cone; other methods always do",
        default=True,
    )
    free_settings: Annotated[tuple[str, ...], Field(strict=False, min_length=1, max_length=40)] | None = key(
        "closest fit: pinion settings it may move, see below; the usual ones if left out",
        allowed="names of settings",
        default=None,
    )
    material: Steel = Steel()

    @field_validator("free_settings")
    @classmethod
    def _known(cls, names: tuple[str, ...] | None) -> tuple[str, ...] | None:
        for name in names or ():
            scale_of(name)
        return names

    def _check(self) -> None:
        if self.method == "closest_fit":
            if self.limits != LimitsTable():
                raise ValueError('limits belong to a method of the shop: give method = "modified_roll" or another')
        elif self.free_settings is not None or not self.follow_root:
            raise ValueError(
                f'method = "{self.method}": has settings and root line of its own; free_settings and follow_root = '
                'false belong to method = "closest_fit"'
            )


class CutterStepsTable(Table):
    """Standard steps of the cutters, taken before the machine settings are fitted; zero leaves a value as computed."""

    blade_angle: float = number("step of the blade angles", "deg", default=0.5, ge=0, le=5)
    point_width: float = number(
        "face-milled: step of the point widths; the radius of a blade tip has half of it", "mm", default=0.1, ge=0, le=2
    )
    edge_radius: float = number(
        "step of an edge radius that is not given, rounded down", "mm", default=0.05, ge=0, le=1
    )


class ResolutionTable(Table):
    """Resolution of the machine and the tool room, to which `easeoff design --round` rounds."""

    length: float = number("linear settings of the machine", "mm", default=0.001, gt=0, lt=10)
    angle: float = number("angular settings of the machine", "deg", default=0.001, gt=0, lt=10)
    roll: float = number("ratio of roll", "1", default=1e-6, gt=0, lt=10)
    modified_roll: float = number("coefficients of the modified roll", "1", default=1e-5, gt=0, lt=10)
    motion: float = number("derivatives of moving settings", "mm/rad or deg/rad", default=0.001, gt=0, lt=10)
    blade_radius: float = number("radius of a blade tip", "mm", default=0.01, gt=0, lt=10)
    blade_angle: float = number("angles of a blade", "deg", default=0.01, gt=0, lt=10)
    edge_radius: float = number("edge radius of a blade", "mm", default=0.01, gt=0, lt=10)


class DesignTargets(Table):
    """Wanted ease-off of both sides, in the misalignment of the design; by the size of the teeth if left out."""

    drive: TargetTable = TargetTable()
    coast: TargetTable = TargetTable()


FORMATE_RATIO = 2.5  # of a pair at 90 degrees; customary from there on
#: Crowning of a side without a target: lengthwise in face widths, profile in outer transverse modules [um/mm].
LENGTHWISE_CROWNING, PROFILE_CROWNING = 2.0, 6.0
OWN_RULE = "rule of this package"


class Design(InputFile):
    """A whole design file.

    Examples
    --------
    >>> from easeoff.cases import read_design
    >>> design = read_design("fm-11x41")
    >>> design.pinion.number_of_teeth, design.blank_design.process
    (11, 'face_milled')
    """

    easeoff_design: Literal[1] = key("version of the format")
    title: Title
    description: Description = ""
    pair: PairTable = PairTable()
    blank_design: BlankDesignTable
    pinion: DesignedPinion
    gear: DesignedGear
    cutter_steps: CutterStepsTable = CutterStepsTable()
    resolution: ResolutionTable = ResolutionTable()
    misalignment: MisalignmentTable = MisalignmentTable()
    contact: ContactTable = ContactTable()
    compliance: ComplianceTable = ComplianceTable()
    friction: FrictionTable | None = None
    target: DesignTargets = DesignTargets()
    drawing: DrawingTable = DrawingTable()
    _defaults: tuple[DefaultValue, ...] = PrivateAttr(default=())

    @property
    def defaults(self) -> tuple[DefaultValue, ...]:
        """Values taken for keys that the file leaves out where a drawing does, with their sources."""
        return (*self.blank_design.defaults, *self._defaults)

    def with_defaults(self, changed: tuple[DefaultValue, ...]) -> Self:
        """The design with other values for what its file leaves out, those of [pinion] and [gear] by dotted names."""
        basic = tuple(each for each in changed if "." not in each.name)
        copy = self.model_copy(update={"blank_design": self.blank_design.with_defaults(basic)})
        for each in set(changed).difference(basic):
            table, key = each.name.split(".")
            copy = copy.model_copy(update={table: getattr(copy, table).model_copy(update={key: each.value})})
            copy._defaults = (*(old for old in copy._defaults if old.name != each.name), each)
        return copy

    @property
    def usual_generation(self) -> Literal["formate", "generated"]:
        """Cutting of the gear by the pitch angle that it has without an offset."""
        shaft = math.radians(self.pair.shaft_angle)
        pinion, gear = self.pinion.number_of_teeth, self.gear.number_of_teeth
        flat = math.sin(shaft) * gear > FORMATE_RATIO * (pinion + gear * math.cos(shaft))
        return "formate" if flat else "generated"

    def _check(self) -> None:
        teeth = self.pinion.number_of_teeth, self.gear.number_of_teeth
        basic = self.blank_design.completed(teeth, self.pair.shaft_angle, self.pair.hypoid_offset)
        taken: list[DefaultValue] = []
        changed: dict[str, Any] = {"blank_design": basic}
        if "generation" not in self.gear.model_fields_set:
            taken.append(DefaultValue("gear.generation", self.usual_generation, "pitch angle of the gear"))
            changed["gear"] = self.gear.model_copy(update={"generation": self.usual_generation})
        module, width = basic.tooth_size(teeth)
        crowning = {
            "lengthwise_crowning": round(LENGTHWISE_CROWNING * width, 1),
            "profile_crowning": round(PROFILE_CROWNING * module, 1),
        }
        sides = [side for side, _ in self.target if side not in self.target.model_fields_set]
        taken += [DefaultValue(f"target.{side}.{key}", crowning[key], OWN_RULE) for side in sides for key in crowning]
        changed["target"] = self.target.model_copy(update=dict.fromkeys(sides, TargetTable(**crowning)))
        for name, value in changed.items():
            object.__setattr__(self, name, value)
        self._defaults = (*self._defaults, *taken)
