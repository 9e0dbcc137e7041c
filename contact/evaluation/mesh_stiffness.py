"""Mesh stiffness: torque about the gear axis per rotation of the gear, the pinion held."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compliance import WeberLineContact
from ..loaded_cases import LoadedCase

Array = NDArray[Any]
BLOCKS_TOGETHER = 24  # tooth pairs at a mesh position that are solved together


def mesh_stiffness(case: LoadedCase) -> float:
    """Tangent of the torque over the rotation at a certified solution.

    With the segments in contact fixed, their gaps stay closed: ``(B + D) dF = r dtheta`` and ``dT = r . dF``, so that
    ``dT / dtheta = r . (B + D)^-1 r`` with the bending compliance B, the tangent D of the line contacts and the lever
    arms r. A segment comes into contact with no force: the tangent is continuous in the torque.

    Parameters
    ----------
    case
        A solved torque at a mesh position.

    Returns
    -------
    float
        Stiffness [N m/urad]; NaN if the solution is not certified.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=9)
    >>> low, high = (cycle.solved([torque])[0] for torque in (99.0, 101.0))
    >>> secant = 3.0 * 2.0 / (1e6 * (high.solution.rotation - low.solution.rotation))
    >>> bool(np.isclose(mesh_stiffness(cycle.solved([100.0])[0]), secant, rtol=1e-3))
    True
    """
    return float(mesh_stiffnesses([case])[0])


def mesh_stiffnesses(cases: Sequence[LoadedCase]) -> Array:
    """``mesh_stiffness`` of several cases (c)."""
    certified = [number for number, case in enumerate(cases) if case.solution.certified]
    result = np.full(len(cases), np.nan)
    if certified:
        result[certified] = _of_certified([cases[number] for number in certified])
    return result


def _of_certified(cases: Sequence[LoadedCase]) -> Array:
    """Stiffnesses (c): the sum over tooth pairs, which no bending couples, of what their segments in contact carry."""
    forces = [case.solution.force for case in cases]
    local = WeberLineContact.joined([case.segments.line_contact for case in cases]).tangent(np.concatenate(forces))
    tangents = np.split(local, np.cumsum([force.size for force in forces])[:-1])
    blocks = []
    for case, force, tangent in zip(cases, forces, tangents, strict=True):
        bending, arm = case.segments.bending, case.segments.lever_arm
        for index, modes in bending.blocks:
            rows = np.flatnonzero(force[index] > 0.0)
            blocks.append((modes[rows], tangent[index[rows]], arm[index[rows]]))
    carried = np.empty(len(blocks))
    order = sorted(range(len(blocks)), key=lambda number: len(blocks[number][0]))
    for start in range(0, len(order), BLOCKS_TOGETHER):  # of about the same size
        together = order[start : start + BLOCKS_TOGETHER]
        carried[together] = _carried([blocks[number] for number in together])
    first = np.cumsum([0, *(len(case.segments.bending.blocks) for case in cases)])[:-1]
    return np.asarray(np.add.reduceat(carried, first)) * 1e-9


def _carried(blocks: Sequence[tuple[Array, Array, Array]]) -> Array:
    """``r . (B + D)^-1 r`` of blocks (b), from the modes of B (m, k), the diagonal of D (m) and the arms r (m)."""
    size, rank = (max(modes.shape[axis] for modes, _, _ in blocks) for axis in (0, 1))
    shape = len(blocks), size
    all_modes, compliance, arms = np.zeros((*shape, rank)), np.ones(shape), np.zeros(shape)
    for number, (modes, tangent, arm) in enumerate(blocks):
        all_modes[number, : len(modes), : modes.shape[1]] = modes
        compliance[number, : len(modes)], arms[number, : len(modes)] = tangent, arm
    whole = all_modes @ all_modes.swapaxes(1, 2) + compliance[:, :, None] * np.eye(size)
    return np.asarray(np.sum(arms * np.linalg.solve(whole, arms[..., None])[..., 0], axis=1))
