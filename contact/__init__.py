"""Unloaded and loaded tooth contact: curves, compliance, the contact problem and its solvers.

The contact problem stands on its own: ``ContactProblem``, ``solve`` and ``certify`` need no gear.
"""

from ..core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
