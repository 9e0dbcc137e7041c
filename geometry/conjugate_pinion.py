"""The exactly conjugate pinion of a Formate gear, as settings of a cradle machine.

Cut the pinion on a machine whose cradle axis is the gear axis, whose ratio of roll is the ratio of the pair and whose
cutter is the gear's own blade, taken from the other side and, face-hobbed, turning in the same time. The cradle then
plays the gear, and the pinion is its envelope: the ease-off is zero everywhere. Machine root angle near zero and a
large cutter tilt are the marks of this set-up.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..core.errors import GeometryError
from .assembly import Assembly
from .blade import Blade, BladeSide
from .generating_surface import GeneratingSurface, Hand
from .machine import MachineSettings
from .machine_pose import machine_pose


def conjugate_pinion(gear: GeneratingSurface, assembly: Assembly, blade_height: float) -> GeneratingSurface:
    """Machine settings that cut the pinion flank conjugate to a Formate gear flank.

    Parameters
    ----------
    gear
        Generating surface of the gear flank.
    assembly
        The pair; its misalignment is not used, the pinion is conjugate in the nominal position.
    blade_height
        Distance between the blade tips of the two cutters along the cutter axis [mm]: where the pinion's root is to be.

    Returns
    -------
    GeneratingSurface
        The pinion flank.

    Raises
    ------
    GeometryError
        If the gear is generated (no fixed cone stands for its flank), or the cone ends before ``blade_height``.
    """
    settings = gear.settings
    if settings.generated:
        raise GeometryError(
            "a conjugate pinion in machine settings exists for a Formate gear only: this gear is generated"
        )
    # The gear's cutter in the frame of a right-hand gear: centre of the tip plane, axis towards the gear.
    still = np.zeros(1)
    pose = machine_pose(settings, still, gear.sense)
    tip_center = pose.to_member(pose.center, still, point=True)[:, 0]
    axis = pose.to_member(pose.frame[2], still, point=False)[:, 0]

    # The pinion's cutter reaches from the gear's body to the pinion; its machine frame is the gear's with z reversed.
    tip_center = tip_center - blade_height * axis
    towards_pinion = np.array([-axis[0], -axis[1], axis[2]])
    cradle_angle = float(np.arctan2(tip_center[1], tip_center[0]))
    pinion_settings = MachineSettings(
        radial_distance=float(np.hypot(tip_center[0], tip_center[1])),
        cradle_angle=cradle_angle,
        machine_root_angle=assembly.shaft_angle - np.pi / 2,
        work_offset=assembly.hypoid_offset,
        sliding_base=float(tip_center[2]),
        cutter_tilt=float(np.arccos(np.clip(towards_pinion[2], -1.0, 1.0))),
        cutter_swivel=cradle_angle - float(np.arctan2(towards_pinion[0], -towards_pinion[1])),
        ratio_of_roll=assembly.ratio,
        indexing_ratio=settings.indexing_ratio * assembly.ratio,
    )
    hand: Hand = "left" if gear.hand == "right" else "right"
    return replace(gear, blade=_other_side(gear.blade, blade_height), settings=pinion_settings, hand=hand, sense=-1)


def _other_side(blade: Blade, height: float) -> Blade:
    """The same edge as a blade that points the other way, its tip ``height`` further up along the cutter axis."""
    (tip_r, tip_t), (edge_r, edge_t, edge_z) = blade.tip, blade.edge
    along = -height / edge_z
    tip = complex(tip_r + along * edge_r, tip_t + along * edge_t)
    if blade.offset_angle == 0.0 and tip.real <= 0.0:
        raise GeometryError(f"the gear's cutter cone ends before the pinion's root, {height} mm from its blade tip")
    # The edge from the new tip to the new shank, its radial and tangential part counted from the new tip's radius.
    lateral = complex(-edge_r, -edge_t) * abs(tip) / tip
    side: BladeSide = "outside" if blade.side == "inside" else "inside"
    return Blade(
        point_radius=abs(tip),
        pressure_angle=-blade.side_sign * math.asin(lateral.real),
        side=side,
        offset_angle=math.atan2(tip.imag, tip.real),
        hook_angle=math.atan2(lateral.imag, -edge_z),
    )
