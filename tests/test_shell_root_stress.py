"""The cheap root stress: balance of the root springs, and the notch factor's published constants."""

from __future__ import annotations

import math

import numpy as np
import pytest

from easeoff import InputError
from easeoff.contact import ElasticFoundation, Material, Shell, ToothDimensions
from easeoff.contact.compliance.shell_kinematics import ROOT_DEFLECTION, ROOT_HEIGHT_SHIFT, ROOT_ROTATION
from easeoff.verification import shell_root_stress
from easeoff.verification.shell_root_stress import notch_factor, root_section_forces

STEEL = Material(206000.0, 0.3)
TOOTH = ToothDimensions(36.0, math.inf, 7.0, 9.5, 5.5, 7.5, 2.5, 2.5)


def test_root_springs_balance_the_load() -> None:
    """Whatever acts wherever on a straight tooth: its force, and its moment about the root line, come back."""
    shell = Shell(TOOTH, STEEL, foundation=ElasticFoundation())
    x, y = np.array([3.0, 6.0]), np.array([10.0, 30.0])
    loads = shell.load_vectors(x, y, np.array([[0.0, 0.0, 1.0], [-0.4, 0.0, 0.9]]))
    at, weights = np.polynomial.legendre.leggauss(24)
    forces = root_section_forces(shell, 18.0 * (1.0 + at), loads)
    total = 18.0 * np.einsum("s,asn->an", weights, forces)
    np.testing.assert_allclose(total[ROOT_DEFLECTION], [1.0, 0.9], rtol=1e-9)
    np.testing.assert_allclose(total[ROOT_HEIGHT_SHIFT], [0.0, -0.4], atol=1e-9)
    np.testing.assert_allclose(np.abs(total[ROOT_ROTATION]), [3.0, 6.0 * 0.9], rtol=1e-9)


def test_notch_factor_has_its_printed_exponents() -> None:
    """At 20 degrees the photoelastic tests gave 0.18, 0.15 and 0.45; at 14.5 degrees 0.22, 0.20 and 0.40."""
    for degrees, (base, by_radius, by_height) in ((20.0, (0.18, 0.15, 0.45)), (14.5, (0.22, 0.20, 0.40))):
        expected = base + 6.0**by_radius * 1.2**by_height
        found = notch_factor(np.array(6.0), 1.0, np.array(5.0), math.radians(degrees))
        assert found == pytest.approx(expected, abs=0.015)


def test_stress_of_a_uniform_line_load_is_that_of_a_beam() -> None:
    """Of a material that does not contract, so that its ends are like its middle."""
    plate = ToothDimensions(30.0, math.inf, 10.0, 10.0, 4.0, 4.0, 4.0, 4.0)
    shell = Shell(plate, Material(206000.0, 0.0), foundation=ElasticFoundation())
    at, weights = np.polynomial.legendre.leggauss(9)
    y = 15.0 * (1.0 + at)
    load = 600.0 * shell.load_vectors(np.full(9, 8.0), y, (0.0, 0.0, 1.0), 0.5 * weights)
    stress = shell_root_stress(shell, y, load[None], 1.0, math.radians(20.0))
    nominal = 6.0 * (600.0 / 30.0 * 8.0) / 4.0**2
    factor = notch_factor(np.array(4.0), 1.0, np.array(8.0), math.radians(20.0))
    np.testing.assert_allclose(stress[:, 0], nominal * factor, rtol=1e-6)


def test_no_springs_or_no_fillet_no_stress() -> None:
    clamped, sprung = Shell(TOOTH, STEEL), Shell(TOOTH, STEEL, foundation=ElasticFoundation())
    load = np.ones((1, clamped.size))
    with pytest.raises(InputError, match="clamped"):
        root_section_forces(clamped, np.array([1.0]), load)
    with pytest.raises(InputError, match="tool_edge_radius"):
        shell_root_stress(sprung, np.array([1.0]), np.ones((1, sprung.size)), 0.0, 0.3)
