"""Contact of a whole pair at one mesh position without the split, for all tooth pairs, edges included.

The split is that into bending and indentation; here pressures act on cells of the flank. Find pressures p >= 0 and the
rotation of the gear such that every gap

    Y = (indentation by p, closed form) + (what both bodies add, finite elements) + S - r theta >= 0,   p Y = 0

and the moments of the pressures balance the torque. No line of contact, no relative radius, no foot of a normal and no
depth to a middle surface enters. Each tooth has a body of its own.

Loads per length are compared as greatest means over stretches of a contact line. At a point where a line runs into an
edge a line load has no definite value: pieces of the edge are shorter than the pressed strip is wide, and cells across
the line are cut by it. A mean over a stretch as long as the strip is wide has one: shorter than that, nothing acts as a
line contact.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.linalg

from ..contact.compliance.half_space_cells import even_pressure_integral
from ..contact.compliance.material import Material
from ..contact.lines.mesh_lines import MeshLines
from ..contact.problem.contact_problem import ContactProblem
from ..contact.solvers import ContactSolution, solve
from ..core.arrays import Array, record
from ..core.checks import instance, instances, positive, truth, whole
from ..geometry.pair.gear_pair import GearPair
from ..geometry.tooth.tooth_flanks import MemberName
from ..geometry.tooth.tooth_lattice import LatticeSize
from .flank_response import THROUGH_BRICKS, FlankResponse
from .surface_cells import FlanksInMesh, SurfaceCells, cells_on_line


def half_space_compliance(cells: SurfaceCells, materials: tuple[Material, Material]) -> Array:
    """Deflection (n, n) of both half spaces in the middle of a cell under an even pressure on another [mm/N]."""
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
    """Compliance (n, n) of the cells of one tooth pair, both members together [mm/N]."""
    compliance = half_space_compliance(cells, materials)
    for response, fractions in zip(responses, (cells.pinion_fractions, cells.gear_fractions), strict=True):
        shares = response.shares(fractions)
        compliance += shares @ (shares @ response.beyond_half_space).T
    return 0.5 * (compliance + compliance.T)


def solve_surface_contact(
    separation: list[Array], lever_arm: list[Array], compliance: list[Array], torque: float
) -> tuple[list[Array], ContactSolution]:
    """Forces (n) [N] on the cells of tooth pairs that turn together, under a torque about the gear's axis [N mm].

    Cells have separation and lever arm (n) [mm] and compliance (n, n) [mm/N]; a negative eigenvalue is not certified.
    """
    whole_compliance = scipy.linalg.block_diag(*compliance)
    solution = solve(ContactProblem(np.concatenate(separation), np.concatenate(lever_arm), torque, whole_compliance))
    return np.split(solution.force, np.cumsum([s.size for s in separation])[:-1]), solution


CELLS_PER_HALF_WIDTH = 8
CELL_LENGTH_FACTOR = 2.4  # [mm], length of the cells along the line times their number in a half-width
FIRST_BAND_RATIO, BAND_RATIO_LIMIT = 1.6, 8.0  # half of the band with cells over the half-width
LINE_EXTENSION = 2.0  # [mm], of the band beyond the ends of a line
ROTATION_LIMIT = 0.1  # [rad]; flanks without cells at this rotation cannot touch
BORROWED_LINE_DISTANCE = 0.25  # [pitch], from a mesh position without a line to the one whose line it takes


@record(frozen=True)
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
    >>> contact = contact_of_flanks(flanks, responses, (STEEL, STEEL), mesh, 0, 100.0, **guess)
    >>> print(contact.load_share.sum().round(9))
    1.0
    """
    instance("flanks", flanks, FlanksInMesh)
    instance("mesh", mesh, MeshLines)
    whole("position", position, 0, mesh.rotations.size - 1)
    truth("beyond_lines", beyond_lines)
    instances("responses", responses, FlankResponse, 2)
    instances("materials", materials, Material, 2)
    positive("torque", torque, "N m")
    positive("half_width", half_width, "mm")
    positive("rotation", rotation, "rad")
    positive("cells_per_half_width", cells_per_half_width)
    gear_torque = 1e3 * torque * flanks.pair.assembly.ratio
    lines = _lines_at(mesh, position, BORROWED_LINE_DISTANCE if beyond_lines else 0.0)
    pitch = flanks.pair.assembly.pinion_pitch
    across = half_width / cells_per_half_width
    step = (CELL_LENGTH_FACTOR / cells_per_half_width, across)
    greatest_arm = float(np.max(flanks.splines.spline.coefficients[flanks.splines.columns["lever_arm"][0]]))
    band, allowed = FIRST_BAND_RATIO * half_width, 1.15 * rotation
    while True:
        cells_of_pairs = {
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
        cells_of_pairs = {pair: cells for pair, cells in cells_of_pairs.items() if cells.row.size}
        if not cells_of_pairs:
            if allowed > ROTATION_LIMIT:
                return FlankContact(np.nan, [], [], [])
            allowed *= 2.0
            continue
        cells = list(cells_of_pairs.values())
        separation, lever_arm = [one.separation for one in cells], [one.lever_arm for one in cells]
        compliance = [surface_contact_compliance(one, responses, materials) for one in cells]
        force, solved = solve_surface_contact(separation, lever_arm, compliance, gear_torque)
        border = np.ceil(band / across)
        touches = any(np.any(f[np.abs(c.row) == border] > 0.0) for f, c in zip(force, cells, strict=True))
        if touches and band < BAND_RATIO_LIMIT * half_width:
            band *= 1.5
        elif solved.rotation > allowed:
            allowed = 1.15 * solved.rotation
        else:
            return FlankContact(solved.rotation, list(cells_of_pairs), cells, force)


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


def greatest_stretch_load(place: Array, length: Array, force: Array, stretch: float) -> float:
    """Greatest load per length [N/mm] over any stretch [mm] of a line under pieces (n) [N], which may overlap.

    Forces are spread evenly over each piece, of a middle and a length [mm].
    """
    loaded = np.flatnonzero(force > 0.0)
    if not loaded.size:
        return 0.0
    place, length, force = place[loaded], length[loaded], force[loaded]
    start, end = place - 0.5 * length, place + 0.5 * length
    # The load of a stretch is piecewise linear in its place, with kinks where either end meets an end of a piece.
    kinks = np.concatenate([start, end])
    first = np.concatenate([kinks, kinks - stretch])

    def load_before(places: Array) -> Array:
        return np.asarray(np.clip((places[:, None] - start) / length, 0.0, 1.0) @ force)

    return float(np.max(load_before(first + stretch) - load_before(first)) / stretch)


def stretch_load(contact: FlankContact, stretch: float) -> float:
    """Greatest load per length over any stretch of the lines of a contact without the split [N/mm]; 0 if none."""
    lines = zip(line_directions(contact), contact.cells, contact.force, strict=True)
    loads = (greatest_stretch_load(c.position @ along, c.sides[:, 0], force, stretch) for along, c, force in lines)
    return max(loads, default=0.0)


def line_directions(contact: FlankContact) -> list[Array]:
    """Unit vector (3) along the contact line of every tooth pair, in the gear's frame."""
    means = [cells.along.mean(axis=0) for cells in contact.cells]
    return [mean / np.linalg.norm(mean) for mean in means]


BRICKS_PER_MILLIMETRE = 0.55  # along the face
FEWEST_BRICKS, MOST_BRICKS = 24, 32  # along the face
THIN_BRICKS = 4  # of these


def response_size(pair: GearPair, member: MemberName, *, finer: bool = False) -> LatticeSize:
    """Bricks of a tooth for its response: more than those of the analysis, thin ones at its ends, or many more."""
    one = getattr(pair, member)
    trace = one.flank(np.linspace(0.0, 1.0, 17), np.array([0.5])).position
    length = float(np.linalg.norm(np.diff(trace, axis=1), axis=0).sum())
    along = int(np.clip(round(BRICKS_PER_MILLIMETRE * length) + THIN_BRICKS, FEWEST_BRICKS, MOST_BRICKS))
    usual = LatticeSize(lengthwise=along, upward=13, through=len(THROUGH_BRICKS))
    return replace(usual, lengthwise=usual.lengthwise + 8, upward=17, slot=3) if finer else usual
