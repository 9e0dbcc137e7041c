"""Templates of input files: case, design, supports, oil and load cases."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from ....core.errors import InputError
from ....core.suggestion import suggestion
from ....friction import available_lubricants, lubricant
from ....friction.lubricants.data_sheet import lubricant_toml
from ...reading import CASE, DESIGN, SUPPORT
from ..case_schema import Case
from ..design_schema import Design
from ..load_case_table import LoadCase
from ..supports_table import SupportFile
from .template_text import comment, meaning, template_text

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
    """A kind of template.

    Parameters
    ----------
    suffix
        Of the file.
    names
        Of what its numbers can be taken from, the usual one first.
    text
        The text, from one of these names.
    """

    suffix: str
    names: Callable[[], list[str]]
    text: Callable[[str], str]


def template(kind: str, name: str | None = None) -> str:
    """Text of a commented template, which can be read and run as it is.

    Every key of the file is in it: with the value of an example, or switched off with its default.

    Parameters
    ----------
    kind
        ``case``, ``design``, ``supports``, ``oil`` or ``load-cases``.
    name
        What the numbers are taken from: ``face-milled`` or ``face-hobbed`` for a case or design, or the name of a
        shipped file of the kind; for load cases that of the shipped case whose torques they take. The first of these
        if left out.

    Raises
    ------
    InputError
        If there is no such kind or name.

    Examples
    --------
    >>> from easeoff.cases import parse_design
    >>> parse_design(template("design", "face-hobbed")).blank_design.process
    'face_hobbed'
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
