"""Reading the bevel part of REXS, the exchange format for gearbox data of the FVA: a bevel stage as a case.

The XML holds components with attributes, and relations between them, as ``rexs_writing`` has them; values are read with
their units. What REXS leaves open is decided in ``docs/engineer/reference/exchange.md``.
"""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from ...core.errors import InputError
from ...core.regular_file import MODEL_SIZE_LIMIT, read_bytes
from ...geometry.pair.gear_pair import MEMBERS
from ..reading import MEAN, MID_FLANK, check_case
from ..schema.case_schema import Blank, Case, MemberTable
from ..schema.cutting_table import ANGULAR_MOTIONS, ROLL_KEYS, Cutter, Machine, polynomial_derivatives
from . import rexs_vocabulary as rexs
from .rexs_vocabulary import Hand, Term, opposite, side

Value = str | float | int | tuple[float, ...]


@dataclass(frozen=True)
class Component:
    """A component of a REXS model."""

    number: int
    kind: str
    name: str
    attributes: Mapping[str, ET.Element]

    def __str__(self) -> str:
        return f"component {self.number} ({self.kind})"

    def text(self, term: Term) -> str | None:
        """Text of an attribute; ``None`` if it is not there."""
        element = self.attributes.get(term.attribute)
        return None if element is None else (element.text or "").strip()

    def number_of(self, term: Term) -> float | None:
        """Number of an attribute in our unit; ``None`` if it is not there."""
        text = self.text(term)
        return None if text is None else self._converted(term, text)

    def numbers_of(self, term: Term) -> tuple[float, ...]:
        """Numbers of an array in our unit; none if it is not there. Raises as ``number_of``."""
        element = self.attributes.get(term.attribute)
        if element is None:
            return ()
        array = element.find("array")
        if array is None or array.get("code") is not None:
            raise InputError(
                f"{self.described(term)}: must be an <array> of <c> elements; arrays in binary code are not read"
            )
        return tuple(self._converted(term, (item.text or "").strip()) for item in array.findall("c"))

    def described(self, term: Term) -> str:
        """Name of an attribute in messages."""
        return f"{self}, attribute {term.attribute}"

    def _converted(self, term: Term, text: str) -> float:
        unit = self.attributes[term.attribute].get("unit", term.unit).strip()
        ours, factor = rexs.UNIT_FACTORS.get(unit, ("", math.nan))
        if ours != term.unit:
            units = rexs.UNIT_FACTORS.items()
            allowed = ", ".join(repr(name) for name, (quantity, _) in units if quantity == term.unit)
            raise InputError(f"{self.described(term)}: unit = {unit!r}: must be one of {allowed}")
        try:
            value = float(text)
        except ValueError as error:
            raise InputError(f"{self.described(term)} = {text!r}: must be a number") from error
        if not math.isfinite(value):
            raise InputError(f"{self.described(term)} = {text}: must be a finite number")
        return value * factor


@dataclass(frozen=True)
class Relation:
    """A relation between components: its type, its order (0 if none is given), and the component of every role."""

    kind: str
    order: int
    roles: Mapping[str, int]


@dataclass(frozen=True)
class Model:
    """A REXS model; ``loaded`` says whether it has load spectra, ``application`` which program wrote it."""

    version: str
    application: str
    components: Mapping[int, Component]
    relations: tuple[Relation, ...]
    loaded: bool

    def related(self, kind: str, role: str, number: int) -> list[Relation]:
        """The relations of a type in which the given component has the given role, by their order."""
        relations = [r for r in self.relations if r.kind == kind and r.roles.get(role) == number]
        return sorted(relations, key=lambda relation: relation.order)

    def in_role(self, relation: Relation, role: str, kind: str) -> Component | None:
        """The component that has a role in a relation; ``None`` if there is none, or it is of another type."""
        component = self.components.get(relation.roles.get(role, -1))
        return component if component is not None and component.kind == kind else None


class _NoDoctype(ET.TreeBuilder):
    """Refuses a document type: REXS has none, and its entities could blow up a small file."""

    def doctype(self, name: str, _public: str | None, _system: str | None) -> None:
        raise InputError(f"the file declares a document type ({name}), which a REXS file never does: it is not read")


