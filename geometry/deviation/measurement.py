"""Deviations as a measuring machine states them: zero at the reference point in the middle of the flank."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..cutting.generating_surface import GeneratingSurface
from ..flanks.flank import solve_flank
from .deviation import Deviation


def zeroed(deviation: Deviation, surface: GeneratingSurface) -> Deviation:
    """The deviation with the tooth turned about its axis so that the middle of the flank has none.

    That is how bevel gears are measured: the machine turns them to the reference point. A constant would not do: the
    lever arm, and with it what a rotation moves, changes along the flank.

    Parameters
    ----------
    deviation
        Deviation measured in any position of the tooth.
    surface
        The designed flank.
    """
    section, shape = deviation.section, deviation.value.shape
    middle = section.points(np.array([0.5]), np.array([0.5]))
    nodes = np.stack([deviation.axial.ravel(), deviation.radial.ravel()])
    flank = solve_flank(surface.designed, section, *np.concatenate([nodes, middle], axis=1))
    lever = flank.position[0] * flank.normal[1] - flank.position[1] * flank.normal[0]
    turn = float(deviation.at(np.array([0.5]), np.array([0.5]))[0]) / lever[-1]
    return replace(deviation, value=deviation.value - turn * lever[:-1].reshape(shape))
