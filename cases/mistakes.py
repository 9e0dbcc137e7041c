"""Messages about the mistakes in a case or design file that pydantic finds: key, value, what is allowed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from pydantic import BaseModel, ValidationError

from ..core.errors import InputError, printable, shortened, suggestion

VALUE_LENGTH = 80  # of a value in a message [characters]
LINE_COUNT_LIMIT = 12  # of the mistakes that a message names
MESSAGE_LENGTH_LIMIT = 2500  # of the lines of a message; the first one is always shown [characters]
LIMIT_MESSAGES = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("below", "lt"),
    "less_than_equal": ("at most", "le"),
}
COUNT_MESSAGES = {
    "too_short": ("least", "min_length"),
    "too_long": ("most", "max_length"),
    "string_too_short": ("least", "min_length"),
    "string_too_long": ("most", "max_length"),
}
TYPE_MESSAGES = {
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be text in quotes",
    "tuple_type": "must be a list in brackets, such as [50.0, 150.0]",
    "model_type": "must be a table with keys of its own",
}


def refusal(origin: str, model: type[BaseModel], error: ValidationError, further: Sequence[str] = ()) -> InputError:
    """The error of a file or table called ``origin`` with mistakes: how many, and the first of them."""
    total = sum(map(_count, _items(error))) + len(further)
    told = mistakes(model, error, further)
    return InputError(f"{origin} has {'a mistake' if total == 1 else f'{total} mistakes'}:\n{told}")


def mistakes(model: type[BaseModel], error: ValidationError, further: Sequence[str] = ()) -> str:
    """The first mistakes in a table, one a line: key, value, what is allowed; and how many more there are.

    ``further`` ones come last.
    """
    items = _items(error)
    total = sum(map(_count, items)) + len(further)
    shown: list[str] = []
    lines = [*_lines(model, items[:LINE_COUNT_LIMIT]), *(f"  {model.__name__.lower()}: {text}" for text in further)]
    for line in lines[:LINE_COUNT_LIMIT]:
        if shown and sum(map(len, shown)) + len(line) > MESSAGE_LENGTH_LIMIT:
            break
        shown.append(line)
    left = total - len(shown)
    return "\n".join([*shown, *([f"  and {left} more"] if left > 0 else [])])


def _items(error: ValidationError) -> list[Any]:
    """Mistakes that pydantic reports, without lists that are too short for entries reported already."""
    return [
        item
        for item in error.errors(include_url=False)
        if not (item["type"] == "too_short" and len(item["input"]) >= item["ctx"]["min_length"])
    ]


def _count(item: Any) -> int:
    """Number of mistakes of one that pydantic reports: a check of a whole table tells several, a line each."""
    return str(item["ctx"]["error"]).count("\n") + 1 if item["type"] == "value_error" else 1


def _lines(model: type[BaseModel], items: list[Any]) -> list[str]:
    lines = []
    tables: set[tuple[Any, ...]] = set()  # tables whose keys were listed
    for item in items:
        key = shortened(printable(".".join(str(part) for part in item["loc"]))) or model.__name__.lower()
        lines += [f"  {key}{_value(item)}: {text}" for text in _allowed(model, item, tables).split("\n")]
    return lines


def _value(item: Any) -> str:
    table = isinstance(item["input"], dict)
    if item["type"] in ("missing", "value_error") or (table and item["type"] == "extra_forbidden"):
        return ""
    return f" = {written(item['input'])}"


def written(value: Any) -> str:
    """A value as the file has it, its beginning if it is long."""
    text = printable("".join(_pieces(value)))
    return text if len(text) <= VALUE_LENGTH else f"{text[: VALUE_LENGTH - 4]} ..."


def _pieces(value: Any, left: int = VALUE_LENGTH) -> Iterator[str]:
    """Text of a value piece by piece, not much more than is shown."""
    if isinstance(value, dict | list):
        brackets = "{}" if isinstance(value, dict) else "[]"
        yield brackets[0]
        for at, entry in enumerate(value):
            before = ", " if at else ""
            before += f"{str(entry)[:VALUE_LENGTH]} = " if isinstance(value, dict) else ""
            text = before + "".join(_pieces(value[entry] if isinstance(value, dict) else entry, left - len(before)))
            yield text
            left -= len(text)
            if left < 0:
                break
        yield brackets[1]
    elif isinstance(value, str):
        yield repr(value[: VALUE_LENGTH + 1])
    else:
        yield str(value).lower() if isinstance(value, bool) else repr(value)


def _allowed(model: type[BaseModel], item: Any, tables: set[tuple[Any, ...]]) -> str:
    """Values allowed, in plain words; the keys of a table are listed once, and the table is then one of ``tables``."""
    kind, context = item["type"], item.get("ctx", {})
    if kind == "missing":
        return "is missing; it must be given"
    if kind == "extra_forbidden":
        table = item["loc"][:-1]
        known = _known_keys(model, table)
        near = suggestion(str(item["loc"][-1]), known)
        place = f"[{'.'.join(map(str, table))}]" if table else f"a {model.__name__.lower()} file"
        listed = "" if table in tables else f"; known are: {', '.join(known)}"
        tables.add(table)
        others = _tables_with(model, str(item["loc"][-1]))
        there = f"; it is one of {' and '.join(others)}, whose line must stand above it" if others else near
        return f"is not a key of {place}{listed}{there}"
    if kind == "value_error":
        return str(context["error"])
    if kind in LIMIT_MESSAGES:
        words, name = LIMIT_MESSAGES[kind]
        return f"must be {words} {context[name]:g}{_unit(model, item['loc'])}"
    if kind in COUNT_MESSAGES:
        words, name = COUNT_MESSAGES[kind]
        unit = "character" if kind.startswith("string") else "value"
        return f"must have at {words} {context[name]} {unit}{'' if context[name] == 1 else 's'}"
    if kind == "literal_error":
        return f"must be {context['expected']}"
    return TYPE_MESSAGES.get(kind) or str(item["msg"][0].lower() + item["msg"][1:])


def _known_keys(model: type[BaseModel], table: tuple[Any, ...]) -> list[str]:
    """Keys of the table ``table`` of a case or design."""
    return sorted(_node(model, tuple(part for part in table if isinstance(part, str))).get("properties", {}))


def _tables_with(model: type[BaseModel], key: str) -> list[str]:
    """The tables of a case or design, in brackets, that have a key; none if it stands outside of all tables."""
    tables = _known_keys(model, ())
    return [f"[{table}]" for table in tables if key in _known_keys(model, (table,)) and key not in tables]


def _unit(model: type[BaseModel], key: tuple[Any, ...]) -> str:
    """Unit of a key, in brackets; empty of a number without one."""
    unit = _node(model, tuple(part for part in key if isinstance(part, str))).get("unit", "1")
    return "" if unit == "1" else f" [{unit}]"


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    """JSON schema of a case or design, made once: a message asks for it for every table that it looks at."""
    return model.model_json_schema()


def _node(model: type[BaseModel], path: tuple[Any, ...]) -> dict[str, Any]:
    """Schema of the table or key ``path`` of a case or design; empty if there is none."""
    schema = _schema(model)
    node = schema
    for part in path:
        node = node.get("properties", {}).get(part, {})
        for option in [node, node.get("items", {}), *node.get("anyOf", []), *node.get("allOf", [])]:
            if "$ref" in option:
                node = schema["$defs"][option["$ref"].rsplit("/", 1)[1]]
                break
    return node
