"""Settings by which an analysis can be differentiated, under the names that sweeps have for them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ...core.checks import instance, one_of, shown, words
from ...core.errors import InputError, suggestion
from ...geometry.cutting.named_settings import MACHINE_STEPS, MODIFIED_ROLL_ORDERS
from ...geometry.pair.gear_pair import FlankName, GearPair
from ...geometry.pair.modification import TERM_POWERS
from ...geometry.pair.near_pair import PairSetting, is_angle

#: Keys of the cutter in a case file, and the settings of the blade that they are.
CUTTER_KEYS = {
    "blade_point_radius": "point_radius",
    "blade_pressure_angle": "pressure_angle",
    "blade_rake_angle": "rake_angle",
    "blade_hook_angle": "hook_angle",
    "blade_spheric_radius": "blade_curvature",
}
ERRORS = {"E": "offset", "P": "pinion_axial", "G": "gear_axial", "Sigma": "shaft_angle"}
SIDES = {"drive": {"pinion": "concave", "gear": "convex"}, "coast": {"pinion": "convex", "gear": "concave"}}


@dataclass(frozen=True)
class NamedSetting:
    """A setting under the name that sweeps have for it.

    Parameters
    ----------
    name
        The name.
    setting
        What it is.
    factor
        Takes its derivative to the unit of the name.
    """

    name: str
    setting: PairSetting
    factor: float


def derivative_settings(pair: GearPair, flank: FlankName = "drive") -> list[str]:
    """Names of all settings by which an analysis of a pair can be differentiated, as sweeps have them.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> names = derivative_settings(gear_pair(read_case("fm-11x41")))
    >>> names[0], "gear.convex.machine.ratio_of_roll" in names, names[-1]
    ('pinion.concave.machine.radial_distance', False, 'torque')
    """
    instance("pair", pair, GearPair)
    return [*(one.name for one in _settings(pair, flank)), "torque"]


def _settings(pair: GearPair, flank: FlankName) -> list[NamedSetting]:
    found = []
    for member, side in SIDES[one_of("flank", flank, SIDES)].items():
        surface = (pair.pinion if member == "pinion" else pair.gear).loaded.designed
        names = {f"machine.{name}": name for name in (*MACHINE_STEPS, *MODIFIED_ROLL_ORDERS)}
        names |= {f"cutter.{key}": name for key, name in CUTTER_KEYS.items()}
        for key, name in names.items():
            setting = PairSetting("pinion" if member == "pinion" else "gear", name)
            factor = math.radians(1.0) if is_angle(setting) else 1.0
            if name == "blade_curvature":
                radius = surface.blade.spheric_radius
                if radius is None:
                    continue  # a straight blade has no radius in the case
                factor = -1.0 / radius**2
            if setting.acts_on(pair):
                found.append(NamedSetting(f"{member}.{side}.{key}", setting, factor))
    for name, error in ERRORS.items():
        found.append(NamedSetting(name, PairSetting("assembly", error), math.radians(1.0) if name == "Sigma" else 1.0))
    return found


def chosen_settings(
    pair: GearPair, flank: FlankName, names: Sequence[str] | None
) -> tuple[list[NamedSetting], list[str]]:
    """The settings to differentiate by, and the names asked for, in their order.

    Parameters
    ----------
    pair, flank
        The pair in mesh.
    names
        Names of ``derivative_settings`` or ``modification.TERM``; all of the former if left out.

    Raises
    ------
    InputError
        If there is no such setting, or one comes twice.
    """
    known = {one.name: one for one in _settings(pair, flank)}
    known |= {
        f"modification.{term}": NamedSetting(f"modification.{term}", PairSetting("modification", term), 1.0)
        for term in TERM_POWERS
    }
    wanted = list(derivative_settings(pair, flank)) if names is None else list(words("settings", names))
    for name in wanted:
        if name not in known and name != "torque":
            raise InputError(
                f"setting = {shown(name)}: must be a machine or cutter setting of the {flank} flanks such as "
                f"{next(iter(known))}, E, P, G, Sigma, modification.TERM or torque"
                f"{suggestion(name, [*known, 'torque'])}"
            )
    if not wanted or len(set(wanted)) != len(wanted):
        raise InputError(f"settings = {shown(wanted)}: must be one or more names, none of them twice")
    # The torque comes with any other setting; alone it takes one along.
    return [known[name] for name in wanted if name != "torque"] or [next(iter(known.values()))], wanted