def read_model(path: str | os.PathLike[str]) -> Model:
    """Read the components and relations of a REXS file; one that declares a document type is refused."""
    data = read_bytes(path, MODEL_SIZE_LIMIT)
    parser = ET.XMLParser(target=_NoDoctype())
    try:
        parser.feed(data)
        root = parser.close()
    except (ET.ParseError, LookupError, ValueError) as error:
        raise InputError(f"{path} cannot be read as XML: {error}") from error
    for element in root.iter():
        element.tag = element.tag.rsplit("}", 1)[-1]  # the schema exists with and without a namespace
    if root.tag != "model":
        raise InputError(f"{path} is not a REXS file: its outermost element is <{root.tag}>, not <model>")
    try:
        components = [_component(item) for item in root.findall("./components/component")]
        relations = tuple(_relation(item) for item in root.findall("./relations/relation"))
    except (KeyError, ValueError) as error:
        raise InputError(f"{path}: a component or relation lacks its id or type, or its id is not a number") from error
    return Model(
        root.get("version", ""),
        root.get("applicationId", ""),
        {component.number: component for component in components},
        relations,
        root.find("load_spectrum") is not None,
    )


def _component(element: ET.Element) -> Component:
    attributes = {item.attrib["id"]: item for item in element.findall("attribute")}
    return Component(int(element.attrib["id"]), element.attrib["type"], element.get("name", ""), attributes)


def _relation(element: ET.Element) -> Relation:
    roles = {ref.attrib["role"]: int(ref.attrib["id"]) for ref in element.findall("ref")}
    return Relation(element.attrib["type"], int(element.get("order", "0")), roles)


class ModelWriter:
    """Collects components and relations, numbers them, and makes the XML, whose root has the attributes."""

    def __init__(self, **attributes: str) -> None:
        self._root = ET.Element("model", attributes)
        self._relations = ET.SubElement(self._root, "relations")
        self._components = ET.SubElement(self._root, "components")

    def component(self, kind: str, name: str, attributes: Iterable[tuple[Term, Value]]) -> int:
        """Add a component and return its id."""
        number = len(self._components) + 1
        ET.SubElement(self._components, "component", {"id": str(number), "type": kind, "name": name})
        self.add(number, attributes)
        return number

    def add(self, number: int, attributes: Iterable[tuple[Term, Value]]) -> None:
        """Add attributes to a component."""
        element = self._components[number - 1]
        for term, value in attributes:
            item = ET.SubElement(element, "attribute", {"id": term.attribute, "unit": term.unit})
            if isinstance(value, tuple):
                array = ET.SubElement(item, "array")
                for entry in value:
                    ET.SubElement(array, "c").text = repr(entry)
            else:
                item.text = value if isinstance(value, str) else repr(value)

    def relation(self, kind: str, *, order: int | None = None, **roles: int) -> None:
        """Add a relation between components that are there already; in the file the relations stand first."""
        element = ET.SubElement(self._relations, "relation", {"id": str(len(self._relations) + 1), "type": kind})
        if order is not None:
            element.set("order", str(order))
        for role, number in roles.items():
            hint = self._components[number - 1].attrib["type"]
            ET.SubElement(element, "ref", {"id": str(number), "role": role, "hint": hint})

    def text(self) -> str:
        """The file."""
        ET.indent(self._root)
        return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(self._root, encoding="unicode") + "\n"


HANDS: tuple[Hand, ...] = ("left", "right")


def read_rexs(path: str | os.PathLike[str]) -> tuple[Case, list[str]]:
    """Read the bevel stage of a REXS file (XML).

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    tuple
        The case, and what in the file was not understood or not used, one entry each.

    Raises
    ------
    InputError
        If the file cannot be read, does not hold exactly one bevel stage, lacks an attribute that a case needs, or has
        values that a case does not allow.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import read_case, write_rexs
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     notes = write_rexs(read_case("nasa-12x36"), f"{folder}/pair.rexs")
    ...     case, notes = read_rexs(f"{folder}/pair.rexs")
    >>> case.gear.number_of_teeth
    36
    """
    try:
        return _read(read_model(path))
    except InputError as error:
        text = str(error)
        raise InputError(text if text.startswith(str(path)) else f"{path}: {text}") from error


