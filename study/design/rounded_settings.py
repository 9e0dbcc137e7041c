"""Settings rounded to what a machine and a tool room can set, and what that changes of the ease-off."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...cases.conversion import gear_pair
from ...cases.schema.case_schema import Case
from ...cases.schema.cutting_table import FlankSettings, blade_field
from ...core.arrays import RealArray as Array
from ...core.checks import array, instance
from ...core.errors import GeometryError
from ...geometry.cutting import named_settings
from ...geometry.cutting.named_settings import USUAL_RESOLUTION, MachineResolution, step_of
from ...geometry.pair.ease_off import exact_ease_off
from ...geometry.pair.gear_pair import FlankName, grid

EFFECT_NODES = (15, 11)
FLANKS = ("concave", "convex")


def rounded_case(
    case: Case,
    resolution: MachineResolution | None = None,
    pinion_limits: Mapping[str, tuple[float, float]] | None = None,
    gear_limits: Mapping[str, tuple[float, float]] | None = None,
) -> Case:
    """The case with the settings of every flank rounded.

    Parameters
    ----------
    case
        A checked case.
    resolution
        Steps; the usual ones if left out.
    pinion_limits, gear_limits
        Least and greatest value of settings of a member [mm or rad], by the names in ``named_settings``, and of
        ``edge_radius``: they are rounded inwards, and one without a step between its limits stays as it is.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> rounded_case(read_case("fm-11x41")).pinion.concave.machine.cutter_tilt
    14.012
    """
    instance("case", case, Case)
    steps = USUAL_RESOLUTION if resolution is None else resolution
    instance("resolution", steps, MachineResolution)
    members: dict[str, Any] = {}
    for name, given in (("pinion", pinion_limits), ("gear", gear_limits)):
        member = getattr(case, name)
        instance(f"{name}_limits", given, Mapping | None)
        entries = (given or {}).items()
        limits = {key: array(f"{name}_limits {key}", ends, size=2, infinite=True).tolist() for key, ends in entries}
        members[name] = {side: _flank(getattr(member, side), steps, limits) for side in member.sides}
    return case.with_tables(**members)


def rounding_effect(case: Case, rounded: Case) -> dict[FlankName, float]:
    """Greatest change of the ease-off on the common flank, up to a rotation of the gear [mm], of each side.

    Parameters
    ----------
    case
        The case as it was.
    rounded
        The same with other settings of its flanks.

    Raises
    ------
    GeometryError
        If the rounded flanks do not meet.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case = read_case("fm-11x41")
    >>> effect = rounding_effect(case, rounded_case(case))
    >>> max(effect.values()) < 0.005
    True
    """
    instance("case", case, Case)
    instance("rounded", rounded, Case)
    return {flank: _change(case, rounded, flank) for flank in case.flanks}


def _change(case: Case, rounded: Case, side: FlankName) -> float:
    t, h = grid(EFFECT_NODES)
    ease_offs = []
    for each in (case, rounded):
        pair = gear_pair(each, side)
        flank = pair.gear.flank(t, h)
        ease_offs.append(exact_ease_off(flank, pair.pinion.loaded, pair.pinion.section, pair.assembly))
    before, after = ease_offs
    known = before.inside & after.inside
    if not np.any(known):
        raise GeometryError(f"{side}: with rounded settings pinion and gear do not meet: take a finer resolution")
    lever = before.lever_arm[known]
    return float(np.abs(without_rotation((after.angle - before.angle)[known] * lever, lever)).max())


def without_rotation(change: Array, lever_arm: Array) -> Array:
    """Change of an ease-off (n) less that by the rotation of the gear which leaves the least."""
    return np.asarray(change - lever_arm * float(lever_arm @ change) / float(lever_arm @ lever_arm))


def _flank(
    settings: FlankSettings, steps: MachineResolution, limits: Mapping[str, tuple[float, float]]
) -> FlankSettings:
    def rounded(value: Any, name: str) -> Any:
        """The nearest multiple of the step within the limits."""
        step = step_of(name, steps)
        if value is None or step is None:
            return value
        factor = named_settings.setting_step(name, steps).factor if name in limits and name != "edge_radius" else 1.0
        ends = (factor * end for end in limits.get(name, (-math.inf, math.inf)))
        return named_settings.nearest_multiple(value, step, *ends)

    machine = {key: rounded(value, key) for key, value in settings.machine}
    motions = {
        key: tuple(rounded(value, f"{key}_motion_{order}") for order, value in enumerate(values, start=1))
        for key, values in settings.machine.motions
    }
    machine["motions"] = settings.machine.motions.model_copy(update=motions)
    cutter = {key: rounded(value, blade_field(key)) for key, value in settings.cutter}
    return settings.with_tables(machine=machine, cutter=cutter)


def step_of_key(resolution: MachineResolution, table: str, key: str) -> float | None:
    """Step of a key of the tables ``machine``, ``motions`` or ``cutter``; ``None`` where it is not rounded."""
    return step_of(f"{key}_motion_1" if table == "motions" else blade_field(key), resolution)
