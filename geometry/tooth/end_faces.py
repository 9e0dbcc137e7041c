"""Toe and heel faces of a tooth: how they stand to its loaded flank, and how high they are.

The ends of spiral teeth are blunt or sharp wedges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..pair.gear_pair import Member


@dataclass(frozen=True)
class EndFace:
    """One end of a tooth.

    Parameters
    ----------
    slant
        Angle of the face against the normal of the flank [rad], positive where the tooth is a sharp wedge.
    height
        From root to tip [mm].
    """

    slant: float
    height: float


def end_faces(member: Member) -> tuple[EndFace, EndFace]:
    """Toe and heel; the slants are those in the middle of the height.

    Parameters
    ----------
    member
        The member.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> [(round(float(np.degrees(end.slant))), round(end.height, 1)) for end in end_faces(pair.pinion)]
    [(-30, 5.7), (39, 8.2)]
    """
    corners = member.section.corners
    found = member.flank(np.array([0.0, 1.0]), np.array([0.5]))
    up = corners[:, 1] - corners[:, 0]
    heights = np.linalg.norm(up, axis=1)
    face = np.stack([up[:, 1], -up[:, 0]], axis=1) / heights[:, None]  # (axial, radial)
    outward = np.array([[-1.0], [1.0]]) * (corners[1] - corners[0]).mean(axis=0)
    face *= np.sign(np.sum(face * outward, axis=1, keepdims=True))
    radial = found.position[:2] / np.hypot(*found.position[:2])
    agreeing = face[:, 0] * found.normal[2] + face[:, 1] * np.sum(radial * found.normal[:2], axis=0)
    toe, heel = (
        EndFace(float(slant), float(height)) for slant, height in zip(-np.arcsin(agreeing), heights, strict=True)
    )
    return toe, heel
