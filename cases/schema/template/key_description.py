"""What a key of an input file means, its unit and what it allows, for the pages of the docs and for templates."""

from __future__ import annotations

from collections.abc import Mapping
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

from annotated_types import MaxLen, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ....friction import COEFFICIENTS, FILM_FACTORS, FILMS, THERMAL_FACTORS, available_lubricants
from ..supports_table import CURVE_LENGTH_LIMIT, STIFFNESS_LIMIT, TILTING_STIFFNESS_LIMIT

# What the schema itself says nothing about, because a type or a table says it there: (meaning, unit).
MEANINGS = {
    "easeoff_case": ("version of the format", ""),
    "title": ("one line for lists and plots", ""),
    "description": ("where the numbers come from", ""),
    "process": ("how the pair is cut; methods 2 and 3 are face-hobbed", ""),
    "depth_taper": ("how the depth changes along the face; instead of the gear's two angles", ""),
    "easeoff_design": ("version of the format", ""),
    "easeoff_support": ("version of the format", ""),
    "generation": ("whether the gear is rolled while it is cut, or only indexed", ""),
    "basic_settings": (
        "whether the gear's settings are corrected until its flanks have the blank's angles at the mean point, or "
        "follow from the root line by the closed form",
        "",
    ),
    "method": ("how the pinion is cut, see [methods](#methods-of-the-pinion)", ""),
    "follow_root": (
        "closest fit: whether the tips of the pinion's blades shall run along its root cone; other methods always do",
        "",
    ),
    "free_settings": ("closest fit: pinion settings it may move, see below; the usual ones if left out", ""),
    "hand_of_spiral": ("hand of the pinion's spiral; the gear has the other one; `[pinion]` only", ""),
    "edge_contact": (
        "whether tooth edges may touch beside the contact lines, see "
        "[finite elements](../guides/finite_elements.md#edges)",
        "",
    ),
    "torques": (
        "torques at the pinion, one or more; if left out, three in proportion to the size of the teeth, the middle one "
        "40 N/mm² times face width, outer transverse module squared and half the pinion's teeth",
        "N m",
    ),
    "model": (
        "see [finite elements](../guides/finite_elements.md); `plate` to `root_factor` go with `shell`, the "
        "dissertation's",
        "",
    ),
    "plate": (
        "`fitted` follows the tooth's thickness over the height and the fanning of its heights; `even` is the "
        "dissertation's",
        "",
    ),
    "oil": ("lubricant: a shipped name, or the path of a TOML file inside the folder of this one", ""),
    "film": ("formula for the least film thickness", ""),
    "film_heating": ("how heat of the inlet thins the film", ""),
    "thermal_factor": ("how heat of the inlet lowers the rolling traction", ""),
    "rolling_frame": ("rolling velocity in the fixed frame, or relative to the contact line", ""),
    "out_of_range": ("temperatures the oil has no data for: an error, or the end of the data with a flag", ""),
    "name": ("of the load case in results and pictures; its number, from 1, if left out", ""),
    "flank": ("flanks in mesh; those of the analysis if left out", ""),
    "feedback": ("whether friction takes its part of the torque from the normal forces", ""),
    "wind_up": (
        "whether the pinion turns about its axis by the compliance of its support; else this rotation is held, as that "
        "of the gear always is",
        "",
    ),
    "rounds": (
        "for which assembly under load the ease-off is computed anew: the mean one over the mesh cycle, that of every "
        "mesh position, or none, so that all counts to first order",
        "",
    ),
    "root": ("constants of the root springs; `clamped` for a rigid root", ""),
}

