"""Tooth compliance, in replaceable pieces: shell, root foundation, local line contact."""

from .elastic_foundation import ElasticFoundation
from .material import Material
from .shell import Shell
from .tooth_dimensions import ToothDimensions
from .weber_line_contact import FOOT_OF_NORMAL_CORRECTION, WeberLineContact

__all__ = [
    "FOOT_OF_NORMAL_CORRECTION",
    "ElasticFoundation",
    "Material",
    "Shell",
    "ToothDimensions",
    "WeberLineContact",
]
