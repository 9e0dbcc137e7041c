"""Flanks against published points, their grids, curvatures in closed form, and settings that cut no tooth."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from pairs import GEAR_BLANK, PINION_BLANK, conjugate_pair

from easeoff import GeometryError
from easeoff.cases import gear_pair, read_case
from easeoff.geometry import BlankSection, flank, principal_curvatures
from easeoff.geometry.flanks.flank import NodeStatus, shape_operator, solve_flank
from easeoff.geometry.vectors import dot

INCH = 25.4

# NASA CR-191009 (Bibel, Reddy & Kumar 1994), first point of each flank [inch]; z along the member's axis.
PUBLISHED = {
    ("pinion", "concave"): (0.7948185893337920, 0.1518771876505158, 2.565573009266192),
    ("pinion", "convex"): (0.7093463178422439, 0.3893983454546772, 2.565573009266191),
    ("gear", "concave"): (2.474433967420987, -0.3395653327372070, 0.9856358798469023),
    ("gear", "convex"): (2.487328996883535, -0.2265447761173172, 0.9856358798469033),
}
# The same settings evaluated by a separate program, which is no part of this repository: (t, h) and point [inch].
COMPUTED = {
    ("pinion", "concave"): [
        (0.0, 0.5, 0.8901646, 0.2211861, 2.5328185),
        (0.5, 0.5, 1.0793146, -0.1122090, 3.0043892),
        (1.0, 0.5, 1.1223570, -0.5571357, 3.4759599),
    ],
    ("gear", "convex"): [
        (0.0, 0.5, 2.5309226, -0.1852667, 0.8880161),
        (0.5, 0.5, 3.0068560, 0.1212901, 1.0558132),
        (1.0, 0.5, 3.4364223, 0.5547286, 1.2236103),
    ],
}


def nasa_member(name: str, side: str):  # type: ignore[no-untyped-def]
    drive = (name, side) in COMPUTED
    pair = gear_pair(read_case("nasa-12x36"), "drive" if drive else "coast")
    return pair.pinion if name == "pinion" else pair.gear


@pytest.mark.parametrize("which", PUBLISHED)
def test_published_points_of_all_four_flanks(which: tuple[str, str]) -> None:
    found = nasa_member(*which).flank(np.array([0.0]), np.array([0.0])).position[:, 0] / INCH
    np.testing.assert_allclose(found, PUBLISHED[which], rtol=0, atol=1e-6)


@pytest.mark.parametrize("which", COMPUTED)
def test_points_of_a_separate_program(which: tuple[str, str]) -> None:
    member = nasa_member(*which)
    for t, h, *point in COMPUTED[which]:
        found = member.flank(np.array([t]), np.array([h])).position[:, 0] / INCH
        np.testing.assert_allclose(found, point, rtol=0, atol=1e-6)


@pytest.mark.parametrize("which", PUBLISHED)
def test_every_node_lies_where_it_was_asked_for(which: tuple[str, str]) -> None:
    member = nasa_member(*which)
    t, h = np.linspace(0, 1, 11), np.linspace(0, 1, 7)
    nodes = member.flank(t, h)
    axial, radial = member.section.points(*np.meshgrid(t, h, indexing="ij"))
    assert np.all(nodes.inside)
    np.testing.assert_allclose(nodes.position[2], axial.ravel(), rtol=0, atol=1e-10)
    np.testing.assert_allclose(np.hypot(*nodes.position[:2]), radial.ravel(), rtol=0, atol=1e-10)
    np.testing.assert_allclose(dot(nodes.normal, nodes.normal), 1.0, rtol=0, atol=1e-13)


# Teeth twice as high at the heel as at the toe: the apex of their ends is nearer than the face is wide.
STRONG_TAPER = BlankSection(
    pitch_angle=1.2685,
    face_angle=1.2929,
    root_angle=1.1709,
    outer_cone_distance=110.948,
    face_width=34.5,
    pitch_apex=0.1359,
    face_apex=-0.6423,
    root_apex=4.7221,
    clearance=0.9619,
)


@pytest.mark.parametrize("section", [PINION_BLANK, GEAR_BLANK, STRONG_TAPER])
def test_section_coordinates_invert_each_other(section: BlankSection) -> None:
    t, h = np.meshgrid(np.linspace(-0.2, 1.2, 8), np.linspace(-0.3, 1.4, 7), indexing="ij")
    found = section.fractions(*section.points(t, h))
    np.testing.assert_allclose(found[0], t, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found[1], h, rtol=0, atol=1e-12)


def test_section_ends_on_its_cones() -> None:
    corners = GEAR_BLANK.corners
    height = GEAR_BLANK.height_above_root(corners[..., 0], corners[..., 1])
    np.testing.assert_allclose(height[:, 0], GEAR_BLANK.clearance, rtol=0, atol=1e-12)
    slope = (corners[1, 1] - corners[0, 1])[1] / (corners[1, 1] - corners[0, 1])[0]
    assert math.atan(slope) == pytest.approx(GEAR_BLANK.face_angle, abs=1e-12)


def test_blank_without_depth_is_refused() -> None:
    with pytest.raises(GeometryError, match="tooth depth"):
        replace(GEAR_BLANK, clearance=30.0)


def test_formate_flank_has_the_curvatures_of_its_cone() -> None:
    """Zero along the blade, cos(pressure angle) over the local cutter radius across it; a convex flank is positive."""
    for coast, sign in ((False, 1.0), (True, -1.0)):
        nodes = conjugate_pair(coast=coast).gear.flank(np.linspace(0, 1, 7), np.linspace(0, 1, 5))
        blade = nodes.surface.blade
        radius = blade.point_radius + blade.side_sign * nodes.blade_distance * math.sin(blade.pressure_angle)
        across = sign * math.cos(blade.pressure_angle) / radius
        found = principal_curvatures(nodes).curvature
        expected = np.stack([np.maximum(across, 0.0), np.minimum(across, 0.0)])
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


def test_curvature_of_a_generated_flank_agrees_with_its_normals_nearby() -> None:
    """Normal curvature along the face, from three neighbouring nodes, converges to the second fundamental form."""
    member = nasa_member("pinion", "concave")
    errors = []
    for step in (0.04, 0.02, 0.01):
        nodes = member.flank(0.5 + step * np.array([-1.0, 0.0, 1.0]), np.array([0.5]))
        chord = nodes.position[:, 2] - nodes.position[:, 0]
        numeric = float((nodes.normal[:, 2] - nodes.normal[:, 0]) @ chord / (chord @ chord))
        tangents, first, second = shape_operator(nodes)
        weights = np.linalg.lstsq(tangents[:, :, 1], chord, rcond=None)[0]
        exact = float(weights @ second[..., 1] @ weights / (weights @ first[..., 1] @ weights))
        errors.append(abs(numeric - exact))
    order = np.log2(errors[0] / errors[1]), np.log2(errors[1] / errors[2])
    assert np.all(np.array(order) > 1.9)


def test_nodes_past_the_blade_tip_are_marked_not_extrapolated() -> None:
    member = conjugate_pair().gear
    axial, radial = member.section.points(np.array([0.5, 0.5]), np.array([0.5, -0.5]))
    nodes = solve_flank(member.loaded, member.section, axial, radial)
    assert nodes.status.tolist() == [NodeStatus.INSIDE, NodeStatus.BEYOND_BLADE_TIP]


def test_undercut_nodes_are_masked() -> None:
    """Far below a generated pinion's root the envelope turns back on itself."""
    member = nasa_member("pinion", "concave")
    t, h = np.meshgrid(np.linspace(0, 1, 7), np.linspace(-3.0, 1.0, 21), indexing="ij")
    axial, radial = member.section.points(t.ravel(), h.ravel())
    nodes = solve_flank(member.loaded, member.section, axial, radial)
    bad = np.isin(nodes.status, [NodeStatus.UNDERCUT, NodeStatus.NO_SOLUTION])
    assert bad.any()
    assert not bad[h.ravel() >= 0.0].any()
    assert np.isnan(nodes.position[:, bad]).all()
    assert np.isfinite(nodes.position[:, ~bad]).all()


