"""Curvature from two directions against the fundamental forms; the contact line of conventional contact analysis."""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from pairs import conjugate_pair, hobbed_pair, mirrored

from easeoff.cases import gear_pair, read_case, shipped_cases
from easeoff.contact.lines.contact_lines import curvature_and_skew
from easeoff.contact.mesh_wrench import MeshWrenches
from easeoff.contact.supports.supported_contact import PARTS, RelativeMotion, moved
from easeoff.geometry import (
    Blade,
    EaseOffTarget,
    FlankName,
    GearPair,
    GeneratingSurface,
    MachineSettings,
    Misalignment,
    PairGeometry,
    fit_pinion,
    pair_geometry,
    principal_curvatures,
)
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.gear_pair import grid
from easeoff.geometry.vectors import cross, dot
from easeoff.verification import relative_curvature
from easeoff.verification.conventional_analysis import (
    BothMethods,
    DirectionalCurvatures,
    ShapeOperator,
    both_methods,
    directional_curvatures,
    line_differences,
    path_of_contact,
    point_differences,
    shape_operators,
    stationary_directions,
)

ERRORS = Misalignment(0.1, -0.1, 0.05)
FLANKS: tuple[FlankName, ...] = ("drive", "coast")
SHIPPED = list(itertools.product(shipped_cases(), FLANKS))


def shipped(name: str, flank: FlankName) -> GearPair:
    return gear_pair(read_case(name), flank)


@cache
def hobbed() -> GearPair:
    """The face-hobbed pair on its coast flanks, where no undercut reaches into the pinion, with some crowning."""
    pair = hobbed_pair("left", coast=True)
    fitted = fit_pinion(pair, EaseOffTarget(0.02, 0.015, 0.0, 0.0, -0.005))
    return replace(pair, pinion=replace(pair.pinion, loaded=fitted.surface))


@cache
def analysed(name: str, flank: FlankName, misaligned: bool) -> BothMethods:
    pair = hobbed() if name == "hobbed" else shipped(name, flank)
    return both_methods(pair.misaligned(ERRORS if misaligned else Misalignment()))


# --- one flank


@pytest.mark.parametrize(
    "pair", [*(shipped(*case) for case in SHIPPED), hobbed_pair("left"), hobbed_pair("right", coast=True)]
)
def test_two_directions_give_the_curvatures_of_the_fundamental_forms(pair: GearPair) -> None:
    """On every usable node of both members, to rounding; the torsion that is not needed agrees with the others."""
    for member in (pair.pinion, pair.gear):
        flank = member.flank(*grid((31, 21)))
        usable = np.isfinite(flank.normal[0])
        found = directional_curvatures(flank.surface, flank.parameters[:, usable])
        operator, expected = found.shape_operator(), principal_curvatures(flank)
        curvature = expected.curvature[:, usable]
        # Rounding grows where curvatures are large (next to undercut) and the two tangents are nearly parallel.
        sine = dot(found.across[0], found.tangent[1])
        rounding = 1e-14 * np.abs(curvature).max(axis=0) / sine**2
        assert np.all(np.abs(operator.principal().curvature - curvature) < rounding)
        assert np.all(np.abs(found.torsion_residual()) < rounding)
        apart = cross(operator.principal().direction, expected.direction[:, usable])
        assert np.all(dot(apart, apart) < (rounding / (curvature[0] - curvature[1])) ** 2 + 1e-28)
        assert usable.sum() > 450


