"""Templates of input files: case, design, supports, oil and load cases.

A template has the values of an example, and every other key of the schema behind a comment sign, with its meaning, unit
and range, which the pages of the docs show, too.
"""

from __future__ import annotations

import json
import math
import re
import textwrap
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ...core import checks
from ...core.errors import InputError, suggestion
from ...friction import COEFFICIENTS, FILM_FACTORS, FILMS, THERMAL_FACTORS, available_lubricants, lubricant
from ...friction.lubricants.lubricant import lubricant_toml
from ...geometry.design.iso23509.usual_proportions import DefaultValue
from ...geometry.design.sizing import first_size
from ..reading import CASE, DESIGN, SUPPORT
from .case_schema import Case
from .design_schema import Design
from .load_case_table import LoadCase
from .schema_table import extra_of, inner_table
from .supports_table import SupportFile

#: Choices of keys that friction offers, which the schema does not load.
FRICTION_CHOICES = {
    "oil": f"{', '.join(f'`{name}`' for name in available_lubricants())}, a path",
    "coefficient": f"{', '.join(f'`{name}`' for name in COEFFICIENTS)}, a number 0 to 1",
    "film": ", ".join(f"`{name}`" for name in FILMS),
    "film_heating": ", ".join(f"`{name}`" for name in FILM_FACTORS),
    "thermal_factor": ", ".join(f"`{name}`" for name in THERMAL_FACTORS),
}
SIGNS = {"Gt": ">", "Ge": "≥", "Lt": "<", "Le": "≤"}
LENGTHS = {"MinLen": "min_length", "MaxLen": "max_length"}


def sub_table(annotation: Any) -> bool:
    """True if a key opens a table of its own, or a list of them."""
    return inner_table(annotation, listed=True) is not None


def described(field: FieldInfo) -> tuple[str, str]:
    """Meaning and unit of a key."""
    unit = extra_of(field, "unit")
    return (field.description or "").removesuffix(f" [{unit}]"), "" if unit == "1" else unit


def allowed(name: str, field: FieldInfo) -> str:
    """Range, choices or type of the values of a key."""
    if checked_elsewhere := FRICTION_CHOICES.get(name) or extra_of(field, "allowed"):
        return checked_elsewhere
    options = (field.annotation, *get_args(field.annotation))
    if bool in options:
        return "`true`, `false`"
    for option in options:
        if get_origin(option) is Literal:
            return ", ".join(f"`{toml_value(choice)}`" for choice in get_args(option))
    limits = {type(limit).__name__: limit for limit in field.metadata}
    count = " to ".join(str(getattr(limits[kind], key)) for kind, key in LENGTHS.items() if kind in limits)
    if field.annotation is str:
        return f"text of {count} characters" if count else "text"
    if count:
        return f"{count} numbers, each ≥ 1e-6, < 1e7" if "MinLen" in limits else f"up to {count} numbers"
    bounds = {kind: getattr(limit, kind.lower()) for kind, limit in limits.items() if kind in SIGNS}
    return interval(bounds) + (", whole" if int in options else "")


def interval(limits: Mapping[str, float]) -> str:
    """Limits in words, by the names of their kinds: both included ones with "to", open and symmetric ones with ±."""
    if list(limits) == ["Ge", "Le"]:
        return f"{limits['Ge']:g} to {limits['Le']:g}"
    if list(limits) == ["Gt", "Lt"] and limits["Gt"] == -limits["Lt"]:
        return f"within ±{limits['Lt']:g}"
    return ", ".join(f"{SIGNS[kind]} {limit:g}" for kind, limit in limits.items())


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
            inner = inner_table(field.annotation, listed=True)
            if inner is None or name in IN_LINE:
                continue
            below = f"{path}.{name}" if path else name
            if values is None and below in self.elsewhere:
                continue
            given = None if values is None else values.get(name)
            if not given and below in self.elsewhere:
                lines += ["", *comment(self.elsewhere[below])]
            elif Ellipsis in get_args(field.annotation):  # a list of tables
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
            inner = inner_table(field.annotation, listed=True)
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
        if known is not None and (lines or not all(sub_table(one.annotation) for one in model.model_fields.values())):
            lines.append(f"# further keys as in [{known}]")
        return lines


def meaning(name: str, field: FieldInfo) -> str:
    """Meaning of a key, its unit, and its choices if they are words."""
    words, unit = described(field)
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


def sized_design(
    process: str | None,
    ratio: float,
    torque: float,
    *,
    speed: float | None = None,
    shaft_angle: float = 90.0,
    offset: float = 0.0,
    use: str = "industrial",
) -> tuple[str, tuple[str, ...]]:
    """Text of a design file of a first size, by ``first_size`` with angles in degrees, and its values with sources."""
    if process not in (None, *PROCESSES):
        raise InputError(f"name = {process!r}: must be {' or '.join(PROCESSES)} where a ratio is given")
    checks.number("shaft_angle", shaft_angle, "deg", least=60.0, most=120.0)
    angle = math.radians(shaft_angle)
    hobbed = process == PROCESSES[1]
    values = first_size(ratio, torque, speed=speed, shaft_angle=angle, offset=offset, use=use, hobbed=hobbed)
    torques = [round(share * torque, 6) for share in (0.25, 0.5, 1.0)]
    tables: dict[str, dict[str, tuple[Any, str]]] = {
        "pair": {"shaft_angle": (shaft_angle, ""), "hypoid_offset": (float(offset), "")},
        "blank_design": {},
        "pinion": {"hand_of_spiral": ("left", "below centre if there is an offset")},
        "gear": {},
        "contact": {"torques": (torques, "quarter, half and whole of the torque given")},
        **({} if speed is None else {"friction": {"speed": (float(speed), "")}}),
    }
    told = []
    for each in values:
        table, _, key = each.name.rpartition(".")
        value = round(math.degrees(each.value), 1) if key.endswith("angle") else each.value
        tables[table or "blank_design"][key] = (value, each.source)
        told.append(str(DefaultValue(each.name, value, each.source)))
    head = comment(
        "Design: a first size, to be changed after its analysis. 'easeoff design FILE -o CASE.toml' makes a case with "
        "machine settings of it. Keys that are left out have defaults; 'easeoff new design' writes all of them."
    )
    title = f"First size, {use}, ratio {ratio:g}, {torque:g} N m"
    lines = ["easeoff_design = 1", f"title = {toml_value(title)}"]
    for table, keys in tables.items():
        lines += ["", f"[{table}]"]
        for key, (value, source) in keys.items():
            lines += with_comment(f"{key} = {toml_value(value)}", source)
    return "\n".join([*head, "", *lines, ""]), tuple(told)


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
        "data sheet. density and thermal_conductivity may be left out."
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


def _values(content: Any, title: str) -> dict[str, Any]:
    """Values that a file gives, with a title of its own and no description, which would go into what is made of it."""
    values: dict[str, Any] = content.model_dump(exclude_unset=True)
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
    return "\n".join([*(line for words in (*head, SWITCHED_OFF) for line in comment(words)), "", text])


TEMPLATE_KINDS = {
    "case": TemplateKind(".toml", lambda: [*PROCESSES, *CASE.names()], _case),
    "design": TemplateKind(".toml", lambda: [*PROCESSES, *DESIGN.names()], _design),
    "supports": TemplateKind(".toml", SUPPORT.names, _supports),
    "oil": TemplateKind(".toml", available_lubricants, _oil),
    "load-cases": TemplateKind(".csv", lambda: sorted(CASE.names(), key=lambda name: name != "fm-11x41"), _load_cases),
}
