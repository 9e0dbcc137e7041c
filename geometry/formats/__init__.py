"""Geometry that leaves the package: nominal points for measuring machines, surfaces for CAD, meshes."""

from .cmm import EdgeMargins, cmm_points, read_cmm_points, write_cmm_points
from .mesh import write_mesh
from .step import write_step

__all__ = ["EdgeMargins", "cmm_points", "read_cmm_points", "write_cmm_points", "write_mesh", "write_step"]
