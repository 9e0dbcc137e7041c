"""Ease-off method against conventional contact analysis: error, path, direction and length of the contact line.

Conventional analysis knows the flanks and nothing of ease-off or roll angle: five equations give the point of contact,
both members' curvatures the line through it, as the major axis of an ellipse. The ellipse is of second order: by the
flanks' symmetric third-order terms both direction and length of a true line differ from it in proportion to the
separation at which the line ends.

Curvature is taken from two directions, independently of the fundamental forms. Along each of the two parameter curves
the normal turns by the normal curvature in the tangent plane's one direction and by the geodesic torsion in the other
(Kolivand 2009, Eq. 2.9 to 2.13). Two normal curvatures and one torsion make the shape operator; the other torsion has
to agree.

At a given pinion rotation the two flanks touch where positions and normals agree: five equations for the two parameters
of each flank and the gear rotation (Kolivand 2009, Eq. 2.14; Litvin).

To second order (Kolivand 2009, Eq. 2.15 to 2.18), next to the point of contact the gap is half the relative curvature
times the distance squared, and the contact line runs where it is smallest.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..contact.lines.closest_approach import closest_approach
from ..contact.lines.contact_lines import contact_splines
from ..contact.lines.flank_splines import FlankSplines
from ..contact.lines.mesh_lines import MeshLines, lines_in_mesh
from ..contact.unloaded import unloaded_contact
from ..core.arrays import Array, Bools, record
from ..core.checks import instance
from ..geometry.cutting.generating_surface import GeneratingSurface, SurfacePoints
from ..geometry.flanks.flank import Curvatures, Flank, seed_lattice
from ..geometry.pair.conjugate_motion import ConjugateMotion
from ..geometry.pair.ease_off import EaseOff
from ..geometry.pair.gear_pair import GearPair, Member, PairGeometry, pair_geometry
from ..geometry.vectors import column, cross, dot, rotate
from .smallest_gap import limited_newton


@record(frozen=True)
class ShapeOperator:
    """Shape operator of a surface at n points, symmetric, in an orthonormal tangent basis; convex bodies positive."""

    first: Array  # unit tangents (3, n)
    second: Array  # outward normal times first
    along: Array  # normal curvature along first (n) [1/mm]
    across: Array
    torsion: Array  # geodesic, along first (n) [1/mm]

    def principal(self) -> Curvatures:
        """Principal curvatures and first principal direction, in closed form."""
        middle = 0.5 * (self.along + self.across)
        half = 0.5 * (self.along - self.across)
        radius = np.hypot(half, self.torsion)
        angle = 0.5 * np.arctan2(self.torsion, half)
        direction = np.cos(angle) * self.first + np.sin(angle) * self.second
        return Curvatures(np.stack([middle + radius, middle - radius]), direction)


@record(frozen=True)
class DirectionalCurvatures:
    """Normal curvature and geodesic torsion along the two parameter curves, at n points."""

    tangent: Array  # unit, of rising parameters (2, 3, n)
    across: Array  # outward normal times tangent
    normal_curvature: Array  # (2, n) [1/mm]
    geodesic_torsion: Array

    def _turn(self) -> tuple[Array, Array]:
        """Cosine and sine of the angle in the tangent plane from the first tangent to the second."""
        return dot(self.tangent[0], self.tangent[1]), dot(self.across[0], self.tangent[1])

    def shape_operator(self) -> ShapeOperator:
        """The operator in the basis of the first tangent; it takes no notice of the second torsion."""
        cosine, sine = self._turn()
        (along, other), torsion = self.normal_curvature, self.geodesic_torsion[0]
        across = (other - along * cosine**2 - 2.0 * torsion * sine * cosine) / sine**2
        return ShapeOperator(self.tangent[0], self.across[0], along, across, torsion)

    def torsion_residual(self) -> Array:
        """Geodesic torsion along the second tangent, less the one that the shape operator says (n) [1/mm]."""
        cosine, sine = self._turn()
        operator = self.shape_operator()
        said = (operator.across - operator.along) * sine * cosine + operator.torsion * (cosine**2 - sine**2)
        return np.asarray(self.geodesic_torsion[1] - said)


def directional_curvatures(surface: GeneratingSurface, parameters: Array) -> DirectionalCurvatures:
    """Normal curvatures and geodesic torsions along both parameter curves (2, n), Kolivand 2009, Eq. 2.10 and 2.12.

    The change of the outward normal per mm is k t + tau v, of the inward one -(k t + tau v); derivatives by complex
    step.
    """
    with np.errstate(all="ignore"):
        points, along = SurfacePoints.of(surface, parameters), []
        for derivative in points.slopes:
            length = np.sqrt(dot(derivative[:3], derivative[:3]))
            tangent, turning = derivative[:3] / length, derivative[3:6] / length
            across = cross(points.normal, tangent)
            along.append((tangent, across, dot(turning, tangent), dot(turning, across)))
    return DirectionalCurvatures(*map(np.stack, zip(*along, strict=True)))


@record(frozen=True)
class PointContact:
    """Contact points at pinion rotations (n), each in the member's own frame; NaN where not converged."""

    pinion_rotation: Array
    #: Of the gear against the drive, beyond the ideal ratio [rad]: transmission error plus first_contact_rad.
    closing_angle: Array
    gear_parameters: Array
    pinion_parameters: Array
    gear_position: Array  # (3, n) [mm]
    pinion_position: Array
    converged: Bools


