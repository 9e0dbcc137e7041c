"""Standard steps of the cutters: blade angles, point widths and edge radii as a tool room stocks and grinds them.

They are taken before the machine settings are fitted, so that these make up for them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields

from ...core.checks import number
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.machine_resolution import step_count
from ..cutting.named_settings import get_setting

SMALL_MODULE, SMALL_SHARE = 1.0, 0.1  # [mm]; below it the steps are a tenth


@dataclass(frozen=True)
class StandardSteps:
    """Steps of the cutters; zero leaves a value as it was computed.

    Parameters
    ----------
    blade_angle
        Of the pressure angle of a blade [rad].
    point_width
        Of the point width of a cutter; the radius of a blade's tip has half of it [mm].
    edge_radius
        Of the edge radius of a blade, which is rounded down [mm].

    Raises
    ------
    InputError
        If a step is negative.

    Examples
    --------
    >>> steps = StandardSteps(blade_angle=math.radians(0.5), point_width=0.1, edge_radius=0.05)
    >>> round(steps.edge(0.93), 9), round(math.degrees(steps.angle(math.radians(18.83))), 9)
    (0.9, 19.0)
    """

    blade_angle: float = 0.0
    point_width: float = 0.0
    edge_radius: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            number(f"step of {field.name}", getattr(self, field.name), least=0.0)

    def of_module(self, module: float) -> StandardSteps:
        """The steps for teeth of a mean normal module [mm]: a tenth below one millimetre."""
        if module >= SMALL_MODULE:
            return self
        return StandardSteps(*(SMALL_SHARE * getattr(self, field.name) for field in fields(self)))

    def angle(self, value: float) -> float:
        """The nearest blade angle [rad]."""
        return _nearest(value, self.blade_angle)

    def width(self, value: float) -> float:
        """The nearest point width [mm]; one step at least."""
        return max(_nearest(value, self.point_width), self.point_width)

    def edge(self, value: float) -> float:
        """The next smaller edge radius [mm]; the value itself below one step."""
        step = self.edge_radius
        return value if step == 0.0 or value < step else round(math.floor(value / step + 1e-9) * step, 9)

    def blade(
        self,
        surface: GeneratingSurface,
        *,
        with_radius: bool,
        allowed: Callable[[str], tuple[float, float]] = lambda _: (-math.inf, math.inf),
    ) -> dict[str, float]:
        """Settings of a flank's blade at their steps, by name; empty where nothing has one.

        Parameters
        ----------
        surface
            The flank.
        with_radius
            Whether the radius of the blade's tip has steps too.
        allowed
            Least and greatest value of a setting by name; one without a step between them stays as it is.
        """
        found = {}
        if self.blade_angle:
            angle = get_setting(surface, "pressure_angle")
            found["pressure_angle"] = _nearest(angle, self.blade_angle, *allowed("pressure_angle"))
        if with_radius and self.point_width:
            radius = get_setting(surface, "point_radius")
            found["point_radius"] = _nearest(radius, 0.5 * self.point_width, *allowed("point_radius"))
        return found


def _nearest(value: float, step: float, low: float = -math.inf, high: float = math.inf) -> float:
    count = step_count(value, step, low, high) if step else None
    return value if count is None else count * step
