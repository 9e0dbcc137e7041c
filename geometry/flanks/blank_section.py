"""The axial section of a blank: where a flank begins and ends, and the grid of nodes on it.

The axial plane of a member has the axial coordinate along the member's own axis, from the crossing point to the heel,
and the radial coordinate as the distance from that axis. The flank is bounded by four straight lines: towards the root
(root cone plus clearance), towards the tip (face cone), toe and heel. Nodes are counted by two fractions from 0 to 1:
``lengthwise`` from toe to heel and ``profile`` from root to tip.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...core.arrays import RealArray as Array, record
from ...core.checks import check_fields
from ...core.errors import GeometryError
from ..newton import determinant


@record(frozen=True)
class BlankSection:
    """Axial section of one member's blank.

    Parameters
    ----------
    pitch_angle, face_angle, root_angle
        Angles of the cones [rad].
    pitch_apex, face_apex, root_apex
        Distance of each apex beyond the crossing point [mm], positive away from the teeth.
    outer_cone_distance
        Distance from the pitch apex to the heel along the pitch cone [mm].
    face_width
        Distance from toe to heel along the pitch cone [mm].
    clearance
        Distance between the root cone and the end of the flank, measured at right angles to the root cone [mm].
    front_angle, back_angle
        The toe and heel lines stand at right angles to a cone of this angle [rad]; the pitch angle when ``None``.

    Raises
    ------
    GeometryError
        If the four lines do not enclose a flank.

    Examples
    --------
    >>> section = BlankSection(
    ...     pitch_angle=0.32, face_angle=0.36, root_angle=0.29, outer_cone_distance=100.0, face_width=30.0
    ... )
    >>> axial, radial = section.points(np.array([0.0, 1.0]), np.array([0.5, 0.5]))  # toe and heel at mid height
    >>> [round(float(v), 1) for v in np.hypot(axial, radial)]
    [70.0, 100.0]
    """

    pitch_angle: float
    face_angle: float
    root_angle: float
    outer_cone_distance: float
    face_width: float
    pitch_apex: float = 0.0
    face_apex: float = 0.0
    root_apex: float = 0.0
    clearance: float = 0.0
    front_angle: float | None = None
    back_angle: float | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        corners = self.corners
        depth = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=-1)
        towards_tip = np.einsum("ij,ij->i", corners[:, 1] - corners[:, 0], np.stack([self._root_normal] * 2))
        lengthwise = np.linalg.norm(corners[1] - corners[0], axis=-1)
        if not (np.all(np.isfinite(corners)) and np.all(towards_tip > 1e-6) and np.all(depth > 1e-6)):
            raise GeometryError(
                f"the blank leaves no tooth depth between root cone ({np.degrees(self.root_angle):.4f} deg) and face "
                f"cone ({np.degrees(self.face_angle):.4f} deg): check the angles, the apexes and the clearance"
            )
        if np.any(lengthwise <= 1e-6) or np.any(corners[..., 1] <= 0.0):
            raise GeometryError("the blank reaches its own axis: check outer_cone_distance and face_width")

    @cached_property
    def _root_normal(self) -> Array:
        """Unit vector (axial, radial) at right angles to the root cone, towards the tip."""
        return np.array([-np.sin(self.root_angle), np.cos(self.root_angle)])

    @cached_property
    def corners(self) -> Array:
        """Corners of the flank (toe/heel, root/tip, axial/radial) [mm]."""
        root_point = np.array([-self.root_apex, 0.0]) + self.clearance * self._root_normal
        lines = [(root_point, self.root_angle), (np.array([-self.face_apex, 0.0]), self.face_angle)]
        corners = np.empty((2, 2, 2))
        ends = (self.outer_cone_distance - self.face_width, self.outer_cone_distance)
        for i, (distance, angle) in enumerate(zip(ends, (self.front_angle, self.back_angle), strict=True)):
            end_angle = (self.pitch_angle if angle is None else angle) + np.pi / 2
            on_pitch = distance * np.array([np.cos(self.pitch_angle), np.sin(self.pitch_angle)])
            on_pitch[0] -= self.pitch_apex
            for j, (point, line_angle) in enumerate(lines):
                matrix = np.array([[np.cos(line_angle), -np.cos(end_angle)], [np.sin(line_angle), -np.sin(end_angle)]])
                along = np.linalg.solve(matrix, on_pitch - point)[0]
                corners[i, j] = point + along * np.array([np.cos(line_angle), np.sin(line_angle)])
        return corners

    def points(self, lengthwise: Array, profile: Array) -> Array:
        """Axial and radial coordinates (2, ...) [mm] of the given fractions (...)."""
        corners = self.corners
        t, h = np.broadcast_arrays(lengthwise, profile)
        root = np.multiply.outer(corners[0, 0], 1.0 - t) + np.multiply.outer(corners[1, 0], t)
        tip = np.multiply.outer(corners[0, 1], 1.0 - t) + np.multiply.outer(corners[1, 1], t)
        return np.asarray(root * (1.0 - h) + tip * h)

    def fractions(self, axial: Array, radial: Array) -> tuple[Array, Array]:
        """Lengthwise and profile fractions (...) of axial and radial coordinates (...) [mm].

        The inverse of ``points``, by the quadratic of the bilinear map; NaN where there is none.
        """
        corners = self.corners
        base = corners[0, 0]
        along = corners[1, 0] - base
        up = corners[0, 1] - base
        twist = corners[1, 1] - corners[1, 0] - up
        x, y = axial - base[0], radial - base[1]

        # (x, y) = along t + up h + twist t h; crossing with (up + twist t) removes h.
        quadratic = determinant(along, twist)
        linear = determinant(along, up) + determinant(twist, (x, y))
        constant = determinant(up, (x, y))
        # Of the two solutions that one at which the map turns as at the corner; the other lies beyond the apex of the
        # ends. Of its two forms that one whose terms do not cancel.
        turn = np.sign(determinant(along, up))
        with np.errstate(invalid="ignore", divide="ignore"):
            root = turn * np.sqrt(linear**2 - 4.0 * quadratic * constant)
            t = np.where(
                turn * linear.real >= 0.0, -2.0 * constant / (linear + root), (root - linear) / (2.0 * quadratic)
            )
        direction = up[:, None] + np.multiply.outer(twist, np.ravel(t))
        offset = np.stack([np.ravel(x - along[0] * t), np.ravel(y - along[1] * t)])
        h = np.einsum("ij,ij->j", direction, offset) / np.einsum("ij,ij->j", direction, direction)
        return np.asarray(t), h.reshape(np.shape(t))

    @property
    def middle_distance(self) -> float:
        """Distance of the middle of the face from the pitch apex, along the pitch cone [mm]."""
        return self.outer_cone_distance - 0.5 * self.face_width

    def on_pitch_cone(self, distance: float) -> Array:
        """Axial and radial coordinate (2) [mm] of a point of the pitch cone, by its distance from the apex [mm]."""
        direction = np.array([np.cos(self.pitch_angle), np.sin(self.pitch_angle)])
        return np.asarray(distance * direction - np.array([self.pitch_apex, 0.0]))

    def height_above_root(self, axial: Array, radial: Array) -> Array:
        """Distance from the root cone, at right angles to it [mm]; positive towards the tip."""
        normal = self._root_normal
        return np.asarray((axial + self.root_apex) * normal[0] + radial * normal[1])
