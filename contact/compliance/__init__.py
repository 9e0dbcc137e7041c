"""Tooth compliance, in replaceable pieces: shell, root foundation, local line contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .elastic_foundation import ElasticFoundation
    from .half_space_cells import HalfSpaceCompliance
    from .material import Material
    from .shell import Shell
    from .tooth_dimensions import ToothDimensions

__all__ = [
    "ElasticFoundation",
    "HalfSpaceCompliance",
    "Material",
    "Shell",
    "ToothDimensions",
]

_ORIGINS = {
    ".elastic_foundation": ["ElasticFoundation"],
    ".half_space_cells": ["HalfSpaceCompliance"],
    ".material": ["Material"],
    ".shell": ["Shell"],
    ".tooth_dimensions": ["ToothDimensions"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
