"""Aim of a search: objectives and limits over sides, assemblies and torques, and their references at the start."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.checks import shown
from ....core.errors import EaseoffError, InputError
from ....geometry.pair.gear_pair import FlankName
from ...analysis.solved_contact import SolvedContact
from .composite import Composite
from .contact_quantity import ContactQuantity, QuantityLimit
from .step_programme import Form, judged_objective
from .trust_region import Merit

Array = NDArray[np.float64]

#: Values of an objective at the start by side and number of the torque.
Reference = dict[tuple[FlankName, int], float]
#: Least reference of an objective, over which ratios are no longer of order one.
REFERENCE_MINIMUM = 1e-3


@dataclass(frozen=True)
class Load:
    """Where a quantity is read: side, assembly and torque, all by number but the side."""

    flank: FlankName
    assembly: int
    torque: int


@dataclass(frozen=True, eq=False)
class Reading:
    """Values of one side and assembly, with derivatives by the settings in micrometres of ease-off.

    Parameters
    ----------
    solved
        Of which it is.
    values
        Of ``SolvedContact``.
    differentiated
        Makes the exact derivatives; ``None`` where they are not wanted.
    differences
        Makes derivatives by differences of analyses.
    """

    solved: SolvedContact
    values: xr.Dataset
    differentiated: Callable[[], xr.Dataset] | None
    differences: Callable[[], xr.Dataset]

    @cached_property
    def exact(self) -> xr.Dataset | None:
        """The exact derivatives; ``None`` where they have no answer, as at a contact line that ends at undercut."""
        try:
            return None if self.differentiated is None else self.differentiated()
        except EaseoffError:
            return None

    @cached_property
    def slopes(self) -> xr.Dataset:
        """The derivatives, computed when they are asked for; raises EaseoffError if there are none of either kind."""
        return self.differences() if self.exact is None else self.exact


@dataclass(frozen=True)
class Objective:
    """A quantity to be made small.

    Parameters
    ----------
    quantity
        The quantity.
    weight
        In relation to the others.
    """

    quantity: ContactQuantity
    weight: float = 1.0


@dataclass(frozen=True, eq=False)
class Aim:
    """Objectives and limits.

    Parameters
    ----------
    objectives
        What is minimised.
    limits
        What is kept.
    form
        See ``judged_objective``.
    torques
        Of every analysis [N m].
    flanks
        Sides that are analysed.
    assemblies
        Number of assemblies.
    """

    objectives: tuple[Objective, ...]
    limits: tuple[QuantityLimit, ...]
    form: Form
    torques: tuple[float, ...]
    flanks: tuple[FlankName, ...]
    assemblies: int

    def __post_init__(self) -> None:
        if not self.objectives:
            raise InputError("minimize = []: must name a quantity at least, such as peak_to_peak")
        for kind, texts in (
            ("minimize", [one.quantity.text for one in self.objectives]),
            ("limit", [limit.text.partition("=")[0] for limit in self.limits]),
        ):
            twice = next((text for number, text in enumerate(texts) if text in texts[:number]), None)
            if twice is not None:
                raise InputError(f"{kind} = {shown(twice.rstrip('<>'))}: must be there once")
        for limit in self.limits:
            below = [one for one in self.limits if limit.upper > one.upper and one.quantity == limit.quantity]
            if any(one.bound >= limit.bound for one in below):
                raise InputError(
                    f"limit = {shown(limit.text)}: must be above the lower limit of the same quantity, {below[0].text}"
                )
        for quantity in self.quantities:
            if quantity.torque is not None and quantity.torque not in self.torques:
                told = ", ".join(f"{torque:g}" for torque in self.torques)
                raise InputError(f"quantity = {shown(quantity.text)}: must be at one of the torques {told} [N m]")
            if quantity.flank is not None and quantity.flank not in self.flanks:
                raise InputError(
                    f"quantity = {shown(quantity.text)}: must be of the flanks that are analysed, "
                    f"{' and '.join(self.flanks)}"
                )

    @property
    def quantities(self) -> list[ContactQuantity]:
        """Quantities of objectives and limits."""
        return [*(one.quantity for one in self.objectives), *(one.quantity for one in self.limits)]

    @property
    def weights(self) -> Array:
        """Weights of the objectives."""
        return np.array([one.weight for one in self.objectives])

    def loads(self, quantity: ContactQuantity) -> list[Load]:
        """Where a quantity counts."""
        flanks = [flank for flank in self.flanks if quantity.flank in (None, flank)]
        torques = [n for n, torque in enumerate(self.torques) if quantity.torque in (None, torque)]
        torques = torques if quantity.meaning.over_torque else torques[:1]
        return [
            Load(flank, number, torque) for flank in flanks for number in range(self.assemblies) for torque in torques
        ]

    def values(self, quantity: ContactQuantity, read: Callable[[ContactQuantity, Load], Composite]) -> Array:
        """Values of a quantity at all its loads."""
        return np.array([read(quantity, load).value() for load in self.loads(quantity)])

    def references(self, read: Callable[[ContactQuantity, Load], Composite]) -> list[Reference]:
        """By objective its values at the start by side and torque, of the worst assembly."""
        found = []
        for one in self.objectives:
            own: Reference = {}
            for load, value in zip(self.loads(one.quantity), self.values(one.quantity, read), strict=True):
                key = load.flank, load.torque
                own[key] = max(own.get(key, REFERENCE_MINIMUM), float(value))
            found.append(own)
        return found


@dataclass(frozen=True, eq=False)
class Judgement:
    """An aim with its references: what judges values and makes models.

    Parameters
    ----------
    aim
        The aim.
    references
        By objective, see ``Aim.references``.
    ceilings
        Limits of objectives over their references, by number of the objective, which are then not minimised; infinite
        for none. Of the points of a front.
    """

    aim: Aim
    references: Sequence[Reference]
    ceilings: tuple[tuple[int, float], ...] = ()

    def composites(
        self, read: Callable[[ContactQuantity, Load], Composite]
    ) -> tuple[tuple[tuple[Composite, ...], ...], tuple[tuple[Composite, ...], ...]]:
        """Objectives over their references, and limits over themselves."""
        aim = self.aim
        ratios = tuple(
            tuple(
                read(one.quantity, load).scaled(1.0 / own[load.flank, load.torque]) for load in aim.loads(one.quantity)
            )
            for one, own in zip(aim.objectives, self.references, strict=True)
        )
        limits = [
            tuple(limit.normed(read(limit.quantity, load)) for load in aim.loads(limit.quantity))
            for limit in aim.limits
        ]
        bounded = [(number, ceiling) for number, ceiling in self.ceilings if np.isfinite(ceiling)]
        limits += [tuple(c.scaled(1.0 / ceiling) for c in ratios[number]) for number, ceiling in bounded]
        ceiled = {number for number, _ in self.ceilings}
        kept = tuple(ratio for number, ratio in enumerate(ratios) if number not in ceiled)
        return kept, tuple(limits)

    @property
    def weights(self) -> Array:
        """Weights of the objectives that are minimised."""
        ceiled = {number for number, _ in self.ceilings}
        return np.array([w for number, w in enumerate(self.aim.weights) if number not in ceiled])

    def merit(self, read: Callable[[ContactQuantity, Load], Composite]) -> Merit:
        """What values reach."""
        ratios, limits = self.composites(read)
        values = [np.array([c.value() for c in one]) for one in ratios]
        passed = [max(0.0, max(c.value() for c in one) - 1.0) for one in limits]
        return Merit(judged_objective(values, self.weights, self.aim.form), float(sum(passed)))

    def by_assembly(self, read: Callable[[ContactQuantity, Load], Composite]) -> tuple[Array, Array]:
        """Greatest ratio of every objective, and the worst value of every limit's quantity, by assembly (k, a)."""
        aim = self.aim
        ratios = np.full((len(aim.objectives), aim.assemblies), -np.inf)
        for number, (one, own) in enumerate(zip(aim.objectives, self.references, strict=True)):
            loads = aim.loads(one.quantity)
            values = aim.values(one.quantity, read) / np.array([own[load.flank, load.torque] for load in loads])
            np.maximum.at(ratios[number], [load.assembly for load in loads], values)
        limited = np.full((len(aim.limits), aim.assemblies), -np.inf)
        signs = np.array([1.0 if limit.upper else -1.0 for limit in aim.limits])
        for number, limit in enumerate(aim.limits):
            places = [load.assembly for load in aim.loads(limit.quantity)]
            np.maximum.at(limited[number], places, signs[number] * aim.values(limit.quantity, read))
        return ratios, signs[:, None] * limited

    def worst(self, read: Callable[[ContactQuantity, Load], Composite]) -> tuple[Array, Array, Array]:
        """Of all loads: greatest ratio and greatest value of every objective, worst value of every limit's quantity."""
        ratios, limited = self.by_assembly(read)
        values = [self.aim.values(one.quantity, read).max() for one in self.aim.objectives]
        uppers = np.array([limit.upper for limit in self.aim.limits], dtype=bool)
        return ratios.max(axis=1), np.array(values), np.where(uppers, limited.max(axis=1), limited.min(axis=1))
