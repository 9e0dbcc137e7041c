"""Wrenches of the normal forces at the contact segments of a mesh cycle.

The force acts along the pinion's normal where it makes conjugate contact, and works on the rotation of the gear with
the lever arm of the contact problem: so scaled, a motion of the members changes the separation of the contact problem
by its product with the wrench, exactly so to first order, and the moments about both axes are those of the torques.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.attributes import ordered
from ...core.checks import frozen_arrays
from ...geometry.pair.gear_pair import PairGeometry, first_contact
from ..lines.flank_splines import FlankSplines, fit
from .support import unit_wrenches

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True, eq=False)
class MeshWrenches:
    """Wrench about the origin of the global frame of a unit normal force on the pinion, over the gear flank."""

    fields: FlankSplines
    gear_turn: float
    flank: Array  # wrench at points of the grid on both flanks (m, 6)
    lever_arm: Array
    ease_off_angle: Array  # as a gear rotation, all of the grid (nt, nh) [rad]
    inside: NDArray[np.bool_]

    @classmethod
    def of(cls, geometry: PairGeometry) -> MeshWrenches:
        """The wrenches of a pair."""
        data, grid = geometry.ease_off, ("lengthwise", "profile")
        position, normal = (
            np.moveaxis(ordered(data, name, *grid, "space"), -1, 0) for name in ("action_position", "action_normal")
        )
        shape = position.shape[1:]
        wrench = -unit_wrenches(position.reshape(3, -1), normal.reshape(3, -1)).T.reshape(6, *shape)
        wrench *= ordered(data, "lever_arm", *grid) / np.abs(wrench[5])
        fields = {"wrench": np.moveaxis(wrench, 0, -1), "roll_angle": ordered(data, "roll_angle", *grid)}
        turn = geometry.exact.motion.gear_axis[2] / geometry.pair.assembly.ratio
        inside = ordered(data, "inside", *grid) == 1
        splines = fit(data["lengthwise"].values, data["profile"].values, fields)
        lever_arm, angle = (ordered(data, name, *grid) for name in ("lever_arm", "ease_off_angle"))
        return cls(splines, turn, wrench[:, inside].T, lever_arm[inside], angle, inside)

    def first_contact_change(self, twist: Array) -> float:
        """Change of the gear rotation to first contact [rad] by a twist (6) of the pinion to the gear, to first order.

        First order of the gap at every point: the place of first contact may change.
        """
        angle = self.ease_off_angle.copy()
        angle[self.inside] += self.flank @ twist / self.lever_arm
        return first_contact(angle, self.inside) - first_contact(self.ease_off_angle, self.inside)

    def on_lines(self, points: Array) -> Array:
        """Wrenches (6, ...) at points (2, ...) of contact lines."""
        return self.fields("wrench", points)

    def beside_lines(self, points: Array, rotation: Array) -> Array:
        """Wrenches (6, n) at points (2, n) that touch at pinion rotations (n) other than their roll angle [rad]."""
        fields = self.fields.evaluate(["wrench", "roll_angle"], points)
        force, moment = np.split(fields["wrench"], 2)
        angle = self.gear_turn * (rotation - fields["roll_angle"])
        cosine, sine = np.cos(angle), np.sin(angle)

        def turned(vector: Array) -> Array:
            x, y, z = vector
            return np.stack([cosine * x - sine * y, sine * x + cosine * y, z])

        return np.concatenate([turned(force), turned(moment)])