def _read(model: Model) -> tuple[Case, list[str]]:
    notes: list[str] = []
    stages = [r for r in model.relations if r.kind == "stage" and model.in_role(r, "stage", "bevel_stage")]
    if len(stages) != 1:
        raise InputError(f"the file holds {len(stages)} bevel stages with a relation 'stage'; a case is exactly one")
    stage = model.in_role(stages[0], "stage", "bevel_stage")
    pinion, gear = (model.in_role(stages[0], role, "bevel_gear") for role in ("gear_1", "gear_2"))
    if stage is None or pinion is None or gear is None:
        raise InputError("the relation 'stage' of the bevel stage does not name two components of type bevel_gear")
    missing: list[str] = []
    teeth = rexs.MEMBER_TERMS["number_of_teeth"]
    if (gear.number_of(teeth) or 1e9) < (pinion.number_of(teeth) or 0):
        pinion, gear = gear, pinion
        notes.append("gear_2 of the stage has fewer teeth: it is taken as the pinion")
    hand = _hand(pinion, gear, missing)
    visited = {stage.number, pinion.number, gear.number}
    tables = [
        _read_member(model, component, spiral, missing, notes, visited)
        for component, spiral in ((pinion, hand), (gear, opposite(hand)))
    ]
    if model.application == rexs.APPLICATION and stage.text(rexs.CASE_TERM) is None:
        for name, table in zip(MEMBERS, tables, strict=True):
            if MEAN in table:
                table[MID_FLANK] = table.pop(MEAN)
                notes.append(
                    f"{name}.{MID_FLANK}: an earlier easeoff wrote the thickness in the middle of the flank as "
                    f"{rexs.MEMBER_TERMS[MEAN].attribute}; write the file anew, other programs take it for another one"
                )
    if missing:
        raise InputError("these attributes are needed and missing:\n" + "\n".join(f"  {line}" for line in missing))
    data = {
        "easeoff_case": 2,
        "title": (stage.name or f"{pinion.name} {gear.name}".strip() or "bevel stage")[:200],
        "pair": _values(stage, rexs.STAGE_TERMS),
        "misalignment": _values(stage, rexs.MISALIGNMENT_TERMS),
        "pinion": {**tables[0], "hand_of_spiral": hand},
        "gear": tables[1],
    }
    return check_case(data, "the bevel stage"), notes + _not_used(model, visited)


def _hand(pinion: Component, gear: Component, missing: list[str]) -> Hand:
    """Hand of the pinion, given by itself or by its mate."""
    hands: list[Hand] = []
    for component, left in ((pinion, "left"), (gear, "right")):
        text = component.text(rexs.HAND_TERM)
        if text is None:
            continue
        if text not in HANDS:
            raise InputError(f"{component.described(rexs.HAND_TERM)} = {text!r}: must be one of left, right")
        hands.append("left" if text == left else "right")
    if len(set(hands)) > 1:
        raise InputError(
            f"{gear.described(rexs.HAND_TERM)}: both members have the same hand; they must be of opposite hand"
        )
    if not hands:
        missing.append(pinion.described(rexs.HAND_TERM))
        return "left"
    return hands[0]


def _values(component: Component, terms: dict[str, Term]) -> dict[str, Any]:
    """Keys of a table for the attributes that a component has."""
    numbers = {key: component.number_of(term) for key, term in terms.items()}
    return {key: value for key, value in numbers.items() if value is not None}


def _needed(
    component: Component, table: type[BaseModel], terms: dict[str, Term], missing: list[str], *also: str
) -> dict[str, Any]:
    """The same, with a list of those that must be there and are not."""
    values = _values(component, terms)
    for key, term in terms.items():
        field = table.model_fields[key]
        if key not in values and (field.is_required() or key in also):
            missing.append(component.described(term))
        elif key in values and field.annotation is int:
            if not values[key].is_integer():
                raise InputError(f"{component.described(term)} = {values[key]}: must be a whole number")
            values[key] = int(values[key])
    return values


