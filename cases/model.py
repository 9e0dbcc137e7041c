"""The schema of a case file: every key, its unit and its range. Angles in degrees, lengths in mm, torque in N m.

Names follow the REXS standard where it has one. A misspelt key is an error, never ignored.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, PrivateAttr, model_validator

from .blank_design_table import BlankDesignTable
from .table import Integer, Number, Table
from .table import number as _number


class Blank(Table):
    """Axial section of a member's blank."""

    pitch_angle: Number = _number("pitch angle", "deg", gt=0, lt=90)
    face_angle: Number = _number("face angle", "deg", gt=0, lt=95)
    root_angle: Number = _number("root angle", "deg", gt=-5, lt=90)
    pitch_apex_beyond_crossing_point: Number = _number(
        "pitch apex beyond the crossing point, positive away from the teeth", "mm", default=0.0, gt=-500, lt=500
    )
    face_apex_beyond_crossing_point: Number = _number(
        "face apex beyond the crossing point, positive away from the teeth", "mm", default=0.0, gt=-500, lt=500
    )
    root_apex_beyond_crossing_point: Number = _number(
        "root apex beyond the crossing point, positive away from the teeth", "mm", default=0.0, gt=-500, lt=500
    )
    outer_cone_distance: Number = _number("pitch apex to heel along the pitch cone", "mm", gt=1, lt=5000)
    face_width: Number = _number("toe to heel along the pitch cone", "mm", gt=0.5, lt=1000)
    clearance: Number = _number("root cone to the end of the flank, at right angles", "mm", default=0.0, ge=0, lt=50)
    front_angle: Number | None = _number(
        "the toe line stands at right angles to a cone of this angle; the pitch angle if left out",
        "deg",
        default=None,
        gt=-90,
        lt=180,
    )
    back_angle: Number | None = _number(
        "the heel line stands at right angles to a cone of this angle; the pitch angle if left out",
        "deg",
        default=None,
        gt=-90,
        lt=180,
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.face_angle < self.root_angle:
            raise ValueError(
                f"face_angle = {self.face_angle}: must not be smaller than root_angle = {self.root_angle} (degrees); "
                "both are the same for teeth of uniform depth"
            )
        if self.face_width >= self.outer_cone_distance:
            raise ValueError(
                f"face_width = {self.face_width}: must be smaller than outer_cone_distance = "
                f"{self.outer_cone_distance} (mm)"
            )
        return self


class Cutter(Table):
    """The blade of a cutter: its profile, its reliefs and its edge radius."""

    blade_point_radius: Number = _number("radius of the blade tip", "mm", gt=1, lt=2000)
    blade_pressure_angle: Number = _number("angle between blade edge and cutter axis", "deg", gt=-45, lt=60)
    number_of_blade_groups: Integer = _number(
        "face hobbing: blade groups of the cutter; zero for face milling", "1", default=0, ge=0, le=100
    )
    blade_offset_angle: Number = _number(
        "face hobbing: how far the blade tip stands off the radial direction", "deg", default=0.0, gt=-60, lt=60
    )
    blade_rake_angle: Number = _number(
        "face hobbing: turn of the edge about the cutter axis", "deg", default=0.0, gt=-60, lt=60
    )
    blade_hook_angle: Number = _number(
        "face hobbing: turn of the edge about the radial direction", "deg", default=0.0, gt=-60, lt=60
    )
    blade_spheric_radius: Number | None = _number(
        "radius of a circular profile, positive for a hollow edge, whose pressure angle grows towards the shank; "
        "straight if left out",
        "mm",
        default=None,
        gt=-1e7,
        lt=1e7,
    )
    blade_reference_height: Number = _number(
        "height above the tip plane at which a circular profile has the pressure angle",
        "mm",
        default=0.0,
        gt=-50,
        lt=100,
    )
    tool_edge_radius: Number = _number("radius between profile and tip land", "mm", default=0.0, ge=0, lt=20)
    toprem_depth: Number | None = _number(
        "toprem: height above the tip plane where it begins; none if left out", "mm", default=None, gt=0, lt=50
    )
    toprem_angle: Number = _number("toprem: by how much its pressure angle is smaller", "deg", default=0.0, ge=0, lt=30)
    toprem_radius: Number | None = _number(
        "toprem: radius of its arc; straight if left out", "mm", default=None, gt=0.1, lt=1e7
    )
    flankrem_depth: Number | None = _number(
        "flankrem: height above the tip plane where it begins; none if left out", "mm", default=None, gt=0, lt=100
    )
    flankrem_angle: Number = _number(
        "flankrem: by how much its pressure angle is larger", "deg", default=0.0, ge=0, lt=30
    )
    flankrem_radius: Number | None = _number(
        "flankrem: radius of its arc; straight if left out", "mm", default=None, gt=0.1, lt=1e7
    )

    @model_validator(mode="after")
    def _hobbing_has_groups(self) -> Self:
        turned = (self.blade_offset_angle, self.blade_rake_angle, self.blade_hook_angle)
        if self.number_of_blade_groups == 0 and any(turned):
            raise ValueError(
                "blade_offset_angle, blade_rake_angle and blade_hook_angle belong to face hobbing: give "
                "number_of_blade_groups"
            )
        return self

    @model_validator(mode="after")
    def _reliefs_begin_somewhere(self) -> Self:
        for name in ("toprem", "flankrem"):
            if getattr(self, f"{name}_depth") is None and (
                getattr(self, f"{name}_angle") or getattr(self, f"{name}_radius") is not None
            ):
                raise ValueError(f"{name}_angle and {name}_radius need {name}_depth: where the {name} begins")
            if getattr(self, f"{name}_depth") is not None and not (
                getattr(self, f"{name}_angle") or getattr(self, f"{name}_radius") is not None
            ):
                raise ValueError(f"{name}_depth needs {name}_angle or {name}_radius: it changes nothing without")
        if self.blade_spheric_radius is not None and not abs(self.blade_spheric_radius) > 1.0:
            raise ValueError(f"blade_spheric_radius = {self.blade_spheric_radius}: must be longer than 1 mm either way")
        if self.blade_spheric_radius is None and self.blade_reference_height:
            raise ValueError("blade_reference_height belongs to a circular profile: give blade_spheric_radius")
        return self


Derivatives = Annotated[tuple[Number, ...], Field(strict=False, max_length=6)]


class Motions(Table):
    """Higher-order motions of a generated member: derivatives of settings by the cradle increment, first to sixth.

    A setting is then its basic value plus the sum of derivative times increment^n / n!.
    """

    radial_distance: Derivatives = _number("radial motion", "mm/rad^n", default=())
    work_offset: Derivatives = _number("vertical motion", "mm/rad^n", default=())
    sliding_base: Derivatives = _number("helical motion", "mm/rad^n", default=())
    machine_center_to_crossing_point: Derivatives = _number("axial motion", "mm/rad^n", default=())
    machine_root_angle: Derivatives = _number("angular motion", "deg/rad^n", default=())
    cutter_tilt: Derivatives = _number("tilt motion", "deg/rad^n", default=())
    cutter_swivel: Derivatives = _number("swivel motion", "deg/rad^n", default=())


class Machine(Table):
    """Basic settings of the cradle machine, standard Gleason meaning."""

    radial_distance: Number | None = _number("cutter centre to cradle axis", "mm", default=None, ge=0, lt=5000)
    cradle_angle: Number | None = _number(
        "basic cradle angle, positive for both hands", "deg", default=None, ge=-180, le=180
    )
    horizontal_distance: Number | None = _number(
        "Formate only, instead of radial_distance and cradle_angle: cutter centre along the root line",
        "mm",
        default=None,
        gt=-5000,
        lt=5000,
    )
    vertical_distance: Number | None = _number(
        "Formate only, instead of radial_distance and cradle_angle: cutter centre across the root line",
        "mm",
        default=None,
        gt=-5000,
        lt=5000,
    )
    machine_root_angle: Number = _number("machine root angle", "deg", ge=-45, le=120)
    work_offset: Number = _number("work (blank) offset", "mm", default=0.0, gt=-500, lt=500)
    sliding_base: Number = _number("sliding base", "mm", default=0.0, gt=-1000, lt=1000)
    machine_center_to_crossing_point: Number = _number(
        "machine centre to crossing point (machine centre to back), along the work axis",
        "mm",
        default=0.0,
        gt=-1000,
        lt=1000,
    )
    cutter_tilt: Number = _number("tilt of the cutter axis", "deg", default=0.0, ge=-90, le=90)
    cutter_swivel: Number = _number("swivel: direction of the tilt", "deg", default=0.0, ge=-360, le=360)
    ratio_of_roll: Number | None = _number(
        "work rotation over cradle rotation; left out for a Formate member", "1", default=None, gt=0, lt=100
    )
    modified_roll_2c: Number = _number("second-order modified roll, 2C", "1", default=0.0, gt=-10, lt=10)
    modified_roll_6d: Number = _number("third-order modified roll, 6D", "1", default=0.0, gt=-100, lt=100)
    modified_roll_24e: Number = _number("fourth-order modified roll, 24E", "1", default=0.0, gt=-1000, lt=1000)
    modified_roll_120f: Number = _number("fifth-order modified roll, 120F", "1", default=0.0, gt=-1e4, lt=1e4)
    modified_roll_720g: Number = _number("sixth-order modified roll, 720G", "1", default=0.0, gt=-1e5, lt=1e5)
    motions: Motions = Motions()

    @model_validator(mode="after")
    def _one_way_to_say_it(self) -> Self:
        polar = (self.radial_distance, self.cradle_angle)
        straight = (self.horizontal_distance, self.vertical_distance)
        if any(v is not None for v in straight):
            if any(v is not None for v in polar) or None in straight:
                raise ValueError(
                    "the cutter centre is given either by radial_distance and cradle_angle, or (Formate) by "
                    "horizontal_distance and vertical_distance"
                )
            if self.ratio_of_roll is not None:
                raise ValueError(
                    "horizontal_distance and vertical_distance belong to a Formate member, which has no "
                    "ratio_of_roll: give radial_distance and cradle_angle instead"
                )
        elif None in polar:
            raise ValueError(
                "the cutter centre is missing: give radial_distance and cradle_angle, or (Formate) "
                "horizontal_distance and vertical_distance"
            )
        if self.ratio_of_roll is None and any(self.modified_roll):
            raise ValueError("modified roll is given without ratio_of_roll: a Formate member does not roll")
        if self.ratio_of_roll is None and any(self.motions.model_dump().values()):
            raise ValueError("motions are given without ratio_of_roll: nothing moves while a Formate member is cut")
        return self

    @property
    def modified_roll(self) -> tuple[float, ...]:
        """The derivatives 2C, 6D, 24E, ... as given."""
        return (
            self.modified_roll_2c,
            self.modified_roll_6d,
            self.modified_roll_24e,
            self.modified_roll_120f,
            self.modified_roll_720g,
        )


class FlankSettings(Table):
    """How one flank is cut."""

    machine: Machine
    cutter: Cutter


class Steel(Table):
    """Elastic constants of a member."""

    elastic_modulus: Number = _number("Young's modulus", "MPa", default=206000.0, gt=100, lt=1e6)
    poisson_ratio: Number = _number("Poisson's ratio", "1", default=0.3, ge=0, lt=0.5)


class MemberTable(Table):
    """A pinion or a gear."""

    number_of_teeth: Integer = _number("number of teeth", "1", ge=3, le=500)
    mean_normal_circular_thickness: Number | None = _number(
        "normal circular thickness of the tooth in the middle of the flank; from the cutter, or from the mate's slot, "
        "if left out",
        "mm",
        default=None,
        gt=0,
        lt=200,
    )
    blank: Blank | None = None
    concave: FlankSettings | None = None
    convex: FlankSettings | None = None
    material: Steel = Steel()


class PinionTable(MemberTable):
    """The pinion; its hand decides that of the gear."""

    hand_of_spiral: Literal["left", "right"]


class PairTable(Table):
    """How the members stand to each other."""

    shaft_angle: Number = _number("shaft angle", "deg", default=90.0, gt=5, lt=175)
    hypoid_offset: Number = _number("offset; zero for a spiral bevel pair", "mm", default=0.0, gt=-500, lt=500)


class MisalignmentTable(Table):
    """Assembly errors."""

    offset: Number = _number("E: increase of the offset", "mm", default=0.0, gt=-10, lt=10)
    pinion_axial: Number = _number("P: pinion away from the crossing point", "mm", default=0.0, gt=-10, lt=10)
    gear_axial: Number = _number("G: gear away from the crossing point", "mm", default=0.0, gt=-10, lt=10)
    shaft_angle: Number = _number("increase of the shaft angle", "deg", default=0.0, gt=-5, lt=5)


class ContactTable(Table):
    """What to analyse, and how finely."""

    torques: Annotated[tuple[Number, ...], Field(strict=False, min_length=1, max_length=1000)] = (50.0, 250.0, 500.0)
    mesh_positions: Integer = _number("pinion rotations in one pitch", "1", default=32, ge=3, le=2000)
    segments_per_line: Integer = _number("segments of a contact line", "1", default=31, ge=3, le=2000)
    lengthwise_nodes: Integer = _number("grid nodes along the face", "1", default=31, ge=7, le=1001)
    profile_nodes: Integer = _number("grid nodes up the profile", "1", default=21, ge=7, le=1001)
    separation: Number = _number("gap at which an unloaded contact line ends", "um", default=6.0, gt=0, lt=1000)

    @model_validator(mode="after")
    def _positive_torques(self) -> Self:
        for value in self.torques:
            if not 0.0 < value < 1e7:
                raise ValueError(f"torques contains {value}: every torque must be greater than 0 and below 1e7 N m")
        return self


class ComplianceTable(Table):
    """Models of the elastic tooth."""

    shell_form: Literal["five_field", "thesis"] = "five_field"
    profile_modes: Integer = _number("shell modes up the profile", "1", default=5, ge=1, le=12)
    lengthwise_modes: Integer = _number("shell modes along the face", "1", default=15, ge=1, le=60)
    shear_factor: Number = _number("shear correction factor", "1", default=1.0, gt=0, le=1)
    root: Literal["weber", "odonnell", "clamped"] = "weber"
    root_factor: Number = _number("multiplies the flexibility of the root", "1", default=1.0, gt=0, le=10)


class TargetTable(Table):
    """Ease-off that the pinion's settings were fitted to, in the case's own misalignment; all at the flank's edges.

    A record: the analysis uses the settings.
    """

    lengthwise_crowning: Number = _number("ease-off at toe and heel, mid height", "um", default=0.0, gt=-1e4, lt=1e4)
    profile_crowning: Number = _number("ease-off at root and tip, mid face", "um", default=0.0, gt=-1e4, lt=1e4)
    bias: Number = _number(
        "twist: what toe-tip and heel-root have more than toe-root and heel-tip, over four",
        "um",
        default=0.0,
        gt=-1e4,
        lt=1e4,
    )
    spiral_angle_error: Number = _number(
        "half the ease-off at the heel beyond that at the toe", "um", default=0.0, gt=-1e4, lt=1e4
    )
    pressure_angle_error: Number = _number(
        "half the ease-off at the tip beyond that at the root", "um", default=0.0, gt=-1e4, lt=1e4
    )


class TargetsTable(Table):
    """Targets of the two sides."""

    drive: TargetTable | None = None
    coast: TargetTable | None = None


class Case(Table):
    """A whole case file."""

    easeoff_case: Literal[1]
    title: Annotated[str, Field(min_length=1, max_length=200)]
    description: str = ""
    pair: PairTable
    blank_design: BlankDesignTable | None = None
    pinion: PinionTable
    gear: MemberTable
    misalignment: MisalignmentTable = MisalignmentTable()
    contact: ContactTable = ContactTable()
    compliance: ComplianceTable = ComplianceTable()
    target: TargetsTable = TargetsTable()
    _text: str = PrivateAttr(default="")

    @property
    def text(self) -> str:
        """The case file as it was read; empty for a case built in Python."""
        return self._text

    @model_validator(mode="after")
    def _has_blanks_once(self) -> Self:
        for name, member in (("pinion", self.pinion), ("gear", self.gear)):
            if self.blank_design is None and member.blank is None:
                raise ValueError(
                    f"[{name}.blank] is missing: give [pinion.blank] and [gear.blank], or the basic data of both in "
                    "[blank_design]"
                )
            if self.blank_design is not None and member.blank is not None:
                raise ValueError(
                    f"[blank_design] and [{name}.blank] are both given: basic data stand for the blanks of both "
                    "members, so leave out either [blank_design] or [pinion.blank] and [gear.blank]"
                )
        return self

    @model_validator(mode="after")
    def _has_a_pair_of_flanks(self) -> Self:
        drive = self.pinion.concave is not None and self.gear.convex is not None
        coast = self.pinion.convex is not None and self.gear.concave is not None
        if not (drive or coast):
            raise ValueError(
                "no flanks to mesh: give [pinion.concave] and [gear.convex] for the drive side, or [pinion.convex] and "
                "[gear.concave] for the coast side"
            )
        return self
