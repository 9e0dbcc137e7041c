"""The rows of ``easeoff verify``: within their limits where nothing is wrong, outside where an error is planted."""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from tooth_models import FEW

import easeoff
from easeoff import GeometryError, InputError
from easeoff.cases import Case, gear_pair, read_case, shipped_cases
from easeoff.contact import STEEL, solve
from easeoff.contact.unloaded import unloaded_contact
from easeoff.core.foreign_code import foreign_code
from easeoff.geometry import (
    Blade,
    FlankName,
    GeneratingSurface,
    MachineSettings,
    Misalignment,
    Modification,
    pair_geometry,
    principal_curvatures,
)
from easeoff.geometry.cutting import generating_surface
from easeoff.geometry.cutting.blade import Relief
from easeoff.geometry.cutting.generating_surface import straight_edge
from easeoff.geometry.flanks.flank import Flank, NodeStatus
from easeoff.geometry.pair.gear_pair import grid
from easeoff.study import key_numbers
from easeoff.study.cli import main
from easeoff.verification import (
    FlankContact,
    Verification,
    VerificationRow,
    case_verification,
    conventional_analysis,
    envelope_condition,
    geometry_rows,
    loaded_rows,
    verify,
)
from easeoff.verification.case_verification import cells, closing, difference_text, head_lines, meaning, row_lines
from easeoff.verification.conventional_analysis import methods_compared, point_differences
from easeoff.verification.envelope_condition import cutter_position
from easeoff.verification.geometry_rows import conventional_rows, flank_rows, smallest_gap_rows
from easeoff.verification.loaded_rows import LIMITS, Refinement, UnsplitContact, changes, convergence_rows, refinements
from easeoff.verification.surface_cells import SegmentGaps, SurfaceCells, segment_gaps
from easeoff.verification.verified_pair import VerifiedPair, not_applicable

COARSE = {"mesh_positions": 4, "segments_per_line": 15, "lengthwise_nodes": 21, "profile_nodes": 15}
TORQUE = 250.0


def case(name: str = "fm-11x41", **contact: Any) -> Case:
    """A shipped case with shells and lines alone, coarser than as shipped."""
    read = read_case(name)
    tables = {"contact": {**COARSE, "edge_contact": False, **contact}, "compliance": {"model": "shell"}}
    return read.model_copy(update={key: getattr(read, key).model_copy(update=value) for key, value in tables.items()})


@pytest.fixture(scope="module")
def pair() -> VerifiedPair:
    return VerifiedPair.of(case(), torques=TORQUE)


def with_ease_off(crowning: float) -> VerifiedPair:
    """The pair whose ease-off is off by a lengthwise crowning [um] that its flanks do not have."""
    found = VerifiedPair.of(case(), torques=TORQUE)
    found.__dict__["state"] = found.state.modified(Modification({"lengthwise_crowning": crowning}))
    return found


def outside(rows: Iterator[VerificationRow] | list[VerificationRow]) -> list[str]:
    return [row.quantity for row in rows if row.status.name == "OUTSIDE"]


# --- flanks

MOTIONS = (
    ("sliding_base", (1.5, -0.8, 0.3)),
    ("work_offset", (-2.0, 1.1)),
    ("radial_distance", (0.9, 0.0, -1.4)),
    ("machine_center_to_crossing_point", (0.4,)),
    ("machine_root_angle", (0.02, -0.03)),
    ("cutter_tilt", (0.05, 0.02)),
    ("cutter_swivel", (-0.1, 0.04)),
)
SETTINGS = MachineSettings(75.0, 1.1, 0.3, 4.0, 0.7, -1.1, 0.15, -0.4, 3.2, (0.02, -0.03), 0.4, MOTIONS)
BLADES = {
    "straight": Blade(75.0, 0.3, "outside"),
    "inside": Blade(75.0, 0.3, "inside", offset_angle=0.3, rake_angle=0.1, hook_angle=-0.2),
    "hollow": Blade(75.0, 0.3, "outside", hook_angle=0.1, spheric_radius=800.0, reference_height=3.0),
    "toprem": Blade(75.0, 0.3, "outside", toprem=Relief(1.5, 0.03)),
}


