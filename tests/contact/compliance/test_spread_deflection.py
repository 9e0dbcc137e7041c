"""Deflection that plane line contact leaves out: against finite elements of tapered teeth."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator
from scipy.sparse.linalg import splu
from scipy.special import k0, k1

from easeoff import read_case
from easeoff.cases import gear_pair
from easeoff.contact import STEEL, MeshCycle
from easeoff.contact.compliance.spread_deflection import EVEN_LOAD_DEFLECTION, SpreadDeflection, gaussians
from easeoff.geometry import pair_geometry

Array = NDArray[Any]
HALF_WIDTH, HEIGHT = 0.2, 9.0  # [mm], of the pressed strip and of the tooth


def quadratic(x: Array) -> tuple[Array, Array]:
    return np.stack([x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2], -1), np.stack([x - 0.5, -2 * x, x + 0.5], -1)


def graded(start: float, end: float, first: float) -> Array:
    steps = [first]
    while sum(steps) < abs(end - start):
        steps.append(1.35 * steps[-1])
    return start + (end - start) * np.cumsum(steps) / sum(steps)


def with_middles(points: Array) -> Array:
    result = np.empty(2 * points.size - 1)
    result[::2], result[1::2] = points, 0.5 * (points[1:] + points[:-1])
    return result


def stiffness(nodes: Array, wave_number: float) -> sparse.csc_array:
    """Of displacements u cos(k s), v cos(k s), w sin(k s), on a grid (m, n, 2) of nine-node elements."""
    m, n = nodes.shape[:2]
    index = np.arange(m * n).reshape(m, n)
    cells = np.stack([index[i : m - 2 + i : 2, j : n - 2 + j : 2].ravel() for i in range(3) for j in range(3)], 1)
    modulus, nu, k = STEEL.elastic_modulus, STEEL.poisson_ratio, wave_number
    shear = modulus / (2 * (1 + nu))
    law = np.diag([2 * shear] * 3 + [shear] * 3)
    law[:3, :3] += modulus * nu / ((1 + nu) * (1 - 2 * nu))
    x, w = np.polynomial.legendre.leggauss(3)
    value, slope = quadratic(x)
    corners, matrix = nodes.reshape(-1, 2)[cells], np.zeros((len(cells), 27, 27))
    for a in range(3):
        for b in range(3):
            shape = np.outer(value[a], value[b]).ravel()
            local = np.stack([np.outer(slope[a], value[b]).ravel(), np.outer(value[a], slope[b]).ravel()])
            jacobian = np.einsum("kn,enx->ekx", local, corners)
            g = np.linalg.solve(jacobian, np.broadcast_to(local, (len(cells), 2, 9)))
            strain = np.zeros((len(cells), 6, 27))
            strain[:, 0, 0::3], strain[:, 1, 1::3], strain[:, 2, 2::3] = g[:, 0], g[:, 1], k * shape
            strain[:, 3, 0::3], strain[:, 3, 1::3] = g[:, 1], g[:, 0]
            strain[:, 4, 2::3], strain[:, 4, 0::3] = g[:, 0], -k * shape
            strain[:, 5, 2::3], strain[:, 5, 1::3] = g[:, 1], -k * shape
            volume = np.abs(np.linalg.det(jacobian)) * w[a] * w[b]
            matrix += np.einsum("eij,ik,ekl,e->ejl", strain, law, strain, volume, optimize=True)
    freedoms = np.stack([3 * cells, 3 * cells + 1, 3 * cells + 2], -1).reshape(len(cells), 27)
    rows, columns = np.repeat(freedoms, 27, axis=1).ravel(), np.tile(freedoms, (1, 27)).ravel()
    return sparse.csc_array((matrix.ravel(), (rows, columns)), shape=(3 * m * n, 3 * m * n))


def missing(half_taper: float, land: float, below_tip: float, depths_per_radian: float) -> float:
    """Approach of flank and foot of the normal beyond Weber's formula, in units of q (1 - nu^2) / E."""
    taper = np.radians(half_taper)
    s = np.concatenate([np.linspace(-1, 1, 11) * HALF_WIDTH, [0.0]])[:-1] + below_tip
    first = HALF_WIDTH / 5
    s = with_middles(np.concatenate([graded(s[0], 0.0, first)[::-1], s, graded(s[-1], HEIGHT, first)]))
    depth = (0.5 * land + below_tip * np.sin(taper)) / np.cos(taper)
    through = with_middles(np.concatenate([[0.0], graded(0.0, 1.0, 0.5 * first / depth)]))
    flank = np.stack([0.5 * land + s * np.sin(taper), -s * np.cos(taper)], -1)
    nodes = flank[:, None] + through[None, :, None] * (flank * np.array([-2.0, 0.0]))[:, None]
    index, normal = np.arange(nodes[..., 0].size).reshape(nodes.shape[:2]), np.array([np.cos(taper), np.sin(taper)])
    # Hertz's pressure, by the quadratic shape functions of the flank.
    x, w = np.polynomial.legendre.leggauss(6)
    load = np.zeros(s.size)
    for i in range(0, s.size - 2, 2):
        middle, half = 0.5 * (s[i] + s[i + 2]), 0.5 * (s[i + 2] - s[i])
        pressure = np.sqrt(np.maximum(1 - ((middle + half * x - below_tip) / HALF_WIDTH) ** 2, 0.0))
        load[i : i + 3] += half * (pressure * w) @ quadratic(x)[0]
    force = np.zeros(3 * index.size)
    for axis in (0, 1):
        force[3 * index[:, 0] + axis] = -normal[axis] * load / load.sum()
    k = depths_per_radian / depth
    held = [3 * index[-1] + axis for axis in range(3)] + ([3 * index.ravel() + 2] if k == 0.0 else [])
    free = np.setdiff1d(np.arange(force.size), np.concatenate(held))
    moved = np.zeros(force.size)
    moved[free] = splu(stiffness(nodes, k)[free][:, free]).solve(force[free])
    field = -(moved.reshape(*nodes.shape[:2], 3)[..., :2] @ normal)
    # The foot is on the axis of the tooth, lower by the rise of the normal.
    lower = below_tip + depth * np.tan(taper)
    foot = RegularGridInterpolator((s, through), field)([[lower, 0.5]])[0]
    nu, reach = STEEL.poisson_ratio, np.hypot(depth, HALF_WIDTH)
    weber = 2 / np.pi * (np.arcsinh(depth / HALF_WIDTH) - nu / (1 - nu) * depth / (reach + depth))
    surface = field[np.argmin(np.abs(s - below_tip)), 0]
    return float((surface - foot) * STEEL.plane_strain_modulus - weber)


