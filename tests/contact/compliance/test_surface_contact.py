"""Contact of surfaces with pressures as unknowns: Hertz, finite bodies, CalculiX, and what it may not depend on."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from easeoff.contact import STEEL
from easeoff.geometry.tooth.tooth_lattice import with_middles
from easeoff.verification import FlankResponse
from easeoff.verification.flank_contact import half_space_compliance, solve_surface_contact, surface_contact_compliance
from easeoff.verification.flank_response import cubic_shares, surface_compliance
from easeoff.verification.surface_cells import SurfaceCells

BOTH = (STEEL, STEEL)
MODULUS = 0.5 * STEEL.plane_strain_modulus  # of the contact of two steel bodies
UNIT = 1.0 / (np.pi * STEEL.plane_strain_modulus)
Array = NDArray[np.float64]


def plane_cells(counts: tuple[int, int], sides: tuple[float, float], radii: tuple[float, float]) -> SurfaceCells:
    """Cells on the plane z = 0 (x along, y across), with the gap of two paraboloids."""
    axes = [side * (np.arange(n) - 0.5 * (n - 1)) for n, side in zip(counts, sides, strict=True)]
    x, y = (a.ravel() for a in np.meshgrid(*axes, indexing="ij"))
    i, j = (a.ravel() for a in np.indices(counts))
    every = np.ones((x.size, 1))
    return SurfaceCells(
        i,
        j,
        every * [1.0, 0.0, 0.0],
        every * [0.0, 1.0, 0.0],
        every * sides,
        np.stack([x, y, np.zeros_like(x)], axis=1),
        np.stack([x, y]),
        np.stack([x, y]),
        0.5 * x**2 / radii[0] + 0.5 * y**2 / radii[1],
        np.ones(x.size),
    )


def pressed(cells: SurfaceCells, compliance: Array, force: float) -> tuple[float, Array]:
    """Approach of the bodies and pressure on the cells."""
    (forces,), solved = solve_surface_contact([cells.separation], [cells.lever_arm], [compliance], force)
    assert solved.certified
    return solved.rotation, forces / cells.area


def test_spheres_against_hertz() -> None:
    radius, force = 20.0, 1000.0
    half_width = (0.75 * force * radius / MODULUS) ** (1.0 / 3.0)
    peak = 1.5 * force / (np.pi * half_width**2)
    cells = plane_cells((25, 25), (half_width / 9,) * 2, (radius, radius))
    approach, pressure = pressed(cells, half_space_compliance(cells, BOTH), force)
    assert approach == pytest.approx(half_width**2 / radius, rel=1e-3)
    assert pressure.max() == pytest.approx(peak, rel=4e-3)
    distance = np.hypot(*cells.position[:, :2].T)
    inner = distance < 0.9 * half_width
    expected = peak * np.sqrt(1.0 - (distance[inner] / half_width) ** 2)
    np.testing.assert_allclose(pressure[inner], expected, atol=0.015 * peak)


def hertz_ellipse(radii: tuple[float, float], force: float) -> tuple[float, float, float, float]:
    """Half axes [mm], greatest pressure [MPa], approach [mm] (Johnson, Contact Mechanics, section 4.2)."""
    longer, shorter = radii

    def integrals(k: float) -> tuple[float, float]:
        return float(ellipe(k) / (1.0 - k) - ellipk(k)), float(ellipk(k) - ellipe(k))

    k = float(brentq(lambda k: integrals(k)[0] / integrals(k)[1] - longer / shorter, 0.1, 1.0 - 1e-12))
    first, second = integrals(k)
    product = 4.0 / (np.pi * k) * (1.0 - k) ** 0.75 * np.sqrt(first * second)
    mean = (0.75 * force * np.sqrt(longer * shorter) / MODULUS * product) ** (1.0 / 3.0)
    a, b = mean / (1.0 - k) ** 0.25, mean * (1.0 - k) ** 0.25
    return a, b, 1.5 * force / (np.pi * a * b), 1.5 * force / (np.pi * a * b * MODULUS) * b * float(ellipk(k))


def test_long_ellipse_against_hertz() -> None:
    """As slender as the contact of teeth, on cells as slender."""
    radii, force = (600.0, 12.0), 2756.0
    a, b, peak, approach = hertz_ellipse(radii, force)
    assert a / b > 10.0
    cells = plane_cells((29, 21), (a / 12, b / 8), radii)
    found, pressure = pressed(cells, half_space_compliance(cells, BOTH), force)
    assert found == pytest.approx(approach, rel=1e-3)
    assert pressure.max() == pytest.approx(peak, rel=3e-3)


def block(
    size: tuple[float, float, float], bricks: tuple[int, int, int], radii: tuple[float, float]
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
    """Nodes, bricks and node numbers of a block below z = 0, crowned downwards, half sides and height given."""
    x = with_middles(np.linspace(-size[0], size[0], bricks[0] + 1))
    y = with_middles(np.linspace(-size[1], size[1], bricks[1] + 1))
    depth = with_middles(np.linspace(1.0, 0.0, bricks[2] + 1) ** 1.5)
    place = np.stack(np.meshgrid(x, y, depth, indexing="ij"))
    sunk = 0.5 * place[0] ** 2 / radii[0] + 0.5 * place[1] ** 2 / radii[1]
    place[2] = -(sunk + (size[2] - sunk) * place[2])
    number = np.arange(place[0].size).reshape(place.shape[1:])
    cells = np.lib.stride_tricks.sliding_window_view(number, (3, 3, 3))[::2, ::2, ::2].reshape(-1, 3, 3, 3)
    return np.moveaxis(place, 0, -1).reshape(-1, 3), cells, number


def block_response(
    size: tuple[float, float, float],
    bricks: tuple[int, int, int],
    reach: tuple[float, float],
    radii: tuple[float, float] = (np.inf, np.inf),
) -> FlankResponse:
    """Response of the middle of a block held at its bottom; its "fractions" are x and y in mm."""
    nodes, cells, number = block(size, bricks, radii)
    top = nodes[number[:, :, -1]]
    chosen = np.ix_(np.abs(top[:, 0, 0]) < reach[0], np.abs(top[0, :, 1]) < reach[1])
    place = top[chosen]
    normal = np.stack([place[..., 0] / radii[0], place[..., 1] / radii[1], np.ones(place.shape[:2])], axis=-1)
    normal = (normal / np.linalg.norm(normal, axis=-1, keepdims=True)).reshape(-1, 3)
    loaded = number[:, :, -1][chosen].ravel()
    whole = surface_compliance(nodes, cells, number[:, :, 0].ravel(), STEEL, loaded, normal)
    flat = place.reshape(-1, 3)
    distance = np.linalg.norm(flat[:, None] - flat, axis=2)
    np.fill_diagonal(distance, np.inf)
    beyond = whole - UNIT / distance
    # Betti's theorem: nothing in the method makes the compliance symmetric.
    assert np.abs(whole - whole.T).max() < 0.02 * np.abs(beyond).max()
    return FlankResponse(place[:, 0, 0], place[..., 1], 0.5 * (beyond + beyond.T))


def test_what_a_body_adds_hardly_needs_bricks() -> None:
    """The half space is taken out in closed form: four times as many bricks change the rest by a per cent."""
    size, points = (6.0, 6.0, 8.0), np.array([[0.0, 1.5, -2.5], [0.0, 2.0, 0.5]])
    found = []
    for bricks in ((3, 3, 3), (4, 4, 3), (6, 6, 5)):
        response = block_response(size, bricks, (4.5, 4.5))
        shares = response.shares(points)
        found.append((shares @ (shares @ response.beyond_half_space).T) / UNIT)
    scale = np.abs(found[-1]).max()
    assert np.abs(found[1] - found[-1]).max() < 0.015 * scale
    assert np.abs(found[1] - found[-1]).max() < np.abs(found[0] - found[-1]).max()


def test_a_deep_body_is_a_half_space() -> None:
    """The larger the block, the less it adds, in proportion to its inverse size: Boussinesq's field has no length."""
    added = []
    for scale in (1.0, 2.0, 4.0):
        response = block_response((6.0 * scale, 6.0 * scale, 8.0 * scale), (4, 4, 3), (4.0 * scale, 4.0 * scale))
        middle = response.shares(np.zeros((2, 1)))
        added.append(float((middle @ (middle @ response.beyond_half_space).T)[0, 0]))
    for larger, smaller in pairwise(added):
        assert smaller == pytest.approx(0.5 * larger, rel=1e-9)


