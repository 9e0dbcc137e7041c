"""Distance of a flank from nominal points along their normals, as a coordinate measuring machine finds it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import GeometryError
from ...geometry.cutting.generating_surface import GeneratingSurface
from ...geometry.flanks.blank_section import BlankSection
from ...geometry.flanks.seed_lattice import seed_lattice
from ...geometry.newton import complex_steps, solve

Array = NDArray[Any]
MAX_ITERATIONS = 20


def distance_along_normals(surface: GeneratingSurface, section: BlankSection, position: Array, normal: Array) -> Array:
    """Distance from nominal points along their normals to a flank.

    Parameters
    ----------
    surface, section
        The flank as it is, and its blank.
    position, normal
        Nominal points [mm] and outward unit normals (3, n), in the member's frame.

    Returns
    -------
    Array
        Distance along each normal (n) [mm], positive where the flank has more metal.

    Raises
    ------
    GeometryError
        If a normal misses the flank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> gear = geometry.members.gear
    >>> distance = distance_along_normals(gear.surface, geometry.pair.gear.section, gear.position, gear.normal)
    >>> bool(np.abs(distance).max() < 1e-9)
    True
    """
    seeds = seed_lattice(surface, section)
    target = np.stack([position[2], np.hypot(position[0], position[1])])
    start = seeds.nearest(surface.axial_and_radial(seeds.points.parameters), seeds.side, target).parameters
    near = solve(surface.axial_and_radial, start, target, surface.max_step)
    unknowns = np.concatenate([near.parameters, np.zeros((1, position.shape[1]))])
    for _ in range(MAX_ITERATIONS):
        found, slopes = complex_steps(lambda p: surface.evaluate(p)[0], unknowns[:2])
        jacobian = np.concatenate([slopes, -normal[None]]).transpose(2, 1, 0)
        error = found - position - unknowns[2] * normal
        if np.max(np.abs(error)) < 1e-12 * np.max(np.abs(position)):
            return np.asarray(unknowns[2])
        # A start that ran away has no finite or no regular Jacobian: there is nothing to step from.
        if not np.all(np.linalg.det(jacobian) != 0.0) or not np.all(np.isfinite(jacobian)):
            break
        unknowns += -np.linalg.solve(jacobian, error.T[..., None])[..., 0].T
    raise GeometryError(
        f"the normal of a nominal point misses the flank: {float(np.nanmax(np.abs(error))):.3g} mm are left between "
        "them. Do the points belong to this flank, in this position?"
    )
