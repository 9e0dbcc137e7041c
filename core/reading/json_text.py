"""JSON whose every fault is a ``ValueError``."""

from __future__ import annotations

import json
from typing import Any

DIGIT_COUNT_LIMIT = 300  # of a whole number; one of more may be greater than any floating-point number


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
        return json.loads(text, parse_int=_whole_number)
    except RecursionError as error:
        raise ValueError("nested too deeply") from error


def _whole_number(digits: str) -> int:
    if len(digits) > DIGIT_COUNT_LIMIT:
        raise ValueError(f"a whole number of {len(digits)} digits")
    return int(digits)
