"""Contact of two teeth without a split into bending and indentation, by pressures on cells of the flank.

Find pressures p >= 0 and the rotation of the gear such that every gap

    Y = (indentation by p, closed form) + (what both bodies add, finite elements) + S - r theta >= 0,   p Y = 0

and the moments of the pressures balance the torque. No line of contact, no relative radius, no foot of a normal and no
depth to a middle surface enters. Each tooth has a body of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from ...contact.compliance.half_space_cells import even_pressure_integral
from ...contact.compliance.material import Material
from ...contact.problem.contact_problem import ContactProblem
from ...contact.solvers import solve
from .flank_response import FlankResponse
from .surface_cells import SurfaceCells

Array = NDArray[Any]


@dataclass(frozen=True)
class SurfaceContact:
    """Solved pressures of one mesh position.

    Parameters
    ----------
    force
        Normal force on every cell, by tooth pair [N].
    rotation
        Of the gear [rad].
    settled
        Whether the answer is certified; if not, force and rotation are NaN.
    """

    force: list[Array]
    rotation: float
    settled: bool


def half_space_compliance(cells: SurfaceCells, materials: tuple[Material, Material]) -> Array:
    """Deflection (n, n) of both half spaces in the middle of a cell under an even pressure on another [mm/N].

    Examples
    --------
    >>> from easeoff.contact import STEEL
    >>> at, zero, one = np.zeros(1, dtype=int), np.zeros((2, 1)), np.ones(1)
    >>> along, across, middle = np.eye(3)[:, None]
    >>> cell = SurfaceCells(at, at, along, across, np.array([[0.2, 0.1]]), middle, zero, zero, one, one)
    >>> half_space_compliance(cell, (STEEL, STEEL)).shape
    (1, 1)
    """
    offset = cells.position[:, None] - cells.position[None]
    along, across = (np.einsum("ijx,jx->ij", offset, side) for side in (cells.along, cells.across))
    # On a curved flank the distance counts, not its projection.
    flat = np.hypot(along, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        stretch = np.where(flat > 0.0, np.linalg.norm(offset, axis=2) / flat, 1.0)
    half = 0.5 * cells.sides
    integral = even_pressure_integral(along * stretch, across * stretch, half[:, 0], half[:, 1])
    flexibility = sum(1.0 / material.plane_strain_modulus for material in materials)
    return np.asarray(flexibility / np.pi * integral / cells.area)


def surface_contact_compliance(
    cells: SurfaceCells, responses: tuple[FlankResponse, FlankResponse], materials: tuple[Material, Material]
) -> Array:
    """Compliance (n, n) of the cells of one tooth pair, both members together [mm/N].

    Parameters
    ----------
    cells
        The cells.
    responses
        Of pinion and gear.
    materials
        Of pinion and gear.
    """
    compliance = half_space_compliance(cells, materials)
    for response, fractions in zip(responses, (cells.pinion_fractions, cells.gear_fractions), strict=True):
        shares = response.shares(fractions)
        compliance += shares @ (shares @ response.beyond_half_space).T
    return 0.5 * (compliance + compliance.T)


def solve_surface_contact(
    separation: list[Array], lever_arm: list[Array], compliance: list[Array], torque: float
) -> SurfaceContact:
    """Pressures of several tooth pairs that turn together.

    Parameters
    ----------
    separation, lever_arm, compliance
        Of the cells of every tooth pair: (n), (n) [mm] and (n, n) [mm/N].
    torque
        About the gear's axis [N mm].

    Returns
    -------
    SurfaceContact
        Certified, or not settled: if a compliance has a negative eigenvalue, for instance.
    """
    problem = ContactProblem(
        np.concatenate(separation), np.concatenate(lever_arm), torque, scipy.linalg.block_diag(*compliance)
    )
    solution = solve(problem)
    by_pair = np.split(solution.force, np.cumsum([s.size for s in separation])[:-1])
    return SurfaceContact(by_pair, solution.rotation, solution.certified)
