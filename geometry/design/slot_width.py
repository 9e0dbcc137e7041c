"""The tooth along the face: widths of slots and top lands, and the blade points and edge radii that fit them.

A place is given by the cone distance of one member. Pinion and gear touch in the pitch plane, in which the tooth
line of the gear is that of its crown gear; the pinion's apex lies beside the gear's by the offset.

Edge radii are bounded by the interference of fillets, by blades that can be made, and by mutilation. Where a design
gives none, the cutter's blades get that of the basic rack, as far as it fits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...core.arrays import Array, record
from ...core.errors import GeometryError
from ..pair.gear_pair import MEMBERS, GearPair
from ..pair.tooth_thickness import unmet_tips
from ..tooth.tooth_flanks import MemberName
from ..tooth.tooth_surface import tooth_surface
from .closest_fit import StandardSteps
from .iso23509.pitch_cones import CrownGear, crown_gear
from .tooth_proportions import ToothProportions, measured_proportions

PLACES = ("toe", "mean", "heel")


@dataclass(frozen=True)
class ToothLine:
    """Tooth of a pair along the face (AGMA 929-B22, 4.1 to 4.4)."""

    proportions: ToothProportions

    @cached_property
    def crown(self) -> CrownGear:
        """The crown gear. Raises GeometryError if the cutter is too small for its blade groups."""
        p = self.proportions
        return crown_gear(p, p.pitch_angle[1], p.mean_cone_distance[1], p.gear_spiral_angle)

    @property
    def pinion_places(self) -> Array:
        """Cone distances of the pinion at toe, mean point and heel (3) [mm] (5)."""
        return self._places(0)

    @property
    def gear_places(self) -> Array:
        """Cone distances of the gear at toe, mean point and heel (3) [mm] (6)."""
        return self._places(1)

    def _places(self, member: int) -> Array:
        p = self.proportions
        outer = p.outer_cone_distance[member]
        return np.array([outer - p.face_width[member], p.mean_cone_distance[member], outer])

    @property
    def involute_distance(self) -> float:
        """Cone distance of the gear where its tooth line is curved as an involute (R_x2) [mm] (39, 46)."""
        return self.crown.involute_cone_distance

    def on_gear(self, pinion_distance: Array) -> Array:
        """Cone distances of the gear (...) [mm] at those of the pinion (16)."""
        p = self.proportions
        beyond = pinion_distance - p.mean_cone_distance[0]
        mean = p.mean_cone_distance[1]
        return np.asarray(np.sqrt(mean**2 + beyond**2 + 2.0 * mean * beyond * math.cos(p.offset_angle)))

    def on_pinion(self, gear_distance: Array) -> Array:
        """Cone distances of the pinion (...) [mm] at those of the gear (55); the inverse of ``on_gear``."""
        p = self.proportions
        along = gear_distance * np.cos(self.offset_angle(gear_distance))
        return np.asarray(p.mean_cone_distance[0] + along - p.mean_cone_distance[1] * math.cos(p.offset_angle))

    def offset_angle(self, gear_distance: Array) -> Array:
        """Offset angles in the pitch plane (...) [rad] (33)."""
        p = self.proportions
        return np.asarray(np.arcsin(p.mean_cone_distance[1] * math.sin(p.offset_angle) / gear_distance))

    def gear_spiral(self, gear_distance: Array) -> Array:
        """Spiral angles of the gear (...) [rad] (22, 30). Raises GeometryError where the cutter does not reach."""
        return _each(self.crown.spiral_angle, gear_distance)

    def pinion_spiral(self, gear_distance: Array) -> Array:
        """Spiral angles of the pinion (...) [rad] at cone distances of the gear (34)."""
        return self.gear_spiral(gear_distance) + self.offset_angle(gear_distance)

    def narrowing(self, gear_distance: Array) -> Array:
        """Normal pitch over that at the gear's mean point (...), by the cone distance of the gear."""
        p = self.proportions
        mean = p.mean_cone_distance[1] * math.cos(p.gear_spiral_angle)
        return np.asarray(gear_distance * np.cos(self.gear_spiral(gear_distance)) / mean)

    def pinion_dedendum(self, gear_distance: Array) -> Array:
        """Dedendum of the pinion (...) [mm] (58)."""
        p = self.proportions
        beyond = self.on_pinion(gear_distance) - p.mean_cone_distance[0]
        return np.asarray(p.mean_dedendum[0] + beyond * math.tan(p.dedendum_angle[0]))

    def gear_dedendum(self, gear_distance: Array) -> Array:
        """Dedendum of the gear (...) [mm] (59, 60)."""
        p = self.proportions
        straight = p.mean_dedendum[1] + (gear_distance - p.mean_cone_distance[1]) * math.tan(p.dedendum_angle[1])
        return np.asarray(straight if p.generated_gear else straight - self._rise(gear_distance))

    def _rise(self, gear_distance: Array) -> Array:
        """Rise of a Formate cutter's flat path above the root cone towards the ends (...) [mm] (48, 54, 57)."""
        p = self.proportions
        blade = p.half_included_angle if p.inside_blade_angle is None else p.inside_blade_angle
        tilt = math.tan(blade - p.drive_pressure_angle) / (2.0 * p.cutter_radius * math.cos(p.gear_spiral_angle) ** 2)
        turned = _each(self.crown.generating_angle, gear_distance)
        turned = turned - self.crown.generating_angle(p.mean_cone_distance[1])
        root = math.tan(p.pitch_angle[1] - p.dedendum_angle[1])
        beyond = gear_distance - p.mean_cone_distance[1]
        return np.asarray(tilt * beyond**2 + gear_distance * np.sin(turned) ** 2 / (2.0 * root))

    def pinion_addendum(self, gear_distance: Array) -> Array:
        """Addendum of the pinion (...) [mm] (62)."""
        return self.gear_dedendum(gear_distance) - self.proportions.clearance

    def gear_addendum(self, gear_distance: Array) -> Array:
        """Addendum of the gear (...) [mm] (63)."""
        return self.pinion_dedendum(gear_distance) - self.proportions.clearance


