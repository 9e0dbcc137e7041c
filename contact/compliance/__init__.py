"""Tooth compliance, in replaceable pieces: shell, root foundation, local line contact."""

from .foundation import ElasticFoundation
from .hertz import FOOT_OF_NORMAL_CORRECTION, WeberLineContact
from .material import Material
from .shell import Shell
from .tooth import ToothDimensions

__all__ = [
    "FOOT_OF_NORMAL_CORRECTION",
    "ElasticFoundation",
    "Material",
    "Shell",
    "ToothDimensions",
    "WeberLineContact",
]
