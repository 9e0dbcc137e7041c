"""The fit that comes nearest to a target ease-off, one flank at a time, on a machine that knows no limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import get_setting, with_settings
from ..pair.gear_pair import GearPair
from ..tooth.blade_tip import tip_gap
from .fit_quality import residual_limits
from .root_line import root_gap
from .standard_steps import StandardSteps
from .synthesis import FREE_SETTINGS_WITH_ROOT_ANGLE, EaseOffTarget, Synthesis, fit_pinion, root_cost

RETRY_RESIDUAL = 0.005  # [mm]; root mean square residual above which another fit is tried
FOLD_MARGIN = 0.2  # of the conjugate gear's area; nodes nearer to a fold are no part of a fit from the crown gear
ROOT_PASSES = 10  # fits in which the blade tips come onto the root cone; two or three are usual
ROOT_TOLERANCE = 0.02  # [mm]; blade tips as near to the root cone are on it


def best_fit(
    starts: Sequence[GearPair],
    target: EaseOffTarget,
    free: Sequence[str] | None,
    follow_root: bool,
    clearance: float,
    steps: StandardSteps,
) -> Synthesis:
    """The fit that comes nearest to target and root cone: the first good one, else the best of several.

    Parameters
    ----------
    starts
        The pair with each pinion flank to start from; that of a Formate gear last.
    target
        The wanted ease-off.
    free, follow_root
        As in ``design_pair``.
    clearance
        Of the blanks [mm]: blade tips further off the root cone are not good.
    steps
        Standard steps of the blade, at which the machine settings are fitted once more.

    Raises
    ------
    GeometryError
        If no fit succeeds.
    """
    best: Synthesis | None = None
    from_start, margin_of_best = starts[-1], 0.0
    failure = GeometryError("no start")
    for pair, margin, attempt in _attempts(starts, target, free, follow_root):
        try:
            fit = attempt()
        except GeometryError as error:
            failure = error
            continue
        if best is None or _cost(fit, follow_root) < _cost(best, follow_root):
            best, from_start, margin_of_best = fit, pair, margin
        enough = len(starts) > 1 or best.rms < RETRY_RESIDUAL
        if enough and _good(best, target, clearance if follow_root else math.inf):
            break
    if best is None:
        raise failure
    return _stepped(best, from_start, target, follow_root, margin_of_best, steps)


def _stepped(
    fit: Synthesis,
    pair: GearPair,
    target: EaseOffTarget,
    follow_root: bool,
    fold_margin: float,
    steps: StandardSteps,
) -> Synthesis:
    """The fit with its blade at standard steps, and the other settings fitted once more."""
    milled = fit.surface.settings.indexing_ratio == 0.0
    blade = {name: v for name, v in steps.blade(fit.surface, with_radius=milled).items() if name in fit.moved}
    if not blade:
        return fit
    near = replace(pair, pinion=replace(pair.pinion, loaded=with_settings(fit.surface, blade)))
    names = [name for name in fit.moved if name not in blade]
    if fold_margin > 0.0:
        again = _from_crown_gear(near, target, names, follow_root)
    else:
        again = fit_pinion(near, target, free=names, follow_root=follow_root)
    return _started_from(pair.pinion.loaded, again, fit.moved)


def _attempts(
    starts: Sequence[GearPair], target: EaseOffTarget, free: Sequence[str] | None, follow_root: bool
) -> Iterator[tuple[GearPair, float, Callable[[], Synthesis]]]:
    """Fits to try, the most promising first, with the pair and the fold margin that each starts from."""
    *crown_gear, conjugate = starts
    choices = [free] if free is not None else [FREE_SETTINGS_WITH_ROOT_ANGLE, None] if follow_root else [None]
    for pair in crown_gear:
        for names in choices:
            yield pair, FOLD_MARGIN, partial(_from_crown_gear, pair, target, names, follow_root)
    yield conjugate, 0.0, partial(fit_pinion, conjugate, target, free=free, follow_root=follow_root)
    if follow_root and free is None:
        yield conjugate, 0.0, partial(_form_first, conjugate, target)


def _from_crown_gear(pair: GearPair, target: EaseOffTarget, free: Sequence[str] | None, follow_root: bool) -> Synthesis:
    """A fit from the pinion of the crown gear, its blade tips on the root cone itself.

    What ``RootLine`` measures at blades that roll past is corrected by what it gives for the flank found.
    """
    fit: Synthesis | None = None
    surface, section = pair.pinion.loaded, pair.pinion.section
    height = tip_gap(surface, section)
    for _ in range(ROOT_PASSES if follow_root else 1):
        wanted = np.nan_to_num(root_gap(surface, section) - height)
        near = replace(pair, pinion=replace(pair.pinion, loaded=surface))
        again = fit_pinion(
            near, target, free=free, follow_root=follow_root, fold_margin=FOLD_MARGIN, wanted_root=wanted
        )
        fit = _started_from(pair.pinion.loaded, again, again.moved)
        if not np.any(np.abs(fit.root_gap) > ROOT_TOLERANCE):
            break
        surface, height = fit.surface, fit.root_gap
    assert fit is not None
    return fit


def _started_from(start: GeneratingSurface, fit: Synthesis, names: Iterable[str]) -> Synthesis:
    """The fit, with the settings of the flank at which the search began."""
    return replace(fit, moved={name: (get_setting(start, name), get_setting(fit.surface, name)) for name in names})


def _form_first(pair: GearPair, target: EaseOffTarget) -> Synthesis:
    """A fit that takes the form of the flank first and the root cone then."""
    form = fit_pinion(pair, target)
    near = replace(pair, pinion=replace(pair.pinion, loaded=form.surface))
    fit = fit_pinion(near, target, follow_root=True)
    return _started_from(pair.pinion.loaded, fit, fit.moved)


def _cost(fit: Synthesis, follow_root: bool) -> float:
    """Mean square of the residual [mm^2], with that of the root line as the fit weighs it."""
    root = root_cost(fit) / fit.residual.size if follow_root else 0.0
    return fit.rms**2 + root


def _good(fit: Synthesis, target: EaseOffTarget, root_limit: float) -> bool:
    return fit.largest_residual <= residual_limits(target)[0] and (
        math.isinf(root_limit) or bool(np.all(np.abs(fit.root_gap) <= root_limit))
    )
