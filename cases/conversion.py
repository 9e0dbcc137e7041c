"""From a checked case to the objects of geometry and contact: degrees to radians, flanks to generating surfaces."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, get_args

from ..core.checks import instance, one_of, two_whole
from ..core.errors import InputError, errors_about
from ..geometry.cutting.blade import Blade, BladeSide, Relief
from ..geometry.cutting.generating_surface import GeneratingSurface, Hand
from ..geometry.cutting.machine import MachineSettings
from ..geometry.cutting.named_settings import MACHINE_STEPS, MachineResolution
from ..geometry.flanks.blank_section import BlankSection
from ..geometry.pair.assembly import Assembly, Misalignment
from ..geometry.pair.gear_pair import FlankName, GearPair, Member
from ..geometry.pair.member_names import MemberName
from ..geometry.pair.tooth_thickness import mean_cone_distances, mid_flank_thickness
from .deflections import Deflections, misalignment_at
from .schema.blank_design_table import BlankDesignTable
from .schema.case_schema import (
    MATING_SIDES,
    Blank,
    Case,
    MemberTable,
    MisalignmentTable,
    PairTable,
    Side,
    TargetTable,
    WebTable,
    deflections_of,
)
from .schema.cutting_table import ANGULAR_MOTIONS, RELIEFS, FlankSettings, Machine, Motions, blade_field, polynomial
from .schema.design_schema import CutterStepsTable, Design, LimitsTable, ResolutionTable
from .schema.schema_table import in_radians

if TYPE_CHECKING:  # what a design or elastic teeth need is imported for them
    from ..contact.compliance import Material
    from ..contact.compliance.elastic_model import ElasticModel
    from ..contact.compliance.finite_elements.finite_element_tooth import FiniteElementTooth
    from ..geometry.design.blank import BlankDesign, BlankDimensions
    from ..geometry.design.closest_fit import StandardSteps
    from ..geometry.design.pinion_method import SettingLimits
    from ..geometry.design.synthesis import EaseOffTarget

APEX_SUFFIX = "_beyond_crossing_point"  # of keys of a blank, not of the fields of geometry


def section(blank: Blank) -> BlankSection:
    """Axial section of a blank."""
    return BlankSection(**{key.removesuffix(APEX_SUFFIX): value for key, value in in_radians(blank).items()})


def blank_design(table: BlankDesignTable, teeth: tuple[int, int], pair: PairTable) -> BlankDesign:
    """Basic data of a pair in rad, with teeth of pinion and gear, offset and shaft angle of other tables."""
    whole = table.completed(teeth, pair.shaft_angle, pair.hypoid_offset)
    with errors_about("[blank_design]"):
        return whole.basic_data(teeth, pair.shaft_angle, pair.hypoid_offset)


def designed_blanks(table: BlankDesignTable, teeth: tuple[int, int], pair: PairTable) -> BlankDimensions:
    """Blanks of both members from basic data. Raises as ``blank_design``, and GeometryError if no blanks follow.

    Examples
    --------
    >>> from easeoff.cases import read_design
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> blanks.gear.pitch_angle > blanks.pinion.pitch_angle
    True
    """
    from ..geometry.design.blank import blank_dimensions

    instance("table", table, BlankDesignTable)
    instance("pair", pair, PairTable)
    table = table.completed(two_whole("teeth", teeth, 1), pair.shaft_angle, pair.hypoid_offset)
    design = blank_design(table, teeth, pair)
    with errors_about("[blank_design]"):
        blank = blank_dimensions(design)
        difference, text = spiral_angle_difference(table, blank)
        if abs(difference) > LARGEST_SPIRAL_DIFFERENCE:
            raise InputError(f"{text}; change or leave out one of them")
    return blank


#: [deg] between the spiral angles that a drawing gives of pinion and gear: a larger one is refused, one is told.
LARGEST_SPIRAL_DIFFERENCE, TOLD_SPIRAL_DIFFERENCE = 8.0, 0.1


def spiral_angle_difference(table: BlankDesignTable, blank: BlankDimensions) -> tuple[float, str]:
    """Spiral angle that basic data give of the member whose angle the method does not take, less that of its blank.

    The difference [deg], zero if only one is given, and a text that tells both.
    """
    name, other = table.spiral_angles
    given = getattr(table, other)
    if given is None:
        return 0.0, ""
    found = math.degrees(getattr(blank, other.partition("_")[0]).mean_spiral_angle)
    taken = f"method {table.method} gives {found:.1f} degrees with {name} = {getattr(table, name):g}"
    apart = f"{abs(given - found):.1f} degrees {'less' if given > found else 'more'}"
    return given - found, f"{other} = {given:g}: {taken}, {apart}"


def sections(case: Case) -> tuple[BlankSection, BlankSection]:
    """Axial sections of pinion and gear, from their blanks or from the basic data of the pair."""
    if case.blank_design is not None:
        blanks = designed_blanks(case.blank_design, (case.pinion.number_of_teeth, case.gear.number_of_teeth), case.pair)
        from ..geometry.design.blank import blank_section

        return blank_section(blanks.pinion, blanks.clearance), blank_section(blanks.gear, blanks.clearance)
    assert case.pinion.blank is not None  # the schema sees to it
    assert case.gear.blank is not None
    return section(case.pinion.blank), section(case.gear.blank)


def machine_settings(machine: Machine, indexing_ratio: float = 0.0) -> MachineSettings:
    """Machine settings in mm and rad; modified roll as polynomial coefficients C = 2C / 2, D = 6D / 6, ..."""
    settings = {key: value for key, value in in_radians(machine).items() if key in MACHINE_STEPS}
    if machine.radial_distance is None or machine.cradle_angle is None:
        horizontal, vertical = machine.horizontal_distance or 0.0, machine.vertical_distance or 0.0
        settings["radial_distance"] = math.hypot(horizontal, vertical)
        settings["cradle_angle"] = math.atan2(vertical, horizontal)
    roll = list(polynomial(machine.modified_roll, 2))
    while roll and roll[-1] == 0.0:
        roll.pop()
    motions = _motions(machine.motions)
    return MachineSettings(**settings, modified_roll=tuple(roll), indexing_ratio=indexing_ratio, motions=motions)


def _motions(motions: Motions) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Polynomial coefficients of the settings that move, angles in rad."""
    units = {name: math.radians(1.0) if name in ANGULAR_MOTIONS else 1.0 for name, _ in motions}
    return tuple((name, polynomial(values, unit=units[name])) for name, values in motions if any(values))


