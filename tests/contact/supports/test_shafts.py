"""Shafts on bearings against closed forms, an independent integration, and balance."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from easeoff.contact import STEEL, Material
from easeoff.contact.supports.shaft import (
    Beam,
    Bearing,
    Shaft,
    ShaftSection,
    ShaftSupport,
    ShaftSupports,
    StiffnessCurve,
    shear_coefficient,
)
from easeoff.contact.supports.support import ORIGIN, shifted_wrench
from easeoff.core.errors import InputError
from easeoff.geometry.pair.assembly import Assembly
from easeoff.geometry.tooth.tooth_flanks import MemberName

Array = NDArray[np.float64]
STEPPED = (
    ShaftSection(-20.0, 15.0, 50.0, 20.0),
    ShaftSection(15.0, 60.0, 42.0),
    ShaftSection(60.0, 62.5, 36.0, 8.0),
    ShaftSection(62.5, 140.0, 35.0),
)
STIFF = 1e14


def shaft(**changed: object) -> Shaft:
    """A stepped shaft, indeterminate, with every kind of stiffness."""
    bearings = (
        Bearing("front", -10.0, 3e5, 1e5, 2e7),
        Bearing("middle", 55.0, 6e5),
        Bearing("back", 120.0, 4e5, 2e5, 1e7),
    )
    found = Shaft(STEPPED, bearings, reference=20.0, seat=30.0, material=STEEL)
    return replace(found, **changed)  # type: ignore[arg-type]


def at(place: float, wrench: Array) -> Array:
    """A wrench (6, ...) at a place of the axis, about the axis' origin."""
    moved = np.array(wrench, dtype=float)
    moved[3] -= place * moved[1]
    moved[4] += place * moved[0]
    return moved


@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.8])
def test_shear_coefficient_is_that_of_the_shear_stress_at_its_limits(ratio: float) -> None:
    """Cowper's table: 6 (1 + nu) / (7 + 6 nu) of a solid section, 2 (1 + nu) / (4 + 3 nu) of a thin tube."""
    assert shear_coefficient(0.0, 0.3) == pytest.approx(7.8 / 8.8, rel=1e-15)
    assert shear_coefficient(1.0, 0.3) == pytest.approx(2.6 / 4.9, rel=1e-15)
    assert 2.6 / 4.9 < shear_coefficient(max(ratio, 1e-3), 0.3) < 7.8 / 8.8 + 1e-6
    assert shear_coefficient(ratio, 0.0) == pytest.approx(
        6 * (1 + ratio**2) ** 2 / (7 * (1 + ratio**2) ** 2 + 20 * ratio**2), rel=1e-15
    )


def test_cantilever_bends_shears_stretches_and_twists_as_in_closed_form() -> None:
    length, section = 130.0, ShaftSection(25.0, 155.0, 44.0, 15.0)
    tip = Beam((section,), STEEL).compliance(25.0, 155.0, origin=155.0)
    bending, area = STEEL.elastic_modulus * section.second_moment, section.area
    shear = shear_coefficient(15.0 / 44.0, 0.3) * STEEL.shear_modulus * area
    across = length**3 / (3.0 * bending) + length / shear
    expected = np.diag(
        [
            across,
            across,
            length / (STEEL.elastic_modulus * area),
            length / bending,
            length / bending,
            length / (STEEL.shear_modulus * np.pi / 32.0 * (44.0**4 - 15.0**4)),
        ]
    )
    expected[0, 4] = expected[4, 0] = length**2 / (2.0 * bending)  # a force along x turns the tip about y
    expected[1, 3] = expected[3, 1] = -(length**2) / (2.0 * bending)
    np.testing.assert_allclose(tip, expected, rtol=1e-13, atol=1e-22)


def test_cutting_a_prismatic_shaft_into_sections_changes_nothing() -> None:
    whole = shaft(sections=(ShaftSection(-20.0, 140.0, 40.0, 12.0),))
    cuts = np.linspace(-20.0, 140.0, 38)
    pieces = tuple(ShaftSection(a, b, 40.0, 12.0) for a, b in itertools.pairwise(cuts))
    np.testing.assert_allclose(shaft(sections=pieces).compliance, whole.compliance, rtol=1e-12, atol=1e-22)


