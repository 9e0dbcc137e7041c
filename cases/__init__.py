"""Case and design files: schemas, reading, checking and writing, the shipped ones, exchange with other programs."""

from ..core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
