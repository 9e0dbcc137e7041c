"""Loaded contact: equilibrium, limits, convergence, agreement of solvers, and what happens when a cell fails."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import small
from tooth_models import coarse_solid_shells

from easeoff import InputError, analyze
from easeoff.cases import Case, gear_pair, read_case
from easeoff.contact import ElasticModel, MeshCycle, available_solvers
from easeoff.contact.compliance.elastic_model import shells, tooth_dimensions
from easeoff.geometry import pair_geometry
from easeoff.study import CaseInMesh
from easeoff.study.analysis.contact_analysis import contact_analysis


def run(case: Case, **arguments: Any) -> xr.Dataset:
    """Loaded contact of a case."""
    return CaseInMesh.of(case).cycle.loaded(**arguments)[0]


@pytest.fixture(scope="module")
def loaded() -> xr.Dataset:
    return run(small(compliance="shell"), torques=[50.0, 150.0, 400.0])


def test_every_position_is_certified(loaded: xr.Dataset) -> None:
    assert np.all(loaded["status"].values == 0)
    for name in ("equilibrium", "negative_force", "negative_gap", "complementarity", "duality_gap"):
        assert loaded[name].max() < 1e-9


def test_forces_balance_the_torque(loaded: xr.Dataset) -> None:
    moment = (loaded["force"] * loaded["lever_arm"]).sum("segment")
    np.testing.assert_allclose(moment, 1e3 * 3.0 * loaded["torque"] * xr.ones_like(moment), rtol=1e-10)
    assert loaded["force"].min() >= 0.0
    assert loaded["gap"].min() >= -1e-6
    assert float((loaded["force"] * loaded["gap"]).max()) < 1e-6
    np.testing.assert_allclose(loaded["load_share"].sum("pair"), 1.0, rtol=1e-12)


def test_more_torque_turns_the_gear_further(loaded: xr.Dataset) -> None:
    assert np.all(np.diff(loaded["transmission_error"].values, axis=0) > 0.0)
    assert np.all(np.diff(loaded["max_pressure"].values) > 0.0)


def test_vanishing_torque_gives_the_unloaded_error() -> None:
    """Loaded error at ever smaller torque approaches the unloaded one from above, in proportion to the deflection."""
    # Fine segments: a segment's separation is its mean, which lies above the point of first contact.
    tree = analyze(small("fm-11x41", "shell", segments_per_line=201), torques=[1e-4, 1e-3])
    loaded, unloaded = tree["loaded"].to_dataset(), tree["unloaded"].to_dataset()
    excess = loaded["transmission_error"].values - unloaded["transmission_error_envelope"].values
    assert np.all(excess > 0.0)
    assert excess.max() < 1.0
    assert np.all(excess[0] < excess[1])


def test_hertz_pressure_follows_from_force_length_and_radius(loaded: xr.Dataset) -> None:
    """p = sqrt(F' E' / (2 pi R)) with E' = E / (1 - nu^2) for equal members."""
    force, length = loaded["force"].values, loaded["length"].values
    expected = np.sqrt(force / length * (206000.0 / 0.91) / (2 * np.pi * loaded["equivalent_radius"].values))
    carrying, on_edge = force > 1.0, np.isfinite(loaded["overhang"].values)
    on_line = carrying & ~on_edge
    np.testing.assert_allclose(loaded["pressure"].values[on_line], expected[on_line], rtol=1e-9)
    assert np.any(carrying & on_edge)
    assert np.all(np.isnan(loaded["pressure"].values[on_edge]))  # an edge has no half space


@pytest.mark.thorough
def test_all_solvers_agree() -> None:
    """Every installed solver gives the native transmission error within 1e-6 relative, certified by us."""
    case = small(compliance="shell")
    native = run(case, torques=[80.0, 300.0])["transmission_error"].values
    solvers = [name for name in available_solvers() if name != "native"]
    assert {"clarabel", "osqp", "daqp", "piqp", "cvxpy"} <= set(solvers)
    for name in solvers:
        found = run(case, torques=[80.0, 300.0], solver=name)
        assert np.all(found["status"].values == 0), name
        np.testing.assert_allclose(found["transmission_error"].values, native, rtol=1e-6, err_msg=name)


def test_coast_side_runs_from_the_case_alone() -> None:
    tree = analyze(small(compliance="shell"), flank="coast", torques=[150.0])
    assert np.all(tree["loaded"]["status"].values == 0)
    assert tree.attrs["flank"] == "coast"


