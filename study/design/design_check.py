"""Check of a designed pair: residuals, undercut, blade tips, top lands and whole teeth, with warnings.

Warnings are those of a pair as its blanks and settings cut it: undercut, blade tips off the root, thin tips, narrow
slots. Top lands, slots and fillets are by the formulas of AGMA 929-B22, and on the generated teeth. Of a doubtful
design a sentence each says what in its basic data to look at.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ...cases.conversion import (
    TOLD_SPIRAL_DIFFERENCE,
    blank_design,
    ease_off_target,
    gear_pair,
    setting_limits,
    spiral_angle_difference,
)
from ...cases.schema.case_schema import Case
from ...cases.schema.design_schema import FORMATE_RATIO, Design
from ...contact.compliance.finite_elements.finite_element_tooth import require_solid_shell
from ...contact.evaluation.flank_region import flank_share
from ...core.arrays import Array, record
from ...core.errors import EaseoffError, GeometryError, InputError
from ...geometry.cutting.generating_surface import GeneratingSurface
from ...geometry.design import slot_width
from ...geometry.design.blank import BlankDesign, BlankDimensions, blank_dimensions
from ...geometry.design.closest_fit import BLADE_ANGLES, require_usable, residual_limits
from ...geometry.design.iso23509.usual_proportions import DefaultValue
from ...geometry.design.pair_design import BOTH_MEMBERS, SIDES, PairDesign
from ...geometry.design.pinion_method import ADVICE, at_limit
from ...geometry.design.slot_width import EdgeRadiusLimits, SlotWidths, ToothLine, TopLands
from ...geometry.design.tooth_proportions import FILLET_MUTILATION, ToothProportions, measured_proportions
from ...geometry.flanks.blank_section import BlankSection
from ...geometry.flanks.flank import NodeStatus
from ...geometry.pair.ease_off import exact_ease_off
from ...geometry.pair.gear_pair import MEMBERS, FlankName, GearPair, bodies, grid
from ...geometry.pair.tooth_thickness import contradictions, unmet_tips
from ...geometry.tooth.tooth_flanks import MemberName
from ...geometry.tooth.tooth_surface import LandWidths, contact_heights, land_widths, tooth_side
from .rounded_settings import without_rotation

CUTTER_RADIUS_RATIO = 1.5  # over the gear's mean cone distance; pairs in use lie between 0.7 and 1.2
SMALL_CUTTER_RATIO = 0.55
FACE_WIDTH_SHARE = 0.315  # of the outer cone distance; 0.3 is the most by ISO 23509, annex B, without an offset
SPIRAL_ANGLES = {"pinion": 60.0, "gear": 45.0}  # largest customary [deg]
LEAST_PRESSURE_ANGLE = 10.0  # generated [deg]; next to it a slot has parallel walls
LEAST_CROWNING = 1.0  # [um]; a smaller one looks like mm


def blank_or_none(basic_data: BlankDesign) -> BlankDimensions | None:
    """Dimensions of the blanks of a pair; ``None`` where there are none."""
    with suppress(EaseoffError):
        return blank_dimensions(basic_data)
    return None


def limit_pressure_angle_advice(basic_data: BlankDesign, blank: BlankDimensions | None) -> list[str]:
    """Advice, a line each, on what the limit pressure angle of a hypoid pair makes of its pressure angles."""
    if basic_data.hypoid_offset == 0.0 or blank is None:
        return []
    limit = math.degrees(blank.limit_pressure_angle)
    if not basic_data.limit_pressure_angle_influence > 0.0:
        return [
            f"limit_pressure_angle_influence = 0 while the limit pressure angle of this offset is {limit:.1f} degrees: "
            "1 gives drive and coast flanks pressure angles that allow for it"
        ]
    generated = {"drive": blank.generated_drive_pressure_angle, "coast": blank.generated_coast_pressure_angle}
    return [
        f"the generated {side} pressure angle of {math.degrees(angle):.1f} degrees is small, as the limit pressure "
        f"angle of this offset is {limit:.1f} degrees: a smaller hypoid_offset or a larger "
        f"nominal_{side}_pressure_angle helps"
        for side, angle in generated.items()
        if math.degrees(angle) < LEAST_PRESSURE_ANGLE
    ]


def formate_advice(design: Design) -> list[str]:
    """Advice, in one line or none, on a Formate gear with so small a pitch angle that generation serves it better."""
    if design.gear.generation == "generated" or design.usual_generation == "formate":
        return []
    return [
        "the gear's pitch angle is small for a gear cut without generation, less than a ratio of "
        f'{FORMATE_RATIO:g} gives at 90 degrees: generation = "generated" in [gear] helps'
    ]


def proportion_warnings(p: ToothProportions) -> Iterator[str]:
    """Warnings of proportions out of the customary range, each with its value and the range."""
    width, outer, mean = p.face_width[1], p.outer_cone_distance[1], p.mean_cone_distance[1]
    if (share := width / outer) > FACE_WIDTH_SHARE:
        yield (
            f"gear_face_width = {width:g} mm is {100.0 * share:.0f} % of the outer cone distance of {outer:.0f} mm: at "
            "most 30 % are usual"
        )
    spirals = {"pinion": p.gear_spiral_angle + p.offset_angle, "gear": p.gear_spiral_angle}
    for name, largest in SPIRAL_ANGLES.items():
        if (angle := math.degrees(spirals[name])) > largest:
            yield f"the {name}'s mean spiral angle of {angle:.1f} degrees is large: up to {largest:.0f} are usual"
    ratio = p.cutter_radius / mean
    if not SMALL_CUTTER_RATIO <= ratio < CUTTER_RADIUS_RATIO:
        yield (
            f"cutter_radius = {p.cutter_radius:g} mm is {ratio:.2f} times the gear's mean cone distance of "
            f"{mean:.0f} mm: 0.7 to 1.2 are usual" + (", the radius is meant, not the diameter?" if ratio > 1.0 else "")
        )


def unusual_blades(pairs: Mapping[FlankName, GearPair]) -> Iterator[tuple[FlankName, str, float, str]]:
    """Side, member, blade angle [deg] and a sentence of every blade out of the customary range."""
    least, largest = map(math.degrees, BLADE_ANGLES)
    for side, pair in pairs.items():
        for name in MEMBERS:
            angle = math.degrees(getattr(pair, name).loaded.blade.pressure_angle)
            if not least <= round(angle, 6) <= largest:
                said = f"{side}: the {name}'s blade has an angle of {angle:.1f} degrees: {least:.0f} to {largest:.0f}"
                yield side, name, angle, f"{said} are usual"


def blade_warnings(design: Design, designed: PairDesign) -> Iterator[str]:
    """Warnings of blade angles out of the customary range, with what helps."""
    least, largest = map(math.degrees, BLADE_ANGLES)
    for side, name, angle, said in unusual_blades({side: designed.pair(side) for side in SIDES}):
        change = f"a {'larger' if angle < least else 'smaller'} nominal_{side}_pressure_angle"
        if name == "pinion":
            bound = f"smallest_blade_pressure_angle = {least:g} or largest_blade_pressure_angle = {largest:g}"
            other = ' with method = "tilt"' if design.pinion.method == "closest_fit" else ""
            change = f"{bound} in [pinion.limits]{other}"
        yield f"{said}; {change} helps"


def failure_advice(design: Design, basic_data: BlankDesign) -> list[str]:
    """Advice, a line each, on what may keep a design from being made."""
    blank = blank_or_none(basic_data)
    advice = [*formate_advice(design), *limit_pressure_angle_advice(basic_data, blank)]
    unusual = [] if blank is None else proportion_warnings(_proportions(design, blank))
    return [*advice, *unusual, *offset_advice(design, basic_data)]


def small_target_advice(design: Design) -> list[str]:
    """Advice on crownings of the target that seem to be given in mm."""
    return [
        f"target.{side}.{key} = {value:g}: next to no crowning; um are meant, not mm?"
        for side in ("drive", "coast")
        for key in ("lengthwise_crowning", "profile_crowning")
        if 0.0 < abs(value := getattr(getattr(design.target, side), key)) < LEAST_CROWNING
    ]


def offset_advice(design: Design, basic_data: BlankDesign) -> list[str]:
    """Advice, in one line or none, on what a negative offset means."""
    if basic_data.hypoid_offset >= 0.0:
        return []
    hand = design.pinion.hand_of_spiral
    place = "above" if hand == "left" else "below"
    return [
        f"hypoid_offset = {basic_data.hypoid_offset:g} mm is negative: the {hand}-hand pinion lies {place} centre and "
        "has the smaller spiral angle; the usual hypoid pair has a positive one"
    ]


TOE_HALF = np.linspace(0.0, 0.5, 6)
NO_VALUE = "-"


@record(frozen=True)
class ToothSpaces:
    """Spaces of a pair by the formulas of AGMA 929-B22 and on the generated teeth; arrays have the pinion first."""

    slots: SlotWidths
    lands: TopLands
    limits: EdgeRadiusLimits
    measured: tuple[LandWidths, LandWidths]  # of the generated teeth at toe, mean point and heel
    edge_radius: Array  # of the blades, the larger one of each member (2) [mm]
    #: fillets to the path of the mate's tip, least in the toe half (2, 2) [mm], side of the concave pinion first; NaN
    #: where the teeth have no such place
    fillet_clearance: Array

    def rows(self) -> Iterator[tuple[str, ...]]:
        """Table: quantity, by the formulas, on the generated teeth, their difference; toe / mean / heel [mm].

        The blade tips' heights are those of the path that they cut on the whole tooth, in their deepest positions.
        """
        yield "toe / mean / heel [mm]", "AGMA 929-B22", "generated teeth", "difference"
        for k, name in enumerate(MEMBERS):
            for label, formula, teeth in (
                ("top land", self.lands.width[k], self.measured[k].top_land),
                ("slot width", self.slots.width[k], self.measured[k].slot),
            ):
                yield f"{name} {label}", _texts(formula), _texts(teeth), _texts(teeth - formula, sign=True)
        clearance = self.limits.fillet_clearance(self.edge_radius)
        for k, name in enumerate(MEMBERS):
            for j, which in enumerate(("drive", "coast")):
                pair = clearance[k, j : j + 1], self.fillet_clearance[k, j : j + 1]
                apart = _texts(pair[1] - pair[0], sign=True)
                yield f"{name} fillet clearance at the toe, {which}", *map(_texts, pair), apart
        for k, name in enumerate(MEMBERS):
            for j, which in enumerate(("concave", "convex") if k == 0 else ("convex", "concave")):
                path = _texts(self.measured[k].root_line[j], sign=True)
                yield f"{name} {which}: blade tip above the root cone", NO_VALUE, path, NO_VALUE
        for k, name in enumerate(MEMBERS):
            least, most = self.blade_point(k)
            yield f"{name} blade point, least / greatest", _texts(np.array([least, most])), NO_VALUE, NO_VALUE
            limit = f"{self.limits.largest[k]:.3f} ({self.limits.governing[k]})"
            yield f"{name} edge radius: greatest; as cut", limit, f"{self.edge_radius[k]:.3f}", NO_VALUE

    def blade_point(self, member: int) -> tuple[float, float]:
        """Least blade point without a fin in the widest slot, greatest in the narrowest [mm]; pinion 0, gear 1."""
        return float(self.slots.greatest[member]) / 2.0 + slot_width.BLADE_OVERLAP, float(self.slots.least[member])

    def warnings(self) -> Iterator[str]:
        """Warnings of teeth that cannot be cut as they are, a sentence each."""
        module = self.slots.line.proportions.mean_normal_module
        for k, name in enumerate(MEMBERS):
            least, most = self.blade_point(k)
            even = self._even_slot(k) if self.slots.width[k, 1] > NARROW_SLOT * module else TOOTH_ADVICE[""][k]
            if not most > 0.0:
                none = f"the {name}'s slot has no width at its narrowest end ({most:.2f} mm)"
                yield f"{none}: no blade enters it; {even} helps"
            elif least > most:
                yield (
                    f"the {name}'s slot narrows from {self.slots.greatest[k]:.2f} to {most:.2f} mm: a blade that fits "
                    f"the narrow end leaves a fin at the wide one; {self._even_slot(k)} helps"
                )
            elif most < NARROW_SLOT * module:
                yield (
                    f"the {name}'s slot is {most:.2f} mm wide at its narrowest end, for a module of {module:.2f} mm: "
                    f"blades of so narrow a point are weak; {even} helps"
                )
            if (deepest := float(np.nanmin(self.fillet_clearance[k], initial=np.inf))) < -FILLET_MUTILATION:
                # Higher than the edge of the blade leaves it, the fillet is one of an undercut flank.
                advice = "a smaller tool_edge_radius or a larger clearance_factor"
                advice = TOOTH_ADVICE["undercut"][k] if -deepest > float(self.edge_radius[k]) else advice
                yield f"the {name}'s fillet reaches {-deepest:.2f} mm into the path of the mate's tip: {advice} helps"

    def _even_slot(self, member: int) -> str:
        """Change of basic data that makes the ends of a slot more equal (ISO 23509:2016, C.5)."""
        toe, _, heel = self.slots.width[member]
        if toe > heel:
            return "a larger cutter_radius"
        smaller, hobbed = "a smaller cutter_radius", self.slots.line.proportions.number_of_blade_groups
        return smaller if hobbed else f'depth_taper = "constant_slot_width" or {smaller}'


def tooth_spaces(drive: GearPair, coast: GearPair, proportions: ToothProportions) -> ToothSpaces:
    """Spaces of a pair from both sides; GeometryError if a cutter does not reach a tooth or an end of the face."""
    slots = SlotWidths(ToothLine(proportions))
    members = drive.pinion, drive.gear
    places = [_places(proportions, k) for k in (0, 1)]
    measured = tuple(land_widths(drive, name, t) for name, t in zip(MEMBERS, places, strict=True))
    clearance = np.stack([_fillet_clearance(pair) for pair in (drive, coast)], axis=1)
    edges = [max(m.loaded.blade.edge_radius, m.from_opposite.loaded.blade.edge_radius) for m in members]
    limits, measured_pair = EdgeRadiusLimits(slots), (measured[0], measured[1])
    return ToothSpaces(slots, TopLands(slots), limits, measured_pair, np.array(edges), clearance)


def _places(proportions: ToothProportions, member: int) -> Array:
    """Lengthwise fractions of toe, mean point and heel (3)."""
    outer, width = proportions.outer_cone_distance[member], proportions.face_width[member]
    return np.array([0.0, 1.0 - (outer - proportions.mean_cone_distance[member]) / width, 1.0])


def _fillet_clearance(pair: GearPair) -> Array:
    """Least height of the contact above the end of the fillet, in the half at the toe, of both members (2) [mm]."""
    clearances = []
    for member, heights, along in zip((pair.pinion, pair.gear), *contact_heights(pair, TOE_HALF), strict=True):
        known = np.isfinite(heights) & (along >= 0.0) & (along <= 1.0)
        ends = _fillet_ends(member.loaded, member.section, along[known])
        clearances.append(float(np.min(heights[known] - ends)) if ends.size else float("nan"))
    return np.array(clearances)


def _fillet_ends(surface: GeneratingSurface, section: BlankSection, lengthwise: Array) -> Array:
    """Heights above the root cone at which a fillet ends (n) [mm]; none if the flank has no whole fillet there."""
    if lengthwise.size >= 3:  # what the search along the face takes
        with suppress(GeometryError):
            points = tooth_side(surface, section, tuple(lengthwise.tolist()), 5, 2).fillet[:, :, -1]
            return section.height_above_root(points[2], np.hypot(points[0], points[1]))
    return np.zeros(0)


def _texts(values: Array, *, sign: bool = False) -> str:
    return " / ".join(NO_VALUE if not np.isfinite(v) else f"{v:+.3f}" if sign else f"{v:.3f}" for v in values)


TOP_LAND_LIMIT = NARROW_SLOT = 0.2  # over the module; a smaller top land or slot is narrow


def case_warnings(case: Case) -> tuple[ToothSpaces | None, tuple[str, ...]]:
    """Top lands, slots and fillets of a case, ``None`` if not measurable, and warnings, a sentence each."""
    try:
        drive, coast = (gear_pair(case, side) for side in SIDES)
        proportions = measured_proportions(drive)
    except (InputError, GeometryError) as error:
        return None, (f"the teeth are not checked: {error}",)
    warnings = [*contradictions(drive), *narrow_top_lands(drive, proportions.mean_normal_module)]
    warnings += [text for _, text in unfinished_teeth(drive, case.compliance.model)]
    pairs = dict(zip(SIDES, (drive, coast), strict=True))
    warnings += [*proportion_warnings(proportions), *(said for *_, said in unusual_blades(pairs))]
    for side, pair in pairs.items():
        warnings += [f"{side}: {text}" for _, text in missing_flanks(unmet_tips(pair))]
    try:
        spaces = tooth_spaces(drive, coast, proportions)
    except GeometryError as error:
        return None, (*warnings, f"top lands, slots and fillets are not checked: {error}")
    for name, lands in zip(MEMBERS, spaces.measured, strict=True):
        for side, gap in zip(SIDES, lands.root_line, strict=True):
            warnings += [f"{side}: {text}" for text in off_the_root(name, gap, proportions.clearance)]
    return spaces, (*warnings, *spaces.warnings())


def unusual_set_ups(case: Case) -> tuple[str, ...]:
    """Flanks of the pinion in a set-up that no method of a design for the shop makes, in one line or none.

    Fixed setting and modified roll have no tilt, tilt has no modified roll, completing has both on one machine for both
    flanks. The closest fit and freed settings may give each flank a tilt and a modified roll of its own.
    """
    concave, convex = case.pinion.concave, case.pinion.convex
    if concave is None or convex is None or concave.machine == convex.machine:
        return ()
    names = [
        name
        for name, machine in (("concave", concave.machine), ("convex", convex.machine))
        if machine.cutter_tilt and (any(machine.modified_roll) or any(machine.motions.model_dump().values()))
    ]
    if not names:
        return ()
    words = ("flanks have", "set-ups of their own") if len(names) > 1 else ("flank has", "a set-up of its own")
    return (
        f"Note: the pinion's {' and '.join(names)} {words[0]} tilt and modified roll in {words[1]}, as the closest fit "
        "gives for analysis; the methods of the shop (fixed_setting, modified_roll, tilt, completing) make none such",
    )


def missing_flanks(unmet: tuple[float, float]) -> Iterator[tuple[MemberName, str]]:
    """Members whose flank ends before the mate's tip has passed it, by ``unmet_tips``, each with a warning."""
    for name, mate, share in zip(reversed(BOTH_MEMBERS), BOTH_MEMBERS, unmet, strict=True):
        if not share <= slot_width.UNMET_LIMIT:
            where = f"the {mate}'s tip meets no flank on {100 * share:.0f} % of its length"
            yield name, f"{where}: there the {name}'s root is undercut, or its fillet reaches too high"


