"""Aim of a search: objectives and limits over sides, assemblies and torques, and their references at the start.

Its quantities are those of an analysis, and the form of the ease-off at some nodes of the flank, a rotation left out;
all with their changes by the settings.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import get_args

import numpy as np
import xarray as xr

from ....core.arrays import RealArray as Array
from ....core.attributes import ordered
from ....core.checks import number, shown
from ....core.errors import EaseoffError, InputError, suggestion
from ....geometry.pair.ease_off import exact_ease_off
from ....geometry.pair.gear_pair import FlankName, GearPair
from ...analysis.setting_derivatives import SolvedContact
from .step_programme import Composite, Form, Kind, judged_objective
from .trust_region import Merit

HARMONIC = re.compile(r"harmonic_([1-9]|1\d|20)")
WRITTEN = re.compile(r"\s*(?:(drive|coast)\.)?([a-z_0-9]+)\s*(?:@\s*([0-9.eE+]+))?\s*")
LIMIT = re.compile(r"(.+?)(<=|>=|=)(.+)")
#: Rows of the greatest pressure that a programme looks at: those that could become the greatest in a trust region.
ROW_COUNT = 80
#: Change that a tip counts with which no longer reaches the flank at its place [mm].
LOST_TIP = 10.0


@dataclass(frozen=True)
class QuantityKind:
    """Composite and variable of ``SolvedContact`` that give a quantity."""

    units: str
    kind: Kind
    variable: str
    member: str | None = None

    @property
    def over_torque(self) -> bool:
        """True if the torque changes it."""
        return self.variable not in ("unloaded_transmission_error_envelope", "ease_off", "blade_tip_gap")


KINDS: dict[str, QuantityKind] = {
    "peak_to_peak": QuantityKind("urad", "range", "transmission_error"),
    "max_pressure": QuantityKind("MPa", "greatest", "pressure"),
    "unloaded_peak_to_peak": QuantityKind("urad", "range", "unloaded_transmission_error_envelope"),
    "pinion_root_stress": QuantityKind("MPa", "greatest", "root_stress_history", "pinion"),
    "gear_root_stress": QuantityKind("MPa", "greatest", "root_stress_history", "gear"),
    "mean_power_loss": QuantityKind("W", "greatest", "mean_power_loss"),  # at the worst operating condition
    **{
        f"load_{what}_{way}": QuantityKind("1", "affine", f"load_{what}_{way}")
        for what in ("centre", "extent")
        for way in ("lengthwise", "profile")
    },
    "ease_off_change": QuantityKind("um", "greatest", "ease_off"),  # a rotation left out
    "root_line_change": QuantityKind("mm", "greatest", "blade_tip_gap"),  # of blade tips from root cones
}
#: What a case needs for variables that not every analysis has.
NEEDED = {
    "root_stress_history": "[compliance] model = 'fe' and edge radii of the blades",
    "mean_power_loss": "a speed in [friction]",
}
NAMES = ("peak_to_peak", "harmonic_1 to harmonic_20", *list(KINDS)[1:])


@dataclass(frozen=True)
class ContactQuantity:
    """One quantity of the contact, of ``NAMES``, at one torque and on one side or at all that are analysed."""

    name: str
    torque: float | None = None  # [N m]
    flank: FlankName | None = None

    def __post_init__(self) -> None:
        if self.name not in KINDS and not HARMONIC.fullmatch(self.name):
            raise InputError(
                f"quantity = {shown(self.name)}: must be one of {', '.join(NAMES)}{suggestion(self.name, KINDS)}"
            )
        if self.torque is not None:
            number("torque of a quantity", self.torque, "N m", above=0.0)
            if not self.meaning.over_torque:
                raise InputError(f"quantity = {shown(self.text)}: must be without torque, which does not change it")

    @classmethod
    def parsed(cls, text: str) -> ContactQuantity:
        """Quantity of a text such as ``coast.max_pressure@250``; raises InputError if it is none."""
        match = WRITTEN.fullmatch(text)
        try:
            torque = float(match[3]) if match and match[3] else None
        except ValueError:
            match = None
        if match is None:
            raise InputError(
                f"quantity = {shown(text)}: must be NAME, NAME@TORQUE or FLANK.NAME, such as max_pressure@250 or "
                f"coast.peak_to_peak; NAME is one of {', '.join(NAMES)}"
            )
        flank = next((one for one in get_args(FlankName) if one == match[1]), None)
        return cls(match[2], torque, flank)

    @property
    def text(self) -> str:
        """The quantity as it is written."""
        torque = "" if self.torque is None else f"@{self.torque:g}"
        return f"{'' if self.flank is None else f'{self.flank}.'}{self.name}{torque}"

    @property
    def unloaded(self) -> bool:
        """True if it is of the unloaded transmission error."""
        return self.name == "unloaded_peak_to_peak"

    @property
    def meaning(self) -> QuantityKind:
        """Its row in the table of kinds."""
        order = HARMONIC.fullmatch(self.name)
        return KINDS[self.name] if order is None else QuantityKind("urad", "norm", "transmission_error")

    def composite(
        self, values: xr.Dataset, slopes: xr.Dataset | None, torque: int, start: xr.Dataset, radius: float = 0.0
    ) -> Composite:
        """The quantity of one analysis and torque, by number, as a function of the settings from ``start``.

        Slopes are by settings (n) in units that change the ease-off by one micrometre at most; without them the value
        alone counts. ``radius`` is that of the trust region [um].
        """
        meaning = self.meaning
        if meaning.variable not in values:
            raise InputError(f"quantity = {shown(self.text)}: must be of a case with {NEEDED[meaning.variable]}")
        level, slope = _rows(meaning, values, slopes, torque)
        if self.name in ("ease_off_change", "root_line_change"):
            before, _ = _rows(meaning, start, None, torque)
            level = level - before
            if self.name == "ease_off_change":
                arm = ordered(start, "lever_arm", "lengthwise", "profile").ravel()
                level, slope = turned(level[:, None], arm)[:, 0], turned(slope, arm)
            else:
                level = np.where(np.isnan(level) & np.isfinite(before), LOST_TIP, level)
            level, slope = np.concatenate([level, -level]), np.concatenate([slope, -slope])
        if meaning.kind == "norm":
            order = int(self.name.rpartition("_")[2])
            level, slope = _fourier(level[:, None], order)[:, 0], _fourier(slope, order)
        elif meaning.kind == "greatest":
            level, slope = _likely_greatest(level, slope, radius)
        elif meaning.kind == "range":
            known = np.isfinite(level)
            if not known.any():
                level, slope = np.zeros(level.size), np.zeros(slope.shape)
            else:  # an unknown row counts as one that is known
                level = np.where(known, level, level[known][0])
                slope = np.where(known[:, None], slope, slope[known][0])
        return Composite(meaning.kind, level, np.nan_to_num(slope))


def _rows(meaning: QuantityKind, values: xr.Dataset, slopes: xr.Dataset | None, torque: int) -> tuple[Array, Array]:
    """Values (m) of a variable, and their derivatives (m, n)."""
    variable = _chosen(values[meaning.variable], meaning, torque)
    level = np.asarray(variable.values, dtype=np.float64).ravel()
    if slopes is None:
        return level, np.zeros((level.size, 0))
    change = _chosen(slopes[meaning.variable], meaning, torque).transpose(*variable.dims, "setting")
    return level, np.asarray(change.values, dtype=np.float64).reshape(level.size, -1)


def _chosen(values: xr.DataArray, meaning: QuantityKind, torque: int) -> xr.DataArray:
    if meaning.member is not None:
        values = values.isel(member=("pinion", "gear").index(meaning.member))
    return values.isel(torque=torque) if "torque" in values.dims else values


def turned(change: Array, arm: Array) -> Array:
    """Changes of the ease-off (s, n) less those of a rotation of the gear, with lever arms (s); zero where unknown."""
    known = np.isfinite(change) & np.isfinite(arm)[:, None]
    known_change = np.where(known, change, 0.0)
    lever = np.where(known, arm[:, None], 0.0)
    weight = np.sum(lever**2, axis=0)
    turn = np.sum(lever * known_change, axis=0) / np.where(weight > 0.0, weight, 1.0)
    return np.asarray(known_change - lever * turn)


def _fourier(rows: Array, order: int) -> Array:
    """Cosine and sine parts (2, n) of rows over the mesh cycle (k, n), as in ``loaded``."""
    count = len(rows)
    if order > count // 2:
        return np.zeros((2, rows.shape[1]))
    scale = (1.0 if 2 * order == count else 2.0) / count
    harmonic = scale * np.fft.rfft(rows, axis=0)[order]
    return np.stack([harmonic.real, harmonic.imag])


def _likely_greatest(level: Array, slope: Array, radius: float) -> tuple[Array, Array]:
    """The rows that may become the greatest, always as many: the last one repeated where there are fewer."""
    level, slope = np.where(np.isfinite(level), level, -np.inf), np.nan_to_num(slope)
    bound = level + radius * np.linalg.norm(slope, axis=1)
    chosen = np.argsort(-bound, kind="stable")[:ROW_COUNT]
    chosen = np.concatenate([chosen, np.repeat(chosen[:1], ROW_COUNT - chosen.size)])
    return np.where(np.isfinite(level[chosen]), level[chosen], 0.0), slope[chosen]


@dataclass(frozen=True)
class QuantityLimit:
    """Upper or lower limit of a quantity."""

    quantity: ContactQuantity
    bound: float
    upper: bool = True

    def __post_init__(self) -> None:
        if self.quantity.meaning.kind != "affine":
            number(f"limit of {self.quantity.text}", self.bound, self.quantity.meaning.units, above=0.0)
            if not self.upper:
                raise InputError(f"limit = {shown(self.text)}: must be an upper limit: {self.quantity.text}<=VALUE")

    @classmethod
    def parsed(cls, text: str) -> tuple[QuantityLimit, ...]:
        """Limits of a text: ``NAME<=VALUE``, ``NAME>=VALUE`` or ``NAME=VALUE+-BAND``; raises InputError if none."""
        parts = LIMIT.fullmatch(text.strip())
        try:
            numbers = [float(part) for part in parts[3].split("+-")] if parts else []
        except ValueError:
            numbers = []
        if parts is None or len(numbers) != (2 if parts[2] == "=" else 1):
            raise InputError(
                f"limit = {shown(text)}: must be QUANTITY<=VALUE, QUANTITY>=VALUE or QUANTITY=VALUE+-BAND, such as "
                "'max_pressure<=1500'; decimals have a point"
            )
        quantity = ContactQuantity.parsed(parts[1])
        if parts[2] != "=":
            return (cls(quantity, numbers[0], upper=parts[2] == "<="),)
        value, half = numbers
        return cls(quantity, value + half), cls(quantity, value - half, upper=False)

    @property
    def text(self) -> str:
        """The limit as it is written."""
        return f"{self.quantity.text}{'<=' if self.upper else '>='}{self.bound:g}"

    @property
    def scale(self) -> float:
        """By what a violation is measured: the limit itself."""
        return abs(self.bound) or 1.0

    def normed(self, composite: Composite) -> Composite:
        """A composite of the quantity as one that is one where the limit is reached."""
        if composite.kind != "affine":
            return composite.scaled(1.0 / self.scale)
        sign = 1.0 if self.upper else -1.0
        return composite.scaled(sign / self.scale, 1.0 - sign * self.bound / self.scale)


#: Values of an objective at the start by side and number of the torque.
Reference = dict[tuple[FlankName, int], float]
#: Least reference of an objective, over which ratios are no longer of order one.
REFERENCE_MINIMUM = 1e-3


@dataclass(frozen=True)
class Load:
    """Side, assembly and torque at which a quantity is read, all by number but the side."""

    flank: FlankName
    assembly: int
    torque: int


#: What reads a quantity at a load.
Read = Callable[[ContactQuantity, Load], Composite]


@dataclass(frozen=True, eq=False)
class Reading:
    """Values of one side and assembly, with derivatives by the settings in micrometres of ease-off."""

    solved: SolvedContact
    values: xr.Dataset
    differentiated: Callable[[], xr.Dataset] | None  # exact derivatives; None if not wanted
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
    """A quantity to be made small, with its weight."""

    quantity: ContactQuantity
    weight: float = 1.0


@dataclass(frozen=True, eq=False)
class Aim:
    """Objectives and limits."""

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
                torques = ", ".join(f"{torque:g}" for torque in self.torques)
                raise InputError(f"quantity = {shown(quantity.text)}: must be at one of the torques {torques} [N m]")
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
        """Loads at which a quantity counts."""
        flanks = [flank for flank in self.flanks if quantity.flank in (None, flank)]
        torques = [n for n, torque in enumerate(self.torques) if quantity.torque in (None, torque)]
        torques = torques if quantity.meaning.over_torque else torques[:1]
        return [Load(*place) for place in itertools.product(flanks, range(self.assemblies), torques)]

    def values(self, quantity: ContactQuantity, read: Read) -> Array:
        """Values of a quantity at all its loads."""
        return np.array([read(quantity, load).value() for load in self.loads(quantity)])

    def references(self, read: Read) -> list[Reference]:
        """By objective its values at the start by side and torque, of the worst assembly."""
        references = []
        for one in self.objectives:
            reference: Reference = {}
            for load, value in zip(self.loads(one.quantity), self.values(one.quantity, read), strict=True):
                key = load.flank, load.torque
                reference[key] = max(reference.get(key, REFERENCE_MINIMUM), float(value))
            references.append(reference)
        return references


@dataclass(frozen=True, eq=False)
class Judgement:
    """An aim with its references, which judges values and makes models."""

    aim: Aim
    references: Sequence[Reference]
    #: on a front: objective by number, limit over its reference (not minimised then)
    ceilings: tuple[tuple[int, float], ...] = ()

    def composites(self, read: Read) -> tuple[tuple[tuple[Composite, ...], ...], tuple[tuple[Composite, ...], ...]]:
        """Objectives over their references, and limits over themselves."""
        aim = self.aim
        ratios = []
        for one, reference in zip(aim.objectives, self.references, strict=True):
            scales = [(load, 1.0 / reference[load.flank, load.torque]) for load in aim.loads(one.quantity)]
            ratios.append(tuple(read(one.quantity, load).scaled(scale) for load, scale in scales))
        limits = [tuple(one.normed(read(one.quantity, load)) for load in aim.loads(one.quantity)) for one in aim.limits]
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

    def merit(self, read: Read) -> Merit:
        """Objective and violation that values reach."""
        ratios, limits = self.composites(read)
        values = [np.array([c.value() for c in one]) for one in ratios]
        passed = [max(0.0, max(c.value() for c in one) - 1.0) for one in limits]
        return Merit(judged_objective(values, self.weights, self.aim.form), float(sum(passed)))

    def by_assembly(self, read: Read) -> tuple[Array, Array]:
        """Greatest ratio of every objective, and the worst value of every limit's quantity, by assembly (k, a)."""
        aim = self.aim
        ratios = np.full((len(aim.objectives), aim.assemblies), -np.inf)
        for row, (one, reference) in enumerate(zip(aim.objectives, self.references, strict=True)):
            loads = aim.loads(one.quantity)
            values = aim.values(one.quantity, read) / np.array([reference[load.flank, load.torque] for load in loads])
            np.maximum.at(ratios[row], [load.assembly for load in loads], values)
        limited = np.full((len(aim.limits), aim.assemblies), -np.inf)
        signs = np.array([1.0 if limit.upper else -1.0 for limit in aim.limits])
        for row, limit in enumerate(aim.limits):
            places = [load.assembly for load in aim.loads(limit.quantity)]
            np.maximum.at(limited[row], places, signs[row] * aim.values(limit.quantity, read))
        return ratios, signs[:, None] * limited

    def worst(self, read: Read) -> tuple[Array, Array, Array]:
        """Of all loads: greatest ratio and greatest value of every objective, worst value of every limit's quantity."""
        ratios, limited = self.by_assembly(read)
        values = [self.aim.values(one.quantity, read).max() for one in self.aim.objectives]
        uppers = np.array([limit.upper for limit in self.aim.limits], dtype=bool)
        return ratios.max(axis=1), np.array(values), np.where(uppers, limited.max(axis=1), limited.min(axis=1))