def generating_surface(
    settings: FlankSettings, side: Side, hand: Hand, teeth: int, *, pinion: bool
) -> GeneratingSurface:
    """Generating surface of one flank; the concave one is cut by an outside blade."""
    cutter = in_radians(settings.cutter)
    groups = cutter.pop("number_of_blade_groups")
    reliefs: dict[str, Any] = {}
    for name in RELIEFS:
        depth, angle, radius = (cutter.pop(f"{name}_{what}") for what in ("depth", "angle", "radius"))
        reliefs[name] = None if depth is None else Relief(depth, angle, radius)
    blade_side: BladeSide = "outside" if side == "concave" else "inside"
    blade = Blade(**{blade_field(key): value for key, value in cutter.items()}, side=blade_side, **reliefs)
    return GeneratingSurface(blade, machine_settings(settings.machine, groups / teeth), hand, -1 if pinion else 1)


def _member(table: MemberTable, blank: BlankSection, loaded: Side, hand: Hand, *, pinion: bool) -> Member:
    sides: tuple[Side, Side] = ("concave", "convex") if loaded == "concave" else ("convex", "concave")
    first, opposite = (
        None if settings is None else generating_surface(settings, side, hand, table.number_of_teeth, pinion=pinion)
        for side, settings in zip(sides, (getattr(table, side) for side in sides), strict=True)
    )
    assert first is not None  # ``gear_pair`` sees to it
    return Member(table.number_of_teeth, blank, first, opposite, table.mid_flank_normal_circular_thickness)


def misalignment(table: MisalignmentTable) -> Misalignment | Deflections:
    """Assembly errors in mm and rad, over the torque if the table has deflections."""
    errors = Misalignment(table.offset, table.pinion_axial, table.gear_axial, math.radians(table.shaft_angle))
    return deflections_of(table.deflections, errors) if table.deflections else errors


def ease_off_target(table: TargetTable) -> EaseOffTarget:
    """Wanted ease-off in mm."""
    from ..geometry.design.synthesis import EaseOffTarget

    return EaseOffTarget(**{key: 1e-3 * value for key, value in table.model_dump().items()})


def setting_limits(table: LimitsTable) -> SettingLimits:
    """Limits of the settings of a designed pinion, in mm and rad."""
    from ..geometry.design.pinion_method import SettingLimits

    values = in_radians(table)
    low, high = (values.pop(f"{end}_blade_pressure_angle") for end in ("smallest", "largest"))
    return SettingLimits(**values, blade_pressure_angle=(low, high))


def standard_steps(table: CutterStepsTable) -> StandardSteps:
    """Standard steps of a design's cutters, in mm and rad."""
    from ..geometry.design.closest_fit import StandardSteps

    return StandardSteps(math.radians(table.blade_angle), table.point_width, table.edge_radius)


def machine_resolution(table: ResolutionTable) -> MachineResolution:
    """Resolution of a design's machine, in mm and degrees."""
    return MachineResolution(**table.model_dump())