def spread_over(depth: float, depths_per_radian: float) -> float:
    """The same by the spread deflection, from unit loads on short pieces of a long line."""
    along = np.linspace(-30.0, 30.0, 1201) * depth
    nodes = np.linspace(-30.0, 30.0, 61) * depth
    loads = gaussians(nodes, along, np.full(along.size, depth), nodes[1] - nodes[0])
    wave = np.cos(depths_per_radian / depth * along)
    return float(loads[:, 600] @ (loads @ wave) * (along[1] - along[0]))


@pytest.mark.parametrize(("half_taper", "land", "below_tip"), [(18.0, 3.0, 2.0), (26.0, 1.5, 4.0)])
def test_finite_elements_of_tapered_teeth(half_taper: float, land: float, below_tip: float) -> None:
    """0.16 under an even load, a third of that at half a radian a depth, almost nothing at one: within 0.05.

    The local deflection itself is about 2 in these units.
    """
    for wave, error in ((0.0, 0.01), (0.25, 0.025), (0.5, 0.05), (1.0, 0.05)):
        assert abs(missing(half_taper, land, below_tip, wave) - spread_over(1.0, wave)) < error


def half_space(depths_per_radian: float) -> float:
    """What plane strain has too much of in a half space under a line load cos(k s): Boussinesq's field over the line.

    Its displacement at the depth h is q / (pi E*) [2 K0(k h) + k h K1(k h) / (1 - nu)].
    """
    x, nu = depths_per_radian, STEEL.poisson_ratio
    surface = -np.euler_gamma - np.log(0.5 * x)
    return float(2.0 / np.pi * (surface - k0(x) + (1.0 - x * k1(x)) / (2.0 * (1.0 - nu))))


@pytest.mark.parametrize("shape", [(18.0, 3.0, 4.0), (26.0, 1.5, 2.0)])
def test_a_load_that_varies_quickly_indents_less_than_plane_strain(shape: tuple[float, float, float]) -> None:
    """From one and a half radians a depth on a tooth is a half space; the analysis leaves this out."""
    assert half_space(1e-4) == pytest.approx(0.0, abs=1e-6)
    for wave in (2.0, 3.0, 4.0):
        assert missing(*shape, wave) == pytest.approx(half_space(wave), abs=0.02)


def test_next_to_the_tip_nothing_else_is_missing() -> None:
    """The corner beyond a load gives way with the foot: a third of a depth from it plane line contact is as good."""
    assert missing(30.0, 1.3, 0.3, 0.0) == pytest.approx(EVEN_LOAD_DEFLECTION, abs=0.01)


def test_an_even_load_on_a_long_line_is_spread_to_nothing() -> None:
    assert spread_over(2.0, 0.0) == pytest.approx(EVEN_LOAD_DEFLECTION, rel=1e-3)
    assert spread_over(2.0, 0.5) == pytest.approx(spread_over(1.0, 0.5), rel=1e-3)
    # Through a Gaussian twice: exp(-(k sigma)^2).
    assert spread_over(1.0, 0.5) / EVEN_LOAD_DEFLECTION == pytest.approx(np.exp(-((0.5 * 1.69) ** 2)), rel=1e-3)


def test_nodes_cover_the_flank_of_a_pair() -> None:
    """A force in any place spreads wholly: the squares of its Gaussians add up to those of an endless row of nodes."""
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    for member in ("pinion", "gear"):
        spread = SpreadDeflection.of(cycle.fields, member, STEEL)
        points = np.array([[0.0, 0.5, 1.0], [0.8, 0.5, 0.2]])[..., None]
        own = np.sum(spread.loads(cycle.fields, points, points, np.ones(1)) ** 2, axis=0)
        step = spread.nodes[1] - spread.nodes[0]
        depth = np.maximum(cycle.fields(f"depth_{member}", points[..., 0]), 0.7 / 1.69 * step)
        endless = EVEN_LOAD_DEFLECTION * spread.flexibility / (2.0 * np.sqrt(np.pi) * 1.69 * depth)
        np.testing.assert_allclose(own, endless, rtol=2e-3)
