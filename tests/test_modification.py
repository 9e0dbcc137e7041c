"""Low-order modifications: names, signs, what they do to the ease-off and the analysis, machine settings for them."""

from __future__ import annotations

import numpy as np
import pytest
from runs import small

import easeoff
from easeoff import InputError
from easeoff.cases import gear_pair, read_case
from easeoff.geometry import EaseOffTarget, Modification, ease_off, modified_ease_off
from easeoff.geometry.pair.modification import TERM_ORDERS, basis, terms
from easeoff.study import fit_modification

T, H = np.meshgrid(np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 7), indexing="ij")
SOME = Modification({"lengthwise_crowning": 8.0, "bias": -5.0, "profile_3": 3.0, "spiral_angle_error": 2.0})


def test_second_order_terms_are_those_of_a_target() -> None:
    for name in terms(2):
        ours = Modification({name: 7.0})(T, H)
        np.testing.assert_allclose(ours, 1e3 * EaseOffTarget(**{name: 7e-3})(T, H), rtol=0, atol=1e-12)


@pytest.mark.parametrize("order", TERM_ORDERS)
def test_terms_span_all_surfaces_of_their_order_but_the_constant(order: int) -> None:
    columns = basis(terms(order), T.ravel(), H.ravel())
    assert columns.shape[1] == (order + 1) * (order + 2) // 2 - 1
    whole = np.column_stack([np.ones(T.size), columns])
    assert np.linalg.matrix_rank(whole) == whole.shape[1]
    rng = np.random.default_rng(order)
    powers = [(a, b) for a in range(order + 1) for b in range(order + 1 - a)]
    wanted = sum(rng.standard_normal() * T**a * H**b for a, b in powers)
    left = np.linalg.lstsq(whole, np.ravel(wanted), rcond=None)[1]
    assert left.size == 0 or left.max() < 1e-20


def test_modification_adds_to_the_normal_ease_off_up_to_a_rotation() -> None:
    before = ease_off(gear_pair(read_case("fm-11x41")), (9, 7))
    after = modified_ease_off(before, SOME)
    turned = after.attrs["first_contact_rad"] - before.attrs["first_contact_rad"]
    added = after["ease_off"] - before["ease_off"] + 1e3 * turned * before["lever_arm"]
    np.testing.assert_allclose(added.values, SOME(T, H), rtol=0, atol=1e-9)
    np.testing.assert_allclose(after["ease_off"], 1e3 * after["ease_off_angle"] * after["lever_arm"], rtol=1e-12)
    assert after["ease_off"].attrs == before["ease_off"].attrs
    # Zero at first contact, which lies between the nodes.
    assert 0.0 <= after["ease_off"].values[after["inside"].values == 1].min() < 1.0
    back = modified_ease_off(after, Modification({k: -v for k, v in SOME.coefficients.items()}))
    np.testing.assert_allclose(back["ease_off_angle"], before["ease_off_angle"], rtol=0, atol=1e-15)
    assert back.attrs["first_contact_rad"] == pytest.approx(before.attrs["first_contact_rad"], rel=1e-12)


def test_settings_for_a_modification_give_what_they_say() -> None:
    """The ease-off of the fitted case, made afresh, is the old one with the modification, within what is left."""
    case = read_case("fm-11x41")
    wanted = Modification({"lengthwise_crowning": 4.0, "profile_crowning": 3.0, "bias": 2.0})
    fitted, found = fit_modification(case, wanted)
    assert fitted.target.drive is None
    assert fitted.pinion.convex == case.pinion.convex
    goal = modified_ease_off(ease_off(gear_pair(case), (9, 7)), wanted)
    fresh = ease_off(gear_pair(fitted), (9, 7))
    lever = goal["lever_arm"].values
    error = fresh["ease_off"].values - goal["ease_off"].values
    error -= lever * np.sum(lever * error) / np.sum(lever**2)
    np.testing.assert_allclose(error.ravel(), 1e3 * found.residual, rtol=0, atol=1e-4)
    assert np.abs(error).max() < 0.2 * np.ptp(wanted(T, H))


def test_no_modification_changes_nothing() -> None:
    case, nothing = small("nasa-12x36", "shell"), Modification({"bias": 0.0})
    plain, same = (easeoff.analyze(case, torques=[100.0], modification=one) for one in (None, nothing))
    np.testing.assert_allclose(same["loaded"]["force"], plain["loaded"]["force"], rtol=1e-9, atol=1e-6)
    assert same.attrs["modification_um"] == '{"bias": 0.0}'


def test_mistakes_are_named() -> None:
    with pytest.raises(InputError, match="modification term = 'crowning': must be one of spiral_angle_error"):
        Modification({"crowning": 1.0})
    with pytest.raises(InputError, match="bias = nan"):
        Modification({"bias": np.nan})
    with pytest.raises(InputError, match="order = 5: must be one of 2, 3, 4"):
        terms(5)
