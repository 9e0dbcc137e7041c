"""Mesh stiffness: torque about the gear axis per rotation of the gear, the pinion held."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compliance.weber_line_contact import WeberLineContact
from ..loaded_cases import LoadedCase
from ..solvers.parametric.touching_form import touching_stiffness

Array = NDArray[Any]


def mesh_stiffness(case: LoadedCase) -> float:
    """Tangent of the torque over the rotation at a certified solution.

    With the segments in contact fixed, their gaps stay closed: ``(B + D) dF = r dtheta`` and ``dT = r . dF``, so that
    ``dT / dtheta = r . (B + D)^-1 r`` with the bending compliance B, the tangent D of the line contacts and the lever
    arms r; see ``line_contact_sensitivity``. Where a segment is about to touch, this is the stiffness before it does:
    the tangent jumps as the segment enters, while the rotation is continuous.

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
    >>> low, high = (cycle.solved([torque])[0] for torque in (109.0, 111.0))
    >>> secant = 3.0 * 2.0 / (1e6 * (high.solution.rotation - low.solution.rotation))
    >>> bool(np.isclose(mesh_stiffness(cycle.solved([110.0])[0]), secant, rtol=1e-3))
    True
    """
    return float(mesh_stiffnesses([case])[0])


def mesh_stiffnesses(cases: Sequence[LoadedCase]) -> Array:
    """``mesh_stiffness`` of several cases (c), as the solution gives it or from the system of touching segments."""
    known = np.array([case.solution.stiffness if case.solution.certified else np.nan for case in cases])
    result = 1e-9 * known
    certified = [n for n, case in enumerate(cases) if case.solution.certified and not np.isfinite(known[n])]
    if not certified:
        return result
    contacts = WeberLineContact.joined([cases[number].segments.line_contact for number in certified])
    forces = [cases[number].solution.force for number in certified]
    tangents = np.split(contacts.tangent(np.concatenate(forces)), np.cumsum([force.size for force in forces])[:-1])
    for number, force, tangent in zip(certified, forces, tangents, strict=True):
        here = cases[number].segments
        result[number] = 1e-9 * touching_stiffness(tangent, here.bending, here.lever_arm, force > 0.0)
    return result
