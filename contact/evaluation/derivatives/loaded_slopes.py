"""Derivatives of the loaded contact over a mesh cycle: rotation, forces, pressures and load shares.

The elastic teeth and the segments in contact are held: within a touching set everything is smooth, and across its
changes forces and rotation are continuous. At every mesh position the system of the touching segments that Newton's
method ended with is solved once more, with the changes of gap, lever arm and deflection by all settings on the right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.errors import InputError
from ...compliance import WeberLineContact
from ...line_contact.line_contact_sensitivity import line_contact_sensitivity
from ...loaded_cases import LoadedCase
from ...segments import MATERIAL_DEPTH_MINIMUM, RELATIVE_CURVATURE_MINIMUM, CycleSegments
from .bending_slopes import BendingSlopes
from .segment_slopes import SegmentSlopes

Array = NDArray[Any]

SIZE_STEP = 1e-5  # relative, of the sizes of a line contact in a difference of its deflection


@dataclass(frozen=True)
class CaseSlopes:
    """Derivatives of one torque at one mesh position by settings (j), of which the last is the torque at the pinion.

    Parameters
    ----------
    case
        The solved case, of n segments.
    rotation
        Of the gear (j) [rad].
    force, pressure
        Of the segments (n, j) [N, MPa].
    moment
        Of the segments' moments about the gear axis (n, j) [N mm].
    """

    case: LoadedCase
    rotation: Array
    force: Array
    pressure: Array
    moment: Array


def case_slopes(
    segments: CycleSegments,
    slopes: SegmentSlopes,
    bending: BendingSlopes,
    cases: Sequence[LoadedCase],
    torque_slope: float,
) -> list[CaseSlopes]:
    """Derivatives of solved cases of contact on lines.

    Parameters
    ----------
    segments
        Of the mesh cycle.
    slopes, bending
        Derivatives of its segments, and of their bending.
    cases
        From ``MeshCycle.loaded`` with contact on lines alone.
    torque_slope
        Torque about the gear axis per torque at the pinion [N mm / (N m)].

    Raises
    ------
    InputError
        If a case is not certified, is supported, or has edges in contact.
    """
    position = segments.on_lines.names["position"]
    numbers = {k: np.flatnonzero(position == k) for k in np.unique(position)}
    result = []
    for case in cases:
        chosen = numbers[case.mesh_position]
        if case.segments.held is not None or np.any(np.isfinite(case.segments.line_contact.overhang)):
            raise InputError("cases: must be those of contact on lines alone, with rigid supports, to have derivatives")
        if case.segments.pair.size != chosen.size:
            raise InputError("cases: must be those of the mesh cycle's own segments")
        own = {name: values[chosen] for name, values in slopes.slopes.items()}
        result.append(_case(case, own, bending(case.segments, chosen, case.solution.force), torque_slope))
    return result


def _case(case: LoadedCase, slopes: dict[str, Array], bent: Array, torque_slope: float) -> CaseSlopes:
    here, solution = case.segments, case.solution
    force, contact = solution.force, here.line_contact
    arm, count = slopes["lever_arm"], bent.shape[1]
    sizes = _sizes(contact, slopes)
    bent = bent + sum(_deflection_slope(contact, name, force)[:, None] * change for name, change in sizes.items())
    gap = slopes["separation_angle"] * here.lever_arm[:, None] + here.separation_angle[:, None] * arm
    turn = np.zeros(count + 1)
    turn[-1] = torque_slope

    def with_torque(values: Array) -> Array:
        return np.pad(values, ((0, 0), (0, 1)))

    problem = here.bending_problem.with_torque(case.problem.torque)
    changes = line_contact_sensitivity(problem, contact, solution).forward_all(
        torque=turn, separation=with_torque(gap), lever_arm=with_torque(arm), bent=with_torque(bent)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        of_load = np.nan_to_num(changes.force / force[:, None], posinf=0.0, neginf=0.0)
    of_load = of_load - with_torque(sizes["length"] / contact.length[:, None])
    of_load = of_load - with_torque(sizes["equivalent_radius"] / contact.equivalent_radius[:, None])
    pressure = 0.5 * contact.pressure(force)[:, None] * of_load
    moment = changes.force * here.lever_arm[:, None] + force[:, None] * with_torque(arm)
    return CaseSlopes(case, changes.rotation, changes.force, pressure, moment)


def _sizes(contact: WeberLineContact, slopes: dict[str, Array]) -> dict[str, Array]:
    """Derivatives (n, j) of the sizes of a line contact, zero where a size is at its limit."""
    radius = contact.equivalent_radius[:, None]
    free = radius < 1.0 / RELATIVE_CURVATURE_MINIMUM
    sizes = {"length": slopes["length"], "equivalent_radius": np.where(free, -(radius**2) * slopes["curvature"], 0.0)}
    for name in ("depth_pinion", "depth_gear"):
        inside = getattr(contact, name)[:, None] > MATERIAL_DEPTH_MINIMUM
        sizes[name] = np.where(inside, slopes[name], 0.0)
    return sizes


def _deflection_slope(contact: WeberLineContact, name: str, force: Array) -> Array:
    """Derivative (n) of the local deflection under a held force by one of the sizes."""
    size = getattr(contact, name)
    ahead, behind = (
        replace(contact, **{name: size * (1.0 + sign * SIZE_STEP)}).deflection(force) for sign in (1.0, -1.0)
    )
    return np.asarray((ahead - behind) / (2.0 * SIZE_STEP * size))
