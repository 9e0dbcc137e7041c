"""Principal curvatures of a generated flank, by fundamental forms."""

from __future__ import annotations

import numpy as np

from ...core.arrays import Array, record
from ...core.checks import instance
from ..cutting.generating_surface import GeneratingSurface, SurfacePoints
from ..vectors import dot
from .flank import Flank, on_parts


@record(frozen=True)
class Curvatures:
    """Principal curvatures of a flank at n nodes."""

    curvature: Array  # (2, n) [1/mm], the larger one first; positive where the tooth is convex
    direction: Array  # (3, n) of the first one, in the member's frame


def shape_operator(flank: Flank) -> tuple[Array, Array, Array]:
    """Tangents (3, 2, n) by both parameters, and first and second fundamental form (2, 2, n) of a flank.

    The second is taken with the inward normal, so that convex teeth have positive curvature.
    """

    def derivatives_on(surface: GeneratingSurface, parameters: Array) -> Array:
        return SurfacePoints.of(surface, parameters).slopes

    with np.errstate(all="ignore"):
        derivatives = on_parts(
            flank.surface.flank_parts, flank.part.ravel(), flank.parameters.reshape(2, -1), derivatives_on
        )
    tangents, turning = derivatives[:, :3].swapaxes(0, 1), derivatives[:, 3:6].swapaxes(0, 1)
    first = np.einsum("ian,ibn->abn", tangents, tangents)
    second = np.einsum("ian,ibn->abn", turning, tangents)
    return tangents, first, 0.5 * (second + second.transpose(1, 0, 2))


def principal_curvatures(flank: Flank) -> Curvatures:
    """Principal curvatures and first principal direction of a flank at its nodes.

    Unusable nodes carry NaN.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> first, second = principal_curvatures(geometry.members.gear).curvature
    >>> bool((first > second).all())
    True
    """
    instance("flank", flank, Flank)
    tangents, first, second = shape_operator(flank)
    usable = np.all(np.isfinite(flank.normal.reshape(3, -1)), axis=0)
    usable &= np.all(np.isfinite(first) & np.isfinite(second), axis=(0, 1))
    identity = np.eye(2)[..., None]
    # Orthonormal tangent basis: with I = L L^T the operator L^-1 II L^-T is symmetric.
    lower = np.linalg.cholesky(np.where(usable, first, identity).transpose(2, 0, 1))
    inverse = np.linalg.inv(lower)
    symmetric = inverse @ np.where(usable, second, identity).transpose(2, 0, 1) @ inverse.transpose(0, 2, 1)
    values, vectors = np.linalg.eigh(symmetric)
    along = np.einsum("nba,nb->an", inverse, vectors[:, :, 1])
    direction = np.einsum("ian,an->in", tangents, along)
    with np.errstate(all="ignore"):
        direction = direction / np.sqrt(dot(direction, direction))
    blank = np.where(usable, 1.0, np.nan)
    return Curvatures(values[:, ::-1].T * blank, direction * blank)
