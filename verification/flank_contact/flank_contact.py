"""Contact of a whole pair at one mesh position without the split, for all tooth pairs, edges included."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...contact.compliance.material import Material
from ...contact.lines.mesh_lines import MeshLines
from ...core.checks import frozen_arrays, instance, instances, positive, truth, whole
from .flank_response import FlankResponse
from .surface_cells import FlanksInMesh, SurfaceCells, cells_on_line
from .surface_contact import solve_surface_contact, surface_contact_compliance

Array = NDArray[Any]
CELLS_PER_HALF_WIDTH = 8
CELL_LENGTH_FACTOR = 2.4  # [mm], length of the cells along the line times their number in a half-width
FIRST_BAND_RATIO, BAND_RATIO_LIMIT = 1.6, 8.0  # half of the band with cells over the half-width
LINE_EXTENSION = 2.0  # [mm], of the band beyond the ends of a line
ROTATION_LIMIT = 0.1  # [rad]; flanks without cells at this rotation cannot touch
BORROWED_LINE_DISTANCE = 0.25  # [pitch], from a mesh position without a line to the one whose line it takes


@frozen_arrays
@dataclass(frozen=True)
class FlankContact:
    """Solved contact of one mesh position.

    Parameters
    ----------
    rotation
        Transmission error [rad]; NaN if not solved, or if nothing can touch.
    pairs
        Tooth pairs, as ``MeshLines`` counts them.
    cells, force
        Their cells and the normal forces on them [N].

    Examples
    --------
    >>> at, zero, one = np.zeros(1, dtype=int), np.zeros((2, 1)), np.ones((1, 3))
    >>> cells = SurfaceCells(at, at, one, one, np.ones((1, 2)), one, zero, zero, np.zeros(1), np.array([50.0]))
    >>> FlankContact(1e-4, [0, 1], [cells, cells], [np.array([300.0]), np.array([100.0])]).load_share
    array([0.75, 0.25])
    """

    rotation: float
    pairs: list[int]
    cells: list[SurfaceCells]
    force: list[Array]

    @property
    def load_share(self) -> Array:
        """Part of the torque that every tooth pair carries."""
        moment = np.array([force @ cells.lever_arm for force, cells in zip(self.force, self.cells, strict=True)])
        return np.asarray(moment / moment.sum())


def contact_of_flanks(
    flanks: FlanksInMesh,
    responses: tuple[FlankResponse, FlankResponse],
    materials: tuple[Material, Material],
    mesh: MeshLines,
    position: int,
    torque: float,
    *,
    half_width: float,
    rotation: float,
    cells_per_half_width: float = CELLS_PER_HALF_WIDTH,
    beyond_lines: bool = True,
) -> FlankContact:
    """Solve one mesh position.

    Parameters
    ----------
    flanks
        The pair.
    responses, materials
        Of pinion and gear.
    mesh
        Contact lines of the pair, one a tooth pair; they only say where to lay cells.
    position
        Index of the mesh position.
    torque
        At the pinion [N m].
    half_width, rotation
        About how wide the contact and how great the transmission error will be [mm, rad]; both are widened until the
        contact ends within the cells.
    cells_per_half_width
        Resolution across the line.
    beyond_lines
        Whether edges may touch where there is no contact line: beyond its ends, and on teeth just before and after
        their passage.

    Raises
    ------
    InputError
        If torque, half-width, rotation or resolution is not a positive number.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import STEEL, lines_in_mesh
    >>> from easeoff.geometry import LatticeSize
    >>> from easeoff.verification import flank_response, flanks_in_mesh
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> flanks, size = flanks_in_mesh(pair, (9, 7)), LatticeSize(4, 3, 2, 1, 1, 1, 0)
    >>> responses = flank_response(pair, "pinion", STEEL, size), flank_response(pair, "gear", STEEL, size)
    >>> mesh = lines_in_mesh(flanks.splines, pair.assembly.pinion_pitch, 4)
    >>> guess = {"half_width": 0.4, "rotation": 2e-4, "cells_per_half_width": 2.0, "beyond_lines": False}
    >>> found = contact_of_flanks(flanks, responses, (STEEL, STEEL), mesh, 0, 100.0, **guess)
    >>> print(found.load_share.sum().round(9))
    1.0
    """
    instance("flanks", flanks, FlanksInMesh)
    instance("mesh", mesh, MeshLines)
    whole("position", position, 0, mesh.rotations.size - 1)
    truth("beyond_lines", beyond_lines)
    instances("responses", responses, FlankResponse, 2)
    instances("materials", materials, Material, 2)
    for name, value, unit in (
        ("torque", torque, "N m"),
        ("half_width", half_width, "mm"),
        ("rotation", rotation, "rad"),
        ("cells_per_half_width", cells_per_half_width, "1"),
    ):
        positive(name, value, unit)
    lines = _lines_at(mesh, position, BORROWED_LINE_DISTANCE if beyond_lines else 0.0)
    pitch = flanks.pair.assembly.pinion_pitch
    across = half_width / cells_per_half_width
    step = (CELL_LENGTH_FACTOR / cells_per_half_width, across)
    greatest_arm = float(np.max(flanks.splines.spline.coefficients[flanks.splines.columns["lever_arm"][0]]))
    band, allowed = FIRST_BAND_RATIO * half_width, 1.15 * rotation
    while True:
        found = {
            pair: cells_on_line(
                flanks,
                line,
                float(mesh.rotations[position] - pair * pitch),
                step=step,
                half_band=band,
                extension=LINE_EXTENSION if beyond_lines else 0.0,
                widest_gap=allowed * greatest_arm,
            )
            for pair, line in lines.items()
        }
        found = {pair: cells for pair, cells in found.items() if cells.row.size}
        if not found:
            if allowed > ROTATION_LIMIT:
                return FlankContact(np.nan, [], [], [])
            allowed *= 2.0
            continue
        cells = list(found.values())
        solved = solve_surface_contact(
            [one.separation for one in cells],
            [one.lever_arm for one in cells],
            [surface_contact_compliance(one, responses, materials) for one in cells],
            1e3 * torque * flanks.pair.assembly.ratio,
        )
        border = np.ceil(band / across)
        touches = any(np.any(f[np.abs(c.row) == border] > 0.0) for f, c in zip(solved.force, cells, strict=True))
        if touches and band < BAND_RATIO_LIMIT * half_width:
            band *= 1.5
        elif solved.rotation > allowed:
            allowed = 1.15 * solved.rotation
        else:
            return FlankContact(solved.rotation, list(found), cells, solved.force)


def _lines_at(mesh: MeshLines, position: int, near: float) -> dict[int, Array]:
    """Contact line of every tooth pair; shortly before and after its passage the nearest line it has."""
    count = mesh.rotations.size
    step = mesh.position - mesh.pair * count
    lines: dict[int, Array] = {}
    for pair in range(int(mesh.pair.min()) - 1, int(mesh.pair.max()) + 2):
        away = np.abs(step - (position - pair * count))
        nearest = int(np.argmin(away))
        if away[nearest] <= near * count:
            lines[pair] = mesh.lines.points[:, nearest]
    return lines
