"""Tables of a case file for the cutting of a flank: blade, machine and motions."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated

from pydantic import Field

from .schema_table import Table, number, optional

#: Keys of the modified roll, from the second derivative of the work rotation on.
ROLL_KEYS = ("modified_roll_2c", "modified_roll_6d", "modified_roll_24e", "modified_roll_120f", "modified_roll_720g")
RELIEFS = ("toprem", "flankrem")
#: Moving settings that are angles.
ANGULAR_MOTIONS = ("machine_root_angle", "cutter_tilt", "cutter_swivel")


def polynomial(derivatives: Iterable[float], first: int = 1, unit: float = 1.0) -> tuple[float, ...]:
    """Coefficients of a polynomial from its derivatives at zero, of the order ``first`` and the next, in a unit."""
    return tuple(unit * value / math.factorial(order) for order, value in enumerate(derivatives, start=first))


def polynomial_derivatives(coefficients: Iterable[float], first: int = 1, unit: float = 1.0) -> tuple[float, ...]:
    """The inverse of ``polynomial``."""
    return tuple(unit * value * math.factorial(order) for order, value in enumerate(coefficients, start=first))


def blade_field(key: str) -> str:
    """Field of ``Blade`` that is a key of a cutter: the key without its prefix."""
    return key.removeprefix("blade_").removeprefix("tool_")


class Cutter(Table):
    """The blade of a cutter: its profile, its reliefs and its edge radius."""

    blade_point_radius: float = number("radius of the blade tip", "mm", gt=1, lt=2000)
    blade_pressure_angle: float = number("between blade edge and cutter axis", "deg", gt=-45, lt=60)
    number_of_blade_groups: int = number("face hobbing; zero for face milling", "1", default=0, ge=0, le=100)
    blade_offset_angle: float = number(
        "face hobbing: blade tip off the radial direction", "deg", default=0.0, gt=-60, lt=60
    )
    blade_rake_angle: float = number("face hobbing: turn about the cutter axis", "deg", default=0.0, gt=-60, lt=60)
    blade_hook_angle: float = number("face hobbing: turn about the radial direction", "deg", default=0.0, gt=-60, lt=60)
    blade_spheric_radius: float | None = optional(
        "circular profile, positive for a hollow edge, whose pressure angle grows towards the shank; "
        "straight if left out",
        "mm",
        gt=-1e7,
        lt=1e7,
    )
    blade_reference_height: float = number(
        "where a circular profile has the pressure angle, above the tip plane", "mm", default=0.0, gt=-50, lt=100
    )
    tool_edge_radius: float = number("between profile and tip land", "mm", default=0.0, ge=0, lt=20)
    toprem_depth: float | None = optional("where it begins, above the tip plane", "mm", gt=0, lt=50)
    toprem_angle: float = number("decrease of the pressure angle", "deg", default=0.0, ge=0, lt=30)
    toprem_radius: float | None = optional("of its arc; straight if left out", "mm", gt=0.1, lt=1e7)
    flankrem_depth: float | None = optional("where it begins, above the tip plane", "mm", gt=0, lt=100)
    flankrem_angle: float = number("increase of the pressure angle", "deg", default=0.0, ge=0, lt=30)
    flankrem_radius: float | None = optional("of its arc; straight if left out", "mm", gt=0.1, lt=1e7)

    def _check(self) -> None:
        turned = (self.blade_offset_angle, self.blade_rake_angle, self.blade_hook_angle)
        if self.number_of_blade_groups == 0 and any(turned):
            raise ValueError(
                "blade_offset_angle, blade_rake_angle and blade_hook_angle belong to face hobbing: give "
                "number_of_blade_groups"
            )
        for name in RELIEFS:
            begins = getattr(self, f"{name}_depth") is not None
            changes = bool(getattr(self, f"{name}_angle")) or getattr(self, f"{name}_radius") is not None
            if changes and not begins:
                raise ValueError(f"{name}_angle and {name}_radius need {name}_depth, where the {name} begins")
            if begins and not changes:
                raise ValueError(f"{name}_depth needs {name}_angle or {name}_radius: without them it changes nothing")
        if self.blade_spheric_radius is not None and not abs(self.blade_spheric_radius) > 1.0:
            raise ValueError(f"blade_spheric_radius = {self.blade_spheric_radius}: must be above 1 mm or below -1 mm")
        if self.blade_spheric_radius is None and self.blade_reference_height:
            raise ValueError("blade_reference_height belongs to a circular profile: give blade_spheric_radius")


Derivatives = Annotated[tuple[float, ...], Field(strict=False, max_length=6)]


class Motions(Table):
    """Higher-order motions of a generated member: derivatives of settings by the cradle increment, first to sixth.

    A setting is its basic value plus the sum of derivative times increment^n / n!.
    """

    radial_distance: Derivatives = number("radial motion", "mm/rad^n", default=())
    work_offset: Derivatives = number("vertical motion", "mm/rad^n", default=())
    sliding_base: Derivatives = number("helical motion", "mm/rad^n", default=())
    machine_center_to_crossing_point: Derivatives = number("axial motion", "mm/rad^n", default=())
    machine_root_angle: Derivatives = number("angular motion", "deg/rad^n", default=())
    cutter_tilt: Derivatives = number("tilt motion", "deg/rad^n", default=())
    cutter_swivel: Derivatives = number("swivel motion", "deg/rad^n", default=())


class Machine(Table):
    """Basic settings of the cradle machine, standard Gleason meaning."""

    radial_distance: float | None = optional("cutter centre to cradle axis", "mm", ge=0, lt=5000)
    cradle_angle: float | None = optional("positive for both hands", "deg", ge=-180, le=180)
    horizontal_distance: float | None = optional("Formate: cutter centre along the root line", "mm", gt=-5000, lt=5000)
    vertical_distance: float | None = optional("Formate: cutter centre across the root line", "mm", gt=-5000, lt=5000)
    machine_root_angle: float = number("machine root angle", "deg", ge=-45, le=120)
    work_offset: float = number("blank offset", "mm", default=0.0, gt=-500, lt=500)
    sliding_base: float = number("sliding base", "mm", default=0.0, gt=-1000, lt=1000)
    machine_center_to_crossing_point: float = number(
        "machine centre to back, along the work axis", "mm", default=0.0, gt=-1000, lt=1000
    )
    cutter_tilt: float = number("of the cutter axis", "deg", default=0.0, ge=-90, le=90)
    cutter_swivel: float = number("direction of the tilt", "deg", default=0.0, ge=-360, le=360)
    ratio_of_roll: float | None = optional("work over cradle rotation; left out for Formate", "1", gt=0, lt=100)
    modified_roll_2c: float = number("second order", "1", default=0.0, gt=-10, lt=10)
    modified_roll_6d: float = number("third order", "1", default=0.0, gt=-100, lt=100)
    modified_roll_24e: float = number("fourth order", "1", default=0.0, gt=-1000, lt=1000)
    modified_roll_120f: float = number("fifth order", "1", default=0.0, gt=-1e4, lt=1e4)
    modified_roll_720g: float = number("sixth order", "1", default=0.0, gt=-1e5, lt=1e5)
    motions: Motions = Motions()

    def _check(self) -> None:
        polar = (self.radial_distance, self.cradle_angle)
        straight = (self.horizontal_distance, self.vertical_distance)
        if any(v is not None for v in straight):
            if any(v is not None for v in polar) or None in straight:
                raise ValueError(
                    "the cutter centre is given either by radial_distance and cradle_angle, or (Formate) by "
                    "horizontal_distance and vertical_distance"
                )
            if self.ratio_of_roll is not None:
                raise ValueError(
                    "horizontal_distance and vertical_distance belong to a Formate member, which has no "
                    "ratio_of_roll: give radial_distance and cradle_angle instead"
                )
        elif None in polar:
            raise ValueError(
                "the cutter centre is missing: give radial_distance and cradle_angle, or (Formate) "
                "horizontal_distance and vertical_distance"
            )
        if self.ratio_of_roll is None and any(self.modified_roll):
            raise ValueError("modified roll is given without ratio_of_roll: a Formate member does not roll")
        if self.ratio_of_roll is None and any(self.motions.model_dump().values()):
            raise ValueError("motions are given without ratio_of_roll: nothing moves while a Formate member is cut")

    @property
    def modified_roll(self) -> tuple[float, ...]:
        """The derivatives 2C, 6D, 24E, ... as given."""
        return tuple(getattr(self, key) for key in ROLL_KEYS)


class FlankSettings(Table):
    """Machine settings and cutter of one flank."""

    machine: Machine
    cutter: Cutter
