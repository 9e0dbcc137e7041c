"""Cutter radii that were given in inches: absurdly small beside the member, and usual after conversion."""

from __future__ import annotations

from ...core.errors import InputError
from .blank_design_table import BlankDesignTable

INCH = 25.4  # [mm]
#: Radius of the cutter over the gear's pitch radius: what is absurd, what is usual.
ABSURD_RATIO, USUAL_RATIOS = 0.15, (0.25, 3.0)


def refuse_inches(table: BlankDesignTable) -> None:
    """Refuse a cutter radius in inches among basic data.

    Raises
    ------
    InputError
        With the radius in mm.

    Examples
    --------
    >>> from easeoff.cases import read_design
    >>> refuse_inches(read_design("fm-11x41").blank_design)
    """
    diameter = table.gear_outer_pitch_diameter or table.gear_mean_pitch_diameter
    if diameter is None:
        return
    radius, ratio = table.cutter_radius, 2.0 * table.cutter_radius / diameter
    if ratio < ABSURD_RATIO and USUAL_RATIOS[0] <= INCH * ratio <= USUAL_RATIOS[1]:
        raise InputError(
            f"[blank_design] cutter_radius = {radius:g}: must be in mm, and is absurdly small for a pair of this size; "
            f"{radius:g} in is {INCH * radius:.6g} mm"
        )