@pytest.mark.parametrize("blade", BLADES)
@pytest.mark.parametrize(("hand", "sense"), [*itertools.product(("left", "right"), (-1, 1))])
def test_joints_of_the_machine_carry_the_blade_through_the_flank(blade: str, hand: Any, sense: Any) -> None:
    """Every setting, motion, hand and kind of blade: position, normal and condition of the envelope."""
    surface = GeneratingSurface(BLADES[blade], SETTINGS, hand, sense)
    lattice = np.stack(np.meshgrid(np.linspace(-3.0, 3.0, 9), np.linspace(-0.3, 0.3, 5))).reshape(2, -1)
    for part in surface.flank_parts:
        away = part.evaluate(lattice)[2]
        with np.errstate(invalid="ignore"):
            parameters = lattice[:, np.abs(away) < 40.0]  # where the blade touches, no further up than a shank
        assert parameters.shape[1] > 3
        position, normal, coordinate = part.evaluate(parameters)
        found = cutter_position(part, coordinate, *parameters)
        np.testing.assert_allclose(found, position, rtol=0, atol=1e-11)
        inside = np.full(coordinate.size, NodeStatus.INSIDE, dtype=np.int8)
        which = np.full(coordinate.size, surface.flank_parts.index(part), dtype=np.int8)
        condition = envelope_condition(Flank(surface, parameters, position, normal, coordinate, inside, which))
        assert condition.position.max() < 1e-11
        assert condition.normal.max() < 1e-10
        assert condition.along_blade.max() < 1e-8


@pytest.mark.parametrize("name", shipped_cases())
@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_flanks_of_shipped_cases(name: str, flank: FlankName) -> None:
    pair = gear_pair(read_case(name), flank)
    for member in ("pinion", "gear"):
        one = getattr(pair, member)
        rows = flank_rows(member, one.flank(*grid((9, 7))), one.section)
        assert outside(rows) == []
        assert (rows[2].status.name == "NOT_APPLICABLE") == (not one.loaded.settings.generated)


def nodes() -> Any:
    member = gear_pair(read_case("nasa-12x36")).pinion
    return member.flank(*grid((9, 7))), member.section


def test_a_flank_moved_by_a_hundredth_of_a_nanometre_is_seen() -> None:
    flank, section = nodes()
    moved = flank.position.copy()
    moved[1, 20] += 1e-8
    assert outside(flank_rows("pinion", replace(flank, position=moved), section)) == ["flank position, pinion"]


def test_a_turned_normal_is_seen() -> None:
    flank, section = nodes()
    turned = flank.normal.copy()
    turned[:, 5] += 1e-8 * np.array([0.6, -0.8, 0.1])
    assert outside(flank_rows("pinion", replace(flank, normal=turned), section)) == ["flank normal, pinion"]


