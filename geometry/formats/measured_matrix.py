"""Measured grids from plain matrices of deviations."""

from __future__ import annotations

import xarray as xr
from numpy.typing import ArrayLike

from ...core.checks import instance
from ..pair.gear_pair import Member
from ..tooth.tooth_flanks import Side, side
from .deviation_table import table_of_matrix
from .measured_grid import measured_grid
from .measuring_points import EdgeMargins


def measured_matrix(
    member: Member,
    deviation: ArrayLike,
    flank: Side | None = None,
    *,
    rows: str = "root to tip",
    columns: str = "toe to heel",
    deviation_unit: str = "um",
    edge_margins: EdgeMargins | None = None,
) -> xr.Dataset:
    """A measured grid from a plain matrix of deviations, at the points of ``cmm_points``.

    Parameters
    ----------
    member
        The member as designed.
    deviation
        Deviations over rows and columns, positive where there is more metal.
    flank
        ``concave`` or ``convex``; the loaded flank if left out.
    rows, columns
        ``root to tip`` or ``tip to root``, and ``toe to heel`` or ``heel to toe``; rows and columns may be exchanged.
    deviation_unit
        ``um`` or ``mm``.
    edge_margins
        Strips left out at the edges of the flank; a tenth if left out.

    Raises
    ------
    InputError
        If the matrix cannot be used, or the words do not say how it lies.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> gear = gear_pair(read_case("nasa-12x36")).gear
    >>> grid = measured_matrix(gear, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], rows="tip to root")
    >>> float(grid["deviation"].sel(flank="convex", row=1, column=3))  # at root and heel
    6.0
    """
    instance("member", member, Member)
    instance("edge_margins", edge_margins, EdgeMargins | None)
    table = table_of_matrix(
        deviation,
        side(member.loaded) if flank is None else flank,
        rows=rows,
        columns=columns,
        deviation_unit=deviation_unit,
        margins=edge_margins,
    )
    return measured_grid(table.points(member), table.deviation)
