"""Set-up of the machine that cuts a flank: which settings may be moved, and whether both flanks of a tooth share it."""

from __future__ import annotations

from collections.abc import Sequence

from ...core.checks import instance
from ...core.errors import InputError, suggestion
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.machine import MOVING_SETTINGS
from ..cutting.named_settings import (
    BLADE_STEPS,
    CURVATURE_STEPS,
    MACHINE_STEPS,
    MODIFIED_ROLL_ORDERS,
    MOTION_PATTERN,
    get_setting,
)
from ..pair.gear_pair import Member

# Formate: no roll. The flank has four degrees of freedom; the fifth setting holds the root.
FREE_FORMATE_SETTINGS = (
    "radial_distance",
    "cradle_angle",
    "machine_root_angle",
    "sliding_base",
    "machine_center_to_crossing_point",
)
# Generated: the basic cradle angle turns the tooth. Tilt, swivel and modified roll only where the design has them.
FREE_MACHINE_SETTINGS = (
    "radial_distance",
    "machine_root_angle",
    "work_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
    "cutter_tilt",
    "cutter_swivel",
    "ratio_of_roll",
    "modified_roll_2c",
    "modified_roll_6d",
)
BLADE_SETTINGS = (*BLADE_STEPS, *CURVATURE_STEPS)
TILTS = ("cutter_tilt", "cutter_swivel")


def shares_set_up(member: Member) -> bool:
    """True if both flanks of a member are cut in one set-up: by one cutter at the same machine settings.

    So are spread-blade and completing members. Unlike ``Member.one_set_up`` it counts face hobbing in.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fh-12x41-45"))
    >>> shares_set_up(pair.gear), shares_set_up(pair.pinion)
    (True, False)
    """
    instance("member", member, Member)
    return member.opposite is not None and member.opposite.settings == member.loaded.settings


def usual_settings(surface: GeneratingSurface) -> tuple[str, ...]:
    """Settings that corrections move unless others are named: those of the machine, no blades.

    Coefficients of the modified roll that are zero in the design stay zero.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> usual_settings(gear_pair(read_case("fm-11x41")).gear.loaded)[:3]
    ('radial_distance', 'cradle_angle', 'machine_root_angle')
    """
    instance("surface", surface, GeneratingSurface)
    if not surface.settings.generated:
        return FREE_FORMATE_SETTINGS
    unused = [name for name in MODIFIED_ROLL_ORDERS if get_setting(surface, name) == 0.0]
    return tuple(name for name in FREE_MACHINE_SETTINGS if name in movable_settings(surface) and name not in unused)


def movable_settings(surface: GeneratingSurface) -> tuple[str, ...]:
    """Settings of a surface that can be moved, but for its higher-order motions; a Formate flank has no roll."""
    hobbed, rolled = surface.settings.indexing_ratio != 0.0, surface.settings.generated
    names = [name for name in BLADE_SETTINGS if hobbed or name not in ("rake_angle", "hook_angle")]
    tilted = surface.settings.cutter_tilt != 0.0
    for name in MACHINE_STEPS:
        if (rolled or name != "ratio_of_roll") and (tilted or name not in TILTS):
            names.append(name)
    return (*names, *MODIFIED_ROLL_ORDERS) if rolled else tuple(names)


def require_movable(surface: GeneratingSurface, names: Sequence[str]) -> None:
    """Refuse names of settings that this machine does not have, that come twice, or none at all."""
    allowed, rolled = movable_settings(surface), surface.settings.generated
    motions = f", or a motion: {', '.join(MOVING_SETTINGS)} with _motion_1 to _motion_6" if rolled else ""
    if not names:
        raise InputError(f"free settings: must name one at least of {', '.join(allowed)}{motions}")
    for name in names:
        if list(names).count(name) > 1:
            raise InputError(f"free setting = {name!r}: must be named once")
        if name in allowed or (rolled and MOTION_PATTERN.fullmatch(name)):
            continue
        raise InputError(
            f"free setting = {name!r}: must be one of {', '.join(allowed)}{motions}"
            + (_reason(name) or suggestion(name, allowed))
        )


def _reason(name: str) -> str:
    """Why a setting that exists elsewhere cannot be moved here."""
    if name == "ratio_of_roll" or name in MODIFIED_ROLL_ORDERS or MOTION_PATTERN.fullmatch(name):
        return "; this member is Formate and has no roll"
    if name in TILTS:
        return "; the cutter of this machine is not tilted"
    if name in BLADE_SETTINGS:
        return "; a face-milling blade sweeps a surface of revolution"
    return ""
