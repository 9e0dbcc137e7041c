"""A whole pair from basic data and wanted ease-offs: blanks, gear, and a pinion flank for each side."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.flank import solve_flank
from ..pair.assembly import Assembly
from ..pair.gear_pair import FlankName, GearPair, Member, thickness_per_angle
from .basic_settings import Flanks, blank_section, formate_gear, generated_gear
from .blank import BlankDesign, BlankDimensions, blank_dimensions
from .conjugate_pinion import conjugate_pinion
from .mean_point import mean_point_angles
from .synthesis import EaseOffTarget, Synthesis, fit_pinion

RETRY_RESIDUAL = 0.005  # [mm]; root mean square residual above which a second fit is tried
SIDES: tuple[FlankName, FlankName] = ("drive", "coast")


@dataclass(frozen=True)
class PairDesign:
    """A designed pair.

    Parameters
    ----------
    blank
        Blanks of both members.
    assembly
        Axes, with the misalignment in which the pinion was fitted.
    gear
        Convex and concave flank of the gear.
    pinion
        Concave (drive) and convex (coast) flank of the pinion, each with what its fit moved and left.
    gear_thickness
        Normal circular thickness of the gear's tooth in the middle of the flank [mm], where the cutter does not fix
        it (face hobbing); ``None`` where it does.
    """

    blank: BlankDimensions
    assembly: Assembly
    gear: Flanks
    pinion: Mapping[FlankName, Synthesis]
    gear_thickness: float | None

    def pair(self, side: FlankName = "drive") -> GearPair:
        """The pair seen from one side."""
        order = 1 if side == "drive" else -1
        gear = self.gear[::order]
        pinion = [self.pinion[name].surface for name in SIDES][::order]
        blanks, clearance = self.blank, self.blank.clearance
        return GearPair(
            Member(self.assembly.pinion_teeth, blank_section(blanks.pinion, clearance), pinion[0], pinion[1]),
            Member(
                self.assembly.gear_teeth, blank_section(blanks.gear, clearance), gear[0], gear[1], self.gear_thickness
            ),
            self.assembly,
        )


def design_pair(
    design: BlankDesign,
    assembly: Assembly,
    targets: Mapping[FlankName, EaseOffTarget],
    *,
    free: Sequence[str] | None = None,
    follow_root: bool = False,
    generated: bool = False,
    corrected: bool = True,
    edge_radii: tuple[float, float] = (0.0, 0.0),
) -> PairDesign:
    """Design the blanks, the gear and the pinion flanks of a pair.

    Parameters
    ----------
    design
        Basic data of the blanks; cutter radius and blade groups are those of the cutters too.
    assembly
        Axes and teeth as in ``design``, hand of the pinion, and the misalignment in which the targets hold.
    targets
        Wanted ease-off of the two sides.
    free
        Pinion settings that may move, see ``named_settings``; the usual ones if left out.
    follow_root
        Whether the tips of the pinion's blades shall run along its root cone, see ``fit_pinion``.
    generated
        Whether the gear is generated; Formate if not. The fit starts from the conjugate pinion of the Formate one.
    corrected
        Whether the gear's flanks get the blank's angles to rounding, see ``formate_gear``.
    edge_radii
        Edge radius of the blades of pinion and gear [mm].

    Raises
    ------
    InputError
        If a value cannot be used.
    GeometryError
        If the basic data give no blanks, no cutter fits them, or the flanks do not meet.
    """
    blank = blank_dimensions(design)
    groups = design.number_of_blade_groups or 0

    def flanks(make: Callable[..., Flanks]) -> Flanks:
        plain = make(blank, design.cutter_radius, assembly.gear_hand, groups, corrected=corrected)
        return _rounded(plain[0], edge_radii[1]), _rounded(plain[1], edge_radii[1])

    formate = flanks(formate_gear)
    gear = flanks(generated_gear) if generated else formate
    sections = [blank_section(member, blank.clearance) for member in (blank.pinion, blank.gear)]
    # The pinion's blade tips run along its root, opposite those of the gear's cutter.
    height = blank.gear.mean_dedendum + blank.pinion.mean_dedendum
    pinion: dict[FlankName, Synthesis] = {}
    for side, like, loaded, opposite in zip(SIDES, formate, gear, gear[::-1], strict=True):
        conjugate = _rounded(conjugate_pinion(like, assembly, height), edge_radii[0])
        start = Member(assembly.pinion_teeth, sections[0], conjugate)
        wheel = Member(assembly.gear_teeth, sections[1], loaded, opposite)
        pinion[side] = _fitted(GearPair(start, wheel, assembly), targets[side], free, follow_root)
    thickness = _middle_thickness(blank, gear) if groups else None
    return PairDesign(blank, assembly, gear, pinion, thickness)


def _fitted(pair: GearPair, target: EaseOffTarget, free: Sequence[str] | None, follow_root: bool) -> Synthesis:
    """The fit, and where it stops far from the target a second one that takes the form first and the root cone then."""
    fit = fit_pinion(pair, target, free=free, follow_root=follow_root)
    if not follow_root or free is not None or fit.rms < RETRY_RESIDUAL:
        return fit
    try:
        form = fit_pinion(pair, target)
        near = replace(pair, pinion=replace(pair.pinion, loaded=form.surface))
        second = fit_pinion(near, target, follow_root=True)
    except GeometryError:
        return fit
    moved = {name: (fit.moved[name][0], end) for name, (_, end) in second.moved.items()}
    return replace(second, moved=moved) if second.rms < fit.rms else fit


def _rounded(surface: GeneratingSurface, edge_radius: float) -> GeneratingSurface:
    return replace(surface, blade=replace(surface.blade, edge_radius=edge_radius))


def _middle_thickness(blank: BlankDimensions, gear: Flanks) -> float:
    """The blank's mean normal thickness, carried from the mean point to the middle of the flank along both flanks."""
    member, section = blank.gear, blank_section(blank.gear, blank.clearance)
    at_mean = mean_point_angles(gear[0], section, member).azimuth - mean_point_angles(gear[1], section, member).azimuth
    middle = section.points(np.array([0.5]), np.array([0.5]))
    sides = [solve_flank(flank, section, middle[0], middle[1]).position[:, 0] for flank in gear]
    hand = 1.0 if gear[0].hand == "right" else -1.0
    azimuths = [hand * math.atan2(position[1], position[0]) for position in sides]
    # What the slot, from the concave to the convex flank, grows by the tooth loses.
    growth = azimuths[0] - azimuths[1] - at_mean
    angle = 2.0 * member.mean_transverse_thickness / member.mean_pitch_diameter - growth
    return angle * thickness_per_angle(Member(member.number_of_teeth, section, gear[0]))
