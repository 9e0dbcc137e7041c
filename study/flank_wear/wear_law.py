"""Wear law: coefficients, step, stop and duty cycle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ...cases.schema.usual_torques import TORQUE_LIMIT, TORQUE_MINIMUM, torque_range
from ...core.checks import number, positive, whole
from ...core.errors import InputError, time_in_words

WEAR_COEFFICIENT_LIMIT = 1e-3  # [mm^2/N]; more is a mistake of units
REVOLUTIONS_LIMIT = 1e15  # of the pinion; 2000 years at 1e6 1/min
WEAR_DEPTH_LIMIT = 1e4  # [um]; deeper than the teeth of usual gears are thick
USUAL_STEP_LIMIT = 1000


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
    most_steps
        The most steps to take.

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
    most_steps: int = USUAL_STEP_LIMIT

    def __post_init__(self) -> None:
        for name in ("pinion_coefficient", "gear_coefficient"):
            value = positive(name, getattr(self, name), "mm^2/N", zero=True)
            if value > WEAR_COEFFICIENT_LIMIT:
                raise InputError(
                    f"{name} = {value:g}: must be at most {WEAR_COEFFICIENT_LIMIT:g} [mm^2/N]; 1e-12 is usual for a "
                    "well lubricated gear"
                )
        for name, unit, most in (
            ("revolutions", "1", REVOLUTIONS_LIMIT),
            ("largest_step", "um", WEAR_DEPTH_LIMIT),
            ("largest_depth", "um", WEAR_DEPTH_LIMIT),
        ):
            value = getattr(self, name)
            if value is not None and positive(name, value, unit) > most:
                words = "" if unit == "1" else f" [{unit}]"
                raise InputError(f"{name} = {value:g}: must be at most {most:g}{words}")
        whole("most_steps", self.most_steps, 1)

    def steps(self, fastest: float) -> float:
        """Number of steps if the flanks went on wearing as they do now; a whole number, or infinite.

        Parameters
        ----------
        fastest
            Greatest depth per revolution of the pinion [mm].
        """
        depth = 1e3 * fastest * self.revolutions
        if self.largest_depth is not None:
            depth = min(depth, self.largest_depth)
        count = depth / self.largest_step
        return float(max(math.ceil(count * (1.0 - 1e-12)), 1)) if math.isfinite(count) else math.inf

    def require_few_steps(self, fastest: float, problems: int, seconds: float) -> None:
        """Refuse to take more steps than are allowed, and tell what they would cost.

        Parameters
        ----------
        fastest
            As of ``steps``.
        problems
            Contact problems of a step.
        seconds
            Time that a step takes [s].

        Raises
        ------
        InputError
            With the smallest step for which the steps allowed are enough.
        """
        count = self.steps(fastest)
        if count <= self.most_steps:
            return
        least = float(f"{self.largest_step * count / self.most_steps:.1e}") * 1.1 if math.isfinite(count) else math.inf
        raise InputError(
            f"largest_step = {self.largest_step:g}: would take about {count:.3g} steps, in each of which {problems} "
            f"contact problems are solved, {time_in_words(seconds * count)} in all: must be "
            + (f"{least:.2g} [um] or more" if least <= WEAR_DEPTH_LIMIT else "greater")
            + f" for {self.most_steps} steps; most_steps (--most-steps) allows more, largest_depth ends it earlier"
        )


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
    given = torque if isinstance(torque, Mapping) else {number("torque", torque, "N m"): 1.0}
    shares = {number("torque", one, "N m"): number("share of a torque", share) for one, share in given.items()}
    total = sum(shares.values())
    usable = bool(shares) and all(v > 0.0 for pair in shares.items() for v in pair)
    wrong = [one for one in shares if usable and not TORQUE_MINIMUM <= one < TORQUE_LIMIT]
    if wrong:
        raise InputError(f"torque = {wrong[0]:g}: must be {torque_range()}")
    if not usable or abs(total - 1.0) > 1e-6:
        told = ", ".join(f"{t:g}: {share:g}" for t, share in shares.items())
        raise InputError(
            f"torque = {{{told}}}: must be a torque above 0 [N m], or several with their shares of the revolutions, "
            f"above 0; the shares add up to {total:g}, not 1"
        )
    return {t: share / total for t, share in shares.items()}
