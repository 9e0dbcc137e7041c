"""Departures of a result's flanks from the designed ones, as text, from the attributes of its root."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from ...geometry.pair.gear_pair import MEMBERS

TERM_COUNT_LIMIT = 5  # of a modification, the largest first; more are counted


def deviations(attributes: Mapping[Any, Any]) -> str:
    """Largest deviations of the flanks, and how they were taken in; empty if there are none.

    >>> deviations({"deviated": "surface", "largest_deviation_gear_um": 8.4})
    'gear up to 8.4 um, surfaces recomputed'
    """
    names = {member: f"largest_deviation_{member}_um" for member in MEMBERS}
    parts = [f"{member} up to {attributes[name]:.3g} um" for member, name in names.items() if name in attributes]
    way = {"ease_off": "ease-off updated", "surface": "surfaces recomputed"}.get(attributes.get("deviated", ""))
    return ", ".join([*parts, way] if parts and way else parts)


def modification(attributes: Mapping[Any, Any]) -> str:
    """Modification of the ease-off; empty if there is none.

    >>> modification({"modification_um": '{"bias": -3.0, "lengthwise_crowning": 10.0}'})
    'lengthwise crowning +10 um, bias -3 um'
    """
    terms = json.loads(str(attributes.get("modification_um", "{}")))
    largest = sorted(((n, v) for n, v in terms.items() if v), key=lambda term: -abs(term[1]))
    words = [f"{name.replace('_', ' ')} {value:+.3g} um" for name, value in largest[:TERM_COUNT_LIMIT]]
    left = len(largest) - len(words)
    return ", ".join([*words, f"{left} more terms"] if left else words)
