"""Export and import of geometry: measuring points and grids, CAD surfaces, meshes."""

from .measured_grid import flank_deviation, measured_grid, measured_matrix, read_measured_grid, write_measured_grid
from .measuring_points import EdgeMargins, cmm_points, read_cmm_points, write_cmm_points
from .mesh import write_mesh
from .step import write_step

__all__ = [
    "EdgeMargins",
    "cmm_points",
    "flank_deviation",
    "measured_grid",
    "measured_matrix",
    "read_cmm_points",
    "read_measured_grid",
    "write_cmm_points",
    "write_measured_grid",
    "write_mesh",
    "write_step",
]