def test_settings_without_a_tooth_say_so() -> None:
    member = nasa_member("pinion", "concave")
    far = replace(member.loaded, settings=replace(member.loaded.settings, radial_distance=400.0))
    with pytest.raises(GeometryError, match="no tooth in this blank"):
        flank(replace(member, loaded=far))


def test_random_settings_never_crash_and_never_leave_unmasked_garbage() -> None:
    member = nasa_member("pinion", "concave")
    rng = np.random.default_rng(1)
    t, h = np.linspace(0, 1, 5), np.linspace(0, 1, 5)
    refused = 0
    for _ in range(20):
        scale = 10.0 ** rng.uniform(-3, 0)
        shake = rng.normal(size=6) * scale * np.array([10.0, 0.3, 0.3, 10.0, 0.3, 0.5])
        old = member.loaded.settings
        settings = replace(
            old,
            radial_distance=abs(old.radial_distance + shake[0]),
            cradle_angle=old.cradle_angle + shake[1],
            machine_root_angle=old.machine_root_angle + shake[2],
            work_offset=old.work_offset + shake[3],
            cutter_tilt=shake[4],
            ratio_of_roll=abs((old.ratio_of_roll or 1.0) + shake[5]) + 0.01,
        )
        try:
            nodes = replace(member, loaded=replace(member.loaded, settings=settings)).flank(t, h)
        except GeometryError:
            refused += 1
            continue
        axial, radial = member.section.points(*np.meshgrid(t, h, indexing="ij"))
        good = nodes.inside
        np.testing.assert_allclose(nodes.position[2, good], axial.ravel()[good], rtol=0, atol=1e-8)
        np.testing.assert_allclose(np.hypot(*nodes.position[:2, good]), radial.ravel()[good], rtol=0, atol=1e-8)
    assert refused < 20
