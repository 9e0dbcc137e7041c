"""Position of the two members: axes, offset, misalignment and sense of rotation.

Global frame: the gear axis is z, from the crossing point to the heel; x points from the gear axis to the mesh, so that
the nominal pinion axis is (sin Sigma, 0, cos Sigma); y is along the offset.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...core.arrays import Array
from ...core.checks import check_fields
from ..cutting.generating_surface import Hand
from ..vectors import column


@dataclass(frozen=True)
class Misalignment:
    """Assembly errors (Kolivand 2009, section 2.6; the signs are stated here, the dissertation leaves them open).

    Parameters
    ----------
    offset
        E: increase of the offset [mm].
    pinion_axial
        P: pinion away from the crossing point along its axis [mm].
    gear_axial
        G: gear away from the crossing point along its axis, out of mesh [mm].
    shaft_angle
        Increase of the shaft angle [rad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> moved = pair.misaligned(Misalignment(offset=0.1, shaft_angle=0.001))
    >>> moved.assembly.misalignment.offset
    0.1
    """

    offset: float = 0.0
    pinion_axial: float = 0.0
    gear_axial: float = 0.0
    shaft_angle: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "misalignment ")


@dataclass(frozen=True)
class Assembly:
    """A pair of members in mesh.

    Parameters
    ----------
    pinion_teeth, gear_teeth
        Numbers of teeth.
    pinion_hand
        Hand of spiral of the pinion; the gear has the other one.
    shaft_angle
        Angle between the axes [rad].
    hypoid_offset
        Distance between the axes [mm]; positive: pinion below centre for a left-hand pinion, in the usual hypoid sense.
    misalignment
        Assembly errors.

    Examples
    --------
    >>> from math import pi
    >>> assembly = Assembly(11, 44, pinion_hand="left", shaft_angle=pi / 2, hypoid_offset=20.0)
    >>> assembly.ratio, assembly.gear_hand
    (4.0, 'right')
    """

    pinion_teeth: int
    gear_teeth: int
    pinion_hand: Hand
    shaft_angle: float
    hypoid_offset: float
    misalignment: Misalignment = Misalignment()

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def ratio(self) -> float:
        """Gear teeth over pinion teeth, R."""
        return self.gear_teeth / self.pinion_teeth

    @property
    def gear_hand(self) -> Hand:
        """Hand of spiral of the gear."""
        return "right" if self.pinion_hand == "left" else "left"

    @property
    def pinion_pitch(self) -> float:
        """Angular pitch of the pinion [rad]: one mesh cycle."""
        return 2.0 * np.pi / self.pinion_teeth

    def misaligned(self, misalignment: Misalignment) -> Assembly:
        """The same pair with other assembly errors."""
        return replace(self, misalignment=misalignment)

    @property
    def pinion_frame(self) -> Array:
        """Rotation (3, 3) from the pinion frame to the global frame; its last column is the pinion axis."""
        angle = self.shaft_angle + self.misalignment.shaft_angle
        sine, cosine = np.sin(angle), np.cos(angle)
        return np.array([[-cosine, 0.0, sine], [0.0, -1.0, 0.0], [sine, 0.0, cosine]])

    @property
    def pinion_origin(self) -> Array:
        """Origin of the pinion frame (3) in the global frame [mm]."""
        side = 1.0 if self.pinion_hand == "left" else -1.0
        offset = np.array([0.0, side * (self.hypoid_offset + self.misalignment.offset), 0.0])
        return offset + self.misalignment.pinion_axial * self.pinion_frame[:, 2]

    @property
    def gear_origin(self) -> Array:
        """Origin of the gear frame (3) in the global frame [mm]."""
        return np.array([0.0, 0.0, self.misalignment.gear_axial])

    def pinion_to_global(self, position: Array, normal: Array) -> tuple[Array, Array]:
        """Pinion positions [mm] and normals (3, n) in the global frame, at zero rotation."""
        frame = self.pinion_frame
        turned = np.tensordot(frame, position, axes=1)
        return turned + column(self.pinion_origin, turned), np.tensordot(frame, normal, axes=1)