def off_the_root(member: str, gap: Array, clearance: float, advice: str = "") -> Iterator[str]:
    """Warnings of blade tips off the root cone by their gap (3) [mm] at toe, middle and heel, or without a root."""
    roots = np.isfinite(gap)
    if np.any(np.abs(gap[roots]) > clearance):
        yield (
            f"the {member}'s blade tips deviate up to {np.abs(gap[roots]).max():.2f} mm from its root cone, more than "
            f"the clearance of {clearance:.2f} mm{advice}"
        )
    if not np.all(roots):
        places = " and ".join(name for name, known in zip(("toe", "middle", "heel"), roots, strict=True) if not known)
        yield f"the {member} has no flank near its root at the {places}: it is undercut or not reached"


def narrow_top_lands(pair: GearPair, module: float) -> Iterator[str]:
    """Warnings of top lands narrow for the mean normal module [mm], or of members with no tooth between flanks."""
    try:
        both = bodies(pair)
    except GeometryError as error:
        yield str(error)
        return
    for name, body in zip(MEMBERS, both, strict=True):
        for end, thickness in zip(("toe", "heel"), body.thickness[:, 1], strict=True):
            if not thickness >= TOP_LAND_LIMIT * module:
                yield f"the {name}'s tooth has a narrow top land at the {end}: {thickness:.2f} mm"


