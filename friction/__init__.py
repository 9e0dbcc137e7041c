"""Lubricants, film, friction coefficient, power loss and efficiency; in SI."""

from ..core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