def test_a_wrong_equation_of_meshing_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The blade then stands where it cuts, but not where it touches the flank."""
    right = straight_edge
    monkeypatch.setattr(generating_surface, "straight_edge", lambda *given: right(*given) + 1e-7)
    flank, section = nodes()
    assert outside(flank_rows("pinion", flank, section)) == ["envelope condition, pinion"]


def test_a_wrong_curvature_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    flank, section = nodes()

    def wrong(flank: Flank) -> Any:
        right = principal_curvatures(flank)
        return replace(right, curvature=right.curvature * (1.0 + 1e-7))

    monkeypatch.setattr(geometry_rows, "principal_curvatures", wrong)
    assert outside(flank_rows("pinion", flank, section)) == ["principal curvatures, pinion"]


def test_no_usable_node_is_no_agreement() -> None:
    flank, section = nodes()
    nothing = replace(flank, position=np.full_like(flank.position, np.nan))
    assert len(outside(flank_rows("pinion", nothing, section))) == 4


# --- unloaded contact


def test_unloaded_contact_of_the_pair(pair: VerifiedPair) -> None:
    rows = conventional_rows(pair)
    assert outside(rows) == []
    assert [row.quantity for row in rows if row.applicable] == [row.quantity for row in rows]


def test_a_shifted_ease_off_is_seen() -> None:
    """A twentieth of a micrometre of crowning that the flanks do not have."""
    assert "transmission error of a tooth pair" in outside(conventional_rows(with_ease_off(0.05)))


@pytest.mark.thorough
def test_smallest_gap_sees_a_shifted_ease_off(pair: VerifiedPair) -> None:
    assert outside(smallest_gap_rows(pair)) == []
    assert outside(smallest_gap_rows(with_ease_off(0.1))) == ["unloaded transmission error"]


def test_an_equation_without_a_solution_is_counted(pair: VerifiedPair, monkeypatch: pytest.MonkeyPatch) -> None:
    right = methods_compared

    def missing(*given: Any) -> Any:
        both = right(*given)
        lost = both.contact.converged.copy()
        lost[:3] = False
        return replace(both, contact=replace(both.contact, converged=lost))

    monkeypatch.setattr(conventional_analysis, "methods_compared", missing)
    rows = conventional_rows(pair)
    assert outside(rows) == ["conventional analysis"]
    assert rows[0].difference == 3


def test_contact_at_edges_alone_is_not_applicable(pair: VerifiedPair, monkeypatch: pytest.MonkeyPatch) -> None:
    right = methods_compared
    monkeypatch.setattr(
        conventional_analysis,
        "methods_compared",
        lambda *given: replace(b := right(*given), inside=np.zeros_like(b.inside)),
    )
    assert [row.status.name for row in conventional_rows(pair)] == ["WITHIN", *["NOT_APPLICABLE"] * 5]


def test_a_tooth_pair_that_touches_on_edges_alone_is_left_out() -> None:
    """Misaligned by 0.01 rad, a tooth pair has no contact line: conventional analysis knows nothing of it."""
    geometry = pair_geometry(gear_pair(read_case("fh-12x41-45"), "coast"), (15, 11))
    both = methods_compared(geometry.misaligned(Misalignment(shaft_angle=-0.01)), mesh_positions=4)
    pairs = unloaded_contact(both.geometry, both.splines, both.mesh)["pair"].values
    on_lines = both.unloaded()
    assert set(pairs) - set(both.mesh.pair) == set(pairs) - set(on_lines["pair"].values) == {-2}
    error, _ = point_differences(both)
    assert error.shape == both.inside.shape == (on_lines.sizes["pair"] * 4,)
    assert np.all(np.abs(error[both.inside]) < 1e-6)


# --- loaded contact


def test_gaps_and_certificates_of_the_pair(pair: VerifiedPair) -> None:
    assert outside([loaded_rows.gap_row(pair), loaded_rows.certificate_row(pair)]) == []
    assert outside([loaded_rows.gap_row(with_ease_off(5.0))]) == ["loaded transmission error by its gaps"]


def test_a_gap_error_moves_the_rotation_as_its_row_says(pair: VerifiedPair) -> None:
    """Solved anew with the false gaps: their effect to first order is the difference of the rotations."""
    false = with_ease_off(0.5)
    both = zip(false.analysis.cases, pair.analysis.cases, strict=True)
    apart = [one.solution.rotation - other.solution.rotation for one, other in both]
    said = [segment_gaps(false.flanks, false.state.cycle, one).rotation_error for one in false.analysis.cases]
    assert min(apart) > 1.5e-6
    np.testing.assert_allclose(said, apart, rtol=0.05)


def test_uncertified_solutions_are_counted(pair: VerifiedPair) -> None:
    found = VerifiedPair.of(case(), torques=TORQUE)
    groups = pair.analysis.groups
    status = groups["loaded"]["status"].copy()
    status[0, 1] = 8
    groups = {**groups, "loaded": groups["loaded"].assign(status=status)}
    found.__dict__["analysis"] = replace(pair.analysis, groups=groups)
    assert loaded_rows.certificate_row(found).difference == 1.0


def test_a_lying_solver_is_seen(pair: VerifiedPair, monkeypatch: pytest.MonkeyPatch) -> None:
    """It calls itself certified, with a rotation wrong in the eighth digit."""
    right = solve

    def lie(problem: Any, solver: str, **given: Any) -> Any:
        found = right(problem, solver, **given)
        answer = found.answer
        wrong = replace(answer, rotation=answer.rotation * (1.0 + 2e-8))
        return replace(found, answer=wrong) if given["polish"] else found

    assert outside(loaded_rows.solver_rows(pair, ["lemke"])) == []
    monkeypatch.setattr(loaded_rows, "solve", lie)
    assert outside(loaded_rows.solver_rows(pair, ["lemke"])) == ["solver lemke"]


def test_a_solver_without_an_answer_is_seen(pair: VerifiedPair, monkeypatch: pytest.MonkeyPatch) -> None:
    right = solve
    monkeypatch.setattr(
        loaded_rows, "solve", lambda problem, solver, **given: right(problem, "osqp", polish=False, max_iter=1)
    )
    rows = loaded_rows.solver_rows(pair, ["osqp"])
    assert outside(rows) == ["solver osqp"]
    assert rows[1].status.name == "NOT_APPLICABLE"  # a refused answer reaches nobody
    assert "0 of 4 contact problems certified" in rows[0].compared


# --- convergence


def number(values: list[float], unit: str) -> Any:
    return "torque", np.array(values), {"units": unit}


NUMBERS = xr.Dataset(
    {
        "mean_level": number([200.0, 400.0], "urad"),
        "peak_to_peak": number([10.0, 20.0], "urad"),
        "pinion_peak_to_peak": number([40.0, 80.0], "urad"),
        "max_load_share": number([0.8, 0.7], "1"),
        "contact_ratio": number([1.6, 2.0], "1"),
        "max_pressure": number([700.0, 1200.0], "MPa"),
        "max_pressure_line_end": ("torque", np.array([0, 8])),
        "mean_mesh_stiffness": number([2.0, math.nan], "N m urad-1"),
        "unloaded_peak_to_peak": ((), 20.0, {"units": "urad"}),
    },
    coords={"torque": [50.0, 250.0]},
)


def test_changes_of_key_numbers_by_group() -> None:
    """Each over what it should be: errors over the mean level, fractions in points, the rest over itself."""
    fine = NUMBERS.copy(deep=True)
    fine["peak_to_peak"].values[1] += 2.0
    fine["pinion_peak_to_peak"].values[1] += 70.0
    fine["max_load_share"].values[0] -= 0.01
    fine["contact_ratio"].values[1] += 0.01
    fine["max_pressure"].values[:] *= [1.02, 1.05]
    fine["unloaded_peak_to_peak"] = fine["unloaded_peak_to_peak"] + 0.2
    found = {group: (round(value, 9), label) for group, value, label in changes(NUMBERS, fine)}
    assert found["transmission error"] == (0.5, "peak_to_peak at 250 N m 20 and 22 urad, over the mean level 400")
    assert found["unloaded transmission error"][0] == 1.0
    assert found["shares, ratios and places"] == (1.0, "max_load_share at 50 N m 0.8 and 0.79, in points of 1")
    assert found["greatest pressure"][0] == 2.0
    assert found["greatest pressure, at a line's end"][0] == 5.0
    assert found["other numbers"][0] == 0.0


def test_a_pressure_that_a_finer_computation_finds_at_a_line_end_is_one_there() -> None:
    fine = NUMBERS.copy(deep=True)
    fine["max_pressure_line_end"].values[0] = 4
    assert "greatest pressure" not in {group for group, _, _ in changes(NUMBERS, fine)}


def test_a_number_that_is_missing_or_lost_is_no_convergence() -> None:
    lost = NUMBERS.copy(deep=True)
    lost["peak_to_peak"].values[0] = np.nan
    assert math.isnan({group: value for group, value, _ in changes(NUMBERS, lost)}["transmission error"])
    missing = NUMBERS.drop_vars("max_load_share")
    assert math.isnan({group: value for group, value, _ in changes(NUMBERS, missing)}["shares, ratios and places"])


def test_every_group_of_the_key_numbers_has_a_limit(pair: VerifiedPair) -> None:
    numbers = key_numbers(pair.analysis.tree)
    groups = {group for group, _, _ in changes(numbers, numbers)}
    assert groups <= LIMITS["grid of the flank"].keys()
    assert {"transmission error", "shares, ratios and places", "other numbers"} < groups


def test_a_coarse_grid_is_seen() -> None:
    coarse = VerifiedPair.of(case("nasa-12x36", lengthwise_nodes=7, profile_nodes=7), torques=TORQUE)
    assert "grid of the flank: transmission error" in outside(convergence_rows(coarse, refinements(coarse.case)[0]))


def test_few_segments_are_seen() -> None:
    few = VerifiedPair.of(case(segments_per_line=5), torques=TORQUE)
    assert "segments of a line: other numbers" in outside(convergence_rows(few, refinements(few.case)[1]))


def test_refinements_follow_the_model_of_the_teeth() -> None:
    shell, fe = case(), case()
    fe = fe.model_copy(update={"compliance": fe.compliance.model_copy(update={"model": "fe"})})
    assert [one.name for one in refinements(shell)][3:] == ["shell modes along the face", "shell modes up the profile"]
    assert [one.name for one in refinements(fe)][3:] == ["fineness of the teeth"]
    assert {one.name for one in (*refinements(shell), *refinements(fe))} == set(LIMITS)


# --- contact without the split


def solved(rotation: float, shares: list[float]) -> tuple[Any, list[FlankContact]]:
    """An analysis of one position, and a contact without the split with 200 urad, 70 and 30 %."""
    loaded = xr.Dataset(
        {
            "transmission_error": ("mesh_position", [rotation]),
            "load_share": (("mesh_position", "pair"), [shares]),
        },
        coords={"pair": [0, 1]},
    )

    class Contact(FlankContact):
        load_share = np.array([0.7, 0.3])

    return loaded, [Contact(2e-4, [0, 1], [], [])]


def test_differences_from_the_contact_without_the_split() -> None:
    loaded, contacts = solved(206.0, [0.72, 0.28])
    assert loaded_rows.rotation_differences(loaded, contacts) == [pytest.approx(0.03)]
    assert max(loaded_rows.share_differences(loaded, contacts)) == pytest.approx(0.02)
    other = replace(contacts[0], pairs=[0, 2])
    assert max(np.abs(loaded_rows.share_differences(loaded, [other]))) == pytest.approx(0.3)


def test_line_load_is_compared_over_the_same_stretch(pair: VerifiedPair) -> None:
    """Segments of 105 N/mm against cells of 100 N/mm on one line, however either is divided."""
    points = np.stack([np.linspace(0.4, 0.6, 41), np.full(41, 0.5)])
    position = pair.flanks.splines("position", points)
    along = np.diff(position, axis=1)
    length = np.linalg.norm(along, axis=0)
    direction = (along / length).mean(axis=1)
    direction /= np.linalg.norm(direction)
    length = along.T @ direction
    middle = 0.5 * (points[:, 1:] + points[:, :-1])
    place = pair.flanks.splines("position", middle)
    loaded = xr.Dataset(
        {
            "force": (("mesh_position", "segment"), [105.0 * length]),
            "length": (("mesh_position", "segment"), [length]),
            "half_width": (("mesh_position", "segment"), [np.full(40, 0.3)]),
            "tooth": (("mesh_position", "segment"), [np.zeros(40)]),
            "lengthwise": (("mesh_position", "segment"), [middle[0]]),
            "profile": (("mesh_position", "segment"), [middle[1]]),
        }
    )
    two = np.repeat(np.arange(40), 2)  # two cells side by side across the line
    none = np.zeros((2, 80))
    cells = SurfaceCells(
        two,
        two,
        np.tile(direction, (80, 1)),
        np.tile(direction, (80, 1)),
        np.stack([length[two], np.full(80, 0.1)], axis=1),
        place[:, two].T,
        none,
        none,
        none[0],
        np.ones(80),
    )
    contact = FlankContact(2e-4, [0], [cells], [50.0 * length[two]])
    found = loaded_rows.line_load_difference(loaded, [contact], pair.flanks.splines)
    assert found == pytest.approx(0.05, abs=2e-3)


@pytest.mark.thorough
def test_rows_of_the_contact_without_the_split(pair: VerifiedPair, monkeypatch: pytest.MonkeyPatch) -> None:
    """On few bricks: near enough to see that half the stiffness is wrong, and a shell with edges right."""
    monkeypatch.setattr(loaded_rows, "response_size", lambda *_, **__: FEW)
    monkeypatch.setattr(loaded_rows, "UNSPLIT_POSITIONS", 2)
    with_edges = VerifiedPair.of(case(edge_contact=True), torques=TORQUE)
    soft = case(edge_contact=True)
    half = soft.pinion.material.model_copy(update={"elastic_modulus": 103000.0})
    soft = soft.model_copy(update={"pinion": soft.pinion.model_copy(update={"material": half})})
    found = []
    for one in (with_edges, VerifiedPair.of(soft, torques=TORQUE)):
        contact = UnsplitContact(one, cells_per_half_width=4.0)
        contact.__dict__["responses"] = UnsplitContact(with_edges).responses
        assert contact.responses[0].beyond_half_space.shape[0] > 0
        monkeypatch.setattr(loaded_rows, "materials", lambda _: (STEEL, STEEL))
        rows = list(loaded_rows.unsplit_rows(contact, {place: contact.solved(*place) for place in contact.places}))
        found.append([row.difference for row in rows])
    assert found[0][0] < 4.0
    assert found[1][0] > 10.0


# --- the whole


@pytest.fixture(scope="module")
def found() -> Verification:
    return verify(case(), torques=TORQUE, progress=None)


@pytest.mark.thorough
def test_whole_table_of_a_coarse_case(found: Verification, tmp_path: Path) -> None:
    names = [row.quantity for row in found.rows]
    assert names[0] == "certificates"
    assert len(set(names)) == len(names)
    assert not [row for row in found.rows if row.status.name == "OUTSIDE" and math.isnan(row.difference)]
    assert found.rows[-1].status.name == "NOT_APPLICABLE"
    table = found.table()
    assert all(
        word in table for word in ("within", "envelope condition, pinion", "not applicable: cut without rolling")
    )
    path = tmp_path / "verification.nc"
    found.dataset().to_netcdf(path, engine="netcdf4")
    with xr.open_dataset(path, engine="netcdf4") as read:
        assert read["quantity"].values.tolist() == names
        np.testing.assert_array_equal(read["comparison_status"], [row.status for row in found.rows])
        np.testing.assert_array_equal(read["difference"], [row.difference for row in found.rows])
        assert read["comparison_status"].attrs["flag_meanings"] == "within outside not_applicable"


def only(monkeypatch: pytest.MonkeyPatch, *steps: Any) -> None:
    """Let a verification have these steps alone."""
    monkeypatch.setattr(case_verification, "_steps", lambda _: iter(steps))


def test_a_yardstick_that_gives_up_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    def gives_up() -> list[VerificationRow]:
        raise GeometryError("the flanks do not meet")

    only(monkeypatch, ("smallest gap", gives_up), ("path", lambda: [VerificationRow("path", "", 0.0, 1.0, "mm")]))
    seen: list[tuple[int, int, str]] = []
    told: list[VerificationRow] = []
    found = verify(case(), progress=lambda *given: seen.append(given), on_row=told.append)
    assert tuple(told) == found.rows
    assert [row.quantity for row in found.outside] == ["smallest gap"]
    assert "the flanks do not meet" in found.outside[0].compared
    assert seen == [(0, 2, "smallest gap"), (1, 2, "path"), (2, 2, "")]


def test_a_case_that_cannot_be_analysed_is_a_mistake_not_a_row() -> None:
    with pytest.raises(InputError, match="solid"):
        verify("no-such-solid-case")
    one_side = case().model_copy(deep=True)
    one_side = one_side.model_copy(update={"pinion": one_side.pinion.model_copy(update={"convex": None})})
    with pytest.raises(InputError, match=r"pinion\.convex"):
        verify(one_side, flank="coast")


def test_not_a_number_is_outside_and_not_applicable_is_neither() -> None:
    rows = (VerificationRow("a", "b", math.nan, 1.0, "mm"), not_applicable("c", "no flank"))
    found = Verification("title", "drive", rows)
    assert [row.quantity for row in found.outside] == ["a"]
    assert not found.passed
    assert Verification("title", "drive", rows[1:]).passed


def test_command_prints_the_table_and_says_whether_it_is_within(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for difference, code, words in (
        (0.5, 0, "every comparison that applies is within"),
        (2.0, 1, "1 of 2 comparisons outside their limits: path of contact"),
    ):
        row = VerificationRow("path of contact", "five equations", difference, 1.0, "um")
        only(monkeypatch, ("path", lambda row=row: [row]))
        file = tmp_path / f"{code}.nc"
        done = CliRunner().invoke(main, ["verify", "fm-11x41", "--flank", "coast", "-o", str(file)])
        assert done.exit_code == code, done.output
        assert "path of contact" in done.output
        assert ("-> the path of contact may be off by 2 um" in done.output) == (code == 1)
        assert words in done.output
        with xr.open_dataset(file, engine="netcdf4") as read:
            assert read.attrs["flank"] == "coast"
            assert read["difference"].values[0] == difference


def test_rows_are_printed_as_they_come(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was printed before an interruption stays."""

    def interrupted() -> list[VerificationRow]:
        raise KeyboardInterrupt

    row = VerificationRow("path of contact", "five equations", 0.5, 1.0, "um")
    only(monkeypatch, ("path", lambda: [row]), ("gap", interrupted))
    done = CliRunner().invoke(main, ["verify", "fm-11x41"])
    assert done.exit_code != 0
    assert "path of contact" in done.stdout
    assert "comparisons" not in done.output


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        ("relative curvature across the line", "half of it, 2.4 %; transmission error and load shares are not"),
        ("segments of a line: greatest pressure", "off by 4.7 %; set more segments_per_line"),
        ("transmission error of a tooth pair", "unloaded transmission error may be off by 4.7 %"),
        ("transmission error", "the elastic model"),
        ("solver osqp", "the other solver"),
    ],
)
def test_a_row_outside_says_what_it_means(quantity: str, words: str) -> None:
    outside = VerificationRow(quantity, "another method", 4.7, 4.0, "%")
    assert words in meaning(outside)
    assert words.split()[0] in row_lines(outside)
    assert meaning(VerificationRow(quantity, "another method", 3.9, 4.0, "%")) == ""
    assert "not checked" in meaning(VerificationRow(quantity, "another method", math.nan, 4.0, "%"))


