"""Notes on results that are solved and certified but unlike any gear: most often a slip in a setting."""

from __future__ import annotations

import numpy as np
import xarray as xr

#: [um] Ease-off on the common flank. Shipped pairs have up to 0.16 mm; a lost sign in a setting gives many mm.
MOST_EASE_OFF = 1000.0
#: [MPa] Greatest pressure. Case-hardened steel yields below the surface at 3 to 4 GPa: no contact is elastic beyond.
MOST_PRESSURE = 5000.0
#: Common flank over the gear flank. Teeth that belong together share most of it, 0.75 and more in the shipped cases.
LEAST_COMMON = 0.3


def plausibility(tree: xr.DataTree) -> list[str]:
    """One note for each of ease-off, pressure and common flank that is beyond what gears have.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    """
    ease_off = tree["ease_off"].to_dataset()
    inside = ease_off["inside"].values == 1
    widest = float(np.max(np.abs(ease_off["ease_off"].values[inside]), initial=0.0))
    greatest = float(np.nan_to_num(tree["loaded"].to_dataset()["max_pressure"].values).max(initial=0.0))
    common = float(inside.mean())
    notes = []
    if widest > MOST_EASE_OFF:
        notes.append(
            f"Note: the ease-off reaches {1e-3 * widest:.3g} mm on the common flank, more than "
            f"{1e-3 * MOST_EASE_OFF:g} mm: are the settings of pinion and gear right, and their signs?"
        )
    if greatest > MOST_PRESSURE:
        notes.append(
            f"Note: the greatest pressure is {1e-3 * greatest:.3g} GPa, more than {1e-3 * MOST_PRESSURE:g} GPa: no "
            "steel bears that elastically; are torque and settings right?"
        )
    if common < LEAST_COMMON:
        notes.append(
            f"Note: the flanks share {100 * common:.0f} % of the gear flank, less than {100 * LEAST_COMMON:.0f} %: are "
            "blanks, settings and misalignment right?"
        )
    return notes
