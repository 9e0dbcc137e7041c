"""Corrective machine settings: changes of settings that cancel measured deviations, rounded to what can be set.

Each flank is known by its deviation from the one designed. Least squares find the settings that would have made the
measured flanks: the errors of the machine. Their opposite, rounded to the machine's resolution, is the correction; the
flanks cut anew with errors and correction together are the prediction. (Settings that make the opposite deviation would
do to first order only.) Two flanks that share a set-up share its settings in one problem; each has its own blade.

Turning the tooth is no change of form: a rotation of each flank is left out or, where the thickness of the tooth was
measured, one rotation of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array
from ...core.checks import frozen_arrays, instance, number, truth, words
from ...core.errors import GeometryError, InputError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import get_setting, with_settings
from ..pair.gear_pair import Member, thickness_per_angle
from ..tooth.tooth_flanks import Side, side
from .correction_fit import LooseCombination, SetUpFit, rotations
from .deviated_flank import RecutFlank
from .deviation import Deviation, zeroed
from .machine_set_up import BLADE_SETTINGS, require_movable, shares_set_up, usual_settings

MISSING_LIMIT = 0.25  # of a flank's points, the most that the settings found may not cut


@frozen_arrays
@dataclass(frozen=True)
class CorrectedFlank:
    """One measured flank before and after the correction, a rotation left out.

    Points that the flank with the errors found does not have are NaN after the correction, and left out of the fit.
    """

    member: Member
    surface: GeneratingSurface
    deviation: Deviation
    before: Array  # deviation (columns, rows) [mm]
    linear: Array  # left by first derivatives
    after: Array  # left on the flank cut anew
    root_change: Array  # tip off the root cone (3) [mm], negative if deeper

    @property
    def side(self) -> Side:
        """Concave or convex."""
        return side(self.surface)

    @property
    def missing(self) -> NDArray[np.bool_]:
        """Points that the flank with the errors found does not have (columns, rows)."""
        return np.isnan(self.after)


@dataclass(frozen=True)
class Correction:
    """Corrective settings of one set-up, and what they leave.

    Parameters
    ----------
    flanks
        The measured flanks cut in it.
    surfaces
        Surfaces with the corrected settings of all flanks cut in it, measured or not.
    changes
        Change of each free setting, to be set on the machine: mm, rad or per radian. A blade of one of two flanks is
        named after it, as ``point_radius.concave``.
    errors
        The errors of the settings that were found, not rounded.
    condition
        Greatest over least effect of a usual step, of the combinations of settings that are moved.
    loose
        The combinations that the flanks do not tell, taken so that the root line moves least.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> from easeoff.geometry import GlobalErrors, deviation_from_formula
    >>> deviation = deviation_from_formula(pair.gear.section, GlobalErrors(pressure_angle=5.0), (9, 5))
    >>> correction = corrective_settings(pair.gear, deviation, free=["pressure_angle"])
    >>> list(correction.changes), correction.residual.shape, sorted(correction.surfaces)
    (['pressure_angle'], (9, 5), ['concave', 'convex'])
    """

    flanks: tuple[CorrectedFlank, ...]
    surfaces: dict[Side, GeneratingSurface]
    changes: dict[str, float]
    errors: dict[str, float]
    condition: float
    loose: tuple[LooseCombination, ...]

    @property
    def surface(self) -> GeneratingSurface:
        """Surface of the first measured flank with the corrected settings."""
        return self.flanks[0].surface

    @property
    def residual(self) -> Array:
        """Rest of the first measured flank's deviation (columns, rows) [mm]."""
        return self.flanks[0].after

    @property
    def nothing(self) -> bool:
        """True if no setting changes: the deviation is less than the effect of steps of the resolution."""
        return not any(self.changes.values())

    @property
    def rms_before(self) -> float:
        """Root mean square of the deviations of all flanks [mm]."""
        return _rms([flank.before for flank in self.flanks])

    @property
    def rms_linear(self) -> float:
        """Root mean square of what first derivatives leave [mm]."""
        return _rms([flank.linear for flank in self.flanks])

    @property
    def rms(self) -> float:
        """Root mean square of what is left on the flanks cut anew [mm]."""
        return _rms([flank.after for flank in self.flanks])


def _rms(values: Sequence[Array]) -> float:
    return float(np.sqrt(np.nanmean(np.concatenate([value.ravel() for value in values]) ** 2)))


