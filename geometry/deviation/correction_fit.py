"""Least squares on the settings of one set-up: the settings that would have made the measured flanks.

Settings are counted in usual steps. Combinations of them that hardly change the flanks are not determined by any
measurement. They are told, and taken so that the blade's tip stays on its root line as well as small steps of them let
it; of all changes with the same effect on flanks and root the smallest are taken. Of those that are determined the ones
with the least effect are left at the design while what they could still correct is next to nothing (truncated least
squares).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import get_setting, scale_of, setting_step, with_settings
from ..design.root_line import RootLine
from ..tooth.tooth_flanks import side
from .deviated_flank import RecutFlank
from .machine_set_up import BLADE_SETTINGS

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
    def determined(self) -> NDArray[np.bool_]:
        """Which combinations the flanks tell (m)."""
        return np.asarray(self.effects[0] >= EFFECT_LIMIT)

    def needed(self, target: Array) -> NDArray[np.bool_]:
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
        for number in np.flatnonzero(~self.determined):
            share = np.abs(ways[:, number])
            names = tuple(self.keys[i] for i in np.argsort(-share) if share[i] >= min(NAMED_SHARE, share.max()))
            combinations.append(LooseCombination(names, float(values[number])))
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
        order = [int(number) for number in np.argsort(-felt)]
        for place, number in enumerate(order):
            exact = self.start[number] + self.scale[number] * rounded_steps[number]
            moved = (resolutions[number].rounded(float(exact)) - exact) / self.scale[number]
            rounded_steps[number] += moved
            rest = order[place + 1 :]
            if rest:
                effect = -self.slopes[:, number] * moved
                rounded_steps[rest] += np.linalg.lstsq(self.slopes[:, rest], effect, rcond=REFIT_SHARE)[0]
        return rounded_steps
