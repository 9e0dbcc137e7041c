"""Response of loads and rotation to a change of the separation, while the same segments touch.

On the segments A in contact the gap is zero, elsewhere the force is. With the separation S + B m the conditions

    C_AA F_A + S_A + B_A m - r_A theta = 0,    r_A'F_A = T

are linear, so forces and rotation are affine functions of the coefficients m (Conry and Seireg 1973). They are solved
by the system of the touching segments that sensitivities and torque paths are solved by, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from ...core.arrays import Bools, Integers, RealArray as Array
from ..problem.compliance_matrix import ComplianceMatrix
from ..solvers.parametric.touching_form import touching_system


def held_in_contact(
    compliance: ComplianceMatrix, separation: Array, lever_arm: Array, torque: float
) -> tuple[Array, float]:
    """Forces [N], pulling ones allowed, and rotation [rad] that close all gaps (n); positive definite compliance."""
    system = touching_system(compliance, lever_arm, np.ones(separation.size, dtype=np.bool_))
    force, rotation, _ = system.solve(-separation[:, None], np.array([torque])).column(0)
    return force, rotation


@dataclass(frozen=True, eq=False)
class LoadResponse:
    """Line loads (n) and rotations (m) of many contact problems as affine functions of p coefficients.

    Without contact a line load is minus the gap over the yielding; it turns positive where the segment would touch, and
    is then too high, as the neighbours touch too. A mesh cycle is one torque in one assembly.
    """

    line_load: Array  # [N/mm]
    line_load_slope: Array
    touching: Bools
    length: Array
    curvature: Array
    at_end: Bools
    cycle: Integers
    rotation: Array  # [urad]
    rotation_slope: Array
    rotation_cycle: Integers

    @property
    def carried(self) -> Array:
        """Line loads (n) [N/mm], zero where there is no contact."""
        return np.maximum(self.line_load, 0.0)


def stacked(parts: Sequence[LoadResponse]) -> LoadResponse:
    """Concatenate the loads of many contact problems."""
    return LoadResponse(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(LoadResponse)))


def load_response(
    compliance: ComplianceMatrix,
    force: Array,
    gap: Array,
    rotation: float,
    separation: Array,
    *,
    lever_arm: Array,
    length: Array,
    curvature: Array,
    at_end: Bools,
    cycle: int,
    held: bool = False,
) -> LoadResponse:
    """One solved contact problem as affine functions of the coefficients, from its tangent compliance [mm/N].

    That is positive definite on the segments in contact, at least one.
    Solution (n) [N], (n) [mm], [rad]; derivatives of the separation (n, p) [mm per unit]. With ``held`` all segments
    are in contact, by pulling if need be.
    """
    active = np.full(force.size, held) | (force > 0.0)
    system = touching_system(compliance, lever_arm, active)
    change = system.solve(-separation, np.zeros(separation.shape[1]))
    # To a force of its own while the loaded segments keep contact [mm/N].
    yielding = compliance.diagonal if active.all() else np.where(active, compliance.diagonal, system.yielding())
    would_be = np.where(active, force, -np.maximum(gap, 0.0) / yielding)
    would_be_slope = np.where(active[:, None], change.force, -change.gap / yielding[:, None])
    return LoadResponse(
        line_load=would_be / length,
        line_load_slope=would_be_slope / length[:, None],
        touching=active,
        length=length,
        curvature=curvature,
        at_end=at_end,
        cycle=np.full(force.size, cycle),
        rotation=np.array([1e6 * rotation]),
        rotation_slope=1e6 * change.rotation[None],
        rotation_cycle=np.array([cycle]),
    )