@pytest.mark.parametrize("load", range(6))
def test_a_stepped_shaft_follows_the_unit_load_theorem(load: int) -> None:
    """Internal forces from the bearings' loads, integrated numerically against those of a virtual unit load."""
    held = shaft(torque_position=140.0)
    # The virtual system needs equilibrium alone: front and back bearing, simply supported.
    virtual = replace(held, bearings=(Bearing("a", -10.0, STIFF, STIFF), Bearing("b", 120.0, STIFF)))
    wrench = np.eye(6)[load]

    def internal(system: Shaft, wrench: Array, z: Array) -> Array:
        """Wrench (n, 6) that the part beyond z takes from the other."""
        forces = [(30.0, at(20.0 - 30.0, wrench))]  # enters the shaft at the seat
        forces += [(b.position, -r @ wrench) for b, r in zip(system.bearings, system.loads, strict=True)]
        forces += [(140.0, np.array([0, 0, 0, 0, 0, -wrench[5]]))]
        total = np.zeros((z.size, 6))
        for place_of, force in forces:
            about = at(place_of, force)  # about the origin of the axis
            beyond = (z < place_of)[:, None]
            local = np.tile(about, (z.size, 1))
            local[:, 3] += z * about[1]
            local[:, 4] -= z * about[0]
            total += np.where(beyond, local, 0.0)
        return total

    places = sorted({-20.0, 15.0, 60.0, 62.5, 140.0, -10.0, 55.0, 120.0, 30.0})
    nodes, weights = np.polynomial.legendre.leggauss(6)
    found = np.zeros(6)
    for a, b in itertools.pairwise(places):
        z, w = 0.5 * (a + b) + 0.5 * (b - a) * nodes, 0.5 * (b - a) * weights
        section = next(s for s in STEPPED if s.start <= a and b <= s.end)
        shear = shear_coefficient(section.inner_diameter / section.outer_diameter, 0.3)
        modulus = STEEL.elastic_modulus
        stiffness = np.array(
            [shear * STEEL.shear_modulus * section.area] * 2
            + [modulus * section.area]
            + [modulus * section.second_moment] * 2
            + [2.0 * STEEL.shear_modulus * section.second_moment]
        )
        real = internal(held, wrench, z)
        for component in range(6):
            unit = internal(virtual, np.eye(6)[component], z)
            found[component] += np.einsum("ij,ij,i,j->", real, unit, w, 1.0 / stiffness)
    for bearing, load_of, virtual_load in (
        (held.bearings[0], held.loads[0], virtual.loads[0]),
        (held.bearings[2], held.loads[2], virtual.loads[1]),
    ):
        displacement = (load_of @ wrench)[:5] / bearing.stiffness
        found += virtual_load[:5].T @ displacement
    scale = np.sqrt(np.outer(held.compliance.diagonal(), held.compliance.diagonal()))[load]
    np.testing.assert_allclose(found / scale, held.compliance[load] / scale, rtol=0, atol=1e-8)


def test_compliance_is_symmetric_and_definite_and_reciprocal_between_places() -> None:
    for held in (shaft(), shaft(seat=-20.0, torque_position=100.0), shaft(reference=-400.0)):
        np.testing.assert_allclose(held.compliance, held.compliance.T, rtol=0, atol=1e-18)
        assert np.all(np.linalg.eigvalsh(held.compliance)[1:] > 0.0)
    # The beam between two places, about one point and about another.
    beam = Beam(STEPPED, STEEL)
    shift = np.eye(6)
    shift[3, 1], shift[4, 0] = -33.0, 33.0  # takes a wrench at 33 to one at 0
    about = beam.compliance(-5.0, 80.0, origin=0.0)
    np.testing.assert_allclose(
        beam.compliance(-5.0, 80.0, origin=33.0), shift.T @ about @ shift, rtol=1e-11, atol=1e-20
    )


@pytest.mark.parametrize("tilting", [0.0, 1e7])
def test_loads_of_the_bearings_balance_the_wrench_and_the_torque(tilting: float) -> None:
    bearings = tuple(replace(bearing, tilting=tilting) for bearing in shaft().bearings)
    held, rng = shaft(bearings=bearings, torque_position=140.0), np.random.default_rng(5)
    wrench = rng.normal(size=6) * [1e4, 1e4, 1e4, 1e6, 1e6, 1e6]
    carried = sum(at(bearing.position, load @ wrench) for bearing, load in zip(bearings, held.loads, strict=True))
    left = at(20.0, wrench) - carried
    assert np.max(np.abs(left[:3])) < 1e-12 * 1e4
    assert np.max(np.abs(left[3:5])) < 1e-12 * 1e6
    assert left[5] == pytest.approx(wrench[5], rel=1e-15)  # leaves the shaft where the torque enters


