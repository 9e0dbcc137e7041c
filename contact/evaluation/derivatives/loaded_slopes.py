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

from ....core.checks import frozen_arrays
from ....core.errors import InputError
from ...compliance.weber_line_contact import WeberLineContact
from ...line_contact.line_contact_sensitivity import line_contact_sensitivity
from ...loaded_cases import LoadedCase
from ...segments import MATERIAL_DEPTH_MINIMUM, RELATIVE_CURVATURE_MINIMUM
from .bending_slopes import BendingSlopes
from .segment_slopes import SegmentSlopes

Array = NDArray[Any]

SIZE_STEP = 1e-5  # relative, of the sizes of a line contact in a difference of its deflection
OVERHANG_STEP = 1e-7  # [mm], of the distance beyond an edge in such a difference; strips are some hundredths wide
SIZES = ("length", "equivalent_radius", "depth_pinion", "depth_gear", "overhang")


@frozen_arrays
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
    place, pinion_place
        Of the places where gear and pinion are loaded (2, n, j), see ``Segments``.
    length, equivalent_radius
        Of these (n, j) [mm]. As the places those of edges without load are left at zero.
    """

    case: LoadedCase
    rotation: Array
    force: Array
    pressure: Array
    moment: Array
    place: Array
    pinion_place: Array
    length: Array
    equivalent_radius: Array


def case_slopes(
    slopes: SegmentSlopes, bending: BendingSlopes, cases: Sequence[LoadedCase], torque_slope: float
) -> list[CaseSlopes]:
    """Derivatives of solved cases.

    Parameters
    ----------
    slopes, bending
        Derivatives of the segments, and of their bending.
    cases
        From ``MeshCycle.loaded``.
    torque_slope
        Torque about the gear axis per torque at the pinion [N mm / (N m)].

    Raises
    ------
    InputError
        If a case is not certified, or is supported.
    """
    result = []
    for case, softer in zip(cases, _deflection_slopes(cases), strict=True):
        here, force = case.segments, case.solution.force
        if here.held is not None:
            raise InputError("cases: must be those of rigid supports to have derivatives")
        rows = slopes.rows(case)
        known = np.flatnonzero(rows >= 0)  # edges without load have no part in the derivatives
        own = {name: _among(values[rows[known]], known, rows.size) for name, values in slopes.slopes.items()}
        bent = _among(bending(here.pair[known], rows[known], force[known]), known, rows.size)
        pinion, gear = (
            np.stack([_among(values[rows[known]], known, rows.size) for values in one]) for one in slopes.places
        )
        sizes = _sizes(here.line_contact, own)
        bent = bent + sum(softer[name][:, None] * change for name, change in sizes.items())
        result.append(_case(case, own | sizes, bent, (pinion, gear), torque_slope))
    return result


def _among(values: Array, rows: Array, count: int) -> Array:
    """Values (m, j) at some rows of ``count``, zero at the others."""
    every = np.zeros((count, values.shape[1]))
    every[rows] = values
    return every


def _case(
    case: LoadedCase, slopes: dict[str, Array], bent: Array, places: tuple[Array, Array], torque_slope: float
) -> CaseSlopes:
    here, solution = case.segments, case.solution
    force, contact = solution.force, here.line_contact
    arm, count = slopes["lever_arm"], bent.shape[1]
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
    of_load = of_load - with_torque(slopes["length"] / contact.length[:, None])
    of_load = of_load - with_torque(slopes["equivalent_radius"] / contact.equivalent_radius[:, None])
    pressure = 0.5 * contact.pressure(force)[:, None] * of_load
    moment = changes.force * here.lever_arm[:, None] + force[:, None] * with_torque(arm)
    length, radius = (with_torque(slopes[name]) for name in ("length", "equivalent_radius"))
    pinion, gear = (np.stack([with_torque(values) for values in one]) for one in places)
    return CaseSlopes(case, changes.rotation, changes.force, pressure, moment, gear, pinion, length, radius)


def _sizes(contact: WeberLineContact, slopes: dict[str, Array]) -> dict[str, Array]:
    """Derivatives (n, j) of the sizes of a line contact, zero where a size is at its limit."""
    radius = contact.equivalent_radius[:, None]
    free = radius < 1.0 / RELATIVE_CURVATURE_MINIMUM
    sizes = {"length": slopes["length"], "equivalent_radius": np.where(free, -(radius**2) * slopes["curvature"], 0.0)}
    for name in ("depth_pinion", "depth_gear"):
        inside = getattr(contact, name)[:, None] > MATERIAL_DEPTH_MINIMUM
        sizes[name] = np.where(inside, slopes[name], 0.0)
    if np.any(np.isfinite(contact.overhang)):
        sizes["overhang"] = slopes["overhang"]
    return sizes


def _deflection_slopes(cases: Sequence[LoadedCase]) -> list[dict[str, Array]]:
    """Derivatives (n) of the local deflections under held forces by each of the sizes, for every case."""
    contact = WeberLineContact.joined([case.segments.line_contact for case in cases])
    force = np.concatenate([case.solution.force for case in cases])
    ends = np.cumsum([case.solution.force.size for case in cases])[:-1]
    found: list[dict[str, Array]] = [{} for _ in cases]
    for name in SIZES:
        size = getattr(contact, name)
        step = OVERHANG_STEP if name == "overhang" else SIZE_STEP * size
        ahead, behind = (replace(contact, **{name: size + sign * step}).deflection(force) for sign in (1.0, -1.0))
        for one, values in zip(found, np.split((ahead - behind) / (2.0 * step), ends), strict=True):
            one[name] = values
    return found
