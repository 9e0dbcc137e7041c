"""The flanks of another program's session script, computed from its own keywords, without the package.

The order of the joints and their signs are those of the public code SpyGO (``haomjc/SpyGO``, ``kinematics.py`` and
``data_structs.py`` in ``OriginalCode/hypoid/main``), read for these facts alone; no code of it is here. Velocities are
finite differences of positions, the point of the blade that touches the flank is found by bisection, and the point of
the flank with given coordinates by Newton's method on top of that.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy.optimize import brentq, fsolve

Array = np.ndarray[Any, Any]
Numbers = Mapping[str, float]
Edge = Callable[[float], tuple[float, float, float, float]]
"""Radius and height (towards the blank) of the blade at a distance along it, and its normal, out of the tool."""

ROLL = ("RATIOROLL", "MODROLL_2C", "MODROLL_6D", "MODROLL_24E", "MODROLL_120F", "MODROLL_720G")
JOINTS: Mapping[str, tuple[str, ...]] = {
    "RADIAL": ("RADIALSETTING", *(f"R{n}" for n in range(1, 7))),
    "TILT": ("TILTANGLE",),
    "SWIVEL": ("SWIVELANGLE",),
    "OFFSET": ("BLANKOFFSET", *(f"V{n}" for n in range(1, 7))),
    "SLIDING": ("SLIDINGBASE", *(f"H{n}" for n in range(1, 7))),
    "CRADLE": ("CRADLEANGLE",),
    "CENTER": ("MACHCTRBACK",),
    "ROOT": ("ROOTANGLE",),
}
PLUS = "+++++++"
SIGNS: Mapping[tuple[str, str], Mapping[str, str]] = {
    ("PINION", "LEFT"): {"TILT": "-", "SWIVEL": "-", "CRADLE": "-", "ROLL": "+-----"},
    ("PINION", "RIGHT"): {"OFFSET": "-------", "SLIDING": "+-+-+-+", "ROLL": "++-+-+"},
    ("GEAR", "LEFT"): {"TILT": "-", "OFFSET": "-++++++", "ROLL": "+-----"},
    ("GEAR", "RIGHT"): {
        "RADIAL": "+++-+++",
        "OFFSET": "++-+-++",
        "SLIDING": "+-+-+-+",
        "CRADLE": "-",
        "ROLL": "++-+-+",
    },
}
"""Signs of a joint's constant, first derivative and so on, by member and hand of the pinion; plus where not given."""


def _spin(axis: str, angle: float) -> Array:
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(4)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[i, j], matrix[j, i] = -np.sin(angle), np.sin(angle)
    return matrix


def _shift(axis: str, distance: float) -> Array:
    matrix = np.eye(4)
    matrix["xyz".index(axis), 3] = distance
    return matrix


