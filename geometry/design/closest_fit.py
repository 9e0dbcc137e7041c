"""The fit that comes nearest to a target ease-off, one flank at a time, on a machine that knows no limits.

By how near it comes a fit is good, usable or refused. Blade angles, point widths and edge radii that a tool room stocks
or grinds in standard steps are taken before the machine settings are fitted, so that these make up for them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import TypeVar

import numpy as np

from ...core.checks import number
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import get_setting, step_count, with_settings
from ..pair.gear_pair import FlankName, GearPair
from ..tooth.tooth_surface import tip_gap
from .pinion_method import ADVICE
from .synthesis import FREE_SETTINGS_WITH_ROOT_ANGLE, EaseOffTarget, Synthesis, fit_pinion, root_cost, root_gap

SMALL_RESIDUAL = 0.001  # [mm]; a smaller residual is good for any target
GOOD_SHARE = 0.1  # of the target's range; a smaller residual is good
USABLE_RESIDUAL = 0.010  # [mm]; a smaller residual is never refused
USABLE_SHARE = 0.5  # of the target's range; a larger residual is refused
BLANK_ADVICE = "change the blanks: cutter_radius, depth_taper, spiral angle, or more teeth against undercut"


def residual_limits(target: EaseOffTarget) -> tuple[float, float]:
    """Largest residuals of a good fit and of one that can be used at all [mm], by the target's range."""
    size = target_range(target)
    return max(SMALL_RESIDUAL, GOOD_SHARE * size), max(USABLE_RESIDUAL, USABLE_SHARE * size)


def target_range(target: EaseOffTarget) -> float:
    """Range of a target over the gear flank [mm]."""
    t, h = np.meshgrid(np.linspace(0.0, 1.0, 15), np.linspace(0.0, 1.0, 11), indexing="ij")
    return float(np.ptp(target(t, h)))


def require_usable(side: FlankName, missed: float, target: EaseOffTarget, advice: str = ADVICE["closest_fit"]) -> None:
    """Refuse a fit that missed its target by more [mm] than the second of ``residual_limits``."""
    limit = residual_limits(target)[1]
    if not missed <= limit:
        raise GeometryError(
            f"{side}: no pinion near the target ease-off was found: the best one misses it by up to "
            f"{1e3 * missed:.1f} um, where the target's range is {1e3 * target_range(target):.1f} um and "
            f"{1e3 * limit:.1f} um would do; {advice}, ask for less crowning and bias, or {BLANK_ADVICE}"
        )


SMALL_MODULE, SMALL_SHARE = 1.0, 0.1  # [mm]; below it the steps are a tenth


@dataclass(frozen=True)
class StandardSteps:
    """Steps of the cutters [rad, mm]; zero leaves a value as it was computed."""

    blade_angle: float = 0.0
    point_width: float = 0.0  # [mm]; the radius of a blade's tip has half of it
    edge_radius: float = 0.0  # [mm], rounded down

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
        """Settings of a flank's blade at their steps, by name; one without a step within ``allowed`` stays as it is."""
        settings = {}
        if self.blade_angle:
            angle = get_setting(surface, "pressure_angle")
            settings["pressure_angle"] = _nearest(angle, self.blade_angle, *allowed("pressure_angle"))
        if with_radius and self.point_width:
            radius = get_setting(surface, "point_radius")
            settings["point_radius"] = _nearest(radius, 0.5 * self.point_width, *allowed("point_radius"))
        return settings


NO_STEPS = StandardSteps()


def _nearest(value: float, step: float, low: float = -math.inf, high: float = math.inf) -> float:
    count = step_count(value, step, low, high) if step else None
    return value if count is None else count * step


RETRY_RESIDUAL = 0.005  # [mm]; root mean square residual above which another fit is tried
FOLD_MARGIN = 0.2  # of the conjugate gear's area; nodes nearer to a fold are no part of a fit from the crown gear
ROOT_PASSES = 10  # fits in which the blade tips come onto the root cone; two or three are usual
ROOT_TOLERANCE = 0.02  # [mm]; blade tips as near to the root cone are on it


