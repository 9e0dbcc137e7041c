"""Solvers of the contact problem behind one interface, one adapter a file."""

from ...core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
