"""Mutations of XML and of JSON lines: their elements and records, and what their parsers may fall for."""

from __future__ import annotations

import copy
import json
import random
import xml.etree.ElementTree as ET
from typing import Any

from . import text_mutations

ENTITIES = "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 10))
DOCTYPES = (
    f'<!DOCTYPE model [<!ENTITY e0 "lol">{ENTITIES}]>',
    '<!DOCTYPE model [<!ENTITY e9 SYSTEM "../../secret.toml">]>',
    '<!DOCTYPE model [<!ENTITY e9 SYSTEM "http://localhost/model.xml">]>',
    '<!DOCTYPE model SYSTEM "../../secret.toml">',
)
ODD_TEXTS = (
    "",
    "nan",
    "inf",
    "-1",
    "0",
    "1e300",
    "x",
    "1,5",
    "true",
    "9" * 5000,
    "é",
    "\u202ex",
    "x" * 100_000,
    "[1]",
    "1 2 3",
    "-",
)
ODD_RECORDS: tuple[Any, ...] = (
    None, 0, -1, 1e300, float("nan"), float("inf"), "", "x", "\x1b[2J", [], {}, [[]], True, 10**400, "x" * 100_000,
        [1] * 10_000,
)  # fmt: skip
DEEP_JSON = (
    "[" * 5000,
    '{"a":' * 5000,
    "[" * 5000 + "]" * 5000,
    "9" * 5000,
    "-" + "9" * 5000,
    "NaN",
    '"\\ud800"',
    "{}{}",
    "\x00",
)


def mutated_xml(rng: random.Random, text: str) -> str:
    """XML after mutations of its elements, or of its text."""
    way = rng.random()
    if way < 0.35:
        return text_mutations.mutated(rng, text)
    if way < 0.45:
        head, sep, body = text.partition("?>")
        entity = body.replace(">", ">&e9;", 3)
        return head + sep + rng.choice(DOCTYPES) + entity
    if way < 0.5:
        return text.replace("UTF-8", rng.choice(["UTF-16", "latin-1", "x", "UTF-7", ""])).replace("utf-8", "utf-16")
    if way < 0.55:
        depth = rng.choice([100, 5000, 200_000])
        return text.replace("</", "<component>" * depth + "</component>" * depth + "</", 1)
    root = ET.fromstring(text.encode())
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        _change_element(rng, root)
    return ET.tostring(root, encoding="unicode")


def _change_element(rng: random.Random, root: ET.Element) -> None:
    parents = [element for element in root.iter() if len(element)]
    parent = rng.choice(parents)
    child = rng.choice(list(parent))
    way = rng.choice(
        ["text", "text", "text", "attribute", "attribute", "drop", "drop", "repeat", "tag", "move", "many", "exchange"]
    )
    if way == "text":
        child.text = rng.choice(ODD_TEXTS)
    elif way == "attribute":
        key = rng.choice([*child.attrib, "id", "unit"])
        if rng.random() < 0.3:
            child.attrib.pop(key, None)
        else:
            child.set(key, rng.choice([*ODD_TEXTS, "mm", "deg", "rad", "in", "1", "2"]))
    elif way == "drop":
        parent.remove(child)
    elif way in ("repeat", "many"):
        parent.extend(copy.deepcopy(child) for _ in range(1 if way == "repeat" else 300))
    elif way == "tag":
        child.tag = rng.choice(["x", child.tag.upper(), "model", "component"])
    elif way == "move":
        parent.remove(child)
        rng.choice(parents).append(child)
    else:
        other = rng.choice(list(rng.choice(parents)))
        child.text, other.text = other.text, child.text
        child.attrib, other.attrib = other.attrib, child.attrib


def mutated_json_lines(rng: random.Random, text: str) -> str:
    """JSON lines, or one JSON document, after mutations of the records or the text."""
    way = rng.random()
    if way < 0.35:
        return text_mutations.mutated(rng, text)
    lines = text.split("\n")
    at = rng.randrange(len(lines))
    if way < 0.5:
        lines[at] = rng.choice(DEEP_JSON)
        return "\n".join(lines)
    try:
        whole = len(lines) > 1 and all(line.startswith("{") for line in lines)
        record = json.loads(lines[at] if whole else text)
    except ValueError:
        return text_mutations.mutated(rng, text)
    for _ in range(rng.choice([1, 1, 2, 4])):
        record = _changed_record(rng, record)
    if not whole:
        return json.dumps(record)
    lines[at] = json.dumps(record)
    return "\n".join(lines)


def _changed_record(rng: random.Random, record: Any) -> Any:
    places = _places(record)
    if not places or rng.random() < 0.03:
        return rng.choice(ODD_RECORDS)
    at, key = rng.choice(places)
    way = rng.choice(["odd", "odd", "drop", "text", "nest"])
    if way == "odd":
        at[key] = rng.choice(ODD_RECORDS)
    elif way == "drop":
        del at[key]
    else:
        at[key] = str(at[key]) if way == "text" else [at[key]]
    return record


def _places(record: Any) -> list[tuple[Any, Any]]:
    entries = list(
        record.items() if isinstance(record, dict) else enumerate(record) if isinstance(record, list) else []
    )
    return [(record, key) for key, _ in entries] + [place for _, value in entries for place in _places(value)]
