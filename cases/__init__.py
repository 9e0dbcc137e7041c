"""Case and design files: schemas, reading, checking and writing, the shipped ones, exchange with other programs.

To ship a case:

1. ``cases/NAME.toml``; the head says where each number comes from, and what was converted or chosen. Units and signs as
   in ``docs/how_it_works/conventions.md``.
2. All four flanks if they are known. If the pinion was fitted, the target in ``[target.drive]`` and ``[target.coast]``.
3. Tests: the case reads, its flanks hit the published points or its ease-off the target, and every mesh position at
   every torque is certified, drive and coast.
4. A line in the changelog; what it was compared with goes into ``docs/how_it_works/validation.md``.
"""

from ..core.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
