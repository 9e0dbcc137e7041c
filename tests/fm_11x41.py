"""The case fm-11x41, rebuilt from the dissertation's Table 2.1; run it to print the case file.

Table 2.1 gives teeth, hands, spiral angles, offset and outer cone distances, but neither blank nor machine settings.
The blank is taken from ISO 23509 Method 1 with a 95.25 mm cutter, the gear is Formate with a spread-blade cutter, and
the pinion is fitted, in the misaligned position the dissertation analyses, to a target ease-off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from easeoff.geometry import (
    Assembly,
    BlankDesign,
    BlankDimensions,
    EaseOffTarget,
    GearPair,
    GeneratingSurface,
    Member,
    Misalignment,
    blank_dimensions,
    blank_section,
    conjugate_pinion,
    fit_pinion,
    formate_gear,
)

CUTTER_RADIUS = 95.25  # [mm]
MISALIGNMENT = Misalignment(offset=-0.15, pinion_axial=0.12)
# Ease-off targets at the edges of the gear flank [mm]: lengthwise, profile, bias, spiral angle, pressure angle.
DRIVE = EaseOffTarget(0.0102, 0.0228, 0.0138, 0.0026, -0.0066)
COAST = EaseOffTarget(0.0200, 0.0150, 0.0, 0.0, -0.0050)


def blank() -> BlankDimensions:
    """ISO 23509 Method 1 blank of the pair; the outer pitch diameter makes the gear's outer cone distance 111 mm."""
    return blank_dimensions(
        BlankDesign(
            method=1,
            process="face_milled",
            number_of_teeth=(11, 41),
            hypoid_offset=20.0,
            mean_spiral_angle=math.radians(40.5),
            gear_outer_pitch_diameter=211.8355,
            gear_face_width=33.3,
            cutter_radius=CUTTER_RADIUS,
            nominal_drive_pressure_angle=math.radians(20.0),
            nominal_coast_pressure_angle=math.radians(20.0),
            limit_pressure_angle_influence=1.0,
            gear_mean_addendum_factor=0.2,
            depth_factor=2.0,
            clearance_factor=0.125,
            thickness_factor=0.1,
            depth_taper="modified_slot_width",
        )
    )


@dataclass(frozen=True)
class Rebuilt:
    """The pair's blank and its four flanks."""

    blank: BlankDimensions
    pair: GearPair
    pinion_concave: GeneratingSurface
    pinion_convex: GeneratingSurface


def rebuild() -> Rebuilt:
    """Blank, Formate gear and both pinion flanks."""
    dimensions = blank()
    convex, concave = formate_gear(dimensions, CUTTER_RADIUS, "right", corrected=False)
    assembly = Assembly(11, 41, "left", math.pi / 2, 20.0, MISALIGNMENT)
    height = dimensions.gear.mean_dedendum + dimensions.pinion.mean_dedendum
    sections = [blank_section(m, dimensions.clearance) for m in (dimensions.pinion, dimensions.gear)]
    flanks = []
    for loaded, opposite, target in ((convex, concave, DRIVE), (concave, convex, COAST)):
        start = Member(11, sections[0], conjugate_pinion(loaded, assembly, height))
        pair = GearPair(start, Member(41, sections[1], loaded, opposite), assembly)
        flanks.append(fit_pinion(pair, target).surface)
    pinion = Member(11, sections[0], flanks[0], flanks[1])
    return Rebuilt(dimensions, GearPair(pinion, Member(41, sections[1], convex, concave), assembly), *flanks)


def machine_table(surface: GeneratingSurface) -> dict[str, float]:
    """Machine settings as a case file has them."""
    s = surface.settings
    table = {
        "radial_distance": s.radial_distance,
        "cradle_angle": math.degrees(s.cradle_angle),
        "machine_root_angle": math.degrees(s.machine_root_angle),
        "work_offset": s.work_offset,
        "sliding_base": s.sliding_base,
        "machine_center_to_crossing_point": s.machine_center_to_crossing_point,
        "cutter_tilt": math.degrees(s.cutter_tilt),
        "cutter_swivel": math.degrees(s.cutter_swivel),
    }
    if s.ratio_of_roll is not None:
        table["ratio_of_roll"] = s.ratio_of_roll
    for name, order, coefficient in zip(("2c", "6d"), (2, 3), s.modified_roll, strict=False):
        table[f"modified_roll_{name}"] = coefficient * math.factorial(order)
    return table


