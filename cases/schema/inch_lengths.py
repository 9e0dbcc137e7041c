"""Cutter radii that were given in inches: absurdly small beside the member, and usual after conversion."""

from __future__ import annotations

from collections.abc import Iterator

from ...core.errors import InputError
from .case_schema import Case
from .design_schema import Design

INCH = 25.4  # [mm]
#: Radius of the cutter over the outer cone distance, or over the gear's pitch radius: what is absurd, what is usual.
ABSURD_RATIO, USUAL_RATIOS = 0.15, (0.25, 3.0)


def refuse_inches(found: Case | Design) -> None:
    """Refuse the radius of a cutter in inches.

    Raises
    ------
    InputError
        With the radius in mm.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> refuse_inches(read_case("nasa-12x36"))
    """
    for key, radius, size in _radii(found):
        ratio = radius / size
        if ratio < ABSURD_RATIO and USUAL_RATIOS[0] <= INCH * ratio <= USUAL_RATIOS[1]:
            raise InputError(
                f"{key} = {radius:g}: must be in mm, and is absurdly small for a pair of this size; {radius:g} in is "
                f"{INCH * radius:.6g} mm"
            )


def _radii(found: Case | Design) -> Iterator[tuple[str, float, float]]:
    """Key, radius of a cutter and size of the member that it cuts [mm], as far as both are given."""
    table = found.blank_design
    diameter = None if table is None else table.gear_outer_pitch_diameter or table.gear_mean_pitch_diameter
    if table is not None and diameter is not None:
        yield "blank_design.cutter_radius", table.cutter_radius, 0.5 * diameter
    if isinstance(found, Design):
        return
    for name, member in (("pinion", found.pinion), ("gear", found.gear)):
        size = (
            member.blank.outer_cone_distance if member.blank is not None else None if not diameter else 0.5 * diameter
        )
        for side, flank in (("concave", member.concave), ("convex", member.convex)):
            if flank is not None and size is not None:
                yield f"{name}.{side}.cutter.blade_point_radius", flank.cutter.blade_point_radius, size
