"""Free settings of a search: which ones, how far and in which steps, and the case that has them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from ....cases.conversion import gear_pair
from ....cases.schema.case_schema import Case
from ....cases.writing import flank_settings
from ....core.arrays import RealArray as Array
from ....core.checks import array, shown, words
from ....core.errors import InputError, suggestion
from ....geometry.cutting import named_settings
from ....geometry.cutting.generating_surface import GeneratingSurface
from ....geometry.cutting.named_settings import get_setting, setting_step
from ....geometry.design.pinion_method import MACHINE_SETTINGS, TILT_SETTINGS
from ....geometry.pair.gear_pair import FlankName, GearPair, shares_set_up
from ....geometry.pair.near_pair import PairSetting, is_angle
from ...analysis.setting_derivatives import CUTTER_KEYS, SIDES, derivative_settings
from ...analysis.swept_quantity import swept_quantity

#: Share of a setting's usual step that changes the ease-off by some micrometres.
ROUGH_SHARE = 0.01
CENTRE, BASE = "machine_center_to_crossing_point", "sliding_base"


@dataclass(frozen=True)
class FreeSetting:
    """One setting that a search moves, in the units of the case file."""

    name: str  # key in the case, with ``*`` for the flank where both share it
    moves: Mapping[str, float]  # keys that it moves, and by how much for one unit of it
    units: str
    start: float
    low: float = -math.inf
    high: float = math.inf

    @property
    def key(self) -> str:
        """The first key that it moves, of which it is the value."""
        return next(iter(self.moves))

    @property
    def setting(self) -> PairSetting:
        """Setting of a pair that this key is."""
        return pair_setting(self.key)

    def value_in(self, case: Case) -> float:
        """Its value in a case, in the units of the case file."""
        member, side, *_ = self.key.split(".")
        return case_units(self.setting) * self.setting.value(gear_pair(case, _flank_of(member, side)))

    @property
    def own_keys(self) -> list[str]:
        """Its name and the keys of which it is the value: not of those that follow it."""
        return [self.name, *(key for key, factor in self.moves.items() if factor == 1.0)]


def free_settings(
    case: Case, flanks: Sequence[FlankName], patterns: Sequence[str] | None = None
) -> tuple[FreeSetting, ...]:
    """Settings that a search moves, still without limits, by patterns such as ``pinion.*.machine.*``.

    Without patterns the machine settings that the set-up of the pinion uses: with tilt and modified roll where it has
    them. Without tilt the sliding base then follows the machine centre: the root stays on its cone.
    """
    pairs = {flank: gear_pair(case, flank) for flank in flanks}
    keys = {key: flank for flank, pair in pairs.items() for key in _movable(pair, flank)}
    known = _together(pairs, keys)
    if patterns is None:
        usual = tuple(_usual(pairs, known))
        if not usual:
            raise InputError("free = None: must name settings, as the pinion has none that its set-up moves")
        return usual
    settings: dict[str, FreeSetting] = {}
    for pattern in words("free", patterns, 1):
        names = [name for name, one in known.items() if any(fnmatchcase(key, pattern) for key in (name, *one.moves))]
        if not names:
            raise InputError(
                f"free = {shown(pattern)}: must be the key of a machine or cutter setting of the flanks in mesh, such "
                f"as {next(iter(known))}, or a pattern with *{suggestion(pattern, known)}"
            )
        settings |= {name: known[name] for name in names}
    return tuple(settings.values())


def _movable(pair: GearPair, flank: FlankName) -> list[str]:
    """Keys of machine and cutter settings, without the radius of a blade's profile, which may be infinite.

    On a generated member the basic cradle angle turns the tooth and does nothing else.
    """
    keys = []
    for key in derivative_settings(pair, flank):
        member, short = key.partition(".")[0], key.rpartition(".")[2]
        if member not in ("pinion", "gear") or short == "blade_spheric_radius":
            continue
        surface = (pair.pinion if member == "pinion" else pair.gear).loaded.designed
        turns_only = short == "cradle_angle" and surface.settings.generated
        if internal_name(key) in named_settings.movable_settings(surface) and not turns_only:
            keys.append(key)
    return keys


def _together(pairs: Mapping[FlankName, GearPair], keys: Mapping[str, FlankName]) -> dict[str, FreeSetting]:
    """Settings by name: the machine settings of both flanks are one setting where they share a set-up."""
    settings: dict[str, FreeSetting] = {}
    for key, flank in keys.items():
        name, moves = key, {key: 1.0}
        member, side, table, short = key.split(".")
        pair = pairs[flank]
        if table == "machine" and shares_set_up(pair.pinion if member == "pinion" else pair.gear):
            other = "convex" if side == "concave" else "concave"
            name, moves = f"{member}.*.{table}.{short}", {key: 1.0, f"{member}.{other}.{table}.{short}": 1.0}
        setting = pair_setting(key)
        start = case_units(setting) * setting.value(pair)
        settings.setdefault(name, FreeSetting(name, moves, swept_quantity(key).units, start))
    return settings


def _usual(pairs: Mapping[FlankName, GearPair], known: Mapping[str, FreeSetting]) -> list[FreeSetting]:
    settings: dict[str, FreeSetting] = {}
    for flank, pair in pairs.items():
        surface = pair.pinion.loaded.designed
        tilted = surface.settings.cutter_tilt != 0.0
        names = [*MACHINE_SETTINGS, *(TILT_SETTINGS if tilted else ())]
        names += [name for name in named_settings.MODIFIED_ROLL_ORDERS if get_setting(surface, name) != 0.0]
        for one in known.values():
            member, _, table, short = one.name.split(".")
            on_flank = f"pinion.{SIDES[flank]['pinion']}.{table}.{short}" in one.moves
            if member == "pinion" and table == "machine" and short in names and on_flank:
                settings[one.name] = one if tilted or short != CENTRE else _along_root(one, surface)
    return list(settings.values())


def _along_root(one: FreeSetting, surface: GeneratingSurface) -> FreeSetting:
    """The machine centre with the sliding base that keeps the tip plane of the cutter through the same apex."""
    slope = -math.sin(surface.settings.machine_root_angle)
    return replace(one, moves={**one.moves, **{key.replace(CENTRE, BASE): slope for key in one.moves}})


def internal_name(key: str) -> str:
    """Name in ``named_settings`` of a key of a case."""
    short = key.rpartition(".")[2]
    return CUTTER_KEYS.get(short, short)


def pair_setting(key: str) -> PairSetting:
    """Setting of a pair that a key of a case is."""
    return PairSetting("pinion" if key.startswith("pinion.") else "gear", internal_name(key))


def case_units(setting: PairSetting) -> float:
    """Value in the units of the case file of a setting that is one [mm, rad or per rad]."""
    return math.degrees(1.0) if is_angle(setting) else 1.0


def _flank_of(member: str, side: str) -> FlankName:
    """Flanks in mesh of which one is a side of a member."""
    return "drive" if SIDES["drive"][member] == side else "coast"


@dataclass(frozen=True)
class SettingSpace:
    """All free settings, and the cases that they make; InputError if limits hold no multiple of a setting's step."""

    case: Case
    free: tuple[FreeSetting, ...]
    resolution: named_settings.MachineResolution = named_settings.USUAL_RESOLUTION

    def __post_init__(self) -> None:
        for one, step in zip(self.free, self.steps.tolist(), strict=True):
            if named_settings.step_count(one.start, step, one.low, one.high) is None:
                raise InputError(
                    f"limits of {one.name} = {one.low:.10g}:{one.high:.10g}: must hold a multiple of the machine's "
                    f"step, {step:g} [{one.units}]: give wider limits, more --move or a finer --resolution"
                )

    @property
    def start(self) -> Array:
        """Values in the case (n)."""
        return np.array([one.start for one in self.free])

    @property
    def steps(self) -> Array:
        """Steps (n) of the machine, in the units of the case file."""
        return np.array([setting_step(internal_name(one.key), self.resolution).step for one in self.free])

    @property
    def scales(self) -> Array:
        """Changes (n) of some micrometres of ease-off, in the units of the case file."""
        return ROUGH_SHARE * np.array([case_units(one.setting) * one.setting.scale for one in self.free])

    def nearest(self, values: Array) -> Array:
        """The nearest values (n) that can be set, within the limits."""
        each = zip(values.tolist(), self.steps.tolist(), self.free, strict=True)
        return np.array([named_settings.nearest_multiple(value, step, one.low, one.high) for value, step, one in each])

    def case_at(self, values: Array, *, rounded: bool = False) -> Case:
        """The case with other values (n) of the free settings, ``rounded`` on request; InputError if out of range."""
        steps: dict[str, float] = {}
        for one, value in zip(self.free, values, strict=True):
            for key, factor in one.moves.items():
                steps[key] = steps.get(key, 0.0) + factor * (float(value) - one.start)
        members: dict[str, dict[str, Any]] = {"pinion": {}, "gear": {}}
        for member, changed in members.items():
            table = getattr(self.case, member)
            for side in ("concave", "convex"):
                flank_steps = {key: step for key, step in steps.items() if key.startswith(f"{member}.{side}.")}
                if flank_steps and getattr(table, side) is not None:
                    surface = self._moved(member, side, flank_steps, rounded=rounded)
                    changed[side] = _settings(surface, table.number_of_teeth, member, side)
        dropped: dict[str, Any] = {
            flank: None for flank, sides in SIDES.items() for member in members if sides[member] in members[member]
        }
        return self.case.with_tables(**members, target=dropped)

    def _moved(self, member: str, side: str, steps: Mapping[str, float], *, rounded: bool) -> GeneratingSurface:
        pair = gear_pair(self.case, _flank_of(member, side))
        surface = (pair.pinion if member == "pinion" else pair.gear).loaded.designed
        values = {}
        for key, step in steps.items():
            name = internal_name(key)
            factor = math.radians(1.0) if is_angle(pair_setting(key)) else 1.0
            value = get_setting(surface, name) + factor * step
            values[name] = setting_step(name, self.resolution).rounded(value) if rounded else value
        return named_settings.with_settings(surface, values)

    def values_of(self, case: Case) -> Array:
        """Values (n) of the free settings in a case, in the units of the case file."""
        return np.array([one.value_in(case) for one in self.free])