def test_a_library_that_prints_does_not_reach_the_standard_output(capfd: pytest.CaptureFixture[str]) -> None:
    with foreign_code(silent=True):
        os.write(1, b"Running HiGHS")
    os.write(1, b"a row")
    assert capfd.readouterr() == ("a row", "")


@pytest.mark.parametrize(
    "arguments",
    [
        ["no-such-case"],
        ["fm-11x41", "--torque", "-3"],
        ["fm-11x41", "-o", "table.txt"],
        ["fm-11x41", "--misalignment", "E=99"],
    ],
)
def test_command_refuses_mistakes(arguments: list[str]) -> None:
    done = CliRunner().invoke(main, ["verify", *arguments])
    assert done.exit_code == 2
    assert "Traceback" not in done.output


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "flank"), [*itertools.product(shipped_cases(), ("drive", "coast"))])
def test_shipped_cases_are_within_every_limit(name: str, flank: FlankName) -> None:
    found = verify(easeoff.read_case(name), flank=flank)
    assert [(row.quantity, row.compared, row.difference) for row in found.outside] == []


def test_differences_are_told_apart_from_their_limits() -> None:
    assert [difference_text(value, 0.1) for value in (0.1034, 0.0834)] == ["0.103", "0.083"]
    assert cells(VerificationRow("path", "another method", 1.0, 2.0, "um"))[2:] == ("1", "2", "um", "yes")
    assert head_lines().splitlines()[0].split()[-3:] == ["limit", "unit", "within"]


def test_rows_of_curvatures_alone_are_explained_together() -> None:
    row = VerificationRow("relative curvature across the line", "both members' curvatures", 4.7, 4.0, "%")
    assert closing([row]).startswith("these are curvature and direction of con")


def test_gap_errors_count_by_the_share_of_each_segment() -> None:
    gaps = SegmentGaps(np.array([2e-6, 5e-6]), np.array([1e-6, 5e-6]), np.array([0.25, 0.75]))
    assert gaps.rotation_error == pytest.approx(2.5e-7)


def test_a_refinement_tells_the_values_compared() -> None:
    finer = Refinement("mesh positions", "contact", {"mesh_positions": 64})
    assert finer.described(read_case("nasa-12x36")) == "32 against 64"
