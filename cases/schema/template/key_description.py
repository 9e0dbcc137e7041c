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
    "easeoff_case": ("version of the format; 1 is read, too", ""),
    "title": ("one line for lists and plots", ""),
    "description": ("where the numbers come from", ""),
    "corrected_flanks": (
        "flanks whose settings `easeoff correct` made for the machine that cut the measured ones; on a machine without "
        "errors they cut others",
        "",
    ),
    "process": ("face_hobbed in methods 2 and 3", ""),
    "depth_taper": ("change of depth along the face", ""),
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
    "hand_of_spiral": ("of the pinion, the gear has the other; `[pinion]` only", ""),
    "edge_contact": ("[edges](../guides/finite_elements.md#edges) may touch beside the contact lines", ""),
    "torques": (
        "at the pinion; if left out, three in proportion to the size of the teeth, the middle one 40 N/mm² times face "
        "width, outer transverse module squared and half the pinion's teeth",
        "N m",
    ),
    "model": (
        "of the [teeth](../guides/finite_elements.md); `plate` to `root_factor` go with `shell`, the rest with the "
        "others",
        "",
    ),
    "plate": ("`fitted` follows thickness over the height and fanning; `even` is the dissertation's", ""),
    "oil": ("lubricant, or path of a TOML file inside the folder of this one", ""),
    "film": ("formula for the least film thickness", ""),
    "film_heating": ("thinning of the film by heat of the inlet", ""),
    "thermal_factor": ("decrease of the rolling traction by heat of the inlet", ""),
    "rolling_frame": ("frame of the rolling velocity", ""),
    "out_of_range": ("temperature without oil data: an error, or the end of the data with a flag", ""),
    "name": ("in results; its number, from 1, if left out", ""),
    "flank": ("in mesh; that of the analysis if left out", ""),
    "feedback": ("friction takes its part of the torque from the normal forces", ""),
    "wind_up": (
        "the pinion turns about its axis by its support's compliance; else this rotation is held, as the gear's always "
        "is",
        "",
    ),
    "rounds": (
        "assembly for which the ease-off is computed anew: mean of the mesh cycle, every mesh position, or none (first "
        "order)",
        "",
    ),
    "root": ("root springs; `clamped` for a rigid root", ""),
}

PAIRS = f"2 to {CURVE_LENGTH_LIMIT} pairs, positive and increasing"
# Values that a model elsewhere checks: what it allows.
ELSEWHERE = {
    "name": "text of up to 60 letters, digits, blanks and `. _ + = -`",
    "free_settings": "names of settings",
    "rim_depth": "one or two, > 0, < 1000",
    **dict.fromkeys(("reference", "pinion_reference", "gear_reference"), "three within ±5000"),
    **dict.fromkeys(("stiffness", "compliance"), "symmetric, [positive definite](../guides/supports.md)"),
    **dict.fromkeys(("radial_stiffness", "axial_stiffness"), f"0 to {STIFFNESS_LIMIT:g}, or {PAIRS}"),
    "tilting_stiffness": f"0 to {TILTING_STIFFNESS_LIMIT:g}, or {PAIRS}",
    **{f"{key}_displacement": PAIRS for key in ("radial", "axial", "tilting")},
    "speed": "one or a list, 1e-6 to 1e6",
    "temperature": "one or a list, within the oil's data; clamped to them, ≤ 400",
    "roughness": "one or a list, 0 to 100",
    "bulk_temperature": "> -273.15, ≤ 1000",
    "tooth_conductivity": "one or two, 0.01 to 1e4",
    "tooth_density": "one or two, 10 to 1e5",
    "tooth_heat_capacity": "one or two, 1 to 1e5",
    "oil": f"{', '.join(f'`{name}`' for name in available_lubricants())}, a path",
    "coefficient": f"{', '.join(f'`{name}`' for name in COEFFICIENTS)}, a number 0 to 1",
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
    limits = {
        type(limit).__name__: getattr(limit, type(limit).__name__.lower())
        for limit in field.metadata
        if type(limit).__name__ in SIGNS
    }
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
        return f"{count} numbers, each ≥ 1e-6, < 1e7"
    return interval(limits) + (", whole" if int in (field.annotation, *get_args(field.annotation)) else "")


def interval(limits: Mapping[str, float]) -> str:
    """Limits in words, by the names of their kinds: both included ones with "to", open and symmetric ones with ±."""
    if list(limits) == ["Ge", "Le"]:
        return f"{limits['Ge']:g} to {limits['Le']:g}"
    if list(limits) == ["Gt", "Lt"] and limits["Gt"] == -limits["Lt"]:
        return f"within ±{limits['Lt']:g}"
    return ", ".join(f"{SIGNS[kind]} {limit:g}" for kind, limit in limits.items())


def written(value: Any) -> str:
    """A value as it stands in TOML."""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f'`"{value}"`' if isinstance(value, str) else f"`{value}`"
