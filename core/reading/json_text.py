"""JSON whose every fault is a ``ValueError``."""

from __future__ import annotations

import json
from typing import Any


def parsed_json(text: str) -> Any:
    """Value of a JSON text.

    Raises
    ------
    ValueError
        If it is no JSON, is nested too deeply, or has a number of too many digits.

    Examples
    --------
    >>> parsed_json('{"bias": 1.5}')
    {'bias': 1.5}
    >>> try:
    ...     parsed_json("[" * 100_000)
    ... except ValueError as error:
    ...     print(error)
    nested too deeply
    """
    try:
        return json.loads(text)
    except RecursionError as error:
        raise ValueError("nested too deeply") from error
