"""A bearing on a shaft: radial, axial and tilting stiffness, constant or from curves of displacement over load."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...core.arrays import RealArray as Array
from ...core.checks import array, number, shown
from ...core.errors import InputError
from ..lines.monotone_cubic import MonotoneCubic
from .shaft_section import POSITION_LIMIT

STIFFNESS_LIMIT = 1e15  # [N/mm, N mm/rad]
POINT_COUNT_LIMIT = 1000  # of a curve


@dataclass(frozen=True)
class StiffnessCurve:
    """Stiffness of a bearing that depends on its load, by increasing loads and displacements.

    A monotone cubic on logarithmic scales, exact for a power law such as that of a line contact; beyond the loads the
    stiffness is that of the curve's end.
    """

    load: tuple[float, ...]  # [N, or N mm]
    displacement: tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("load", "displacement"):
            values = array(name, getattr(self, name), "N, mm, N mm, rad", ndim=1, fewest=2, above=0.0)
            if np.any(np.diff(values) <= 0.0):
                raise InputError(f"{name} = {shown(values)}: must increase from point to point")
            object.__setattr__(self, name, tuple(values.tolist()))
        if not len(self.load) == len(self.displacement) <= POINT_COUNT_LIMIT:
            raise InputError(
                f"{len(self.load)} loads and {len(self.displacement)} displacements: must be as many of both, at most "
                f"{POINT_COUNT_LIMIT}"
            )

    @classmethod
    def of_stiffness(cls, points: Sequence[tuple[float, float]]) -> StiffnessCurve:
        """The curve of points (load, load over displacement), refused if the displacement falls."""
        table = array("points", points, "N, N/mm", ndim=2, above=0.0)
        if table.shape[1] != 2:
            raise InputError(f"points = {shown(points)}: must be pairs of load and stiffness")
        displacement = table[:, 0] / table[:, 1]
        for (before, now), (load, stiffness) in zip(itertools.pairwise(displacement), table[1:], strict=True):
            if now <= before:
                raise InputError(
                    f"stiffness {shown(stiffness)} at load {shown(load)}: must be load over displacement, smaller than "
                    f"{shown(load / before)}: with it the displacement would not grow with the load"
                )
        return cls(tuple(table[:, 0]), tuple(displacement))

    @cached_property
    def _logarithms(self) -> MonotoneCubic:
        return MonotoneCubic(np.log(self.load), np.log(self.displacement))

    def stiffness(self, load: float) -> float:
        """Load over displacement at a load [N/mm, or N mm/rad]; of load zero that of the first point."""
        within = float(np.log(np.clip(abs(load), self.load[0], self.load[-1])))
        within = min(max(within, float(self._logarithms.places[0])), float(self._logarithms.places[-1]))
        return float(np.exp(within - self._logarithms(np.array(within))))


Stiffness = float | StiffnessCurve


@dataclass(frozen=True)
class Bearing:
    """A bearing at a place of a shaft. It leaves the rotation about the axis free; a stiffness of zero is none."""

    name: str
    position: float  # on the axis [mm]; of a taper roller bearing its load centre
    radial: Stiffness  # [N/mm]
    axial: Stiffness = 0.0  # [N/mm], both senses alike
    tilting: Stiffness = 0.0  # [N mm/rad]

    def __post_init__(self) -> None:
        number("position", self.position, "mm", least=-POSITION_LIMIT, most=POSITION_LIMIT)
        for name, unit in (("radial", "N/mm"), ("axial", "N/mm"), ("tilting", "N mm/rad")):
            if not isinstance(value := getattr(self, name), StiffnessCurve):
                number(f"{name} stiffness", value, unit, least=0.0, most=STIFFNESS_LIMIT)
        if not np.any(self.stiffness > 0.0):
            raise InputError(f"bearing {self.name}: must have a stiffness above 0: radial, axial or tilting")

    @property
    def is_linear(self) -> bool:
        """True if no stiffness depends on the load."""
        return not any(isinstance(value, StiffnessCurve) for value in (self.radial, self.axial, self.tilting))

    def _at(self, loads: Sequence[float]) -> list[float]:
        """Radial, axial and tilting stiffness at loads."""
        each = zip((self.radial, self.axial, self.tilting), loads, strict=True)
        return [value.stiffness(load) if isinstance(value, StiffnessCurve) else value for value, load in each]

    @property
    def stiffness(self) -> Array:
        """Stiffness (5) along x, y, z and about x and y [N/mm, N mm/rad]; of curves that without load."""
        radial, axial, tilting = self._at((0.0, 0.0, 0.0))
        return np.array([radial, radial, axial, tilting, tilting], dtype=np.float64)

    def under(self, load: Array) -> Bearing:
        """The linear bearing with the stiffness, load over displacement, of a load (6) on it [N, N mm]."""
        sizes = float(np.hypot(*load[:2])), float(load[2]), float(np.hypot(*load[3:5]))
        radial, axial, tilting = self._at(sizes)
        return replace(self, radial=radial, axial=axial, tilting=tilting)