#: Nodes lengthwise and along the profile.
FORM_NODES = (9, 7)
_GRID = ("lengthwise", "profile")


@dataclass(frozen=True, eq=False)
class EaseOffForm:
    """Ease-off of one pair of flanks at nodes (s), with derivatives by the settings (n)."""

    lengthwise: Array
    profile: Array
    lever_arm: Array  # (s) [mm]; NaN where the flanks have no common part
    value: Array  # (s) [um]
    slopes: Array  # (s, n), a rotation left out

    @classmethod
    def of(cls, reading: Reading) -> EaseOffForm:
        """Form of an analysis with derivatives."""
        values = reading.values
        rows, columns = (
            np.unique(np.linspace(0, values.sizes[name] - 1, count).round().astype(int))
            for name, count in zip(_GRID, FORM_NODES, strict=True)
        )
        chosen = np.ix_(rows, columns)
        arm, value = (values[name].transpose(*_GRID).values[chosen].ravel() for name in ("lever_arm", "ease_off"))
        change = reading.slopes["ease_off"].transpose(*_GRID, "setting").values[chosen]
        known = np.where(np.isfinite(value), arm, np.nan)
        slopes = turned(change.reshape(arm.size, -1), known)
        t, h = (values[name].values[nodes] for name, nodes in zip(_GRID, (rows, columns), strict=True))
        return cls(t, h, known, value, slopes)

    def missed(self, pair: GearPair, step: Array) -> Array:
        """Form after a step (n), to first order, less that of another pair (s) [um]; zero where either is unknown.

        GeometryError if the flanks of the other pair do not meet.
        """
        gear = pair.gear.flank(self.lengthwise, self.profile)
        exact = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
        difference = self.value + self.slopes @ step - 1e3 * exact.angle * exact.lever_arm
        return turned(difference[:, None], self.lever_arm)[:, 0]
