"""A case as the text of a case file."""

from __future__ import annotations

from typing import Any

import tomli_w

from .model import Case


def case_toml(case: Case) -> str:
    """Text of a case file that reads back as the same case; what has its default value is left out.

    Parameters
    ----------
    case
        A checked case.
    """
    data = _without_empty_tables(case.model_dump(mode="json", exclude_defaults=True))
    data.setdefault("pair", {})
    return tomli_w.dumps(data, multiline_strings=True)


def _without_empty_tables(table: dict[str, Any]) -> dict[str, Any]:
    inner = {key: _without_empty_tables(value) if isinstance(value, dict) else value for key, value in table.items()}
    return {key: value for key, value in inner.items() if value is not None and value != {}}