def test_the_work_of_a_wrench_is_the_energy_of_beam_and_bearings() -> None:
    held, wrench = shaft(seat=60.0, reference=60.0), np.array([3e3, -2e3, 4e3, 1e5, 2e5, 0.0])
    stored = sum(
        ((load @ wrench)[:5] ** 2 / bearing.stiffness)[bearing.stiffness > 0].sum()
        for bearing, load in zip(held.bearings, held.loads, strict=True)
        if np.all(bearing.stiffness > 0)
    )
    middle = held.loads[1] @ wrench
    stored += np.sum(middle[:2] ** 2 / 6e5)
    places = sorted({-20.0, 15.0, 60.0, 62.5, 140.0, -10.0, 55.0, 120.0})
    nodes, weights = np.polynomial.legendre.leggauss(4)
    for a, b in itertools.pairwise(places):
        section = next(s for s in STEPPED if s.start <= a and b <= s.end)
        shear = shear_coefficient(section.inner_diameter / section.outer_diameter, 0.3)
        for z, w in zip(0.5 * (a + b) + 0.5 * (b - a) * nodes, 0.5 * (b - a) * weights, strict=True):
            inside = np.zeros(6)
            if z < 60.0:
                inside += at(60.0 - z, wrench)
            for bearing, load in zip(held.bearings, held.loads, strict=True):
                if z < bearing.position:
                    inside -= at(bearing.position - z, load @ wrench)
            bending = STEEL.elastic_modulus * section.second_moment
            stored += w * (inside[0] ** 2 + inside[1] ** 2) / (shear * STEEL.shear_modulus * section.area)
            stored += w * inside[2] ** 2 / (STEEL.elastic_modulus * section.area)
            stored += w * (inside[3] ** 2 + inside[4] ** 2) / bending
    assert wrench @ held.compliance @ wrench == pytest.approx(stored, rel=1e-11)


def test_an_overhung_shaft_is_that_of_the_textbook() -> None:
    """Load F at the overhang a, bearings l apart: bending F a^2 (l + a) / (3 E I), shear, springs as a lever."""
    overhang, span, diameter = 35.0, 70.0, 38.0
    front, back = 5e5, 3e5
    held = Shaft(
        (ShaftSection(0.0, overhang + span, diameter),),
        (Bearing("front", overhang, front, 1e5), Bearing("back", overhang + span, back)),
        reference=0.0,
        material=STEEL,
    )
    bending = STEEL.elastic_modulus * np.pi / 64.0 * diameter**4
    shear = shear_coefficient(0.0, 0.3) * STEEL.shear_modulus * np.pi / 4.0 * diameter**2
    lever = overhang / span
    expected = overhang**2 * (span + overhang) / (3.0 * bending)
    expected += (overhang + lever**2 * span) / shear
    expected += (1.0 + lever) ** 2 / front + lever**2 / back
    assert held.compliance[0, 0] == pytest.approx(expected, rel=1e-13)
    # Tilt under the force: bending, the lever's tilt, the shear angle between the bearings.
    tilt = overhang * span / (3.0 * bending) + overhang**2 / (2.0 * bending)
    tilt += ((1.0 + lever) / front + lever / back) / span + lever / (span * shear) * span
    assert held.compliance[4, 0] == pytest.approx(-tilt, rel=1e-13)
    assert held.compliance[2, 2] == pytest.approx(
        1e-5 + overhang / (STEEL.elastic_modulus * np.pi / 4.0 * diameter**2), rel=1e-13
    )
    np.testing.assert_allclose(held.loads[:, 0, 0], [1.0 + lever, -lever], rtol=1e-13)