def unfinished_teeth(
    pair: GearPair, model: str, whole: Collection[MemberName] = ()
) -> Iterator[tuple[MemberName, str]]:
    """Members, but those known to have one, without the whole tooth that a model of elastic teeth needs, and why."""
    for name in (name for name in BOTH_MEMBERS if name not in whole):
        try:
            if model == "shell":
                slot_width.require_whole_tooth(pair, name)
            else:
                require_elastic_tooth(pair, name)
        except GeometryError as error:
            yield name, str(error) if f"the {name}'s" in str(error) else f"the {name} has no whole tooth: {error}"


def require_elastic_tooth(pair: GearPair, member: MemberName) -> None:
    """Refuse a tooth that the default compliance cannot take, loaded on either flank; the quick check first."""
    slot_width.require_whole_tooth(pair, member)
    other_side = replace(pair, pinion=pair.pinion.from_opposite, gear=pair.gear.from_opposite)
    for loaded in (pair, other_side):
        require_solid_shell(loaded, member)


EASE_OFF_NODES = (15, 11)
COMMON_FLANK_LIMIT = 0.6  # share of the gear flank; a pinion that meets less leaves contact out


@dataclass(frozen=True)
class SideReport:
    """Fit of one pinion flank to the wanted ease-off."""

    moved: Mapping[str, tuple[float, float]]  # start and end of every free setting [mm, rad or per rad]
    #: ease-off less target (n) [mm], a gear rotation left out; on the common flank if generated, else at nodes
    residual: Array
    largest_ease_off: float
    common_flank: float
    root_gap: Array  # blade tip above the root cone at toe, middle, heel (3) [mm]; NaN where undercut or out of reach
    at_limit: tuple[str, ...] = ()

    @property
    def largest_residual(self) -> float:
        """Largest residual [mm]."""
        return float(np.abs(self.residual).max())

    @property
    def rms_residual(self) -> float:
        """Root mean square of the residual [mm]."""
        return float(np.sqrt(np.mean(self.residual**2)))


