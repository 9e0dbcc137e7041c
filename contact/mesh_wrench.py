"""Wrenches of the normal forces at the contact segments of a mesh cycle, and supports as modes of these.

The force acts along the pinion's normal where it makes conjugate contact, and works on the rotation of the gear with
the lever arm of the contact problem: so scaled, a motion of the members changes the separation of the contact problem
by its product with the wrench, exactly so to first order, and the moments about both axes are those of the torques.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ..core.arrays import Array, Bools, record
from ..core.attributes import ordered
from ..geometry.pair.gear_pair import PairGeometry, first_contact
from .lines.flank_splines import FlankSplines, fit
from .problem.modal_basis import ModalBasis, with_shared_modes

ROTATION_LENGTH = 100.0  # [mm]; makes rotations comparable with translations, matters for rounding alone
DROPPED_SHARE = 1e-15  # of the greatest eigenvalue of the compliance


def unit_wrenches(position: Array, normal: Array) -> Array:
    """Wrenches (n, 6) about the origin of unit forces along normals (3, n) at positions (3, n) [mm]."""
    return np.concatenate([normal, np.cross(position, normal, axis=0)]).T


@record(frozen=True, eq=False)
class MeshWrenches:
    """Wrench about the origin of the global frame of a unit normal force on the pinion, over the gear flank."""

    fields: FlankSplines
    gear_turn: float
    flank: Array  # wrench at points of the grid on both flanks (m, 6)
    lever_arm: Array
    ease_off_angle: Array  # as a gear rotation, all of the grid (nt, nh) [rad]
    inside: Bools

    @classmethod
    def of(cls, geometry: PairGeometry) -> MeshWrenches:
        """The wrenches of a pair."""
        data, grid = geometry.ease_off, ("lengthwise", "profile")
        vectors = (ordered(data, name, *grid, "space") for name in ("action_position", "action_normal"))
        position, normal = (np.moveaxis(vector, -1, 0) for vector in vectors)
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


@record(frozen=True, eq=False)
class SupportModes:
    """Part of the supports in the contact problem of a mesh position."""

    compliance: Array  # twist of pinion to gear for wrench on the pinion, about the origin (6, 6)
    absorbed: Array  # twist (6) that is in the separations already

    @cached_property
    def mixing(self) -> Array:
        """L (6, s) with L L' the compliance, of as few columns as it has directions."""
        scale = np.repeat([1.0, ROTATION_LENGTH], 3)
        values, vectors = np.linalg.eigh(self.compliance * np.outer(scale, scale))
        kept = values > DROPPED_SHARE * max(values[-1], 0.0)
        return np.asarray(vectors[:, kept] * np.sqrt(values[kept]) / scale[:, None])

    def twist(self, wrench: Array) -> Array:
        """Twist (..., 6) of the pinion relative to the gear under wrenches (..., 6) on the pinion about the origin."""
        return np.asarray(wrench @ self.compliance)

    def basis(self, bending: ModalBasis, wrenches: Array) -> ModalBasis:
        """The modes of the teeth with those of the supports, for unit wrenches (n, 6) at the segments."""
        mixing = self.mixing
        if mixing.shape[1] == 0:
            return bending
        return with_shared_modes(bending, wrenches, np.tile(mixing, (len(bending.blocks), 1, 1)))

    def separation(self, separation: Array, wrenches: Array) -> Array:
        """The separations (n) [mm] without what is absorbed in them."""
        return np.asarray(separation - wrenches @ self.absorbed) if self.absorbed.any() else separation
