"""Widths of the slots at their bottom along the face, and the blade points that fit them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from .tooth_line import ToothLine
from .tooth_proportions import ToothProportions

Array = NDArray[Any]

BLADE_OVERLAP = 0.025  # [mm] by which a blade point passes the middle of the slot, or two roughing blades one another


@frozen_arrays
@dataclass(frozen=True)
class SlotWidths:
    """Slot widths of both members; arrays have the pinion first (AGMA 929-B22, 4.4 and 4.5).

    Parameters
    ----------
    line
        The tooth along the face.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> slots = SlotWidths(ToothLine(ToothProportions.of(blanks, 95.25, generated_gear=False)))
    >>> slots.width.shape, bool(np.all(slots.least <= slots.greatest))
    ((2, 3), True)
    """

    line: ToothLine

    @property
    def proportions(self) -> ToothProportions:
        """Tooth proportions of the pair."""
        return self.line.proportions

    @cached_property
    def backlash(self) -> float:
        """Normal backlash at the heel (j_en) [mm] (51)."""
        p = self.proportions
        play = p.pitch - sum(p.mean_normal_thickness)
        return play * self._at_heel * math.cos(p.half_included_angle)

    @cached_property
    def _at_heel(self) -> float:
        return float(self.line.narrowing(self.line.gear_places)[2])

    def _play(self, gear_distance: Array) -> Array:
        """Backlash along the pitch line (...) [mm]."""
        share = self.line.narrowing(gear_distance) / self._at_heel
        return np.asarray(share * self.backlash / math.cos(self.proportions.half_included_angle))

    @property
    def clearance_change(self) -> Array:
        """What the backlash changes of the clearance at the toe of pinion and gear (2) [mm] (52, 53)."""
        p, line = self.proportions, self.line
        steep = math.sin(p.drive_pressure_angle) + math.sin(p.coast_pressure_angle)
        pinion = line.pinion_places * np.cos(line.pinion_spiral(line.on_gear(line.pinion_places)))
        gear = line.gear_places * np.cos(line.gear_spiral(line.gear_places))
        return np.asarray(self.backlash / steep * np.array([each[0] / each[2] for each in (pinion, gear)]))

    @cached_property
    def effective_width(self) -> float:
        """Width of the gear's slot that does not change along the face (W_eff) [mm] (64, 72)."""
        p = self.proportions
        mean = p.pitch - p.mean_normal_thickness[1] - sum(p.mean_dedendum) / 2.0 * p.taper
        mean -= (p.mean_addendum[0] - p.mean_addendum[1]) * math.tan(p.half_included_angle)
        return mean - p.rotation_factor * p.pitch / 2.0

    def gear_width(self, gear_distance: Array) -> Array:
        """Slot widths of the gear (...) [mm] at its cone distances (75)."""
        p, share = self.proportions, self.line.narrowing(gear_distance)
        of_the_tooth = share * (p.mean_normal_thickness[0] - p.mean_dedendum[1] * p.taper)
        return np.asarray(self.effective_width * (1.0 - share) + of_the_tooth + self._play(gear_distance))

    def pinion_width(self, gear_distance: Array) -> Array:
        """Slot widths of the pinion (...) [mm] at cone distances of the gear (76)."""
        p, line = self.proportions, self.line
        depth = line.pinion_dedendum(gear_distance) + line.gear_dedendum(gear_distance)
        filled = line.narrowing(gear_distance) * p.pitch - depth * p.taper - self.gear_width(gear_distance)
        return np.asarray(filled + self._play(gear_distance))

    @cached_property
    def width(self) -> Array:
        """Slot widths at toe, mean point and heel of pinion and gear (2, 3) [mm] (77 to 81)."""
        line = self.line
        return np.stack([self.pinion_width(line.on_gear(line.pinion_places)), self.gear_width(line.gear_places)])

    @cached_property
    def at_involute(self) -> Array:
        """Slot widths at the place of involute lengthwise curvature (2) [mm]; NaN if it is off the face (82 to 85)."""
        if not self.line.has_involute_point:
            return np.full(2, np.nan)
        place = np.asarray(self.line.involute_distance)
        return np.stack([self.pinion_width(place), self.gear_width(place)])

    @property
    def least(self) -> Array:
        """Least slot widths of pinion and gear (2) [mm] (86, 87)."""
        return np.asarray(self.width.min(axis=1))

    @property
    def greatest(self) -> Array:
        """Greatest slot widths of pinion and gear (2) [mm] (88, 89)."""
        return np.asarray(np.fmax(self.width.max(axis=1), self.at_involute))

    @property
    def limit_point_width(self) -> Array:
        """Largest point widths that fit the slots of pinion and gear, less the stock allowance (2) [mm] (90, 91)."""
        return np.asarray(self.least - np.array(self.proportions.stock_allowance))

    @property
    def roughing_blade_point(self) -> Array:
        """Least widths of the tips of roughing blades (2) [mm] (92, 93)."""
        return self.limit_point_width / 2.0 + BLADE_OVERLAP

    @property
    def finishing_blade_point(self) -> Array:
        """Widths of the tips of finishing blades (2) [mm] (94 to 97).

        Of a member finished in one cut the least ones, with which the two blades leave no fin in the middle; of others
        the greatest.
        """
        stock = np.array(self.proportions.stock_allowance)
        return np.where(stock == 0.0, self.least / 2.0 + BLADE_OVERLAP, self.least - stock)