@dataclass(frozen=True)
class DesignReport:
    """Report of a design: blanks, fits and warnings.

    Parameters
    ----------
    blank
        Dimensions of the blanks.
    sides
        The fits of drive and coast side.
    warnings
        Doubtful points, a sentence each.
    spaces
        Top lands, slots and fillets; ``None`` where they could not be measured.
    defaults
        Values taken for what the file leaves out, with their sources.
    analysable
        Whether both members have the whole teeth that the design's model of the elastic teeth needs.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> design = read_design("fm-11x41")
    >>> blank = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> DesignReport(blank, sides={}, warnings=("the top land of the pinion is narrow",)).warnings
    ('the top land of the pinion is narrow',)
    """

    blank: BlankDimensions
    sides: Mapping[FlankName, SideReport]
    warnings: tuple[str, ...]
    analysable: bool = True
    spaces: ToothSpaces | None = None
    defaults: tuple[DefaultValue, ...] = ()


def checked_design(design: Design, designed: PairDesign) -> DesignReport:
    """Report of a designed pair. Raises GeometryError if the ease-off of a side is far off its target."""
    sides = {side: _side(design, designed, side) for side in SIDES}
    clearance = designed.blank.clearance
    warnings: list[str] = []
    for side, item in sides.items():
        wanted = ease_off_target(getattr(design.target, side))
        # The fit may leave out what is near a fold; the flank does not.
        require_usable(side, item.largest_residual, wanted, ADVICE[design.pinion.method])
        good, _ = residual_limits(wanted)
        if not item.largest_residual <= good:
            warnings.append(
                f"{side}: the ease-off misses the target by up to {1e3 * item.largest_residual:.1f} um; "
                f"{ADVICE[design.pinion.method]}, or change the target"
            )
        warnings += [f"{side}: {name} stands at its limit, see [pinion.limits]" for name in item.at_limit]
        for name, text in missing_flanks(unmet_tips(designed.pair(side))):
            less, more = ("smaller", "larger") if name == "pinion" else ("larger", "smaller")
            edge = "" if getattr(design, name).tool_edge_radius is None else "a smaller tool_edge_radius, "
            warnings.append(
                f"{side}: {text}; {edge}a {less} gear_mean_addendum_factor or {more} profile_shift_coefficient, a "
                "larger pressure angle or more teeth help"
            )
        if not item.common_flank >= COMMON_FLANK_LIMIT:
            warnings.append(f"{side}: pinion and gear meet on {100 * item.common_flank:.0f} % of the gear flank alone")
        followed = design.pinion.follow_root
        advice = "change the target or the blanks" if followed else "follow_root = true in [pinion] keeps them on it"
        warnings += [f"{side}: {text}" for text in off_the_root("pinion", item.root_gap, clearance, f"; {advice}")]
    messages = unfinished_teeth(designed.pair(), design.compliance.model, designed.whole)
    unfinished = [text + _advice(design, designed, name, text) for name, text in messages]
    analysable = not unfinished or design.compliance.model == "shell"
    spaces = _spaces(design, designed)
    warnings += [
        *narrow_top_lands(designed.pair(), designed.blank.mean_normal_module),
        *unfinished,
        *(spaces.warnings() if spaces is not None else []),
    ]
    warnings += proportion_warnings(_proportions(design, designed.blank))
    warnings += blade_warnings(design, designed)
    teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
    basic_data = blank_design(design.blank_design, teeth, design.pair)
    # A share of zero that replaced the default of method 1 was found to help.
    searched = basic_data.method == 1 and "limit_pressure_angle_influence" in {each.name for each in design.defaults}
    if warnings and (basic_data.limit_pressure_angle_influence or not searched):
        warnings += limit_pressure_angle_advice(basic_data, designed.blank)
    warnings += formate_advice(design) if warnings else []
    difference, text = spiral_angle_difference(design.blank_design, designed.blank)
    warnings += [text] if abs(difference) > TOLD_SPIRAL_DIFFERENCE else []
    warnings += [*small_target_advice(design), *offset_advice(design, basic_data)]
    return DesignReport(designed.blank, sides, tuple(warnings), analysable, spaces, design.defaults)