def cutter_table(surface: GeneratingSurface) -> dict[str, float]:
    """Cutter as a case file has it."""
    return {
        "blade_point_radius": surface.blade.point_radius,
        "blade_pressure_angle": math.degrees(surface.blade.pressure_angle),
    }


def tables(rebuilt: Rebuilt) -> dict[str, dict[str, float]]:
    """Every table of numbers of the case file that is computed."""
    result = {}
    gear = rebuilt.pair.gear
    assert gear.opposite is not None
    for name, member, clearance in (
        ("pinion", rebuilt.blank.pinion, rebuilt.blank.clearance),
        ("gear", rebuilt.blank.gear, rebuilt.blank.clearance),
    ):
        result[f"{name}.blank"] = {
            "pitch_angle": math.degrees(member.pitch_angle),
            "face_angle": math.degrees(member.face_angle),
            "root_angle": math.degrees(member.root_angle),
            "pitch_apex_beyond_crossing_point": member.pitch_apex,
            "face_apex_beyond_crossing_point": member.face_apex,
            "root_apex_beyond_crossing_point": member.root_apex,
            "outer_cone_distance": member.outer_cone_distance,
            "face_width": member.face_width,
            "clearance": clearance,
        }
    for name, surface in (
        ("pinion.concave", rebuilt.pinion_concave),
        ("pinion.convex", rebuilt.pinion_convex),
        ("gear.convex", gear.loaded),
        ("gear.concave", gear.opposite),
    ):
        result[f"{name}.machine"] = machine_table(surface)
        result[f"{name}.cutter"] = cutter_table(surface)
    return result


HEAD = """\
# Face-milled hypoid pair 11 x 41, offset 20 mm: Formate gear, generated pinion.
#
# Rebuilt from Table 2.1 of M. Kolivand's dissertation (The Ohio State University, 2009), which prints teeth, hands,
# spiral angles, offset and outer cone distances, but no blank and no machine settings. Blank: ISO 23509 Method 1,
# cutter radius 95.25 mm. Pinion: the conjugate of the gear, its settings then fitted to the ease-off of [target] in
# the position of [misalignment]. tests/fm_11x41.py makes this file; the tests make the settings again and compare.
easeoff_case = 1
title = "FM 11x41 hypoid pair, offset 20 mm, Formate gear (rebuilt from Kolivand 2009, Table 2.1)"
description = \"\"\"The dissertation's face-milled example with one fixed design of our own. The misalignment is
that of its figures 2.9, 2.10, 3.6 and 3.7; the signs, which it does not state, are those that move the contact as it
says.\"\"\"
"""


def case_file() -> str:
    """The text of the case file."""
    parts = [HEAD, "[pair]\nshaft_angle = 90.0\nhypoid_offset = 20.0\n"]
    parts.append(f"[misalignment]\noffset = {MISALIGNMENT.offset}\npinion_axial = {MISALIGNMENT.pinion_axial}\n")
    parts.append("[contact]\ntorques = [50.0, 250.0, 500.0]\n")
    for side, target in (("drive", DRIVE), ("coast", COAST)):
        lines = [f"{name} = {1e3 * value:.1f}" for name, value in vars(target).items()]
        parts.append(f"[target.{side}]\n" + "\n".join(lines) + "\n")
    computed = tables(rebuild())
    heads = {
        "pinion": '[pinion]\nnumber_of_teeth = 11\nhand_of_spiral = "left"\n',
        "gear": "[gear]\nnumber_of_teeth = 41\n",
    }
    for member, head in heads.items():
        parts.append(head)
        for name, table in computed.items():
            if name.startswith(member):
                parts.append(f"[{name}]\n" + "\n".join(f"{k} = {v:.10f}" for k, v in table.items()) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    print(case_file(), end="")  # noqa: T201
