"""The case fm-11x41, made again from its design: the dissertation's Table 2.1, with a blank and a target of our own.

Table 2.1 gives teeth, hands, spiral angles, offset and outer cone distances, but neither blank nor machine settings.
"""

from __future__ import annotations

from functools import cache

from easeoff.cases import Case, read_design
from easeoff.cases.conversion import ease_off_target
from easeoff.study import DesignReport, design_case

DESIGN = read_design("fm-11x41")
DRIVE = ease_off_target(DESIGN.target.drive)


@cache
def rebuild() -> tuple[Case, DesignReport]:
    """Blank, Formate gear and both pinion flanks."""
    return design_case(DESIGN)
