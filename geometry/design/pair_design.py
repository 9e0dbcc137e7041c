"""A whole pair from basic data and wanted ease-offs: blanks, gear, and a pinion flank for each side."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from ..cutting.generating_surface import Flanks, GeneratingSurface
from ..pair.assembly import Assembly
from ..pair.gear_pair import FlankName, GearPair, Member, left_by_cutter, thickness_per_angle
from ..pair.tooth_thickness import (
    filling_thickness,
    mean_cone_distances,
    mean_normal_thickness,
    mid_flank_thickness,
)
from ..tooth.tooth_flanks import MemberName
from .basic_settings import conjugate_pinion, crown_gear_pinion, formate_gear, generated_gear, pitch_point_azimuth
from .blank import BlankDesign, BlankDimensions, blank_dimensions, blank_section
from .closest_fit import NO_STEPS, StandardSteps, best_fit, require_usable
from .pinion_method import ADVICE, PinionMethod, SettingLimits
from .set_up_fit import along_the_root, best_set_up
from .slot_width import ToothCheck, allowed_edge_radius, fitting_edge_radius, require_whole_tooth, usual_edge_radii
from .synthesis import EaseOffTarget, Synthesis
from .tooth_proportions import ToothProportions

BOTH_MEMBERS: tuple[MemberName, MemberName] = ("pinion", "gear")
SIDES: tuple[FlankName, FlankName] = ("drive", "coast")


@dataclass(frozen=True)
class PairDesign:
    """Designed pair; the misalignment of the assembly is the one in which the pinion was fitted."""

    blank: BlankDimensions
    assembly: Assembly
    gear: Flanks
    pinion: Mapping[FlankName, Synthesis]
    gear_thickness: float | None  # normal circular, mid-flank [mm]; None where the cutter fixes it
    #: [mm] left by a completing face-milling cutter, else with the blank's backlash
    pinion_thickness: float | None = None
    whole: frozenset[MemberName] = frozenset()  # members whose teeth passed the check of their edge radii

    def pair(self, side: FlankName = "drive") -> GearPair:
        """The pair seen from one side."""
        order = 1 if side == "drive" else -1
        of_pinion, of_gear = [self.pinion[name].surface for name in SIDES][::order], self.gear[::order]
        sections = [blank_section(member, self.blank.clearance) for member in (self.blank.pinion, self.blank.gear)]
        pinion = Member(self.assembly.pinion_teeth, sections[0], of_pinion[0], of_pinion[1], self.pinion_thickness)
        gear = Member(self.assembly.gear_teeth, sections[1], of_gear[0], of_gear[1], self.gear_thickness)
        return GearPair(pinion, gear, self.assembly)


def design_pair(
    design: BlankDesign,
    assembly: Assembly,
    targets: Mapping[FlankName, EaseOffTarget],
    *,
    method: PinionMethod = "closest_fit",
    limits: SettingLimits | None = None,
    free: Sequence[str] | None = None,
    follow_root: bool = True,
    generated: bool = False,
    corrected: bool = True,
    edge_radii: tuple[float | None, float | None] = (None, None),
    steps: StandardSteps = NO_STEPS,
    require: ToothCheck = require_whole_tooth,
) -> PairDesign:
    """Design the blanks, the gear and the pinion flanks of a pair; targets hold at the assembly's misalignment.

    Cutter radius and blade groups are those of the design. ``closest_fit`` uses ``free`` and ``follow_root``, other
    methods ``limits``; an edge radius [mm] of ``None`` is the usual one, smaller until the teeth pass ``require``.
    """
    blank = blank_dimensions(design)
    groups, steps = design.number_of_blade_groups or 0, steps.of_module(blank.mean_normal_module)
    proportions = ToothProportions.of(blank, design.cutter_radius, groups, generated_gear=generated)
    usual = usual_edge_radii(proportions)
    pinion_edge, gear_edge = (
        steps.edge(usual_radius) if radius is None else radius
        for radius, usual_radius in zip(edge_radii, usual, strict=True)
    )

    def flanks(make: Callable[..., Flanks]) -> Flanks:
        plain = make(blank, design.cutter_radius, assembly.gear_hand, groups, corrected=corrected, steps=steps)
        return plain[0].rounded(gear_edge), plain[1].rounded(gear_edge)

    gear = flanks(generated_gear if generated else formate_gear)
    formate = flanks(formate_gear) if generated else gear
    sections = [blank_section(member, blank.clearance) for member in (blank.pinion, blank.gear)]
    # The pinion's blade tips run along its root, opposite those of the gear's cutter.
    height = blank.gear.mean_dedendum + blank.pinion.mean_dedendum
    azimuth = pitch_point_azimuth(blank, assembly.hypoid_offset)
    wheels = [Member(assembly.gear_teeth, sections[1], *each) for each in (gear, gear[::-1])]

    def start(make: Callable[[int], GeneratingSurface]) -> dict[FlankName, GearPair]:
        """The pair with the pinion flanks to start a fit from, on both sides."""
        members = [Member(assembly.pinion_teeth, sections[0], make(k).rounded(pinion_edge)) for k in (0, 1)]
        return {s: GearPair(*each, assembly) for s, each in zip(SIDES, zip(members, wheels, strict=True), strict=True)}

    def conjugate() -> dict[FlankName, GearPair]:
        return start(lambda k: conjugate_pinion(formate[k], assembly, height))

    def crown(upright: bool) -> dict[FlankName, GearPair]:
        rolled = gear if generated else flanks(generated_gear)
        made = [crown_gear_pinion(flank, assembly, height, azimuth) for flank in rolled]
        return start(lambda k: along_the_root(made[k], blank) if upright else made[k])

    if method == "closest_fit":
        starts = [*([crown(upright=False), crown(upright=True)] if generated else []), conjugate()]
        pinion = {}
        for side in SIDES:
            sides = [each[side] for each in starts]
            pinion[side] = best_fit(side, sides, targets[side], free, follow_root, blank.clearance, steps)
    else:
        limits = SettingLimits() if limits is None else limits
        # A tilted cutter cuts the conjugate pinion of a Formate gear, both its flanks in one set-up.
        further = [conjugate()] if not generated and method in ("tilt", "completing") else []
        upright = crown(upright=True)
        pinion = best_set_up(upright, further, targets, method, limits, blank, design.cutter_radius, steps)
    for side in SIDES:
        require_usable(side, pinion[side].largest_residual, targets[side], ADVICE[method])
    thickness = _middle_thickness(blank, gear) if groups else None
    designed = PairDesign(blank, assembly, gear, pinion, thickness)
    by_cutter = method == "completing" and not groups
    designed = replace(designed, pinion_thickness=_pinion_thickness(blank, designed.pair(), by_cutter=by_cutter))
    for name, given in zip(BOTH_MEMBERS, edge_radii, strict=True):
        if given is None:
            designed = _with_fitting_edges(designed, name, require, steps)
    return designed


def _with_fitting_edges(designed: PairDesign, name: MemberName, check: ToothCheck, steps: StandardSteps) -> PairDesign:
    """The design with the usual edge radius of one member made so small that blades and fillets fit the slot."""
    pair, flank = designed.pair(), designed.gear[0] if name == "gear" else designed.pinion["drive"].surface
    usual = allowed_edge_radius(pair, name, flank.blade.edge_radius)
    radius, passed = fitting_edge_radius([pair, designed.pair("coast")], name, usual, check, steps)
    whole = designed.whole.union([name] if passed else [])
    if name == "gear":
        return replace(designed, gear=(designed.gear[0].rounded(radius), designed.gear[1].rounded(radius)), whole=whole)
    pinion = {side: replace(fit, surface=fit.surface.rounded(radius)) for side, fit in designed.pinion.items()}
    return replace(designed, pinion=pinion, whole=whole)


def _pinion_thickness(blank: BlankDimensions, pair: GearPair, *, by_cutter: bool) -> float:
    """Normal circular thickness of the pinion's tooth in the middle of the flank [mm].

    It is what one cutter of both flanks leaves, else what leaves the backlash in the gear's slot.
    """
    if by_cutter:
        return left_by_cutter(pair.pinion) * thickness_per_angle(pair.pinion)
    lost = math.pi * blank.mean_normal_module - blank.pinion.mean_normal_thickness - blank.gear.mean_normal_thickness
    distance = mean_cone_distances(pair)[0]
    filling = mean_normal_thickness(pair.pinion, filling_thickness(pair), distance)
    return mid_flank_thickness(pair.pinion, filling - lost, distance)


def _middle_thickness(blank: BlankDimensions, gear: Flanks) -> float:
    """The blank's mean normal thickness, carried from the mean point to the middle of the flank along both flanks."""
    gear_blank = blank.gear
    member = Member(gear_blank.number_of_teeth, blank_section(gear_blank, blank.clearance), *gear)
    return mid_flank_thickness(member, gear_blank.mean_normal_thickness, gear_blank.mean_cone_distance)
