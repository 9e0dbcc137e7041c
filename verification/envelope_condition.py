"""Envelope condition of a generated flank by finite differences of the cutter's motion.

The blade touches the flank where its edge, its motion by the cutter's turning and its motion by the cradle's lie in one
plane. All three are differences of positions from ``cutter_position``; the product takes them from velocities in closed
form.

The motion is a product of elementary rotations, joint by joint. It shares nothing with the pose that generates the
flanks: no velocities, no equation of meshing, no frame that turns with the cradle. From the blade to the member
(Kolivand 2009, Eq. 2.5 to 2.7): rake, hook and offset of the blade, cutter angle, tilt and swivel, radial distance,
cradle, work offset, sliding base and machine centre to crossing point, machine root angle, roll of the work.

A flank's distance from nominal points is taken along their normals, as a coordinate measuring machine finds it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval

from ..core.arrays import Array, record
from ..core.checks import instance
from ..core.errors import GeometryError
from ..geometry.cutting.blade import Blade, BladeSection
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.flanks.blank_section import BlankSection
from ..geometry.flanks.flank import Flank, on_parts, seed_lattice
from ..geometry.newton import complex_steps, solve
from ..geometry.vectors import cross, dot


def cutter_position(
    surface: GeneratingSurface, coordinate: Array, cutter_angle: Array, cradle_rotation: Array
) -> Array:
    """Positions (3, n) [mm] of blade points (n), see ``blade_sections`` [mm], in the frame of the member being cut.

    Angles of cutter and cradle in [rad]; the cradle's is zero for a Formate member.
    """
    settings, sense = surface.settings, surface.sense
    increment = sense * np.asarray(cradle_rotation, dtype=float)

    def joint(name: str) -> Array:
        coefficients = (getattr(settings, name), *dict(settings.motions).get(name, ()))
        return np.asarray(polyval(increment, coefficients)) + 0.0 * increment

    point = _turned("z", cutter_angle, _blade_point(surface.blade, surface.section, coordinate))
    point = _turned("z", -joint("cutter_swivel"), _turned("x", joint("cutter_tilt"), point))
    point = _shifted(point, x=joint("radial_distance"))
    point = _turned("z", settings.cradle_angle + cradle_rotation, point)
    point = _shifted(point, y=-joint("work_offset"), z=-joint("sliding_base"))
    # The work axis stands in the machine's x-z plane, at the machine root angle from x: it becomes z of the member.
    x, y, z = _turned("y", joint("machine_root_angle"), point)
    point = np.stack([-z, y, x - joint("machine_center_to_crossing_point")])
    roll = polyval(increment, (0.0, 1.0, *(-c for c in settings.modified_roll)))
    turned = sense * ((settings.ratio_of_roll or 0.0) * roll) - settings.indexing_ratio * cutter_angle
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


def _turned(axis: str, angle: Any, vector: Array) -> Array:
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    cosine, sine = np.cos(angle), np.sin(angle)
    turned = [np.asarray(one) + 0.0 * cosine for one in vector]
    turned[i], turned[j] = cosine * vector[i] - sine * vector[j], sine * vector[i] + cosine * vector[j]
    return np.stack(turned)


def _shifted(vector: Array, x: Any = 0.0, y: Any = 0.0, z: Any = 0.0) -> Array:
    return np.stack([vector[0] + x, vector[1] + y, vector[2] + z])


DIFFERENCE_WEIGHTS = ((1, 45.0 / 60.0), (2, -9.0 / 60.0), (3, 1.0 / 60.0))  # central, of sixth order
ANGLE_STEP = 5e-3  # [rad]; with it the difference's error and rounding are both about 1e-11 of the value
EDGE_STEP = 0.05  # [mm]


@record(frozen=True)
class EnvelopeCondition:
    """Flank against cutter at n nodes; NaN where there is no flank.

    Parameters
    ----------
    position
        Distance between the node and the blade's point there [mm].
    normal
        Angle between the flank's normal and the one of edge and cutting motion [rad].
    along_blade
        Distance along the blade from the node's point to where the condition holds [mm]; NaN for a Formate member, on
        which no cradle turns.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> condition = envelope_condition(gear_pair(read_case("nasa-12x36")).pinion.middle())
    >>> condition.along_blade.shape
    (1,)
    """

    position: Array
    normal: Array
    along_blade: Array


def envelope_condition(flank: Flank) -> EnvelopeCondition:
    """Compare a flank's nodes with the motion of the cutter.

    Parameters
    ----------
    flank
        A flank on its nodes.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> condition = envelope_condition(gear_pair(read_case("nasa-12x36")).pinion.middle())
    >>> bool(condition.position[0] < 1e-11), bool(condition.normal[0] < 1e-11), bool(condition.along_blade[0] < 1e-9)
    (True, True, True)
    """
    instance("flank", flank, Flank)

    def on_part(surface: GeneratingSurface, rows: Array) -> Array:
        return _compared(surface, rows[:2], rows[2:5], rows[5:8], rows[8])

    nodes = np.concatenate([flank.parameters, flank.position, flank.normal, flank.blade_distance[None]])
    with np.errstate(all="ignore"):
        position, normal, along = on_parts(flank.surface.flank_parts, flank.part, nodes, on_part)
    missing = ~np.isfinite(flank.position[0])
    return EnvelopeCondition(*(np.where(missing, np.nan, one) for one in (position, normal, along)))


def _compared(
    surface: GeneratingSurface, parameters: Array, position: Array, normal: Array, coordinate: Array
) -> Array:
    angle, second = parameters
    generated = surface.settings.generated
    at = np.stack([coordinate, angle, second if generated else np.zeros_like(second)])

    def place(values: Array) -> Array:
        return cutter_position(surface, *values)

    def own_normal(values: Array) -> Array:
        return cross(difference(place, values, 0, EDGE_STEP), difference(place, values, 1, ANGLE_STEP))

    def condition(values: Array) -> Array:
        across = own_normal(values)
        return dot(across, difference(place, values, 2, ANGLE_STEP)) / np.sqrt(dot(across, across))

    away = np.linalg.norm(place(at) - position, axis=0)
    across = cross(own_normal(at), normal)
    turned = np.sqrt(dot(across, across) / dot(own_normal(at), own_normal(at)))
    along = (
        np.abs(condition(at) / difference(condition, at, 0, EDGE_STEP)) if generated else np.full(away.shape, np.nan)
    )
    return np.stack([away, turned, along])


def difference(function: Callable[[Array], Array], values: Array, row: int, step: float) -> Array:
    """Derivative of a function of values (k, n) by one of their rows, as a central difference of sixth order."""
    shift = np.zeros_like(values)
    shift[row] = step
    ends = [weight * (function(values + k * shift) - function(values - k * shift)) for k, weight in DIFFERENCE_WEIGHTS]
    return np.asarray(sum(ends) / step)


MAX_ITERATIONS = 20


def distance_along_normals(surface: GeneratingSurface, section: BlankSection, position: Array, normal: Array) -> Array:
    """Distances (n) [mm] along normals (3, n) to a flank, positive for more metal; fails if a normal misses it."""
    seeds = seed_lattice(surface, section)
    target = np.stack([position[2], np.hypot(position[0], position[1])])
    start = seeds.nearest(surface.axial_and_radial(seeds.points.parameters), seeds.side, target).parameters
    near = solve(surface.axial_and_radial, start, target, surface.max_step)
    unknowns = np.concatenate([near.parameters, np.zeros((1, position.shape[1]))])
    for _ in range(MAX_ITERATIONS):
        points, slopes = complex_steps(lambda p: surface.evaluate(p)[0], unknowns[:2])
        jacobian = np.concatenate([slopes, -normal[None]]).transpose(2, 1, 0)
        error = points - position - unknowns[2] * normal
        if np.max(np.abs(error)) < 1e-12 * np.max(np.abs(position)):
            return np.asarray(unknowns[2])
        # A start that ran away has no finite or no regular Jacobian: there is nothing to step from.
        if not np.all(np.linalg.det(jacobian) != 0.0) or not np.all(np.isfinite(jacobian)):
            break
        unknowns += -np.linalg.solve(jacobian, error.T[..., None])[..., 0].T
    raise GeometryError(
        f"the normal of a nominal point misses the flank: {float(np.nanmax(np.abs(error))):.3g} mm are left between "
        "them. Do the points belong to this flank, in this position?"
    )
