"""Relative curvature of the two members at a point of contact: direction and length of the contact line.

The second-order picture of conventional tooth contact analysis (Kolivand 2009, Eq. 2.15 to 2.18): next to the point of
contact the gap is half the relative curvature times the distance squared, the contact line runs where it is smallest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.checks import frozen_arrays, instance
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.flanks.curvature import Curvatures
from ..geometry.pair.conjugate_motion import ConjugateMotion
from ..geometry.vectors import cross, dot, rotate
from .directional_curvature import ShapeOperator, directional_curvatures
from .point_contact import PointContact

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class RelativeCurvature:
    """Second-order gap at n points of contact, vectors in the gear's frame.

    Parameters
    ----------
    line, across
        Unit tangents (3, n) along the contact line and at right angles to it.
    along_line, across_line
        Relative curvatures (n) in these directions [1/mm], positive where the flanks part.

    Examples
    --------
    >>> x, y = np.eye(3)[:2, :, None]
    >>> found = RelativeCurvature(x, y, along_line=np.array([1e-4]), across_line=np.array([0.05]))
    >>> found.equivalent_radius, found.half_length(5e-3)
    (array([20.]), array([10.]))
    """

    line: Array
    across: Array
    along_line: Array
    across_line: Array

    @property
    def equivalent_radius(self) -> Array:
        """Radius (n) [mm] of the cylinder that stands for the line contact."""
        return np.asarray(1.0 / np.abs(self.across_line))

    def half_length(self, separation: float) -> Array:
        """Half the length (n) [mm] of the contact line whose ends are ``separation`` [mm] apart.

        Half of L = sqrt(8 separation / |relative curvature|), the major axis of the contact ellipse.
        """
        return np.asarray(np.sqrt(2.0 * separation / np.abs(self.along_line)))


def relative_shape_operator(gear: ShapeOperator, pinion: ShapeOperator) -> Array:
    """Sum of both operators (2, 2, n) [1/mm] in the gear's tangent basis.

    Each operator counts its own body convex, so that the sum is the difference S_gear - S_pinion for one common normal.

    Parameters
    ----------
    gear, pinion
        Both in one frame, their normals opposite.
    """
    # Columns: the gear's tangents in the pinion's basis.
    turn = np.array([[dot(p, g) for g in (gear.first, gear.second)] for p in (pinion.first, pinion.second)])
    own, other = (np.array([[s.along, s.torsion], [s.torsion, s.across]]) for s in (gear, pinion))
    return np.asarray(own + np.einsum("kan,kln,lbn->abn", turn, other, turn))


def stationary_directions(gear: Curvatures, pinion: Curvatures, normal: Array) -> RelativeCurvature:
    """Directions of stationary relative curvature from both members' principal curvatures, in closed form.

    Kolivand 2009, Eq. 2.15 to 2.18, with angles counted about the gear's normal, theta from the first principal
    direction of the pinion and sigma from the gear's to the pinion's. The smaller one is the contact line.

    Parameters
    ----------
    gear, pinion
        Principal curvatures, convex positive for either body, and directions in one frame.
    normal
        Outward normal of the gear (3, n).
    """
    first, second = pinion.direction, cross(normal, pinion.direction)
    sigma = np.arctan2(dot(cross(gear.direction, pinion.direction), normal), dot(gear.direction, pinion.direction))
    # Seen with the gear's normal the pinion's curvatures change sign.
    of_gear, of_pinion = gear.curvature, -pinion.curvature
    gear_range, pinion_range = of_gear[0] - of_gear[1], of_pinion[0] - of_pinion[1]
    theta = 0.5 * np.arctan2(gear_range * np.sin(2 * sigma), pinion_range - gear_range * np.cos(2 * sigma))

    def relative(angle: Array) -> Array:
        k_pinion = of_pinion[0] * np.cos(angle) ** 2 + of_pinion[1] * np.sin(angle) ** 2
        k_gear = of_gear[0] * np.cos(angle + sigma) ** 2 + of_gear[1] * np.sin(angle + sigma) ** 2
        return np.asarray(k_gear - k_pinion)

    other = theta + 0.5 * np.pi
    theta = np.where(np.abs(relative(theta)) <= np.abs(relative(other)), theta, other)
    line = np.cos(theta) * first + np.sin(theta) * second
    return RelativeCurvature(line, cross(normal, line), relative(theta), relative(theta + 0.5 * np.pi))


def in_gear_frame(motion: ConjugateMotion, contact: PointContact, vector: Array) -> Array:
    """Directions (3, n) of the pinion's frame, at the points of contact, in the gear's frame."""
    in_space = rotate(
        motion.pinion_axis, contact.pinion_rotation, np.tensordot(motion.assembly.pinion_frame, vector, 1)
    )
    turn = contact.pinion_rotation / motion.assembly.ratio - contact.closing_angle
    return rotate(motion.gear_axis, -turn, in_space)


def shape_operators(
    motion: ConjugateMotion, gear_surface: GeneratingSurface, contact: PointContact
) -> tuple[ShapeOperator, ShapeOperator]:
    """Shape operators of gear and pinion at points of contact, both in the gear's frame."""
    gear = directional_curvatures(gear_surface, contact.gear_parameters).shape_operator()
    pinion = directional_curvatures(motion.surface, contact.pinion_parameters).shape_operator()
    first, second = (in_gear_frame(motion, contact, v) for v in (pinion.first, pinion.second))
    return gear, ShapeOperator(first, second, pinion.along, pinion.across, pinion.torsion)


def relative_curvature(
    motion: ConjugateMotion, gear_surface: GeneratingSurface, contact: PointContact
) -> RelativeCurvature:
    """Contact-line direction and relative curvatures at points of contact, in the gear's frame.

    Parameters
    ----------
    motion
        Axes, senses and pinion surface.
    gear_surface
        The gear flank.
    contact
        Points from ``point_contact.path_of_contact``; where they did not converge the result is NaN.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> from easeoff.verification.point_contact import path_of_contact
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> path = path_of_contact(geometry.members.gear, geometry.exact, np.zeros(1))
    >>> found = relative_curvature(geometry.exact.motion, geometry.members.gear.surface, path)
    >>> bool(0.0 < found.along_line[0] < found.across_line[0])
    True
    """
    instance("motion", motion, ConjugateMotion)
    instance("gear_surface", gear_surface, GeneratingSurface)
    instance("contact", contact, PointContact)
    gear, pinion = shape_operators(motion, gear_surface, contact)
    return stationary_directions(gear.principal(), pinion.principal(), cross(gear.first, gear.second))
