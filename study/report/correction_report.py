"""Correction report: global errors, corrective settings and predicted rest of measured flanks, as text."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict

import numpy as np
from tabulate import tabulate

from ...geometry.cutting.named_settings import get_setting, setting_step
from ...geometry.deviation.correction_fit import EFFECT_LIMIT
from ...geometry.deviation.corrective_settings import CorrectedFlank, Correction
from ...geometry.deviation.deviation import zeroed
from ...geometry.deviation.global_errors import angle_errors, fit_global_errors
from ...geometry.pair.gear_pair import MEMBERS
from ..deviations.case_correction import CaseCorrection

SMALL_GAIN = 0.7  # share of the deviation left above which a correction hardly pays
ROOT_SHARE = 0.2  # of the clearance, a move of the root from which on a warning is given
CONDITION_LIMIT = 1e3  # above which settings are told to do nearly the same


def correction_report(found: CaseCorrection) -> str:
    """Report of the corrections of a case.

    Parameters
    ----------
    found
        The corrections.

    Returns
    -------
    str
        For every set-up the global errors of its flanks, the settings to be set, and the predicted rest.
    """
    parts = [
        "\n".join(_set_up_lines(name, correction))
        for name in MEMBERS
        for correction in found.corrections.get(name, ())  # type: ignore[call-overload]
    ]
    return "\n\n".join(parts)


def _set_up_lines(name: str, correction: Correction) -> Iterator[str]:
    sides = [flank.side for flank in correction.flanks]
    together = ", one set-up" if len(correction.surfaces) > 1 else ""
    flanks = f"{' and '.join(sides)} flank{'s' if len(sides) > 1 else ''}"
    yield f"{name}, {flanks}{together}: global errors, um of metal at the edges of the flank"
    for flank in correction.flanks:
        yield from _error_lines(flank)
    yield ""
    yield "corrective settings"
    yield tabulate(
        list(_setting_rows(correction)),
        headers=["setting", "unit", "designed", "change", "to set"],
        disable_numparse=True,
        colalign=("left", "left", "right", "right", "right"),
    )
    yield tabulate(
        [
            (flank.side, stage, *_sizes(getattr(flank, key)))
            for flank in correction.flanks
            for stage, key in (("measured", "before"), ("by derivatives", "linear"), ("cut anew", "after"))
        ],
        headers=["flank", "um", "rms", "least", "greatest", "sum of squares"],
        disable_numparse=True,
        colalign=("left", "left", "right", "right", "right", "right"),
    )
    yield (
        f"rms {1e3 * correction.rms_before:.2f} um, after the correction {1e3 * correction.rms:.2f} um, as predicted "
        "on flanks cut anew with the settings to set; a rotation of the tooth is left out"
    )
    for flank in correction.flanks:
        if np.any(np.abs(flank.root_change) >= 0.5e-3):
            moved = ", ".join(f"{1e3 * value:+.0f}" for value in flank.root_change)
            yield f"{flank.side} flank: the root moves by {moved} um at toe, middle, heel; negative is deeper"
    yield from (f"Warning: {warning}" for warning in root_warnings(correction))
    yield from _notes(correction)


def root_warnings(correction: Correction) -> Iterator[str]:
    """Warnings of flanks whose corrected settings move the root by ``ROOT_SHARE`` of the clearance or more."""
    free = list(dict.fromkeys(key.partition(".")[0] for key in correction.changes))
    if "point_radius" in free:
        advice = "name fewer settings by --free, or leave the root as it is told here"
    else:
        advice = f"a cutter of another radius holds the depth: --free {','.join([*free, 'point_radius'])}"
    for flank in correction.flanks:
        clearance = flank.member.section.clearance
        known = flank.root_change[np.isfinite(flank.root_change)]
        farthest = float(np.max(np.abs(known), initial=0.0))
        if farthest > 0.0 and farthest >= ROOT_SHARE * clearance:
            yield (
                f"the root of the {flank.side} flank moves by up to {farthest:.2f} mm, of a clearance of "
                f"{clearance:.2f} mm: check slot depth and tip clearance; {advice}"
            )


def _error_lines(flank: CorrectedFlank) -> Iterator[str]:
    turned = zeroed(flank.deviation, flank.member.loaded)
    if min(turned.value.shape) < 3:
        yield f"{flank.side}: too few rows or columns for global errors"
        return
    found = fit_global_errors(turned)
    angles = dict(zip(("spiral_angle", "pressure_angle"), angle_errors(found.errors, flank.member), strict=True))
    rows = [
        (key, f"{value:+.1f}", f"{60.0 * math.degrees(angles[key]):+.2f}" if key in angles else "")
        for key, value in asdict(found.errors).items()
    ]
    yield tabulate(
        rows, headers=[flank.side, "um", "minutes"], disable_numparse=True, colalign=("left", "right", "right")
    )
    yield f"rms {found.rms_before:.2f} um, without these {found.rms:.2f} um"


def _setting_rows(correction: Correction) -> Iterator[tuple[str, str, str, str, str]]:
    """Name, unit, designed, change and value to set of each free setting."""
    by_side = {flank.side: flank.member.loaded.designed for flank in correction.flanks}
    for key, change in correction.changes.items():
        name, _, which = key.partition(".")
        start = get_setting(by_side[which] if which else correction.flanks[0].member.loaded.designed, name)  # type: ignore[index]
        resolution = setting_step(name)
        written = [resolution.written(value) + 0.0 for value in (start, start + change)]
        digits = resolution.decimals + 3
        difference = f"{written[1] - written[0]:+.{digits}f}" if all(map(math.isfinite, written)) else ""
        designed = f"{written[0]:.{digits}f}" if math.isfinite(written[0]) else resolution.text(start)
        yield key, resolution.unit, designed, difference, resolution.text(start + change)


def _sizes(values: np.ndarray) -> tuple[str, ...]:
    """Root mean square, extremes and sum of squares of deviations [mm], in um."""
    um = 1e3 * values[np.isfinite(values)]
    return f"{np.sqrt(np.mean(um**2)):.2f}", f"{um.min():+.1f}", f"{um.max():+.1f}", f"{np.sum(um**2):.1f}"


def _notes(correction: Correction) -> Iterator[str]:
    for flank in correction.flanks:
        if np.any(flank.missing):
            column, row = np.argwhere(flank.missing)[0] + 1
            yield (
                f"Note: {flank.side} flank: {np.sum(flank.missing)} of {flank.missing.size} points, the first in row "
                f"{row}, column {column}, are left out: the flank with the errors found does not reach them."
            )
    if correction.nothing:
        yield (
            "Note: nothing to correct: no change of these settings by steps of the machine's resolution lessens the "
            "deviation."
        )
        return
    if correction.rms > SMALL_GAIN * correction.rms_before:
        yield (
            "Note: most of the deviation is no error of these settings; the changes hardly pay. Free others, or fewer."
        )
    if len(correction.surfaces) > len(correction.flanks):
        other = next(which for which in correction.surfaces if which != correction.flanks[0].side)
        yield f"Note: the {other} flank is cut in the same set-up and changes, too; it was not measured."
    if correction.loose:
        words = "; ".join(", ".join(combination.settings) for combination in correction.loose)
        count = f"{len(correction.loose)} combination{'s' if len(correction.loose) > 1 else ''}"
        yield (
            f"Note: no measurement tells {count} of settings ({words}), less than {1e3 * EFFECT_LIMIT:g} um rms a "
            "usual step: taken so that the root moves least; to choose otherwise, free fewer."
        )
    if correction.condition > CONDITION_LIMIT:
        yield (
            f"Note: condition {correction.condition:.2g}: some of these settings do nearly the same, and measuring "
            "errors move them far; free fewer."
        )