def corrective_settings(
    member: Member,
    deviation: Deviation,
    *,
    opposite: Deviation | None = None,
    free: Sequence[str] | None = None,
    shared: bool | None = None,
    thickness: float | None = None,
    rounded: bool = True,
) -> Correction:
    """Settings that cancel the measured deviations of a set-up.

    Parameters
    ----------
    member
        The member as designed, seen from the measured flank.
    deviation
        Deviation of its loaded flank.
    opposite
        Deviation of its other flank, cut in the same set-up.
    free
        Settings that may change, see ``named_settings``; ``usual_settings``, without blades, if left out.
    shared
        Whether both flanks are cut in one set-up; if left out, whether their settings are equal.
    thickness
        By how much the normal circular thickness of the tooth was measured to be above the one designed [mm]; if left
        out it was not measured, and each flank may be turned by itself.
    rounded
        Whether the corrected settings are rounded to the resolution of the machine.

    Raises
    ------
    InputError
        If a free setting cannot be moved, or two flanks or a thickness are given that share no set-up.
    GeometryError
        If a measured point lies off the designed flank, or settings near the design cut no flank at many of them.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import departure
    >>> from easeoff.geometry.cutting.named_settings import with_settings
    >>> gear = gear_pair(read_case("fm-11x41")).gear
    >>> wrong = {"radial_distance": gear.loaded.settings.radial_distance + 0.2}
    >>> measured = [departure(m, with_settings(m.loaded, wrong)) for m in (gear, gear.from_opposite)]
    >>> correction = corrective_settings(gear, measured[0], opposite=measured[1])
    >>> correction.rms < 0.02 * correction.rms_before
    True
    """
    instance("deviation", deviation, Deviation)
    instance("opposite", opposite, Deviation | None)
    truth("rounded", rounded)
    if thickness is not None:
        number("thickness", thickness, "mm")
    one = shares_set_up(member) if shared is None else truth("shared", shared)
    if one and not shares_set_up(member):
        raise InputError(
            "shared set-up: must be both flanks of a member with the same machine settings; those of this member "
            + ("differ" if member.opposite is not None else "are given for one flank only")
        )
    if not one and (opposite is not None or thickness is not None):
        what = "an opposite flank" if opposite is not None else "a thickness"
        raise InputError(f"{what} is given for flanks with set-ups of their own: correct each flank by itself")
    if thickness is not None and opposite is None:
        raise InputError(f"thickness = {1e3 * thickness:g} um: must go with the deviations of both flanks")
    names = words("free", free) if free is not None else usual_settings(member.loaded)
    require_movable(member.loaded, names)
    measured = [(member, deviation), *([] if opposite is None else [(member.from_opposite, opposite)])]
    fit, steps, before, cut = _fit(measured, names, thickness)
    target = np.concatenate([v[kept] for v, kept in zip(before, cut, strict=True)])
    to_set = fit.rounded(-steps) if rounded else -steps
    left = target - fit.departure(steps) + fit.departure(steps + to_set)
    if np.nansum(left**2) >= np.sum(target[np.isfinite(left)] ** 2):  # rounding changes more than there is to correct
        to_set, left = np.zeros_like(to_set), target
    stages = (fit.split(stage) for stage in (target + fit.slopes @ to_set, left))
    flanks = tuple(
        CorrectedFlank(
            seen,
            fit.surface(number, to_set),
            measurement,
            form.reshape(measurement.value.shape),
            _on_grid(linear, kept).reshape(measurement.value.shape),
            _on_grid(after, kept).reshape(measurement.value.shape),
            fit.root_change(number, to_set),
        )
        for number, ((seen, measurement), form, kept, linear, after) in enumerate(
            zip(measured, before, cut, *stages, strict=True)
        )
    )
    surfaces = {flank.side: flank.surface for flank in flanks}
    if one and opposite is None:
        # The machine moves for the other flank, too; its blade, of which nothing was measured, does not.
        other, machine = member.from_opposite.loaded.designed, [n for n in names if n not in BLADE_SETTINGS]
        surfaces[side(other)] = with_settings(other, {n: get_setting(flanks[0].surface, n) for n in machine})
    return Correction(
        flanks,
        surfaces,
        dict(zip(fit.keys, (float(v) for v in fit.scale * to_set), strict=True)),
        dict(zip(fit.keys, (float(v) for v in fit.scale * steps), strict=True)),
        fit.condition(target),
        fit.loose(),
    )


def _fit(
    measured: Sequence[tuple[Member, Deviation]], names: tuple[str, ...], thickness: float | None
) -> tuple[SetUpFit, Array, list[Array], list[NDArray[np.bool_]]]:
    """Fit to points cut by settings near the design, its steps, form (n) [mm] and the points kept (n), by flank.

    A point that the flank with the errors found does not have (undercut, beyond the blade) is left out, and the errors
    are found anew.
    """
    recut = [RecutFlank.of(member, deviation.axial, deviation.radial) for member, deviation in measured]
    values, together = _measured_values(measured, recut, thickness), thickness is not None
    cut = [np.ones(v.size, dtype=bool) for v in values]
    while True:
        flanks = tuple(flank.at(mask) for flank, mask in zip(recut, cut, strict=True))
        deviations = [v[mask] for v, mask in zip(values, cut, strict=True)]
        fit = SetUpFit(flanks, names, together, rotations(flanks, deviations, together))
        known = np.all(np.isfinite(fit.slopes), axis=1)
        if np.all(known):
            steps = fit.steps(fit.form(deviations))
            known = np.isfinite(fit.departure(steps))
            if np.all(known):
                form = [v - f.lever * turn for v, f, turn in zip(values, recut, fit.position, strict=True)]
                return fit, steps, form, cut
        for flank, mask, kept in zip(recut, cut, fit.split(known), strict=True):
            mask[mask] = kept
            if np.mean(mask) < 1.0 - MISSING_LIMIT:
                raise GeometryError(
                    f"{side(flank.surface)} flank: settings near the design do not cut {np.sum(~mask)} of {mask.size} "
                    f"measured points; must be at most {100.0 * MISSING_LIMIT:g} %. Free others than "
                    f"{', '.join(names)}, or check the deviations"
                )


def _on_grid(values: Array, cut: NDArray[np.bool_]) -> Array:
    """Values of the points that are cut as those of all points (n); NaN elsewhere."""
    grid = np.full(cut.shape, np.nan)
    grid[cut] = values
    return grid


def _measured_values(
    measured: Sequence[tuple[Member, Deviation]], recut: Sequence[RecutFlank], thickness: float | None
) -> list[Array]:
    """Measured deviations by flank (n) [mm]; with a thickness, in one position of the tooth."""
    if thickness is None:
        return [deviation.value.ravel() for _, deviation in measured]
    # Each flank is turned by half the angle that the tooth is thicker; its middle is the place of the thickness.
    half = [0.5 * thickness / thickness_per_angle(member) for member, _ in measured]
    values = [zeroed(deviation, member.loaded).value.ravel() for member, deviation in measured]
    return [v + turn * np.abs(flank.lever) for v, turn, flank in zip(values, half, recut, strict=True)]