def _each(function: Callable[[float], float], values: Array) -> Array:
    """A function of one number at each of an array."""
    return np.asarray(np.vectorize(function, otypes=[float])(values))


BLADE_OVERLAP = 0.025  # [mm] by which a blade point passes the middle of the slot, or two roughing blades one another


@record(frozen=True)
class SlotWidths:
    """Slot widths of both members; arrays have the pinion first (AGMA 929-B22, 4.4 and 4.5)."""

    line: ToothLine

    @cached_property
    def backlash(self) -> float:
        """Normal backlash at the heel (j_en) [mm] (51)."""
        p = self.line.proportions
        return (p.pitch - sum(p.mean_normal_thickness)) * self._at_heel * math.cos(p.half_included_angle)

    @cached_property
    def _at_heel(self) -> float:
        return float(self.line.narrowing(self.line.gear_places)[2])

    def play(self, gear_distance: Array) -> Array:
        """Backlash along the pitch line (...) [mm]."""
        share = self.line.narrowing(gear_distance) / self._at_heel
        return np.asarray(share * self.backlash / math.cos(self.line.proportions.half_included_angle))

    @property
    def clearance_change(self) -> Array:
        """Change of the clearance by the backlash at the toe of pinion and gear (2) [mm] (52, 53)."""
        p, line = self.line.proportions, self.line
        steep = math.sin(p.drive_pressure_angle) + math.sin(p.coast_pressure_angle)
        pinion = line.pinion_places * np.cos(line.pinion_spiral(line.on_gear(line.pinion_places)))
        gear = line.gear_places * np.cos(line.gear_spiral(line.gear_places))
        return np.asarray(self.backlash / steep * np.array([each[0] / each[2] for each in (pinion, gear)]))

    @cached_property
    def effective_width(self) -> float:
        """Width of the gear's slot that does not change along the face (W_eff) [mm] (64, 72)."""
        p = self.line.proportions
        mean = p.pitch - p.mean_normal_thickness[1] - sum(p.mean_dedendum) / 2.0 * p.taper
        mean -= (p.mean_addendum[0] - p.mean_addendum[1]) * math.tan(p.half_included_angle)
        return mean - p.rotation_factor * p.pitch / 2.0

    def gear_width(self, gear_distance: Array) -> Array:
        """Slot widths of the gear (...) [mm] at its cone distances (75)."""
        p, share = self.line.proportions, self.line.narrowing(gear_distance)
        of_the_tooth = share * (p.mean_normal_thickness[0] - p.mean_dedendum[1] * p.taper)
        return np.asarray(self.effective_width * (1.0 - share) + of_the_tooth + self.play(gear_distance))

    def pinion_width(self, gear_distance: Array) -> Array:
        """Slot widths of the pinion (...) [mm] at cone distances of the gear (76)."""
        p, line = self.line.proportions, self.line
        depth = line.pinion_dedendum(gear_distance) + line.gear_dedendum(gear_distance)
        filled = line.narrowing(gear_distance) * p.pitch - depth * p.taper - self.gear_width(gear_distance)
        return np.asarray(filled + self.play(gear_distance))

    @cached_property
    def width(self) -> Array:
        """Slot widths at toe, mean point and heel of pinion and gear (2, 3) [mm] (77 to 81)."""
        line = self.line
        return np.stack([self.pinion_width(line.on_gear(line.pinion_places)), self.gear_width(line.gear_places)])

    @cached_property
    def at_involute(self) -> Array:
        """Slot widths at the place of involute lengthwise curvature (2) [mm]; NaN if it is off the face (82 to 85)."""
        (toe, _, heel), place = self.line.gear_places, np.asarray(self.line.involute_distance)
        if not toe < place < heel:
            return np.full(2, np.nan)
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
    def roughing_blade_point(self) -> Array:
        """Least widths of the tips of roughing blades (2) [mm] (90 to 93): slots less the stock allowance, halved."""
        return np.asarray((self.least - np.array(self.line.proportions.stock_allowance)) / 2.0 + BLADE_OVERLAP)

    @property
    def finishing_blade_point(self) -> Array:
        """Widths of the tips of finishing blades (2) [mm] (94 to 97).

        The least ones, which leave no fin, for a member finished in one cut; the greatest for others.
        """
        stock = np.array(self.line.proportions.stock_allowance)
        return np.where(stock == 0.0, self.least / 2.0 + BLADE_OVERLAP, self.least - stock)


