"""What is kept, shared or compiled to save time gives the numbers of the work done anew, alone and in numpy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from easeoff import analyze, read_case
from easeoff.cases import gear_pair
from easeoff.contact import ElasticModel, Material, MeshCycle
from easeoff.contact.compliance import WeberLineContact
from easeoff.contact.compliance.unit_loads import Loads, UnitLoads
from easeoff.contact.evaluation.carrying_error import CarryingError
from easeoff.contact.evaluation.marking_print import least_gap
from easeoff.contact.evaluation.mesh_stiffness import mesh_stiffness, mesh_stiffnesses
from easeoff.contact.lines.contact_lines import evenly_spaced
from easeoff.core.compiled.compiled_use import without_compiled_code
from easeoff.core.ordered_values import ordered
from easeoff.geometry import Misalignment, pair_geometry
from easeoff.geometry.newton import complex_steps

Array = NDArray[Any]
AWAY = Misalignment(offset=-0.15, pinion_axial=0.12)


def cycle_of(name: str) -> MeshCycle:
    geometry = pair_geometry(gear_pair(read_case(name)).misaligned(AWAY), (25, 15))
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
    alone = [mesh_stiffness(case) for case in cases]
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


@pytest.mark.usefixtures("kernels_in_python")
@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45"])
def test_compiled_search_of_the_least_gap_is_the_plain_one(name: str) -> None:
    cycle = cycle_of(name)
    error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    points = np.random.default_rng(2).uniform(0.0, 1.0, (2, 400))
    found = least_gap(cycle.fields, error, points)
    with without_compiled_code():
        wanted = least_gap(cycle.fields, error, points)
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9 * float(np.abs(wanted).max()))


@pytest.mark.usefixtures("kernels_in_python")
def test_analysis_without_compiled_code_has_the_same_numbers() -> None:
    case = read_case("fm-11x41")
    coarse = {"mesh_positions": 4, "segments_per_line": 15, "lengthwise_nodes": 21, "profile_nodes": 13}
    compliance = case.compliance.model_copy(update={"model": "shell"})
    case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse), "compliance": compliance})
    found = analyze(case, torques=[100.0, 250.0], misalignment=AWAY)
    with without_compiled_code():
        wanted = analyze(case, torques=[100.0, 250.0], misalignment=AWAY)
    for group, names in {
        "unloaded": ("transmission_error_envelope", "least_gap", "pattern_centre_profile", "contact_ratio"),
        "light_load": ("transmission_error", "pattern_centre_profile", "contact_ratio"),
        "loaded": ("transmission_error", "force", "pressure", "mesh_stiffness", "pattern_centre_profile"),
    }.items():
        for name in names:
            mine, other = (ordered(t[group].to_dataset(), name, *t[group][name].dims) for t in (found, wanted))
            scale = float(np.nanmax(np.abs(other)))
            np.testing.assert_allclose(mine / scale, other / scale, rtol=0, atol=1e-9, err_msg=f"{group}/{name}")


def test_derivatives_by_some_of_the_parameters_are_those_by_all() -> None:
    def function(p: Array) -> Array:
        return np.stack([p[0] * p[1] + p[2], np.sin(p[0]) * p[2]])

    for columns in (5, 4001):  # more than are worked on together
        at = np.random.default_rng(4).normal(size=(3, columns))
        value, slopes = complex_steps(function, at)
        same, first = complex_steps(function, at, 2)
        np.testing.assert_array_equal(same, value)
        np.testing.assert_array_equal(first, slopes[:2])