def materials(case: Case) -> tuple[Material, Material]:
    """Materials of pinion and gear."""
    from ..contact.compliance import Material

    pinion, gear = (Material(m.material.elastic_modulus, m.material.poisson_ratio) for m in (case.pinion, case.gear))
    return pinion, gear


def finite_elements(
    case: Case, pair: GearPair, stage: Callable[[str], None] | None = None
) -> tuple[FiniteElementTooth, FiniteElementTooth] | None:
    """Teeth by finite elements or as solid shells, ``None`` for plain shells; ``stage`` is told of each."""
    table = case.compliance
    if table.model == "shell":
        return None
    from ..contact.compliance.finite_elements.finite_element_tooth import finite_element_tooth, solid_shell_tooth
    from ..contact.compliance.finite_elements.tooth_ring import ToothBody
    from ..geometry.tooth.tooth_lattice import Web

    make = finite_element_tooth if table.model == "fe" else solid_shell_tooth
    what = "finite elements" if table.model == "fe" else "solid shell"

    def tooth(member: MemberName, material: Material, rim: float | None, web: WebTable | None) -> FiniteElementTooth:
        if stage is not None:
            stage(f"{what} of the {member}")
        body = ToothBody(rim, table.neighbours, None if web is None else Web(web.bore_diameter, web.thickness))
        return make(pair, member, material, table.fineness, body)

    (pinion, gear), (of_pinion, of_gear) = materials(case), table.rim_depth or (None, None)
    return tooth("pinion", pinion, of_pinion, table.pinion_web), tooth("gear", gear, of_gear, table.gear_web)


def elastic_model(case: Case, teeth: tuple[FiniteElementTooth, FiniteElementTooth] | None) -> ElasticModel:
    """Elastic model of a case with the teeth from ``finite_elements``, or with shells if they are ``None``."""
    from ..contact.compliance import ElasticFoundation
    from ..contact.compliance.elastic_model import ElasticModel

    table = case.compliance
    pinion, gear = materials(case)
    foundation = None if table.root == "clamped" else ElasticFoundation(table.root, table.root_factor)
    return ElasticModel(
        pinion,
        gear,
        modes=(table.profile_modes, table.lengthwise_modes),
        shear_factor=table.shear_factor,
        plate=table.plate,
        foundation=foundation,
        condensed=None if teeth is None else (teeth[0].flank, teeth[1].flank),
    )


def given_pair(case: Case) -> GearPair:
    """Gear pair of the drive side, or of the coast side where the case has that alone."""
    return gear_pair(case, case.flanks[0])


def case_assembly(case: Case | Design, errors: Misalignment | None = None) -> Assembly:
    """Assembly of the pair of a case or design, with errors or without."""
    return Assembly(
        case.pinion.number_of_teeth,
        case.gear.number_of_teeth,
        case.pinion.hand_of_spiral,
        math.radians(case.pair.shaft_angle),
        case.pair.hypoid_offset,
        errors or Misalignment(),
    )


def gear_pair(case: Case, flank: FlankName = "drive") -> GearPair:
    """The gear pair of a case, seen from one pair of flanks.

    Parameters
    ----------
    case
        A checked case.
    flank
        ``drive``: pinion concave with gear convex; ``coast``: the other two.

    Raises
    ------
    InputError
        If the case does not describe these flanks.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> pair = gear_pair(read_case("nasa-12x36"), "coast")
    >>> pair.pinion.loaded.blade.side  # the inside blade cuts the convex flank
    'inside'
    """
    instance("case", case, Case)
    one_of("flank", flank, get_args(FlankName))
    pinion_side, gear_side = MATING_SIDES[flank]
    for name, side, table in (("pinion", pinion_side, case.pinion), ("gear", gear_side, case.gear)):
        if getattr(table, side) is None:
            raise InputError(f"the {flank} side needs [{name}.{side}], which the case {case.title!r} does not have")
    assembly = case_assembly(case, misalignment_at(misalignment(case.misalignment), 0.0, flank))
    pinion_section, gear_section = sections(case)
    pair = GearPair(
        pinion=_member(case.pinion, pinion_section, pinion_side, assembly.pinion_hand, pinion=True),
        gear=_member(case.gear, gear_section, gear_side, assembly.gear_hand, pinion=False),
        assembly=assembly,
    )
    given = [table.mean_normal_circular_thickness for table in (case.pinion, case.gear)]
    if given == [None, None]:
        return pair
    members = [
        member
        if thickness is None
        else replace(member, mean_thickness=mid_flank_thickness(member, thickness, distance))
        for member, thickness, distance in zip((pair.pinion, pair.gear), given, mean_cone_distances(pair), strict=True)
    ]
    return replace(pair, pinion=members[0], gear=members[1])
