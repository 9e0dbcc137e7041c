"""V-H check of a case: V and H at which the unloaded pattern is centred at toe, middle and heel, and patterns between.

V is a displacement along the offset, added to E of the misalignment; H one of the pinion along its axis, added to P.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...cases.deflection_table import MisalignmentSource
from ...cases.schema.case_schema import Case, ComplianceTable
from ...contact.evaluation.marking_print import checked_thickness
from ...core.attributes import labelled
from ...core.checks import number, two_whole, whole
from ...core.netcdf_file import write_netcdf
from ...geometry.deviation.deviation import Method
from ...geometry.pair.gear_pair import FlankName
from ...geometry.pair.modification import Modification
from ...geometry.tooth.tooth_flanks import MemberName
from ..analysis.shown_progress import shows_progress, told
from ..case_in_mesh import CaseInMesh, case_attributes, checked_case
from ..deviations.deviation_source import Deviated, Source
from .shifted_patterns import PLACES, STORED_GRID, ShiftedPatterns, found_dataset, grid_dataset
from .vh_search import Found, PatternSearch, PatternStatus

Array = NDArray[Any]

CENTRE_TOLERANCE, ESTIMATE_TOLERANCE = 2e-5, 1e-3  # of the centre, over the length of the flank
NODES = (21, 13)  # of the ease-off; more change the centre by less than 1e-5 of the face
ESTIMATE_NODES, ESTIMATE_POSITIONS, ESTIMATE_GRID = (15, 9), 16, (61, 31)
RANGE_SHARE = 0.1  # of the length of the flank: range of V and H if none is given
RANGE_LIMIT = 9.9  # [mm]
GRID_COUNT_LIMIT = 21  # of the values of V and of H in the grid


@shows_progress("V-H check", "pattern")
def vh_check(
    case: Case | str | Path,
    *,
    flank: FlankName = "drive",
    misalignment: MisalignmentSource | None = None,
    deviations: Mapping[MemberName, Source] | None = None,
    deviated: Deviated = "ease_off",
    interpolation: Method = "spline",
    modification: Modification | None = None,
    marking: float | None = None,
    share: float = 0.25,
    height: float = 0.5,
    largest: float | None = None,
    grid: tuple[int, int] | None = None,
    progress: Callable[[], None] | bool | None = None,
) -> xr.Dataset:
    """Shift V and H until the unloaded pattern is centred at toe, middle and heel, at one height of the flank.

    Parameters
    ----------
    case, flank, deviations, deviated, interpolation, modification, marking
        As of ``analyze``; no load is applied, and no elastic tooth is built.
    misalignment
        Assembly errors at V = H = 0; the case's own if left out. Of deflections, those without torque.
    share
        Place of the pattern's centre at toe and heel: its distance from the end of the tooth, over the face width.
    height
        Height of the centre, as a profile fraction of the gear flank.
    largest
        Greatest size of V and of H that is tried [mm]; a tenth of the gear's face width if left out.
    grid
        Numbers of values of V and H at which the pattern is computed besides, around those found; none if left out.
    progress
        ``True`` for a line that shows it; or a function, called after every pattern that is computed.

    Returns
    -------
    xr.Dataset
        V and H, centre, length and height of the pattern, peak to peak of the transmission error and status over
        ``place`` (toe, middle, heel); ``total_v`` and ``total_h`` from toe to heel and ``h_over_v``; with ``grid``
        the same of the patterns over ``v_grid`` and ``h_grid``; the prints of all. What is not reached is NaN.

    Raises
    ------
    InputError
        If an argument is out of range, or the case has no such flanks.
    GeometryError
        If the settings describe no tooth in the blank, or the flanks do not meet.

    Examples
    --------
    >>> found = vh_check("fh-design-a")
    >>> found["status"].values.tolist(), found["place"].values.tolist()
    ([0, 0, 0], ['toe', 'middle', 'heel'])
    >>> bool(found["v"].sel(place="toe") > 0.0 > found["v"].sel(place="heel"))
    True
    """
    case = checked_case(case)
    share = number("share", share, above=0.0, below=0.5)
    height = number("height", height, above=0.0, below=1.0)
    thickness = checked_thickness(case.contact.separation if marking is None else marking)
    counts = None if grid is None else _counts(grid)
    given: dict[str, Any] = {
        "flank": flank,
        "misalignment": misalignment,
        "deviations": deviations,
        "deviated": deviated,
        "interpolation": interpolation,
        "modification": modification,
    }
    fine = CaseInMesh.of(_unloaded(case, NODES, case.contact.mesh_positions), **given)
    coarse = CaseInMesh.of(_unloaded(case, ESTIMATE_NODES, ESTIMATE_POSITIONS), **given)
    exact = ShiftedPatterns(fine, thickness, progress=told(progress))
    estimate = ShiftedPatterns(coarse, thickness, ESTIMATE_GRID, told(progress))
    size = exact.size
    reach = RANGE_SHARE * size[0] if largest is None else number("largest", largest, "mm", above=0.0, most=RANGE_LIMIT)
    places = np.array([[share, height], [0.5, height], [1.0 - share, height]])
    found = _searched(dict(zip(PLACES, places * size, strict=True)), exact, estimate, min(float(reach), RANGE_LIMIT))
    dataset = found_dataset(found, places, exact)
    if counts is not None:
        dataset = dataset.merge(
            grid_dataset(dataset, counts, ShiftedPatterns(coarse, thickness, STORED_GRID, told(progress)))
        )
    origin = case_attributes(case, "vh_check") | fine.attributes
    units = {"separation": thickness, "attribute_units": "separation: um"}
    return labelled(dataset).assign_attrs(origin | units | dataset.attrs)


def write_vh_check(found: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a V-H check to a netCDF-4 file.

    Parameters
    ----------
    found
        Of ``vh_check``.
    path
        The file, replaced if it exists.

    Raises
    ------
    InputError
        If the file cannot be written; nothing is left behind then.
    """
    packed = {str(name): {"zlib": True, "complevel": 1} for name, one in found.data_vars.items() if one.ndim > 1}
    write_netcdf(found, path, packed)


