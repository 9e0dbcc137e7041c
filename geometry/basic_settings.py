"""Basic machine settings of a face-milled Formate gear from its blank."""

from __future__ import annotations

import math

from ..core.errors import GeometryError
from .blade import Blade
from .blank import BlankDimensions
from .generating_surface import GeneratingSurface, Hand
from .iso23509_dimensions import MemberBlank
from .machine import MachineSettings
from .section import BlankSection


def blank_section(member: MemberBlank, clearance: float) -> BlankSection:
    """Axial section of one member of a blank; the flank ends at the clearance above the root cone."""
    return BlankSection(
        pitch_angle=member.pitch_angle,
        face_angle=member.face_angle,
        root_angle=member.root_angle,
        outer_cone_distance=member.outer_cone_distance,
        face_width=member.face_width,
        pitch_apex=member.pitch_apex,
        face_apex=member.face_apex,
        root_apex=member.root_apex,
        clearance=clearance,
    )


def formate_gear(
    blank: BlankDimensions, cutter_radius: float, hand: Hand
) -> tuple[GeneratingSurface, GeneratingSurface]:
    """Convex and concave flank of a Formate gear cut by one spread-blade cutter.

    The machine centre is the apex of the root cone and the cutter axis stands at right angles to the root line. The
    cutter centre gives the mean spiral angle at the mean point, the blade angles are the generated pressure angles of
    the blank, and the point width leaves the blank's tooth thickness.

    Parameters
    ----------
    blank
        Dimensions of the pair.
    cutter_radius
        Mean cutter radius [mm].
    hand
        Hand of spiral of the gear.

    Returns
    -------
    tuple
        Generating surfaces of the convex (drive) and the concave (coast) flank.

    Raises
    ------
    GeometryError
        If the slot is too narrow for a cutter.
    """
    gear = blank.gear
    # The mean point on the pitch cone, seen along the root line from the root apex.
    axial = gear.mean_cone_distance * math.cos(gear.pitch_angle) - gear.pitch_apex
    radial = gear.mean_cone_distance * math.sin(gear.pitch_angle)
    along = (axial + gear.root_apex) * math.cos(gear.root_angle) + radial * math.sin(gear.root_angle)
    horizontal = along - cutter_radius * math.sin(gear.mean_spiral_angle)
    vertical = cutter_radius * math.cos(gear.mean_spiral_angle)
    drive, coast = float(blank.generated_drive_pressure_angle), float(blank.generated_coast_pressure_angle)
    slot = math.pi * blank.mean_normal_module - gear.mean_normal_thickness
    point_width = slot - gear.mean_dedendum * (math.tan(drive) + math.tan(coast))
    if point_width <= 0.0:
        raise GeometryError(f"the gear's slot leaves a point width of {point_width:.3f} mm: no cutter fits")
    settings = MachineSettings(
        radial_distance=math.hypot(horizontal, vertical),
        cradle_angle=math.atan2(vertical, horizontal),
        machine_root_angle=gear.root_angle,
        machine_center_to_crossing_point=gear.root_apex,
    )
    inside = Blade(cutter_radius - point_width / 2.0, drive, "inside")
    outside = Blade(cutter_radius + point_width / 2.0, coast, "outside")
    return GeneratingSurface(inside, settings, hand, 1), GeneratingSurface(outside, settings, hand, 1)
