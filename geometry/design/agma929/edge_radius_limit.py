"""Largest edge radii of the cutters: no interference of fillets, blades that can be made, no mutilation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from .slot_width import SlotWidths
from .tooth_proportions import ToothProportions

Array = NDArray[Any]

LEAST_ROUGHING_RADIUS = 0.254  # [mm]
LIMITS = ("interference", "manufacture", "mutilation")


@frozen_arrays
@dataclass(frozen=True)
class EdgeRadiusLimits:
    """Limits of the edge radii (AGMA 929-B22, 4.6); arrays have members first (pinion, gear), then drive and coast.

    The drive side is the pinion's concave and the gear's convex flank.

    Parameters
    ----------
    slots
        Slot widths of the pair.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> from easeoff.geometry.design.agma929.tooth_line import ToothLine
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> limits = EdgeRadiusLimits(SlotWidths(ToothLine(ToothProportions.of(blanks, 95.25, generated_gear=False))))
    >>> bool(np.all(limits.largest > 0.25 * blanks.mean_normal_module))
    True
    """

    slots: SlotWidths

    @property
    def proportions(self) -> ToothProportions:
        """Tooth proportions of the pair."""
        return self.slots.proportions

    @property
    def pressure_angles(self) -> Array:
        """Of the drive and the coast side (2) [rad]."""
        return np.array([self.proportions.drive_pressure_angle, self.proportions.coast_pressure_angle])

    @property
    def inner_radius(self) -> Array:
        """Pitch radii at the toe in the normal section (r_i) (2) [mm] (100, 101)."""
        line = self.slots.line
        pinion, gear = line.pinion_places[0], line.gear_places[0]
        spiral = line.pinion_spiral(line.on_gear(pinion)), line.gear_spiral(gear)
        pitch = np.tan(self.proportions.pitch_angle)
        return np.asarray(np.array([pinion, gear]) * pitch / np.cos(np.array(spiral)) ** 2)

    @property
    def inner_dedendum(self) -> Array:
        """Dedenda at the toe (2) [mm] (58 to 60)."""
        line = self.slots.line
        pinion = line.pinion_dedendum(line.on_gear(line.pinion_places[0]))
        return np.array([float(pinion), float(line.gear_dedendum(line.gear_places[0]))])

    @property
    def shift(self) -> Array:
        """Shares of both members in the approach that takes up the backlash at the toe (2) [mm] (104, 105)."""
        p = self.proportions
        own = np.array(p.number_of_teeth) * np.cos(np.array(p.pitch_angle)[::-1])
        return np.asarray(self.slots.clearance_change[::-1] * own / own.sum())

    @cached_property
    def interference_height(self) -> Array:
        """Heights above the root, at the toe, to which the fillet may reach (h_inf) (2, 2) [mm] (106 to 127).

        Where the mate's tip ends on the line of action with the backlash taken up; beside a gear cut without
        generation, what is left of the clearance.
        """
        p, radius, dedendum = self.proportions, self.inner_radius, self.inner_dedendum
        tip = radius + dedendum[::-1] - p.clearance
        adjusted = radius - self.shift
        pressure = np.arccos(radius[0] * np.cos(self.pressure_angles) / adjusted[0])
        base = np.multiply.outer(radius, np.cos(self.pressure_angles))
        curvature = adjusted.sum() * np.sin(pressure) - np.sqrt(tip[:, None] ** 2 - base**2)[::-1]
        height = base * np.cos(self.pressure_angles) + curvature * np.sin(self.pressure_angles)
        height = height + (dedendum - radius)[:, None]
        if not p.generated_gear:
            height[0] = p.clearance - self.slots.clearance_change[0]
        return np.asarray(height)

    @property
    def by_interference(self) -> Array:
        """Largest edge radii with which no fillet meets the mate's tip (2, 2) [mm] (128 to 131)."""
        return self.interference_height / (1.0 - np.sin(self.pressure_angles))

    def fillet_clearance(self, edge_radius: Array) -> Array:
        """Heights left between the end of the fillet and the mate's tip at the toe (2, 2) [mm]; negative if they meet.

        Parameters
        ----------
        edge_radius
            Of the blades of pinion and gear (2) [mm].
        """
        return self.interference_height - np.multiply.outer(edge_radius, 1.0 - np.sin(self.pressure_angles))

    @cached_property
    def by_manufacture(self) -> Array:
        """Largest edge radii that fit the tips of the blades (2, 2) [mm] (136 to 147); zero where none does."""
        p, lean = self.proportions, self._lean
        finishing = np.maximum(0.0, np.divide.outer(self.slots.finishing_blade_point - p.blade_flat, lean))
        stock = np.array(p.stock_allowance)
        roughing = (self.slots.roughing_blade_point - p.blade_flat) / lean[0]
        roughed = np.maximum(roughing, LEAST_ROUGHING_RADIUS)[:, None] + np.divide.outer(0.5 * stock, lean)
        return np.asarray(np.where(stock[:, None] == 0.0, finishing, np.minimum(finishing, roughed)))

    @cached_property
    def by_mutilation(self) -> Array:
        """Largest edge radii with which one blade leaves the fillet of the other whole (2, 2) [mm] (152 to 161).

        NaN where the blade point is too wide for any.
        """
        p, lean = self.proportions, self._lean
        past = np.multiply.outer(self.slots.least - self.slots.finishing_blade_point, lean)
        depth = p.fillet_mutilation
        with np.errstate(invalid="ignore"):
            return np.asarray((depth + past + np.sqrt(depth**2 + 2.0 * depth * past)) / lean**2)

    @property
    def _lean(self) -> Array:
        """Width of the blade's tip that an edge radius of one takes (2)."""
        return 1.0 / np.cos(self.pressure_angles) - np.tan(self.pressure_angles)

    @property
    def largest(self) -> Array:
        """Largest edge radii of pinion and gear (2) [mm] (98, 99)."""
        return np.asarray(self._limits.min(axis=0))

    @property
    def _limits(self) -> Array:
        """Largest edge radii by each of ``LIMITS``, for pinion and gear (3, 2) [mm]."""
        return np.array([each.min(axis=1) for each in (self.by_interference, self.by_manufacture, self.by_mutilation)])

    @property
    def governing(self) -> tuple[str, str]:
        """What limits the edge radii of pinion and gear: interference, manufacture or mutilation."""
        pinion, gear = np.argmin(self._limits, axis=0)
        return LIMITS[pinion], LIMITS[gear]