def _proportions(design: Design, blank: BlankDimensions) -> ToothProportions:
    given, generated = design.blank_design, design.gear.generation == "generated"
    return ToothProportions.of(blank, given.cutter_radius, given.number_of_blade_groups or 0, generated_gear=generated)


def _spaces(design: Design, designed: PairDesign) -> ToothSpaces | None:
    proportions = _proportions(design, designed.blank)
    with suppress(GeometryError):
        return tooth_spaces(designed.pair("drive"), designed.pair("coast"), proportions)
    return None


#: Changes of basic data that help pinion and gear, by a word of what is wrong with a tooth; the last is a narrow slot.
TOOTH_ADVICE: Mapping[str, tuple[str, str]] = {
    "pointed": (
        "a smaller depth_factor or a larger gear_mean_addendum_factor",
        "a smaller depth_factor or gear_mean_addendum_factor",
    ),
    "undercut": (
        "a smaller gear_mean_addendum_factor, larger pressure angles or more teeth",
        "a larger gear_mean_addendum_factor, larger pressure angles or more teeth",
    ),
    "": (
        "a smaller depth_factor, clearance_factor, thickness_factor or gear_mean_slot_width",
        "a smaller depth_factor or clearance_factor, or a larger thickness_factor or gear_mean_slot_width",
    ),
}