PAIRS = f"2 to {CURVE_LENGTH_LIMIT} pairs of positive numbers, loads and displacements increasing"
# Values that a model elsewhere checks: what it allows.
ELSEWHERE = {
    "name": "text of up to 60 letters, digits, blanks and `. _ + = -`",
    "free_settings": "names of settings",
    "rim_depth": "one or two numbers, each > 0 and < 1000",
    **dict.fromkeys(("reference", "pinion_reference", "gear_reference"), "three numbers, each > -5000 and < 5000"),
    **dict.fromkeys(("stiffness", "compliance"), "symmetric, positive definite, see [supports](../guides/supports.md)"),
    **dict.fromkeys(("radial_stiffness", "axial_stiffness"), f"a number ≥ 0 and ≤ {STIFFNESS_LIMIT:g}, or {PAIRS}"),
    "tilting_stiffness": f"a number ≥ 0 and ≤ {TILTING_STIFFNESS_LIMIT:g}, or {PAIRS}",
    **{f"{key}_displacement": PAIRS for key in ("radial", "axial", "tilting")},
    "speed": "a number or a list, each ≥ 1e-6 and ≤ 1e6",
    "temperature": "a number or a list, within the oil's data; clamped to them, ≤ 400",
    "roughness": "a number or a list, each ≥ 0 and ≤ 100",
    "bulk_temperature": "a number > -273.15 and ≤ 1000",
    "tooth_conductivity": "a number or a list of two, each ≥ 0.01 and ≤ 1e4",
    "tooth_density": "a number or a list of two, each ≥ 10 and ≤ 1e5",
    "tooth_heat_capacity": "a number or a list of two, each ≥ 1 and ≤ 1e5",
    "oil": f"{', '.join(f'`{name}`' for name in available_lubricants())}, a path",
    "coefficient": f"{', '.join(f'`{name}`' for name in COEFFICIENTS)}, a number ≥ 0 and ≤ 1",
    "film": ", ".join(f"`{name}`" for name in FILMS),
    "film_heating": ", ".join(f"`{name}`" for name in FILM_FACTORS),
    "thermal_factor": ", ".join(f"`{name}`" for name in THERMAL_FACTORS),
}
SIGNS = {"Gt": ">", "Ge": "≥", "Lt": "<", "Le": "≤"}


def sub_table(annotation: Any) -> bool:
    """Whether a key opens a table of its own."""
    options = get_args(annotation) if get_origin(annotation) in (Union, UnionType, tuple) else (annotation,)
    return any(isinstance(option, type) and issubclass(option, BaseModel) for option in options)


def described(name: str, field: FieldInfo) -> tuple[str, str]:
    """Meaning and unit of a key."""
    if field.description is None:
        return MEANINGS[name]
    extra = field.json_schema_extra
    unit = str(extra["unit"]) if isinstance(extra, Mapping) else ""
    return field.description.removesuffix(f" [{unit}]"), "" if unit == "1" else unit


def allowed(name: str, field: FieldInfo) -> str:
    """Range, choices or type of the values of a key."""
    if name in ELSEWHERE and not any(type(limit).__name__ in SIGNS for limit in field.metadata):
        return ELSEWHERE[name]
    if bool in (field.annotation, *get_args(field.annotation)):
        return "`true`, `false`"
    for option in (field.annotation, *get_args(field.annotation)):
        if get_origin(option) is Literal:
            return ", ".join(written(choice) for choice in get_args(option))
    limits = [
        f"{sign} {getattr(limit, type(limit).__name__.lower()):g}"
        for limit in field.metadata
        if (sign := SIGNS.get(type(limit).__name__))
    ]
    lengths = [limit for limit in field.metadata if isinstance(limit, MinLen | MaxLen)]
    if len(lengths) == 1 and isinstance(lengths[0], MaxLen) and field.annotation is not str:
        return f"up to {lengths[0].max_length} numbers"
    count = " to ".join(
        str(limit.min_length if isinstance(limit, MinLen) else limit.max_length)
        for limit in field.metadata
        if isinstance(limit, MinLen | MaxLen)
    )
    if field.annotation is str:
        return f"text of {count} characters" if count else "text"
    if count:
        return f"{count} numbers, each ≥ 1e-6 and < 1e7"
    return ("whole number " if field.annotation is int else "") + " and ".join(limits)


def written(value: Any) -> str:
    """A value as it stands in TOML."""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f'`"{value}"`' if isinstance(value, str) else f"`{value}`"
