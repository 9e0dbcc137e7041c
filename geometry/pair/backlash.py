"""Backlash of a pair: how far the gear can turn between contact on the drive side and contact on the coast side.

Both sides have their ease-off in the position in which the machines cut the flanks. Its least value is where the flanks
first touch; the thickness of the teeth turns the flanks of the other side.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .ease_off import exact_ease_off
from .gear_pair import GearPair, Member, grid, thickness_per_angle, tooth_angles
from .tooth_body import middle_angle

NODES = (31, 21)


def circular_backlash(pair: GearPair) -> float:
    """Normal circular backlash in the middle of the gear's flank [mm]; negative if the teeth overlap.

    Teeth as thick as ``gear_pair.tooth_angles`` says; both members need both flanks.
    """
    pinion_angle, gear_angle = tooth_angles(pair)
    pitch = 2.0 * np.pi / pair.pinion.teeth
    # More than half a pitch too thin is as much too thick, a tooth further on.
    thinner = np.mod(_filling_angle(pair, gear_angle) - pinion_angle + pitch / 2.0, pitch) - pitch / 2.0
    return float(thinner) / pair.assembly.ratio * thickness_per_angle(pair.gear)


def filling_thickness(pair: GearPair) -> float:
    """Normal circular thickness of the pinion's tooth in the middle of its flank [mm] that leaves no backlash."""
    return _filling_angle(pair, tooth_angles(pair)[1]) * thickness_per_angle(pair.pinion)


def _filling_angle(pair: GearPair, gear_angle: float) -> float:
    """Angular thickness of the pinion's tooth [rad] that leaves no backlash."""
    other = replace(pair, pinion=pair.pinion.from_opposite, gear=pair.gear.from_opposite)
    touching, senses = [], []
    for side in (pair, other):
        t, h = grid(NODES)
        surface = exact_ease_off(side.gear.flank(t, h), side.pinion.loaded, side.pinion.section, side.assembly)
        touching.append(float(surface.angle[surface.inside].min()))
        senses.append(surface.motion.pinion_sense)
    turn, as_cut = _as_cut(pair.gear)
    gear_rotation = turn * (gear_angle - as_cut)
    # Each side touches where the gear is turned by its least ease-off against its own sense of drive.
    rotation = -pair.assembly.ratio * (gear_rotation + senses[0] * sum(touching))
    turn, as_cut = _as_cut(pair.pinion)
    return float(np.mod(as_cut + turn * rotation, 2.0 * np.pi / pair.pinion.teeth))


def _as_cut(member: Member) -> tuple[float, float]:
    """Sense of rotation into the tooth, and the angle between the middles of its flanks, see ``middle_angle``."""
    return middle_angle(member.section, member.loaded, member.from_opposite.loaded)
