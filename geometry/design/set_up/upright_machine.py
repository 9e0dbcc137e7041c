"""The machine without tilt: its root angle along the root cone of the pinion, its tip plane through that cone's apex.

The tip plane of the cutter stands still while the cradle turns. Seen from the work it envelops a cone with the machine
root angle whose apex is where the work axis meets the plane: the root of the tooth lies on it, whatever else is set.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ...cutting.generating_surface import GeneratingSurface
from ...cutting.named_settings import get_setting, with_settings
from ..blank import BlankDimensions
from ..ease_off_residual import Tie

CENTER = "machine_center_to_crossing_point"


def root_tie(blank: BlankDimensions, free: Sequence[str]) -> Tie | None:
    """The sliding base that keeps the root on its cone, where nothing but the machine centre moves it.

    Without tilt, and with the machine root angle of the blank, the tip plane of the cutter envelops the root cone: it
    has to pass through the apex of that cone. ``None`` if the sliding base is free.
    """
    if "sliding_base" in free:
        return None
    root = blank.pinion

    def tie(values: Mapping[str, float]) -> Mapping[str, float]:
        center = values[CENTER]
        return {"sliding_base": (root.root_apex - center) * math.sin(root.root_angle)}

    return tie


def along_the_root(surface: GeneratingSurface, blank: BlankDimensions) -> GeneratingSurface:
    """A pinion flank's machine without tilt, its root angle that of the blank and its tip plane through the root apex.

    Parameters
    ----------
    surface
        The flank, see ``crown_gear_pinion``.
    blank
        Dimensions of the pair.
    """
    tie = root_tie(blank, ())
    assert tie is not None
    values = {CENTER: get_setting(surface, CENTER)}
    upright = {"cutter_tilt": 0.0, "cutter_swivel": 0.0, "machine_root_angle": blank.pinion.root_angle}
    return with_settings(surface, {**upright, **tie(values)})
