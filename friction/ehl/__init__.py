"""Mixed elastohydrodynamic lubrication of a line contact: film, rough surfaces, friction."""

from ...core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
