"""Sweeps: a case analysed over grids, samples and load cases, and what is read off the numbers."""

from ...core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
