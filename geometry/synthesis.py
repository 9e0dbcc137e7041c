"""Pinion settings from a target ease-off: least squares on the machine settings, from the exactly conjugate pinion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..core.errors import GeometryError
from .ease_off_surface import compute
from .free_settings import CURVATURE, get_setting, scale_of, with_settings
from .generating_surface import GeneratingSurface
from .pair import GearPair, grid

Array = NDArray[Any]

FAR = 1e9  # residual [um] of settings with which the flanks do not meet
# Without tilt and swivel, which can stand in for the others, so that settings would run away at no gain.
FREE = (
    "point_radius",
    "pressure_angle",
    "radial_distance",
    "work_offset",
    "machine_center_to_crossing_point",
    "ratio_of_roll",
    "modified_roll_2c",
    "modified_roll_6d",
)


@dataclass(frozen=True)
class EaseOffTarget:
    """Wanted ease-off on the gear flank, up to a constant [mm].

    With t and h from -1 to 1 lengthwise and up the profile it is
    ``lengthwise_crowning t^2 + profile_crowning h^2 - bias t h + spiral_angle_error t + pressure_angle_error h``.

    Parameters
    ----------
    lengthwise_crowning
        At toe and heel, mid height.
    profile_crowning
        At root and tip, mid face.
    bias
        Twist; positive adds gap at toe-tip and heel-root.
    spiral_angle_error
        Half of what the heel has more than the toe.
    pressure_angle_error
        Half of what the tip has more than the root.
    """

    lengthwise_crowning: float = 0.0
    profile_crowning: float = 0.0
    bias: float = 0.0
    spiral_angle_error: float = 0.0
    pressure_angle_error: float = 0.0

    def __call__(self, lengthwise: Array, profile: Array) -> Array:
        """Target (n) [mm] at fractions (n)."""
        t, h = 2.0 * lengthwise - 1.0, 2.0 * profile - 1.0
        second = self.lengthwise_crowning * t**2 + self.profile_crowning * h**2 - self.bias * t * h
        return np.asarray(second + self.spiral_angle_error * t + self.pressure_angle_error * h)


@dataclass(frozen=True)
class Synthesis:
    """A pinion flank fitted to a target.

    Parameters
    ----------
    surface
        The pinion flank.
    moved
        What became of each free setting: (start, end), mm, rad or per radian.
    residual
        Ease-off less target at the fit's nodes (n) [mm], its mean removed.
    """

    surface: GeneratingSurface
    moved: dict[str, tuple[float, float]]
    residual: Array


def fit_pinion(
    pair: GearPair,
    target: EaseOffTarget,
    *,
    free: Sequence[str] = FREE,
    nodes: tuple[int, int] = (9, 7),
) -> Synthesis:
    """Fit the pinion's settings to a target ease-off.

    Parameters
    ----------
    pair
        The pair as assembled, with the pinion flank to start from, usually the conjugate one.
    target
        The wanted ease-off on the gear flank.
    free
        Settings that may move, see ``free_settings``.
    nodes
        Gear nodes of the fit, lengthwise and along the profile.

    Returns
    -------
    Synthesis
        The settings that leave the smallest sum of squares.

    Raises
    ------
    InputError
        If a free setting has another name.
    GeometryError
        If the flanks do not meet on enough of the gear flank.
    """
    scale = np.array([scale_of(name) for name in free])
    t, h = grid(nodes)
    gear = pair.gear.flank(t, h)
    start = pair.pinion.loaded
    origin = np.array([get_setting(start, name) for name in free])
    wanted = target(*(f.ravel() for f in np.meshgrid(t, h, indexing="ij")))
    lever = np.abs(gear.position[0] * gear.normal[1] - gear.position[1] * gear.normal[0])
    known = compute(gear, start, pair.pinion.section, pair.assembly)
    usable = np.isfinite(known.angle)
    if usable.sum() < 2 * len(free):
        raise GeometryError("pinion and gear flank meet on too few nodes to fit the pinion's settings")

    def residual(steps: Array) -> Array:
        surface = with_settings(start, dict(zip(free, origin + scale * steps, strict=True)))
        try:
            here = compute(gear, surface, pair.pinion.section, pair.assembly, near=known)
            error = (here.angle * here.lever_arm - wanted)[usable]
        except GeometryError:
            error = np.full(int(usable.sum()), np.nan)
        if not np.all(np.isfinite(error)):
            # A step so large that the flanks no longer meet: the search must take a shorter one.
            return np.linspace(FAR, 2.0 * FAR, int(usable.sum()))
        # The zero of the ease-off is free: a rotation of the gear is no change of form.
        arm = lever[usable]
        return np.asarray(1e3 * (error - arm * float(arm @ error) / float(arm @ arm)))

    # A blade all but straight is an arc of enormous radius, whose points are lost in rounding: begin well away from it,
    # and differentiate with long steps, which a flank that is nearly linear in its blade's curvature allows.
    curved = np.array([name in CURVATURE for name in free])
    found = least_squares(
        residual,
        np.where(curved & (origin == 0.0), 0.1, 0.0),
        method="trf",
        x_scale=1.0,
        diff_step=np.where(curved, 0.1, 1e-4),
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=60,
    )
    values = dict(zip(free, (float(v) for v in origin + scale * found.x), strict=True))
    moved = {name: (float(o), values[name]) for name, o in zip(free, origin, strict=True)}
    surface = with_settings(start, values)
    left = 1e-3 * residual(found.x)
    # The fit follows one sheet of the envelope; whoever uses the settings must find the same one.
    fresh = compute(gear, surface, pair.pinion.section, pair.assembly)
    error = (fresh.angle * fresh.lever_arm - wanted)[usable]
    arm = lever[usable]
    error = error - arm * float(arm @ error) / float(arm @ arm)
    if not np.allclose(error, left, rtol=0.0, atol=1e-6):
        raise GeometryError(
            "the fitted settings cut the blank with another part of the cutter than the fit followed: free fewer "
            f"settings than {', '.join(free)}, or start nearer to the target"
        )
    return Synthesis(surface, moved, left)