def test_a_straddled_shaft_is_that_of_the_textbook() -> None:
    """Load F between two bearings: F a^2 b^2 / (3 E I l) + F a b / (k G A l) + springs."""
    first, second, diameter = 40.0, 65.0, 45.0
    left, right, span = 4e5, 7e5, 105.0
    held = Shaft(
        (ShaftSection(-first, second, diameter),),
        (Bearing("left", -first, left, 1e5), Bearing("right", second, right, 2e5)),
        reference=0.0,
        material=STEEL,
    )
    bending = STEEL.elastic_modulus * np.pi / 64.0 * diameter**4
    shear = shear_coefficient(0.0, 0.3) * STEEL.shear_modulus * np.pi / 4.0 * diameter**2
    expected = (first * second) ** 2 / (3.0 * bending * span) + first * second / (shear * span)
    expected += (second / span) ** 2 / left + (first / span) ** 2 / right
    assert held.compliance[1, 1] == pytest.approx(expected, rel=1e-13)
    axial = STEEL.elastic_modulus * np.pi / 4.0 * diameter**2
    springs = 1.0 / (1.0 / (1e-5 + first / axial) + 1.0 / (5e-6 + second / axial))
    assert held.compliance[2, 2] == pytest.approx(springs, rel=1e-13)


def test_an_infinitely_stiff_bearing_at_the_seat_is_a_clamp() -> None:
    held = Shaft(
        (ShaftSection(0.0, 80.0, 30.0),),
        (Bearing("wall", 80.0, STIFF, STIFF, STIFF),),
        reference=0.0,
        torque_position=80.0,
        material=STEEL,
    )
    cantilever = held.beam.compliance(0.0, 80.0)
    given = np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 0.0]) / STIFF  # what the wall gives, at the wall
    shift = np.eye(6)
    shift[3, 1], shift[4, 0] = 80.0, -80.0
    np.testing.assert_allclose(held.compliance, cantilever + shift.T @ given @ shift, rtol=1e-12, atol=1e-24)


def test_a_rigid_shaft_leaves_the_springs() -> None:
    thick = (ShaftSection(-20.0, 140.0, 2000.0),)
    rigid = Material(1e15, 0.3)
    springs = shaft(sections=thick, material=rigid)
    stiffness = np.zeros((6, 6))
    for bearing in springs.bearings:
        shift = np.eye(6)
        shift[3, 1], shift[4, 0] = -(bearing.position - 20.0), bearing.position - 20.0
        stiffness += shift @ np.diag([*bearing.stiffness, 0.0]) @ shift.T
    np.testing.assert_allclose(springs.compliance[:5, :5], np.linalg.inv(stiffness[:5, :5]), rtol=1e-6, atol=1e-18)


def test_statically_determinate_loads_do_not_depend_on_stiffness() -> None:
    soft = Shaft(STEPPED, (Bearing("a", 0.0, 1e4, 1e3), Bearing("b", 100.0, 5e4)), reference=20.0, seat=-5.0)
    hard = replace(soft, bearings=(Bearing("a", 0.0, 1e9, 1e7), Bearing("b", 100.0, 1e6)), material=Material(7e4, 0.1))
    np.testing.assert_allclose(soft.loads, hard.loads, rtol=0, atol=1e-12)


def test_wind_up_is_the_torsion_between_seat_and_torque() -> None:
    held = shaft(torque_position=140.0)
    polar = [(30.0, np.pi / 32 * 42.0**4), (2.5, np.pi / 32 * (36.0**4 - 8.0**4)), (77.5, np.pi / 32 * 35.0**4)]
    expected = sum(length / (STEEL.shear_modulus * moment) for length, moment in polar)
    assert held.compliance[5, 5] == pytest.approx(expected, rel=1e-14)
    assert not shaft().compliance[5].any()
    np.testing.assert_array_equal(held.compliance[:5, :5], shaft().compliance[:5, :5])


def test_a_curve_follows_a_line_contact_exactly_and_never_overshoots() -> None:
    """delta = c F^0.9, hence k = F^0.1 / c."""
    loads = np.geomspace(100.0, 1e5, 7)
    curve = StiffnessCurve(tuple(loads), tuple(3e-6 * loads**0.9))
    for load in (100.0, 333.0, 5e3, 9.9e4, 1e5):
        assert curve.stiffness(load) == pytest.approx(load**0.1 / 3e-6, rel=1e-12)
        assert curve.stiffness(-load) == curve.stiffness(load)
    assert curve.stiffness(0.0) == curve.stiffness(50.0) == pytest.approx(100.0**0.1 / 3e-6, rel=1e-12)
    assert curve.stiffness(1e7) == pytest.approx(1e5**0.1 / 3e-6, rel=1e-12)
    rough = StiffnessCurve((1e2, 1e3, 1.1e3, 1e4), (1e-3, 1.1e-3, 4e-3, 4.1e-3))
    at = np.geomspace(50.0, 2e4, 400)
    assert np.all(np.diff([load / rough.stiffness(load) for load in at]) > 0.0)


