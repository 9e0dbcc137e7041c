"""Check of a designed pair: residuals, undercut, blade tips, top lands and whole teeth, with warnings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cases.conversion import blank_design, ease_off_target, setting_limits
from ...cases.schema.case_schema import Case
from ...cases.schema.design_schema import Design
from ...contact.evaluation.marking_print import flank_share
from ...core.errors import GeometryError
from ...geometry.design.blank import BlankDimensions
from ...geometry.design.closest_fit import require_usable, residual_limits, target_range
from ...geometry.design.edge_radius import REDUCTIONS, SMALLEST_SHARE
from ...geometry.design.pair_design import (
    SIDES,
    PairDesign,
)
from ...geometry.design.pinion_method import ADVICE, at_limit
from ...geometry.design.tooth_proportions import ToothProportions
from ...geometry.flanks.flank import NodeStatus
from ...geometry.pair.ease_off import EaseOff, exact_ease_off
from ...geometry.pair.gear_pair import FlankName, grid
from ...geometry.pair.tip_mates import unmet_tips
from ...geometry.tooth.tooth_flanks import MemberName
from .design_advice import (
    cutter_radius_advice,
    formate_advice,
    limit_pressure_angle_advice,
    offset_advice,
    small_target_advice,
)
from .pair_warnings import missing_flanks, narrow_top_lands, off_the_root, uncut_share, unfinished_teeth
from .tooth_spaces import ToothSpaces, tooth_spaces

Array = NDArray[Any]
EASE_OFF_NODES = (15, 11)
COMMON_FLANK_LIMIT = 0.6  # share of the gear flank; a pinion that meets less leaves contact out


@dataclass(frozen=True)
class SideReport:
    """Fit of one pinion flank to the wanted ease-off.

    Parameters
    ----------
    moved
        Start and end of every free setting [mm, rad or per rad].
    residual
        Ease-off less target (n), up to a rotation of the gear [mm]: at the nodes of the fit or, with a generated gear,
        on the whole common flank.
    wanted_range
        Range of the target over the gear flank [mm].
    largest_ease_off
        Largest ease-off over the common flank [mm].
    common_flank
        Share of the gear flank that the pinion meets.
    uncut
        Share of the flanks of pinion and gear that is undercut or out of the cutter's reach.
    at_limit
        Names of the settings that stand at a limit of the machine or the cutter.
    root_gap
        Height of the pinion's blade tip above the root cone at toe, middle and heel (3) [mm]; negative where it cuts
        deeper, NaN where the root is undercut or out of the cutter's reach.
    """

    moved: Mapping[str, tuple[float, float]]
    residual: Array
    wanted_range: float
    largest_ease_off: float
    common_flank: float
    uncut: tuple[float, float]
    root_gap: Array
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
        for name in item.at_limit:
            warnings.append(f"{side}: {name} stands at its limit, see [pinion.limits]")
        for name, text in missing_flanks(unmet_tips(designed.pair(side))):
            less, more = ("smaller", "larger") if name == "pinion" else ("larger", "smaller")
            warnings.append(
                f"{side}: {text}; a {less} gear_mean_addendum_factor or {more} profile_shift_coefficient, a larger "
                "pressure angle or more teeth help"
            )
        if not item.common_flank >= COMMON_FLANK_LIMIT:
            warnings.append(f"{side}: pinion and gear meet on {100 * item.common_flank:.0f} % of the gear flank alone")
        followed = design.pinion.follow_root
        advice = "change the target or the blanks" if followed else "follow_root = true in [pinion] keeps them on it"
        off_root = off_the_root("pinion", item.root_gap, clearance, f"; {advice}")
        warnings += [f"{side}: {text}" for text in off_root]
    unfinished = _unfinished(design, designed)
    spaces = _spaces(design, designed)
    warnings += [
        *narrow_top_lands(designed.pair(), designed.blank.mean_normal_module),
        *unfinished,
        *(spaces.warnings() if spaces is not None else []),
    ]
    teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
    basic_data = blank_design(design.blank_design, teeth, design.pair)
    if warnings:
        warnings += [
            *limit_pressure_angle_advice(basic_data),
            *cutter_radius_advice(basic_data),
            *formate_advice(design, basic_data),
        ]
    warnings += [*small_target_advice(design), *offset_advice(design, basic_data)]
    return DesignReport(designed.blank, sides, tuple(warnings), not unfinished, spaces)


def _spaces(design: Design, designed: PairDesign) -> ToothSpaces | None:
    proportions = ToothProportions.of(
        designed.blank,
        design.blank_design.cutter_radius,
        design.blank_design.number_of_blade_groups or 0,
        generated_gear=design.gear.generation == "generated",
    )
    try:
        return tooth_spaces(designed.pair("drive"), designed.pair("coast"), proportions)
    except GeometryError:
        return None


def _unfinished(design: Design, designed: PairDesign) -> list[str]:
    """Warnings of members without a whole tooth, which the shell alone can do without."""
    found = unfinished_teeth(designed.pair(), design.compliance.model)
    return [text + _advice(design, designed, name) for name, text in found]


def _advice(design: Design, designed: PairDesign, name: MemberName) -> str:
    """What to change if it is not the edge radius."""
    if getattr(design, name).tool_edge_radius is not None:
        return ""
    blade = (designed.gear[0] if name == "gear" else designed.pinion["drive"].surface).blade
    return (
        f"; edge radii from {blade.edge_radius:.3g} down to {REDUCTIONS[-1] * blade.edge_radius:.2g} mm were tried, so "
        "change the blanks: depth_taper, cutter_radius, thickness_factor or clearance_factor against a narrow slot, "
        "gear_mean_addendum_factor (or profile_shift_coefficient), the pressure angles or more teeth against undercut, "
        "a larger gear_mean_addendum_factor or thickness_factor against a pointed pinion"
    )


def _side(design: Design, designed: PairDesign, side: FlankName) -> SideReport:
    pair, fit = designed.pair(side), designed.pinion[side]
    t, h = grid(EASE_OFF_NODES)
    gear = pair.gear.flank(t, h)
    found = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    inside = found.status == NodeStatus.INSIDE
    wanted = ease_off_target(getattr(design.target, side))
    residual = fit.residual
    if designed.gear[0].settings.generated or design.pinion.method != "closest_fit":
        residual = _left(found, wanted(*(f.ravel() for f in np.meshgrid(t, h, indexing="ij"))), inside)
    gap = (found.angle[inside] - found.angle[inside].min()) * found.lever_arm[inside]
    return SideReport(
        moved=fit.moved,
        residual=residual,
        wanted_range=target_range(wanted),
        largest_ease_off=float(gap.max()),
        common_flank=flank_share(inside.reshape(EASE_OFF_NODES)),
        uncut=(uncut_share(pair.pinion.flank(t, h)), uncut_share(gear)),
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
    """Least and greatest value of settings of pinion and gear by name [mm or rad], within which they are rounded.

    Of the pinion's fitted settings, but for the closest fit, which has none; and of the edge radii: these become
    smaller alone, as whatever allowed them allows less, but not below the smallest fillet.
    """
    found: tuple[dict[str, tuple[float, float]], ...] = ({}, {})
    if design.pinion.method != "closest_fit":
        limits, radius = setting_limits(design.pinion.limits), design.blank_design.cutter_radius
        allowed = partial(limits.allowed, root_angle=report.blank.pinion.root_angle, cutter_radius=radius)
        found[0].update({name: allowed(name) for side in report.sides.values() for name in side.moved})
    least = SMALLEST_SHARE * report.blank.mean_normal_module
    for own, member in zip(found, (case.pinion, case.gear), strict=True):
        assert member.concave is not None  # a designed case has all flanks, and one edge radius a member
        radius = member.concave.cutter.tool_edge_radius
        own["edge_radius"] = min(least, radius), radius
    return found


def _left(found: EaseOff, wanted: Array, inside: NDArray[np.bool_]) -> Array:
    """Ease-off less target on the common flank (n) [mm], up to a rotation of the gear."""
    lever = found.lever_arm[inside]
    error = found.angle[inside] * lever - wanted[inside]
    return np.asarray(error - lever * float(lever @ error) / float(lever @ lever))
