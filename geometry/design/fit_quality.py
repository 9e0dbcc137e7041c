"""How near a fit has to come to its target ease-off: good, usable or refused."""

from __future__ import annotations

import numpy as np

from ...core.errors import GeometryError
from ..pair.gear_pair import FlankName
from .set_up.pinion_method import ADVICE
from .synthesis import EaseOffTarget

SMALL_RESIDUAL = 0.001  # [mm]; a smaller residual is good for any target
GOOD_SHARE = 0.1  # of the target's range; a smaller residual is good
USABLE_RESIDUAL = 0.010  # [mm]; a smaller residual is never refused
USABLE_SHARE = 0.5  # of the target's range; a larger residual is refused
BLANK_ADVICE = "change the blanks: cutter_radius, depth_taper, spiral angle, or more teeth against undercut"


def residual_limits(target: EaseOffTarget) -> tuple[float, float]:
    """Largest residuals of a good fit and of one that can be used at all [mm], by the target's range.

    Examples
    --------
    >>> [round(limit, 6) for limit in residual_limits(EaseOffTarget(lengthwise_crowning=0.05))]
    [0.005, 0.025]
    """
    size = target_range(target)
    return max(SMALL_RESIDUAL, GOOD_SHARE * size), max(USABLE_RESIDUAL, USABLE_SHARE * size)


def target_range(target: EaseOffTarget) -> float:
    """Range of a target over the gear flank [mm]."""
    t, h = np.meshgrid(np.linspace(0.0, 1.0, 15), np.linspace(0.0, 1.0, 11), indexing="ij")
    return float(np.ptp(target(t, h)))


def require_usable(
    side: FlankName, residual: float, target: EaseOffTarget, advice: str = ADVICE["closest_fit"]
) -> None:
    """Refuse a fit that misses its target by more than the second of ``residual_limits``.

    Parameters
    ----------
    side
        Which side.
    residual
        Its largest residual [mm].
    target
        The wanted ease-off.
    advice
        What else to try.

    Raises
    ------
    GeometryError
        If the fit is far off.
    """
    limit = residual_limits(target)[1]
    if not residual <= limit:
        raise GeometryError(
            f"{side}: no pinion near the target ease-off was found: the best one misses it by up to "
            f"{1e3 * residual:.1f} um, where the target's range is {1e3 * target_range(target):.1f} um and "
            f"{1e3 * limit:.1f} um would do; {advice}, ask for less crowning and bias, or {BLANK_ADVICE}"
        )