def test_a_curve_of_stiffness_is_that_of_load_over_displacement() -> None:
    curve = StiffnessCurve.of_stiffness([(1e3, 2e5), (4e3, 3e5)])
    assert curve.displacement == pytest.approx((5e-3, 4e-3 / 0.3))
    assert curve.stiffness(4e3) == pytest.approx(3e5, rel=1e-14)


def test_bearings_under_load_move_as_their_curves_say() -> None:
    """A rigid shaft midway on two equal line contacts: F/2 on each, displacement c (F/2)^0.9."""
    loads = np.geomspace(10.0, 1e5, 9)
    curve = StiffnessCurve(tuple(loads), tuple(2e-6 * loads**0.9))
    softer = StiffnessCurve(tuple(loads), tuple(5e-6 * loads**0.9))
    held = Shaft(
        (ShaftSection(0.0, 100.0, 500.0),),
        (Bearing("a", 0.0, curve, curve), Bearing("b", 100.0, curve, softer)),
        reference=50.0,
        material=Material(9e14, 0.3),
    )
    wrench = np.array([3e3, 4e3, 5e3, 0.0, 0.0, 0.0])
    twist = held.under(wrench).compliance @ wrench
    assert np.hypot(*twist[:2]) == pytest.approx(2e-6 * 2500.0**0.9, rel=1e-6)
    assert twist[1] / twist[0] == pytest.approx(4.0 / 3.0, rel=1e-9)
    # Along the axis both share the load so that their displacements are the same: F1/F2 = (5/2)^(1/0.9).
    part = 2.5 ** (1.0 / 0.9) / (1.0 + 2.5 ** (1.0 / 0.9))
    loads_found = held.under(wrench).loads @ wrench
    assert loads_found[0, 2] == pytest.approx(5e3 * part, rel=1e-6)
    assert twist[2] == pytest.approx(2e-6 * (5e3 * part) ** 0.9, rel=1e-6)
    assert held.under(np.zeros(6)).bearings[0].radial == curve.stiffness(0.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sections": (STEPPED[0], STEPPED[2])}, r"section 2 leaves a gap before it: start = 60: must be 15 \[mm\]"),
        (
            {"sections": (STEPPED[0], replace(STEPPED[1], start=14.0))},
            r"section 2 overlaps the one before it: start = 14: must be 15 \[mm\]",
        ),
        (
            {"bearings": (Bearing("a", 0.0, 1e5, 1e5), Bearing("tail", 141.0, 1e5))},
            r"bearing tail: position = 141: must be on the shaft, from -20 to 140 \[mm\]",
        ),
        ({"bearings": (Bearing("a", 0.0, 1e5), Bearing("b", 50.0, 1e5))}, "free to move along its axis"),
        ({"bearings": (Bearing("a", 0.0, 1e5, 1e5), Bearing("b", 0.0, 1e5))}, "free to tilt"),
        ({"bearings": (Bearing("a", 0.0, 0.0, 1e5, 1e5),)}, "free to move across its axis"),
        ({"bearings": (Bearing("a", 0.0, 1e5, 1e5), Bearing("a", 50.0, 1e5))}, "two bearings have the name 'a'"),
        ({"seat": 150.0}, r"seat = 150: must be on the shaft, from -20 to 140 \[mm\]"),
        ({"seat": None, "reference": 200.0}, r"middle of the face.* = 200: must be on the shaft"),
        ({"torque_position": 141.0}, r"torque_position = 141: must be on the shaft"),
    ],
)
def test_a_system_that_cannot_stand_is_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        shaft(**change)


def test_bearings_that_a_thread_cannot_tell_apart_are_refused() -> None:
    twins = tuple(Bearing(name, 1500.0, STIFF, STIFF, STIFF) for name in "ab")
    thread = shaft(sections=(ShaftSection(0.0, 3000.0, 1.0),), bearings=(*twins, Bearing("c", 2400.0, STIFF)))
    with pytest.raises(InputError, match="the bearings are too stiff for the shaft"):
        _ = thread.compliance


