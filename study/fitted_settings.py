"""Machine settings that cut a modification of the ease-off: the pinion fitted to the present one with the addition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..cases.conversion import gear_pair
from ..cases.recording import flank_settings
from ..cases.schema.case_schema import Case
from ..geometry.design.synthesis import Synthesis, fit_pinion
from ..geometry.flanks.flank import solve_flank
from ..geometry.pair.ease_off import exact_ease_off
from ..geometry.pair.gear_pair import FlankName, GearPair
from ..geometry.pair.modification import Modification

Array = NDArray[Any]


@dataclass(frozen=True)
class _Wanted:
    """The ease-off of a pair, and a modification."""

    pair: GearPair
    modification: Modification

    def __call__(self, lengthwise: Array, profile: Array) -> Array:
        """Wanted ease-off (n) [mm] at fractions (n)."""
        gear = self.pair.gear
        flank = solve_flank(gear.loaded, gear.section, *gear.section.points(lengthwise, profile))
        now = exact_ease_off(flank, self.pair.pinion.loaded, self.pair.pinion.section, self.pair.assembly)
        return np.asarray(now.angle * now.lever_arm + 1e-3 * self.modification(lengthwise, profile))


def recorded_modification(tree: xr.DataTree) -> Modification:
    """The modification of a result of ``optimize``."""
    terms = tree["modification"].to_dataset()["coefficient"]
    return Modification({str(k): float(v) for k, v in zip(terms["term"].values, terms.values, strict=True)})


def fit_modification(
    case: Case, modification: Modification, *, flank: FlankName = "drive", free: Sequence[str] | None = None
) -> tuple[Case, Synthesis]:
    """Fit the pinion's settings to the present ease-off with a modification.

    Parameters
    ----------
    case
        A checked case.
    modification
        What shall be added to the ease-off.
    flank
        ``drive``: the pinion's concave flank is cut anew; ``coast``: the convex one.
    free
        Settings that may move; ``geometry.design.synthesis.FREE_SETTINGS`` if left out.

    Returns
    -------
    Case
        The case with the fitted flank of the pinion. A target that it records for this side is dropped.
    Synthesis
        Which settings moved, and what is left.

    Raises
    ------
    InputError, GeometryError
        As ``geometry.fit_pinion``.
    """
    pair = gear_pair(case, flank)
    found = fit_pinion(pair, _Wanted(pair, modification), free=free)
    side = "concave" if flank == "drive" else "convex"
    settings = flank_settings(found.surface, case.pinion.number_of_teeth)
    return (
        case.model_copy(
            update={
                "pinion": case.pinion.model_copy(update={side: settings}),
                "target": case.target.model_copy(update={flank: None}),
            }
        ),
        found,
    )
