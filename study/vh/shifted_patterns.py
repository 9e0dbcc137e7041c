"""Unloaded patterns of a pair at displacements V and H, and their numbers as a dataset."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.evaluation.marking_print import PRINT_GRID, ProjectionPlane, UnloadedPattern
from ...core.errors import GeometryError
from ..case_in_mesh import CaseInMesh
from .vh_search import REASONS, Found, PatternStatus

Array = NDArray[Any]

PLACES = ("toe", "middle", "heel")
STORED_GRID = (121, 61)  # points of a stored print along the face and the profile; every second of an exact one
GRID_MARGIN = 0.1  # of the range of V and of H that was found, beyond it on both sides of the grid
ROUND_FACTORS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0)  # times a power of ten, of a step
ROUNDING = 1e-9  # of a step
GRID_MINIMUM = 0.004  # of the length of the flank, to both sides: the grid is no smaller


@dataclass
class ShiftedPatterns:
    """Unloaded patterns of a pair at V and H, each computed once.

    Parameters
    ----------
    state
        The pair in mesh at V = H = 0.
    thickness
        Of the marking compound [um].
    shape
        Points of the print along the face and the profile.
    progress
        Called after every pattern that is computed.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case = read_case("fh-design-a")
    >>> coarse = {"mesh_positions": 4, "lengthwise_nodes": 11, "profile_nodes": 7}
    >>> shells = case.compliance.model_copy(update={"model": "shell"})
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse), "compliance": shells})
    >>> patterns = ShiftedPatterns(CaseInMesh.of(case), 6.0, (61, 31))
    >>> along, up = patterns.centre(np.array([0.1, 0.0])) - patterns.centre(np.zeros(2))
    >>> bool(along < -1.0 < up)
    True
    """

    state: CaseInMesh
    thickness: float
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


def found_dataset(found: Mapping[str, Found], places: Array, patterns: ShiftedPatterns) -> xr.Dataset:
    """What was found at the places (3, 2), as fractions; NaN where the pattern cannot be brought there."""
    shifts = np.array([one.displacement for one in found.values()])
    shifts[[one.status != PatternStatus.REACHED for one in found.values()]] = np.nan
    numbers, prints = _numbers([patterns.at(shift) if np.all(np.isfinite(shift)) else None for shift in shifts])
    total = shifts[-1] - shifts[0]
    data: dict[str, Any] = {
        "v": ("place", shifts[:, 0]),
        "h": ("place", shifts[:, 1]),
        "place_lengthwise": ("place", places[:, 0]),
        "place_profile": ("place", places[:, 1]),
        **{name: ("place", values) for name, values in numbers.items()},
        "status": (
            "place",
            np.array([one.status for one in found.values()], dtype=np.int8),
            PatternStatus.flag_attributes() | {"long_name": "how the search for the place ended"},
        ),
        "total_v": total[0],
        "total_h": total[1],
        "h_over_v": total[1] / total[0] if total[0] else np.nan,
        "print_excess": (("place", "lengthwise", "profile"), prints),
    }
    axes = [np.linspace(0.0, 1.0, n) for n in STORED_GRID]
    in_plane = patterns.plane(np.stack(np.meshgrid(*axes, indexing="ij")))
    reasons = {f"reason_{name}": _reason(one, patterns.size) for name, one in found.items() if REASONS[one.status]}
    return xr.Dataset(
        {**data, "in_plane": (("plane_axis", "lengthwise", "profile"), in_plane)},
        coords={
            "place": list(PLACES),
            "plane_axis": ["along", "across"],
            **dict(zip(("lengthwise", "profile"), axes, strict=True)),
        },
        attrs=reasons,
    )


def _reason(found: Found, size: Array) -> str:
    """Why a place is not reached, and how near the pattern came."""
    said = REASONS[found.status]
    if not np.all(np.isfinite(found.centre)):
        return said
    (v, h), (along, up) = found.displacement, 100.0 * found.centre / size
    return f"{said}; nearest: centre {along:.1f}, {up:.1f} % from toe, root at V = {v:.4f}, H = {h:.4f} mm"


def grid_dataset(found: xr.Dataset, counts: tuple[int, int], patterns: ShiftedPatterns) -> xr.Dataset:
    """Patterns at round, even values of V and H around those that were found, and around zero."""
    face = float(patterns.size[0])
    axes = []
    for name, count in zip(("v", "h"), counts, strict=True):
        values = np.append(found[name].values[np.isfinite(found[name].values)], 0.0)
        margin = max(GRID_MARGIN * float(np.ptp(values)), GRID_MINIMUM * face)
        axes.append(round_values(values.min() - margin, values.max() + margin, count))
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    numbers, prints = _numbers([patterns.at(point) for point in points.reshape(-1, 2)])
    dimensions = ("v_grid", "h_grid")
    data: dict[str, Any] = {f"grid_{name}": (dimensions, values.reshape(counts)) for name, values in numbers.items()}
    data["grid_print_excess"] = ((*dimensions, "lengthwise", "profile"), prints.reshape(*counts, *STORED_GRID))
    return xr.Dataset(data, coords=dict(zip(dimensions, axes, strict=True)))


def round_values(low: float, high: float, count: int) -> Array:
    """Multiples (count) of half a round step, the smallest with which they reach from ``low`` or below to ``high``.

    Parameters
    ----------
    low, high
        Range that must be covered, of some length.
    count
        Number of values, at least 2.

    Examples
    --------
    >>> round_values(-0.51, 0.43, 5).tolist()
    [-0.6, -0.3, 0.0, 0.3, 0.6]
    """
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
    names = (
        *("pattern_centre_lengthwise", "pattern_centre_profile", "pattern_length", "pattern_height"),
        *("pattern_from", "pattern_to", "peak_to_peak"),
    )
    return dict(zip(names, np.array(rows).T, strict=True)), np.array(prints)
