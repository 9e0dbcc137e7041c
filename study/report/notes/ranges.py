"""Ranges of the friction models in words: which part of the power loss is beyond them, for run, show and pictures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....friction.kolivand_formula import TOLD_THINNING

#: Input that a flag of ``/friction/formula_flags`` is about.
INPUTS = {
    1: "slide-to-roll ratio",
    2: "pressure",
    4: "roughness",
    8: "pressure",
    16: "radius",
    32: "rolling velocity",
    64: "roughness",
    128: "temperature",
    256: "lambda ratio",
    512: "coefficient",
    1024: "radius",
    2048: "rolling velocity",
    4096: "viscosity",
    8192: "pressure-viscosity coefficient",
    16384: "lambda ratio",
}
CONDITIONS = ("torque", "speed", "temperature", "roughness")
#: Least part of the power loss that is told: a pitch line, where nothing slides, has one or two per cent.
TOLD_SHARE = 0.05
TOLD_TRANSITION = 0.1  # the same where two expressions of a formula meet


def range_notes(friction: xr.Dataset, at: Mapping[str, int] | None = None) -> list[str]:
    """Notes on what of the power loss is beyond the range of a model: one each for formula, oil, temperature and film.

    Parameters
    ----------
    friction
        The group ``/friction``.
    at
        Numbers of torque, speed, temperature and roughness; all conditions if left out, of which the worst is named.

    Returns
    -------
    list of str
        No notes if everything is within, or the result is of an older version.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0], speed=10.0)
    >>> range_notes(tree["friction"].to_dataset())[0].partition(" lies")[0]
    'Note: 100 % of the power loss at 100 N m, 10 1/min, 0.8 um'
    """
    if "film_thinning" not in friction:
        return []
    here = friction.isel({name: [int(number)] for name, number in (at or {}).items()})
    named = at is None
    texts = (*_formula(here, named), *_oil(here), *_temperature(here), *_film(here, named))
    return [f"Note: {text}" for text in texts]


def _formula(friction: xr.Dataset, named: bool) -> list[str]:
    """Sentences on the range of the friction formula, and on where its expressions meet."""
    found = []
    worst, place = _worst(friction, "extrapolated_share", TOLD_SHARE)
    if place is not None:
        parts: dict[str, float] = {}
        for flag, share in zip(
            friction["formula_flag"].values, friction["flagged_share"].isel(place).values, strict=True
        ):
            name = INPUTS.get(int(flag), "another input")
            parts[name] = parts.get(name, 0.0) + float(share)
        largest = sorted(parts, key=lambda name: -round(parts[name], 4))  # alike but for rounding stay in order
        told = [name for name in largest if parts[name] >= TOLD_SHARE]
        inputs = [name for name in told if name != "coefficient"] or told or largest[:1]
        found.append(
            f"{_percent(worst)} of the power loss{_at(friction, place, 'roughness', named)} lies outside the range "
            f"of the friction formula ({', '.join(inputs)})."
        )
    worst, place = _worst(friction, "transition_share", TOLD_TRANSITION)
    if place is not None:
        smooth = friction.attrs["friction_coefficient"] == "kolivand_blended"
        passing = "passes smoothly" if smooth else "jumps"
        found.append(
            f"{_percent(worst)} of the power loss{_at(friction, place, 'roughness', named)} is where two expressions "
            "of the friction formula meet (lambda ratio 0.9 to 1.1 or 2.7 to 3.3); they differ by 10 to 30 % as a "
            f"rule, and the coefficient {passing} from one to the other."
        )
    return found


def _oil(friction: xr.Dataset) -> list[str]:
    """Sentence on an oil that the formula was not made for."""
    attrs = friction.attrs
    if "formula_oil" not in attrs:
        return []
    sliding = friction["mean_sliding_loss"] / friction["mean_power_loss"]
    values = sliding.values[np.isfinite(sliding.values)]
    share = float(values.max()) if values.size else 1.0
    return [
        f"{_percent(share)} of the power loss is by a friction formula made for {attrs['formula_oil']}; the oil "
        f"{attrs['oil']} enters it through its viscosity and pressure-viscosity coefficient alone."
    ]


def _temperature(friction: xr.Dataset) -> list[str]:
    """Sentence on temperatures beyond the oil's data."""
    clamped = friction["temperature"].values[friction["temperature_clamped"].values > 0]
    if not clamped.size:
        return []
    ends = np.atleast_1d(friction.attrs["oil_temperature_range_degC"])
    asked = ", ".join(f"{value:g}" for value in clamped)
    return [
        f"100 % of the power loss at {asked} degC is computed with the oil's properties at the end of its data, which "
        f"are from {ends[0]:g} to {ends[1]:g} degC."
    ]


def _film(friction: xr.Dataset, named: bool) -> list[str]:
    """Sentence on the thinning of the film by heat of the inlet."""
    worst, place = _worst(friction, "film_thinning", TOLD_THINNING)
    if place is None:
        return []
    share, heating = float(friction["thinned_share"].isel(place)), friction.attrs["film_heating"]
    end = "it is left out; film_heating = 'gupta_cheng' includes it" if heating == "none" else "it is included"
    return [
        f"heat of the inlet thins the film by up to {_percent(worst)}{_at(friction, place, 'temperature', named)}, and "
        f"by more than 10 % for {_percent(share)} of the power loss "
        f"({'gupta_cheng' if heating == 'none' else heating}): {end}."
    ]


def _worst(friction: xr.Dataset, name: str, least: float) -> tuple[float, dict[str, int] | None]:
    """Greatest value of a share and where it is; nowhere if it is below the least that is told."""
    if name not in friction:
        return 0.0, None
    values: NDArray[Any] = np.nan_to_num(friction[name].transpose(*CONDITIONS).values)
    worst = float(values.max(initial=0.0))
    if worst < least:
        return worst, None
    # Shares that are alike but for rounding count as one: the first of them is named.
    number = int(np.argmax(values.ravel() >= worst - 1e-6))
    return worst, {name: int(i) for name, i in zip(CONDITIONS, np.unravel_index(number, values.shape), strict=True)}


def _at(friction: xr.Dataset, place: Mapping[str, int], more: str, named: bool) -> str:
    """Torque, speed and another condition in words, and those of which the result has several; or nothing."""
    if not named:
        return ""
    units = {"torque": "N m", "speed": "1/min", "temperature": "degC", "roughness": "um"}
    chosen = [name for name in CONDITIONS if name in ("torque", "speed", more) or friction.sizes[name] > 1]
    values = {name: f"{float(friction[name].values[place[name]]):.4g}" for name in chosen}
    if "roughness" in values:
        both = [f"{float(friction[f'roughness_{m}'].values[place['roughness']]):.4g}" for m in ("pinion", "gear")]
        values["roughness"] = both[0] if both[0] == both[1] else "/".join(both)
    return " at " + ", ".join(f"{values[name]} {units[name]}" for name in chosen)


def _percent(share: float) -> str:
    """A share in per cent; 100 for the whole alone."""
    percent = 100.0 * share
    return f"{min(percent, 99.0) if percent < 99.95 else 100.0:.0f} %"
