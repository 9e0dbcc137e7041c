"""The problem library: what it declares, that it comes out the same again, and that its answers are proved."""

from __future__ import annotations

import hashlib
import math
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from places import ROOT
from proved_answers import condition_number, condition_of, proved_answer, refined_rotation
from runs import call, output_of
from threadpoolctl import threadpool_info, threadpool_limits

from easeoff import InputError
from easeoff.cases import read_case, shipped_cases
from easeoff.cases.schema.case_schema import ComplianceTable
from easeoff.contact import ContactProblem, read_problems, solve, write_problems
from easeoff.contact.problem.exchange.problem_file import read_labels
from easeoff.geometry import Misalignment
from easeoff.study import CaseInMesh
from easeoff.study.analysis.contact_analysis import contact_analysis
from easeoff.study.library import Entry, entries, generate, library_files as files, reference_answers
from easeoff.study.library.library_entries import (
    BASES,
    KINDS,
    LIBRARY_VERSION,
    MESH_POSITIONS,
    PARTS,
    TABLE,
    TORQUES,
    USUAL_PARTS,
)
from easeoff.study.library.library_files import CHANGES, copied_segments, dense, next_contact, write_library

EVERY = {entry.name: entry for entry in entries()}
BASE = "nasa-12x36"

#: Every change of one base, both forms, one problem of each other kind, two pairs and two sizes.
SAMPLE = [
    *(entry for entry in EVERY.values() if entry.kind == "degenerate" and entry.source == BASES[BASE]),
    *(
        EVERY[f"{BASE}-{end}"]
        for end in ("drive-heavy", "fine-21", "fine-131", "weak-31-1e-4", "weak-31-1e-8", "dense")
    ),
    *(EVERY[f"fh-design-a-{end}"] for end in ("coast-misaligned-2", "cycle-20")),
]


@pytest.fixture(scope="module")
def sample() -> dict[str, ContactProblem]:
    return {entry.name: problem for entry, problem in generate(SAMPLE)}


@pytest.fixture(scope="module")
def real() -> ContactProblem:
    return next(generate([Entry("real", "load", BASES[BASE])]))[1]


def test_description_holds_together() -> None:
    assert len(EVERY) == len(entries())  # names are unique
    assert len(EVERY) >= 500
    assert {entry.kind for entry in EVERY.values()} == set(KINDS)
    assert {entry.change for entry in EVERY.values()} == {"", *CHANGES}
    assert set(TORQUES) == set(shipped_cases())
    loads = {(e.source.case, e.source.flank) for e in EVERY.values() if e.kind == "load"}
    assert loads == {(case, flank) for case in shipped_cases() for flank in ("drive", "coast")}
    parts = [list(PARTS).index(entry.part) for entry in entries()]
    assert parts == sorted(parts)
    for case, (light, design, heavy) in TORQUES.items():
        own = read_case(case).contact.torques
        assert light < min(own)
        assert design in own
        assert heavy == 2.0 * max(own)


def test_sequences_are_neighbours_in_order() -> None:
    """Every sequence counts from 0, in one part, on one pair of flanks, and one quantity changes along it."""
    sequences: dict[str, list[Entry]] = {}
    for entry in entries():
        assert (entry.step >= 0) == bool(entry.sequence)
        if entry.sequence:
            sequences.setdefault(entry.sequence, []).append(entry)
    assert len(sequences) == 18
    for name, chosen in sequences.items():
        assert [entry.step for entry in chosen] == list(range(len(chosen))), name
        assert len(chosen) in (16, MESH_POSITIONS)
        assert len({(e.part, e.source.case, e.source.flank, e.source.segments_per_line) for e in chosen}) == 1
        changing = [
            [getattr(entry.source, key) for entry in chosen]
            for key in ("torque", "mesh_position", "offset_error", "pinion_axial_error")
        ]
        assert sum(len(set(values)) > 1 for values in changing) == (2 if "drift" in name else 1)
        assert all(values in (sorted(values), sorted(values, reverse=True)) for values in changing)


