"""The settings of the cradle machine, and the rotation of the work with the cradle (Kolivand 2009, Eq. 2.4a).

Everything here describes a *right-hand* member; a left-hand one is its mirror image (see ``generating_surface``).

Machine frame: z along the cradle axis, towards the blank; x along the root line when sliding base, machine centre to
crossing point and work offset are zero. Member frame: z along the member's own axis, from the crossing point to the
heel; the tooth lies near the x axis.

Any setting may be a polynomial in the cradle increment: helical motion moves the sliding base, vertical motion the work
offset, and so on. Everything is seen from a frame that turns with the cradle, x towards the cutter centre; there the
velocity of a blade point relative to the work is a spin and a shift, whatever moves. The chain from the cutter to the
member being cut is that of Kolivand 2009, Eq. 2.7.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np

from ...core.arrays import Array
from ...core.checks import array, check_fields, one_of, shown
from ...core.errors import InputError
from ..vectors import cos_sin, cross, turn_z

MOVING_SETTINGS = (
    "radial_distance",
    "machine_root_angle",
    "work_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
    "cutter_tilt",
    "cutter_swivel",
)


@dataclass(frozen=True)
class MachineSettings:
    """Basic settings of a hypoid generator, in the standard Gleason meaning.

    Parameters
    ----------
    radial_distance
        Cutter centre from the cradle axis [mm].
    cradle_angle
        Basic cradle angle, from the root line to the cutter centre [rad].
    machine_root_angle
        Angle between the work axis and the cradle plane [rad].
    work_offset
        Work (blank) offset [mm]; positive up for a left-hand member.
    sliding_base
        Position of the sliding base [mm].
    machine_center_to_crossing_point
        Machine centre to crossing point (machine centre to back), along the work axis [mm].
    cutter_tilt, cutter_swivel
        Tilt of the cutter axis, and direction of the tilt [rad].
    ratio_of_roll
        Rotation of the work per rotation of the cradle; ``None`` for a Formate (non-generated) member.
    modified_roll
        Coefficients (C, D, E, ...) of work rotation = ratio (p - C p^2 - D p^3 - ...), p the cradle increment;
        C in rad^-1, D in rad^-2 and so on.
    indexing_ratio
        Face hobbing: blade groups over teeth, N_t / N; the work turns by this times the cutter angle, against it. Zero
        for face milling (Kolivand 2009, Eq. 2.1).
    motions
        Higher-order motions: names of settings and coefficients (c1, c2, ...) of setting + c1 p + c2 p^2 + ..., p the
        cradle increment [rad]. ``sliding_base`` is helical motion, ``work_offset`` vertical motion.

    Examples
    --------
    Without a ratio of roll the member is Formate, with one it is generated:

    >>> settings = MachineSettings(radial_distance=97.0, cradle_angle=1.04, machine_root_angle=1.17)
    >>> settings.generated
    False
    >>> from dataclasses import replace
    >>> replace(settings, ratio_of_roll=1.05, motions=(("sliding_base", (0.6,)),)).generated
    True
    """

    radial_distance: float
    cradle_angle: float
    machine_root_angle: float
    work_offset: float = 0.0
    sliding_base: float = 0.0
    machine_center_to_crossing_point: float = 0.0
    cutter_tilt: float = 0.0
    cutter_swivel: float = 0.0
    ratio_of_roll: float | None = None
    modified_roll: tuple[float, ...] = ()
    indexing_ratio: float = 0.0
    motions: tuple[tuple[str, tuple[float, ...]], ...] = ()

    def __post_init__(self) -> None:
        check_fields(self)
        array("modified_roll", self.modified_roll, ndim=1)
        given: Any = self.motions
        motions = given if isinstance(given, tuple | list) else (given,)
        if not all(isinstance(motion, tuple | list) and len(motion) == 2 for motion in motions):
            raise InputError(f"motions = {shown(self.motions)}: must be pairs of a name and coefficients")
        for name, coefficients in self.motions:
            array(f"motion of {one_of('motion', name, MOVING_SETTINGS)}", coefficients, ndim=1)
        if self.ratio_of_roll is None and self.motions:
            raise InputError("motions are given but ratio_of_roll is not: nothing moves while a Formate member is cut")
        if self.ratio_of_roll is None and len(self.modified_roll):
            raise InputError("modified_roll is given but ratio_of_roll is not: a Formate member has no generating roll")

    @property
    def generated(self) -> bool:
        """True if the member is generated (rolled); if not, it is Formate."""
        return self.ratio_of_roll is not None


IncrementSense = Literal[-1, 1]
"""Sense of the cradle increment seen from a right-hand member: +1 for a gear, -1 for a pinion.

A pair is cut with one sense of the cradle, so that its two members, of opposite hand, differ here. It matters for the
even orders of the modified roll only.
"""


def work_rotation(settings: MachineSettings, cradle_rotation: Any, sense: IncrementSense) -> tuple[Any, Any]:
    """Rotation of the work [rad], with modified roll, and its derivative by the cradle's (Kolivand 2009, Eq. 2.4a)."""
    ratio = settings.ratio_of_roll or 0.0
    increment = sense * cradle_rotation
    rotation = increment
    derivative = np.ones_like(increment)
    for index, coefficient in enumerate(settings.modified_roll):
        power = index + 2
        rotation = rotation - coefficient * increment**power
        derivative = derivative - power * coefficient * increment ** (power - 1)
    return sense * ratio * rotation, ratio * derivative


