"""The exactly conjugate pinion of a Formate gear, as settings of a cradle machine.

Cut the pinion on a machine whose cradle axis is the gear axis, whose ratio of roll is the ratio of the pair and whose
cutter is the gear's own blade, taken from the other side and, face-hobbed, turning in the same time. The cradle then
plays the gear, and the pinion is its envelope: the ease-off is zero everywhere. Machine root angle near zero and a
large cutter tilt are the marks of this set-up.

The pinion that the generating gear of a generated gear cuts from the other side, as settings of a cradle machine.

The cradle of the gear's machine plays a crown gear that rolls on the gear. Let the same crown gear roll on the pinion,
at the tooth ratio, and let its flank be cut from the other side. Where the axes intersect and the crown gear rolls on
the pitch cone, all three bodies turn about one instantaneous axis, and gear and pinion are exactly conjugate (Litvin &
Fuentes 2004, Gear Geometry and Applied Theory, chapter 21). With an offset they are so near the pitch point only.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...core.arrays import RealArray as Array
from ...core.checks import instance, number
from ...core.errors import GeometryError
from ..cutting.blade import Blade, BladeSide
from ..cutting.generating_surface import GeneratingSurface, Hand
from ..cutting.machine import MachineSettings, machine_pose
from ..pair.assembly import Assembly
from ..vectors import rotate_z
from .blank import BlankDimensions


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

    Examples
    --------
    The ease-off of the conjugate pinion is zero:

    >>> from dataclasses import replace
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import Misalignment, ease_off
    >>> pair = gear_pair(read_case("fm-11x41")).misaligned(Misalignment())
    >>> surface = conjugate_pinion(pair.gear.loaded, pair.assembly, blade_height=10.0)
    >>> found = ease_off(replace(pair, pinion=replace(pair.pinion, loaded=surface)), (5, 5))
    >>> bool(abs(found["ease_off"]).max() < 1e-6)  # [um]
    True
    """
    instance("gear", gear, GeneratingSurface)
    instance("assembly", assembly, Assembly)
    number("blade_height", blade_height, "mm")
    settings = gear.settings
    if settings.generated:
        raise GeometryError(
            "the conjugate pinion of a Formate gear is asked for, but this gear is generated: take crown_gear_pinion"
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
    return replace(gear, blade=other_side(gear.blade, blade_height), settings=pinion_settings, hand=hand, sense=-1)


def other_side(blade: Blade, height: float) -> Blade:
    """Same edge as a blade that points the other way, its tip ``height`` [mm] further up the cutter axis.

    Both are written along radius, tangent and their own axis; the new axis is the old one reversed. The plane of the
    edge stays: its normal fixes rake and hook.
    """
    (tip_r, tip_t), edge, (outward, upward) = blade.tip, np.array(blade.edge), blade.plane
    reversed_axis = np.array([1.0, 1.0, -1.0])
    along = -height / edge[2]
    tip = complex(tip_r + along * edge[0], tip_t + along * edge[1])
    if blade.offset_angle == 0.0 and tip.real <= 0.0:
        raise GeometryError(f"the gear's cutter cone ends before the pinion's root, {height} mm from its blade tip")
    offset_angle = math.atan2(tip.imag, tip.real)

    def from_tip(vector: Array) -> Array:
        """Components with the radius through the new tip."""
        lateral = complex(vector[0], vector[1]) * abs(tip) / tip
        return np.array([lateral.real, lateral.imag, vector[2]])

    across = from_tip(blade.side_sign * np.cross(outward, upward) * reversed_axis)
    rake_angle, hook_angle = -math.asin(across[0]), math.atan2(across[2], across[1])
    side: BladeSide = "outside" if blade.side == "inside" else "inside"
    turned = Blade(abs(tip), 0.0, side, offset_angle, rake_angle, hook_angle)
    new_edge, new_outward = -edge * reversed_axis, np.array(turned.plane[0])
    pressure_angle = math.asin(float(new_edge @ new_outward))
    touching = (along - blade.reference_height / math.cos(blade.pressure_angle)) * math.cos(pressure_angle)
    return replace(
        turned,
        pressure_angle=pressure_angle,
        spheric_radius=None if blade.spheric_radius is None else -blade.spheric_radius,
        reference_height=touching if blade.spheric_radius is not None else 0.0,
        edge_radius=blade.edge_radius,
    )


TILT_ROUNDING = 1e-9  # [rad]; a smaller tilt is none


def crown_gear_pinion(
    gear: GeneratingSurface, assembly: Assembly, blade_height: float, pitch_point_azimuth: float = 0.0
) -> GeneratingSurface:
    """Pinion flank cut by the crown gear that generates a gear flank: a spiral bevel pair of both has no ease-off.

    The crown gear has to roll on the pitch cone for that. The misalignment is not used; ``blade_height`` [mm], between
    the tips of both cutters along their axis, is where the pinion's root is to be.
    """
    settings = gear.settings
    if settings.ratio_of_roll is None:
        raise GeometryError("the gear is Formate: no crown gear generates it, take conjugate_pinion")
    still = np.zeros(1)
    pose = machine_pose(settings, still, gear.sense)
    turn = np.full(1, pitch_point_azimuth)

    def in_space(vector: object, *, point: bool = False) -> np.ndarray:
        """A vector in the cradle's frame as the nominal pair has it, seen from a right-hand gear."""
        column = np.reshape(np.asarray(vector, dtype=float), (3, 1))
        return np.asarray(rotate_z(turn, pose.to_member(column, still, point=point)))[:, 0]

    cutter_axis = in_space(pose.frame[2])
    tip_center = in_space(pose.center, point=True) - blade_height * cutter_axis
    machine_center = in_space((0.0, 0.0, 0.0), point=True)

    # The pinion's machine: its cradle axis is the same, reversed; a left-hand pinion is described by its mirror image.
    z = -in_space((0.0, 0.0, 1.0))
    work_axis = np.array([math.sin(assembly.shaft_angle), 0.0, math.cos(assembly.shaft_angle)])
    sine = float(work_axis @ z)
    cosine = math.sqrt(max(0.0, 1.0 - sine**2))
    if cosine < 1e-6:
        raise GeometryError("the axis of the crown gear is the pinion's: it cannot generate the pinion")
    x = (work_axis - sine * z) / cosine
    axes = np.stack([x, -np.cross(z, x), z])
    tip = axes @ (tip_center - machine_center)
    crossing_point = axes @ (np.array([0.0, assembly.hypoid_offset, 0.0]) - machine_center)
    towards_pinion = axes @ -cutter_axis
    cradle_angle = math.atan2(tip[1], tip[0])
    center = float(crossing_point[0]) / cosine
    tilt = math.atan2(math.hypot(towards_pinion[0], towards_pinion[1]), towards_pinion[2])
    if tilt < TILT_ROUNDING:
        tilt, swivel = 0.0, 0.0
    else:
        swivel = cradle_angle - math.atan2(towards_pinion[0], -towards_pinion[1])
    pinion_settings = MachineSettings(
        radial_distance=math.hypot(tip[0], tip[1]),
        cradle_angle=cradle_angle,
        machine_root_angle=math.asin(min(1.0, max(-1.0, sine))),
        work_offset=float(crossing_point[1]),
        sliding_base=float(crossing_point[2] - tip[2]) - center * sine,
        machine_center_to_crossing_point=center,
        cutter_tilt=tilt,
        cutter_swivel=swivel,
        ratio_of_roll=settings.ratio_of_roll * assembly.ratio,
        indexing_ratio=settings.indexing_ratio * assembly.ratio,
    )
    hand: Hand = "left" if gear.hand == "right" else "right"
    return replace(gear, blade=other_side(gear.blade, blade_height), settings=pinion_settings, hand=hand, sense=-1)


def pitch_point_azimuth(blank: BlankDimensions, hypoid_offset: float) -> float:
    """Azimuth of the pitch point about the gear axis [rad], towards the pinion's offset [mm] with its sign.

    The common normal of the pitch cones stands at the pitch angle to either axis.
    """
    if hypoid_offset == 0.0:
        return 0.0
    pinion, gear, shaft = blank.pinion.pitch_angle, blank.gear.pitch_angle, blank.shaft_angle
    cosine = (math.sin(pinion) + math.cos(shaft) * math.sin(gear)) / (math.sin(shaft) * math.cos(gear))
    return math.copysign(math.acos(min(1.0, max(-1.0, cosine))), hypoid_offset)
