"""Unloaded pattern of a mesh cycle: the marking print, its centre and size, and the transmission error beside it."""

from __future__ import annotations

from dataclasses import dataclass

from ..mesh_cycle import MeshCycle
from .carrying_error import CarryingError
from .flank_region import FlankRegion, ProjectionPlane
from .marking_print import PRINT_GRID, MarkingPrint


@dataclass(frozen=True)
class UnloadedPattern:
    """Marking print of a pair on the gear flank.

    Parameters
    ----------
    printed
        The print.
    region
        Its centre, extent and area.
    peak_to_peak
        Of the unloaded transmission error [urad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=5)
    >>> pattern = UnloadedPattern.of(cycle, 6.0)
    >>> bool(0.0 < pattern.region.centre[0] < 1.0)
    True
    """

    printed: MarkingPrint
    region: FlankRegion
    peak_to_peak: float

    @classmethod
    def of(cls, cycle: MeshCycle, thickness: float, shape: tuple[int, int] = PRINT_GRID) -> UnloadedPattern:
        """Pattern of a marking compound of a thickness [um], on a grid of a shape.

        Raises
        ------
        GeometryError
            If no tooth pair comes near contact at any rotation.
        """
        unloaded = cycle.unloaded(separation=thickness)
        error = CarryingError.of(unloaded, cycle.pinion_pitch)
        printed = MarkingPrint.of(cycle.fields, error, thickness, shape)
        region = printed.region(ProjectionPlane.of(cycle.geometry.flanks))
        return cls(printed, region, float(unloaded.attrs["peak_to_peak"]))
