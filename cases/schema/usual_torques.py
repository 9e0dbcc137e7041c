"""Torques at the pinion: those allowed, and those of a case that gives none, in proportion to its teeth."""

from __future__ import annotations

# Tangential force at the pinion's outer pitch circle over face width and outer transverse module: the unit load of the
# shipped cases at their middle torque, 38 to 49 N/mm^2.
UNIT_LOAD = 40.0  # [N/mm^2]
SHARES = (0.2, 1.0, 2.0)
TORQUE_MINIMUM, TORQUE_LIMIT = 1e-6, 1e7  # [N m]; less is no load


def torque_range() -> str:
    """Torques allowed, in words."""
    return f"at least {TORQUE_MINIMUM:g} and below {TORQUE_LIMIT:g} N m"


def usual_torques(outer_module: float, face_width: float, pinion_teeth: int) -> tuple[float, ...]:
    """Light, middle and heavy pinion torque [N m], to two figures, from outer module and face width [mm].

    A pair twice as large carries eight times the torque at the same stress.
    """
    middle = 1e-3 * UNIT_LOAD * face_width * outer_module * outer_module * pinion_teeth / 2.0
    return tuple(float(f"{share * middle:.1e}") for share in SHARES)
