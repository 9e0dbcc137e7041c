"""Studies of a case on supports: analysis, wear, optimization and verification in the assembly under load."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import read_only, small

import easeoff
from easeoff.cases import Case, with_supports
from easeoff.contact import AssemblyRounds, Supports
from easeoff.core.errors import GeometryError
from easeoff.geometry import Misalignment
from easeoff.study import CaseInMesh, WearLaw, contact_analysis, wear
from easeoff.study.analysis.supported_analysis import in_assembly_under_load
from easeoff.study.report.summary.result_summary import doubts

GROUPS = ["flanks", "ease_off", "teeth", "unloaded", "light_load", "misalignment", "supports", "loaded"]


def coarse() -> Case:
    return small("fm-11x41", "shell", edge_contact=False)


def on_supports() -> Case:
    return with_supports(coarse(), "axle-fm-11x41")


@cache
def analysis(supported: bool) -> xr.DataTree:
    return read_only(easeoff.analyze(on_supports() if supported else coarse(), torques=[100.0, 300.0]))


@pytest.mark.thorough
def test_analysis_on_supports_is_a_result_like_others(tmp_path: Path) -> None:
    tree = easeoff.analyze(coarse(), torques=[300.0, 100.0], supports="axle-fm-11x41", speed=1000.0)
    assert list(tree.children) == [*GROUPS, "friction"]
    assert (tree["loaded"].to_dataset()["status"].values == 0).all()
    path = tmp_path / "result.nc"
    easeoff.write_result(tree, path)
    again = easeoff.read_result(path)
    for name in ("supports", "misalignment", "loaded"):
        assert again[name].to_dataset().equals(tree[name].to_dataset())
    named = easeoff.analyze(on_supports(), torques=[300.0, 100.0])
    assert named["supports"].to_dataset().equals(tree["supports"].to_dataset())


@pytest.mark.parametrize(("given", "told"), [(None, True), ({"E": 0.0}, False), ({"E": 0.05}, False)])
def test_the_misalignment_of_a_case_is_told_to_be_added_on_supports(given: Any, told: bool) -> None:
    first_order = AssemblyRounds(update="none")
    tree = easeoff.analyze(on_supports(), torques=[250.0], misalignment=given, rounds=first_order)
    notes = [note for note in doubts(tree) if "is added to that of the supports" in note]
    assert len(notes) == told
    if told:
        assert "the case's misalignment E -0.15 mm, P +0.12 mm stands without torque" in notes[0]
        assert "is added to that of the supports" in tree.easeoff.summary()._repr_html_()


def test_rigid_supports_give_the_analysis_without() -> None:
    plain = analysis(False)
    assert "supports" not in plain.children
    rigid = easeoff.analyze(
        coarse(), torques=[100.0, 300.0], supports=Supports.rigid(), rounds=AssemblyRounds(update="none")
    )
    assert plain["loaded"].to_dataset().identical(rigid["loaded"].to_dataset())
    for name in ("offset", "pinion_axial", "gear_axial", "shaft_angle"):
        np.testing.assert_allclose(
            plain["misalignment"].to_dataset()[name], rigid["misalignment"].to_dataset()[name], atol=1e-15
        )


def test_unloaded_contact_is_that_of_the_assembly_without_load() -> None:
    tree, plain = analysis(True), analysis(False)
    for name in ("ease_off", "unloaded"):
        assert tree[name].to_dataset().identical(plain[name].to_dataset())
    moved = (
        tree["misalignment"].to_dataset()["shaft_angle"].values
        - plain["misalignment"].to_dataset()["shaft_angle"].values
    )
    assert (moved > 1e-4).all()
    light = abs(
        tree["light_load"].to_dataset()["transmission_error"].values
        - plain["light_load"].to_dataset()["transmission_error"].values
    ).max()
    heavy = abs(
        tree["loaded"].to_dataset()["transmission_error"].values
        - plain["loaded"].to_dataset()["transmission_error"].values
    ).max()
    assert light < 0.2 * heavy


def test_assembly_under_load_is_that_of_the_analysis() -> None:
    tree = analysis(True)
    state = in_assembly_under_load(CaseInMesh.of(on_supports()), [300.0, 100.0])
    assert state.case.supports is None
    assert state.deflections is not None
    for torque in (100.0, 300.0):
        found = tree["misalignment"].to_dataset().sel(torque=torque).mean("mesh_position")
        for name, value in vars(state.deflections.at(torque)).items():
            assert value == pytest.approx(found[name].item(), rel=1e-12)
    # What varies over the mesh cycle is small: so is the difference of the two analyses.
    held = contact_analysis(state, [100.0, 300.0]).groups["loaded"]
    np.testing.assert_allclose(held["max_pressure"], tree["loaded"].to_dataset()["max_pressure"], rtol=0.02)


@pytest.mark.thorough
def test_wear_and_optimization_hold_the_assembly_under_load() -> None:
    law = WearLaw(1e-10, 1e-10, revolutions=1e4)
    on, off = (wear(case, law, torque=300.0) for case in (on_supports(), coarse()))
    state = in_assembly_under_load(CaseInMesh.of(on_supports()), [300.0])
    assert state.deflections is not None
    errors = state.deflections.at(300.0)
    there = wear(coarse(), law, torque=300.0, misalignment=errors)
    np.testing.assert_allclose(on["max_pressure"], there["max_pressure"], rtol=1e-9)
    assert abs(off["max_pressure"].values[0] / on["max_pressure"].values[0] - 1.0) > 0.01
    best = easeoff.modify(on_supports(), torques=[300.0], order=2, programmes=1)
    for name, value in vars(errors).items():
        np.testing.assert_allclose(best["misalignment"].to_dataset()[name], value, rtol=1e-9)
    before, after = best["optimization"].to_dataset()["max_line_load"].values.ravel()
    assert after <= before


def test_assembly_that_is_not_found_is_an_error_with_a_reason() -> None:
    case = on_supports()
    state = CaseInMesh.of(case, misalignment=Misalignment(offset=0.1))
    with pytest.MonkeyPatch.context() as patch:
        limited = AssemblyRounds(limit=1e-9, most=1)
        patch.setattr("easeoff.study.analysis.supported_analysis.case_rounds", lambda case: limited)
        with pytest.raises(GeometryError, match="after 1 rounds the assembly still changes gaps"):
            in_assembly_under_load(state, [300.0])
