"""The tooth behind a flank: its thickness, its middle surface, and where a contact force meets that surface.

A contact force acts along the flank normal. Sliding it along its own line to the middle of the tooth changes nothing,
and there, at the foot of the normal, it loads the tooth as a plate: this module gives the foot's coordinates, the
direction of the force in the plate's axes and the distance to the foot.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.polynomial import legendre

from ...core.arrays import Array, record
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, into_tooth, solve_flank
from ..vectors import dot, rotate

Z_AXIS = np.array([0.0, 0.0, 1.0])
COMPARISON_NODES = (13, 9)  # where both flanks of a tooth are compared, lengthwise and profile
EDGE_THICKNESS_LIMIT = 0.1  # of the root thickness
LEGENDRE_ORDERS = (5, 4)  # Legendre orders of the smooth surfaces through those nodes


@record(frozen=True)
class ShellCoordinates:
    """Feet of n contact forces on the middle surface of a tooth [mm]."""

    height: Array
    arc: Array  # from the toe along the tooth trace (n) [mm]
    depth: Array  # from the flank along the normal (n) [mm]
    direction: Array  # of the force (3, n): along the height, along the trace, away from its centre


@record(frozen=True)
class ToothBody:
    """One tooth of a member between its two flanks, as a plate along the tooth trace."""

    section: BlankSection
    half_angle: Array  # half the angular thickness [rad], Legendre series in both fractions
    middle_normal: Array  # of the middle surface, towards the loaded flank (3 series)
    turn: float  # sense about the axis from the loaded flank into the tooth, +1 or -1
    trace_arc: Array  # at mid height [mm], Legendre series in the lengthwise fraction
    trace_radius: float
    convex: bool  # loaded flank on the side away from the trace's centre
    height: Array
    thickness: Array  # normal, (toe/heel, root cone/tip) (2, 2) [mm], of the evenly varying plate that fits best
    fitted_thickness: Array
    bulge: Array  # excess at mid height over an even taper, at toe and heel (2) [mm]
    fanning: float  # growth of the trace per height, over its length at mid height [1/mm]

    @property
    def trace_length(self) -> float:
        """Length of the tooth along its trace at mid height [mm]."""
        ends = legendre.legval(np.array([-1.0, 1.0]), self.trace_arc)
        return float(ends[1] - ends[0])

    def shell_coordinates(self, position: Array, normal: Array) -> ShellCoordinates:
        """Foot, direction and depth of contact forces at points [mm] with outward normals (3, n) of the flank."""
        t, h = self.section.fractions(position[2], np.hypot(position[0], position[1]))
        middle = rotate(Z_AXIS, self.turn * legendre.legval2d(2 * t - 1, 2 * h - 1, self.half_angle), position)
        axis = np.stack([legendre.legval2d(2 * t - 1, 2 * h - 1, c) for c in self.middle_normal])
        # The series describes the normal at azimuth zero of the point, so that it varies slowly.
        axis = rotate(Z_AXIS, np.arctan2(middle[1], middle[0]), axis / np.sqrt(dot(axis, axis)))
        depth = dot(position - middle, axis) / dot(normal, axis)
        foot = position - depth * normal
        radial = np.hypot(foot[0], foot[1])
        along, _ = self.section.fractions(foot[2], radial)
        outward = axis if self.convex else -axis
        up = np.array([-np.sin(self.section.root_angle), np.cos(self.section.root_angle)])
        height_axis = np.stack([up[1] * foot[0] / radial, up[1] * foot[1] / radial, np.full_like(radial, up[0])])
        height_axis = height_axis - dot(height_axis, outward) * outward
        height_axis = height_axis / np.sqrt(dot(height_axis, height_axis))
        heelward = np.cross(height_axis, outward, axis=0)
        heelward = heelward * np.sign(heelward[2])
        direction = -np.stack([dot(normal, height_axis), dot(normal, heelward), dot(normal, outward)])
        arc = legendre.legval(2 * along - 1, self.trace_arc) - legendre.legval(-1.0, self.trace_arc)
        return ShellCoordinates(self.section.height_above_root(foot[2], radial), arc, depth, direction)


def opposite_surface(surface: GeneratingSurface) -> GeneratingSurface:
    """The other flank a cutter would cut in the same machine: the other blade at the same pressure angle."""
    blade = surface.blade
    return replace(surface, blade=replace(blade, side="inside" if blade.side == "outside" else "outside"))


def middle_angle(section: BlankSection, loaded: GeneratingSurface, opposite: GeneratingSurface) -> tuple[float, float]:
    """Sense (+1 or -1) about the axis from the loaded flank into its tooth, and angle in it to the other flank [rad].

    The flanks are as their machines cut them; the angle is between their middles.
    """
    axial, radial = section.points(np.array([0.5]), np.array([0.5]))
    front, back = (solve_flank(surface, section, axial, radial) for surface in (loaded, opposite))
    turn = into_tooth(front.position, front.normal)
    return turn, turn * float(_azimuth(back)[0] - _azimuth(front)[0])


def tooth_body(
    section: BlankSection, loaded: GeneratingSurface, opposite: GeneratingSurface, mean_angle: float
) -> ToothBody:
    """Tooth between two flanks, of angular thickness ``mean_angle`` [rad] in the middle of the flank."""
    t, h = np.meshgrid(np.linspace(0, 1, COMPARISON_NODES[0]), np.linspace(0, 1, COMPARISON_NODES[1]), indexing="ij")
    axial, radial = section.points(t.ravel(), h.ravel())
    flanks = [solve_flank(surface, section, axial, radial) for surface in (loaded, opposite)]
    usable = np.all([np.all(np.isfinite(f.position), axis=0) for f in flanks], axis=0)
    if usable.sum() < 0.5 * usable.size:
        raise GeometryError("the two flanks of a member overlap on less than half of the blank: no tooth between them")
    front, back = flanks
    turn = into_tooth(front.position, front.normal)
    angle = np.where(usable, turn * (_azimuth(back) - _azimuth(front)), np.nan)
    angle = angle - _middle(angle) + mean_angle
    nodes = np.stack([t.ravel(), h.ravel()])[:, usable]
    series = legendre.legvander2d(2 * nodes[0] - 1, 2 * nodes[1] - 1, LEGENDRE_ORDERS)

    def fit(values: Array) -> Array:
        coefficients = np.linalg.lstsq(series, values[usable], rcond=None)[0]
        return np.asarray(coefficients).reshape(LEGENDRE_ORDERS[0] + 1, LEGENDRE_ORDERS[1] + 1)

    # Normals of both flanks turned to azimuth zero, where they vary slowly.
    normal = rotate(Z_AXIS, -_azimuth(front), front.normal) - rotate(Z_AXIS, -_azimuth(back), back.normal)
    normal = normal / np.sqrt(dot(normal, normal))
    # Chord between the flanks, measured across the middle surface.
    thickness = 2.0 * radial * np.sin(0.5 * angle) * np.abs(normal[1])
    if _middle(thickness) <= 0.0 or np.mean(thickness[usable] > 0.0) < 0.8:
        raise GeometryError(
            f"the tooth would be {_middle(thickness):.3f} mm thick in its middle, {np.nanmin(thickness):.3f} mm at its "
            "thinnest: check the thickness, the point radii and the blade angles of both flanks"
        )
    middle_azimuth = fit(_azimuth(front) + 0.5 * turn * angle)
    middle_normal = np.stack([fit(component) for component in normal])
    arc, radius, convex = _trace(section, middle_azimuth, middle_normal)
    heights, plate, fitted, bulge = _plate(section, nodes, axial[usable], radial[usable], thickness[usable])
    fanning = _fanning(section, middle_azimuth)
    half = fit(0.5 * angle)
    return ToothBody(section, half, middle_normal, turn, arc, radius, convex, heights, plate, fitted, bulge, fanning)


def _trace(section: BlankSection, azimuth: Array, normal: Array) -> tuple[Array, float, bool]:
    """Arc length series, radius at mid face, and on which side of the middle surface the trace's centre lies."""
    x = np.polynomial.chebyshev.chebpts2(33)
    curve = _curve(section, azimuth, x, 0.5)
    first, second = legendre.legder(curve), legendre.legder(curve, 2)
    arc = legendre.legint(legendre.legfit(x, np.linalg.norm(legendre.legval(x, first), axis=0), 8))
    middle = np.array([legendre.legval2d(0.0, 0.0, c) for c in normal])
    turned = rotate(Z_AXIS, np.asarray(legendre.legval2d(0.0, 0.0, azimuth)), middle)
    curvature = float(legendre.legval(0.0, second) @ turned) / float(np.sum(legendre.legval(0.0, first) ** 2))
    return arc, 1.0 / max(abs(curvature), 1e-9), curvature < 0.0