def test_sections_and_curves_that_make_no_sense_are_refused() -> None:
    with pytest.raises(InputError, match=r"end = 5: must be greater than start = 5 \[mm\]"):
        ShaftSection(5.0, 5.0, 30.0)
    with pytest.raises(InputError, match=r"inner_diameter = 30: must be smaller than outer_diameter = 30 \[mm\]"):
        ShaftSection(0.0, 5.0, 30.0, 30.0)
    with pytest.raises(InputError, match=r"inner_diameter = 29.9: must leave a wall, at most 29.7 \[mm\]"):
        ShaftSection(0.0, 5.0, 30.0, 29.9)
    with pytest.raises(InputError, match=r"displacement = .*: must increase from point to point"):
        StiffnessCurve((1.0, 2.0), (0.2, 0.1))
    with pytest.raises(InputError, match=r"stiffness 3 at load 2: must be load over displacement, smaller than 2"):
        StiffnessCurve.of_stiffness([(1.0, 1.0), (2.0, 3.0)])
    with pytest.raises(InputError, match=r"bearing a: must have a stiffness above 0"):
        Bearing("a", 0.0, 0.0)


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_a_support_in_the_pair_s_frame_is_the_turned_and_shifted_shaft(member: MemberName) -> None:
    """A force at a point of the face moves this point as the shaft's own compliance says in the member's frame."""
    assembly = Assembly(11, 41, "left", np.radians(75.0), 20.0)
    held, rng = shaft(torque_position=100.0), np.random.default_rng(3)
    support = ShaftSupport.of(held, assembly, member).at(np.zeros(6))
    frame = assembly.pinion_frame if member == "pinion" else np.eye(3)
    origin = assembly.pinion_origin if member == "pinion" else np.zeros(3)
    local_point, local_force = rng.normal(size=3) * 50.0, rng.normal(size=3) * 1e3
    arm = local_point - [0.0, 0.0, 20.0]
    twist = held.compliance @ np.concatenate([local_force, np.cross(arm, local_force)])
    moved = frame @ (twist[:3] + np.cross(twist[3:], arm))
    point, force = origin + frame @ local_point, frame @ local_force
    found = support.at_origin @ np.concatenate([force, np.cross(point, force)])
    np.testing.assert_allclose(found[:3] + np.cross(found[3:], point), moved, rtol=1e-9)
    np.testing.assert_allclose(found[3:], frame @ twist[3:], rtol=1e-9)


def test_loads_of_the_bearings_in_the_pair_s_frame_balance_the_wrench() -> None:
    assembly = Assembly(11, 41, "left", np.radians(75.0), 20.0)
    support = ShaftSupport.of(shaft(), assembly, "pinion").at(np.zeros(6))
    wrench = np.random.default_rng(4).normal(size=6) * [1e4, 1e4, 1e4, 1e6, 1e6, 1e6]
    about = shifted_wrench(wrench, ORIGIN, support.reference)
    left = wrench - sum(shifted_wrench(b.load(about), b.point, ORIGIN) for b in support.bearings)
    axis = assembly.pinion_frame[:, 2]
    torque = axis @ about[3:]
    left[3:] -= torque * axis
    np.testing.assert_allclose(left / [1e4, 1e4, 1e4, 1e6, 1e6, 1e6], 0.0, atol=1e-12)


def test_supports_take_the_secant_of_their_own_member_s_wrench() -> None:
    loads = np.geomspace(10.0, 1e5, 9)
    curve = StiffnessCurve(tuple(loads), tuple(2e-6 * loads**0.9))
    bearings = (Bearing("a", 0.0, curve, 1e5), Bearing("b", 100.0, curve))
    assembly = Assembly(11, 41, "left", np.pi / 2, 20.0)
    gear = ShaftSupport.of(shaft(bearings=bearings), assembly, "gear")
    both = ShaftSupports(ShaftSupport.of(shaft(), assembly, "pinion"), gear)
    wrench = np.array([1e3, 2e3, 3e3, 1e5, 2e5, 0.0])
    found = both.at(0.5 * wrench, wrench)
    assert not both.is_linear
    np.testing.assert_array_equal(found.gear.compliance, gear.at(wrench).compliance)
    assert not np.allclose(found.gear.compliance, gear.at(0.5 * wrench).compliance, atol=0.0)
