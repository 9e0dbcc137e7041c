"""Supports that hardly belong to the pair: of another pair, bearings within a face, taper rollers that pull."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ....core.attributes import ordered
from ....geometry.pair.gear_pair import MEMBERS
from ..summary.supports_report import bearing_loads, towards_heel

#: Axial load of a bearing over the greatest of its member, from which both count as loaded in the same sense.
SHARED_LOAD_SHARE = 0.1


def supports_notes(tree: xr.DataTree) -> list[str]:
    """Notes on the supports of a pair, if it has some.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.

    Returns
    -------
    list of str
        None, or one each for supports shipped for another pair, bearings between toe and heel of their member, and
        bearings of a member that share its axial load in one sense.

    Examples
    --------
    >>> import easeoff
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 3})})
    >>> notes = supports_notes(easeoff.analyze(case, torques=[100.0], supports="axle-fm-11x41"))
    >>> notes[0]
    'Note: the supports axle-fm-11x41 are those of another pair, fm-11x41: are places and stiffness right for this one?'
    """
    if "supports" not in tree.children:
        return []
    return [*_other_pair(tree), *_within_face(tree), *_pulled(tree)]


def axial_face(tree: xr.DataTree, member: str) -> tuple[float, float]:
    """Where a member's flank lies on its axis [mm], from its crossing point, positive towards the heel.

    Examples
    --------
    >>> import easeoff
    >>> first, last = axial_face(easeoff.analyze("nasa-12x36", torques=[100.0]), "pinion")
    >>> round(first), round(last)
    (64, 89)
    """
    position = tree["flanks"].to_dataset()["position"].sel(member=member, xyz="z").values  # in the member's own frame
    return float(np.nanmin(position)), float(np.nanmax(position))


def _other_pair(tree: xr.DataTree) -> list[str]:
    """Shipped supports bear the name of their case: ``axle-fm-11x41``."""
    from ....cases.reading import read_case, shipped_cases, shipped_supports  # most pairs have none

    name = str(tree.attrs.get("supports_name", ""))
    if name not in shipped_supports():
        return []
    own = next((case for case in shipped_cases() if name.endswith(f"-{case}")), None)
    if own is None:
        return []
    pair = read_case(own)
    teeth = [pair.pinion.number_of_teeth, pair.gear.number_of_teeth]
    if teeth == [int(tree.attrs[f"{member}_teeth"]) for member in MEMBERS]:
        return []
    return [f"Note: the supports {name} are those of another pair, {own}: are places and stiffness right for this one?"]


def _within_face(tree: xr.DataTree) -> list[str]:
    """Bearings whose place on the axis is between toe and heel of their member."""
    group, ease_off = tree["supports"].to_dataset(), tree["ease_off"].to_dataset()
    if "bearing_position" not in group:
        return []
    notes = []
    places = ordered(group, "bearing_position", "bearing", "space")
    for member in MEMBERS:
        first, last = axial_face(tree, member)
        origin = np.asarray(ease_off.attrs[f"{member}_origin_mm"], dtype=float)
        for bearing, place in zip(group["bearing"].values, places, strict=True):
            along = float((place - origin) @ towards_heel(ease_off, member))
            if str(bearing).startswith(f"{member} ") and first < along < last:
                notes.append(
                    f"Note: the bearing {bearing} is at {along:.1f} mm on the axis, within the teeth, which reach from "
                    f"{first:.1f} to {last:.1f} mm: is its position right?"
                )
    return notes


def _pulled(tree: xr.DataTree) -> list[str]:
    """Members whose bearings all carry axial load in one sense, at the torque where they carry most."""
    names, _, axial = bearing_loads(tree)
    torques = np.sort(tree["supports"].to_dataset()["torque"].values)
    told = []
    for member in MEMBERS:
        own = [number for number, name in enumerate(names) if name.startswith(f"{member} ")]
        if len(own) < 2:
            continue
        mean = axial[own].mean(axis=2)
        weakest, largest = np.abs(mean).min(axis=0), np.abs(mean).max(axis=0)
        shared = (mean.min(axis=0) * mean.max(axis=0) > 0.0) & (weakest > SHARED_LOAD_SHARE * largest)
        if shared.any():
            at = int(np.argmax(np.where(shared, largest, -1.0)))
            loads = ", ".join(f"{names[number]} {mean[row, at]:+.0f} N" for row, number in enumerate(own))
            told.append(f"{loads} at {torques[at]:g} N m")
    if not told:
        return []
    return [
        f"Note: bearings of a member carry axial load in the same sense ({'; '.join(told)}): of two opposed taper "
        "roller bearings one is relieved, which holds as long as its preload lasts; these springs hold in both senses."
    ]