def _read_member(
    model: Model, gear: Component, hand: Hand, missing: list[str], notes: list[str], visited: set[int]
) -> dict[str, Any]:
    table = _needed(gear, MemberTable, rexs.MEMBER_TERMS, missing)
    table["blank"] = _needed(gear, Blank, rexs.BLANK_TERMS, missing)
    for relation in model.related("reference", "origin", gear.number):
        steel = model.in_role(relation, "referenced", "material")
        if steel is not None:
            visited.add(steel.number)
            table["material"] = _values(steel, rexs.MATERIAL_TERMS)
    for relation in model.related("flank", "gear", gear.number):
        for role in HANDS:
            flank = model.in_role(relation, role, "bevel_gear_flank")
            if flank is None:
                continue
            visited.add(flank.number)
            name = flank.text(rexs.FLANK_TERM) or side(hand, role)
            settings = _read_flank(model, flank, missing, notes, visited)
            if settings is None:
                continue
            if name not in ("concave", "convex") or name in table:
                raise InputError(
                    f"{flank.described(rexs.FLANK_TERM)} = {name!r}: must be one of concave, convex, once each"
                )
            table[name] = settings
            if flank.text(rexs.FLANK_TERM) is None:
                notes.append(
                    f"{flank}: the {role} flank is taken as the {name} one, seen from the heel; REXS does not say from "
                    "where"
                )
    return table


def _read_flank(
    model: Model, flank: Component, missing: list[str], notes: list[str], visited: set[int]
) -> dict[str, Any] | None:
    """Machine and cutter of a flank; ``None`` if it has none."""
    steps = model.related("manufacturing_step", "workpiece", flank.number)
    if not steps:
        return None
    if len(steps) > 1:
        notes.append(f"{flank}: the last of {len(steps)} manufacturing steps is used")
    tool = model.in_role(steps[-1], "tool", "bevel_gear_tool")
    made = model.in_role(steps[-1], "manufacturing_settings", "bevel_gear_manufacturing_settings")
    if tool is None or made is None:
        raise InputError(
            f"{flank}: its manufacturing step names no bevel_gear_tool or no bevel_gear_manufacturing_settings"
        )
    visited |= {tool.number, made.number}
    machine = _needed(made, Machine, rexs.MACHINE_TERMS, missing, "radial_distance", "cradle_angle")
    if not machine.get("ratio_of_roll"):
        if "ratio_of_roll" not in machine:
            notes.append(f"{made}: has no ratio_of_roll, so that the member is taken as Formate")
        machine.pop("ratio_of_roll", None)
    roll = made.numbers_of(rexs.MODIFIED_ROLL_TERM)
    if any(roll[len(ROLL_KEYS) :]):
        raise InputError(
            f"{made.described(rexs.MODIFIED_ROLL_TERM)}: has more than {len(ROLL_KEYS)} coefficients other than zero"
        )
    machine |= dict(zip(ROLL_KEYS, polynomial_derivatives(roll, 2), strict=False))
    motions = {}
    for key, term in rexs.MOTION_TERMS.items():
        unit = math.degrees(1.0) if key in ANGULAR_MOTIONS else 1.0
        if coefficients := made.numbers_of(term):
            motions[key] = polynomial_derivatives(coefficients, unit=unit)
    if any(roll) or any(any(values) for values in motions.values()):
        notes.append(
            f"{made}: coefficients of modified roll and motions are taken as those of powers of the cradle increment "
            "in rad, as the page on exchange says; REXS does not define them"
        )
    machine["motions"] = motions
    return {"machine": machine, "cutter": _needed(tool, Cutter, rexs.CUTTER_TERMS, missing)}


def _not_used(model: Model, visited: set[int]) -> list[str]:
    """Attributes and components of the file that the case does not hold."""
    notes = []
    for number in sorted(visited):
        component = model.components[number]
        unknown = [name for name in component.attributes if name not in rexs.ATTRIBUTES_READ[component.kind]]
        if unknown:
            notes.append(f"{component}: not used: {', '.join(unknown)}")
    others = Counter(component.kind for number, component in model.components.items() if number not in visited)
    notes += [f"not used: components of type {kind} ({count})" for kind, count in sorted(others.items())]
    if model.loaded:
        notes.append("not used: the load spectrum")
    return notes
