"""A cylindrical section of a shaft, solid or hollow."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...core.checks import number, shown
from ...core.errors import InputError

POSITION_LIMIT = 5000.0  # along the axis, either way [mm]
DIAMETER_RANGE = (1.0, 2000.0)  # [mm]
WALL_MINIMUM = 0.01  # outer less inner diameter over the outer one


def shear_coefficient(diameter_ratio: float, poisson_ratio: float) -> float:
    """Cowper's shear coefficient of a section by inner over outer diameter (1966, doi:10.1115/1.3625046)."""
    ratio, nu = diameter_ratio**2, poisson_ratio
    ring = (1.0 + ratio) ** 2
    return 6.0 * (1.0 + nu) * ring / ((7.0 + 6.0 * nu) * ring + (20.0 + 12.0 * nu) * ratio)


@dataclass(frozen=True)
class ShaftSection:
    """A cylindrical section of a shaft, from start to end along its axis [mm]."""

    start: float
    end: float
    outer_diameter: float
    inner_diameter: float = 0.0

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            number(name, getattr(self, name), "mm", least=-POSITION_LIMIT, most=POSITION_LIMIT)
        least, most = DIAMETER_RANGE
        number("outer_diameter", self.outer_diameter, "mm", least=least, most=most)
        number("inner_diameter", self.inner_diameter, "mm", least=0.0)
        if self.end <= self.start:
            raise InputError(f"end = {shown(self.end)}: must be greater than start = {shown(self.start)} [mm]")
        if self.inner_diameter >= self.outer_diameter:
            raise InputError(
                f"inner_diameter = {shown(self.inner_diameter)}: must be smaller than outer_diameter = "
                f"{shown(self.outer_diameter)} [mm]"
            )
        if self.inner_diameter > (1.0 - WALL_MINIMUM) * self.outer_diameter:
            raise InputError(
                f"inner_diameter = {shown(self.inner_diameter)}: must leave a wall, at most "
                f"{shown((1.0 - WALL_MINIMUM) * self.outer_diameter)} [mm]"
            )

    @property
    def area(self) -> float:
        """Area of the cross section [mm^2]."""
        return math.pi / 4.0 * (self.outer_diameter**2 - self.inner_diameter**2)

    @property
    def second_moment(self) -> float:
        """Second moment of area about a diameter [mm^4]; the polar one is twice that."""
        return math.pi / 64.0 * (self.outer_diameter**4 - self.inner_diameter**4)
