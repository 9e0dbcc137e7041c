"""The contact problem in scaled numbers, every one of order one: what solvers get.

Optimisation codes stop on absolute tolerances. In N, mm and N mm these are meaningless: several well-known solvers then
report success with loads wrong by half. The scaling here, by the load, does four things.

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
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ...core.arrays import Bools, RealArray as Array, record
from .compliance_matrix import ComplianceMatrix, ModalCompliance, OperatorCompliance
from .first_contact import FirstContact
from .modal_basis import ModalBasis, SharedModes

if TYPE_CHECKING:
    import qpsolvers


@dataclass(frozen=True, eq=False)
class _InUnit:
    """A compliance in another unit [mm/N], a power of two."""

    compliance: ModalCompliance | OperatorCompliance
    unit: float

    @property
    def dense(self) -> Array:
        """C, (n, n); `InputError` where only its products are known."""
        return self.compliance.dense * (1.0 / self.unit)

    @property
    def whole_diagonal(self) -> Array:
        """Diagonal of C, (n)."""
        return self.compliance.diagonal * (1.0 / self.unit)


@dataclass(frozen=True, eq=False)
class ScaledModes(_InUnit):
    """The compliance diag(d) + V V^T in another unit [mm/N], a power of two; formed only when asked for."""

    compliance: ModalCompliance

    @cached_property
    def diagonal(self) -> Array:
        """Local compliance d, (n)."""
        return self.compliance.local * (1.0 / self.unit)

    @cached_property
    def factor(self) -> Array:
        """V, (n, k): C = diag(d) + w V V^T with the weight w."""
        return self.compliance.factor * (1.0 / self._root)

    @property
    def compressed_factor(self) -> Array:
        """V in as few columns as it has directions, (n, r)."""
        return self.compliance.modes.basis.factor * (1.0 / self._root)

    @property
    def weight(self) -> float:
        """Weight w of the factor, one or one half: the root of a power of two may be none, and no bit shall be lost."""
        return self._root * (self._root / self.unit)

    @property
    def _root(self) -> float:
        return math.ldexp(1.0, (math.frexp(self.unit)[1] - 1) // 2)

    @property
    def mode_count(self) -> int:
        """Columns of V."""
        return int(self.compliance.factor.shape[1])

    @property
    def basis(self) -> ModalBasis:
        """V compressed by blocks, scaled: with weight one."""
        given, scale = self.compliance.modes.basis, 1.0 / math.sqrt(self.unit)
        shared = given.shared and SharedModes(given.shared.columns, given.shared.mixing * scale)
        return ModalBasis(given.size, given.index, given.modes * scale, shared)


@dataclass(frozen=True, eq=False)
class ScaledOperator(_InUnit):
    """A compliance known by its products alone, in another unit [mm/N], a power of two."""

    compliance: OperatorCompliance

    def deflection(self, force: Array) -> Array:
        """C F, (n)."""
        return self.compliance.deflection(force) * (1.0 / self.unit)


@dataclass(frozen=True, eq=False)
class ScaledProblem:
    """A contact problem in scaled numbers: minimise 1/2 F'CF + S'F subject to r'F = T, F >= 0.

    Mean diagonal of C and mean of r are of order one, T of the order of the number of segments in contact.
    """

    given_compliance: Array | ScaledModes | ScaledOperator
    separation: Array  # from first contact, clipped (n)
    lever_arm: Array
    torque: float

    @cached_property
    def compliance(self) -> Array:
        """C as an (n, n) array; `InputError` where only its products are known."""
        given = self.given_compliance
        return given if isinstance(given, np.ndarray) else given.dense

    @property
    def modal(self) -> ScaledModes | None:
        """The compliance as local part and modes, if it was given so."""
        return self.given_compliance if isinstance(self.given_compliance, ScaledModes) else None

    @property
    def has_matrix(self) -> bool:
        """True if C can be had as an array."""
        return not isinstance(self.given_compliance, ScaledOperator)

    def deflection(self, force: Array) -> Array:
        """C F, (n), in O(n k) of a structured compliance."""
        given = self.given_compliance
        if isinstance(given, ScaledModes):
            return given.diagonal * force + given.weight * (given.factor @ (force @ given.factor))
        return given @ force if isinstance(given, np.ndarray) else given.deflection(force)

    @property
    def is_finite(self) -> bool:
        """True if no number has overflowed."""
        # No entry of a positive semidefinite matrix exceeds its diagonal.
        given = self.given_compliance
        compliance = given if isinstance(given, np.ndarray) else given.whole_diagonal
        return bool(np.isfinite(self.separation).all() and np.isfinite(compliance).all() and math.isfinite(self.torque))

    def as_products(self) -> qpsolvers.Problem:
        """Return the qpsolvers problem with P as a `scipy.sparse.linalg.LinearOperator`."""
        import qpsolvers
        from scipy.sparse.linalg import LinearOperator

        size = self.separation.size
        product: Any = LinearOperator((size, size), dtype=np.float64, matvec=lambda x: self.deflection(x.ravel()))
        row, torque = self.lever_arm[np.newaxis, :].copy(), np.array([self.torque])
        return qpsolvers.Problem(product, self.separation.copy(), A=row, b=torque, lb=np.zeros(size))

    def as_qp(self, *, sparse: bool = False) -> qpsolvers.Problem:
        """Return the qpsolvers problem, with csc matrices if `sparse`."""
        import qpsolvers  # imports every installed solver: half a second, paid only here

        matrix: Any = self.compliance
        row: Any = self.lever_arm[np.newaxis, :]
        if sparse:
            from scipy.sparse import csc_matrix

            matrix, row = csc_matrix(matrix), csc_matrix(row)
        right, lower = np.array([self.torque]), np.zeros(self.separation.size)
        return qpsolvers.Problem(matrix, self.separation, A=row, b=right, lb=lower)


#: A row sum of the compliance overstates the stiffness a segment feels, since its neighbours carry less further out.
WINKLER_ROW_SUM_FRACTION = 0.4
#: Margin on the bound above, well over rounding.
CLIP_MARGIN = 2.0
#: Energies [N mm] outside this range are near underflow or overflow: then nothing is clipped.
SAFE_ENERGY_RANGE = (1e-200, 1e200)


class Units:
    """Units of gaps and rotations that follow from those of force [N], compliance [mm/N] and lever arm [mm]."""

    __slots__ = ()
    force: float
    compliance: float
    lever_arm: float

    @property
    def gap(self) -> float:
        """Unit of gaps and separations [mm]."""
        return self.force * self.compliance

    @property
    def rotation(self) -> float:
        """Unit of rotations [rad]."""
        return self.gap / self.lever_arm


@record(frozen=True, eq=False, slots=True)
class Scaling(Units):
    """Scales of force [N], compliance [mm/N] and lever arm [mm], powers of two, and findings on the way."""

    force: float
    compliance: float
    lever_arm: float
    first_contact: FirstContact  # scaled rotations count from here
    estimated_active: Bools  # in contact on the Winkler bed (n)
    separation_limit: Array  # (n) [mm], above it provably open; infinite where there is no proof
    certainly_open: Bools

    @classmethod
    def of(cls, first: FirstContact, lever_arm: Array, torque: float, compliance: ComplianceMatrix) -> Scaling:
        """Scales of a problem, O(n) beyond two products with C."""
        separation, arm, size, diagonal = first.separation, lever_arm, lever_arm.size, compliance.diagonal
        positive = arm > 0.0
        estimate = _winkler_force(separation, arm, _winkler_stiffness(compliance), torque)
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
        mean_arm = power_of_two(float(np.abs(arm).sum()) / size)
        return cls(power_of_two(force), unit, mean_arm, first, active, limit, separation > limit)

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
            moment = torque / self.lever_arm / self.force
            return ScaledProblem(given, separation / self.gap, lever_arm * (1.0 / self.lever_arm), moment)

    def unscale(self, force: Array, rotation: float) -> tuple[Array, float]:
        """Return forces [N] and rotation [rad] from their scaled values."""
        return self.unscale_force(force), self.first_contact.whole_rotation(self.unscale_elastic_rotation(rotation))

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
    return math.ldexp(1.0, round(math.log2(value))) if 0.0 < value < math.inf else 1.0


def _winkler_stiffness(compliance: ComplianceMatrix) -> Array:
    """Stiffness of each segment if it were a spring of its own [N/mm], (n)."""
    row_sum = compliance.deflection(np.ones(compliance.diagonal.size))
    spring_compliance = np.maximum(WINKLER_ROW_SUM_FRACTION * row_sum, compliance.diagonal)
    largest = float(spring_compliance.max())
    return 1.0 / np.maximum(spring_compliance, 1e-12 * largest) if largest > 0.0 else np.ones(spring_compliance.size)


def _winkler_force(separation: Array, lever_arm: Array, stiffness: Array, torque: float) -> Array:
    """Forces on a bed of uncoupled springs that balance the torque [N], (n): exact, by sorting the first contacts."""
    index = np.flatnonzero(lever_arm > 0.0)
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
