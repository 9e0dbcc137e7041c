"""Load-based scaling of the contact problem: every number of order one, whatever the torque and the units.

Optimisation codes stop on absolute tolerances. In N, mm and N mm these are meaningless: several well-known solvers
then report success with loads wrong by half. The scaling here does four things.

1. *Shift.* The rotation is counted from the first contact of the rigid bodies, so that large separations cancel
   before they meet small deflections.
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
from numpy.typing import NDArray

if TYPE_CHECKING:
    import qpsolvers

    from .contact_problem import ContactProblem
    from .modal_basis import ModalBasis

#: A row sum of the compliance overstates the stiffness a segment feels, since its neighbours carry less further out.
WINKLER_ROW_SUM_FRACTION = 0.4
#: Margin on the bound above, well over rounding.
CLIP_MARGIN = 2.0
#: Energies [N mm] outside this range are near underflow or overflow: then nothing is clipped.
SAFE_ENERGY = (1e-200, 1e200)


@dataclass(frozen=True, eq=False)
class ScaledPair:
    """The compliance diag(d) + V V^T of a problem in another unit; nothing is formed before it is asked for.

    Attributes
    ----------
    problem : ContactProblem
        A structured one.
    unit : float
        [mm/N].
    """

    problem: ContactProblem
    unit: float

    @property
    def dense(self) -> NDArray[np.float64]:
        """C, (n, n)."""
        return self.problem.dense_compliance * (1.0 / self.unit)

    @cached_property
    def diagonal(self) -> NDArray[np.float64]:
        """Local compliance d, (n)."""
        return self.problem.compliance[0] * (1.0 / self.unit)

    @cached_property
    def factor(self) -> NDArray[np.float64]:
        """V, (n, k): C = diag(d) + w V V^T with the weight w."""
        return self.problem.compliance[1] * (1.0 / self._root)

    @property
    def compressed_factor(self) -> NDArray[np.float64]:
        """V in as few columns as it has directions, (n, r)."""
        return self.modal_basis.factor * (1.0 / self._root)

    @property
    def weight(self) -> float:
        """Weight w of the factor, one or one half: the root of a power of two may be none, and no bit shall be lost."""
        return self._root * (self._root / self.unit)

    @property
    def _root(self) -> float:
        return math.ldexp(1.0, (math.frexp(self.unit)[1] - 1) // 2)

    @property
    def whole_diagonal(self) -> NDArray[np.float64]:
        """Diagonal of C, (n)."""
        return self.problem.compliance_diagonal * (1.0 / self.unit)

    @property
    def mode_count(self) -> int:
        """Columns of V."""
        return int(self.problem.compliance[1].shape[1])

    @property
    def is_compressed(self) -> bool:
        """Whether the compressed V is known already."""
        return "modal_basis" in vars(self.problem)

    @property
    def modal_basis(self) -> ModalBasis:
        """V compressed by blocks, in the unit of the problem."""
        basis = self.problem.modal_basis
        assert basis is not None
        return basis

    @property
    def mode_unit(self) -> float:
        """Factor that brings the modes to the unit of the pair."""
        return 1.0 / math.sqrt(self.unit)


@dataclass(frozen=True, eq=False)
class ScaledProblem:
    """A contact problem in scaled numbers: minimise 1/2 F'CF + S'F subject to r'F = T, F >= 0.

    Attributes
    ----------
    given_compliance : (n, n) array, or ScaledPair
        Mean diagonal of order one.
    separation : (n) array
        Counted from first contact and clipped.
    lever_arm : (n) array
        Mean of order one.
    torque : float
        Of the order of the number of segments in contact.
    """

    given_compliance: NDArray[np.float64] | ScaledPair
    separation: NDArray[np.float64]
    lever_arm: NDArray[np.float64]
    torque: float

    @cached_property
    def compliance(self) -> NDArray[np.float64]:
        """C as an (n, n) array."""
        given = self.given_compliance
        return given.dense if isinstance(given, ScaledPair) else given

    @property
    def pair(self) -> ScaledPair | None:
        """The compliance as diagonal and factor, if it was given so."""
        return self.given_compliance if isinstance(self.given_compliance, ScaledPair) else None

    @property
    def is_finite(self) -> bool:
        """Whether no number has overflowed."""
        # No entry of a positive semidefinite matrix exceeds its diagonal.
        compliance = self.compliance if self.pair is None else self.pair.whole_diagonal
        return bool(np.isfinite(self.separation).all() and np.isfinite(compliance).all() and math.isfinite(self.torque))

    def as_qp(self, *, sparse: bool = False) -> qpsolvers.Problem:
        """Return the qpsolvers problem, with csc matrices if `sparse`."""
        import qpsolvers  # imports every installed solver: half a second, paid only here

        matrix: Any = self.compliance
        row: Any = self.lever_arm[np.newaxis, :]
        if sparse:
            from scipy.sparse import csc_matrix

            matrix, row = csc_matrix(matrix), csc_matrix(row)
        return qpsolvers.Problem(
            matrix, self.separation, A=row, b=np.array([self.torque]), lb=np.zeros(self.separation.size)
        )


@dataclass(frozen=True, eq=False, slots=True)
class Scaling:
    """The scales of one contact problem, and what was learnt in finding them.

    Attributes
    ----------
    force, compliance, lever_arm : float
        Scales [N], [mm/N], [mm], each a power of two.
    first_contact_rotation : float
        Rotation at which the rigid bodies touch [rad]; scaled rotations count from here.
    estimated_active : (n) bool array
        Segments in contact on the Winkler bed: a starting set for active-set methods.
    separation_limit : (n) array
        Separation from first contact [mm] above which a segment provably stays open; infinite where there is no such
        proof (segments with a negative separation from first contact, zero torque).
    certainly_open : (n) bool array
        Segments beyond that limit.
    """

    force: float
    compliance: float
    lever_arm: float
    first_contact_rotation: float
    estimated_active: NDArray[np.bool_]
    separation_limit: NDArray[np.float64]
    certainly_open: NDArray[np.bool_]

    @classmethod
    def of(cls, problem: ContactProblem) -> Scaling:
        """Find the scales of a problem, O(n) beyond two products with the compliance."""
        size, arm, torque = problem.size, problem.lever_arm, problem.torque
        separation, diagonal = problem.separation_at_first_contact, problem.compliance_diagonal
        positive = arm > 0.0
        estimate = _winkler_force(separation, arm, _winkler_stiffness(problem), positive, torque)
        active = estimate > 0.0
        active_count = max(int(np.count_nonzero(active)), 1)

        compliance = power_of_two(float(diagonal.sum()) / size)
        mean_positive_arm = float(arm[positive].sum()) / int(np.count_nonzero(positive))
        force = torque / (mean_positive_arm * active_count)
        if force == 0.0:  # no load: let the separations set the scale
            force = float(np.abs(separation).max()) / compliance

        limit = np.full(size, math.inf)
        if torque > 0.0 and separation.min() >= 0.0:
            energy = float(estimate @ (0.5 * problem.deflection(estimate) + separation))
            if SAFE_ENERGY[0] < energy < SAFE_ENERGY[1]:
                limit = np.sqrt((2.0 * CLIP_MARGIN**2 * energy) * diagonal)
                limit += np.maximum(arm, 0.0) * (2.0 * CLIP_MARGIN * energy / torque)
        return cls(
            power_of_two(force),
            compliance,
            power_of_two(float(np.abs(arm).sum()) / size),
            problem.first_contact_rotation,
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

    def scale(self, problem: ContactProblem, *, clip: bool = True) -> ScaledProblem:
        """Return the problem in scaled numbers; clipping lowers only separations that cannot matter."""
        separation = problem.separation_at_first_contact
        if clip:
            separation = np.minimum(separation, self.separation_limit)
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            return ScaledProblem(
                (
                    ScaledPair(problem, self.compliance)
                    if problem.is_structured
                    else problem.dense_compliance * (1.0 / self.compliance)
                ),
                separation / self.gap,
                problem.lever_arm * (1.0 / self.lever_arm),
                problem.torque / self.lever_arm / self.force,
            )

    def unscale(self, force: NDArray[np.float64], rotation: float) -> tuple[NDArray[np.float64], float]:
        """Return forces [N] and rotation [rad] from their scaled values."""
        return self.unscale_force(force), self.first_contact_rotation + self.unscale_elastic_rotation(rotation)

    def unscale_force(self, force: NDArray[np.float64]) -> NDArray[np.float64]:
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


def _winkler_stiffness(problem: ContactProblem) -> NDArray[np.float64]:
    """Stiffness of each segment if it were a spring of its own [N/mm], (n)."""
    row_sum = problem.deflection(np.ones(problem.size))
    own = np.maximum(WINKLER_ROW_SUM_FRACTION * row_sum, problem.compliance_diagonal)
    largest = float(own.max())
    return 1.0 / np.maximum(own, 1e-12 * largest) if largest > 0.0 else np.ones(problem.size)


def _winkler_force(
    separation: NDArray[np.float64],
    lever_arm: NDArray[np.float64],
    stiffness: NDArray[np.float64],
    positive: NDArray[np.bool_],
    torque: float,
) -> NDArray[np.float64]:
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
