"""Mesh stiffness: torque about the gear axis per rotation of the gear, the pinion held."""

from __future__ import annotations

import numpy as np

from ..loaded_cases import LoadedCase


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
    solution, segments = case.solution, case.segments
    if not solution.certified:
        return float("nan")
    active = np.flatnonzero(solution.force > 0.0)
    arm = segments.lever_arm[active]
    modes = segments.bending.factor[active]
    local = segments.line_contact.tangent(solution.force)[active]
    # Woodbury: the local part is a diagonal, bending has few modes.
    scaled = modes / local[:, None]
    inner = np.eye(modes.shape[1]) + modes.T @ scaled
    coupled = scaled.T @ arm
    return float(arm @ (arm / local) - coupled @ np.linalg.solve(inner, coupled)) * 1e-9