@pytest.mark.thorough
def test_error_converges_with_the_number_of_segments() -> None:
    """First to second order; the default of 31 is within half a percent of the converged error."""
    results = {}
    for count in (8, 16, 31, 32, 128):
        found = run(small(compliance="shell", segments_per_line=count), torques=[150.0])
        results[count] = (found["transmission_error"].values[0], float(found["max_pressure"][0]))
    reference, pressure = results[128]
    errors = {n: np.abs(r[0] / reference - 1.0).max() for n, r in results.items()}
    assert errors[31] < 5e-3
    assert np.log2(errors[8] / errors[32]) / 2.0 > 0.8
    assert abs(results[31][1] / pressure - 1.0) < 0.05


def test_error_converges_with_the_grid() -> None:
    values = []
    for nt, nh in ((13, 9), (31, 21), (49, 33)):
        case = small("fm-11x41", "shell", lengthwise_nodes=nt, profile_nodes=nh)
        values.append(run(case, torques=[250.0])["transmission_error"].values)
    assert np.abs(values[1] / values[2] - 1.0).max() < 1e-4
    assert np.abs(values[1] - values[2]).max() < np.abs(values[0] - values[2]).max()


def test_softer_pieces_make_a_softer_pair() -> None:
    """Shells: clamped root below springs; thin shear factor above none; steel below softer steel."""
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))

    def level(model: ElasticModel) -> float:
        found, _ = MeshCycle.of(geometry, model, mesh_positions=3, segments_per_line=9).loaded([150.0])
        return float(found["mean_level"][0])

    default = ElasticModel()
    assert level(replace(default, foundation=None)) < level(default)
    assert level(default) < level(replace(default, shear_factor=5 / 6))
    soft = replace(default, pinion=replace(default.pinion, elastic_modulus=100000.0))
    assert level(default) < level(soft)


@pytest.mark.parametrize("neighbours", [False, True])
def test_segments_on_one_tooth_pair_are_coupled_and_others_by_the_body_alone(neighbours: bool) -> None:
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    model = coarse_solid_shells(geometry.pair, neighbours=neighbours)
    for here in MeshCycle.of(geometry, model, mesh_positions=3, segments_per_line=9).segments.by_position:
        assert here is not None
        other = here.pair[:, None] != here.pair[None, :]
        bending = here.bending_problem.dense_compliance
        assert np.all((bending[other] != 0.0) == neighbours)
        assert np.all(bending[~other] != 0.0)


def test_plate_dimensions_reach_the_shell() -> None:
    pair = gear_pair(read_case("nasa-12x36"))
    teeth = pair_geometry(pair, (9, 7)).teeth
    pinion, gear = shells(teeth, ElasticModel())
    assert pinion.dimensions == tooth_dimensions(teeth, "pinion")
    assert gear.dimensions.height_heel == pytest.approx(8.71, abs=0.01)


@pytest.mark.parametrize("torques", [[], [0.0], [-1.0], [float("nan")]])
def test_torques_must_be_positive(torques: list[float]) -> None:
    with pytest.raises(InputError, match="torque"):
        analyze(small(compliance="shell"), torques=torques)


def test_contact_problems_are_kept_with_their_solutions() -> None:
    analysis = contact_analysis(CaseInMesh.of(small(compliance="shell")), [100.0])
    assert len(analysis.cases) == 3
    for case in analysis.cases:
        assert case.problem.torque == pytest.approx(1e3 * 3.0 * 100.0)
        gap = case.problem.gap(case.solution.force, case.solution.rotation)
        assert gap.min() > -1e-12


def test_small_matrices_are_left_to_one_thread() -> None:
    """Shared out over threads they take longer, and the number of threads would decide the last bit of a result."""
    from threadpoolctl import threadpool_info

    threads: list[int] = []

    def count() -> None:
        threads.extend(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")

    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    cycle = MeshCycle.of(geometry, ElasticModel(), mesh_positions=2, segments_per_line=5)
    cycle.loaded([100.0], progress=count)
    assert set(threads) == {1}


def test_light_load_is_that_of_an_analysis_of_its_own() -> None:
    """On the segments of the greatest torque, of which under the light load further ones are out of contact."""
    case = small("fm-11x41", "shell")
    light = analyze(case, torques=[500.0])["light_load"].to_dataset()
    alone = analyze(case, torques=[5.0])["loaded"].to_dataset()
    for name in ("transmission_error", "max_pressure", "load_share", "pattern_length", "mesh_stiffness"):
        np.testing.assert_allclose(
            light[name].sel(pair=alone["pair"]) if name == "load_share" else light[name], alone[name], rtol=1e-9
        )
