"""What cuts a flank: a blade on a machine, and the envelope of its motion.

A generated flank has the two parameters (cutter angle, cradle rotation); the distance along the blade follows from
the equation of meshing in closed form (Kolivand 2009, Eq. 2.8). A Formate flank is the cutter cone itself, with the
parameters (cutter angle, distance along the blade).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .blade import Blade
from .machine import IncrementSense, MachineSettings, cutter_frame, machine_to_member, work_axis, work_rotation
from .newton import complex_step
from .vectors import column, cos_sin, cross, dot, rotate_z

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

    @cached_property
    def _frame(self) -> Array:
        return cutter_frame(self.settings)

    def _blade_in_cradle(self, cutter_angle: Array) -> tuple[Array, Array, Array]:
        """Cone normal, blade direction and blade tip (3, n) in the frame that turns with the cradle."""
        cosine, sine = cos_sin(cutter_angle)
        x_axis, y_axis, axis = (column(self._frame[:, i], cosine[None]) for i in range(3))
        radial = x_axis * cosine + y_axis * sine
        (normal_r, normal_z), (edge_r, edge_z) = self.blade.normal, self.blade.edge
        center = column(np.array([self.settings.radial_distance, 0.0, 0.0]), cosine[None])
        tip = center + self.blade.point_radius * radial
        return normal_r * radial + normal_z * axis, edge_r * radial + edge_z * axis, tip

    def _edge_distance(self, blade: tuple[Array, Array, Array], cradle_rotation: Array) -> Array:
        """Distance along the blade [mm] where the generated flank touches it, from the equation of meshing.

        The cone normal is constant along the edge and the relative velocity is linear in the distance, so the
        condition normal . velocity = 0 is linear too (its other solution is always the apex of the cone).
        """
        normal, edge, tip = blade
        direction, crossing_point = work_axis(self.settings)
        _, ratio = work_rotation(self.settings, cradle_rotation, self.sense)
        # The work axis seen from the cradle; the relative velocity is that of the cradle less that of the work.
        back = -(self.settings.cradle_angle + cradle_rotation)
        axis, origin = rotate_z(back, tuple(direction)), rotate_z(back, tuple(crossing_point))
        spin = -ratio * axis
        spin[2] += 1.0
        shift = ratio * cross(axis, origin)
        return np.asarray(-dot(normal, cross(spin, tip) + shift) / dot(normal, cross(spin, edge)))

    def evaluate(self, parameters: Array) -> tuple[Array, Array, Array]:
        """Flank at given parameters; analytic, so that it can be differentiated by complex step.

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
        blade = self._blade_in_cradle(cutter_angle)
        if self.settings.generated:
            cradle_rotation, distance = second, self._edge_distance(blade, second)
        else:
            cradle_rotation, distance = np.zeros_like(second), second
        normal, edge, tip = blade
        cradle = self.settings.cradle_angle + cradle_rotation
        rotation, _ = work_rotation(self.settings, cradle_rotation, self.sense)
        position = machine_to_member(self.settings, rotation, rotate_z(cradle, tip + distance * edge), point=True)
        normal = machine_to_member(self.settings, rotation, rotate_z(cradle, normal), point=False)
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

        _, first = complex_step(position, parameters, 0)
        _, second = complex_step(position, parameters, 1)
        _, normal, _ = self.evaluate(parameters)
        return np.asarray(dot(cross(first, second), normal))
