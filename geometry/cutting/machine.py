"""The settings of the cradle machine, and the rotation of the work with the cradle (Kolivand 2009, Eq. 2.4a).

Everything here describes a *right-hand* member; a left-hand one is its mirror image (see ``generating_surface``).

Machine frame: z along the cradle axis, towards the blank; x along the root line when sliding base, machine centre to
crossing point and work offset are zero. Member frame: z along the member's own axis, from the crossing point to the
heel; the tooth lies near the x axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...core.checks import array, check_fields, one_of, shown
from ...core.errors import InputError

Array = NDArray[Any]
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
        """Whether the member is generated (rolled); if not, it is Formate."""
        return self.ratio_of_roll is not None


IncrementSense = Literal[-1, 1]
"""Sense of the cradle increment seen from a right-hand member: +1 for a gear, -1 for a pinion.

A pair is cut with one sense of the cradle, so that its two members, of opposite hand, differ here. It matters for the
even orders of the modified roll only.
"""


def work_rotation(settings: MachineSettings, cradle_rotation: Any, sense: IncrementSense) -> tuple[Any, Any]:
    """Rotation of the work, and its derivative by the cradle rotation.

    Parameters
    ----------
    settings
        Machine settings.
    cradle_rotation
        Rotation of the cradle about the machine z axis [rad].
    sense
        Sense of the cradle increment, see ``IncrementSense``.

    Returns
    -------
    tuple
        Rotation [rad] and ratio, both shaped as ``cradle_rotation`` (Kolivand 2009, Eq. 2.4a, with modified roll).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> rotation, ratio = work_rotation(pair.pinion.loaded.settings, np.array([0.0, 0.1]), pair.pinion.loaded.sense)
    >>> bool(rotation[0] == 0.0), np.allclose(rotation[1] / 0.1, ratio[1])
    (True, True)
    """
    ratio = settings.ratio_of_roll or 0.0
    increment = sense * cradle_rotation
    rotation = increment
    derivative = np.ones_like(increment)
    for index, coefficient in enumerate(settings.modified_roll):
        power = index + 2
        rotation = rotation - coefficient * increment**power
        derivative = derivative - power * coefficient * increment ** (power - 1)
    return sense * ratio * rotation, ratio * derivative
