"""Studies of a pair: analysis, sweeps, design, optimisation, wear, reports, pictures, solver comparison, commands.

``easeoff.analyze``, ``modify`` and ``optimize`` stand at the top of the package; all names here are imported on first
use.
"""

from ..core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