def path_of_contact(gear: Flank, ease_off: EaseOff, rotations: Array) -> PointContact:
    """Points of contact at rotations (n) from the pinion's middle in the drive sense [rad], by Newton's method.

    Solves the five equations of contact, each from the nearest node of the ease-off.
    """
    motion, gear_surface = ease_off.motion, gear.surface
    assembly, pinion_rotation = motion.assembly, rotations + motion.center
    inside = np.flatnonzero(ease_off.inside)
    beyond = rotations[:, None] - ease_off.roll_angle[inside]
    gap = ease_off.angle[inside] + 0.5 * ease_off.separation_curvature[inside] * beyond**2
    node = inside[np.argmin(gap, axis=1)]
    starts = gear.parameters[:, node], ease_off.pinion_parameters[:, node], gap.min(axis=1)[None]
    # The five unknowns, and below them the given rotation.
    values = np.concatenate([*starts, pinion_rotation[None]])

    def mismatch(values: Array) -> Array:
        p, n_p = motion.action_point(values[2:4], values[5])
        g, n_g, _ = gear_surface.evaluate(values[:2])
        turn = values[5] / assembly.ratio - values[4]
        g = rotate(motion.gear_axis, turn, g) + column(assembly.gear_origin, g)
        n_g = rotate(motion.gear_axis, turn, n_g)
        return np.concatenate([p - g, n_p + n_g])

    limit = np.concatenate([gear_surface.max_step, motion.surface.max_step, [0.05]])
    with np.errstate(all="ignore"):
        values, converged = limited_newton(mismatch, values, limit, 1e-10, 30)
        gear_position, _, _ = gear_surface.evaluate(values[:2])
        pinion_position, _, _ = motion.surface.evaluate(values[2:4])
    blank = np.where(converged, 1.0, np.nan)
    closing, of_gear, of_pinion = (one * blank for one in (values[4], values[:2], values[2:4]))
    positions = gear_position * blank, pinion_position * blank
    return PointContact(pinion_rotation, closing, of_gear, of_pinion, *positions, converged)


@record(frozen=True)
class RelativeCurvature:
    """Second-order gap at n points of contact, vectors in the gear's frame.

    Parameters
    ----------
    line, across
        Unit tangents (3, n) along the contact line and at right angles to it.
    along_line, across_line
        Relative curvatures (n) in these directions [1/mm], positive where the flanks part.

    Examples
    --------
    >>> x, y = np.eye(3)[:2, :, None]
    >>> curvature = RelativeCurvature(x, y, along_line=np.array([1e-4]), across_line=np.array([0.05]))
    >>> curvature.equivalent_radius, curvature.half_length(5e-3)
    (array([20.]), array([10.]))
    """

    line: Array
    across: Array
    along_line: Array
    across_line: Array

    @property
    def equivalent_radius(self) -> Array:
        """Radius (n) [mm] of the cylinder that stands for the line contact."""
        return np.asarray(1.0 / np.abs(self.across_line))

    def half_length(self, separation: float) -> Array:
        """Half the length (n) [mm] of the contact line whose ends are ``separation`` [mm] apart.

        Half of L = sqrt(8 separation / |relative curvature|), the major axis of the contact ellipse.
        """
        return np.asarray(np.sqrt(2.0 * separation / np.abs(self.along_line)))


