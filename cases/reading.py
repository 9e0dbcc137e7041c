"""Reading case files and telling the user, in one message, what is wrong with them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..core.errors import InputError
from .model import Case


def shipped_cases() -> dict[str, str]:
    """Names and titles of the cases that come with the package."""
    names = sorted(f.name[:-5] for f in resources.files(__package__).iterdir() if f.name.endswith(".toml"))
    return {name: read_case(name).title for name in names}


def case_text(name_or_path: str | Path) -> str:
    """Text of a shipped case (by name) or of a case file (by path).

    Raises
    ------
    InputError
        If there is neither a shipped case nor a readable file of that name.
    """
    name = str(name_or_path)
    shipped = resources.files(__package__).joinpath(f"{name}.toml")
    if "/" not in name and "\\" not in name and shipped.is_file():
        return shipped.read_text(encoding="utf-8")
    path = Path(name_or_path)
    if not path.is_file():
        known = ", ".join(
            sorted(f.name[:-5] for f in resources.files(__package__).iterdir() if f.name.endswith(".toml"))
        )
        raise InputError(f"case {name!r}: there is no such file, and the shipped cases are: {known}")
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"case {name!r} cannot be read as text: {error}") from error


def read_case(name_or_path: str | Path) -> Case:
    """Read and check a case.

    Parameters
    ----------
    name_or_path
        Name of a shipped case, or path of a case file in TOML.

    Raises
    ------
    InputError
        Naming every wrong key, its value and what is allowed.

    Examples
    --------
    >>> read_case("nasa-12x36").pinion.number_of_teeth
    12
    """
    return parse_case(case_text(name_or_path), str(name_or_path))


def parse_case(text: str, origin: str = "case") -> Case:
    """Check the text of a case; ``origin`` names it in messages. Raises as ``read_case``."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{origin} is not a TOML file: {error}") from error
    case = check_case(data, origin)
    case._text = text
    return case


def check_case(data: Mapping[str, Any], origin: str = "case") -> Case:
    """Check the tables of a case, wherever they come from. Arguments and exceptions are those of ``parse_case``."""
    try:
        return Case.model_validate(data)
    except ValidationError as error:
        raise InputError(f"{origin} has {_count(error)}:\n" + "\n".join(_lines(error))) from error


def _count(error: ValidationError) -> str:
    count = error.error_count()
    return "a mistake" if count == 1 else f"{count} mistakes"


def _lines(error: ValidationError) -> list[str]:
    lines = []
    for item in error.errors(include_url=False):
        key = ".".join(str(part) for part in item["loc"]) or "case"
        lines.append(f"  {key}{_value(item)}: {_allowed(item)}")
    return lines


def _value(item: Any) -> str:
    if item["type"] in ("missing", "value_error") or isinstance(item["input"], dict):
        return ""
    return f" = {item['input']!r}"


def _allowed(item: Any) -> str:
    """What is allowed, in plain words."""
    kind, context = item["type"], item.get("ctx", {})
    if kind == "missing":
        return "is missing; it must be given"
    if kind == "extra_forbidden":
        table = item["loc"][:-1]
        known = ", ".join(_known_keys(table))
        return (
            f"is not a key of {'[' + '.'.join(map(str, table)) + ']' if table else 'a case file'}; known are: {known}"
        )
    if kind == "value_error":
        return str(context["error"])
    limits = {"greater_than": "gt", "greater_than_equal": "ge", "less_than": "lt", "less_than_equal": "le"}
    words = {"gt": "greater than", "ge": "at least", "lt": "below", "le": "at most"}
    if kind in limits:
        name = limits[kind]
        return f"must be {words[name]} {context[name]:g}"
    if kind == "finite_number":
        return "must be a finite number"
    return str(item["msg"][0].lower() + item["msg"][1:])


def _known_keys(table: tuple[Any, ...]) -> list[str]:
    """Keys of the table at the given place of a case."""
    schema = Case.model_json_schema()
    definitions = schema["$defs"]
    node = schema
    for part in table:
        node = node["properties"].get(part, {})
        for option in [node, *node.get("anyOf", []), *node.get("allOf", [])]:
            if "$ref" in option:
                node = definitions[option["$ref"].rsplit("/", 1)[1]]
                break
        if "properties" not in node:
            return []
    return sorted(node["properties"])
