"""Derivatives of the root stress: linear in the segments' forces, with responses that depend on their places.

The largest stress keeps its place in the root and its direction. It changes with the forces on the nodes of the flank,
which follow the segments' forces and the shares of these that fall to each node.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....geometry.pair.gear_pair import MEMBERS
from ...compliance.elastic_model import member_points
from ...compliance.finite_elements.finite_element_tooth import FiniteElementTooth
from ...compliance.finite_elements.flank_compliance import spread_shares
from ...lines.flank_splines import SLOPES
from ...lines.opposite_points import PINION_FRACTIONS
from .bending_slopes import POINT_STEP
from .field_directions import FieldDirections
from .loaded_slopes import CaseSlopes

Array = NDArray[Any]

OF_ROOTS = ("root_stress_history", "max_root_stress")


def root_stress_slopes(
    directions: FieldDirections,
    teeth: tuple[FiniteElementTooth, FiniteElementTooth],
    found: Sequence[CaseSlopes],
    stress: xr.Dataset,
) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Derivatives of ``root_stress_history`` and ``max_root_stress``, with their dimensions.

    Parameters
    ----------
    directions
        Fields and their derivatives.
    teeth
        Pinion and gear by finite elements.
    found
        Derivatives of solved cases by settings, and last by the torque (j).
    stress
        From ``load_capacity.tooth_root_stress`` of the same cases.
    """
    pairs, count = stress["pair"].values, found[0].rotation.size
    history = stress["root_stress_history"].transpose("torque", "member", "mesh_position", "pair").values
    slopes = np.full((*history.shape, count), np.nan)
    for one in found:
        here, force = one.case.segments, one.case.solution.force
        at = one.case.torque, slice(None), one.case.mesh_position
        column = np.searchsorted(pairs, here.pair)
        places = (here.pinion_point, one.pinion_place), (here.point, one.place)
        for member, (tooth, place) in enumerate(zip(teeth, places, strict=True)):
            assert tooth.root is not None  # or there were no stress
            points, motion = _on_member(directions, MEMBERS[member], *place)
            grid = tooth.flank.lengthwise, tooth.flank.profile
            nodes, shares = spread_shares(*grid, points)
            on_nodes = np.zeros((tooth.flank.profile.size, pairs.size))
            np.add.at(on_nodes, (nodes, column[:, None]), shares * force[:, None])
            gradient = tooth.root.gradients(on_nodes)
            response = np.sum(shares * gradient[nodes, column[:, None]], axis=1)
            by_segment = response[:, None] * one.force
            for axis in (0, 1):
                ahead, behind = (_responses(grid, points, axis, sign, gradient, column) for sign in (1.0, -1.0))
                by_segment += ((ahead - behind) / (2.0 * POINT_STEP) * force)[:, None] * motion[axis]
            change = np.zeros((pairs.size, count))
            np.add.at(change, column, by_segment)
            slopes[at][member] = change
    flat, by_setting = (
        np.moveaxis(values, 1, 0).reshape(len(MEMBERS), len(history), -1, *rest)
        for values, rest in ((history, ()), (slopes, (count,)))
    )
    greatest = np.argmax(np.where(np.isfinite(flat), flat, -np.inf), axis=2)
    of_cycle = np.take_along_axis(by_setting, greatest[..., None, None], axis=2)[:, :, 0]
    return {
        "root_stress_history": (("torque", "member", "mesh_position", "pair", "setting"), slopes),
        "max_root_stress": (("torque", "member", "setting"), np.moveaxis(of_cycle, 0, 1)),
    }


def _on_member(directions: FieldDirections, member: str, points: Array, motion: Array) -> tuple[Array, Array]:
    """Fractions (2, n) on a member of points (2, n) where it is loaded, and their derivatives (2, n, j)."""
    if member == "gear":
        return points, motion
    change = np.stack(list(directions.slopes.evaluate(list(PINION_FRACTIONS), points).values()))
    by_t, by_h = (np.stack(list(d.values())) for d in directions.base.derivatives(PINION_FRACTIONS, points, SLOPES))
    fixed = np.pad(np.moveaxis(change, 1, -1), ((0, 0), (0, 0), (0, 1)))  # the torque moves no field
    moved = fixed + by_t[..., None] * motion[0] + by_h[..., None] * motion[1]
    return member_points(directions.base, member, points), moved


def _responses(
    grid: tuple[Array, Array], points: Array, axis: int, sign: float, gradient: Array, column: Array
) -> Array:
    """Stress (n) under unit forces at points moved along one fraction by a step."""
    moved = points.copy()
    moved[axis] += sign * POINT_STEP
    nodes, shares = spread_shares(*grid, moved)
    return np.asarray(np.sum(shares * gradient[nodes, column[:, None]], axis=1))
