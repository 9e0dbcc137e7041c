"""Elastic model of a result, as text, from the attributes of its root."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

MODEL_NAMES = {"shell": "shell", "solid_shell": "solid shell", "fe": "finite elements"}


def model_name(attributes: Mapping[Any, Any]) -> str:
    """Elastic model and whether edges touch; of a result of an older version what it says.

    >>> model_name({"compliance_model": "solid_shell", "edge_contact": 1})
    'solid shell, edges'
    """
    model = str(attributes.get("compliance_model", ""))
    edges = {1: "edges", 0: "lines only"}.get(int(attributes.get("edge_contact", -1)), "")
    return ", ".join(part for part in (MODEL_NAMES.get(model, model), edges) if part)
