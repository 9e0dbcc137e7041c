"""Corrective machine settings: changes of settings that cancel measured deviations, rounded to what can be set.

Each flank is known by its deviation from the one designed. Least squares find the settings that would have made the
measured flanks: the errors of the machine. Their opposite, rounded to the machine's resolution, is the correction; the
flanks cut anew with errors and correction together are the prediction. (Settings that make the opposite deviation would
do to first order only.) Two flanks that share a set-up share its settings in one problem; each has its own blade.

Turning the tooth is no change of form: a rotation of each flank is left out or, where the thickness of the tooth was
measured, one rotation of both.

In the least squares of a set-up settings are counted in usual steps. Combinations of them that hardly change the flanks
are not determined by any measurement. They are told, and taken so that the blade's tip stays on its root line as well
as small steps of them let it; of all changes with the same effect on flanks and root the smallest are taken. Of those
that are determined the ones with the least effect are left at the design while what they could still correct is next to
nothing (truncated least squares).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...core.arrays import Array, Bools, record
from ...core.checks import instance, number, truth
from ...core.errors import GeometryError, InputError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import BLADE_SETTINGS, free_settings, get_setting, scale_of, setting_step, with_settings
from ..design.synthesis import RootLine
from ..pair.gear_pair import Member, shares_set_up, thickness_per_angle
from ..tooth.tooth_flanks import Side, side
from .deviated_flank import RecutFlank
from .deviation import Deviation, zeroed

MISSING_LIMIT = 0.25  # of a flank's points, the most that the settings found may not cut


@record(frozen=True)
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
    def missing(self) -> Bools:
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
    >>> free = ["machine_root_angle", "radial_distance"]
    >>> correction = corrective_settings(gear, measured[0], opposite=measured[1], free=free)
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
    names = free_settings(member.loaded, free)
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
) -> tuple[SetUpFit, Array, list[Array], list[Bools]]:
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


def _on_grid(values: Array, cut: Bools) -> Array:
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


EFFECT_LIMIT = 1e-4  # [mm]; root mean square effect of a usual step below which a combination is not determined
GIVEN_UP = 0.01  # of a departure's root mean square, the most that combinations of little effect may leave of it in all
LEAST_GIVEN_UP = 0.003  # the same where the points scatter so little that they tell these combinations
SCATTER_SHARE = 3.0  # of the scatter of one point, what one combination may leave
ROOT_EFFECT_LIMIT = 0.2  # [mm]; change of the root line by a usual step below which a combination does not hold it
HOLDING_LIMIT = 0.5  # usual steps, the most that hold the root: the effect on the flanks grows with their square
NAMED_SHARE = 0.3  # of a combination, from which on a setting is named
DIFFERENCE = 1e-3  # of a usual step, for derivatives
TURNS = 3  # corrections of the rotation that is taken off; each leaves of its error about the slope of the deviation
REFIT_SHARE = 0.1  # of the greatest effect, from which on rounding is made up for


@dataclass(frozen=True)
class LooseCombination:
    """Combination of free settings that hardly changes the flanks."""

    settings: tuple[str, ...]
    effect: float  # root mean square on the flanks of a usual step [mm]


def rotations(flanks: Sequence[RecutFlank], values: Sequence[Array], one_rotation: bool = False) -> tuple[float, ...]:
    """Rotation of each flank [rad], or one of all, nearest to its deviations (n) [mm]; NaN points are left out."""
    levers = [np.where(np.isfinite(v), flank.lever, 0.0) for flank, v in zip(flanks, values, strict=True)]
    moments = np.array([lever @ np.nan_to_num(v) for lever, v in zip(levers, values, strict=True)])
    sizes = np.array([lever @ lever for lever in levers])
    if one_rotation:
        moments, sizes = np.full(len(flanks), moments.sum()), np.full(len(flanks), sizes.sum())
    with np.errstate(invalid="ignore"):
        return tuple(float(v) for v in moments / sizes)


@dataclass(frozen=True)
class SetUpFit:
    """Flanks of one set-up, and the settings that may move: of the machine once, of the blade for each flank."""

    flanks: tuple[RecutFlank, ...]
    names: tuple[str, ...]
    one_rotation: bool = False
    position: tuple[float, ...] = ()  # rotation in which each flank was measured [rad]

    @cached_property
    def unknowns(self) -> tuple[tuple[str, tuple[int, ...]], ...]:
        """Name of each unknown, and the numbers of the flanks that it belongs to."""
        every = tuple(range(len(self.flanks)))
        flank_groups = {name: [(one,) for one in every] if name in BLADE_SETTINGS else [every] for name in self.names}
        return tuple((name, flanks) for name, groups in flank_groups.items() for flanks in groups)

    @property
    def keys(self) -> tuple[str, ...]:
        """Name of each unknown; of a blade with its flank, as ``point_radius.concave``, if there are two."""
        return tuple(
            name if len(flanks) == len(self.flanks) else f"{name}.{side(self.flanks[flanks[0]].surface)}"
            for name, flanks in self.unknowns
        )

    @cached_property
    def start(self) -> Array:
        """Designed value of each unknown (m) [mm, rad or per radian]."""
        return np.array([get_setting(self.flanks[flanks[0]].surface, name) for name, flanks in self.unknowns])

    @cached_property
    def scale(self) -> Array:
        """Usual step of each unknown (m) [mm, rad or per radian]."""
        return np.array([scale_of(name) for name, _ in self.unknowns])

    def surface(self, flank: int, steps: Array) -> GeneratingSurface:
        """Surface of a flank at steps (m) from the design."""
        values = self.start + self.scale * steps
        settings = {name: float(v) for (name, flanks), v in zip(self.unknowns, values, strict=True) if flank in flanks}
        return with_settings(self.flanks[flank].surface, settings)

    def form(self, values: Sequence[Array]) -> Array:
        """Deviations of all flanks (n) [mm] less the rotation that fits them best."""
        turns = rotations(self.flanks, values, self.one_rotation)
        return np.concatenate([v - f.lever * turn for f, v, turn in zip(self.flanks, values, turns, strict=True)])

    def split(self, values: Array) -> list[Array]:
        """Values of all flanks (n) by flank."""
        return np.split(values, np.cumsum([flank.target.shape[1] for flank in self.flanks])[:-1])

    def departure(self, steps: Array) -> Array:
        """Departure of the flanks at steps (m) from those designed (n) [mm], a rotation left out; NaN where missing."""
        surfaces = [self.surface(number, steps) for number in range(len(self.flanks))]
        turns = np.array([flank.turn(s) for flank, s in zip(self.flanks, surfaces, strict=True)])
        turns = np.full(turns.shape, np.mean(turns)) if self.one_rotation else turns
        position = np.array(self.position or np.zeros(turns.size))
        for _ in range(TURNS):
            values = [flank.distance(s, turn) for flank, s, turn in zip(self.flanks, surfaces, turns, strict=True)]
            turns = turns + np.array(rotations(self.flanks, values, self.one_rotation)) - position
        return self.form(values)

    @cached_property
    def slopes(self) -> Array:
        """Derivatives of the departure by the steps (n, m) [mm]."""
        ways = DIFFERENCE * np.eye(len(self.unknowns))
        numbers = range(len(self.flanks))

        def displaced(steps: Array) -> Array:
            return self.form([self.flanks[number].displacement(self.surface(number, steps)) for number in numbers])

        return np.stack([(displaced(way) - displaced(-way)) / (2.0 * DIFFERENCE) for way in ways], axis=1)

    @cached_property
    def effects(self) -> tuple[Array, Array]:
        """Root mean square effects (m) [mm] of combinations (m, m), a column each, with the length of a usual step."""
        count = len(self.unknowns)
        _, values, ways = np.linalg.svd(self.slopes / np.sqrt(self.slopes.shape[0]))
        return np.concatenate([values, np.zeros(count - values.size)]), ways.T

    @property
    def determined(self) -> Bools:
        """True for the combinations (m) that the flanks tell."""
        return np.asarray(self.effects[0] >= EFFECT_LIMIT)

    def needed(self, target: Array) -> Bools:
        """True for the combinations (m) that a departure (n) [mm] takes: determined, down to the last that counts.

        Of those that act at right angles, the weakest are left out while their parts are no more than the scatter of
        the points would look like, between ``LEAST_GIVEN_UP`` and ``GIVEN_UP`` of the departure.
        """
        acts = self.slopes @ self.effects[1][:, self.determined]
        acts = acts / np.linalg.norm(acts, axis=0)
        parts = acts.T @ target
        over = target.size - parts.size - (1 if self.one_rotation else len(self.flanks))
        scatter = float(np.linalg.norm(target - acts @ parts)) / np.sqrt(max(over, 1))
        in_all = np.sqrt(np.arange(parts.size, 0, -1))  # of the combinations from each one on
        least, most = (share * float(np.linalg.norm(target)) for share in (LEAST_GIVEN_UP, GIVEN_UP))
        given_up = np.sqrt(np.cumsum(parts[::-1] ** 2)[::-1])
        combinations = self.determined.copy()
        combinations[combinations] = given_up > np.clip(SCATTER_SHARE * scatter * in_all, least, most)
        return combinations

    def condition(self, target: Array) -> float:
        """Greatest over least effect of what a departure (n) takes; infinite if nothing is."""
        values = self.effects[0][self.needed(target)]
        return float(values.max() / values.min()) if values.size else np.inf

    def loose(self) -> tuple[LooseCombination, ...]:
        """The combinations that are not determined."""
        values, ways = self.effects
        combinations = []
        for index in np.flatnonzero(~self.determined):
            share = np.abs(ways[:, index])
            names = tuple(self.keys[i] for i in np.argsort(-share) if share[i] >= min(NAMED_SHARE, share.max()))
            combinations.append(LooseCombination(names, float(values[index])))
        return tuple(combinations)

    def root_change(self, flank: int, steps: Array) -> Array:
        """By how much the blade's tip moves off the root cone at toe, middle and heel (3) [mm]; NaN where unknown."""
        line = self.root_lines[flank]
        return np.asarray(line.gap(self.surface(flank, steps))[0] - line.gap(self.flanks[flank].surface)[0])

    @cached_property
    def root_lines(self) -> tuple[RootLine, ...]:
        """Root line of each flank."""
        return tuple(RootLine.of(flank.surface, flank.section) for flank in self.flanks)

    def steps(self, target: Array) -> Array:
        """Small steps (m) whose departure is nearest to a measured one (n) [mm], see ``needed``."""
        steps = self._nearest(target, np.zeros(len(self.unknowns)))
        ways, change = self.effects[1][:, ~self.determined], self._root_changes(steps)
        known = np.isfinite(change)
        if not ways.size or not np.any(known):
            return steps
        pairs = [(self._root_changes(DIFFERENCE * way), self._root_changes(-DIFFERENCE * way)) for way in ways.T]
        slopes = np.stack([(ahead - behind)[known] for ahead, behind in pairs], axis=1) / (2.0 * DIFFERENCE)
        left, sizes, right = np.linalg.svd(np.nan_to_num(slopes), full_matrices=False)
        holding = sizes >= ROOT_EFFECT_LIMIT
        along = -(left[:, holding].T @ change[known]) / sizes[holding]
        along *= min(1.0, HOLDING_LIMIT / max(float(np.linalg.norm(along)), HOLDING_LIMIT))
        return self._nearest(target, ways @ (right[holding].T @ along))

    def _root_changes(self, steps: Array) -> Array:
        return np.concatenate([self.root_change(number, steps) for number in range(len(self.flanks))])

    def _nearest(self, target: Array, loose: Array) -> Array:
        """Steps (m) nearest to a departure (n) [mm] by what it needs, beside given steps (m) of the loose."""
        from scipy.optimize import least_squares

        ways = self.effects[1][:, self.needed(target)]
        if not ways.size:
            return loose

        def residual(along: Array) -> Array:
            steps = loose + ways @ along
            departure = self.departure(steps)
            # Points that these settings do not cut are bridged, so that the residuals stay continuous enough.
            return np.asarray(1e3 * (target - np.where(np.isfinite(departure), departure, self.slopes @ steps)))

        start = np.zeros(ways.shape[1])
        differences = np.full(start.size, DIFFERENCE)
        solution = least_squares(
            residual, start, x_scale=1.0, diff_step=differences, xtol=1e-10, ftol=1e-12, gtol=1e-12, max_nfev=40
        )
        return np.asarray(loose + ways @ solution.x)

    def rounded(self, steps: Array) -> Array:
        """Steps (m) to settings that the machine can be set to.

        One setting after the other is rounded, first the one whose resolution the flanks feel most; the others make up
        for it.
        """
        rounded_steps = np.array(steps, dtype=float)
        resolutions = [setting_step(name) for name, _ in self.unknowns]
        felt = np.linalg.norm(self.slopes, axis=0) * [r.step / r.factor for r in resolutions] / self.scale
        order = [int(index) for index in np.argsort(-felt)]
        for place, index in enumerate(order):
            exact = self.start[index] + self.scale[index] * rounded_steps[index]
            moved = (resolutions[index].rounded(float(exact)) - exact) / self.scale[index]
            rounded_steps[index] += moved
            rest = order[place + 1 :]
            if rest:
                effect = -self.slopes[:, index] * moved
                rounded_steps[rest] += np.linalg.lstsq(self.slopes[:, rest], effect, rcond=REFIT_SHARE)[0]
        return rounded_steps
