"""The schema of a case file: every key, its unit and its range. Angles in degrees, lengths in mm, torque in N m.

Names follow the REXS standard where it has one; each has a usual one besides, for tables and pictures. A misspelt key
is an error, never ignored. Misalignment is assembly errors, or a table of deflections over the torque. A cutter radius
that is absurdly small beside the member, and usual after conversion, is refused as one in inches.
"""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, PrivateAttr

from ...core.checks import shown
from ...core.errors import InputError, printable
from ...geometry.pair.assembly import Misalignment
from ..deflections import ERRORS, SYMBOLS, Deflections
from ..mistakes import written
from .blank_design_table import BlankDesignTable
from .cutting_table import ROLL_KEYS, FlankSettings
from .friction_table import FrictionTable
from .load_case_table import LoadCases, named_load_cases
from .schema_table import Description, InputFile, Table, Title, key, number, optional
from .supports_table import SupportsTable
from .usual_torques import TORQUE_LIMIT, TORQUE_MINIMUM, torque_range, usual_torques

if TYPE_CHECKING:
    from ...geometry.pair.gear_pair import FlankName

INCH = 25.4  # [mm]
#: Module and cutter radius [mm] below which a whole design seems to be in inches.
SMALLEST_MODULE, LARGEST_CUTTER_IN_INCHES = 0.4, 12.5
#: Radius of the cutter over the gear's pitch radius: what is absurd, what is usual.
ABSURD_RATIO, USUAL_RATIOS = 0.15, (0.25, 3.0)


def refuse_inches(table: BlankDesignTable, gear_teeth: int) -> None:
    """Refuse basic data in inches, or a cutter radius alone; the message has the length in mm."""
    diameter = table.gear_outer_pitch_diameter or table.gear_mean_pitch_diameter
    if diameter is None:
        return
    if diameter / gear_teeth < SMALLEST_MODULE and table.cutter_radius < LARGEST_CUTTER_IN_INCHES:
        name = "gear_outer_pitch_diameter" if table.gear_outer_pitch_diameter else "gear_mean_pitch_diameter"
        raise InputError(
            f"[blank_design] {name} = {diameter:g}: lengths must be in mm, and this one makes a module of "
            f"{diameter / gear_teeth:.2g} mm; {diameter:g} in is {INCH * diameter:.6g} mm"
        )
    radius, ratio = table.cutter_radius, 2.0 * table.cutter_radius / diameter
    if ratio < ABSURD_RATIO and USUAL_RATIOS[0] <= INCH * ratio <= USUAL_RATIOS[1]:
        raise InputError(
            f"[blank_design] cutter_radius = {radius:g}: must be in mm, and is absurdly small for a pair of this size; "
            f"{radius:g} in is {INCH * radius:.6g} mm"
        )


#: Names that settings have in workshops where the key, which follows REXS, says it otherwise.
USUAL_NAMES: Mapping[str, str] = {
    "radial_distance": "radial setting",
    "cradle_angle": "basic cradle angle",
    "horizontal_distance": "horizontal setting",
    "vertical_distance": "vertical setting",
    "work_offset": "blank offset",
    "machine_center_to_crossing_point": "machine centre to back",
    "cutter_tilt": "tilt",
    "cutter_swivel": "swivel",
    **{key: f"modified roll {key.rpartition('_')[2].upper()}" for key in ROLL_KEYS},
    "blade_point_radius": "cutter point radius",
    "blade_pressure_angle": "blade angle",
    "blade_spheric_radius": "profile radius",
    "blade_reference_height": "reference height",
    "tool_edge_radius": "edge radius",
    "number_of_blade_groups": "blade groups",
}
#: Names of the motions that have one.
MOTION_NAMES: Mapping[str, str] = {
    "sliding_base": "helical motion",
    "work_offset": "vertical motion",
    "radial_distance": "radial motion",
}


def usual_name(key: str) -> str:
    """Usual name of the quantity of a key of a case file, else the key in words."""
    return USUAL_NAMES.get(key, key.replace("_", " "))


def motion_name(key: str) -> str:
    """Name of the motion of a setting."""
    return MOTION_NAMES.get(key, f"motion of {usual_name(key)}")


Side = Literal["concave", "convex"]
DEFLECTION_ROW_COUNT_LIMIT = 1000


