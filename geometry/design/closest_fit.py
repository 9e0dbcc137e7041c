"""The fit that comes nearest to a target ease-off, one flank at a time, on a machine that knows no limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ...core.errors import GeometryError
from ..cutting.named_settings import get_setting, with_settings
from ..pair.gear_pair import GearPair
from .ease_off_residual import ROOT_WEIGHT
from .fit_quality import residual_limits
from .standard_steps import StandardSteps
from .synthesis import FREE_SETTINGS_WITH_ROOT_ANGLE, EaseOffTarget, Synthesis, fit_pinion

RETRY_RESIDUAL = 0.005  # [mm]; root mean square residual above which another fit is tried
FOLD_MARGIN = 0.2  # of the conjugate gear's area; nodes nearer to a fold are no part of a fit from the crown gear
LOST_ROOT_GAP = 10.0  # [mm]; weight of a root point that the cutter does not reach


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
    again = fit_pinion(near, target, free=names, follow_root=follow_root, fold_margin=fold_margin)
    moved = {name: (start, get_setting(again.surface, name)) for name, (start, _) in fit.moved.items()}
    return replace(again, moved=moved)


def _attempts(
    starts: Sequence[GearPair], target: EaseOffTarget, free: Sequence[str] | None, follow_root: bool
) -> Iterator[tuple[GearPair, float, Callable[[], Synthesis]]]:
    """Fits to try, the most promising first, with the pair and the fold margin that each starts from."""
    *crown_gear, conjugate = starts
    choices = [free] if free is not None else [FREE_SETTINGS_WITH_ROOT_ANGLE, None] if follow_root else [None]
    for pair in crown_gear:
        for names in choices:
            fit = partial(fit_pinion, pair, target, free=names, follow_root=follow_root, fold_margin=FOLD_MARGIN)
            yield pair, FOLD_MARGIN, fit
    yield conjugate, 0.0, partial(fit_pinion, conjugate, target, free=free, follow_root=follow_root)
    if follow_root and free is None:
        yield conjugate, 0.0, partial(_form_first, conjugate, target)


def _form_first(pair: GearPair, target: EaseOffTarget) -> Synthesis:
    """A fit that takes the form of the flank first and the root cone then."""
    form = fit_pinion(pair, target)
    near = replace(pair, pinion=replace(pair.pinion, loaded=form.surface))
    fit = fit_pinion(near, target, follow_root=True)
    start = pair.pinion.loaded
    return replace(fit, moved={name: (get_setting(start, name), end) for name, (_, end) in fit.moved.items()})


def _cost(fit: Synthesis, follow_root: bool) -> float:
    """Mean square of the residual [mm^2], with that of the root line as the fit weighs it."""
    gap = np.nan_to_num(fit.root_gap, nan=LOST_ROOT_GAP) if follow_root else np.zeros(0)
    return float(fit.rms**2 + np.sum((1e-3 * ROOT_WEIGHT * gap) ** 2) / fit.residual.size)


def _good(fit: Synthesis, target: EaseOffTarget, root_limit: float) -> bool:
    return fit.largest_residual <= residual_limits(target)[0] and (
        math.isinf(root_limit) or bool(np.all(np.abs(fit.root_gap) <= root_limit))
    )
