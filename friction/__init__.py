"""Lubricants, film, friction coefficient, power loss and efficiency; in SI."""

from ..core.lazy_names import lazy_names
from .rolling_traction import rolling_traction as rolling_traction  # before its module takes the name

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