def _curve(section: BlankSection, azimuth: Array, x: Array, height: float) -> Array:
    """Legendre series of the middle surface's points along the trace at one profile fraction, fitted at ``x``."""
    axial, radial = section.points(0.5 * (x + 1), np.full_like(x, height))
    swing = legendre.legval2d(x, np.full_like(x, 2.0 * height - 1.0), azimuth)
    points = np.stack([radial * np.cos(swing), radial * np.sin(swing), axial], axis=1)
    return np.asarray(legendre.legfit(x, points, 8))


def _fanning(section: BlankSection, azimuth: Array) -> float:
    """Growth of the trace's length from root to tip, over its length at mid height and the height [1/mm]."""
    x, weights = legendre.leggauss(32)
    slopes = [legendre.legder(_curve(section, azimuth, x, h)) for h in (0.0, 0.5, 1.0)]
    lengths = [float(weights @ np.linalg.norm(legendre.legval(x, slope), axis=0)) for slope in slopes]
    heights = [section.height_above_root(*tip) - section.height_above_root(*root) for root, tip in section.corners]
    return (lengths[2] - lengths[0]) / (lengths[1] * float(np.mean(heights)))


def _plate(
    section: BlankSection, nodes: Array, axial: Array, radial: Array, thickness: Array
) -> tuple[Array, Array, Array, Array]:
    """Height at toe and heel, the even thickness (toe/heel, root/tip) that fits best, and the best one with a bulge."""
    corners = section.corners
    heights = section.height_above_root(corners[:, 1, 0], corners[:, 1, 1])
    along = nodes[0]
    up = section.height_above_root(axial, radial) / (heights[0] * (1 - along) + heights[1] * along)
    matrix = np.stack([(1 - along) * (1 - up), (1 - along) * up, along * (1 - up), along * up], axis=1)
    bulged = np.concatenate([matrix, (4.0 * up * (1.0 - up))[:, None] * np.stack([1 - along, along], axis=1)], axis=1)
    plate = np.reshape(np.linalg.lstsq(matrix, thickness, rcond=None)[0], (2, 2))
    coefficients = np.linalg.lstsq(bulged, thickness, rcond=None)[0]
    fitted, bulge = np.reshape(coefficients[:4], (2, 2)), np.maximum(coefficients[4:], 0.0)
    # A tooth that ends in a point keeps a plate with a narrow edge.
    for corners in (plate, fitted):
        corners[:, 1] = np.maximum(corners[:, 1], EDGE_THICKNESS_LIMIT * corners[:, 0])
    return np.asarray(heights), plate, fitted, np.asarray(bulge)


def _azimuth(flank: Flank) -> Array:
    """Azimuth of the nodes, without a jump of a whole turn between them."""
    azimuth = np.asarray(np.arctan2(flank.position[1], flank.position[0]))
    middle = azimuth[azimuth.size // 2]
    return np.asarray(azimuth - 2.0 * np.pi * np.round((azimuth - middle) / (2.0 * np.pi)))


def _middle(values: Array) -> float:
    """The value at the middle node."""
    return float(values.reshape(COMPARISON_NODES)[COMPARISON_NODES[0] // 2, COMPARISON_NODES[1] // 2])