def best_fit(
    side: FlankName,
    starts: Sequence[GearPair],
    target: EaseOffTarget,
    free: Sequence[str] | None,
    follow_root: bool,
    clearance: float,
    steps: StandardSteps,
) -> Synthesis:
    """Fit that comes nearest to target and root cone: the first good one, else the best from all starts.

    The start of a Formate gear comes last. Blade tips further off the root cone than the clearance [mm] are not good.
    Blades are put at their steps and the machine settings fitted once more. GeometryError if nothing meets the gear.
    """

    def cost(fit: Synthesis) -> float:
        """Mean square of the residual [mm^2], with that of the root line as the fit weighs it."""
        return fit.rms**2 + (root_cost(fit) / fit.residual.size if follow_root else 0.0)

    def good(fit: Synthesis) -> bool:
        enough = len(starts) > 1 or fit.rms < RETRY_RESIDUAL
        return enough and is_good(fit, target, clearance if follow_root else math.inf)

    try:
        (pair, fold_margin), fit = first_good(_attempts(starts, target, free, follow_root), cost, good)
    except GeometryError as error:
        raise GeometryError(f"{side}: no pinion was found that meets the gear: {error}; {BLANK_ADVICE}") from error

    def again(fit: Synthesis, blade: Mapping[str, float]) -> Synthesis:
        """The fit once more, from where it ended, with settings of the blade held."""
        near = replace(pair, pinion=replace(pair.pinion, loaded=with_settings(fit.surface, blade)))
        names = [name for name in fit.moved if name not in blade]
        if fold_margin > 0.0:
            held = _from_crown_gear(near, target, names, follow_root)
        else:
            held = fit_pinion(near, target, free=names, follow_root=follow_root)
        return started_from(pair.pinion.loaded, held, fit.moved)

    # Blade angles far from those of the start undercut teeth, and the valley to them is flat.
    began, found = get_setting(pair.pinion.loaded, "pressure_angle"), get_setting(fit.surface, "pressure_angle")
    limit, close = (clearance if follow_root else math.inf), SURE_SHARE * residual_limits(target)[0]
    for reach in (NEAR_ANGLE, math.inf) if steps.blade_angle and "pressure_angle" in fit.moved else ():
        angle = min(max(found, BLADE_ANGLES[0], began - reach), BLADE_ANGLES[1], max(began + reach, BLADE_ANGLES[0]))
        if angle == found:
            break
        with suppress(GeometryError):
            usual = again(fit, {"pressure_angle": angle})
            if is_good(usual, target, limit) and (math.isinf(reach) or usual.largest_residual <= close):
                fit = usual
                break
    # The blade at standard steps, and the other settings fitted once more; as computed where that fails.
    milled = fit.surface.settings.indexing_ratio == 0.0
    blade = {name: v for name, v in steps.blade(fit.surface, with_radius=milled).items() if name in fit.moved}
    with suppress(GeometryError):
        fit = again(fit, blade) if blade else fit
    return fit


BLADE_ANGLES = (math.radians(8.0), math.radians(32.0))  # customary
NEAR_ANGLE = math.radians(5.0)  # of a blade to that of the start
SURE_SHARE = 0.75  # of the residual of a good fit, up to which a blade near that of the start is taken


Start = TypeVar("Start")
Fit = TypeVar("Fit")


def first_good(
    attempts: Iterable[tuple[Start, Callable[[], Fit]]], cost: Callable[[Fit], float], good: Callable[[Fit], bool]
) -> tuple[Start, Fit]:
    """Start and fit of the first good attempt, else of the one that costs least; GeometryError if all fail."""
    best: tuple[Start, Fit] | None = None
    failure = GeometryError("no start")
    for start, attempt in attempts:
        try:
            fit = attempt()
        except GeometryError as error:
            failure = error
            continue
        if best is None or cost(fit) < cost(best[1]):
            best = start, fit
        if good(best[1]):
            break
    if best is None:
        raise failure
    return best


def _attempts(
    starts: Sequence[GearPair], target: EaseOffTarget, free: Sequence[str] | None, follow_root: bool
) -> Iterator[tuple[tuple[GearPair, float], Callable[[], Synthesis]]]:
    """Fits to try, the most promising first, with the pair and the fold margin that each starts from."""
    *crown_gear, conjugate = starts
    choices = [free] if free is not None else [FREE_SETTINGS_WITH_ROOT_ANGLE, None] if follow_root else [None]
    for pair in crown_gear:
        for names in choices:
            yield (pair, FOLD_MARGIN), partial(_from_crown_gear, pair, target, names, follow_root)
    yield (conjugate, 0.0), partial(fit_pinion, conjugate, target, free=free, follow_root=follow_root)
    if follow_root and free is None:
        yield (conjugate, 0.0), partial(_form_first, conjugate, target)


def _from_crown_gear(pair: GearPair, target: EaseOffTarget, free: Sequence[str] | None, follow_root: bool) -> Synthesis:
    """Fit from the pinion of the crown gear, its blade tips on the root cone itself.

    ``RootLine`` measures at blades that roll past: its wanted distances are those it gives for the flank found.
    """
    fit: Synthesis | None = None
    surface, section = pair.pinion.loaded, pair.pinion.section
    height = tip_gap(surface, section)
    for _ in range(ROOT_PASSES if follow_root else 1):
        root = np.nan_to_num(root_gap(surface, section) - height)
        near = replace(pair, pinion=replace(pair.pinion, loaded=surface))
        again = fit_pinion(near, target, free=free, follow_root=follow_root, fold_margin=FOLD_MARGIN, wanted_root=root)
        fit = started_from(pair.pinion.loaded, again, again.moved)
        if not np.any(np.abs(fit.root_gap) > ROOT_TOLERANCE):
            break
        surface, height = fit.surface, fit.root_gap
    assert fit is not None
    return fit


def started_from(start: GeneratingSurface, fit: Synthesis, names: Iterable[str]) -> Synthesis:
    """The fit, with the settings of the flank at which the search began."""
    return replace(fit, moved={name: (get_setting(start, name), get_setting(fit.surface, name)) for name in names})


def _form_first(pair: GearPair, target: EaseOffTarget) -> Synthesis:
    """A fit that takes the form of the flank first and the root cone then."""
    near = replace(pair, pinion=replace(pair.pinion, loaded=fit_pinion(pair, target).surface))
    fit = fit_pinion(near, target, follow_root=True)
    return started_from(pair.pinion.loaded, fit, fit.moved)


def is_good(fit: Synthesis, target: EaseOffTarget, root_limit: float) -> bool:
    """True if a fit is near its target, and its blade tips within a limit [mm] of the root cone."""
    return fit.largest_residual <= residual_limits(target)[0] and (
        math.isinf(root_limit) or bool(np.all(np.abs(fit.root_gap) <= root_limit))
    )
