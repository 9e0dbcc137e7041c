"""Small cases whose teeth are plates: for what has nothing to do with how teeth bend."""

from __future__ import annotations

from typing import Any

from runs import small

from easeoff.cases.schema.case_schema import Case


def on_plates(name: str = "fm-11x41", **contact: Any) -> Case:
    """A small case on plates; other keys of [contact] by name."""
    case = small(name, **contact)
    return case.model_copy(update={"compliance": case.compliance.model_copy(update={"model": "shell"})})
