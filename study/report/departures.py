"""In words: how the flanks of a result depart from the designed ones, from the attributes of its root."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

MEMBERS = ("pinion", "gear")
MOST_TERMS = 5  # of a modification, the largest first; more are counted


def deviations(attributes: Mapping[Any, Any]) -> str:
    """How far the flanks deviate and how that was taken in; empty if they do not.

    >>> deviations({"deviated": "surface", "largest_deviation_gear_um": 8.4})
    'gear up to 8.4 um, surfaces recomputed'
    """
    names = {member: f"largest_deviation_{member}_um" for member in MEMBERS}
    parts = [f"{member} up to {attributes[name]:.3g} um" for member, name in names.items() if name in attributes]
    way = {"ease_off": "ease-off updated", "surface": "surfaces recomputed"}.get(attributes.get("deviated", ""))
    return ", ".join([*parts, way] if parts and way else parts)


def modification(attributes: Mapping[Any, Any]) -> str:
    """What was added to the ease-off; empty if nothing was.

    >>> modification({"modification_um": '{"bias": -3.0, "lengthwise_crowning": 10.0}'})
    'lengthwise crowning +10 um, bias -3 um'
    """
    terms = json.loads(str(attributes.get("modification_um", "{}")))
    largest = sorted(((n, v) for n, v in terms.items() if v), key=lambda term: -abs(term[1]))
    words = [f"{name.replace('_', ' ')} {value:+.3g} um" for name, value in largest[:MOST_TERMS]]
    left = len(largest) - len(words)
    return ", ".join([*words, f"{left} more terms"] if left else words)
