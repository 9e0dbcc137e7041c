"""Fitted settings: machine settings of the pinion that realise a modification of the ease-off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...cases.conversion import gear_pair
from ...cases.schema.case_schema import Case
from ...cases.writing import flank_settings
from ...geometry.design.synthesis import Synthesis, fit_pinion
from ...geometry.flanks.flank import solve_flank
from ...geometry.pair.ease_off import exact_ease_off
from ...geometry.pair.gear_pair import FlankName, GearPair
from ...geometry.pair.modification import Modification

Array = NDArray[Any]


@dataclass(frozen=True)
class _Wanted:
    """Ease-off of a pair with a modification, as a target of the fit."""

    pair: GearPair
    modification: Modification

    def __call__(self, lengthwise: Array, profile: Array) -> Array:
        """Wanted ease-off (n) [mm] at lengthwise and profile fractions (n)."""
        gear = self.pair.gear
        flank = solve_flank(gear.loaded, gear.section, *gear.section.points(lengthwise, profile))
        now = exact_ease_off(flank, self.pair.pinion.loaded, self.pair.pinion.section, self.pair.assembly)
        return np.asarray(now.angle * now.lever_arm + 1e-3 * self.modification(lengthwise, profile))


def recorded_modification(tree: xr.DataTree) -> Modification:
    """Modification of a result of ``modify``.

    Examples
    --------
    >>> import easeoff
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = easeoff.modify(case, torques=[200.0], order=2, programmes=1)
    >>> sorted(recorded_modification(tree).coefficients)
    ['bias', 'lengthwise_crowning', 'pressure_angle_error', 'profile_crowning', 'spiral_angle_error']
    """
    terms = tree["modification"].to_dataset()["coefficient"]
    return Modification({str(k): float(v) for k, v in zip(terms["term"].values, terms.values, strict=True)})


def fit_modification(
    case: Case, modification: Modification, *, flank: FlankName = "drive", free: Sequence[str] | None = None
) -> tuple[Case, Synthesis]:
    """Fit the pinion's settings to the ease-off of a case with a modification.

    Parameters
    ----------
    case
        A checked case.
    modification
        Addition to the ease-off.
    flank
        ``drive`` fits the pinion's concave flank, ``coast`` its convex one.
    free
        Settings that may move; those of ``fit_pinion`` if left out.

    Returns
    -------
    Case
        The case with the fitted flank of the pinion. A target recorded for this side is dropped.
    Synthesis
        The moved settings and the residual.

    Raises
    ------
    InputError, GeometryError
        As ``easeoff.geometry.fit_pinion``.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> from easeoff.geometry import Modification
    >>> fitted, fit = fit_modification(read_case("nasa-12x36"), Modification({"lengthwise_crowning": 5.0}))
    >>> fit.rms < 1e-3
    True
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