def stationary_directions(gear: Curvatures, pinion: Curvatures, normal: Array) -> RelativeCurvature:
    """Directions of stationary relative curvature in closed form, Kolivand 2009, Eq. 2.15 to 2.18.

    Angles about the gear's outward normal: theta from the pinion's first principal direction, sigma from the gear's to
    the pinion's. The smaller one is the contact line; convex is positive for either body.
    """
    first, second = pinion.direction, cross(normal, pinion.direction)
    sigma = np.arctan2(dot(cross(gear.direction, pinion.direction), normal), dot(gear.direction, pinion.direction))
    # Seen with the gear's normal the pinion's curvatures change sign.
    of_gear, of_pinion = gear.curvature, -pinion.curvature
    gear_range, pinion_range = of_gear[0] - of_gear[1], of_pinion[0] - of_pinion[1]
    theta = 0.5 * np.arctan2(gear_range * np.sin(2 * sigma), pinion_range - gear_range * np.cos(2 * sigma))

    def relative(angle: Array) -> Array:
        k_pinion = of_pinion[0] * np.cos(angle) ** 2 + of_pinion[1] * np.sin(angle) ** 2
        k_gear = of_gear[0] * np.cos(angle + sigma) ** 2 + of_gear[1] * np.sin(angle + sigma) ** 2
        return np.asarray(k_gear - k_pinion)

    other = theta + 0.5 * np.pi
    theta = np.where(np.abs(relative(theta)) <= np.abs(relative(other)), theta, other)
    line = np.cos(theta) * first + np.sin(theta) * second
    return RelativeCurvature(line, cross(normal, line), relative(theta), relative(theta + 0.5 * np.pi))


def in_gear_frame(motion: ConjugateMotion, contact: PointContact, vector: Array) -> Array:
    """Directions (3, n) of the pinion's frame, at the points of contact, in the gear's frame."""
    at_rest = np.tensordot(motion.assembly.pinion_frame, vector, 1)
    in_space = rotate(motion.pinion_axis, contact.pinion_rotation, at_rest)
    turn = contact.pinion_rotation / motion.assembly.ratio - contact.closing_angle
    return rotate(motion.gear_axis, -turn, in_space)


def shape_operators(
    motion: ConjugateMotion, gear_surface: GeneratingSurface, contact: PointContact
) -> tuple[ShapeOperator, ShapeOperator]:
    """Shape operators of gear and pinion at points of contact, both in the gear's frame."""
    gear = directional_curvatures(gear_surface, contact.gear_parameters).shape_operator()
    pinion = directional_curvatures(motion.surface, contact.pinion_parameters).shape_operator()
    first, second = (in_gear_frame(motion, contact, v) for v in (pinion.first, pinion.second))
    return gear, ShapeOperator(first, second, pinion.along, pinion.across, pinion.torsion)


def relative_curvature(
    motion: ConjugateMotion, gear_surface: GeneratingSurface, contact: PointContact
) -> RelativeCurvature:
    """Contact-line direction and relative curvatures at points of contact, in the gear's frame.

    Parameters
    ----------
    motion
        Axes, senses and pinion surface.
    gear_surface
        The gear flank.
    contact
        Points from ``path_of_contact``; where they did not converge the result is NaN.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> from easeoff.verification.conventional_analysis import path_of_contact
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> path = path_of_contact(geometry.members.gear, geometry.exact, np.zeros(1))
    >>> curvature = relative_curvature(geometry.exact.motion, geometry.members.gear.surface, path)
    >>> bool(0.0 < curvature.along_line[0] < curvature.across_line[0])
    True
    """
    instance("motion", motion, ConjugateMotion)
    instance("gear_surface", gear_surface, GeneratingSurface)
    instance("contact", contact, PointContact)
    gear, pinion = shape_operators(motion, gear_surface, contact)
    return stationary_directions(gear.principal(), pinion.principal(), cross(gear.first, gear.second))


EDGE_MARGIN = 0.02  # fraction of face and profile; nearer to an edge the contact leaves the clipped contact line
BLADE_DISTANCE_MARGIN = 0.1  # [mm]


@record(frozen=True)
class BothMethods:
    """Analysis of a pair by the ease-off method and conventionally, at n rotations, tooth pair by tooth pair."""

    geometry: PairGeometry
    splines: FlankSplines
    mesh: MeshLines
    contact: PointContact
    relative: RelativeCurvature
    inside: Bools  # contact point within both flanks, by a margin (n)

    def unloaded(self, separation: float = 6.0) -> xr.Dataset:
        """The ease-off method's unloaded contact, lines ending at a separation [um]; of the pairs that have lines."""
        dataset = unloaded_contact(self.geometry, self.splines, self.mesh, separation=separation)
        return dataset.sel(pair=np.unique(self.mesh.pair))


