"""Wear law: coefficients, step, stop and duty cycle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..core.checks import positive
from ..core.errors import InputError

WEAR_COEFFICIENT_LIMIT = 1e-3  # [mm^2/N]; more is a mistake of units


@dataclass(frozen=True)
class WearLaw:
    """Wear coefficients, step control and stop.

    Parameters
    ----------
    pinion_coefficient, gear_coefficient
        Depth per pressure and sliding way [mm^2/N]: Archard's dimensional coefficient. 1e-12 mm^2/N = 1e-18 m^2/N.
    revolutions
        Revolutions of the pinion after which to stop.
    largest_step
        Largest depth in one step [um]; between steps the contact is computed anew. The error is of first order in it.
    largest_depth
        Depth at which to stop before that [um]; none if left out.

    Raises
    ------
    InputError
        If a number cannot be used.

    Examples
    --------
    >>> WearLaw(1e-12, 2e-12, revolutions=1e7).largest_step
    0.5
    """

    pinion_coefficient: float
    gear_coefficient: float
    revolutions: float
    largest_step: float = 0.5
    largest_depth: float | None = None

    def __post_init__(self) -> None:
        for name in ("pinion_coefficient", "gear_coefficient"):
            value = positive(name, getattr(self, name), "mm^2/N", zero=True)
            if value > WEAR_COEFFICIENT_LIMIT:
                raise InputError(
                    f"{name} = {value:g}: must be at most {WEAR_COEFFICIENT_LIMIT:g} [mm^2/N]; 1e-12 is usual for a "
                    "well lubricated gear"
                )
        positive("revolutions", self.revolutions)
        positive("largest_step", self.largest_step, "um")
        if self.largest_depth is not None:
            positive("largest_depth", self.largest_depth, "um")


def duty_cycle(torque: float | Mapping[float, float]) -> dict[float, float]:
    """Torques with their shares of the revolutions.

    Raises
    ------
    InputError
        If a torque or share is not positive, or the shares do not add up to one.

    Examples
    --------
    >>> duty_cycle({100: 0.75, 300: 0.25})
    {100.0: 0.75, 300.0: 0.25}
    """
    shares = dict(torque) if isinstance(torque, Mapping) else {torque: 1.0}
    total = sum(shares.values())
    usable = bool(shares) and all(np.isfinite(v) and v > 0.0 for pair in shares.items() for v in pair)
    if not usable or abs(total - 1.0) > 1e-6:
        given = ", ".join(f"{t:g}: {share:g}" for t, share in shares.items())
        raise InputError(
            f"torque = {{{given}}}: must be a torque above 0 [N m], or several with their shares of the revolutions, "
            f"above 0; the shares add up to {total:g}, not 1"
        )
    return {float(t): float(share) / total for t, share in shares.items()}