@dataclass(frozen=True, eq=False)
class MachinePose:
    """Machine at n cradle rotations, in the frame that turns with the cradle; vectors are (3, n) or (3, 1).

    One is made in every step of an iteration, and none is handed on: its arrays are not locked.
    """

    frame: tuple[Array, Array, Array]  # axes of the cutter, x and y before it turns, z towards the blank
    center: Array  # of the blade tip plane [mm]
    axis: Array
    origin: Array
    spin: Array  # velocity of a blade point p relative to the work, by the cradle: spin x p + shift
    shift: Array
    cradle: Array
    work: Array
    cradle_turn: tuple[Array, Array]
    root_turn: tuple[Array, Array]

    def to_member(self, vector: Array, indexing: Array, *, point: bool) -> Array:
        """Position [mm] or direction (3, n) from the cradle's frame into the member's, ``indexing`` beyond the roll."""
        return self._to_member(vector - self.origin if point else vector, cos_sin(-self.work - indexing))

    def both_to_member(self, position: Array, direction: Array, indexing: Array) -> tuple[Array, Array]:
        """``to_member`` of a position and a direction."""
        turn = cos_sin(-self.work - indexing)
        return self._to_member(position - self.origin, turn), self._to_member(direction, turn)

    def _to_member(self, vector: Array, turn: tuple[Array, Array]) -> Array:
        x, y, z = turn_z(*self.cradle_turn, vector)
        cosine, sine = self.root_turn
        return turn_z(*turn, (sine * x - cosine * z, y, cosine * x + sine * z))


def _moving(settings: MachineSettings, name: str, increment: Array, sense: int) -> tuple[Array, Array]:
    """Value of a setting (n) and its derivative by the cradle rotation."""
    coefficients = dict(settings.motions).get(name, ()) if settings.motions else ()
    value = np.full(increment.shape, getattr(settings, name), dtype=increment.dtype)
    derivative = np.zeros_like(value)
    for order, coefficient in enumerate(coefficients, start=1):
        value = value + coefficient * increment**order
        derivative = derivative + sense * order * coefficient * increment ** (order - 1)
    return value, derivative


def machine_pose(settings: MachineSettings, cradle_rotation: Array, sense: IncrementSense) -> MachinePose:
    """Machine with its motions at cradle rotations (n) [rad] about the machine z axis."""
    # Without motions one column stands for all n rotations.
    still = not settings.motions
    state = _still_machine(settings) if still else _machine_at(settings, sense * cradle_rotation, sense)
    value, rate, frame, center, along, crossing_point, root_turn = state
    zero = np.zeros_like(center[0])
    cradle = settings.cradle_angle + cradle_rotation
    work, ratio = work_rotation(settings, cradle_rotation, sense)
    turn = cos_sin(cradle)
    back = turn[0], -turn[1]
    axis, origin = turn_z(*back, tuple(along)), turn_z(*back, tuple(crossing_point))
    spin, shift = -ratio * axis, ratio * cross(axis, origin)
    spin[2] = spin[2] + 1.0
    if not still:
        cos_g, sin_g = root_turn
        distance = value["machine_center_to_crossing_point"]
        turning = rate["cutter_tilt"] * frame[0] + np.stack([zero, zero, -rate["cutter_swivel"]])
        tilting = rate["machine_root_angle"]
        moving = rate["machine_center_to_crossing_point"] * along + distance * tilting * np.stack([-sin_g, zero, cos_g])
        moving = moving + np.stack([zero, rate["work_offset"], rate["sliding_base"]])
        pivot = turn_z(*back, (zero, tilting, zero))
        spin = spin + turning + pivot
        shift = shift - cross(turning, center) - cross(pivot, origin) - turn_z(*back, tuple(moving))
        shift[0] = shift[0] + rate["radial_distance"]
    return MachinePose(frame, center, axis, origin, spin, shift, cradle, work, turn, root_turn)


_State = tuple[dict[str, Array], dict[str, Array], tuple[Array, Array, Array], Array, Array, Array, tuple[Array, Array]]


def _machine_at(settings: MachineSettings, increment: Array, sense: int) -> _State:
    """Machine at cradle increments (n) [rad], not turned with the cradle, as a tuple.

    Settings, their derivatives by the cradle rotation, axes of the cutter, its centre, direction of the work axis,
    crossing point, and cosine and sine of the machine root angle.
    """
    value: dict[str, Array] = {}
    rate: dict[str, Array] = {}
    for name in MOVING_SETTINGS:
        value[name], rate[name] = _moving(settings, name, increment, sense)
    zero = np.zeros_like(increment)
    cos_j, sin_j = cos_sin(value["cutter_swivel"])
    cos_i, sin_i = cos_sin(value["cutter_tilt"])
    frame = (
        np.stack([cos_j, -sin_j, zero]),
        np.stack([sin_j * cos_i, cos_j * cos_i, sin_i]),
        np.stack([-sin_j * sin_i, -cos_j * sin_i, cos_i]),
    )
    center = np.stack([value["radial_distance"], zero, zero])
    cos_g, sin_g = cos_sin(value["machine_root_angle"])
    along = np.stack([cos_g, zero, sin_g])
    crossing_point = value["machine_center_to_crossing_point"] * along
    crossing_point = crossing_point + np.stack([zero, value["work_offset"], value["sliding_base"]])
    return value, rate, frame, center, along, crossing_point, (cos_g, sin_g)


@lru_cache(maxsize=64)
def _still_machine(settings: MachineSettings) -> _State:
    return _machine_at(settings, np.zeros(1), 1)
