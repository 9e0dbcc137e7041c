"""A pair in mesh over one pitch: what is kept, shared or made from another equals the work done anew."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr
from deviations import GEAR_ERRORS, PINION_ERRORS
from numpy.typing import NDArray
from runs import small
from tooth_models import few_bricks

from easeoff import InputError, analyze
from easeoff.cases import Deflections, gear_pair, read_case
from easeoff.contact import ElasticModel, Material, MeshCycle, Shell, lines_in_mesh
from easeoff.contact.compliance.elastic_model import ElasticTeeth, Loads, UnitLoads, solid_shells
from easeoff.contact.compliance.finite_elements.flank_compliance import FlankCompliance
from easeoff.contact.compliance.weber_line_contact import WeberLineContact
from easeoff.contact.evaluation.cycle_numbers import mesh_stiffnesses
from easeoff.contact.evaluation.marking_print import (
    _GAP_FIELDS,
    GAIN_MINIMUM,
    SHIFT_ROUND_COUNT,
    SHIFT_SAMPLE_COUNT,
    _Gaps,
    least_gap,
)
from easeoff.contact.evaluation.tooth_passage import CarryingError
from easeoff.contact.lines.closest_approach import gap_beside, still_opens
from easeoff.contact.lines.contact_lines import evenly_spaced
from easeoff.contact.loaded import CycleSolver, loaded_splines
from easeoff.contact.segments import CycleSegments, LineSegments
from easeoff.geometry import Misalignment, Modification, PairGeometry, deviation_from_formula, pair_geometry
from easeoff.geometry.deviation.deviated_flank import deviated_ease_off, deviated_pair
from easeoff.geometry.newton import complex_steps
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.modification import modified_ease_off
from easeoff.study import CaseInMesh
from easeoff.study.analysis.contact_analysis import contact_analysis

NODES = (9, 7)
AWAY = Misalignment(offset=0.05, pinion_axial=-0.03, gear_axial=0.02, shaft_angle=1e-4)
CROWNED = Modification({"lengthwise_crowning": 6.0, "bias": -3.0})
TORQUES = [60.0, 250.0]
CASES = ["nasa-12x36", "fm-11x41"]


@pytest.fixture(autouse=True, scope="module")
def bricks() -> Iterator[None]:
    """Teeth are not the point."""
    with few_bricks():
        yield


def of(geometry: PairGeometry, model: ElasticModel | None = None) -> MeshCycle:
    return MeshCycle.of(geometry, model, mesh_positions=3, segments_per_line=9)


def model_for(name: str) -> ElasticModel | None:
    """Solid shells for one pair, plain ones for the other."""
    return None if name == "fm-11x41" else ElasticModel()


@cache
def designed(name: str) -> MeshCycle:
    return of(pair_geometry(gear_pair(read_case(name)), NODES), model_for(name))


def require_same(one: xr.Dataset, other: xr.Dataset) -> None:
    """To the bit, attributes as well."""
    assert set(one.variables) == set(other.variables)
    for name in one.variables:
        np.testing.assert_array_equal(one[name].values, other[name].values, err_msg=str(name))
    assert set(one.attrs) == set(other.attrs)
    for name in one.attrs:
        np.testing.assert_array_equal(one.attrs[name], other.attrs[name], err_msg=name)


def require_same_results(one: MeshCycle, other: MeshCycle) -> None:
    for name in ("flanks", "ease_off", "teeth"):
        require_same(getattr(one.geometry, name), getattr(other.geometry, name))
    require_same(one.unloaded(), other.unloaded())
    for edge_contact in (False, True):
        found = [cycle.loaded(TORQUES, edge_contact=edge_contact)[0] for cycle in (one, other)]
        require_same(*found)
        assert np.all(found[0]["status"] == 0)


@pytest.mark.parametrize("name", CASES)
def test_modified_cycle_is_that_of_the_modified_ease_off(name: str) -> None:
    cycle = designed(name)
    cycle.loaded(TORQUES)  # what is kept of it must not show in the other
    ease_off = modified_ease_off(cycle.geometry.ease_off, CROWNED)
    modified = cycle.with_ease_off(ease_off)
    require_same_results(modified, of(replace(cycle.geometry, ease_off=ease_off), model_for(name)))
    assert modified.lines is cycle.lines
    assert modified.segments.on_lines is cycle.segments.on_lines
    assert modified.geometry.flanks is cycle.geometry.flanks
    assert modified.geometry.exact is cycle.geometry.exact


@pytest.mark.parametrize("name", CASES)
def test_misaligned_cycle_is_that_of_the_misaligned_pair(name: str) -> None:
    cycle = designed(name)
    away = cycle.misaligned(AWAY)
    require_same_results(away, of(pair_geometry(cycle.geometry.pair.misaligned(AWAY), NODES), model_for(name)))
    assert away.geometry.members is cycle.geometry.members
    assert away.elastic is cycle.elastic
    assert away.lines is not cycle.lines


def test_there_and_back_is_where_it_began() -> None:
    cycle = designed("fm-11x41")
    back = cycle.misaligned(AWAY).misaligned(cycle.geometry.pair.assembly.misalignment)
    require_same(back.loaded(TORQUES)[0], cycle.loaded(TORQUES)[0])


def test_contact_lines_follow_a_roll_angle_that_changes() -> None:
    """A deviation of the gear leaves them, one of the pinion moves them."""
    cycle = designed("fm-11x41")
    pair = cycle.geometry.pair
    gear = deviation_from_formula(pair.gear.section, GEAR_ERRORS)
    pinion = deviation_from_formula(pair.pinion.section, PINION_ERRORS)
    worn = cycle.with_ease_off(deviated_ease_off(cycle.geometry, gear=gear))
    assert worn.lines is cycle.lines
    ease_off = deviated_ease_off(cycle.geometry, gear=gear, pinion=pinion)
    both = cycle.with_ease_off(ease_off)
    assert both.lines is not cycle.lines
    assert both.elastic is cycle.elastic
    require_same_results(both, of(replace(cycle.geometry, ease_off=ease_off)))
    # And from there on they stay.
    crowned = both.with_ease_off(modified_ease_off(ease_off, CROWNED))
    assert crowned.lines is both.lines


def test_geometry_keeps_the_exact_ease_off() -> None:
    geometry = designed("nasa-12x36").geometry
    pair = geometry.pair
    fresh = exact_ease_off(geometry.members.gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    np.testing.assert_array_equal(geometry.exact.angle, fresh.angle)
    np.testing.assert_array_equal(geometry.exact.pinion_position, fresh.pinion_position)
    assert geometry.misaligned(AWAY).pair.assembly.misalignment == AWAY


def test_cycle_is_its_parts_put_together() -> None:
    """The functions of the stages, called by hand, give the same to the bit."""
    cycle = designed("fm-11x41")
    geometry = cycle.geometry
    fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    lines = lines_in_mesh(fields, cycle.pinion_pitch, 3)
    teeth = ElasticTeeth(geometry.teeth, solid_shells(geometry.pair))
    segments = CycleSegments(fields, LineSegments(fields, lines, teeth, 9))
    by_hand, _ = CycleSolver(cycle.ratio).loaded(segments, np.array(TORQUES))
    require_same(cycle.loaded(TORQUES)[0], by_hand)


def test_teeth_are_solid_shells_unless_another_model_is_given() -> None:
    """Those of the case, whatever the assembly and the deviations of the flanks; plain shells on asking."""
    name = "fm-11x41"
    of_case = CaseInMesh.of(small(name)).cycle
    for pair in (of_case.geometry.pair, of_case.geometry.pair.misaligned(AWAY)):
        for own, other in zip(of(pair_geometry(pair, NODES)).elastic, of_case.elastic, strict=True):
            assert isinstance(own, FlankCompliance)
            assert isinstance(other, FlankCompliance)
            np.testing.assert_array_equal(own.factor, other.factor)
    pair = of_case.geometry.pair
    worn = deviated_pair(pair, gear=deviation_from_formula(pair.gear.section, GEAR_ERRORS))
    np.testing.assert_array_equal(solid_shells(worn).condensed[1].factor, of_case.elastic[1].factor)  # type: ignore[index, union-attr]
    assert all(isinstance(tooth, Shell) for tooth in MeshCycle.of(of_case.geometry, ElasticModel()).elastic)


def test_one_position_alone_has_the_lines_of_the_cycle() -> None:
    cycle = designed("fm-11x41")
    every = cycle.solved(TORQUES)
    for position in range(3):
        here = [case for case in every if case.mesh_position == position]
        for alone, case in zip(cycle.at(position).solved(TORQUES), here, strict=True):
            np.testing.assert_array_equal(alone.segments.separation, case.segments.separation)
            np.testing.assert_allclose(alone.solution.force, case.solution.force, rtol=0, atol=1e-9)
    finer = cycle.at(0).with_segments(18).segments.by_position
    assert [here.length.size for here in finer if here is not None] == [2 * every[0].segments.length.size]


def test_cycle_refuses_impossible_torques() -> None:
    for torques in ([], [0.0], [np.nan]):
        with pytest.raises(InputError, match=r"torques = .*must be .*finite numbers? above 0"):
            designed("nasa-12x36").loaded(torques)


def test_the_pair_of_deflections_is_that_of_no_torque() -> None:
    axle = Deflections([100.0, 300.0], offset=[0.02, 0.05])
    assert CaseInMesh.of(small()).misaligned(axle).pair.assembly.misalignment == axle.at(0.0, "drive")


@pytest.mark.parametrize("deviated", ["ease_off", "surface"])
def test_misaligned_case_keeps_deviations_and_modification(deviated: str) -> None:
    """A study over assemblies gives what an analysis of each gives."""
    case = small("fm-11x41", "shell", edge_contact=False)
    pair = gear_pair(case)
    state = {
        "deviations": {
            "gear": deviation_from_formula(pair.gear.section, lambda t, h: 0.3 * GEAR_ERRORS(t, h)),
            "pinion": deviation_from_formula(pair.pinion.section, lambda t, h: 0.3 * PINION_ERRORS(t, h)),
        },
        "deviated": deviated,
        "modification": CROWNED,
    }
    found = contact_analysis(CaseInMesh.of(case, **state).misaligned(AWAY), TORQUES).tree  # type: ignore[arg-type]
    whole = analyze(case, misalignment=AWAY, torques=TORQUES, **state)  # type: ignore[arg-type]
    for group in whole.children:
        require_same(found[group].to_dataset(), whole[group].to_dataset())
    others = ("history", "backlash_left_out")  # the backlash is of whole analyses alone
    kept, wanted = ({k: v for k, v in one.attrs.items() if k not in others} for one in (found, whole))
    assert kept == wanted


# What is kept, shared or compiled to save time gives the numbers of the work done anew, alone and in numpy


Array = NDArray[Any]
FAR_AWAY = Misalignment(offset=-0.15, pinion_axial=0.12)


def cycle_of(name: str) -> MeshCycle:
    geometry = pair_geometry(gear_pair(read_case(name)).misaligned(FAR_AWAY), (25, 15))
    return MeshCycle.of(geometry, ElasticModel(), mesh_positions=4, segments_per_line=21)


def test_the_edges_of_a_light_load_are_the_same_after_a_heavy_one() -> None:
    """What is kept of a cycle does not depend on the loads before: to the bit what is found without them."""
    alone = cycle_of("fm-11x41").loaded([150.0])[0]
    cycle = cycle_of("fm-11x41")
    heavy = cycle.loaded([600.0])[0]
    xr.testing.assert_identical(cycle.loaded([150.0])[0], alone)
    assert int(np.isfinite(heavy["overhang"]).sum()) > int(np.isfinite(alone["overhang"]).sum()) > 0


def test_blocks_of_unit_loads_are_their_compliance_with_edges_and_without() -> None:
    rng = np.random.default_rng(3)
    on_lines, on_edges = rng.normal(size=(12, 40)), rng.normal(size=(5, 40))
    parts = slice(0, 25), slice(25, 40)
    lines, edges = (Loads(tuple(one[:, own] for own in parts), one[:, :0]) for one in (on_lines, on_edges))
    loads = UnitLoads(lines).with_edges(edges)
    both = np.concatenate([on_lines, on_edges])
    for rows in (np.arange(9), np.array([0, 1, 2, 5, 13, 16]), np.arange(9)):
        pairs = np.where(np.arange(rows.size) % 3 == 0, -1, 2)
        factor = loads.bending(pairs, rows).factor
        wanted = np.where(pairs[:, None] == pairs, both[rows] @ both[rows].T, 0.0)
        np.testing.assert_allclose(factor @ factor.T, wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())


def test_parts_of_line_contacts_are_line_contacts_of_their_own() -> None:
    rng = np.random.default_rng(0)
    length, radius, one, other = rng.uniform(1.0, 4.0, (4, 30))
    overhang = np.where(rng.random(30) < 0.3, rng.uniform(-0.3, 0.1, 30), np.nan)
    steel, bronze = Material(206000.0, 0.3), Material(110000.0, 0.25)

    def made(own: slice) -> WeberLineContact:
        depths = one[own], other[own]
        return WeberLineContact(length[own], radius[own], *depths, steel, bronze, 0.14, overhang=overhang[own])

    whole, cuts = made(slice(None)), [slice(0, 11), slice(11, 12), slice(12, 30)]
    force = rng.uniform(0.0, 300.0, 30)
    for joined in (WeberLineContact.joined([made(cut) for cut in cuts]), WeberLineContact.joined([whole])):
        for name in ("secant", "tangent", "pressure", "half_width", "energy"):
            np.testing.assert_allclose(getattr(joined, name)(force), getattr(whole, name)(force), rtol=1e-14)
        np.testing.assert_allclose(joined.parameters, whole.parameters, rtol=1e-14)
    for cut in cuts:
        np.testing.assert_allclose(whole.part(cut).tangent(force[cut]), made(cut).tangent(force[cut]), rtol=1e-14)
        np.testing.assert_allclose(whole.part(cut).parameters, made(cut).parameters, rtol=1e-14)


def test_stiffnesses_of_many_cases_are_those_of_each() -> None:
    cases = cycle_of("fm-11x41").loaded([2.5, 250.0])[1]
    alone = [mesh_stiffnesses([case])[0] for case in cases]
    np.testing.assert_allclose(mesh_stiffnesses(cases), alone, rtol=1e-11)
    assert np.all(np.isfinite(alone))


def test_lines_are_spaced_evenly_as_each_by_itself() -> None:
    """Also one with a point twice, and one that is a point alone."""
    rng = np.random.default_rng(1)
    points, measure = rng.normal(size=(2, 5, 20)), np.cumsum(rng.uniform(0.1, 1.0, (5, 20)), axis=1)
    measure[2, 7], measure[4] = measure[2, 6], 3.0
    found = evenly_spaced(points, measure, 33)
    for row in range(4):
        at = np.linspace(measure[row, 0], measure[row, -1], 33)
        for side in range(2):
            wanted = np.interp(at, measure[row], points[side, row])
            np.testing.assert_allclose(found[side, row], wanted, rtol=0, atol=1e-12)
    assert np.all(np.isfinite(found))


@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45"])
def test_search_of_the_least_gap_is_that_of_numpy(name: str) -> None:
    cycle = cycle_of(name)
    error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    points = np.random.default_rng(2).uniform(0.0, 1.0, (2, 400))
    found = least_gap(cycle.fields, error, points)
    value = cycle.fields.evaluate(list(_GAP_FIELDS), points)
    gaps = _Gaps.of(value, error)
    curvature, skew, reach = gaps.curvature, gaps.skew, gaps.reach
    best, wanted, sample = np.zeros_like(reach), np.zeros_like(reach), np.linspace(-1.0, 1.0, SHIFT_SAMPLE_COUNT)
    for _ in range(SHIFT_ROUND_COUNT):
        tried = best + sample[:, None] * reach
        opens = still_opens(curvature, skew, tried) | (tried == 0.0)
        carried = error.least(value["roll_angle"] + tried)
        gap = np.where(opens, gap_beside(value["ease_off_angle"], curvature, skew, tried) - carried, np.inf)
        chosen = np.argmin(gap, axis=0)[None]
        best, wanted = (np.take_along_axis(values, chosen, axis=0)[0] for values in (tried, gap))
        reach = 2.0 * reach / (SHIFT_SAMPLE_COUNT - 1)
    wanted = np.where(gaps.gain > GAIN_MINIMUM, 1e3 * value["lever_arm"] * wanted, gaps.at_roll_angle)
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9 * float(np.abs(wanted).max()))


def test_derivatives_by_some_of_the_parameters_are_those_by_all() -> None:
    def function(p: Array) -> Array:
        return np.stack([p[0] * p[1] + p[2], np.sin(p[0]) * p[2]])

    for columns in (5, 4001):  # more than are worked on together
        at = np.random.default_rng(4).normal(size=(3, columns))
        value, slopes = complex_steps(function, at)
        same, first = complex_steps(function, at, 2)
        np.testing.assert_array_equal(same, value)
        np.testing.assert_array_equal(first, slopes[:2])
