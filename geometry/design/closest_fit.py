"""The fit that comes nearest to a target ease-off, one flank at a time, on a machine that knows no limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from ...core.errors import GeometryError
from ..cutting.named_settings import get_setting
from ..pair.gear_pair import GearPair
from .ease_off_residual import ROOT_WEIGHT
from .fit_quality import residual_limits
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

    Raises
    ------
    GeometryError
        If no fit succeeds.
    """
    best: Synthesis | None = None
    failure = GeometryError("no start")
    for attempt in _attempts(starts, target, free, follow_root):
        try:
            fit = attempt()
        except GeometryError as error:
            failure = error
            continue
        if best is None or _cost(fit, follow_root) < _cost(best, follow_root):
            best = fit
        enough = len(starts) > 1 or best.rms < RETRY_RESIDUAL
        if enough and _good(best, target, clearance if follow_root else math.inf):
            break
    if best is None:
        raise failure
    return best


def _attempts(
    starts: Sequence[GearPair], target: EaseOffTarget, free: Sequence[str] | None, follow_root: bool
) -> Iterator[Callable[[], Synthesis]]:
    """Fits to try, the most promising first."""
    *crown_gear, conjugate = starts
    choices = [free] if free is not None else [FREE_SETTINGS_WITH_ROOT_ANGLE, None] if follow_root else [None]
    for pair in crown_gear:
        for names in choices:
            yield partial(fit_pinion, pair, target, free=names, follow_root=follow_root, fold_margin=FOLD_MARGIN)
    yield partial(fit_pinion, conjugate, target, free=free, follow_root=follow_root)
    if follow_root and free is None:
        yield partial(_form_first, conjugate, target)


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