def chain(member: str, hand: str, machine: Numbers, phi: float) -> Array:
    """Pose of the tool in the frame of the work at a cradle increment [rad]; ``hand`` is that of the pinion."""
    signs = SIGNS[(member, hand)]

    def joint(name: str) -> float:
        total = 0.0
        for n, (keyword, sign) in enumerate(zip(JOINTS[name], signs.get(name, PLUS), strict=False)):
            total += float(f"{sign}1") * machine.get(keyword, 0.0) * phi**n / math.factorial(n)
        return total

    angle = {name: math.radians(joint(name)) for name in ("TILT", "SWIVEL", "CRADLE", "ROOT")}
    ratio = machine.get("RATIOROLL", 0.0)
    roll = ratio * phi
    for n, (keyword, sign) in enumerate(zip(ROLL, signs["ROLL"], strict=True), start=1):
        if n > 1:
            roll += float(f"{sign}1") * ratio * machine.get(keyword, 0.0) * phi**n / math.factorial(n)
    base = np.array([[0.0, 0, -1, 0], [0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
    return np.asarray(
        _spin("z", -roll) @ _shift("z", -joint("CENTER")) @ _spin("y", angle["ROOT"]) @ _shift("x", joint("SLIDING"))
        @ _shift("y", joint("OFFSET")) @ _spin("x", -angle["CRADLE"] - phi) @ _shift("z", joint("RADIAL"))
        @ _spin("x", angle["SWIVEL"]) @ _spin("z", angle["TILT"]) @ base
    )  # fmt: skip


def straight(cutter: Numbers, flank: str) -> Edge:
    """A straight blade; that of the concave flank is outside."""
    out, angle = (1.0 if flank == "CONCAVE" else -1.0), math.radians(cutter["BLADEANGLE"])

    def edge(s: float) -> tuple[float, float, float, float]:
        radius = cutter["POINTRADIUS"] + out * s * math.sin(angle)
        return radius, -s * math.cos(angle), out * math.cos(angle), math.sin(angle)

    return edge


def curved(cutter: Numbers, flank: str) -> Edge:
    """A blade that is an arc of radius RHO through the tip, with BLADEANGLE there; s is the arc length."""
    out, rho, angle = (1.0 if flank == "CONCAVE" else -1.0), cutter["RHO"], math.radians(cutter["BLADEANGLE"])

    def edge(s: float) -> tuple[float, float, float, float]:
        here = angle + s / rho
        radius = cutter["POINTRADIUS"] + out * rho * (math.cos(angle) - math.cos(here))
        return radius, rho * (math.sin(angle) - math.sin(here)), out * math.cos(here), math.sin(here)

    return edge


def _swept(edge: Edge, s: float, theta: float) -> tuple[Array, Array]:
    radius, height, n_r, n_z = edge(s)
    cosine, sine = math.cos(theta), math.sin(theta)
    return np.array([radius * cosine, radius * sine, height, 1.0]), np.array([n_r * cosine, n_r * sine, n_z, 0.0])


def touching(member: str, hand: str, machine: Numbers, edge: Edge, theta: float, phi: float) -> tuple[float, Array]:
    """Distance along the blade at which it touches the flank, and that point in the frame of the work."""
    step = 1e-4
    before, here, behind = (chain(member, hand, machine, phi + k * step) for k in (-1, 0, 1))
    velocity = (behind - before) / (2.0 * step)

    def meshing(s: float) -> float:
        point, normal = _swept(edge, s, theta)
        return float((here @ normal) @ (velocity @ point))

    s = float(brentq(meshing, -30.0, 40.0, xtol=1e-12))
    return s, (here @ _swept(edge, s, theta)[0])[:3]


def flank_points(member: str, hand: str, machine: Numbers, edge: Edge, near: Array) -> Array:
    """Points (3, n) of the flank with the axial and radial coordinates of points (3, n) that are nearly they."""
    formate = "RATIOROLL" not in machine

    def point(unknowns: Array) -> tuple[float, Array]:
        theta, second = unknowns
        if formate:
            return second, (chain(member, hand, machine, 0.0) @ _swept(edge, second, theta)[0])[:3]
        return touching(member, hand, machine, edge, theta, second)

    starts = []
    for theta in np.linspace(-math.pi, math.pi, 25):
        for second in np.linspace(0.5, 12.5, 5) if formate else np.linspace(-0.6, 0.6, 5):
            with contextlib.suppress(ValueError):  # no point of this blade touches
                distance, found = point(np.array([theta, second]))
                # The envelope goes on beyond the tip of the blade, where nothing is cut.
                if distance > 0.0:
                    starts.append((theta, second, *found))
    lattice = np.array(starts)
    result = []
    for x, y, z in near.T:
        target = np.array([z, math.hypot(x, y)])

        def mismatch(unknowns: Array, target: Array = target) -> Array:
            found = point(unknowns)[1]
            return np.array([found[2], math.hypot(found[0], found[1])]) - target

        start = lattice[np.argmin(np.linalg.norm(lattice[:, 2:] - (x, y, z), axis=1)), :2]
        solution = fsolve(mismatch, start, xtol=1e-10)
        assert np.abs(mismatch(solution)).max() < 1e-7
        result.append(point(solution)[1])
    return np.array(result).T
