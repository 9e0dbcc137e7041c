"""Templates of input files: case, design, supports, oil and load cases.

What a key of an input file means, its unit and what it allows, for the pages of the docs and for templates.

Text of a commented input file: values of an example, and every other key of the schema behind a comment sign.
"""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from types import UnionType
from typing import Any, Literal, NamedTuple, Union, get_args, get_origin

from annotated_types import MaxLen, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ...core.errors import InputError, suggestion
from ...friction import COEFFICIENTS, FILM_FACTORS, FILMS, THERMAL_FACTORS, available_lubricants, lubricant
from ...friction.lubricants.lubricant import lubricant_toml
from ..reading import CASE, DESIGN, SUPPORT
from .case_schema import Case
from .design_schema import Design
from .load_case_table import LoadCase
from .supports_table import CURVE_LENGTH_LIMIT, STIFFNESS_LIMIT, TILTING_STIFFNESS_LIMIT, SupportFile

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
    """True if a key opens a table of its own."""
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


WIDTH = 110  # [characters] up to which a comment stands behind its key
LINK = re.compile(r"\[([^]]*)\]\([^)]*\)")
REFERENCE = re.compile(r",?\s*\bsee (below|\[[^]]*\]\([^)]*\))(; (?=`))?")
#: Keys whose values are a list of tables that stands in one line each.
IN_LINE = frozenset({"sections"})


def template_text(model: type[BaseModel], values: Mapping[str, Any], elsewhere: Mapping[str, str] | None = None) -> str:
    """Text with comments of a file of a schema, with ``elsewhere`` in the place of tables described elsewhere.

    A key without a space behind its comment sign is switched off.
    """
    return "\n".join(_Writer(dict(elsewhere or {})).table(model, values, "")).strip("\n")


class _Writer:
    """Writer of one file, which describes the keys of a kind of table where it stands first."""

    def __init__(self, elsewhere: dict[str, str]) -> None:
        self.elsewhere = elsewhere
        self.described: dict[type[BaseModel], str] = {}

    def table(self, model: type[BaseModel], values: Mapping[str, Any] | None, path: str, head: str = "") -> list[str]:
        """Lines of a table and of those in it; switched off if it has no values."""
        if values is None and model in self.described:
            return ["", f"{'#' + head:36} # keys as in [{self.described[model]}]"]
        lines = self.keys(model, values, path)
        if head and lines:
            lines = ["", ("" if values is not None else "#") + head, *lines]
        for name, field in model.model_fields.items():
            inner = inner_model(field.annotation)
            if inner is None or name in IN_LINE:
                continue
            below = f"{path}.{name}" if path else name
            if values is None and below in self.elsewhere:
                continue
            given = None if values is None else values.get(name)
            if not given and below in self.elsewhere:
                lines += ["", *comment(self.elsewhere[below])]
            elif is_list(field.annotation):
                for row in given or [None]:
                    lines += self.table(inner, row, below, f"[[{below}]]")
            else:
                lines += self.table(inner, given, below, f"[{below}]")
        return lines

    def keys(self, model: type[BaseModel], values: Mapping[str, Any] | None, path: str) -> list[str]:
        """Lines of the keys of a table that are no tables themselves."""
        lines = []
        known = self.described.get(model)
        if known is None:
            self.described[model] = path
        for name, field in model.model_fields.items():
            inner = inner_model(field.annotation)
            if inner is not None and name not in IN_LINE:
                continue
            given = values is not None and name in values
            value = values[name] if given and values is not None else None
            if known is not None and not given:
                continue
            if name in IN_LINE and inner is not None:
                words = "; ".join(f"{key}: {meaning(key, each)}" for key, each in inner.model_fields.items())
                lines += comment(words) if known is None else []
                rows = [f"    {toml_value(row)}," for row in value or []]
                lines += ["sections = [", *rows, "]"] if rows else [f"#{name} = "]
                continue
            key = f"{name} = {toml_value(value)}" if given else f"#{name} = {default_value(field)}".rstrip()
            lines += with_comment(key, "" if known is not None else meaning(name, field))
        if known is not None and (lines or any(not sub_table(one.annotation) for one in model.model_fields.values())):
            lines.append(f"# further keys as in [{known}]")
        return lines


def inner_model(annotation: Any) -> type[BaseModel] | None:
    """The table that a key opens, alone or as a list; ``None`` if it holds a value."""
    if not sub_table(annotation):
        return None
    options = (annotation, *get_args(annotation))
    return next(each for each in options if isinstance(each, type) and issubclass(each, BaseModel))


def is_list(annotation: Any) -> bool:
    """True if a key holds a list of tables."""
    return Ellipsis in get_args(annotation)


