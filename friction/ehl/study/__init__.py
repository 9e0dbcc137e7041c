"""The parameter study of the film model, and the friction formula fitted to it."""

from ....core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