def _advice(design: Design, designed: PairDesign, name: MemberName, text: str) -> str:
    """Advice for a member other than a smaller edge radius."""
    if getattr(design, name).tool_edge_radius is not None:
        return ""
    word, words = next((word, words) for word, words in TOOTH_ADVICE.items() if word in text)
    advice = words[BOTH_MEMBERS.index(name)]
    if not word and design.blank_design.process == "face_milled" and design.blank_design.depth_taper == "uniform":
        advice = f'depth_taper = "modified_slot_width", or {advice}'
    blade = (designed.gear[0] if name == "gear" else designed.pinion["drive"].surface).blade
    smallest = slot_width.REDUCTIONS[-1] * blade.edge_radius
    return f"; edge radii from {blade.edge_radius:.3g} down to {smallest:.2g} mm were tried; {advice} helps"


def _side(design: Design, designed: PairDesign, side: FlankName) -> SideReport:
    pair, fit = designed.pair(side), designed.pinion[side]
    t, h = grid(EASE_OFF_NODES)
    gear = pair.gear.flank(t, h)
    ease_off = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    inside = ease_off.status == NodeStatus.INSIDE
    wanted = ease_off_target(getattr(design.target, side))
    residual, lever = fit.residual, ease_off.lever_arm[inside]
    if designed.gear[0].settings.generated or design.pinion.method != "closest_fit":
        lengthwise, profile = np.meshgrid(t, h, indexing="ij")
        difference = ease_off.angle[inside] * lever - wanted(lengthwise.ravel(), profile.ravel())[inside]
        residual = without_rotation(difference, lever)
    gap = (ease_off.angle[inside] - ease_off.angle[inside].min()) * lever
    return SideReport(
        moved=fit.moved,
        residual=residual,
        largest_ease_off=float(gap.max()),
        common_flank=flank_share(inside.reshape(EASE_OFF_NODES)),
        root_gap=fit.root_gap,
        at_limit=_at_limit(design, designed, side),
    )