def _counts(grid: tuple[int, int]) -> tuple[int, int]:
    of_v, of_h = two_whole("grid", grid, 2)
    return whole("grid", of_v, 2, GRID_COUNT_LIMIT), whole("grid", of_h, 2, GRID_COUNT_LIMIT)


def _unloaded(case: Case, nodes: tuple[int, int], mesh_positions: int) -> Case:
    """The case with another grid, and without elastic teeth: nothing here is loaded."""
    own = case.contact
    grid = {
        "lengthwise_nodes": min(nodes[0], own.lengthwise_nodes),
        "profile_nodes": min(nodes[1], own.profile_nodes),
        "mesh_positions": min(mesh_positions, own.mesh_positions),
    }
    return case.model_copy(
        update={"contact": own.model_copy(update=grid), "compliance": ComplianceTable(model="shell")}
    )


def _searched(
    targets: dict[str, Array], exact: ShiftedPatterns, estimate: ShiftedPatterns, reach: float
) -> dict[str, Found]:
    """What the search finds at every place: first with coarse patterns, then with the exact ones from there."""
    face = float(exact.size[0])
    rough = PatternSearch(estimate.centre, face, reach, ESTIMATE_TOLERANCE * face)
    fine = PatternSearch(exact.centre, face, reach, CENTRE_TOLERANCE * face)
    start = rough.start()
    middle = rough.find(targets["middle"], start)
    first = middle if middle.status == PatternStatus.REACHED else start
    found = {"middle": middle, **{name: rough.find(targets[name], first) for name in ("toe", "heel")}}
    reached = {name for name, one in found.items() if one.status == PatternStatus.REACHED}
    return {name: fine.find(targets[name], found[name]) if name in reached else found[name] for name in PLACES}
