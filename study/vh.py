"""V-H check of a case: V and H at which the unloaded pattern is centred at toe, middle and heel, and patterns between.

V is a displacement along the offset, added to E of the misalignment; H one of the pinion along its axis, added to P.

The search is Newton's method with Broyden's update of the derivatives: an evaluation is a whole unloaded analysis, and
the centre moves smoothly with V and H until the edges of the teeth cut the pattern. Steps are shortened until they lead
nearer.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ..cases.deflection_table import MisalignmentSource
from ..cases.schema.case_schema import Case, ComplianceTable
from ..contact.evaluation.flank_region import ProjectionPlane
from ..contact.evaluation.marking_print import PRINT_GRID, UnloadedPattern, checked_thickness
from ..core.arrays import Array, record
from ..core.attributes import StoredStatus, labelled
from ..core.checks import number, two_whole, whole
from ..core.errors import GeometryError
from ..core.netcdf_file import write_netcdf
from ..geometry.deviation.deviation import Method
from ..geometry.pair.gear_pair import FlankName
from ..geometry.pair.modification import Modification
from ..geometry.tooth.tooth_flanks import MemberName
from .case_in_mesh import CaseInMesh, FlanksInMesh, case_attributes, checked_case
from .deviations import Deviated, Source
from .progress import callback, shows_progress
from .result import PATTERN

#: Centre of the pattern (2) [mm], along the face and the profile, at displacements V and H (2) [mm]; NaN for none.
Centre = Callable[[Array], Array]

HALVING_COUNT_LIMIT = 4  # of a step that does not lead nearer
EVALUATION_COUNT_LIMIT = 40  # of the centre, in one search
LEAST_DECREASE = 0.05  # of the distance that a step must take off, as a share
STEP_SHARE = 0.01  # of the face; the longest step
DIFFERENCE_SHARE = 4e-4  # of the face; a step of V and H for derivatives
SHORT_SHARE = 1e-4  # of the face; shorter steps say nothing of the derivatives, the print has corners


class PatternStatus(StoredStatus):
    """End of the search for a place of the pattern."""

    REACHED = 0
    NO_PATTERN = 1
    OUT_OF_RANGE = 2
    NOT_REACHED = 3


REASONS = {
    PatternStatus.REACHED: "",
    PatternStatus.NO_PATTERN: "there is no pattern at V = H = 0 to start from",
    PatternStatus.OUT_OF_RANGE: "V or H would exceed the range",
    PatternStatus.NOT_REACHED: "the pattern comes no nearer: it leaves the flank, or edges cut it off",
}


@record(frozen=True)
class Found:
    """The nearest place that a search came to."""

    displacement: Array  # V and H (2) [mm]
    centre: Array  # of the pattern (2) [mm]
    slope: Array  # last known derivatives (2, 2) of the centre by V and H
    status: PatternStatus

    def distance(self, target: Array) -> float:
        """Distance from a place [mm]."""
        return float(np.linalg.norm(self.centre - target))


@dataclass
class PatternSearch:
    """Search of V and H for a place of the pattern, with one way to compute its centre."""

    centre: Centre
    face: float  # length of the flank [mm]
    reach: float  # greatest size of V and of H [mm]
    tolerance: float  # greatest distance of the centre from its place [mm]
    evaluations: int = field(default=0, init=False)

    def start(self, displacement: Array | None = None) -> Found:
        """Centre and its derivatives, by differences, at displacements (2) [mm]; at none if left out."""
        shift = np.zeros(2) if displacement is None else displacement
        centre = self._centre(shift)
        if not np.all(np.isfinite(centre)):
            return Found(shift, centre, np.full((2, 2), np.nan), PatternStatus.NO_PATTERN)
        slope = self._slope(shift, centre)
        known = bool(np.all(np.isfinite(slope)))
        return Found(shift, centre, slope, PatternStatus.NOT_REACHED if known else PatternStatus.NO_PATTERN)

    def find(self, target: Array, start: Found) -> Found:
        """Displacements at which the centre is at a place (2) [mm], from where another search ended."""
        if start.status == PatternStatus.NO_PATTERN:
            return start
        shift, centre, slope = start.displacement, self._centre(start.displacement), start.slope
        if not np.all(np.isfinite(centre)):
            return Found(shift, centre, slope, PatternStatus.NO_PATTERN)
        last, fresh, was_cut = self.evaluations + EVALUATION_COUNT_LIMIT, False, False
        while np.linalg.norm(centre - target) > self.tolerance:
            step, cut = self._step(shift, target - centre, slope)
            if cut and was_cut:
                return Found(shift, centre, slope, PatternStatus.OUT_OF_RANGE)
            was_cut, moved = cut, None
            for _ in range(HALVING_COUNT_LIMIT):
                trial = self._centre(shift + step)
                if np.all(np.isfinite(trial)):
                    if np.linalg.norm(step) > SHORT_SHARE * self.face:
                        slope = slope + np.outer(trial - centre - slope @ step, step) / (step @ step)
                    nearer = np.linalg.norm(trial - target) <= (1.0 - LEAST_DECREASE) * np.linalg.norm(centre - target)
                    if nearer:
                        moved = shift + step, trial
                        break
                step = 0.5 * step
            if moved is not None:
                (shift, centre), fresh = moved, False
            elif cut or fresh or self.evaluations >= last:
                return Found(shift, centre, slope, PatternStatus.OUT_OF_RANGE if cut else PatternStatus.NOT_REACHED)
            else:
                taken = self._slope(shift, centre)
                if not np.all(np.isfinite(taken)):
                    return Found(shift, centre, slope, PatternStatus.NOT_REACHED)
                slope, fresh = taken, True
        return Found(shift, centre, slope, PatternStatus.REACHED)

    def _centre(self, displacement: Array) -> Array:
        self.evaluations += 1
        return self.centre(displacement)

    def _slope(self, known: Array, centre: Array) -> Array:
        """Derivatives (2, 2) of the centre by V and H, forward."""
        size = DIFFERENCE_SHARE * self.face
        return np.stack([(self._centre(known + step) - centre) / size for step in size * np.eye(2)], axis=1)

    def _step(self, centre: Array, wanted: Array, slope: Array) -> tuple[Array, bool]:
        """Step (2) towards a change of the centre (2), not too long and within the range; whether that cut it."""
        step = np.linalg.lstsq(slope, wanted, rcond=1e-6)[0]
        longest = STEP_SHARE * self.face
        step = step * min(1.0, longest / max(float(np.linalg.norm(step)), 1e-300))
        cut = bool(np.any(np.abs(centre + step) > self.reach))
        return (np.clip(centre + step, -self.reach, self.reach) - centre, True) if cut else (step, False)


PLACES = ("toe", "middle", "heel")
STORED_GRID = (121, 61)  # points of a stored print along the face and the profile; every second of an exact one
GRID_MARGIN = 0.1  # of the range of V and of H that was found, beyond it on both sides of the grid
ROUND_FACTORS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0)  # times a power of ten, of a step
ROUNDING = 1e-9  # of a step
GRID_MINIMUM = 0.004  # of the length of the flank, to both sides: the grid is no smaller


@dataclass
class ShiftedPatterns:
    """Unloaded patterns of a pair at V and H, each computed once."""

    state: CaseInMesh
    thickness: float  # of the marking compound [um]
    shape: tuple[int, int] = PRINT_GRID
    progress: Callable[[], None] | None = None
    known: dict[tuple[float, float], UnloadedPattern | None] = field(default_factory=dict, init=False)

    @property
    def plane(self) -> ProjectionPlane:
        """Projection plane of the gear flank."""
        return ProjectionPlane.of(self.state.unmodified.geometry.flanks)

    @property
    def size(self) -> Array:
        """Length of the gear flank at mid height and its height at mid face (2) [mm]."""
        toe, heel, root, tip = self.plane(np.array([[0.0, 1.0, 0.5, 0.5], [0.5, 0.5, 0.0, 1.0]])).T
        return np.array([np.linalg.norm(heel - toe), np.linalg.norm(tip - root)])

    def at(self, displacement: Array) -> UnloadedPattern | None:
        """Pattern at V and H (2) [mm]; ``None`` if the flanks do not meet."""
        v, h = map(float, displacement)
        if (v, h) not in self.known:
            self.known[v, h] = self._computed(v, h)
            if self.progress is not None:
                self.progress()
        return self.known[v, h]

    def _computed(self, v: float, h: float) -> UnloadedPattern | None:
        base = self.state.pair.assembly.misalignment
        errors = replace(base, offset=base.offset + v, pinion_axial=base.pinion_axial + h)
        try:
            return UnloadedPattern.of(self.state.misaligned(errors).cycle, self.thickness, self.shape)
        except GeometryError:
            return None

    def centre(self, displacement: Array) -> Array:
        """Centre of the pattern (2) [mm]; NaN if there is none."""
        pattern = self.at(displacement)
        return np.full(2, np.nan) if pattern is None else np.asarray(pattern.region.centre * self.size)


def found_dataset(searches: Mapping[str, Found], places: Array, patterns: ShiftedPatterns) -> xr.Dataset:
    """Results of the search at the places (3, 2), as fractions; NaN where the pattern cannot be brought there."""
    shifts = np.array([one.displacement for one in searches.values()])
    shifts[[one.status != PatternStatus.REACHED for one in searches.values()]] = np.nan
    numbers, prints = _numbers([patterns.at(shift) if np.all(np.isfinite(shift)) else None for shift in shifts])
    total = shifts[-1] - shifts[0]
    meanings = PatternStatus.flag_attributes() | {"long_name": "how the search for the place ended"}
    data: dict[str, Any] = {
        "v": ("place", shifts[:, 0]),
        "h": ("place", shifts[:, 1]),
        "place_lengthwise": ("place", places[:, 0]),
        "place_profile": ("place", places[:, 1]),
        **{name: ("place", values) for name, values in numbers.items()},
        "status": ("place", np.array([one.status for one in searches.values()], dtype=np.int8), meanings),
        "total_v": total[0],
        "total_h": total[1],
        "h_over_v": total[1] / total[0] if total[0] else np.nan,
        "print_excess": (("place", "lengthwise", "profile"), prints),
    }
    axes = [np.linspace(0.0, 1.0, n) for n in STORED_GRID]
    in_plane = patterns.plane(np.stack(np.meshgrid(*axes, indexing="ij")))
    reasons = {f"reason_{name}": _reason(one, patterns.size) for name, one in searches.items() if REASONS[one.status]}
    data["in_plane"] = (("plane_axis", "lengthwise", "profile"), in_plane)
    coords = {"place": list(PLACES), "plane_axis": ["along", "across"], "lengthwise": axes[0], "profile": axes[1]}
    return xr.Dataset(data, coords, reasons)


def _reason(search: Found, size: Array) -> str:
    """Reason why a place is not reached, and the nearest pattern."""
    said = REASONS[search.status]
    if not np.all(np.isfinite(search.centre)):
        return said
    (v, h), (along, up) = search.displacement, 100.0 * search.centre / size
    return f"{said}; nearest: centre {along:.1f}, {up:.1f} % from toe, root at V = {v:.4f}, H = {h:.4f} mm"


def grid_dataset(check: xr.Dataset, counts: tuple[int, int], patterns: ShiftedPatterns) -> xr.Dataset:
    """Patterns at round, even values of V and H around those that were found, and around zero."""
    face = float(patterns.size[0])
    axes = []
    for name, count in zip(("v", "h"), counts, strict=True):
        values = np.append(check[name].values[np.isfinite(check[name].values)], 0.0)
        margin = max(GRID_MARGIN * float(np.ptp(values)), GRID_MINIMUM * face)
        axes.append(round_values(values.min() - margin, values.max() + margin, count))
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    numbers, prints = _numbers([patterns.at(point) for point in points.reshape(-1, 2)])
    dimensions = ("v_grid", "h_grid")
    data: dict[str, Any] = {f"grid_{name}": (dimensions, values.reshape(counts)) for name, values in numbers.items()}
    data["grid_print_excess"] = ((*dimensions, "lengthwise", "profile"), prints.reshape(*counts, *STORED_GRID))
    return xr.Dataset(data, coords=dict(zip(dimensions, axes, strict=True)))


def round_values(low: float, high: float, count: int) -> Array:
    """Multiples (count) of half a round step, the smallest that reach from ``low`` or below to ``high``."""
    decade = 10.0 ** np.floor(np.log10((high - low) / (count - 1)))
    for step in (factor * ten * decade for ten in (1.0, 10.0) for factor in ROUND_FACTORS):
        for offset in (0.0, 0.5):  # an even number of values may be even about zero
            first = np.floor(low / step - offset + ROUNDING) + offset
            if (first + count - 1) * step >= high - ROUNDING * step:
                return np.asarray(np.round((first + np.arange(count)) * step, 12))
    return np.linspace(low, high, count)


def _numbers(patterns: list[UnloadedPattern | None]) -> tuple[dict[str, Array], Array]:
    """Numbers (n) of patterns by name, and their prints (n, *STORED_GRID); NaN of those that are missing."""
    rows, prints = [], []
    for pattern in patterns:
        if pattern is None:
            rows.append(np.full(7, np.nan))
            prints.append(np.full(STORED_GRID, np.nan))
            continue
        region, excess = pattern.region, pattern.printed.excess
        rows.append(np.array([*region.centre, *region.size, *region.extent[0], pattern.peak_to_peak]))
        coarser = [(n - 1) // (stored - 1) for n, stored in zip(excess.shape, STORED_GRID, strict=True)]
        prints.append(excess[:: coarser[0], :: coarser[1]])
    names = (*PATTERN, "pattern_from", "pattern_to", "peak_to_peak")
    return dict(zip(names, np.array(rows).T, strict=True)), np.array(prints)


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
    >>> check = vh_check("fh-design-a")
    >>> check["status"].values.tolist(), check["place"].values.tolist()
    ([0, 0, 0], ['toe', 'middle', 'heel'])
    >>> bool(check["v"].sel(place="toe") > 0.0 > check["v"].sel(place="heel"))
    True
    """
    case = checked_case(case)
    share = number("share", share, above=0.0, below=0.5)
    height = number("height", height, above=0.0, below=1.0)
    thickness = checked_thickness(case.contact.separation if marking is None else marking)
    counts = None if grid is None else _counts(grid)
    given = FlanksInMesh(flank, misalignment, deviations, deviated, interpolation, modification)
    fine = CaseInMesh.meshed(_unloaded(case, NODES, case.contact.mesh_positions), given)
    coarse = CaseInMesh.meshed(_unloaded(case, ESTIMATE_NODES, ESTIMATE_POSITIONS), given)
    exact = ShiftedPatterns(fine, thickness, progress=callback(progress))
    estimate = ShiftedPatterns(coarse, thickness, ESTIMATE_GRID, callback(progress))
    size = exact.size
    reach = RANGE_SHARE * size[0] if largest is None else number("largest", largest, "mm", above=0.0, most=RANGE_LIMIT)
    places = np.array([[share, height], [0.5, height], [1.0 - share, height]])
    searches = _searched(dict(zip(PLACES, places * size, strict=True)), exact, estimate, min(float(reach), RANGE_LIMIT))
    dataset = found_dataset(searches, places, exact)
    if counts is not None:
        dataset = dataset.merge(
            grid_dataset(dataset, counts, ShiftedPatterns(coarse, thickness, STORED_GRID, callback(progress)))
        )
    origin = case_attributes(case, "vh_check") | fine.attributes
    units = {"separation": thickness, "attribute_units": "separation: um"}
    return labelled(dataset).assign_attrs(origin | units | dataset.attrs)


