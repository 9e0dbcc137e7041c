"""Plausibility of a result: notes on certified values that no gear has, most often from a mistaken setting."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ....contact.evaluation.marking_print import flank_share
from ....core.attributes import ROOT_RESOLUTION, ordered

#: [um] Ease-off on the common flank. Shipped pairs have up to 0.16 mm; a lost sign in a setting gives many mm.
EASE_OFF_LIMIT = 1000.0
#: [MPa] Greatest pressure. Case-hardened steel yields below the surface at 3 to 4 GPa: no contact is elastic beyond.
PRESSURE_LIMIT = 5000.0
#: Common flank over the gear flank. Teeth that belong together share most of it, 0.75 and more in the shipped cases.
COMMON_FLANK_LIMIT = 0.3


def plausibility(tree: xr.DataTree) -> list[str]:
    """Notes on the plausibility of a result: one each for ease-off, pressure, common flank and contradicting blanks.

    One more says how far root stresses are resolved, or why they are left out if they were asked for.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.

    Returns
    -------
    list of str
        No notes if all values are plausible and none is left out.

    Examples
    --------
    >>> import easeoff
    >>> plausibility(easeoff.analyze("nasa-12x36", torques=[100.0]))
    []
    """
    ease_off = tree["ease_off"].to_dataset()
    distance, inside = (ordered(ease_off, name, "lengthwise", "profile") for name in ("ease_off", "inside"))
    inside = inside == 1
    widest = float(np.max(np.abs(distance[inside]), initial=0.0))
    greatest = float(np.nan_to_num(tree["loaded"].to_dataset()["max_pressure"].values).max(initial=0.0))
    common = flank_share(inside)
    notes = []
    if widest > EASE_OFF_LIMIT:
        notes.append(
            f"Note: the ease-off reaches {1e-3 * widest:.3g} mm on the common flank, more than "
            f"{1e-3 * EASE_OFF_LIMIT:g} mm: are the settings of pinion and gear right, and their signs?"
        )
    if greatest > PRESSURE_LIMIT:
        notes.append(
            f"Note: the greatest pressure is {1e-3 * greatest:.3g} GPa, more than {1e-3 * PRESSURE_LIMIT:g} GPa, at "
            "which no steel is elastic: are torque and settings right?"
        )
    envelope = tree["unloaded"].to_dataset()["transmission_error_envelope"].values
    if untouched := int(np.count_nonzero(np.isnan(envelope))):
        notes.append(
            f"Note: without load the flanks do not touch at {untouched} of {envelope.size} mesh positions: there is no "
            "peak to peak of the unloaded transmission error."
        )
    if common < COMMON_FLANK_LIMIT:
        notes.append(
            f"Note: the flanks share {100 * common:.0f} % of the gear flank, less than "
            f"{100 * COMMON_FLANK_LIMIT:.0f} %: are blanks, settings and misalignment right?"
        )
    notes += [f"Warning: {text}." for text in str(tree.attrs.get("contradictions", "")).split("; ") if text]
    if "root_stress" in tree.children:
        notes.append(f"Note: the root stress is too low, {ROOT_RESOLUTION}.")
    left_out = tree.attrs.get("root_stress_left_out")
    if left_out:
        notes.append(f"Note: no root stress. {left_out}")
    return notes
