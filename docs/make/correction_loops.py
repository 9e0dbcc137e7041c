"""Closed loops of corrections that tests and the guide run: shipped cases, cut by machines with errors."""

from __future__ import annotations

from easeoff.cases import Case, read_case
from easeoff.geometry.tooth.tooth_flanks import MemberName, Side
from easeoff.verification.correction_loop import SIDES

# Errors of machines [mm, rad], some of settings that the correction does not move.
FORMATE = {"radial_distance": 0.12, "machine_root_angle": 1.2e-3, "sliding_base": -0.15, "work_offset": 0.05}
GENERATED = {"radial_distance": 0.09, "machine_root_angle": 1.5e-3, "work_offset": -0.07, "ratio_of_roll": 2e-3}
TILTED = {**GENERATED, "cutter_tilt": 1.2e-3, "machine_center_to_crossing_point": -0.1}
OTHER = {"radial_distance": -0.05, "machine_root_angle": -1e-3, "cutter_swivel": 4e-3, "ratio_of_roll": -1.5e-3}
#: Case, member, and the errors of the machine that cuts each of its flanks.
CORRECTION_LOOPS: dict[str, tuple[str, MemberName, dict[Side, dict[str, float]]]] = {
    "milled, spread blade, Formate": ("fm-11x41", "gear", dict.fromkeys(SIDES, FORMATE)),
    "milled, spread blade, generated": ("nasa-12x36", "gear", dict.fromkeys(SIDES, GENERATED)),
    "milled, fixed setting": ("fm-11x41", "pinion", {"concave": TILTED, "convex": OTHER}),
    "hobbed, completing, Formate": ("fh-12x41-45", "gear", dict.fromkeys(SIDES, FORMATE)),
    "hobbed, completing, generated": ("fh-12x41-45 completing", "pinion", dict.fromkeys(SIDES, TILTED)),
}


def loop_case(name: str) -> Case:
    """A shipped case, or with 'completing' behind its name one whose pinion is cut in one set-up."""
    return completing(name.split()[0]) if name.endswith("completing") else read_case(name)


def completing(case: str) -> Case:
    """A shipped case whose pinion is cut in one set-up: its convex flank at the settings of the concave one."""
    original = read_case(case)
    pinion = original.pinion
    assert pinion.convex is not None
    assert pinion.concave is not None
    # One cutter: outer and inner blades stand beside one another; a flank of its own for each.
    convex = pinion.convex.model_copy(update={"machine": pinion.concave.machine})
    return original.model_copy(update={"pinion": pinion.model_copy(update={"convex": convex})})
