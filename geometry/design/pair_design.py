"""A whole pair from basic data and wanted ease-offs: blanks, gear, and a pinion flank for each side."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ...core.errors import GeometryError
from ..cutting.named_settings import get_setting
from ..flanks.flank import solve_flank
from ..pair.assembly import Assembly
from ..pair.gear_pair import FlankName, GearPair, Member, thickness_per_angle
from ..tooth.tooth_flanks import MemberName
from .basic_settings import Flanks, blank_section, formate_gear, generated_gear
from .blank import BlankDesign, BlankDimensions, blank_dimensions
from .conjugate_pinion import conjugate_pinion
from .crown_gear_pinion import crown_gear_pinion, pitch_point_azimuth
from .ease_off_residual import ROOT_WEIGHT
from .edge_radius import ToothCheck, fitting_edge_radius, require_whole_tooth, rounded, usual_edge_radius
from .mean_point import mean_point_angles
from .synthesis import FREE_SETTINGS_WITH_ROOT_ANGLE, EaseOffTarget, Synthesis, fit_pinion

RETRY_RESIDUAL = 0.005  # [mm]; root mean square residual above which another fit is tried
SMALL_RESIDUAL = 0.001  # [mm]; a smaller residual is good for any target
GOOD_SHARE = 0.1  # of the target's range; a smaller residual is good
USABLE_RESIDUAL = 0.010  # [mm]; a smaller residual is never refused
USABLE_SHARE = 0.5  # of the target's range; a larger residual is refused
FOLD_MARGIN = 0.2  # of the conjugate gear's area; nodes nearer to a fold are no part of a fit from the crown gear
BLANK_ADVICE = "change the blanks: cutter_radius, depth_taper, spiral angle, or more teeth against undercut"
LOST_ROOT_GAP = 10.0  # [mm]; weight of a root point that the cutter does not reach
BOTH_MEMBERS: tuple[MemberName, MemberName] = ("pinion", "gear")
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
    follow_root: bool = True,
    generated: bool = False,
    corrected: bool = True,
    edge_radii: tuple[float | None, float | None] = (None, None),
    require: ToothCheck = require_whole_tooth,
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
        Whether the gear is generated; Formate if not. The fit of a generated gear starts from the pinion of its crown
        gear and, where that stays off the target, from the conjugate pinion of the Formate gear.
    corrected
        Whether the gear's flanks get the blank's angles to rounding, see ``formate_gear``.
    edge_radii
        Edge radius of the blades of pinion and gear [mm]; that of ``edge_radius.usual_edge_radius`` where ``None``.
    require
        What the teeth must pass; an edge radius that is not given is made smaller until they do.

    Raises
    ------
    InputError
        If a value cannot be used.
    GeometryError
        If the basic data give no blanks, no cutter fits them, the flanks do not meet, or every fit stays far from the
        target (``residual_limits``).
    """
    blank = blank_dimensions(design)
    groups = design.number_of_blade_groups or 0
    pinion_edge, gear_edge = (
        usual_edge_radius(blank, member) if radius is None else radius
        for radius, member in zip(edge_radii, (blank.pinion, blank.gear), strict=True)
    )

    def flanks(make: Callable[..., Flanks]) -> Flanks:
        plain = make(blank, design.cutter_radius, assembly.gear_hand, groups, corrected=corrected)
        return rounded(plain[0], gear_edge), rounded(plain[1], gear_edge)

    gear = flanks(generated_gear if generated else formate_gear)
    formate = flanks(formate_gear) if generated else gear
    sections = [blank_section(member, blank.clearance) for member in (blank.pinion, blank.gear)]
    # The pinion's blade tips run along its root, opposite those of the gear's cutter.
    height = blank.gear.mean_dedendum + blank.pinion.mean_dedendum
    azimuth = pitch_point_azimuth(blank, assembly.hypoid_offset)
    pinion: dict[FlankName, Synthesis] = {}
    for side, like, loaded, opposite in zip(SIDES, formate, gear, gear[::-1], strict=True):
        starts = [conjugate_pinion(like, assembly, height)]
        if generated:
            starts.insert(0, crown_gear_pinion(loaded, assembly, height, azimuth))
        wheel = Member(assembly.gear_teeth, sections[1], loaded, opposite)
        pairs = [
            GearPair(Member(assembly.pinion_teeth, sections[0], rounded(start, pinion_edge)), wheel, assembly)
            for start in starts
        ]
        try:
            pinion[side] = best_fit(pairs, targets[side], free, follow_root, blank.clearance)
        except GeometryError as error:
            reason = "" if free is None else f": {error}"
            raise GeometryError(f"{side}: no pinion was found that meets the gear{reason}; {BLANK_ADVICE}") from error
        require_usable(side, pinion[side].largest_residual, targets[side])
    thickness = _middle_thickness(blank, gear) if groups else None
    designed = PairDesign(blank, assembly, gear, pinion, thickness)
    for name, given in zip(BOTH_MEMBERS, edge_radii, strict=True):
        if given is None:
            designed = _with_fitting_edges(designed, name, require)
    return designed


