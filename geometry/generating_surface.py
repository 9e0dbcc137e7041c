"""What cuts a flank: a blade on a machine, and the envelope of its motion.

A generated flank has the two parameters (cutter angle, cradle rotation); the distance along the blade follows from
the equation of meshing in closed form (Kolivand 2009, Eq. 2.8). A Formate flank is the cutter cone itself, with the
parameters (cutter angle, distance along the blade).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .blade import Blade
from .machine import IncrementSense, MachineSettings
from .machine_pose import machine_pose
from .newton import complex_steps
from .vectors import cos_sin, cross, dot

Array = NDArray[Any]
Hand = Literal["left", "right"]


@dataclass(frozen=True)
class GeneratingSurface:
    """What cuts one flank: a blade, the machine that carries it, and the hand of the member.

    Parameters
    ----------
    blade
        The cutter blade.
    settings
        The machine settings.
    hand
        Hand of spiral of the member; a left-hand flank is the mirror image (y to -y) of the right-hand one.
    sense
        Sense of the cradle increment, see ``machine.IncrementSense``.
    """

    blade: Blade
    settings: MachineSettings
    hand: Hand
    sense: IncrementSense

    @np.errstate(all="ignore")
    def evaluate(self, parameters: Array) -> tuple[Array, Array, Array]:
        """Flank at given parameters; analytic, so that it can be differentiated by complex step.

        NaN where the blade has no point of the flank.

        Parameters
        ----------
        parameters
            Cutter angle [rad] and, generated, cradle rotation [rad] or, Formate, distance along the blade [mm]: (2, n).

        Returns
        -------
        tuple
            Position (3, n) [mm] and outward unit normal (3, n) in the member frame, distance along the blade (n) [mm].
        """
        cutter_angle, second = parameters
        cradle_rotation = second if self.settings.generated else np.zeros_like(second)
        pose = machine_pose(self.settings, cradle_rotation, self.sense)

        cosine, sine = cos_sin(cutter_angle)
        x_axis, y_axis, cutter_axis = pose.frame
        radial, tangential = x_axis * cosine + y_axis * sine, y_axis * cosine - x_axis * sine
        (tip_r, tip_t), (edge_r, edge_t, edge_z) = self.blade.tip, self.blade.edge
        tip = pose.center + tip_r * radial + tip_t * tangential
        edge = edge_r * radial + edge_t * tangential + edge_z * cutter_axis

        # Velocity of a blade point relative to the work, by the cutter angle, as spin x point + shift.
        indexing = self.settings.indexing_ratio
        spin = cutter_axis + indexing * pose.axis
        shift = -cross(cutter_axis, pose.center) - indexing * cross(pose.axis, pose.origin)
        distance = second
        if self.settings.generated:
            distance = _edge_distance(tip, edge, (spin, shift), (pose.spin, pose.shift))
        point = tip + distance * edge
        normal = -self.blade.side_sign * cross(edge, cross(spin, point) + shift)
        normal = normal / np.sqrt(dot(normal, normal))

        turned = -indexing * cutter_angle
        position = pose.to_member(point, turned, point=True)
        normal = pose.to_member(normal, turned, point=False)
        if self.hand == "left":
            position[1], normal[1] = -position[1], -normal[1]
        return position, normal, distance

    def axial_and_radial(self, parameters: Array) -> Array:
        """Axial and radial coordinates (2, n) [mm] of the flank at given parameters (2, n)."""
        position, _, _ = self.evaluate(parameters)
        return np.stack([position[2], np.sqrt(position[0] ** 2 + position[1] ** 2)])

    @property
    def max_step(self) -> Array:
        """Largest Newton step of the two parameters."""
        return np.array([0.2, 0.2 if self.settings.generated else 0.2 * self.blade.point_radius])

    def orientation(self, parameters: Array) -> Array:
        """Signed area ratio of the parametrisation (n): it changes sign where the flank is undercut."""

        def position(p: Array) -> Array:
            return self.evaluate(p)[0]

        _, (first, second) = complex_steps(position, parameters)
        _, normal, _ = self.evaluate(parameters)
        return np.asarray(dot(cross(first, second), normal))


def _edge_distance(tip: Array, edge: Array, by_cutter: tuple[Array, Array], by_cradle: tuple[Array, Array]) -> Array:
    """Distance along the blade [mm] where the generated flank touches it: the equation of meshing in closed form.

    Blade, velocity by the cutter and velocity by the cradle lie in one plane there (Kolivand 2009, Eq. 2.8). Both
    velocities are linear in the distance, so the condition is quadratic. Its other root is far away: for a face-milling
    cutter it is always the apex of the cone.

    Parameters
    ----------
    tip, edge
        Blade tip [mm] and direction (3, n).
    by_cutter, by_cradle
        Velocities of a point, as (spin, shift) with velocity = spin x point + shift.
    """
    at_tip = [cross(spin, tip) + shift for spin, shift in (by_cutter, by_cradle)]
    along = [cross(spin, edge) for spin, _ in (by_cutter, by_cradle)]
    constant = dot(edge, cross(at_tip[0], at_tip[1]))
    linear = dot(edge, cross(along[0], at_tip[1]) + cross(at_tip[0], along[1]))
    quadratic = dot(edge, cross(along[0], along[1]))
    root = np.sqrt(linear * linear - 4.0 * constant * quadratic)
    return np.asarray(-2.0 * constant / (linear + np.sign(linear.real) * root))
