"""Greatest pressure at the end of a contact line, for run, show, report and notebook."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ....contact.evaluation.pressure_map import LineEnd, max_inner_pressure

#: Part by which the greatest pressure at a line's end depends on where segments and mesh positions lie.
END_UNCERTAINTY = 0.06
INSIDE = (LineEnd.INSIDE, LineEnd.UNKNOWN)
#: Part by which a line load is too low at an end of one member's tooth beyond which the other's goes on.
TOO_LOW = 0.08
TOOTH_ENDS = (LineEnd.GEAR_TOE, LineEnd.GEAR_HEEL, LineEnd.PINION_TOE, LineEnd.PINION_HEEL)


def end_notes(loaded: xr.Dataset) -> list[str]:
    """Note on the torque whose greatest pressure is at the end of a contact line and exceeds that inside most.

    Parameters
    ----------
    loaded
        The group ``/loaded``.

    Returns
    -------
    list of str
        One note; none if the greatest pressures are inside, or the result is too old to tell.

    Examples
    --------
    >>> import easeoff
    >>> (note,) = end_notes(easeoff.analyze("nasa-12x36", torques=[100.0])["loaded"].to_dataset())
    >>> note.partition(" MPa")[2].partition(":")[0]
    ', is at the end of a contact line (pinion tip)'
    """
    if "max_pressure_line_end" not in loaded:
        return []
    torques, greatest = loaded["torque"].values, loaded["max_pressure"].values
    ends = [LineEnd(int(value)) for value in loaded["max_pressure_line_end"].values]
    inner = max_inner_pressure(loaded)
    excess = np.nan_to_num(greatest / inner - 1.0, nan=0.0)
    told = [number for number, end in enumerate(ends) if end not in INSIDE]
    if not told:
        return []
    most = max(told, key=lambda number: (excess[number], greatest[number]))
    above = "no pressure is inside"
    if np.isfinite(inner[most]):
        above = f"{100.0 * max(excess[most], 0.0):.0f} % above the greatest inside, {inner[most]:.0f} MPa"
    more = f"; likewise at {', '.join(f'{torques[n]:g}' for n in told if n != most)} N m" if len(told) > 1 else ""
    place = ends[most].name.lower().replace("_", " ")
    low = ""
    if ends[most] in TOOTH_ENDS:
        low = f", and up to some {100 * TOO_LOW:.0f} % too low where the mate's tooth goes on beyond this end"
    return [
        f"Note: at {torques[most]:g} N m the greatest pressure, {greatest[most]:.0f} MPa, is at the end of a contact "
        f"line ({place}): {above}; there it is uncertain by up to some {100 * END_UNCERTAINTY:.0f} %{low}; "
        f"a real edge is rounded{more}."
    ]
