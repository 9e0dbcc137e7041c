"""Curvature of a generated flank from two directions: an independent check of the fundamental forms.

Along each of the two parameter curves the normal turns by the normal curvature in the tangent plane's one direction and
by the geodesic torsion in the other (Kolivand 2009, Eq. 2.9 to 2.13). Two normal curvatures and one torsion make the
shape operator; the other torsion has to agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.checks import frozen_arrays
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.flanks.curvature import Curvatures
from ..geometry.newton import complex_steps
from ..geometry.vectors import cross, dot

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class ShapeOperator:
    """Shape operator of a surface at n points: a symmetric 2 x 2 operator in an orthonormal tangent basis.

    Curvatures are positive where the body is convex.

    Parameters
    ----------
    first, second
        Unit tangents (3, n); the second is the outward normal times the first.
    along, across
        Normal curvatures (n) along the first and the second tangent [1/mm].
    torsion
        Geodesic torsion along the first tangent (n) [1/mm].

    Examples
    --------
    >>> import numpy as np
    >>> x, y = np.eye(3)[:2, :, None]
    >>> cylinder = ShapeOperator(x, y, along=np.array([0.0]), across=np.array([0.1]), torsion=np.zeros(1))
    >>> cylinder.principal().curvature.ravel()
    array([0.1, 0. ])
    """

    first: Array
    second: Array
    along: Array
    across: Array
    torsion: Array

    def principal(self) -> Curvatures:
        """Principal curvatures and first principal direction, in closed form."""
        middle = 0.5 * (self.along + self.across)
        half = 0.5 * (self.along - self.across)
        radius = np.hypot(half, self.torsion)
        angle = 0.5 * np.arctan2(self.torsion, half)
        direction = np.cos(angle) * self.first + np.sin(angle) * self.second
        return Curvatures(np.stack([middle + radius, middle - radius]), direction)


@frozen_arrays
@dataclass(frozen=True)
class DirectionalCurvatures:
    """Normal curvature and geodesic torsion along the two parameter curves, at n points.

    Parameters
    ----------
    tangent
        Unit tangents (2, 3, n) of the curves on which the first and the second parameter grows.
    across
        Outward normal times tangent (2, 3, n).
    normal_curvature, geodesic_torsion
        Components of the normal's change per mm along ``tangent`` and ``across`` (2, n) [1/mm].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> gear = geometry.members.gear
    >>> found = directional_curvatures(gear.surface, gear.parameters)
    >>> bool(np.abs(found.torsion_residual()).max() < 1e-12)
    True
    """

    tangent: Array
    across: Array
    normal_curvature: Array
    geodesic_torsion: Array

    def _turn(self) -> tuple[Array, Array]:
        """Cosine and sine of the angle in the tangent plane from the first tangent to the second."""
        return dot(self.tangent[0], self.tangent[1]), dot(self.across[0], self.tangent[1])

    def shape_operator(self) -> ShapeOperator:
        """The operator in the basis of the first tangent; it takes no notice of the second torsion."""
        cosine, sine = self._turn()
        (along, other), torsion = self.normal_curvature, self.geodesic_torsion[0]
        across = (other - along * cosine**2 - 2.0 * torsion * sine * cosine) / sine**2
        return ShapeOperator(self.tangent[0], self.across[0], along, across, torsion)

    def torsion_residual(self) -> Array:
        """Geodesic torsion along the second tangent, less the one that the shape operator says (n) [1/mm]."""
        cosine, sine = self._turn()
        operator = self.shape_operator()
        said = (operator.across - operator.along) * sine * cosine + operator.torsion * (cosine**2 - sine**2)
        return np.asarray(self.geodesic_torsion[1] - said)


def directional_curvatures(surface: GeneratingSurface, parameters: Array) -> DirectionalCurvatures:
    """Normal curvatures and geodesic torsions along both parameter curves.

    Kolivand 2009, Eq. 2.10 and 2.12: the change of the normal per mm is -(k t + tau v) for the inward normal, so
    k t + tau v for the outward one; derivatives by complex step.

    Parameters
    ----------
    surface
        Generating surface of the flank.
    parameters
        Surface parameters (2, n), see ``GeneratingSurface.evaluate``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry, principal_curvatures
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> gear = geometry.members.gear
    >>> found = directional_curvatures(gear.surface, gear.parameters).shape_operator().principal()
    >>> np.allclose(found.curvature, principal_curvatures(gear).curvature)
    True
    """

    def position_and_normal(p: Array) -> Array:
        position, normal, _ = surface.evaluate(p)
        return np.concatenate([position, normal])

    with np.errstate(all="ignore"):
        value, derivatives = complex_steps(position_and_normal, parameters)
        normal = value[3:]
        tangents, acrosses, curvatures, torsions = [], [], [], []
        for derivative in derivatives:
            length = np.sqrt(dot(derivative[:3], derivative[:3]))
            tangent, turning = derivative[:3] / length, derivative[3:] / length
            across = cross(normal, tangent)
            tangents.append(tangent)
            acrosses.append(across)
            curvatures.append(dot(turning, tangent))
            torsions.append(dot(turning, across))
    return DirectionalCurvatures(np.stack(tangents), np.stack(acrosses), np.stack(curvatures), np.stack(torsions))
