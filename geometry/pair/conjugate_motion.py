"""The conjugate position of a pinion point, and the gear that would be exactly conjugate to the pinion.

A pinion point is in contact with its conjugate gear at the pinion rotation where the relative velocity of the two
members is at right angles to the normal (Kolivand 2009, Eq. 2.19 and 4.1). That condition is
A cos q + B sin q = C and has two roots, tens of degrees apart; the right one is chosen once, at the mean point, and
followed by its sign over the whole flank.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...core.arrays import Array
from ..cutting.generating_surface import GeneratingSurface, SurfacePoints
from ..vectors import column, cos_sin, cross, dot, rotate, rotate_z
from .assembly import Assembly


@dataclass(frozen=True)
class ConjugateMotion:
    """Two members turning at a constant ratio, and one pinion flank."""

    surface: GeneratingSurface
    assembly: Assembly
    pinion_sense: float  # of drive rotation, +1 or -1; the gear turns in the opposite sense about its own axis
    branch: float = 1.0  # sign of the root of the conjugacy equation
    center: float = 0.0  # rotation at the mean point [rad]; roots within half a turn of it

    @property
    def pinion_axis(self) -> Array:
        """Unit vector (3) of the pinion axis, oriented so that the drive rotation is positive."""
        return np.asarray(self.pinion_sense * self.assembly.pinion_frame[:, 2])

    @property
    def gear_axis(self) -> Array:
        """Unit vector (3) of the gear axis, oriented so that the drive rotation is positive."""
        return np.array([0.0, 0.0, -self.pinion_sense])

    def pinion_point(self, parameters: Array) -> tuple[Array, Array]:
        """Pinion positions [mm] and normals (3, n) in the global frame at zero rotation, from surface parameters."""
        position, normal, _ = self.surface.evaluate(parameters)
        return self.assembly.pinion_to_global(position, normal)

    def _coefficients(self, position: Array, normal: Array) -> tuple[Array, Array, Array]:
        """A, B, C of the conjugacy equation."""
        a_p, a_g = self.pinion_axis, self.gear_axis
        moment = cross(position - column(self.assembly.pinion_origin, position), normal)
        shift = np.cross(a_g, self.assembly.gear_origin - self.assembly.pinion_origin)

        def split(fixed: Array, vector: Array) -> tuple[Array, Array, Array]:
            # fixed . Rot(a_p, q) vector = alpha cos q + beta sin q + gamma
            gamma = np.dot(fixed, a_p) * dot(column(a_p, vector), vector)
            turned = cross(column(a_p, vector), vector)
            return dot(column(fixed, vector), vector) - gamma, dot(column(fixed, vector), turned), gamma

        alpha, beta, gamma = split(a_g, moment)
        alpha_n, beta_n, gamma_n = split(shift, normal)
        driving = self.assembly.ratio * dot(column(a_p, moment), moment)
        return alpha - alpha_n, beta - beta_n, driving - gamma + gamma_n

    def roots(self, position: Array, normal: Array) -> tuple[Array, Array]:
        """Both roots (n) [rad] of the conjugacy equation, within half a turn of ``center``; NaN where there is none."""
        coefficients = self._coefficients(position.real, normal.real)
        return self._root(coefficients, 1.0), self._root(coefficients, -1.0)

    def _root(self, coefficients: tuple[Array, Array, Array], sign: float) -> Array:
        """One of the roots (n) [rad]."""
        a, b, c = coefficients
        with np.errstate(invalid="ignore"):
            half = np.arccos(c / np.hypot(a, b))
        from_center = np.arctan2(b, a) + sign * half - self.center
        return np.asarray(np.mod(from_center + np.pi, 2 * np.pi) - np.pi + self.center)

    def rotation(self, position: Array, normal: Array) -> Array:
        """Pinion rotation (n) [rad] that brings each point into conjugate contact, on the chosen branch.

        Analytic: the real root takes one Newton step in the (possibly complex) coefficients.
        """
        a, b, c = self._coefficients(position, normal)
        q = self._root((a.real, b.real, c.real), self.branch)
        cosine, sine = cos_sin(q)
        return np.asarray(q - (a * cosine + b * sine - c) / (b * cosine - a * sine))

    def action_point(self, parameters: Array, rotation: Array) -> tuple[Array, Array]:
        """Pinion positions [mm] and normals (3, n) in the global frame after the pinion has turned."""
        return self.turned(*self.pinion_point(parameters), rotation)

    def turned(self, position: Array, normal: Array, rotation: Array) -> tuple[Array, Array]:
        """Positions [mm] and normals (3, n) in the global frame, turned with the pinion."""
        axis, origin = self.pinion_axis, column(self.assembly.pinion_origin, position)
        return rotate(axis, rotation, position - origin) + origin, rotate(axis, rotation, normal)

    def in_gear(self, vector: Array, rotation: Array) -> Array:
        """Global positions taken into the gear frame, the gear turned by ``rotation`` over the ratio (Eq. 2.20)."""
        relative = vector - column(self.assembly.gear_origin, vector)
        return rotate(self.gear_axis, -rotation / self.assembly.ratio, relative)

    def conjugate_gear(self, parameters: Array) -> tuple[Array, Array]:
        """Conjugate gear points (3, n) [mm] in the gear frame and the pinion rotations (n) [rad] that make them."""
        position, normal = self.pinion_point(parameters)
        rotation = self.rotation(position, normal)
        origin = column(self.assembly.pinion_origin, position)
        return self.in_gear(rotate(self.pinion_axis, rotation, position - origin) + origin, rotation), rotation

    def closing_and_place(self, points: SurfacePoints, rotation: Array) -> tuple[Array, Array]:
        """``closing_velocity`` and axial and radial place [mm] (3, n), and their derivatives (3, 3, n).

        At any pinion rotation (n) [rad]; the place is about the gear axis, the derivatives by both surface parameters
        and the rotation.
        """
        # All is seen from the pinion, about whose z axis the gear turns backwards.
        frame, sense = self.assembly.pinion_frame, self.pinion_sense
        axis = rotate_z(-sense * rotation, frame[2])
        apart = frame.T @ (self.assembly.gear_origin - self.assembly.pinion_origin)
        position, normal = points.position, points.normal
        from_gear = position - rotate_z(-sense * rotation, apart)
        axial = dot(axis, from_gear)
        arm = cross(axis, from_gear)
        radial = np.sqrt(dot(arm, arm))
        # By the parameters the point moves on its surface, by the rotation about the pinion's axis; so for the normal.
        moved, turned = (
            np.stack([*points.slopes[:, rows], sense * np.stack([-v[1], v[0], np.zeros_like(v[0])])], axis=1)
            for rows, v in ((slice(0, 3), position), (slice(3, 6), normal))
        )
        lever = -sense * dot(arm, normal)
        lever_slopes = -sense * (dot(cross(normal, axis)[:, None], moved) + dot(arm[:, None], turned))
        pinion_lever = sense * (position[0] * normal[1] - position[1] * normal[0])
        pinion_slopes = sense * (
            (moved[0] * normal[1] - moved[1] * normal[0]) + (position[0] * turned[1] - position[1] * turned[0])
        )
        share = pinion_lever / lever
        closing = (pinion_slopes - share * lever_slopes) / lever
        outward = (from_gear - axial * axis) / radial
        values = np.stack([share - 1.0 / self.assembly.ratio, axial, radial])
        return values, np.stack([closing, dot(axis[:, None], moved), dot(outward[:, None], moved)], axis=1)

    def conjugate_place(self, points: SurfacePoints) -> tuple[Array, Array]:
        """Axial and radial coordinates (2, n) [mm] of the conjugate gear points, and their derivatives (2, 2, n)."""
        rotation = self.rotation(*self.assembly.pinion_to_global(points.position, points.normal))
        values, slopes = self.closing_and_place(points, rotation)
        # The rotation follows so that the closing velocity stays zero.
        following = -slopes[:2, 0] / slopes[2, 0]
        return values[1:], slopes[:2, 1:] + following[:, None] * slopes[2, 1:]

    def closing_velocity(self, position: Array, normal: Array) -> Array:
        """Approach of the pinion surface to the gear per pinion rotation, as a gear angle (n).

        The relative normal velocity over the gear's lever arm: zero at conjugate points (Eq. 2.19).
        """
        from_pinion = position - column(self.assembly.pinion_origin, position)
        from_gear = position - column(self.assembly.gear_origin, position)
        pinion_arm = cross(column(self.pinion_axis, position), from_pinion)
        lever = dot(cross(column(self.gear_axis, position), from_gear), normal)
        return np.asarray(dot(pinion_arm, normal) / lever - 1.0 / self.assembly.ratio)