class DeflectionRow(Table):
    """A row of a table of deflections; a key must be in all rows or in none, where it counts as zero."""

    torque: float = number("at the pinion, rising", "N m", ge=0, lt=TORQUE_LIMIT)
    E: float | None = optional("increase of the offset", "mm", gt=-10, lt=10)
    P: float | None = optional("pinion away from the crossing point", "mm", gt=-10, lt=10)
    G: float | None = optional("gear away from the crossing point", "mm", gt=-10, lt=10)
    Sigma: float | None = optional("increase of the shaft angle", "deg", gt=-5, lt=5)
    flank: Literal["drive", "coast"] | None = key("in mesh; both if left out", default=None)


def _rows(value: Any) -> Any:
    if isinstance(value, dict):
        raise ValueError("a row of deflections is a table [[misalignment.deflections]], with two brackets")
    return value


DeflectionRows = Annotated[
    tuple[DeflectionRow, ...], BeforeValidator(_rows), Field(strict=False, max_length=DEFLECTION_ROW_COUNT_LIMIT)
]


class MisalignmentTable(Table):
    """Assembly errors; with deflections those are added to them."""

    offset: float = number("E: increase of the offset", "mm", default=0.0, gt=-10, lt=10)
    pinion_axial: float = number("P: pinion away from the crossing point", "mm", default=0.0, gt=-10, lt=10)
    gear_axial: float = number("G: gear away from the crossing point", "mm", default=0.0, gt=-10, lt=10)
    shaft_angle: float = number("Sigma: increase of the shaft angle", "deg", default=0.0, gt=-5, lt=5)
    deflections: DeflectionRows = ()

    def _check(self) -> None:
        if self.deflections:
            deflections_of(self.deflections)


def deflections_of(rows: Sequence[DeflectionRow], constant: Misalignment | None = None) -> Deflections:
    """Deflections in rad from rows, each flank in the order of torques, plus a constant at every torque."""
    columns: dict[str, list[Any]] = {}
    for symbol in (*SYMBOLS, "flank"):
        values = [getattr(row, symbol) for row in rows]
        without = [row.torque for row, value in zip(rows, values, strict=True) if value is None]
        if 0 < len(without) < len(rows):
            raise ValueError(
                f"{symbol} is in some rows of the deflections and not in that of torque = {without[0]:g}: give it in "
                "every row, or in none"
            )
        columns[symbol] = [] if without else values
    columns["Sigma"] = [math.radians(value) for value in columns["Sigma"]]
    errors = {error: columns[symbol] for error, symbol in zip(ERRORS, SYMBOLS, strict=True)}
    try:
        torques = [row.torque for row in rows]
        return Deflections(torques, **errors, flank=columns["flank"], constant=constant or Misalignment())
    except InputError as error:
        raise ValueError(str(error)) from error


class Blank(Table):
    """Axial section of a member's blank."""

    pitch_angle: float = number("pitch angle", "deg", gt=0, lt=90)
    face_angle: float = number("face angle", "deg", gt=0, lt=95)
    root_angle: float = number("root angle", "deg", gt=-5, lt=90)
    pitch_apex_beyond_crossing_point: float = number("positive away from the teeth", "mm", default=0.0, gt=-500, lt=500)
    face_apex_beyond_crossing_point: float = number("positive away from the teeth", "mm", default=0.0, gt=-500, lt=500)
    root_apex_beyond_crossing_point: float = number("positive away from the teeth", "mm", default=0.0, gt=-500, lt=500)
    outer_cone_distance: float = number("pitch apex to heel", "mm", gt=1, lt=5000)
    face_width: float = number("toe to heel along the pitch cone", "mm", gt=0.5, lt=1000)
    clearance: float = number("root cone to the end of the flank, at right angles", "mm", default=0.0, ge=0, lt=50)
    front_angle: float | None = optional(
        "cone at right angles to the toe line; pitch_angle if left out", "deg", gt=-90, lt=180
    )
    back_angle: float | None = optional(
        "cone at right angles to the heel line; pitch_angle if left out", "deg", gt=-90, lt=180
    )

    def _check(self) -> None:
        if self.face_angle < self.root_angle:
            raise ValueError(
                f"face_angle = {self.face_angle}: must be at least root_angle = {self.root_angle} (degrees); "
                "both are the same for teeth of uniform depth"
            )
        if self.face_width >= self.outer_cone_distance:
            raise ValueError(
                f"face_width = {self.face_width}: must be smaller than outer_cone_distance = "
                f"{self.outer_cone_distance} (mm)"
            )


class Steel(Table):
    """Elastic constants of a member."""

    elastic_modulus: float = number("Young's modulus", "MPa", default=206000.0, gt=500, lt=1e6)
    poisson_ratio: float = number("Poisson's ratio", "1", default=0.3, ge=0, lt=0.5)


