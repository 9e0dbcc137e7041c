"""The XML of REXS: components with attributes, and the relations between them; reading values with their units."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ...core.errors import InputError
from ...core.reading.regular_file import read_bytes
from ...core.reading.text_file import MODEL_SIZE_LIMIT
from .rexs_vocabulary import UNIT_FACTORS, Term

Value = str | float | int | tuple[float, ...]


@dataclass(frozen=True)
class Component:
    """A component of a model.

    Parameters
    ----------
    number
        Its id in the file.
    kind
        Its component type, such as ``bevel_gear``.
    name
        Its name.
    attributes
        Its attributes by id, as XML.
    """

    number: int
    kind: str
    name: str
    attributes: Mapping[str, ET.Element]

    def text(self, term: Term) -> str | None:
        """Text of an attribute; ``None`` if it is not there."""
        element = self.attributes.get(term.attribute)
        return None if element is None else (element.text or "").strip()

    def number_of(self, term: Term) -> float | None:
        """Number of an attribute in our unit; ``None`` if it is not there.

        Raises
        ------
        InputError
            If its text is not a finite number, or its unit is unknown for this quantity.
        """
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
        return f"component {self.number} ({self.kind}), attribute {term.attribute}"

    def _converted(self, term: Term, text: str) -> float:
        unit = self.attributes[term.attribute].get("unit", term.unit).strip()
        ours, factor = UNIT_FACTORS.get(unit, ("", math.nan))
        if ours != term.unit:
            allowed = ", ".join(repr(name) for name, (quantity, _) in UNIT_FACTORS.items() if quantity == term.unit)
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
        found = [r for r in self.relations if r.kind == kind and r.roles.get(role) == number]
        return sorted(found, key=lambda relation: relation.order)

    def in_role(self, relation: Relation, role: str, kind: str) -> Component | None:
        """The component that has a role in a relation; ``None`` if there is none, or it is of another type."""
        component = self.components.get(relation.roles.get(role, -1))
        return component if component is not None and component.kind == kind else None


class _NoDoctype(ET.TreeBuilder):
    """Refuses a document type: REXS has none, and its entities could blow up a small file."""

    def doctype(self, name: str, _public: str | None, _system: str | None) -> None:
        raise InputError(f"the file declares a document type ({name}), which a REXS file never does: it is not read")


def read_model(path: str | os.PathLike[str]) -> Model:
    """Read the components and relations of a REXS file.

    Raises
    ------
    InputError
        If the file cannot be read, is no XML, declares a document type, or holds no REXS model.
    """
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
    """Collects components and relations, numbers them, and makes the XML.

    Parameters
    ----------
    attributes
        Attributes of the outermost element: version, application and date.
    """

    def __init__(self, attributes: Mapping[str, str]) -> None:
        self._root = ET.Element("model", dict(attributes))
        self._relations = ET.SubElement(self._root, "relations")
        self._components = ET.SubElement(self._root, "components")

    def component(self, kind: str, name: str, attributes: Iterable[tuple[Term, Value]]) -> int:
        """Add a component and return its id."""
        number = len(self._components) + 1
        element = ET.SubElement(self._components, "component", {"id": str(number), "type": kind, "name": name})
        for term, value in attributes:
            item = ET.SubElement(element, "attribute", {"id": term.attribute, "unit": term.unit})
            if isinstance(value, tuple):
                array = ET.SubElement(item, "array")
                for entry in value:
                    ET.SubElement(array, "c").text = repr(entry)
            else:
                item.text = value if isinstance(value, str) else repr(value)
        return number

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