def _at_limit(design: Design, designed: PairDesign, side: FlankName) -> tuple[str, ...]:
    if design.pinion.method == "closest_fit":
        return ()
    values = {name: value for name, (_, value) in designed.pinion[side].moved.items()}
    limits = setting_limits(design.pinion.limits)
    return at_limit(values, limits, designed.blank.pinion.root_angle, design.blank_design.cutter_radius)


def rounding_limits(design: Design, report: DesignReport, case: Case) -> tuple[dict[str, tuple[float, float]], ...]:
    """Least and greatest value [mm or rad] within which settings of pinion and gear are rounded, by name.

    Of the pinion's fitted settings, except for the closest fit, which has none; and of edge radii, which are only
    rounded down, as a smaller one is allowed where a larger one is, but not below the smallest fillet.
    """
    ranges: tuple[dict[str, tuple[float, float]], ...] = ({}, {})
    if design.pinion.method != "closest_fit":
        limits, radius = setting_limits(design.pinion.limits), design.blank_design.cutter_radius
        allowed = partial(limits.allowed, root_angle=report.blank.pinion.root_angle, cutter_radius=radius)
        ranges[0].update({name: allowed(name) for side in report.sides.values() for name in side.moved})
    least = slot_width.SMALLEST_SHARE * report.blank.mean_normal_module
    for member_ranges, member in zip(ranges, (case.pinion, case.gear), strict=True):
        assert member.concave is not None  # a designed case has all flanks, and one edge radius a member
        radius = member.concave.cutter.tool_edge_radius
        member_ranges["edge_radius"] = min(least, radius), radius
    return ranges