class MemberTable(Table):
    """A pinion or a gear."""

    number_of_teeth: int = number("number of teeth", "1", ge=3, le=500)
    mean_normal_circular_thickness: float | None = optional(
        "of the teeth at the mean point, on the pitch cone (s_mn of ISO 23509); from the cutter, or about the mate's "
        "slot, if no thickness is given",
        "mm",
        gt=0,
        lt=200,
    )
    mid_flank_normal_circular_thickness: float | None = optional(
        "instead of it: in the middle of the flank", "mm", gt=0, lt=200
    )
    blank: Blank | None = None
    concave: FlankSettings | None = None
    convex: FlankSettings | None = None
    material: Steel = Steel()

    @property
    def sides(self) -> list[str]:
        """Names of the flanks that it has."""
        return [side for side in ("concave", "convex") if getattr(self, side) is not None]

    def _check(self) -> None:
        if self.mean_normal_circular_thickness is not None and self.mid_flank_normal_circular_thickness is not None:
            raise ValueError(
                "mean_normal_circular_thickness and mid_flank_normal_circular_thickness: must not both be given"
            )


HandOfSpiral = Annotated[
    Literal["left", "right"], Field(description="of the pinion, the gear has the other; `[pinion]` only")
]


class PinionTable(MemberTable):
    """The pinion; its hand decides that of the gear."""

    hand_of_spiral: HandOfSpiral


class PairTable(Table):
    """Position of the axes."""

    shaft_angle: float = number("shaft angle", "deg", default=90.0, gt=5, lt=175)
    hypoid_offset: float = number(
        "zero for a spiral bevel pair; positive makes the pinion's spiral angle the larger one: a left-hand pinion "
        "below, a right-hand one above centre",
        "mm",
        default=0.0,
        gt=-500,
        lt=500,
    )


class ContactTable(Table):
    """Torques and resolution of the analysis; without torques the case takes those of ``usual_torques``."""

    torques: Annotated[tuple[float, ...], Field(strict=False, min_length=1, max_length=1000)] = number(
        "at the pinion; if left out, three in proportion to the size of the teeth, the middle one 40 N/mm² times face "
        "width, outer transverse module squared and half the pinion's teeth",
        "N m",
        default=(),
    )
    mesh_positions: int = number("pinion rotations in one pitch", "1", default=32, ge=3, le=2000)
    segments_per_line: int = number("segments per line", "1", default=31, ge=3, le=2000)
    edge_contact: bool = key(
        "[edges](../guides/finite_elements.md#edges) may touch beside the contact lines", default=True
    )
    lengthwise_nodes: int = number("grid nodes along the face", "1", default=31, ge=7, le=1001)
    profile_nodes: int = number("grid nodes up the profile", "1", default=21, ge=7, le=1001)
    separation: float = number(
        "gap at which an unloaded contact line ends; thickness of the marking compound",
        "um",
        default=6.0,
        ge=0.001,
        lt=1000,
    )

    def _check(self) -> None:
        for value in self.torques:
            if not TORQUE_MINIMUM <= value < TORQUE_LIMIT:
                raise ValueError(f"torques contains {value}: must be {torque_range()}")
            if self.torques.count(value) > 1:
                raise ValueError(f"torques contains {value} twice: give every torque once")


def _of_both_members(value: Any) -> Any:
    return (value, value) if isinstance(value, int | float) else value


Depth = Annotated[float, Field(gt=0, lt=1000)]
Depths = Annotated[tuple[Depth, Depth], BeforeValidator(_of_both_members), Field(strict=False)]


class WebTable(Table):
    """Web that carries a member's rim from its toe end inwards along the root cone, held at its bore."""

    bore_diameter: float = number("where the web ends and is held", "mm", gt=0, lt=5000)
    thickness: float | None = optional(
        "at right angles to the root cone, flush with the rim's bottom; the rim's if left out", "mm", gt=0, lt=1000
    )


SHELL_KEYS = frozenset({"plate", "profile_modes", "lengthwise_modes", "shear_factor", "root", "root_factor"})
BRICK_KEYS = frozenset({"rim_depth", "fineness", "neighbours", "pinion_web", "gear_web"})