def both_methods(pair: GearPair) -> BothMethods:
    """Analyse a pair by the ease-off method and conventionally; every tooth pair counts."""
    return methods_compared(pair_geometry(pair))


def methods_compared(geometry: PairGeometry, mesh_positions: int = 48) -> BothMethods:
    """As ``both_methods``, from a geometry: one method takes its ease-off, the conventional one its flanks."""
    pair, surface = geometry.pair, geometry.exact
    splines = contact_splines(geometry.flanks, geometry.ease_off)
    mesh = lines_in_mesh(splines, pair.assembly.pinion_pitch, mesh_positions)
    pairs = np.unique(mesh.pair)
    rotation = (mesh.rotations[None, :] - pairs[:, None] * pair.assembly.pinion_pitch).ravel()
    contact = path_of_contact(geometry.members.gear, surface, rotation)
    on_gear = _on_flank(pair.gear, contact.gear_position, contact.gear_parameters)
    on_pinion = _on_flank(pair.pinion, contact.pinion_position, contact.pinion_parameters)
    inside = contact.converged & on_gear & on_pinion
    relative = relative_curvature(surface.motion, pair.gear.loaded, contact)
    return BothMethods(geometry, splines, mesh, contact, relative, inside)


def _on_flank(member: Member, position: Array, parameters: Array) -> Bools:
    """True where points (3, n) lie within a flank by the margins, and are not undercut."""
    fractions = np.stack(member.section.fractions(position[2], np.hypot(position[0], position[1])))
    side = seed_lattice(member.loaded, member.section).orientation
    with np.errstate(invalid="ignore"):
        valid_side = member.loaded.orientation(parameters) * side > 0.0
        cut = member.loaded.evaluate(parameters)[2] > BLADE_DISTANCE_MARGIN
    return np.asarray(np.all(np.abs(fractions - 0.5) < 0.5 - EDGE_MARGIN, axis=0) & valid_side & cut)


def point_differences(both: BothMethods) -> tuple[Array, Array]:
    """Differences (n) of transmission error [rad] and contact point on the gear [mm]; NaN unless inside both flanks."""
    dataset = both.unloaded()
    error, t, h = (_flat(dataset, name)[0] for name in ("transmission_error", "path_lengthwise", "path_profile"))
    point = both.splines("position", np.stack([t, h]))
    away = np.linalg.norm(point - both.contact.gear_position, axis=0)
    zero = both.geometry.ease_off.attrs["first_contact_rad"]  # closing angle where the ease-off method's error is zero
    difference = 1e-6 * error - (both.contact.closing_angle - zero)
    return np.where(both.inside, difference, np.nan), np.where(both.inside, away, np.nan)


def line_differences(both: BothMethods, separation: float) -> tuple[Array, Array]:
    """Angle (n) [rad] from the major axis of the contact ellipse to the contact line, and length over it less one (n).

    The line is the chord between points of closest approach at ends with the separation [um], its angle about the
    gear's normal. NaN where the edge of a flank ends the line.
    """
    dataset = both.unloaded(separation)
    ends = np.stack([_flat(dataset, "line_lengthwise"), _flat(dataset, "line_profile")])
    smallest, length = 1e-6 * _flat(dataset, "transmission_error")[0], _flat(dataset, "line_length")[0]
    closest = closest_approach(both.splines, ends)
    gap = 1e3 * (closest.separation_angle - smallest) * closest.lever_arm
    whole = both.inside & np.all(np.abs(gap / separation - 1.0) < 0.01, axis=0)
    start, end = both.splines("position", ends + closest.shift).swapaxes(0, 1)
    chord = end - start
    relative = both.relative
    with np.errstate(invalid="ignore"):
        chord = chord * np.sign(dot(chord, relative.line))
        angle = np.arctan2(dot(chord, relative.across), dot(chord, relative.line))
        longer = length / (2.0 * relative.half_length(1e-3 * separation)) - 1.0
    return np.where(whole, angle, np.nan), np.where(whole, longer, np.nan)


def _flat(dataset: xr.Dataset, name: str) -> Array:
    """A variable over tooth pairs and mesh positions as (1 or 2, n)."""
    variable = dataset[name].transpose("pair", "mesh_position", ...).values
    return np.asarray(variable.reshape(variable.shape[0] * variable.shape[1], -1).T)
