"""Table of a V-H check, as text."""

from __future__ import annotations

import numpy as np
import xarray as xr
from tabulate import tabulate

HEADERS = ("", "V\nmm", "H\nmm", "centre at\ntoe %, root %", "from, to\ntoe %", "height\n%", "peak to\npeak urad")
#: What V and H are positive for, one phrase each.
SIGNS = ("V positive: the offset grows (E)", "H positive: pinion away from the crossing point (P)")


def vh_table(found: xr.Dataset) -> str:
    """V and H at toe, middle and heel with the patterns there, their totals, and why a place was not reached.

    Parameters
    ----------
    found
        Of ``study.vh_check``.

    Examples
    --------
    >>> from easeoff.study import vh_check
    >>> print(vh_table(vh_check("fh-design-a")).splitlines()[-1].partition(":")[0])
    toe to heel
    """
    table = tabulate(vh_rows(found), headers=HEADERS, disable_numparse=True, colalign=("left", *("right",) * 6))
    lines = [table, *reasons(found), "", totals(found)]
    return "\n".join(lines)


def vh_rows(found: xr.Dataset) -> list[tuple[str, ...]]:
    """Cells of the table, a row a place; of one that was not reached its name and these words alone."""
    rows: list[tuple[str, ...]] = []
    for place in found["place"].values:
        one = found.sel(place=place)
        value = {str(name): variable.item() for name, variable in one.data_vars.items() if not variable.ndim}
        if np.isnan(value["v"]):
            rows.append((str(place), "not reached"))
            continue
        centre = (value["pattern_centre_lengthwise"], value["pattern_centre_profile"])
        rows.append(
            (
                str(place),
                f"{value['v']:+.3f}",
                f"{value['h']:+.3f}",
                "{:.1f}, {:.1f}".format(*(100.0 * part for part in centre)),
                "{:.0f}, {:.0f}".format(*(100.0 * value[name] for name in ("pattern_from", "pattern_to"))),
                f"{100.0 * value['pattern_height']:.0f}",
                f"{value['peak_to_peak']:.1f}",
            )
        )
    return rows


def reasons(found: xr.Dataset) -> list[str]:
    """Lines on the places that were not reached."""
    names = [f"reason_{place}" for place in found["place"].values]
    return [f"{name.removeprefix('reason_')}: {found.attrs[name]}" for name in names if name in found.attrs]


def totals(found: xr.Dataset) -> str:
    """Total V, total H and H/V in one line."""
    v, h, ratio = (float(found[name]) for name in ("total_v", "total_h", "h_over_v"))
    if np.isnan(v):
        return "toe to heel: unknown, as toe and heel were not both reached"
    return f"toe to heel: total V {v:+.3f} mm, total H {h:+.3f} mm, H/V {ratio:+.3f}"