def write_vh_check(check: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a V-H check to a netCDF-4 file, whole or not at all."""
    write_netcdf(check, path)


def _counts(grid: tuple[int, int]) -> tuple[int, int]:
    of_v, of_h = two_whole("grid", grid, 2)
    return whole("grid", of_v, 2, GRID_COUNT_LIMIT), whole("grid", of_h, 2, GRID_COUNT_LIMIT)


def _unloaded(case: Case, nodes: tuple[int, int], mesh_positions: int) -> Case:
    """The case with another grid, and without elastic teeth: nothing here is loaded."""
    contact = case.contact
    grid = {
        "lengthwise_nodes": min(nodes[0], contact.lengthwise_nodes),
        "profile_nodes": min(nodes[1], contact.profile_nodes),
        "mesh_positions": min(mesh_positions, contact.mesh_positions),
    }
    return case.with_tables(contact=grid).model_copy(update={"compliance": ComplianceTable(model="shell")})


def _searched(
    targets: dict[str, Array], exact: ShiftedPatterns, estimate: ShiftedPatterns, reach: float
) -> dict[str, Found]:
    """Result of the search at every place: first with coarse patterns, then with the exact ones from there."""
    face = float(exact.size[0])
    rough = PatternSearch(estimate.centre, face, reach, ESTIMATE_TOLERANCE * face)
    fine = PatternSearch(exact.centre, face, reach, CENTRE_TOLERANCE * face)
    start = rough.start()
    middle = rough.find(targets["middle"], start)
    first = middle if middle.status == PatternStatus.REACHED else start
    estimates = {"middle": middle, **{name: rough.find(targets[name], first) for name in ("toe", "heel")}}
    reached = {name for name, one in estimates.items() if one.status == PatternStatus.REACHED}
    return {name: fine.find(targets[name], estimates[name]) if name in reached else estimates[name] for name in PLACES}
