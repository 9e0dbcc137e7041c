"""Load-based scaling of the contact problem: every number of order one at any torque and in any units.

Optimisation codes stop on absolute tolerances. In N, mm and N mm these are meaningless: several well-known solvers
then report success with loads wrong by half. The scaling here does four things.

1. *Shift.* The rotation is counted from the first contact of the rigid bodies, so that large separations cancel,
   without error, before they meet small deflections.
2. *Load scale.* Forces are divided by the mean load of the segments in contact, their number taken from a Winkler bed
   (springs without coupling); gaps by the deflection this load gives the mean diagonal compliance; lever arms by their
   mean.
3. *Powers of two.* All scales are rounded to powers of two: scaling and unscaling then lose no bit.
4. *Clip.* Separations of segments that provably cannot touch are lowered to the bound beyond which that holds, because
   relative tolerances are measured against the largest number in sight.

The bound. Let S >= 0 after the shift and J(F) = 1/2 F'CF + S'F. For any feasible force G the minimiser F has J(F) <=
J(G), hence F'CF <= 2 J(G) and theta T = F'CF + S'F <= 2 J(G). By Cauchy-Schwarz |(CF)_i| <= sqrt(C_ii F'CF). So

    Y_i >= S_i - sqrt(2 C_ii J(G)) - max(r_i, 0) 2 J(G) / T,

and a segment whose S_i exceeds the last two terms stays open. The same holds after S_i has been lowered to a value
above them: the clipped problem has the same solution. G is the Winkler estimate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from .compliance_matrix import ComplianceMatrix, ModalCompliance
from .operator_compliance import OperatorCompliance
from .scaled_problem import ScaledModes, ScaledOperator, ScaledProblem

Array = NDArray[np.float64]

#: A row sum of the compliance overstates the stiffness a segment feels, since its neighbours carry less further out.
WINKLER_ROW_SUM_FRACTION = 0.4
#: Margin on the bound above, well over rounding.
CLIP_MARGIN = 2.0
#: Energies [N mm] outside this range are near underflow or overflow: then nothing is clipped.
SAFE_ENERGY_RANGE = (1e-200, 1e200)


@frozen_arrays
@dataclass(frozen=True, eq=False, slots=True)
class Scaling:
    """The scales of one contact problem, and what was learnt in finding them.

    Attributes
    ----------
    force, compliance, lever_arm
        Scales [N], [mm/N], [mm], each a power of two.
    first_contact_rotation, first_contact_remainder
        Rotation at which the rigid bodies touch and what it lacks by rounding [rad]; scaled rotations count from here.
    estimated_active
        Segments in contact on the Winkler bed (n): a starting set for active-set methods.
    separation_limit
        Separation from first contact (n) [mm] above which a segment provably stays open; infinite where there is no
        such proof (segments with a negative separation from first contact, zero torque).
    certainly_open
        Segments beyond that limit (n).
    """

    force: float
    compliance: float
    lever_arm: float
    first_contact_rotation: float
    first_contact_remainder: float
    estimated_active: NDArray[np.bool_]
    separation_limit: Array
    certainly_open: NDArray[np.bool_]

    @classmethod
    def of(
        cls,
        separation: Array,
        lever_arm: Array,
        torque: float,
        compliance: ComplianceMatrix,
        rotation: float,
        remainder: float,
    ) -> Scaling:
        """Find the scales of a problem, O(n) beyond two products with the compliance.

        Parameters
        ----------
        separation
            From first contact (n) [mm].
        lever_arm
            Of the normals about the gear axis (n) [mm].
        torque
            About the gear axis [N mm].
        compliance
            C [mm/N].
        rotation, remainder
            Of first contact and what it lacks by rounding [rad].
        """
        size, arm, diagonal = lever_arm.size, lever_arm, compliance.diagonal
        positive = arm > 0.0
        estimate = _winkler_force(separation, arm, _winkler_stiffness(compliance), positive, torque)
        active = estimate > 0.0
        active_count = max(int(np.count_nonzero(active)), 1)

        unit = power_of_two(float(diagonal.sum()) / size)
        mean_positive_arm = float(arm[positive].sum()) / int(np.count_nonzero(positive))
        force = torque / (mean_positive_arm * active_count)
        largest = float(np.abs(separation).max())
        if force == 0.0:  # no load: let the separations set the scale
            force = largest / unit
        elif not diagonal.any():  # no compliance: likewise
            unit = power_of_two(largest / force)

        limit = np.full(size, math.inf)
        if torque > 0.0 and separation.min() >= 0.0:
            energy = float(estimate @ (0.5 * compliance.deflection(estimate) + separation))
            if SAFE_ENERGY_RANGE[0] < energy < SAFE_ENERGY_RANGE[1]:
                limit = np.sqrt((2.0 * CLIP_MARGIN**2 * energy) * diagonal)
                limit += np.maximum(arm, 0.0) * (2.0 * CLIP_MARGIN * energy / torque)
        return cls(
            power_of_two(force),
            unit,
            power_of_two(float(np.abs(arm).sum()) / size),
            rotation,
            remainder,
            active,
            limit,
            separation > limit,
        )

    @property
    def gap(self) -> float:
        """Scale of gaps [mm]."""
        return self.force * self.compliance

    @property
    def rotation(self) -> float:
        """Scale of rotations [rad]."""
        return self.gap / self.lever_arm

    def scale(
        self, separation: Array, lever_arm: Array, torque: float, compliance: ComplianceMatrix, *, clip: bool = True
    ) -> ScaledProblem:
        """Return the data of a problem, see `of`, in scaled numbers; clipping lowers only what cannot matter."""
        if clip:
            separation = np.minimum(separation, self.separation_limit)
        given: Array | ScaledModes | ScaledOperator
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            if isinstance(compliance, ModalCompliance):
                given = ScaledModes(compliance, self.compliance)
            elif isinstance(compliance, OperatorCompliance):
                given = ScaledOperator(compliance, self.compliance)
            else:
                given = compliance.dense * (1.0 / self.compliance)
            return ScaledProblem(
                given,
                separation / self.gap,
                lever_arm * (1.0 / self.lever_arm),
                torque / self.lever_arm / self.force,
            )

    def unscale(self, force: Array, rotation: float) -> tuple[Array, float]:
        """Return forces [N] and rotation [rad] from their scaled values."""
        beyond = self.first_contact_remainder + self.unscale_elastic_rotation(rotation)
        return self.unscale_force(force), self.first_contact_rotation + beyond

    def unscale_force(self, force: Array) -> Array:
        """Return forces [N]; what rounding left on segments that are certainly open is removed."""
        unscaled = np.asarray(force, dtype=np.float64) * self.force
        unscaled[self.certainly_open] = 0.0
        return unscaled

    def unscale_elastic_rotation(self, rotation: float) -> float:
        """Return the rotation beyond first contact [rad]."""
        return float(rotation) * self.rotation


def power_of_two(value: float) -> float:
    """Return the power of two nearest to a positive number in ratio; 1 if it is zero or not finite."""
    if not (0.0 < value < math.inf):
        return 1.0
    return math.ldexp(1.0, round(math.log2(value)))


def _winkler_stiffness(compliance: ComplianceMatrix) -> Array:
    """Stiffness of each segment if it were a spring of its own [N/mm], (n)."""
    row_sum = compliance.deflection(np.ones(compliance.diagonal.size))
    own = np.maximum(WINKLER_ROW_SUM_FRACTION * row_sum, compliance.diagonal)
    largest = float(own.max())
    return 1.0 / np.maximum(own, 1e-12 * largest) if largest > 0.0 else np.ones(own.size)


def _winkler_force(
    separation: Array,
    lever_arm: Array,
    stiffness: Array,
    positive: NDArray[np.bool_],
    torque: float,
) -> Array:
    """Forces on a bed of uncoupled springs that balance the torque [N], (n): exact, by sorting the first contacts."""
    index = np.flatnonzero(positive)
    arm = lever_arm[index]
    contact_rotation = separation[index] / arm
    order = np.argsort(contact_rotation, kind="stable")
    index, arm, contact_rotation = index[order], arm[order], contact_rotation[order]
    weight = stiffness[index] * arm
    # With the first m springs in contact, the torque is theta sum(k r^2) - sum(k r S).
    rotation = (torque + np.cumsum(weight * separation[index])) / np.cumsum(weight * arm)
    closed = np.flatnonzero(rotation[:-1] <= contact_rotation[1:])
    count = int(closed[0]) + 1 if closed.size else index.size
    force = np.zeros(separation.size)
    loaded = index[:count]
    force[loaded] = np.maximum(rotation[count - 1] * arm[:count] - separation[loaded], 0.0) * stiffness[loaded]
    moment = float(force @ lever_arm)
    return force * (torque / moment) if moment > 0.0 else force
