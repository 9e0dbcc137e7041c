"""The support that explains measured deflections best."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from test_supported_contact import FIRST_ORDER, cycle, found

from easeoff.cases import gear_pair, read_case
from easeoff.contact import Supports, identified_support
from easeoff.contact.supports.relative_motion import RelativeMotion
from easeoff.core.errors import InputError

Array = NDArray[np.float64]
ASSEMBLY = gear_pair(read_case("fm-11x41")).assembly
TWISTS = RelativeMotion(ASSEMBLY, 1.0).twists[:, :4]
SCALE: Array = np.array([1.0, 1.0, 1.0, 100.0])


def compliance(seed: int = 4) -> Array:
    part = np.random.default_rng(seed).normal(size=(4, 6))
    return np.asarray(1e-5 * part @ part.T / 6.0 / np.outer(SCALE, SCALE))


def wrenches(count: int) -> Array:
    return np.asarray(np.random.default_rng(5).normal(size=(count, 6)) * np.repeat([1e4, 5e5], 3))


def test_compliance_is_found_again_where_the_forces_differ_enough() -> None:
    forces, known = wrenches(4), compliance()
    result = identified_support(ASSEMBLY, forces, forces @ TWISTS @ known)
    scaled = known * np.outer(SCALE, SCALE)
    np.testing.assert_allclose(result.compliance * np.outer(SCALE, SCALE), scaled, atol=1e-8 * scaled.max())
    assert (result.determined, result.independent_forces) == (10, 4)
    np.testing.assert_allclose(result.residual, 0.0, atol=1e-8)


@pytest.mark.parametrize(("count", "determined"), [(1, 4), (2, 7), (3, 9), (5, 10)])
def test_result_says_how_far_the_forces_determine_it(count: int, determined: int) -> None:
    """Torques in proportion add nothing: one direction fixes four of the ten numbers."""
    forces = np.concatenate([wrenches(count), 0.5 * wrenches(count)])
    moved = forces @ TWISTS @ compliance()
    result = identified_support(ASSEMBLY, forces, moved)
    assert result.determined == determined
    assert result.independent_forces == min(count, 4)
    np.testing.assert_allclose(result.residual * SCALE, 0.0, atol=1e-5 * np.abs(moved * SCALE).max())
    assert np.linalg.eigvalsh(result.compliance).min() >= -1e-20


def test_negative_stiffness_is_not_the_answer_but_the_nearest_there_is() -> None:
    """No compliance without negative eigenvalues in the neighbourhood explains more."""
    forces = wrenches(6)
    scaled = compliance() * np.outer(SCALE, SCALE)
    values, vectors = np.linalg.eigh(scaled)
    values[0] = -0.5 * values[-1]
    wrong = (vectors * values) @ vectors.T / np.outer(SCALE, SCALE)
    moved = forces @ TWISTS @ wrong
    result = identified_support(ASSEMBLY, forces, moved)
    own = result.compliance * np.outer(SCALE, SCALE)
    assert np.linalg.eigvalsh(own).min() >= -1e-9 * np.abs(own).max()

    def misfit(matrix: Array) -> float:
        return float(np.sum((SCALE * (forces @ TWISTS @ (matrix / np.outer(SCALE, SCALE)) - moved)) ** 2))

    least, random = misfit(own), np.random.default_rng(6)
    assert least > 0.0
    for _ in range(200):
        part = random.normal(size=(4, 4))
        other = own + 1e-3 * np.abs(own).max() * (part + part.T)
        spectrum, frame = np.linalg.eigh(other)
        assert misfit((frame * np.maximum(spectrum, 0.0)) @ frame.T) > least * (1.0 - 1e-9)


def test_supports_found_from_drive_and_coast_move_the_pair_as_measured() -> None:
    """A table computed with supports, at two torques and on both flanks; the answer put in their place."""
    tables = {flank: found("fm-11x41", flank) for flank in ("drive", "coast")}
    forces = np.concatenate([one.mesh_wrench.mean(axis=1) for one in tables.values()])
    names = ("offset", "pinion_axial", "gear_axial", "shaft_angle")
    given = np.array([getattr(cycle().geometry.pair.assembly.misalignment, name) for name in names])
    rows = [
        np.stack([one.misalignment[n].values.mean(axis=1) for n in names], axis=1) - given for one in tables.values()
    ]
    whole = np.concatenate(rows)
    size = np.abs(whole * SCALE).max()
    for rotations, share in ((False, 2e-2), (True, 2e-3)):
        result = identified_support(cycle().geometry.pair.assembly, forces, whole, rotations=rotations)
        assert result.independent_forces >= 2
        assert np.abs(result.residual * SCALE).max() < share * size
        again = cycle().supported([120.0, 400.0], result.supports, rounds=FIRST_ORDER)
        moved = np.stack([again.misalignment[name].values.mean(axis=1) for name in names], axis=1) - given
        np.testing.assert_allclose(moved * SCALE, rows[0] * SCALE, atol=share * size, rtol=0)
    assert isinstance(result.supports, Supports)


@pytest.mark.parametrize(
    ("forces", "moved", "message"),
    [
        (np.ones((2, 6)), np.ones((3, 4)), r"must have the shapes \(n, 4\), \(n, 6\)"),
        (np.zeros((1, 6)), np.ones((1, 4)), "must have a force"),
        (np.ones((1, 6)), np.full((1, 4), np.nan), "must be a finite number"),
    ],
)
def test_refuses_what_does_not_fit(forces: Array, moved: Array, message: str) -> None:
    with pytest.raises(InputError, match=message):
        identified_support(ASSEMBLY, forces, moved)