def meaning(name: str, field: FieldInfo) -> str:
    """Meaning of a key, its unit, and its choices if they are words."""
    words, unit = described(name, field)
    choices = allowed(name, field)
    description = plain(words) + (f" [{unit}]" if unit else "")
    if "`" in choices and "," in choices and bool not in (field.annotation, *get_args(field.annotation)):
        description += f": {plain(choices)}"
    return description


def plain(text: str) -> str:
    """A text of the docs without its marks and references."""
    return LINK.sub(r"\1", REFERENCE.sub("", text)).replace("`", "").strip()


def default_value(field: FieldInfo) -> str:
    """The default of a key as it stands in TOML; nothing if there is none."""
    if field.is_required() or field.default is None or field.default == ():
        return ""
    value = field.default
    return toml_value(value[0] if isinstance(value, tuple) and len(value) == 1 else value)


def toml_value(value: Any) -> str:
    """A value as it stands in TOML, in one line; a text of several lines as one of them."""
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key} = {toml_value(each)}' for key, each in value.items())} }}"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"[{', '.join(map(toml_value, value))}]"
    if isinstance(value, str) and "\n" in value:
        return '"""\\\n' + "\n".join(json.dumps(line, ensure_ascii=False)[1:-1] for line in value.split("\n")) + '"""'
    if isinstance(value, bool | str):
        return json.dumps(value, ensure_ascii=False)
    return repr(value)


def with_comment(key: str, words: str) -> list[str]:
    """Lines of a key and its comment: behind it, or before it if that is too long."""
    if not words:
        return [key]
    if len(line := f"{key:36} # {words}") <= WIDTH and "\n" not in key:
        return [line]
    return [*comment(words), key]


def comment(words: str) -> list[str]:
    """Lines of a comment."""
    return [f"# {line}" for line in textwrap.wrap(words, WIDTH - 2)]


SWITCHED_OFF = (
    "A key right behind its comment sign, as in #key = 1, is switched off and shows its default if it has one. "
    "To switch on a key of a table that is off, switch on the line of the table, too, as in #[contact]."
)
PROCESSES = ("face-milled", "face-hobbed")
#: Shipped files that the processes stand for.
EXAMPLES = {
    "case": {"face-milled": "fm-11x41", "face-hobbed": "fh-12x41-45"},
    "design": {"face-milled": "fm-11x41", "face-hobbed": "fh-design-b"},
}
#: Share of the limit pressure angle of a hypoid pair, and the targets of both sides [um], that suit most pairs.
USUAL_INFLUENCE = 1.0
USUAL_TARGET = {"lengthwise_crowning": 60.0, "profile_crowning": 15.0}
#: What of an example is its own, and is not to get into a design unseen.
OWN_TABLES = ("cutter_steps", "misalignment", "contact", "compliance", "friction")
#: What the columns of load cases hold in the template.
LOAD_CASES: tuple[Mapping[str, Any], ...] = (
    {"name": "cruise", "share": 0.8, "speed": 2000, "flank": "drive"},
    {"name": "climb", "share": 0.15, "speed": 1000, "flank": "drive", "E": 0.05, "P": -0.05, "G": 0.02, "Sigma": 0.01},
    {"name": "launch", "share": 0.05, "speed": 300, "flank": "drive", "E": 0.1, "P": -0.1, "G": 0.04, "Sigma": 0.02},
)


class TemplateKind(NamedTuple):
    """A kind of template."""

    suffix: str
    names: Callable[[], list[str]]  # numbers taken from these, the usual first
    text: Callable[[str], str]


def template(kind: str, name: str | None = None) -> str:
    """Text of a template with a comment on every key, of an example or switched off, that runs as it is.

    ``name`` is ``face-milled``, ``face-hobbed`` or a shipped file of the kind; for load cases a shipped case.
    """
    if kind not in TEMPLATE_KINDS:
        near = suggestion(kind, TEMPLATE_KINDS)
        raise InputError(f"kind = {kind!r}: must be one of {', '.join(TEMPLATE_KINDS)}{near}")
    names = TEMPLATE_KINDS[kind].names()
    if name is not None and name not in names:
        raise InputError(f"name = {name!r}: must be one of {', '.join(names)}{suggestion(name, names)}")
    return TEMPLATE_KINDS[kind].text(name or names[0]) + "\n"