def test_what_takes_long_is_not_made_unless_asked_for() -> None:
    usual = [answer for answer in reference_answers().values() if EVERY[answer.name].part in USUAL_PARTS]
    assert max(answer.size for answer in usual) == 5001
    assert max(answer.size for answer in reference_answers().values()) == 100_005
    assert USUAL_PARTS == ("small", "medium", "large")


def test_every_problem_has_a_reference_answer() -> None:
    answers = reference_answers()
    assert list(answers) == list(EVERY)
    sizes = {answer.size for answer in answers.values()}
    assert min(sizes) == 1
    assert {63, 93, 153, 393, 999, 2001, 5001} <= sizes
    for answer in answers.values():
        # Two methods prove it that are not the native one: at least one of them, and none contradicts.
        found = [d for d in (answer.refined_difference, answer.lemke_difference) if math.isfinite(d)]
        assert found, answer
        assert max(found) < 1e-9, answer
        assert math.isfinite(answer.lemke_difference) == (answer.size <= 600), answer
        assert 0 <= answer.touching <= answer.size or answer.touching == -1


def test_answers_ship_with_the_package() -> None:
    data = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    assert data["package-data"]["easeoff.study.library"] == [TABLE]


def test_problem_is_that_of_the_analysis(real: ContactProblem) -> None:
    source = BASES[BASE]
    own = read_case(source.case)
    fewer = own.contact.model_copy(update={"mesh_positions": MESH_POSITIONS // 4})
    shells = own.model_copy(update={"compliance": ComplianceTable(model="shell"), "contact": fewer})
    state = CaseInMesh.of(shells, flank=source.flank, misalignment=Misalignment())
    analysis = contact_analysis(state, [source.torque], edge_contact=False)
    assert own.contact.mesh_positions == MESH_POSITIONS
    assert own.contact.segments_per_line == source.segments_per_line
    (case,) = [case for case in analysis.cases if 4 * case.mesh_position == source.mesh_position]
    assert real.is_structured
    np.testing.assert_allclose(real.separation, case.problem.separation, rtol=0, atol=1e-11)
    np.testing.assert_allclose(real.lever_arm, case.problem.lever_arm, rtol=1e-12)
    assert real.torque == pytest.approx(case.problem.torque, rel=1e-15)
    scale = case.problem.dense_compliance.max()
    np.testing.assert_allclose(real.dense_compliance, case.problem.dense_compliance, rtol=0, atol=1e-12 * scale)
    assert solve(real).rotation == pytest.approx(case.solution.rotation, rel=1e-10)


def test_problems_come_out_again_with_their_reference_answers(sample: dict[str, ContactProblem]) -> None:
    answers = reference_answers()
    for name, problem in sample.items():
        certificate, difference, fault = files.checked(problem, answers[name])
        assert not fault
        assert certificate < 1e-10
        assert difference < files.ROTATION_TOLERANCE


def test_answers_are_proved_by_methods_of_their_own(sample: dict[str, ContactProblem]) -> None:
    answers = reference_answers()
    for name, problem in sample.items():
        by_lemke = solve(problem, "lemke")
        assert by_lemke.certified
        assert by_lemke.elastic_rotation == pytest.approx(answers[name].elastic_rotation, rel=files.ROTATION_TOLERANCE)
        refined = refined_rotation(problem, by_lemke.active)
        if math.isfinite(answers[name].refined_difference):
            assert refined == pytest.approx(by_lemke.elastic_rotation, rel=1e-9)


def test_refinement_refuses_a_wrong_set(real: ContactProblem) -> None:
    active = solve(real).active
    assert math.isfinite(refined_rotation(real, active))
    for segment in (int(np.flatnonzero(active)[0]), int(np.flatnonzero(~active)[0])):
        wrong = active.copy()
        wrong[segment] = not wrong[segment]
        assert math.isnan(refined_rotation(real, wrong))


def test_refinement_knows_a_closed_form() -> None:
    """Uncoupled springs under one torque: theta = T / sum(r^2 / c)."""
    arm, local = np.array([40.0, 41.0, 43.0]), np.array([1e-6, 2e-6, 3e-6])
    problem = ContactProblem(1e-3 * arm, arm, 1e5, np.diag(local))
    exact = 1e5 / float((arm**2 / local).sum())
    assert refined_rotation(problem, np.ones(3, dtype=bool)) == pytest.approx(exact, rel=1e-13)
    assert proved_answer("springs", problem).touching == 3


def test_large_problems_are_proved_as_small_ones(real: ContactProblem, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the matrix of C: the same rotation and condition."""
    active = solve(real).active
    rotation, condition = refined_rotation(real, active), condition_of(real)
    monkeypatch.setattr(sys.modules[refined_rotation.__module__], "DENSE_SIZE_LIMIT", 0)
    assert refined_rotation(real, active) == pytest.approx(rotation, rel=1e-15)
    assert condition_of(real) == pytest.approx(condition, rel=1e-3)
    assert math.isnan(refined_rotation(real, ~active))


def test_condition_number_of_known_matrices() -> None:
    assert condition_number(np.diag([2.0, 8.0, 4.0])) == 4.0
    assert condition_number(np.ones((3, 3))) == math.inf


def conditions(problem: ContactProblem, force: NDArray[np.float64], rotation: float) -> float:
    """Largest violation of the conditions of contact, each over its own scale."""
    gap = problem.dense_compliance @ force + problem.separation - rotation * problem.lever_arm
    deflection = float((problem.dense_compliance @ force).mean())
    return max(
        abs(float(problem.lever_arm @ force) / problem.torque - 1.0),
        -float(force.min() / force.max()),
        -float(gap.min()) / deflection,
        float(np.minimum(force / force.max(), gap / deflection).max()),
    )


def made(name: str, real: ContactProblem, amount: float = 0.0) -> ContactProblem:
    return CHANGES[name](real, amount)


def test_changes_that_leave_the_answer_known(real: ContactProblem) -> None:
    """What a change does to the answer, where that can be told without a solver."""
    solution = solve(real)
    touching = np.flatnonzero(solution.active)

    shifted = made("shifted_rotation", real, 1e3)
    assert conditions(shifted, solution.force, solution.rotation + 1e3) < 1e-7  # 1e5 mm leave 1e-11 mm

    remote = made("remote_segment", real, 1e6)
    assert not solution.active[-1]
    assert conditions(remote, solution.force, solution.rotation) < 1e-12

    copied = made("copied_segments", real)
    assert np.linalg.matrix_rank(copied.dense_compliance) <= real.size
    for share in (0.5, 0.2):  # however twins share their load
        twice = np.stack([share * solution.force, (1.0 - share) * solution.force], axis=1).ravel()
        assert conditions(copied, twice, solution.rotation) < 1e-12

    doubled = made("copied_tooth_pairs", real).with_torque(2.0 * real.torque)
    assert conditions(doubled, np.tile(solution.force, 2), solution.rotation) < 1e-12

    one = made("single_segment", real)
    force = one.torque / one.lever_arm[0]
    rotation = (one.dense_compliance[0, 0] * force + one.separation[0]) / one.lever_arm[0]
    assert one.size == 1
    assert conditions(one, np.array([force]), float(rotation)) < 1e-12

    light = made("scaled_torque", real, 1e-9)
    first = int(np.argmin(real.separation / real.lever_arm))
    alone = np.zeros(real.size)
    alone[first] = light.torque / light.lever_arm[first]
    elastic = float(real.dense_compliance[first] @ alone) / real.lever_arm[first]
    np.testing.assert_allclose(solve(light).force, alone, rtol=1e-12, atol=0)
    assert solve(light).elastic_rotation == pytest.approx(elastic, rel=1e-12)

    flat = made("zero_separation", real)
    scaled = flat.with_torque(3.0 * flat.torque)  # then all is proportional to the torque
    np.testing.assert_allclose(solve(scaled).force, 3.0 * solve(flat).force, rtol=1e-9)

    pinions = made("several_pinions", real, 3.0)
    assert isinstance(pinions.compliance, tuple)
    assert pinions.torque == 3.0 * real.torque
    together = ContactProblem(np.tile(real.separation, 3), pinions.lever_arm, pinions.torque, pinions.compliance)
    assert conditions(together, np.tile(solution.force, 3), solution.rotation) < 1e-12
    lag = (pinions.separation - together.separation) / together.lever_arm
    np.testing.assert_allclose(lag, np.repeat([0.0, 2e-5, 4e-5], real.size), rtol=0, atol=1e-15)

    assert made("twin_segments", real).size == 2 * real.size
    assert np.unique(np.round(made("tied_separations", real, 0.002).separation / 0.002)).size < real.size
    assert touching.size < real.size


def test_local_compliance_is_taken_away(real: ContactProblem) -> None:
    assert isinstance(real.compliance, tuple)
    whole, factor = real.compliance
    for name, amount, left in (
        ("scaled_local_compliance", 1e-4, 1e-4 * whole),
        ("no_local_compliance", 0.0, 0.0 * whole),
        ("rigid_half", 0.0, whole * (np.arange(real.size) % 2 == 0)),
        ("rigid_segment", 0.0, np.where(np.arange(real.size) == np.argmax(solve(real).force), 0.0, whole)),
    ):
        problem = made(name, real, amount)
        assert isinstance(problem.compliance, tuple)
        np.testing.assert_array_equal(problem.compliance[0], left)
        np.testing.assert_array_equal(problem.compliance[1], factor)
    assert np.linalg.matrix_rank(made("no_local_compliance", real).dense_compliance, tol=1e-15) <= factor.shape[1]


def test_next_contact_is_at_the_brink(real: ContactProblem) -> None:
    """Just below that torque and just above it, the sets in contact differ by one segment; there, F = Y = 0 on it."""
    brink = next_contact(real, 0.0)
    assert brink.torque > real.torque
    below, above = (solve(real.with_torque((1.0 + change) * brink.torque)) for change in (-1e-6, 1e-6))
    (segment,) = np.flatnonzero(below.active != above.active)
    there = solve(brink)
    assert max(there.force[segment] / there.force.max(), there.gap[segment] / there.gap.max()) < 1e-12
    assert np.array_equal(solve(real).active, below.active)


def test_dense_form_is_the_same_problem(sample: dict[str, ContactProblem]) -> None:
    structured = sample[f"{BASE}-zero-separation"]
    assert dense(structured).identical(sample[f"{BASE}-zero-separation-dense"])
    assert not sample[f"{BASE}-zero-separation-dense"].is_structured
    assert copied_segments(structured, 0.0).size == 2 * structured.size


def few(monkeypatch: pytest.MonkeyPatch) -> list[Entry]:
    chosen = [entry for entry in SAMPLE if entry.name.startswith("fh-design-a") or "copied-segments" in entry.name]
    monkeypatch.setattr(files, "entries", lambda: tuple(chosen))
    return chosen


def test_file_says_what_every_problem_is(
    sample: dict[str, ContactProblem], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same machine makes the same once more, to the bit."""
    chosen = few(monkeypatch)
    (written,) = write_library(tmp_path / "new" / "library", ["small"])
    assert written.problems == len(chosen)
    assert not written.faults
    assert 0.0 < written.worst_certificate < 1e-10
    labels, answers = read_labels(written.path), reference_answers()
    assert labels["name"].tolist() == [entry.name for entry in chosen]
    assert labels["kind"].tolist() == [entry.kind for entry in chosen]
    for name in ("elastic_rotation", "touching", "condition_number"):
        assert labels[name].tolist() == [getattr(answers[entry.name], name) for entry in chosen]
    with xr.open_dataset(written.path, engine="netcdf4") as dataset:
        assert dataset.attrs["library_version"] == LIBRARY_VERSION
        assert dataset["pinion_torque"].attrs["units"] == "N m"
        assert all("long_name" in dataset[name].attrs for name in dataset.variables)
        assert f"version {LIBRARY_VERSION}" in dataset.attrs["citation"]
        lines = []
        for i in range(written.problems):  # the checksums, by hand
            one = dataset.isel(problem=i).load()
            n, k = int(one["size"]), int(one["mode_count"])
            S, r, T = one["separation"].values[:n], one["lever_arm"].values[:n], one["torque"].values
            dense = one["compliance"].values[:n, :n]
            C = (one["compliance_diagonal"].values[:n], one["compliance_factor"].values[:n, :k])
            parts = (T, S, r, *(C if one["structured"] else (dense,)))
            digest = hashlib.sha256(b"".join(np.ascontiguousarray(p + 0.0, "<f8").tobytes() for p in parts)).hexdigest()
            assert digest == str(one["checksum"].values)
            lines.append(f"{one['name'].values} {digest}\n")
            force, gap = one["reference_force"].values[:n], one["reference_gap"].values[:n]
            assert abs(r @ force / T - 1.0) < 1e-9
            assert np.minimum(force / force.max(), gap / max(gap.max(), 1e-3)).min() > -1e-9
            assert np.isnan(one["reference_force"].values[n:]).all()
        assert hashlib.sha256("".join(lines).encode()).hexdigest() == dataset.attrs["checksum"]
    for entry, read in zip(chosen, read_problems(written.path), strict=True):
        assert sample[entry.name].identical(read)


def test_what_is_not_as_it_should_be_is_named(sample: dict[str, ContactProblem]) -> None:
    answer = reference_answers()[f"{BASE}-drive-heavy"]
    problem = sample[answer.name]
    indefinite = ContactProblem(np.zeros(2), np.ones(2), 1.0, np.array([[1.0, 2.0], [2.0, 1.0]]))
    for given, expected, words in (
        (problem.with_torque(1.001 * problem.torque), answer, "rotation differs"),
        (problem, replace(answer, touching=answer.touching + 1), "segments touch instead"),
        (problem, replace(answer, size=1), "segments instead of 1"),
        (indefinite, answer, "NOT_POSITIVE_SEMIDEFINITE"),
    ):
        fault = files.checked(given, expected)[2]
        assert fault.startswith(answer.name)
        assert words in fault


def test_command_makes_the_library(
    sample: dict[str, ContactProblem], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = few(monkeypatch)
    monkeypatch.setattr(files, "generate", lambda entries: ((entry, sample[entry.name]) for entry in entries))
    command = ("library", "--parts", "small", "-o", tmp_path / "made")
    assert f"{len(chosen)} contact problems" in output_of(*command)
    assert len(read_problems(tmp_path / "made" / "small.nc")) == len(chosen)
    wrong = {name: replace(answer, elastic_rotation=1.0) for name, answer in reference_answers().items()}
    monkeypatch.setattr(files, "reference_answers", lambda: wrong)
    out = call(*command)
    assert out.exit_code == 1
    assert f"{chosen[0].name}: rotation differs" in out.output


def test_mistakes_are_told_before_any_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def never(_: object) -> Iterator[object]:
        raise AssertionError

    monkeypatch.setattr(files, "generate", never)
    with pytest.raises(InputError, match="parts = tiny: must be one or more of small, medium, large"):
        write_library(tmp_path, ["tiny"])
    with pytest.raises(InputError, match="parts = none"):
        write_library(tmp_path, [])
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is a file"):
        write_library(tmp_path / "file")


def test_labels_bring_their_attributes_and_files_theirs(tmp_path: Path, real: ContactProblem) -> None:
    path = tmp_path / "one.nc"
    label = xr.DataArray([1.5], dims="problem", attrs={"units": "N m", "long_name": "torque of the instant"})
    write_problems([real], path, {"pinion_torque": label}, {"title": "one", "library_version": 3})
    with xr.open_dataset(path, engine="netcdf4") as dataset:
        assert dataset["pinion_torque"].attrs == label.attrs
        assert (dataset.attrs["title"], dataset.attrs["library_version"]) == ("one", 3)
    with pytest.raises(InputError, match="format_version"):
        write_problems([real], path, attributes={"format_version": 7})


def test_library_is_made_with_one_blas_thread(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """How a product is shared out over threads decides its last bit, and with it the checksum."""
    found: list[int] = []

    def part(*_: object) -> None:
        found.extend(one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas")

    monkeypatch.setattr(files, "write_part", part)
    with threadpool_limits(2, user_api="blas"):
        write_library(tmp_path, ["small"])
    assert set(found) == {1}