def _with_fitting_edges(designed: PairDesign, name: MemberName, require: ToothCheck) -> PairDesign:
    """The design with the usual edge radius of one member made so small that its fillets fit the slot."""
    if name == "gear":
        radius = fitting_edge_radius(designed.pair(), name, designed.gear[0].blade.edge_radius, require)
        return replace(designed, gear=(rounded(designed.gear[0], radius), rounded(designed.gear[1], radius)))
    usual = designed.pinion["drive"].surface.blade.edge_radius
    radius = fitting_edge_radius(designed.pair(), name, usual, require)
    return replace(
        designed,
        pinion={side: replace(fit, surface=rounded(fit.surface, radius)) for side, fit in designed.pinion.items()},
    )


def residual_limits(target: EaseOffTarget) -> tuple[float, float]:
    """Largest residuals of a good fit and of one that can be used at all [mm], by the target's range.

    Examples
    --------
    >>> [round(limit, 6) for limit in residual_limits(EaseOffTarget(lengthwise_crowning=0.05))]
    [0.005, 0.025]
    """
    size = target_range(target)
    return max(SMALL_RESIDUAL, GOOD_SHARE * size), max(USABLE_RESIDUAL, USABLE_SHARE * size)


def target_range(target: EaseOffTarget) -> float:
    """Range of a target over the gear flank [mm]."""
    t, h = np.meshgrid(np.linspace(0.0, 1.0, 15), np.linspace(0.0, 1.0, 11), indexing="ij")
    return float(np.ptp(target(t, h)))


def require_usable(side: FlankName, residual: float, target: EaseOffTarget) -> None:
    """Refuse a fit that misses its target by more than the second of ``residual_limits``.

    Parameters
    ----------
    side
        Which side.
    residual
        Its largest residual [mm].
    target
        The wanted ease-off.

    Raises
    ------
    GeometryError
        If the fit is far off.
    """
    limit = residual_limits(target)[1]
    if not residual <= limit:
        raise GeometryError(
            f"{side}: no pinion near the target ease-off was found: the best one misses it by up to "
            f"{1e3 * residual:.1f} um, where the target's range is {1e3 * target_range(target):.1f} um and "
            f"{1e3 * limit:.1f} um would do; free other settings of the pinion (free_settings), ask for less crowning "
            f"and bias, or {BLANK_ADVICE}"
        )


def best_fit(
    starts: Sequence[GearPair],
    target: EaseOffTarget,
    free: Sequence[str] | None,
    follow_root: bool,
    clearance: float,
) -> Synthesis:
    """The fit that comes nearest to target and root cone: the first good one, else the best of several.

    Parameters
    ----------
    starts
        The pair with each pinion flank to start from; that of a Formate gear last.
    target
        The wanted ease-off.
    free, follow_root
        As in ``design_pair``.
    clearance
        Of the blanks [mm]: blade tips further off the root cone are not good.

    Raises
    ------
    GeometryError
        If no fit succeeds.
    """
    best: Synthesis | None = None
    failure = GeometryError("no start")
    for attempt in _attempts(starts, target, free, follow_root):
        try:
            fit = attempt()
        except GeometryError as error:
            failure = error
            continue
        if best is None or _cost(fit, follow_root) < _cost(best, follow_root):
            best = fit
        enough = len(starts) > 1 or best.rms < RETRY_RESIDUAL
        if enough and _good(best, target, clearance if follow_root else math.inf):
            break
    if best is None:
        raise failure
    return best


def _attempts(
    starts: Sequence[GearPair], target: EaseOffTarget, free: Sequence[str] | None, follow_root: bool
) -> Iterator[Callable[[], Synthesis]]:
    """Fits to try, the most promising first."""
    *crown_gear, conjugate = starts
    choices = [free] if free is not None else [FREE_SETTINGS_WITH_ROOT_ANGLE, None] if follow_root else [None]
    for pair in crown_gear:
        for names in choices:
            yield partial(fit_pinion, pair, target, free=names, follow_root=follow_root, fold_margin=FOLD_MARGIN)
    yield partial(fit_pinion, conjugate, target, free=free, follow_root=follow_root)
    if follow_root and free is None:
        yield partial(_form_first, conjugate, target)


def _form_first(pair: GearPair, target: EaseOffTarget) -> Synthesis:
    """A fit that takes the form of the flank first and the root cone then."""
    form = fit_pinion(pair, target)
    near = replace(pair, pinion=replace(pair.pinion, loaded=form.surface))
    fit = fit_pinion(near, target, follow_root=True)
    start = pair.pinion.loaded
    return replace(fit, moved={name: (get_setting(start, name), end) for name, (_, end) in fit.moved.items()})


def _cost(fit: Synthesis, follow_root: bool) -> float:
    """Mean square of the residual [mm^2], with that of the root line as the fit weighs it."""
    gap = np.nan_to_num(fit.root_gap, nan=LOST_ROOT_GAP) if follow_root else np.zeros(0)
    return float(fit.rms**2 + np.sum((1e-3 * ROOT_WEIGHT * gap) ** 2) / fit.residual.size)


def _good(fit: Synthesis, target: EaseOffTarget, root_limit: float) -> bool:
    return fit.largest_residual <= residual_limits(target)[0] and (
        math.isinf(root_limit) or bool(np.all(np.abs(fit.root_gap) <= root_limit))
    )


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
