"""Usual names of the keys of a case file, for tables and pictures: what a gear engineer calls them."""

from __future__ import annotations

from collections.abc import Mapping

#: Names that settings have in workshops where the key, which follows REXS, says it otherwise.
USUAL_NAMES: Mapping[str, str] = {
    "radial_distance": "radial setting",
    "cradle_angle": "basic cradle angle",
    "horizontal_distance": "horizontal setting",
    "vertical_distance": "vertical setting",
    "machine_root_angle": "machine root angle",
    "work_offset": "blank offset",
    "sliding_base": "sliding base",
    "machine_center_to_crossing_point": "machine centre to back",
    "cutter_tilt": "tilt",
    "cutter_swivel": "swivel",
    "ratio_of_roll": "ratio of roll",
    "modified_roll_2c": "modified roll 2C",
    "modified_roll_6d": "modified roll 6D",
    "modified_roll_24e": "modified roll 24E",
    "modified_roll_120f": "modified roll 120F",
    "modified_roll_720g": "modified roll 720G",
    "blade_point_radius": "cutter point radius",
    "blade_pressure_angle": "blade angle",
    "blade_offset_angle": "blade offset angle",
    "blade_rake_angle": "blade rake angle",
    "blade_hook_angle": "blade hook angle",
    "blade_spheric_radius": "profile radius",
    "blade_reference_height": "reference height",
    "tool_edge_radius": "edge radius",
    "toprem_depth": "toprem depth",
    "toprem_angle": "toprem angle",
    "toprem_radius": "toprem radius",
    "flankrem_depth": "flankrem depth",
    "flankrem_angle": "flankrem angle",
    "flankrem_radius": "flankrem radius",
    "number_of_blade_groups": "blade groups",
}
#: Names of the motions that have one.
MOTION_NAMES: Mapping[str, str] = {
    "sliding_base": "helical motion",
    "work_offset": "vertical motion",
    "radial_distance": "radial motion",
}


def usual_name(key: str) -> str:
    """Usual name of what a key of a case file holds; the key in words if it has no other.

    Examples
    --------
    >>> usual_name("cutter_tilt"), usual_name("hypoid_offset")
    ('tilt', 'hypoid offset')
    """
    return USUAL_NAMES.get(key, key.replace("_", " "))


def motion_name(key: str) -> str:
    """Name of the motion of a setting.

    Examples
    --------
    >>> motion_name("sliding_base"), motion_name("cutter_tilt")
    ('helical motion', 'motion of tilt')
    """
    return MOTION_NAMES.get(key, f"motion of {usual_name(key)}")
