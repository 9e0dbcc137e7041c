"""Corrective machine settings: changes of settings that cancel a measured deviation, and the residual.

The flank is known by its deviation from the one designed. Least squares find the settings that would have made the
measured flank; the opposite of their changes corrects it. (Settings that make the opposite deviation would do to first
order only.) Turning the tooth is no change of form: a rotation is left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import get_setting, scale_of, with_settings
from ..design.synthesis import FREE_SETTINGS
from ..flanks.flank import solve_flank
from ..newton import solve
from ..pair.gear_pair import Member
from .deviation import Deviation

Array = NDArray[Any]

# Formate: no roll. The cradle angle and tilt would only stand in for others.
FREE_FORMATE_SETTINGS = ("point_radius", "pressure_angle", "radial_distance", "machine_root_angle", "sliding_base")
STEP_WEIGHT = 1.0  # residual of a usual step of a setting [um]; it keeps apart settings that have the same effect
MISSING_RESIDUAL = 1e6


@dataclass(frozen=True)
class Correction:
    """Corrective settings of one flank.

    Parameters
    ----------
    surface
        The designed flank with the corrections added, to be set on the machine.
    changes
        Change of each free setting: mm, rad or per radian.
    residual
        Rest of the deviation (columns, rows) [mm], a rotation removed.
    rms_before, rms
        Root mean square of deviation and residual, both with a rotation removed [mm].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> from easeoff.geometry import GlobalErrors, deviation_from_formula
    >>> deviation = deviation_from_formula(pair.gear.section, GlobalErrors(pressure_angle=5.0), (9, 5))
    >>> correction = corrective_settings(pair.gear, deviation, free=["pressure_angle"])
    >>> list(correction.changes), correction.residual.shape
    (['pressure_angle'], (9, 5))
    """

    surface: GeneratingSurface
    changes: dict[str, float]
    residual: Array
    rms_before: float
    rms: float


def corrective_settings(member: Member, deviation: Deviation, *, free: Sequence[str] | None = None) -> Correction:
    """Settings that cancel a measured deviation of a member's loaded flank.

    Parameters
    ----------
    member
        The member as designed.
    deviation
        Measured deviation.
    free
        Settings that may change, see ``named_settings``; usual ones of a generated or Formate member if left out.

    Raises
    ------
    InputError
        If a free setting has another name.
    GeometryError
        If a measured point lies off the designed flank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> from easeoff.geometry import GlobalErrors, deviation_from_formula
    >>> deviation = deviation_from_formula(pair.gear.section, GlobalErrors(spiral_angle=5.0), (9, 5))
    >>> correction = corrective_settings(pair.gear, deviation)
    >>> correction.rms < 0.01 * correction.rms_before
    True
    """
    from scipy.optimize import least_squares

    surface = member.loaded.designed
    names = tuple(free) if free is not None else FREE_SETTINGS if surface.settings.generated else FREE_FORMATE_SETTINGS
    scales = np.array([scale_of(name) for name in names])
    start = np.array([get_setting(surface, name) for name in names])
    target = np.stack([deviation.axial.ravel(), deviation.radial.ravel()])
    flank = solve_flank(surface, member.section, *target)
    if not np.all(np.isfinite(flank.position)):
        raise GeometryError("measured points lie off the designed flank: check the measuring grid")
    azimuth = np.arctan2(flank.position[1], flank.position[0])
    lever = flank.position[0] * flank.normal[1] - flank.position[1] * flank.normal[0]
    profile = surface.on("profile")
    measured = deviation.value.ravel()

    def moved(steps: Array) -> GeneratingSurface:
        return with_settings(profile, dict(zip(names, start + scales * steps, strict=True)))

    def left(steps: Array) -> Array:
        """Measured deviation from the flank of these settings (n) [mm], a rotation removed."""
        changed = moved(steps)
        found = solve(changed.axial_and_radial, flank.parameters, target, changed.max_step)
        position, _, _ = changed.evaluate(found.parameters)
        turned = np.mod(np.arctan2(position[1], position[0]) - azimuth + np.pi, 2.0 * np.pi) - np.pi
        error = measured - turned * lever
        error = error - lever * float(lever @ error) / float(lever @ lever)
        return np.where(found.converged, error, MISSING_RESIDUAL)

    def residual(steps: Array) -> Array:
        return np.concatenate([1e3 * left(steps), STEP_WEIGHT * steps])

    found = least_squares(
        residual,
        np.zeros(len(names)),
        x_scale=1.0,
        diff_step=np.full(len(names), 1e-4),
        xtol=1e-10,
        ftol=1e-12,
        max_nfev=40,
    )
    before, after = left(np.zeros(len(names))), left(found.x)
    return Correction(
        moved(-found.x).on(surface.part),
        {name: float(v) for name, v in zip(names, -scales * found.x, strict=True)},
        after.reshape(deviation.value.shape),
        float(np.sqrt(np.mean(before**2))),
        float(np.sqrt(np.mean(after**2))),
    )
