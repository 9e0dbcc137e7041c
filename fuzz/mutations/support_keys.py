"""Supports of a case: tables of each kind, and keys with values at and beyond their limits."""

from __future__ import annotations

from typing import Any

NAN = float("nan")
HEAD: dict[str, Any] = {"name": "head", "position": 99.0, "radial_stiffness": 9e5, "axial_stiffness": 2e5}
TAIL: dict[str, Any] = {"name": "tail", "position": 162.0, "radial_stiffness": [[1e3, 6e5], [1e4, 8e5]]}
SECTION: dict[str, Any] = {"start": 65.0, "end": 200.0, "outer_diameter": 40.0, "inner_diameter": 8.0}
SHAFT: dict[str, Any] = {"sections": [SECTION], "torque_position": 190.0}


def diagonal(size: int, forces: float, moments: float) -> list[list[float]]:
    """Diagonal matrix of members' stiffness [N/mm, N mm/rad] or compliance."""
    entries = ([forces] * 3 + [moments] * 3) * (size // 6)
    return [[entries[row] if row == column else 0.0 for column in range(size)] for row in range(size)]


MATRIX: dict[str, Any] = {"reference": [87.0, 20.0, 0.0], "stiffness": diagonal(6, 4e5, 1e9)}
HOUSING: dict[str, Any] = {
    "pinion_reference": [87.0, 20.0, 0.0],
    "gear_reference": [0.0, 0.0, 30.0],
    "compliance": diagonal(12, 2e-6, 1e-9),
}
SUPPORTS: tuple[dict[str, Any], ...] = (
    {"pinion": {"shaft": SHAFT, "bearings": [HEAD, TAIL]}},
    {"pinion": {"shaft": SHAFT, "bearings": [HEAD, TAIL]}, "gear": MATRIX, "wind_up": True, "rounds": "position"},
    {"pinion": MATRIX, "rounds": "none"},
    {"housing": HOUSING},
)
SUPPORT_KEYS: dict[str, tuple[Any, ...]] = {
    "supports": (*SUPPORTS, {}, [], True),
    "supports.rounds": ("mean", "position", "none", "x", 3),
    "supports.wind_up": (True, False, 1, "yes"),
    "supports.pinion": (MATRIX, {}, {"shaft": SHAFT}, {"bearings": [HEAD, TAIL]}, MATRIX | {"shaft": SHAFT}),
    "supports.gear": (MATRIX, {"reference": [0.0] * 3, "stiffness": diagonal(6, 0.0, 0.0)}),
    "supports.housing": (HOUSING, {}, HOUSING | {"compliance": diagonal(6, 2e-6, 1e-9)}),
    "supports.pinion.reference": ([0.0, 0.0], [NAN] * 3, [1e9, 0.0, 0.0], [0.0, 5.0, 0.0]),
    "supports.pinion.stiffness": tuple(
        diagonal(size, forces, moments)
        for size, forces, moments in (
            (6, 4e5, 1e9), (6, 4e8, 1e9), (6, 4e5, 1e3), (6, -4e5, 1e9), (6, 0.0, 1e9), (6, NAN, 1e9), (6, 1e-300, 1e9),
            (6, 1e300, 1e300), (6, 1e3, 1e7), (12, 4e5, 1e9),
        )
    ),
    "supports.pinion.compliance": (diagonal(6, 2e-6, 1e-9), diagonal(6, 1e-3, 1e-6), diagonal(6, 1e-12, 1e-15)),
    "supports.pinion.shaft": (SHAFT, {"sections": []}, {"sections": [SECTION] * 2}, {"sections": [SECTION] * 200}),
    "supports.pinion.shaft.seat": (80.0, 500.0, -500.0, NAN),
    "supports.pinion.shaft.torque_position": (65.0, 1e9, NAN),
    "supports.pinion.shaft.elastic_modulus": (94e3, 0.0, 1e300),
    "supports.pinion.bearings": (
        [HEAD], [HEAD, HEAD], [HEAD, TAIL] * 20, [HEAD | {"position": 65.0}, TAIL], [HEAD | {"position": 999.0}, TAIL],
        [TAIL, TAIL | {"name": "x"}], [HEAD | {"tilting_stiffness": 1e9}], [HEAD | {"name": "\x1b[2J"}, TAIL],
        [HEAD | {"radial_stiffness": 1e-9}, TAIL], [HEAD | {"radial_stiffness": [[1.0, 1.0]] * 2}, TAIL],
        [HEAD | {"radial_displacement": [[1e3, 1e-3], [1e4, 1e-9]]}, TAIL],
        [HEAD, TAIL | {"radial_stiffness": [[1e-300, 1e3], [1e300, 1e9]]}],
    ),
}  # fmt: skip
