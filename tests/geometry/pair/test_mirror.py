"""Mirror images: with all hands swapped every result stays, and vectors change the sign of their y component alone."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import xarray as xr
from pairs import hobbed_pair, mirrored

from easeoff.cases import gear_pair, read_case, shipped_cases
from easeoff.contact import ElasticModel, MeshCycle
from easeoff.contact.compliance.elastic_model import STEEL
from easeoff.contact.compliance.finite_elements.finite_element_tooth import solid_shell_tooth
from easeoff.friction import Operation, friction
from easeoff.geometry import (
    EaseOffTarget,
    FlankName,
    GearPair,
    Misalignment,
    fit_pinion,
    pair_geometry,
)
from easeoff.geometry.design.pair_design import BOTH_MEMBERS

# Offset, axial positions and shaft angle are lengths and an angle of the pair: their mirror image is the same number.
ERRORS = Misalignment(0.08, -0.05, 0.03, 0.0005)
RESIDUALS = ("equilibrium", "negative_force", "negative_gap", "complementarity", "duality_gap", "resolution")
PAIRS = [*shipped_cases(), "face-hobbed"]
HOBBED_CASES = [name for name in PAIRS if name.startswith("fh-")]


@cache
def crowned_hobbed_pair(flank: FlankName) -> GearPair:
    pair = hobbed_pair("left", coast=flank == "coast")
    fitted = fit_pinion(pair, EaseOffTarget(0.02, 0.015, 0.0, 0.0, -0.005))
    return replace(pair, pinion=replace(pair.pinion, loaded=fitted.surface))


def named(name: str, flank: FlankName) -> GearPair:
    return crowned_hobbed_pair(flank) if name == "face-hobbed" else gear_pair(read_case(name), flank)


def coarse_solid_shells(pair: GearPair) -> ElasticModel:
    """Solid shells of few functions, on the body that the teeth share."""
    pinion, gear = (solid_shell_tooth(pair, name, STEEL, fineness=0.2).flank for name in BOTH_MEMBERS)
    return ElasticModel(condensed=(pinion, gear))


def analysed(pair: GearPair, *, solid: bool = False, whole: bool = True) -> dict[str, xr.Dataset]:
    """Every dataset of an analysis, or ease-off and loaded contact alone, on a coarse grid.

    With teeth as shells or as solid shells.
    """
    geometry = pair_geometry(pair, (11, 9))
    model = coarse_solid_shells(pair) if solid else ElasticModel()
    cycle = MeshCycle.of(geometry, model, mesh_positions=3, segments_per_line=9)
    loaded, _ = cycle.loaded([60.0, 250.0])
    contact = {"ease_off": geometry.ease_off, "loaded": loaded}
    if not whole:
        return contact
    return contact | {
        "flanks": geometry.flanks,
        "teeth": geometry.teeth,
        "unloaded": cycle.unloaded(),
        "friction": friction(xr.DataTree.from_dict(contact), Operation(1500.0)),
    }


def differences(one: dict[str, xr.Dataset], two: dict[str, xr.Dataset]) -> dict[str, float]:
    """Largest difference of every variable over its size; infinite where only one has a value.

    Residuals of a certificate are rounding themselves, and how often a solver goes round may hang on it.
    """
    found = {}
    for group, dataset in one.items():
        for name, variable in dataset.data_vars.items():
            if name == "iterations":
                continue
            a, b = (np.asarray(v.values, dtype=float) for v in (variable, two[group][name]))
            same_holes = a.shape == b.shape and np.array_equal(np.isnan(a), np.isnan(b))
            size = 1.0 if name in RESIDUALS else float(np.nanmax(np.abs(a), initial=0.0)) or 1.0
            found[f"{group}/{name}"] = float(np.nanmax(np.abs(a - b), initial=0.0)) / size if same_holes else np.inf
    return found


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.quick(3)
def test_mirror_image_gives_the_same_results_from_flank_to_pressure(name: str, flank: FlankName) -> None:
    """With teeth as shells in the hobbed cases, as solid shells in the others."""
    pair = named(name, flank).misaligned(ERRORS)
    solid = name not in HOBBED_CASES
    one, two = analysed(pair, solid=solid), analysed(mirrored(pair), solid=solid)
    vectors = [("flanks", name, "xyz") for name in ("position", "normal", "principal_direction")]
    vectors += [("ease_off", name, "space") for name in ("action_position", "action_normal")]
    for group, vector, components in vectors:
        own, image = one[group][vector], two[group][vector]
        signs = xr.DataArray([1.0, -1.0, 1.0], dims=components, coords={components: own[components]})
        image = image * signs
        if vector == "principal_direction":  # a line, not an arrow
            image = image * np.sign((image * own).sum(components))
        two[group][vector] = image.transpose(*own.dims)
    assert np.all(one["loaded"]["status"].values == 0)
    found = differences(one, two)
    assert max(found.values()) < 1e-11


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("name", shipped_cases())
def test_other_hand_in_a_case_file_is_the_mirror_image(name: str, flank: FlankName) -> None:
    case = read_case(name)
    hand = "left" if case.pinion.hand_of_spiral == "right" else "right"
    other = case.model_copy(update={"pinion": case.pinion.model_copy(update={"hand_of_spiral": hand})})
    assert gear_pair(other, flank) == mirrored(gear_pair(case, flank))


def test_every_misalignment_is_felt() -> None:
    """With the other sign of any of them it is no mirror image."""
    pair = named("nasa-12x36", "drive")
    base = analysed(pair.misaligned(ERRORS), whole=False)
    for error in ("offset", "pinion_axial", "gear_axial", "shaft_angle"):
        wrong = replace(ERRORS, **{error: -getattr(ERRORS, error)})
        found = differences(base, analysed(mirrored(pair).misaligned(wrong), whole=False))
        assert found["ease_off/ease_off"] > 1e-3, error
        assert found["loaded/transmission_error"] > 1e-3, error