class ComplianceTable(Table):
    """Models of the elastic tooth."""

    model: Literal["shell", "solid_shell", "fe"] = key(
        "of the [teeth](../guides/finite_elements.md); `plate` to `root_factor` go with `shell`, the rest with the "
        "others",
        default="solid_shell",
    )
    plate: Literal["even", "fitted"] = key(
        "`fitted` follows thickness over the height and fanning; `even` is the dissertation's", default="even"
    )
    profile_modes: int = number("shell modes up the profile", "1", default=5, ge=1, le=12)
    lengthwise_modes: int = number("shell modes along the face", "1", default=15, ge=1, le=60)
    shear_factor: float = number("shear correction", "1", default=1.0, gt=0, le=1)
    root: Literal["weber", "odonnell", "clamped"] = key("root springs; `clamped` for a rigid root", default="weber")
    root_factor: float = number("multiplies the root's flexibility", "1", default=1.0, gt=0, le=10)
    rim_depth: Depths | None = optional(
        "elastic body below the root, of both members or of pinion and gear; 1.2 times the tooth's height if left out",
        "mm",
        allowed="one or two, > 0, < 1000",
    )
    fineness: float = number("multiplies bricks and functions in every direction", "1", default=1.0, ge=0.2, le=4)

    neighbours: bool = key("teeth of a member share its body; otherwise each has a sector of its own", default=True)
    pinion_web: WebTable | None = None
    gear_web: WebTable | None = None

    def _check(self) -> None:
        foreign, wanted = (BRICK_KEYS, '"solid_shell" or "fe"') if self.model == "shell" else (SHELL_KEYS, '"shell"')
        chosen = "model" in self.model_fields_set
        for name in sorted(foreign & self.model_fields_set):
            value = getattr(self, name)
            # With the model itself given, a key of another model at its default is that of a table written in full.
            if not chosen or value != type(self).model_fields[name].default:
                note = f'it is "{self.model}"' + ("" if chosen else ", the default")
                raise ValueError(f"{name} = {written(value)}: must go with model = {wanted}; {note}")
        for name in ("pinion_web", "gear_web"):
            if getattr(self, name) is not None and not self.neighbours:
                raise ValueError(f"{name}: must go with neighbours = true: the web carries the body that teeth share")


class DrawingTable(Table):
    """Title block of the drawings, and tolerances to which the pair is made and mounted; for sheets and reports."""

    drawing_number: str = key("number of the drawing", default="", max_length=60)
    revision: str = key("revision of the drawing", default="", max_length=20)
    accuracy_grade: int | None = optional("of ISO 17485", "1", ge=2, le=11)
    pinion_mounting_distance: float | None = optional("crossing point to the mounting face", "mm", gt=0, lt=5000)
    gear_mounting_distance: float | None = optional("crossing point to the mounting face", "mm", gt=0, lt=5000)
    mounting_tolerance: float = number("± of either mounting distance", "mm", default=0.0, ge=0, lt=10)
    thickness_tolerance: float = number(
        "by which a tooth may be thinner than its mean normal circular thickness", "mm", default=0.0, ge=0, lt=10
    )


class TargetTable(Table):
    """Ease-off at the flank's edges that the pinion was fitted to, in the case's own misalignment.

    A record: the analysis uses the settings.
    """

    lengthwise_crowning: float = number("ease-off at toe and heel, mid height", "um", default=0.0, gt=-1e4, lt=1e4)
    profile_crowning: float = number("ease-off at root and tip, mid face", "um", default=0.0, gt=-1e4, lt=1e4)
    bias: float = number("(toe-tip + heel-root - toe-root - heel-tip) / 4", "um", default=0.0, gt=-1e4, lt=1e4)
    spiral_angle_error: float = number("half of heel less toe", "um", default=0.0, gt=-1e4, lt=1e4)
    pressure_angle_error: float = number("half of tip less root", "um", default=0.0, gt=-1e4, lt=1e4)


class TargetsTable(Table):
    """Targets of the two sides."""

    drive: TargetTable | None = None
    coast: TargetTable | None = None


#: Side of the pinion and of the gear by the flanks in mesh.
MATING_SIDES: Mapping[FlankName, tuple[Side, Side]] = {"drive": ("concave", "convex"), "coast": ("convex", "concave")}

FlankOfMember = Literal["pinion concave", "pinion convex", "gear concave", "gear convex"]


