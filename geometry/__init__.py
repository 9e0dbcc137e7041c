"""Tooth flanks, blanks, ease-off and surface of roll angle: geometry alone, no loads."""

from ..core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