def test_crowned_blocks_against_calculix() -> None:
    """12 um of approach between blocks of 12 x 16 x 8 mm, one crowned with radii of 12 and 600 mm, both held behind.

    CalculiX 2.20, surface to surface, 1e7 N/mm^3: see benchmarks/flank_contact.py.
    """
    size, radii, reach = (6.0, 8.0, 8.0), (12.0, 600.0), (3.0, 5.8)
    responses = (block_response(size, (6, 6, 4), reach, radii), block_response(size, (6, 6, 4), reach))
    cells = plane_cells((19, 21), (0.284 / 6, 3.43 / 8), radii)
    compliance = surface_contact_compliance(cells, responses, BOTH)
    forces = (2700.0, 2760.0)
    approaches = [pressed(cells, compliance, force)[0] for force in forces]
    assert np.interp(0.012, approaches, forces) == pytest.approx(CALCULIX_FORCE, rel=5e-3)


CALCULIX_FORCE = 2728.5  # [N]


def test_torque_and_complementarity_of_two_tooth_pairs() -> None:
    """Pressures push, gaps do not overlap, and the moments of both pairs add up."""
    cells = [plane_cells((9, 9), (0.1, 0.05), (200.0, 20.0)) for _ in range(2)]
    gaps = [cells[0].separation, cells[1].separation + 1e-3]
    arms = [np.full(81, 80.0), np.full(81, 70.0)]
    matrices = [half_space_compliance(one, BOTH) for one in cells]
    forces, solved = solve_surface_contact(gaps, arms, matrices, 3e4)
    assert solved.certified
    assert sum(a @ f for a, f in zip(arms, forces, strict=True)) == pytest.approx(3e4, rel=1e-12)
    for gap, arm, matrix, force in zip(gaps, arms, matrices, forces, strict=True):
        remaining = matrix @ force + gap - solved.rotation * arm
        assert force.min() >= 0.0
        assert remaining.min() > -1e-12
        assert np.abs(force * remaining).max() < 1e-9


def test_what_cannot_be_solved_is_no_number() -> None:
    nothing = np.zeros(2)
    (forces,), solved = solve_surface_contact([nothing], [np.ones(2)], [np.array([[1.0, 2.0], [2.0, 1.0]])], 1.0)
    assert not solved.certified
    assert np.isnan(solved.rotation)
    assert np.all(np.isnan(forces))


def test_cubics_between_uneven_places() -> None:
    places = np.array([[0.0, 0.1, 0.3, 0.7, 1.0]])
    wanted = np.array([0.05, 0.65, 0.9])
    index, shares = cubic_shares(np.repeat(places, 3, axis=0), wanted)
    cube = places[0] ** 3 - 2.0 * places[0]
    np.testing.assert_allclose(np.sum(shares * cube[index], axis=1), wanted**3 - 2.0 * wanted, atol=1e-14)
    _, beyond = cubic_shares(places, np.array([1.3]))
    np.testing.assert_allclose(beyond, [[0.0, 0.0, 0.0, 1.0]], atol=1e-14)
