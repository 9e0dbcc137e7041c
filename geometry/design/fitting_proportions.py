"""Tooth proportions that a drawing omits, changed until the teeth have top lands and slots and no undercut.

Few teeth, high ratios and uniform depth make pinions pointed or undercut with the usual proportions. Top lands and
slots are those of AGMA 929-B22; undercut is that of the involute in the normal section at the toe. The limits and the
order in which proportions change are rules of this package.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from ...core.errors import EaseoffError
from .blank import BlankDesign, BlankDimensions, blank_dimensions
from .iso23509.blank_dimensions import DepthTaper
from .iso23509.usual_proportions import DefaultValue
from .slot_width import SlotWidths, ToothLine, TopLands
from .tooth_proportions import ToothProportions

LEAST_LAND = 0.25  # top land and slot, over the mean normal module
LEAST_MARGIN = 0.05  # height left to the limit of undercut, over the mean normal module
LARGEST_DEDENDUM_ANGLE = math.radians(12.0)
#: Steps of equal weight, that of the depth a share of it.
WEIGHED_STEPS = {"thickness_factor": 0.05, "gear_mean_addendum_factor": 0.04, "depth_factor": -0.05}
FREE_PROPORTIONS = (*WEIGHED_STEPS, "depth_taper")
STEPS, UNIFORM_WEIGHT = 6, 3
RULE = "rule of this package: top land, slot, undercut"


def fitting_proportions(
    design: BlankDesign, free: Sequence[str], *, generated_gear: bool
) -> tuple[BlankDesign, tuple[DefaultValue, ...]]:
    """Basic data with the least change of the proportions in ``free`` that meets all limits, and what was changed.

    Where no change meets them, the one that comes nearest; as given where there are no blanks.
    """
    best, greatest = design, -math.inf
    for candidate in _candidates(design, free):
        with suppress(EaseoffError):
            margin = _margin(candidate, generated_gear)
            if margin > greatest:
                best, greatest = candidate, margin
            if margin >= 0.0:
                break
    names = [name for name in free if getattr(best, name) != getattr(design, name)]
    return best, tuple(DefaultValue(name, getattr(best, name), RULE) for name in names)


def _candidates(design: BlankDesign, free: Sequence[str]) -> Iterator[BlankDesign]:
    """The design itself, then changes of it, small ones first."""
    tapers: list[tuple[int, DepthTaper | None]] = [(0, design.depth_taper)]
    if "depth_taper" in free and design.depth_taper != "uniform":
        tapers.append((UNIFORM_WEIGHT, "uniform"))
    steps = itertools.product(*(range(STEPS if name in free else 1) for name in WEIGHED_STEPS))
    for counts, (_, taper) in sorted(itertools.product(steps, tapers), key=lambda each: sum(each[0]) + each[1][0]):
        changes: dict[str, Any] = {"depth_taper": taper}
        for (name, step), count in zip(WEIGHED_STEPS.items(), counts, strict=True):
            if count:
                value = getattr(design, name)
                changes[name] = value + count * step * (value if name == "depth_factor" else 1.0)
        yield replace(design, **changes)


def _margin(design: BlankDesign, generated_gear: bool) -> float:
    """Least margin to the limits, over the module or in rad; below zero where one is not met."""
    blank = blank_dimensions(design)
    groups = design.number_of_blade_groups or 0
    proportions = ToothProportions.of(blank, design.cutter_radius, groups, generated_gear=generated_gear)
    lands = TopLands(SlotWidths(ToothLine(proportions)))
    widths = np.concatenate([lands.width.ravel(), lands.slots.width.ravel()]) / blank.mean_normal_module
    angles = blank.pinion.dedendum_angle, blank.gear.dedendum_angle
    margins = [
        float(np.nanmin(widths)) - LEAST_LAND,  # NaN where a flank has no involute
        undercut_margin(blank) / blank.mean_normal_module - LEAST_MARGIN,
        LARGEST_DEDENDUM_ANGLE - max(map(abs, angles)),
    ]
    return min(margins)


def undercut_margin(blank: BlankDimensions) -> float:
    """Least height at the toe between a member's dedendum, without clearance, and that of the involute's start [mm]."""
    pressure = min(blank.generated_drive_pressure_angle, blank.generated_coast_pressure_angle)
    margins = []
    for member in (blank.pinion, blank.gear):
        distance = member.mean_cone_distance - member.inner_face_width
        radius = distance * math.tan(member.pitch_angle) / math.cos(member.inner_spiral_angle) ** 2
        dedendum = member.mean_dedendum - blank.clearance - member.inner_face_width * math.tan(member.dedendum_angle)
        margins.append(radius * math.sin(pressure) ** 2 - dedendum)
    return min(margins)
