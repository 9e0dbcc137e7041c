"""How toe and heel faces of a tooth stand to its loaded flank: the ends of spiral teeth are blunt or sharp wedges."""

from __future__ import annotations

import numpy as np

from ..pair.gear_pair import Member


def end_slants(member: Member) -> tuple[float, float]:
    """Angles of toe and heel faces against the normal of the loaded flank, in the middle of its height [rad].

    Positive where the tooth is a sharp wedge.

    Parameters
    ----------
    member
        The member.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> [round(float(np.degrees(slant))) for slant in end_slants(pair.pinion)]
    [-30, 39]
    """
    ends, corners = np.array([0.0, 1.0]), member.section.corners
    found = member.flank(ends, np.array([0.5]))
    up = corners[:, 1] - corners[:, 0]
    face = np.stack([up[:, 1], -up[:, 0]], axis=1) / np.linalg.norm(up, axis=1, keepdims=True)  # (axial, radial)
    outward = np.array([[-1.0], [1.0]]) * (corners[1] - corners[0]).mean(axis=0)
    face *= np.sign(np.sum(face * outward, axis=1, keepdims=True))
    radial = found.position[:2] / np.hypot(*found.position[:2])
    agreeing = face[:, 0] * found.normal[2] + face[:, 1] * np.sum(radial * found.normal[:2], axis=0)
    toe, heel = -np.arcsin(agreeing)
    return float(toe), float(heel)