LEAST_ROUGHING_RADIUS = 0.254  # [mm]
LIMITS = ("interference", "manufacture", "mutilation")


@record(frozen=True)
class EdgeRadiusLimits:
    """Limits of the edge radii by (pinion, gear), then (drive, coast) (AGMA 929-B22, 4.6).

    The drive side is the pinion's concave and the gear's convex flank.
    """

    slots: SlotWidths

    @property
    def pressure_angles(self) -> Array:
        """Of the drive and the coast side (2) [rad]."""
        p = self.slots.line.proportions
        return np.array([p.drive_pressure_angle, p.coast_pressure_angle])

    @property
    def inner_radius(self) -> Array:
        """Pitch radii at the toe in the normal section (r_i) (2) [mm] (100, 101)."""
        line = self.slots.line
        pinion, gear = line.pinion_places[0], line.gear_places[0]
        spiral = line.pinion_spiral(line.on_gear(pinion)), line.gear_spiral(gear)
        pitch = np.tan(line.proportions.pitch_angle)
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
        p = self.slots.line.proportions
        weights = np.array(p.number_of_teeth) * np.cos(np.array(p.pitch_angle)[::-1])
        return np.asarray(self.slots.clearance_change[::-1] * weights / weights.sum())

    @cached_property
    def interference_height(self) -> Array:
        """Heights above the root at the toe to which the fillet may reach (h_inf) (2, 2) [mm] (106 to 127).

        The mate's tip ends there on the line of action with the backlash taken up; beside a gear cut without generation
        it is the clearance that is left.
        """
        p, radius, dedendum = self.slots.line.proportions, self.inner_radius, self.inner_dedendum
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
        """Heights from the end of the fillet to the mate's tip at the toe (2, 2) [mm]; negative if they meet."""
        return self.interference_height - np.multiply.outer(edge_radius, 1.0 - np.sin(self.pressure_angles))

    @cached_property
    def by_manufacture(self) -> Array:
        """Largest edge radii that fit the tips of the blades (2, 2) [mm] (136 to 147); zero where none does."""
        p, lean = self.slots.line.proportions, self._lean
        finishing = np.maximum(0.0, np.divide.outer(self.slots.finishing_blade_point - p.blade_flat, lean))
        stock = np.array(p.stock_allowance)
        roughing = (self.slots.roughing_blade_point - p.blade_flat) / lean[0]
        roughed = np.maximum(roughing, LEAST_ROUGHING_RADIUS)[:, None] + np.divide.outer(0.5 * stock, lean)
        return np.asarray(np.where(stock[:, None] == 0.0, finishing, np.minimum(finishing, roughed)))

    @cached_property
    def by_mutilation(self) -> Array:
        """Largest edge radii that spare the other blade's fillet (2, 2) [mm] (152 to 161); NaN for too wide a point."""
        p, lean = self.slots.line.proportions, self._lean
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
        """Limit that governs the edge radii of pinion and gear: interference, manufacture or mutilation."""
        pinion, gear = np.argmin(self._limits, axis=0)
        return LIMITS[pinion], LIMITS[gear]


