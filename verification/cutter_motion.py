"""Motion of the cutter relative to the work as a product of elementary rotations, joint by joint.

It shares nothing with the pose that generates the flanks: no velocities, no equation of meshing, no frame that turns
with the cradle. From the blade to the member (Kolivand 2009, Eq. 2.5 to 2.7): rake, hook and offset of the blade,
cutter angle, tilt and swivel, radial distance, cradle, work offset, sliding base and machine centre to crossing point,
machine root angle, roll of the work.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..geometry.cutting.blade import Blade
from ..geometry.cutting.blade_sections import BladeSection
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.cutting.machine import MachineSettings

Array = NDArray[Any]


def cutter_position(
    surface: GeneratingSurface, coordinate: Array, cutter_angle: Array, cradle_rotation: Array
) -> Array:
    """Positions of points of the blade in the frame of the member being cut.

    Parameters
    ----------
    surface
        Blade, settings and hand.
    coordinate
        Where on the blade (n), see ``blade_sections`` [mm].
    cutter_angle
        Angle of the cutter (n) [rad].
    cradle_rotation
        Rotation of the cradle (n) [rad]; zero for a Formate member.

    Returns
    -------
    Array
        Positions (3, n) [mm].

    Examples
    --------
    The cutter carries the blade's point through the flank:

    >>> from easeoff.cases import gear_pair, read_case
    >>> pinion = gear_pair(read_case("nasa-12x36")).pinion
    >>> middle = pinion.middle()
    >>> found = cutter_position(pinion.loaded, middle.blade_distance, *middle.parameters)
    >>> np.allclose(found, middle.position, atol=1e-10)
    True
    """
    settings, sense = surface.settings, surface.sense
    increment = sense * np.asarray(cradle_rotation, dtype=float)

    def joint(name: str) -> Array:
        coefficients = (getattr(settings, name), *dict(settings.motions).get(name, ()))
        return np.asarray(np.polynomial.polynomial.polyval(increment, coefficients)) + 0.0 * increment

    point = _turned("z", cutter_angle, _blade_point(surface.blade, surface.section, coordinate))
    point = _turned("z", -joint("cutter_swivel"), _turned("x", joint("cutter_tilt"), point))
    point = _shifted(point, x=joint("radial_distance"))
    point = _turned("z", settings.cradle_angle + cradle_rotation, point)
    point = _shifted(point, y=-joint("work_offset"), z=-joint("sliding_base"))
    # The work axis stands in the machine's x-z plane, at the machine root angle from x: it becomes z of the member.
    x, y, z = _turned("y", joint("machine_root_angle"), point)
    point = np.stack([-z, y, x - joint("machine_center_to_crossing_point")])
    turned = sense * _roll(settings, increment) - settings.indexing_ratio * cutter_angle
    x, y, z = _turned("z", -turned, point)
    return np.stack([x, y if surface.hand == "right" else -y, z])


def _blade_point(blade: Blade, section: BladeSection, coordinate: Array) -> Array:
    """Points (3, n) of the edge in the frame that turns with the blade: radial, tangential, along the cutter axis."""
    along = coordinate - section.begin
    angle = section.angle + section.rate * along
    if section.radius is None:
        outward, height = section.outward + along * np.sin(angle), section.height + along * np.cos(angle)
    else:
        center = section.center
        outward, height = center[0] - section.radius * np.cos(angle), center[1] + section.radius * np.sin(angle)
    point = np.stack([blade.side_sign * outward, np.zeros_like(outward), -height])
    point = _turned("x", blade.hook_angle, _turned("z", blade.rake_angle, point))
    return _turned("z", blade.offset_angle, _shifted(point, x=blade.point_radius))


def _roll(settings: MachineSettings, increment: Array) -> Array:
    """Rotation of the work at a cradle increment (n) [rad], modified roll included."""
    coefficients = (0.0, 1.0, *(-c for c in settings.modified_roll))
    return (settings.ratio_of_roll or 0.0) * np.asarray(np.polynomial.polynomial.polyval(increment, coefficients))


def _turned(axis: str, angle: Any, vector: Array) -> Array:
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    cosine, sine = np.cos(angle), np.sin(angle)
    turned = [np.asarray(one) + 0.0 * cosine for one in vector]
    turned[i], turned[j] = cosine * vector[i] - sine * vector[j], sine * vector[i] + cosine * vector[j]
    return np.stack(turned)


def _shifted(vector: Array, x: Any = 0.0, y: Any = 0.0, z: Any = 0.0) -> Array:
    return np.stack([vector[0] + x, vector[1] + y, vector[2] + z])