def _settings(surface: GeneratingSurface, teeth: int, member: str, side: str) -> Any:
    try:
        return flank_settings(surface, teeth)
    except ValueError as error:  # a setting beyond what a case may hold
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        raise InputError(f"{member}.{side}: settings that no case may hold: {'; '.join(lines[1:3])}") from error


def with_limits(
    free: Sequence[FreeSetting], units: Array, reach: float, limits: Mapping[str, tuple[float, float]]
) -> tuple[FreeSetting, ...]:
    """Free settings (n) with their limits, least and greatest value by name or pattern.

    Else a setting alone may change the ease-off by ``reach`` [um]; ``units`` (n) change it by one micrometre at most.
    InputError if limits are of no free setting, or leave its present value out.
    """
    settings = {
        one.name: replace(one, low=one.start - reach * u, high=one.start + reach * u)
        for one, u in zip(free, units, strict=True)
    }
    for pattern, ends in limits.items():
        low, high = array(f"limit_setting {pattern}", ends, ndim=1, size=2).tolist()
        names = [one.name for one in free if any(fnmatchcase(key, pattern) for key in one.own_keys)]
        if not names:
            raise InputError(
                f"limit_setting = {shown(pattern)}: must be the key of a free setting such as {next(iter(settings))}, "
                f"or a pattern with *{suggestion(pattern, settings)}"
            )
        for name in names:
            if not low <= settings[name].start <= high or not low < high:
                raise InputError(
                    f"limit_setting {name} = {low:g}:{high:g}: must be two numbers that rise, with the present value "
                    f"{settings[name].start:g} [{settings[name].units}] between them"
                )
            settings[name] = replace(settings[name], low=low, high=high)
    return tuple(settings.values())