class Case(InputFile):
    """A whole case file.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case = read_case("nasa-12x36")
    >>> case.pair.shaft_angle, case.gear.number_of_teeth
    (90.0, 36)
    """

    easeoff_case: Literal[2] = key("version of the format; 1 is read, too")
    title: Title
    description: Description = ""
    corrected_flanks: Annotated[tuple[FlankOfMember, ...], Field(strict=False, max_length=4)] = key(
        "flanks whose settings `easeoff correct` made for the machine that cut the measured ones; on a machine without "
        "errors they cut others",
        default=(),
    )
    pair: PairTable
    blank_design: BlankDesignTable | None = None
    pinion: PinionTable
    gear: MemberTable
    misalignment: MisalignmentTable = MisalignmentTable()
    supports: SupportsTable | None = None
    contact: ContactTable = ContactTable()
    compliance: ComplianceTable = ComplianceTable()
    friction: FrictionTable | None = None
    target: TargetsTable = TargetsTable()
    drawing: DrawingTable = DrawingTable()
    load_cases: LoadCases = ()
    _supports_name: str = PrivateAttr(default="")

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy, with other values for some keys, which are not checked but for tables that must be tables.

        Raises
        ------
        InputError
            If a mapping is given for a table; says how to copy that.
        """
        for name, value in (update or {}).items():
            if isinstance(value, Mapping) and name in type(self).model_fields:
                inner = ", ".join(f"{inner_name!r}: ..." for inner_name in value)
                change = f"case.model_copy(update={{{name!r}: case.{name}.model_copy(update={{{inner}}})}})"
                raise InputError(f"{name} = {shown(dict(value))}: must be a table, not a dict; copy it too: {change}")
        return super().model_copy(update=update, deep=deep)

    @property
    def flanks(self) -> tuple[FlankName, ...]:
        """Flanks in mesh that both members have."""
        return tuple(
            each for each, (side, mate) in MATING_SIDES.items() if side in self.pinion.sides and mate in self.gear.sides
        )

    def _summary_rows(self) -> list[tuple[str, str]]:
        """The case in a few lines: names and words."""
        members = (("pinion", self.pinion), ("gear", self.gear))
        rows = [
            ("teeth", f"{self.pinion.number_of_teeth} x {self.gear.number_of_teeth}"),
            ("pinion", f"{self.pinion.hand_of_spiral}-hand"),
            ("hypoid offset", f"{self.pair.hypoid_offset:g} mm"),
            ("shaft angle", f"{self.pair.shaft_angle:g} °"),
            *((f"flanks of the {name}", ", ".join(member.sides)) for name, member in members),
            ("torques", f"{', '.join(f'{torque:g}' for torque in self.contact.torques)} N m at the pinion"),
            ("mesh positions", f"{self.contact.mesh_positions}"),
            ("elastic teeth", self.compliance.model),
            ("supports", self.supports_name),
        ]
        return [(name, words) for name, words in rows if words]

    def __repr__(self) -> str:
        """The case in a few lines; ``case.model_dump()`` has all of it."""
        lines = [f"  {name:<22}{printable(words)}" for name, words in self._summary_rows()]
        return "\n".join([f"Case: {printable(self.title)}", *lines]).replace(" °", " deg")

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        """The case in a few lines, for a notebook."""
        rows = self._summary_rows()
        cells = "".join(f"<tr><td>{name}</td><td>{html.escape(words)}</td></tr>" for name, words in rows)
        return f"<h4>{html.escape(self.title)}</h4><table>{cells}</table>"

    @property
    def supports_name(self) -> str:
        """Name of the file of the supports, or that they stand in the case; empty if there are none."""
        return "" if self.supports is None else self._supports_name or "of the case"

    def _check(self) -> None:
        named_load_cases(self.load_cases)
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
        if self.blank_design is not None:
            teeth = self.pinion.number_of_teeth, self.gear.number_of_teeth
            basic = self.blank_design.completed(teeth, self.pair.shaft_angle, self.pair.hypoid_offset)
            object.__setattr__(self, "blank_design", basic)
        if not self.contact.torques:
            torques = usual_torques(*self._size_of_the_teeth(), self.pinion.number_of_teeth)
            object.__setattr__(self, "contact", self.contact.model_copy(update={"torques": torques}))
        if not self.flanks:
            raise ValueError(
                "no flanks to mesh: give [pinion.concave] and [gear.convex] for the drive side, or [pinion.convex] and "
                "[gear.concave] for the coast side"
            )

    def _size_of_the_teeth(self) -> tuple[float, float]:
        """Outer transverse module and face width of the gear [mm]."""
        blank, basic, teeth = self.gear.blank, self.blank_design, self.gear.number_of_teeth
        if blank is not None:
            diameter = 2.0 * blank.outer_cone_distance * math.sin(math.radians(blank.pitch_angle))
            return diameter / teeth, blank.face_width
        assert basic is not None  # one of both is there
        return basic.tooth_size((self.pinion.number_of_teeth, teeth))
