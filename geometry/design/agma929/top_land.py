"""Widths of the top lands along the face."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from .slot_width import SlotWidths
from .tooth_line import ToothLine

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class TopLands:
    """Normal top lands of both members; arrays have the pinion first (AGMA 929-B22, 4.7).

    The tooth is that of a cylindrical gear in the normal section, with involutes on both sides; the gear cut without
    generation has straight ones, and the pinion's are fuller by what the mate's lack.

    Parameters
    ----------
    slots
        Slot widths of the pair.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> from easeoff.geometry.design.agma929.tooth_proportions import ToothProportions
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> lands = TopLands(SlotWidths(ToothLine(ToothProportions.of(blanks, 95.25, generated_gear=False))))
    >>> lands.width.shape
    (2, 3)
    """

    slots: SlotWidths

    @property
    def line(self) -> ToothLine:
        """The tooth along the face."""
        return self.slots.line

    def pinion_radius(self, pinion_distance: Array) -> Array:
        """Pitch radii of the pinion in the normal section (...) [mm] at its cone distances (164)."""
        spiral = self.line.pinion_spiral(self.line.on_gear(pinion_distance))
        return np.asarray(pinion_distance * math.tan(self.line.proportions.pitch_angle[0]) / np.cos(spiral) ** 2)

    def gear_radius(self, gear_distance: Array) -> Array:
        """Pitch radii of the gear in the normal section (...) [mm] at its cone distances (165)."""
        spiral = self.line.gear_spiral(gear_distance)
        return np.asarray(gear_distance * math.tan(self.line.proportions.pitch_angle[1]) / np.cos(spiral) ** 2)

    def pinion_thickness(self, pinion_distance: Array) -> Array:
        """Normal circular thicknesses of the pinion (...) [mm] at its cone distances (177)."""
        p, line, place = self.line.proportions, self.line, self.line.on_gear(pinion_distance)
        own = pinion_distance * np.cos(line.pinion_spiral(place))
        heel = line.pinion_places[2]
        outer = heel * math.cos(float(line.pinion_spiral(line.on_gear(np.asarray(heel)))))
        play = own / outer * self.slots.backlash / math.cos(p.half_included_angle)
        return np.asarray(line.gear_dedendum(place) * p.taper + self.slots.gear_width(place) - play)

    def gear_thickness(self, gear_distance: Array) -> Array:
        """Normal circular thicknesses of the gear (...) [mm] at its cone distances (178)."""
        p, line = self.line.proportions, self.line
        share = line.narrowing(gear_distance) / float(line.narrowing(line.gear_places)[2])
        play = share * self.slots.backlash / math.cos(p.half_included_angle)
        bottom = line.pinion_dedendum(gear_distance) * p.taper
        return np.asarray(bottom + self.slots.pinion_width(gear_distance) - play)

    def pinion_width(self, pinion_distance: Array) -> Array:
        """Top lands of the pinion (...) [mm] at its cone distances (179, 180)."""
        p, place = self.line.proportions, self.line.on_gear(pinion_distance)
        addendum, radius = self.line.pinion_addendum(place), self.pinion_radius(pinion_distance)
        width = self._involute(self.pinion_thickness(pinion_distance), radius, addendum)
        if p.generated_gear:
            return width
        thickness = self.gear_thickness(place)
        involute = self._involute(thickness, self.gear_radius(place), -addendum)
        return width + involute - (thickness + addendum * p.taper)

    def gear_width(self, gear_distance: Array) -> Array:
        """Top lands of the gear (...) [mm] at its cone distances (181, 182)."""
        addendum, thickness = self.line.gear_addendum(gear_distance), self.gear_thickness(gear_distance)
        if not self.line.proportions.generated_gear:
            return np.asarray(thickness - addendum * self.line.proportions.taper)
        return self._involute(thickness, self.gear_radius(gear_distance), addendum)

    def _involute(self, thickness: Array, radius: Array, height: Array) -> Array:
        """Thickness of an involute tooth above its pitch circle (...) [mm] (166 to 176, 179); NaN below its base."""
        p, angle = self.line.proportions, thickness / radius
        with np.errstate(invalid="ignore"):
            for pressure in (p.drive_pressure_angle, p.coast_pressure_angle):
                there = np.arccos(radius * math.cos(pressure) / (radius + height))
                angle = angle + (math.tan(pressure) - pressure) - (np.tan(there) - there)
        return np.asarray(angle * (radius + height))

    @cached_property
    def width(self) -> Array:
        """Top lands at toe, mean point and heel of pinion and gear (2, 3) [mm] (183 to 188); negative if pointed."""
        return np.stack([self.pinion_width(self.line.pinion_places), self.gear_width(self.line.gear_places)])