def test_curvatures_of_a_cylinder_in_skew_coordinates() -> None:
    """Closed form: radius 20 seen from two directions at 70 and 25 degrees to the axis, convex positive."""
    angles = np.radians([70.0, 25.0])
    curvature, torsion = np.sin(angles) ** 2 / 20.0, np.sin(angles) * np.cos(angles) / 20.0
    normal = np.array([[0.0], [0.0], [1.0]])
    tangent = np.array([[[np.cos(a)], [np.sin(a)], [0.0]] for a in angles])
    across = np.stack([cross(normal, t) for t in tangent])
    found = DirectionalCurvatures(tangent, across, curvature[:, None], torsion[:, None])
    principal = found.shape_operator().principal()
    np.testing.assert_allclose(principal.curvature[:, 0], [1 / 20.0, 0.0], atol=1e-16)
    np.testing.assert_allclose(np.abs(principal.direction[:, 0]), [0.0, 1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(found.torsion_residual(), 0.0, atol=1e-16)
    wrong = replace(found, geodesic_torsion=found.geodesic_torsion * np.array([[1.0], [-1.0]]))
    assert np.abs(wrong.torsion_residual()).max() > 0.03


def test_torsion_is_what_a_twisted_flank_has() -> None:
    """Torsion along a parameter curve, by finite differences of the normal at neighbouring parameters."""
    settings = MachineSettings(75.0, 1.1, 0.3, 4.0, 0.7, -1.1, 0.15, -0.4, 3.2, (0.02, -0.03))
    surface = GeneratingSurface(Blade(75.0, np.radians(18.0), "outside"), settings, "right", -1)
    start = np.array([[-2.1, -2.0], [-0.1, 0.0]])
    found = directional_curvatures(surface, start)
    for k in range(2):
        step = np.zeros((2, 1))
        step[k] = 1e-5
        (ahead, normal_ahead, _), (behind, normal_behind, _) = (surface.evaluate(start + s * step) for s in (1, -1))
        length = np.sqrt(dot(ahead - behind, ahead - behind))
        turning = (normal_ahead - normal_behind) / length
        np.testing.assert_allclose(found.normal_curvature[k], dot(turning, found.tangent[k]), rtol=1e-7)
        np.testing.assert_allclose(found.geodesic_torsion[k], dot(turning, found.across[k]), rtol=1e-7)


# --- two flanks


def random_operators(count: int) -> tuple[ShapeOperator, ShapeOperator, NDArray[np.float64]]:
    """Two operators on the plane z = 0 with bases turned at random, the second one's normal downwards."""
    rng = np.random.default_rng(3)

    def operator(up: float) -> ShapeOperator:
        turn = rng.uniform(-np.pi, np.pi, count)
        first = np.stack([np.cos(turn), np.sin(turn), np.zeros(count)])
        normal = np.repeat([[0.0], [0.0], [up]], count, axis=1)
        return ShapeOperator(first, cross(normal, first), *rng.normal(scale=0.02, size=(3, count)))

    return operator(1.0), operator(-1.0), np.repeat([[0.0], [0.0], [1.0]], count, axis=1)


def relative_shape_operator(gear: ShapeOperator, pinion: ShapeOperator) -> NDArray[np.float64]:
    """Sum of both operators (2, 2, n) [1/mm] in the gear's tangent basis, in one frame, normals opposite.

    Each counts its own body convex, so it is S_gear - S_pinion for one common normal.
    """
    # Columns: the gear's tangents in the pinion's basis.
    turn = np.array([[dot(p, g) for g in (gear.first, gear.second)] for p in (pinion.first, pinion.second)])
    matrix, other = (np.array([[s.along, s.torsion], [s.torsion, s.across]]) for s in (gear, pinion))
    return np.asarray(matrix + np.einsum("kan,kln,lbn->abn", turn, other, turn))


def test_closed_form_gives_the_eigenvectors_of_the_relative_operator() -> None:
    gear, pinion, normal = random_operators(200)
    values, vectors = np.linalg.eigh(relative_shape_operator(gear, pinion).transpose(2, 0, 1))
    smaller = np.argmin(np.abs(values), axis=1)
    rows = np.arange(200)
    expected = vectors[rows, 0, smaller] * gear.first + vectors[rows, 1, smaller] * gear.second
    found = stationary_directions(gear.principal(), pinion.principal(), normal)
    np.testing.assert_allclose(found.along_line, values[rows, smaller], rtol=0, atol=1e-16)
    np.testing.assert_allclose(found.across_line, values[rows, 1 - smaller], rtol=0, atol=1e-16)
    np.testing.assert_allclose(np.abs(dot(found.line, expected)), 1.0, rtol=0, atol=1e-10)


def test_crossed_cylinders() -> None:
    """Equal cylinders crossed at an angle w: relative curvatures (1 + cos w) / r and (1 - cos w) / r (Hertz)."""
    radius, angle = 30.0, np.radians(36.0)
    gear_axis, pinion_axis = (np.array([[np.cos(a)], [np.sin(a)], [0.0]]) for a in (0.3, 0.3 + angle))
    up, one, zero = np.array([[0.0], [0.0], [1.0]]), np.array([1.0 / radius]), np.zeros(1)
    gear = ShapeOperator(gear_axis, cross(up, gear_axis), zero, one, zero)
    pinion = ShapeOperator(pinion_axis, cross(-up, pinion_axis), zero, one, zero)
    found = stationary_directions(gear.principal(), pinion.principal(), up)
    assert found.along_line[0] == pytest.approx((1.0 - np.cos(angle)) / radius, rel=1e-12)
    assert found.across_line[0] == pytest.approx((1.0 + np.cos(angle)) / radius, rel=1e-12)
    assert found.equivalent_radius[0] == pytest.approx(radius / (1.0 + np.cos(angle)))
    between = np.array([np.cos(0.3 + angle / 2), np.sin(0.3 + angle / 2), 0.0])
    assert abs(between @ found.line[:, 0]) == pytest.approx(1.0, abs=1e-12)
    half = found.half_length(0.006)[0]
    assert 0.5 * found.along_line[0] * half**2 == pytest.approx(0.006)


def test_line_of_a_conjugate_pair_is_the_level_set_of_its_roll_angle() -> None:
    """Conjugate flanks touch along a line: no relative curvature along it, and the roll angle does not change on it."""
    pair = conjugate_pair()
    t = h = 0.5 + 0.01 * np.arange(-2, 3)
    gear = pair.gear.flank(t, h)
    surface = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    contact = path_of_contact(gear, surface, surface.roll_angle[[12]])
    relative = relative_curvature(surface.motion, pair.gear.loaded, contact)
    assert abs(relative.along_line[0]) < 1e-12
    assert relative.across_line[0] > 0.01
    weights = np.array([1, -8, 0, 8, -1]) / 0.12

    def slopes(values: NDArray[np.float64]) -> NDArray[np.float64]:
        field = values.reshape(*values.shape[:-1], 5, 5)
        return np.stack([field[..., :, 2] @ weights, field[..., 2, :] @ weights], axis=-1)

    tangents, gradient = slopes(gear.position), slopes(surface.roll_angle)
    level = tangents @ np.array([-gradient[1], gradient[0]])
    level /= np.linalg.norm(level)
    assert abs(level @ relative.line[:, 0]) == pytest.approx(1.0, abs=1e-10)


@pytest.mark.parametrize(("name", "flank"), [*SHIPPED, ("hobbed", "coast")])
@pytest.mark.parametrize("misaligned", [False, True])
def test_gap_of_the_ease_off_method_has_the_relative_curvature_of_the_flanks(
    name: str, flank: FlankName, misaligned: bool
) -> None:
    """All three components of the gap's second derivative; the series in the roll angle is cut at the third order."""
    section = (hobbed() if name == "hobbed" else shipped(name, flank)).gear.section
    both = analysed(name, flank, misaligned)
    inside, contact = both.inside, both.contact
    place = section.fractions(contact.gear_position[2], np.hypot(*contact.gear_position[:2]))
    points = np.stack(place)[:, inside]
    names = ["roll_angle", "ease_off_angle", "separation_bend", "separation_bend_slope", "lever_arm", "position"]
    value = both.splines.evaluate(names, points)
    first = [both.splines.evaluate(names, points, d) for d in ((1, 0), (0, 1))]
    second = {d: both.splines.evaluate(names, points, d) for d in ((2, 0), (1, 1), (0, 2))}
    left = contact.pinion_rotation[inside] - both.geometry.exact.motion.center - value["roll_angle"]
    # Curvature and skew are functions of two fields: their derivatives by the chain rule.
    bend, slope = value["separation_bend"], value["separation_bend_slope"]
    curvature, skew = curvature_and_skew(bend, slope)
    _, by_bend = curvature_and_skew(bend, np.ones_like(bend))
    share = np.tan(bend)
    curved = [by_bend * f["separation_bend"] for f in first]
    skewed = [by_bend * f["separation_bend_slope"] + 2.0 * share * skew * f["separation_bend"] for f in first]
    hessian = np.empty((2, 2, left.size))
    for i, j in itertools.product(range(2), range(2)):
        a, b, ab = first[i], first[j], second[2 - i - j, i + j]
        hessian[i, j] = (
            ab["ease_off_angle"]
            + (curvature + skew * left) * a["roll_angle"] * b["roll_angle"]
            - (curvature * left + 0.5 * skew * left**2) * ab["roll_angle"]
            - left * (curved[i] * b["roll_angle"] + curved[j] * a["roll_angle"])
            - 0.5 * left**2 * (skewed[i] * b["roll_angle"] + skewed[j] * a["roll_angle"])
            + 0.5
            * left**2
            * by_bend
            * (ab["separation_bend"] + 2.0 * share * a["separation_bend"] * b["separation_bend"])
        )
    basis = np.stack([both.relative.line[:, inside], both.relative.across[:, inside]])
    into = np.linalg.inv(np.array([[dot(e, f["position"]) for e in basis] for f in first]).transpose(2, 0, 1))
    found = np.einsum("nai,ijn,nbj->abn", into, value["lever_arm"] * hessian, into)
    expected = np.zeros_like(found)
    expected[0, 0], expected[1, 1] = both.relative.along_line[inside], both.relative.across_line[inside]
    assert inside.sum() > 40
    assert np.all(np.abs(found - expected).max(axis=(0, 1)) < 1e-4 + 1.5 * left**2)


@pytest.mark.parametrize(("name", "flank"), [*SHIPPED, ("hobbed", "coast")])
@pytest.mark.parametrize("misaligned", [False, True])
def test_contact_line_is_the_major_axis_of_the_contact_ellipse(name: str, flank: FlankName, misaligned: bool) -> None:
    """Direction and length at 6 um; halving the separation halves what is left, as the third-order terms say."""
    both = analysed(name, flank, misaligned)
    error, away = point_differences(both)
    assert np.nanmax(np.abs(error)) < 1e-7
    assert np.nanmax(away) < 0.01
    found = [np.stack(line_differences(both, separation)) for separation in (6.0, 3.0, 1.5)]
    whole = np.all(np.isfinite(found), axis=(0, 1))
    assert whole.sum() > 15
    angle, longer = np.abs(found[0][:, whole]).max(axis=1)
    assert angle < np.radians(0.15)
    assert longer < 5e-3
    steps = [np.abs(one - two)[:, whole].sum(axis=1) for one, two in itertools.pairwise(found)]
    order = np.log2(steps[0] / steps[1])
    assert order[0] == pytest.approx(1.0, abs=0.15)
    # The lengths of lines near an edge may come closer still: their points of contact are exact, their ends are not.
    assert order[1] > 0.85


def test_operators_at_the_points_of_contact_agree_with_the_closed_form() -> None:
    both = analysed("nasa-12x36", "drive", True)
    gear, pinion = shape_operators(both.geometry.exact.motion, shipped("nasa-12x36", "drive").gear.loaded, both.contact)
    np.testing.assert_allclose(cross(gear.first, gear.second), -cross(pinion.first, pinion.second), atol=1e-9)
    inside = both.inside
    values = np.linalg.eigvalsh(relative_shape_operator(gear, pinion)[..., inside].transpose(2, 0, 1))
    expected = np.stack([both.relative.along_line, both.relative.across_line], axis=1)[inside]
    np.testing.assert_allclose(values, expected, rtol=0, atol=1e-15)


# --- Relative motion


#: About which the parts are: not small, so that the map is that of the assembly as it stands.
MISPLACED = Misalignment(0.05, -0.03, 0.02, 0.001)
PAIRS = [("fm-11x41", False), ("fm-11x41", True), ("nasa-12x36", False)]


def moved_pair(name: str, mirror: bool, flank: FlankName) -> GearPair:
    pair = gear_pair(read_case(name), flank).misaligned(MISPLACED)
    return mirrored(pair) if mirror else pair


def motion_of(geometry: PairGeometry) -> RelativeMotion:
    motion = geometry.exact.motion
    return RelativeMotion(motion.assembly, motion.pinion_sense)


@pytest.mark.parametrize(
    ("name", "mirror", "flank"),
    [("fm-11x41", True, "drive"), ("nasa-12x36", False, "drive"), ("fm-11x41", False, "coast")],
)
def test_gap_changes_by_the_wrenches_as_in_moved_geometries(name: str, mirror: bool, flank: FlankName) -> None:
    """Central differences of the ease-off: their error falls with the square of the step."""
    geometry = pair_geometry(moved_pair(name, mirror, flank), (9, 7))
    wrenches = MeshWrenches.of(geometry)
    slopes = wrenches.flank @ motion_of(geometry).twists / wrenches.lever_arm[:, None]
    for number, part in enumerate(PARTS[:4]):
        errors = []
        for step in np.array([0.04, 0.02]) * (0.01 if part == "shaft_angle" else 1.0):
            angles = []
            for sense in (1.0, -1.0):
                parts = sense * step * np.eye(6)[number]
                angles.append(geometry.misaligned(moved(MISPLACED, parts)).exact.angle[geometry.exact.inside])
            errors.append(np.nanmax(np.abs((angles[0] - angles[1]) / (2.0 * step) - slopes[:, number])))
        assert errors[1] < 1e-6 * np.abs(slopes[:, number]).max()
        assert abs(np.log2(errors[0] / errors[1]) - 2.0) < 0.01


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize(("name", "mirror"), PAIRS)
def test_rotations_move_the_gap_by_the_lever_arms(name: str, mirror: bool, flank: FlankName) -> None:
    """A gear rotation opens it by the lever arm, one of the pinion closes it by that over the ratio."""
    geometry = pair_geometry(moved_pair(name, mirror, flank), (9, 7))
    wrenches, ratio = MeshWrenches.of(geometry), geometry.pair.assembly.ratio
    slopes = wrenches.flank @ motion_of(geometry).twists / wrenches.lever_arm[:, None]
    np.testing.assert_allclose(slopes[:, PARTS.index("gear_rotation")], 1.0, atol=1e-12)
    np.testing.assert_allclose(slopes[:, PARTS.index("pinion_rotation")], -1.0 / ratio, atol=1e-12)


@pytest.mark.parametrize(("name", "mirror"), PAIRS)
def test_parts_are_the_derivatives_of_the_assembly(name: str, mirror: bool) -> None:
    """Points of the pinion and of the gear move by the twist as their frames do."""
    pair = moved_pair(name, mirror, "drive")
    motion = RelativeMotion(pair.assembly, 1.0)
    point = np.array([[12.0], [-35.0], [80.0]])
    twists = motion.twists
    there, _ = pair.assembly.pinion_to_global(point, point)
    for number, part in enumerate(PARTS[:4]):
        step = 1e-4
        ends = []
        for sense in (1.0, -1.0):
            assembly = replace(pair.assembly, misalignment=moved(MISPLACED, sense * step * np.eye(6)[number]))
            of_pinion, _ = assembly.pinion_to_global(point, point)
            ends.append(of_pinion - (assembly.gear_origin[:, None]))
        found = (ends[0] - ends[1])[:, 0] / (2.0 * step)
        expected = twists[:3, number] + np.cross(twists[3:, number], there[:, 0])
        np.testing.assert_allclose(found, expected, atol=1e-5, err_msg=part)


def test_twist_and_parts_are_each_other_s_inverse() -> None:
    motion = RelativeMotion(moved_pair("fm-11x41", False, "drive").assembly, -1.0)
    parts = np.random.default_rng(3).normal(size=(2, 5, 6))
    np.testing.assert_allclose(motion.parts(motion.twist(parts)), parts, atol=1e-10)
