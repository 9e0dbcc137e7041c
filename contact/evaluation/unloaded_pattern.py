"""Unloaded pattern of a mesh cycle: the marking print, its centre and size, and the transmission error beside it."""

from __future__ import annotations

from dataclasses import dataclass

from ..mesh_cycle import MeshCycle
from .carrying_error import CarryingError
from .flank_region import FlankRegion, ProjectionPlane
from .marking_print import PRINT_GRID, MarkingPrint


@dataclass(frozen=True)
class UnloadedPattern:
    """Marking print of a pair on the gear flank."""

    printed: MarkingPrint
    region: FlankRegion
    peak_to_peak: float

    @classmethod
    def of(cls, cycle: MeshCycle, thickness: float, shape: tuple[int, int] = PRINT_GRID) -> UnloadedPattern:
        """Pattern of a compound of a thickness [um]; a ``GeometryError`` refuses a pair that never nears contact."""
        unloaded = cycle.unloaded(separation=thickness)
        error = CarryingError.of(unloaded, cycle.pinion_pitch)
        printed = MarkingPrint.of(cycle.fields, error, thickness, shape)
        region = printed.region(ProjectionPlane.of(cycle.geometry.flanks))
        return cls(printed, region, float(unloaded.attrs["peak_to_peak"]))