def _case(name: str) -> str:
    origin = EXAMPLES["case"].get(name, name)
    values = _values(CASE.read(origin), "My pair")
    elsewhere = {
        "supports": "[supports]: shafts, bearings and housing; 'easeoff new supports' writes a template, whose tables "
        "may stand here or in a file of their own.",
        "blank_design": "[blank_design]: basic data of the blanks by ISO 23509, instead of [pinion.blank] and "
        "[gear.blank]; 'easeoff new design' writes a template with this table.",
    }
    head = [
        "Case: a pair with its blanks, cutters and machine settings. 'easeoff run FILE -o RESULT.nc' analyses it. "
        f"Numbers of the shipped case {origin}, to be replaced."
    ]
    return _file(head, template_text(Case, values, elsewhere))


def _design(name: str) -> str:
    origin = EXAMPLES["design"].get(name, name)
    shipped = DESIGN.read(origin)
    values = _values(shipped, "My pair")
    if name in EXAMPLES["design"]:
        values = _usual(values)
    head = [
        "Design: basic data of the blanks and the wanted ease-off. 'easeoff design FILE -o CASE.toml' makes a case "
        f"with machine settings of it. Basic data of the shipped design {origin}, to be replaced."
    ]
    if "cutter_steps" in values and not shipped.cutter_steps.blade_angle:
        head.append("Its steps in [cutter_steps] are zero, for the shipped case has the cutters as computed.")
    return _file(head, template_text(Design, values))


def _supports(name: str) -> str:
    values = _values(SUPPORT.read(name), "My supports")
    head = [
        "Supports: shafts, bearings and housing of a pair. 'easeoff run CASE -o RESULT.nc --supports FILE' analyses a "
        "case on them. Places are on a member's axis, from its crossing point, positive towards the heel. Numbers of "
        f"the shipped supports {name}, to be replaced."
    ]
    return _file(head, template_text(SupportFile, values))


def _oil(name: str) -> str:
    head = [
        "Lubricant: properties at two or more temperatures. 'easeoff run CASE -o RESULT.nc --speed SPEED --oil FILE' "
        f"takes it. Numbers of the shipped lubricant {name}, to be replaced; 'easeoff oil' makes such a file from a "
        "data sheet. density and thermal_conductivity may be left out.",
    ]
    return "\n".join([*comment(head[0]), lubricant_toml(lubricant(name)).rstrip()])


def _load_cases(name: str) -> str:
    torques = CASE.read(name).contact.torques
    columns = list(LoadCase.model_fields)
    words = [
        *comment(
            "Load cases, a line each. 'easeoff run CASE -o RESULT.nc --load-cases FILE' analyses them. Columns may "
            "stand in any order; all but torque may be left out, and cells may be empty."
        ),
        *(line for key, field in LoadCase.model_fields.items() for line in comment(f"{key}: {meaning(key, field)}")),
    ]
    rows = [row | {"torque": f"{torques[min(at, len(torques) - 1)]:g}"} for at, row in enumerate(map(dict, LOAD_CASES))]
    lines = [",".join(str(row.get(column, "")) for column in columns) for row in rows]
    return "\n".join([*words, ",".join(columns), *lines])


def _values(found: Any, title: str) -> dict[str, Any]:
    """Values that a file gives, with a title of its own and no description, which would go into what is made of it."""
    values: dict[str, Any] = found.model_dump(exclude_unset=True)
    return values | {"title": title, "description": ""}


def _usual(values: dict[str, Any]) -> dict[str, Any]:
    """Values of a design with the usual targets, and without what is the example's own but its basic data."""
    kept = {key: value for key, value in values.items() if key not in OWN_TABLES}
    members = {name: {k: v for k, v in kept[name].items() if k != "tool_edge_radius"} for name in ("pinion", "gear")}
    blank = kept["blank_design"] | {"limit_pressure_angle_influence": USUAL_INFLUENCE}
    targets = {side: dict(USUAL_TARGET) for side in ("drive", "coast")}
    return kept | members | {"blank_design": blank, "target": targets}


def _file(head: list[str], text: str) -> str:
    """A whole file: what it is, how to read it, and its keys."""
    lines = [line for words in (*head, SWITCHED_OFF) for line in comment(words)]
    return "\n".join([*lines, "", text])


def _case_names() -> list[str]:
    return ["fm-11x41", *(name for name in CASE.names() if name != "fm-11x41")]


TEMPLATE_KINDS = {
    "case": TemplateKind(".toml", lambda: [*PROCESSES, *CASE.names()], _case),
    "design": TemplateKind(".toml", lambda: [*PROCESSES, *DESIGN.names()], _design),
    "supports": TemplateKind(".toml", SUPPORT.names, _supports),
    "oil": TemplateKind(".toml", available_lubricants, _oil),
    "load-cases": TemplateKind(".csv", _case_names, _load_cases),
}
