"""The deviated flank as a surface of its own, for every step of the geometry.

A point of the designed flank moves along its normal by the deviation. The normal leans against the deviation's slope:
with the tangents **r**_k, the deviation d and its derivatives d_k, the new normal is along **n** - **w**, where **w**
lies in the tangent plane and **w** . (**r**_k + d **n**_k) = d_k. That is exact, not to first order.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import InputError
from ..cutting.generating_surface import GeneratingSurface
from ..newton import cramers_rule
from ..pair.gear_pair import GearPair, Member
from ..vectors import dot
from .deviation import Deviation

Array = NDArray[Any]
RELATIVE_STEP = 1e-5  # of the surface parameters, for central differences: a relative error of 1e-10


@dataclass(frozen=True)
class DeviatedFlank(GeneratingSurface):
    """A generated flank with its deviation from the design.

    Parameters
    ----------
    deviation
        Deviation; ``None`` for the designed flank.
    """

    deviation: Deviation | None = None

    @property
    def designed(self) -> GeneratingSurface:
        """The surface without the deviation."""
        return GeneratingSurface(**{f.name: getattr(self, f.name) for f in fields(GeneratingSurface)})

    @np.errstate(all="ignore")
    def evaluate(self, parameters: Array) -> tuple[Array, Array, Array]:
        """As ``GeneratingSurface.evaluate``; the blade coordinate is that of the designed flank."""
        position, normal, coordinate = super().evaluate(parameters)
        if self.deviation is None:
            return position, normal, coordinate
        deviation, slope = self.deviation.interpolant(position[2], np.sqrt(position[0] ** 2 + position[1] ** 2))
        tangents, stretched, climbs = [], [], []
        for index, step in enumerate(RELATIVE_STEP * self.max_step):
            shift = np.zeros_like(parameters)
            shift[index] = step
            ahead, behind = (super(DeviatedFlank, self).evaluate(parameters + s * shift) for s in (1.0, -1.0))
            tangent, turned = ((a - b) / (2.0 * step) for a, b in zip(ahead[:2], behind[:2], strict=True))
            radial = (position[0] * tangent[0] + position[1] * tangent[1]) / np.sqrt(
                position[0] ** 2 + position[1] ** 2
            )
            tangents.append(tangent)
            stretched.append(tangent + deviation * turned)
            climbs.append(slope[0] * tangent[2] + slope[1] * radial)
        own, mixed = ([dot(tangent, other) for other in stretched] for tangent in tangents)
        first, second = cramers_rule(own, mixed, climbs)
        lean = first * tangents[0] + second * tangents[1]
        return position + deviation * normal, (normal - lean) / np.sqrt(1.0 + dot(lean, lean)), coordinate


def deviated_member(member: Member, deviation: Deviation | None) -> Member:
    """The member with a deviated loaded flank.

    Raises
    ------
    InputError
        If the deviation belongs to a flank on another blank.
    """
    if deviation is None:
        return member
    if deviation.section != member.section:
        raise InputError("deviation: must have the section of this member; it was made for another blank")
    surface = member.loaded.designed
    own = {f.name: getattr(surface, f.name) for f in fields(GeneratingSurface)}
    return replace(member, loaded=DeviatedFlank(**own, deviation=deviation))


def deviated_pair(pair: GearPair, *, pinion: Deviation | None = None, gear: Deviation | None = None) -> GearPair:
    """The pair with deviated flanks, for geometry and contact of the deviated surfaces themselves.

    Raises as ``deviated_member``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> from easeoff.geometry import GlobalErrors, deviation_from_formula, ease_off
    >>> deviation = deviation_from_formula(pair.gear.section, GlobalErrors(lengthwise_crowning=10.0))
    >>> crowned = ease_off(deviated_pair(pair, gear=deviation), (7, 5))["ease_off"].sel(profile=0.5)
    >>> added = crowned - ease_off(pair, (7, 5))["ease_off"].sel(profile=0.5)
    >>> bool(added.sel(lengthwise=0.0) > 1.0)  # the gap at the toe grows [um]
    True
    """
    return replace(pair, pinion=deviated_member(pair.pinion, pinion), gear=deviated_member(pair.gear, gear))
