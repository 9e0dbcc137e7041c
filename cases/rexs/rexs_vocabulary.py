"""Names of the keys of a case in REXS: attribute and unit of every key, table by table.

Ids and units are those of the schema of REXS 2.0.0 (FVA, ``rexs_schema_2.0.0.xml`` in the public repository
``fva-net/rexs-api-java``). What it has no attribute for is written under ids that begin with ``custom_easeoff_``, as
the specification provides ("Extensibility of the interface").
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, NamedTuple

REXS_VERSION = "2.0.0"
APPLICATION = "easeoff"
CUSTOM_PREFIX = "custom_easeoff_"


class Term(NamedTuple):
    """Attribute of REXS for a key of a case, and its unit, in which it is read where a file states none."""

    attribute: str
    unit: str

    @property
    def custom(self) -> bool:
        """True if REXS itself has no such attribute."""
        return self.attribute.startswith(CUSTOM_PREFIX)


def _terms(unit: str, *keys: str, **renamed: str) -> dict[str, Term]:
    return {key: Term(attribute, unit) for key, attribute in {**{k: k for k in keys}, **renamed}.items()}


STAGE_TERMS = _terms("deg", "shaft_angle") | _terms("mm", "hypoid_offset")
MISALIGNMENT_TERMS = _terms(
    "mm", offset="deviation_of_offset", pinion_axial="axial_displacement_pinion", gear_axial="axial_displacement_gear"
) | _terms("deg", shaft_angle="deviation_of_shaft_angle")
MEMBER_TERMS = _terms("none", "number_of_teeth") | _terms(
    "mm", mean_normal_circular_thickness="mean_normal_circular_tooth_thickness"
)
CASE_TERM = Term(f"{CUSTOM_PREFIX}case", "none")
"""Version of the case that a file was made of: the first wrote the thickness in the middle of the flank, without it."""
HAND_TERM = Term("spiral_angle_pitch_direction", "none")
BLANK_TERMS = (
    _terms("deg", "pitch_angle", "face_angle", "root_angle")
    | _terms(
        "mm",
        "pitch_apex_beyond_crossing_point",
        "face_apex_beyond_crossing_point",
        "root_apex_beyond_crossing_point",
        "outer_cone_distance",
        "face_width",
        clearance="clearance_iso_23509_2025",
    )
    | _terms("deg", front_angle=f"{CUSTOM_PREFIX}front_angle", back_angle=f"{CUSTOM_PREFIX}back_angle")
)
FLANK_TERM = Term(f"{CUSTOM_PREFIX}flank", "none")
"""``concave`` or ``convex``: REXS says left and right, but not from which end of a bevel gear."""
MACHINE_TERMS = (
    _terms("mm", "radial_distance")
    | _terms("deg", "machine_root_angle", "cutter_tilt", "cutter_swivel", cradle_angle="center_roll_position")
    | _terms("mm", "work_offset", "sliding_base", "machine_center_to_crossing_point")
    | _terms("none", "ratio_of_roll")
)
MODIFIED_ROLL_TERM = Term("modified_roll_coefficients", "none")
"""C, D, ... in the order of ``ROLL_KEYS``."""
MOTION_TERMS = _terms(
    "none",
    radial_distance="radial_motion_coefficients",
    work_offset="vertical_motion_coefficients",
    sliding_base="helical_motion_coefficients",
    machine_center_to_crossing_point=f"{CUSTOM_PREFIX}axial_motion_coefficients",
    machine_root_angle="angular_motion_coefficients",
    cutter_tilt="tilt_motion_coefficients",
    cutter_swivel="swivel_motion_coefficients",
)
"""Without unit in REXS; those of angles are in rad."""
CUTTER_TERMS = (
    _terms(
        "mm",
        "blade_point_radius",
        "blade_spheric_radius",
        blade_reference_height="blade_dedendum",
        tool_edge_radius="tool_edge_radius_bevel_gear_tool",
        toprem_depth="protuberance_height_bevel_gear_tool",
        toprem_radius="protuberance_radius_bevel_gear_tool",
        flankrem_depth="tip_relief_height_bevel_gear_tool",
        flankrem_radius="tip_relief_radius_bevel_gear_tool",
    )
    | _terms(
        "deg",
        "blade_pressure_angle",
        toprem_angle="protuberance_angle_bevel_gear_tool",
        flankrem_angle="tip_relief_angle_bevel_gear_tool",
        blade_offset_angle=f"{CUSTOM_PREFIX}blade_offset_angle",
        blade_rake_angle=f"{CUSTOM_PREFIX}blade_rake_angle",
        blade_hook_angle=f"{CUSTOM_PREFIX}blade_hook_angle",
    )
    | _terms("none", number_of_blade_groups="number_of_blade_groups_bevel_gear_tool")
)
MATERIAL_TERMS = _terms("MPa", "elastic_modulus") | _terms("none", "poisson_ratio")

ATTRIBUTES_READ: Mapping[str, frozenset[str]] = {
    kind: frozenset(term.attribute for term in terms)
    for kind, terms in {
        "bevel_stage": [CASE_TERM, *STAGE_TERMS.values(), *MISALIGNMENT_TERMS.values()],
        "bevel_gear": [*MEMBER_TERMS.values(), *BLANK_TERMS.values(), HAND_TERM],
        "bevel_gear_flank": [FLANK_TERM],
        "bevel_gear_manufacturing_settings": [*MACHINE_TERMS.values(), *MOTION_TERMS.values(), MODIFIED_ROLL_TERM],
        "bevel_gear_tool": [*CUTTER_TERMS.values()],
        "material": [*MATERIAL_TERMS.values()],
    }.items()
}
"""Component types, and the attributes of each that are read."""

UNIT_FACTORS: Mapping[str, tuple[str, float]] = {
    "none": ("none", 1.0),
    "mm": ("mm", 1.0),
    "mum": ("mm", 1e-3),
    "m": ("mm", 1e3),
    "deg": ("deg", 1.0),
    "°": ("deg", 1.0),
    "rad": ("deg", math.degrees(1.0)),
    "MPa": ("MPa", 1.0),
    "N / mm^2": ("MPa", 1.0),
    "Pa": ("MPa", 1e-6),
}
"""Units a file may state: our own unit of the same quantity, and what to multiply by.

``°`` and ``N / mm^2`` are what files of REXS 1.x say.
"""

Hand = Literal["left", "right"]


def opposite(hand: Hand) -> Hand:
    """The other hand."""
    return "left" if hand == "right" else "right"


def side(hand: Hand, role: Hand) -> Literal["concave", "convex"]:
    """Side of the left or right flank of a member of a hand, seen from the heel with the tip of the tooth up."""
    return "convex" if hand == role else "concave"
