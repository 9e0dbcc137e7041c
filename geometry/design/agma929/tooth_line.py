"""The tooth along the face: where the ends of both members meet, spiral angles, dedenda and addenda there.

A place is given by the cone distance of one member. Pinion and gear touch in the pitch plane, in which the tooth
line of the gear is that of its crown gear; the pinion's apex lies beside the gear's by the offset.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..iso23509.crown_gear import CrownGear, crown_gear
from .tooth_proportions import ToothProportions

Array = NDArray[Any]

PLACES = ("toe", "mean", "heel")


@dataclass(frozen=True)
class ToothLine:
    """The tooth of a pair along the face (AGMA 929-B22, 4.1 to 4.4).

    Parameters
    ----------
    proportions
        Tooth proportions of the pair.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> line = ToothLine(ToothProportions.of(blanks, 95.25, generated_gear=False))
    >>> bool(np.allclose(line.on_pinion(line.on_gear(line.pinion_places)), line.pinion_places))
    True
    """

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

    @property
    def has_involute_point(self) -> bool:
        """Whether that place lies on the gear's face."""
        toe, _, heel = self.gear_places
        return bool(toe < self.involute_distance < heel)

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
        beyond = gear_distance - p.mean_cone_distance[1]
        straight = p.mean_dedendum[1] + beyond * math.tan(p.dedendum_angle[1])
        return np.asarray(straight if p.generated_gear else straight - self._rise(gear_distance))

    def _rise(self, gear_distance: Array) -> Array:
        """What the flat path of a Formate cutter rises above the root cone towards the ends (...) [mm] (48, 54, 57)."""
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