@record(frozen=True)
class TopLands:
    """Normal top lands of both members; arrays have the pinion first (AGMA 929-B22, 4.7).

    The tooth is a cylindrical gear's in the normal section, with involutes; a gear cut without generation has straight
    flanks, and the pinion's are fuller by that difference.
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
        lever = pinion_distance * np.cos(line.pinion_spiral(place))
        heel = line.pinion_places[2]
        outer = heel * math.cos(float(line.pinion_spiral(line.on_gear(np.asarray(heel)))))
        play = lever / outer * self.slots.backlash / math.cos(p.half_included_angle)
        return np.asarray(line.gear_dedendum(place) * p.taper + self.slots.gear_width(place) - play)

    def gear_thickness(self, gear_distance: Array) -> Array:
        """Normal circular thicknesses of the gear (...) [mm] at its cone distances (178)."""
        bottom = self.line.pinion_dedendum(gear_distance) * self.line.proportions.taper
        return np.asarray(bottom + self.slots.pinion_width(gear_distance) - self.slots.play(gear_distance))

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


ToothCheck = Callable[[GearPair, MemberName], None]

BASIC_RACK_RADIUS = 0.25  # over the mean normal module
SMALLEST_SHARE = 0.05  # of an edge radius over the module: a tooth is never without a fillet
UNMET_LIMIT = 0.02  # share of a tip; a corner at the toe does no harm
REDUCTIONS = (1.0, 0.8, 0.6, 0.45, 0.3, 0.2)  # of the usual radius, until the tooth has its fillets
WHOLE_TOOTH_NODES, WHOLE_FILLET_NODES = (9, 7), 25


def usual_edge_radii(proportions: ToothProportions) -> tuple[float, float]:
    """Edge radii of the blades of pinion and gear [mm]: ISO 53:1998, profile C, within AGMA 929-B22.

    That is a quarter of the mean normal module, less where a fillet would meet the mate's tip, the blade could not be
    made, or one would cut into the other's fillet.
    """
    limits = EdgeRadiusLimits(SlotWidths(ToothLine(proportions)))
    least, usual = (share * proportions.mean_normal_module for share in (SMALLEST_SHARE, BASIC_RACK_RADIUS))
    pinion, gear = (max(least, min(usual, float(np.nan_to_num(limit)))) for limit in limits.largest)
    return round(pinion, 4), round(gear, 4)


def allowed_edge_radius(pair: GearPair, member: MemberName, usual: float) -> float:
    """Usual edge radius, or a smaller one where AGMA 929-B22 allows less for the slots as they were cut [mm]."""
    try:
        proportions = measured_proportions(pair)
    except GeometryError:  # no mean point to measure at
        return usual
    limit = float(EdgeRadiusLimits(SlotWidths(ToothLine(proportions))).largest[MEMBERS.index(member)])
    return min(usual, max(SMALLEST_SHARE * proportions.mean_normal_module, limit)) if np.isfinite(limit) else usual


def require_whole_tooth(pair: GearPair, member: MemberName) -> None:
    """Refuse a member whose flanks and fillets make no whole tooth (GeometryError)."""
    tooth_surface(pair, member, WHOLE_TOOTH_NODES, WHOLE_FILLET_NODES)


def fitting_edge_radius(
    pairs: Sequence[GearPair], member: MemberName, usual: float, require: ToothCheck, steps: StandardSteps
) -> tuple[float, bool]:
    """Usual edge radius, made smaller until the tooth passes ``require`` and the mate's tips meet its flanks [mm].

    ``pairs`` are those of drive and coast side. Else the largest that passes ``require``, the usual one if none does;
    and if one did.
    """
    whole: float | None = None
    for share in REDUCTIONS:
        radius = steps.edge(share * usual)
        rounded = [_rounded(pair, member, radius) for pair in pairs]
        with suppress(GeometryError):
            require(rounded[0], member)
            whole = radius if whole is None else whole
            if all(unmet_tips(pair)[MEMBERS[::-1].index(member)] <= UNMET_LIMIT for pair in rounded):
                return round(radius, 4), True
    return (usual, False) if whole is None else (round(whole, 4), True)


def _rounded(pair: GearPair, name: str, radius: float) -> GearPair:
    """The pair with an edge radius on both blades of one member."""
    member = pair.pinion if name == "pinion" else pair.gear
    opposite = None if member.opposite is None else member.opposite.rounded(radius)
    changed = replace(member, loaded=member.loaded.rounded(radius), opposite=opposite)
    return replace(pair, pinion=changed) if name == "pinion" else replace(pair, gear=changed)
