"""Text of a commented input file: values of an example, and every other key of the schema behind a comment sign."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from .key_description import allowed, described, sub_table

WIDTH = 110  # [characters] up to which a comment stands behind its key
LINK = re.compile(r"\[([^]]*)\]\([^)]*\)")
REFERENCE = re.compile(r",?\s*\bsee (below|\[[^]]*\]\([^)]*\))(; (?=`))?")
#: Keys whose values are a list of tables that stands in one line each.
IN_LINE = frozenset({"sections"})


def template_text(model: type[BaseModel], values: Mapping[str, Any], elsewhere: Mapping[str, str] | None = None) -> str:
    """Text of a file of a schema with comments. A key without a space behind its comment sign is switched off.

    Parameters
    ----------
    model
        Schema of the file.
    values
        Values that the file gives.
    elsewhere
        Tables that the file does not give and that are described elsewhere: what to say in their place.

    Examples
    --------
    >>> from easeoff.cases.schema.case_schema import Steel
    >>> print(template_text(Steel, {"elastic_modulus": 210000.0}))
    elastic_modulus = 210000.0           # Young's modulus [MPa]
    #poisson_ratio = 0.3                 # Poisson's ratio
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
    """Whether a key holds a list of tables."""
    return Ellipsis in get_args(annotation)


def meaning(name: str, field: FieldInfo) -> str:
    """What a key means, its unit, and its choices if they are words."""
    words, unit = described(name, field)
    choices = allowed(name, field)
    told = plain(words) + (f" [{unit}]" if unit else "")
    if "`" in choices and "," in choices and bool not in (field.annotation, *get_args(field.annotation)):
        told += f": {plain(choices)}"
    return told


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
    """A value as it stands in TOML, in one line; a text of several lines as one of them.

    Examples
    --------
    >>> toml_value({"start": 1.0, "ends": [True, "a"]})
    '{ start = 1.0, ends = [true, "a"] }'
    """
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
