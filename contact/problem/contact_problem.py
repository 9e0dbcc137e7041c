"""The contact problem of one mesh position: who touches, with what load, at what rotation.

The segments of all potential contact lines form one vector. Given their separation S, lever arm r and compliance C,
find the normal forces F and the rotation theta of the gear such that

    Y = C F + S - r theta >= 0,    F >= 0,    F'Y = 0,    r'F = T

(Kolivand 2009, Eq. 3.12-3.14, after Conry and Seireg 1971). These are the optimality conditions of the convex programme

    minimise 1/2 F'C F + S'F   subject to   r'F = T,  F >= 0,

whose equality multiplier is theta and whose bound multipliers are the gaps Y.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.errors import InputError
from .problem_dataset import problem_data, problem_to_dataset
from .scaling import Scaling
from .validation import (
    compliance_array,
    finite_array,
    nonnegative_torque,
    read_only,
    segment_array,
    structured_compliance,
    symmetric_compliance,
)

if TYPE_CHECKING:
    import qpsolvers

    from .modal_basis import ModalBasis

#: Smallest eigenvalue of C, relative to the largest, that is still taken for a rounded zero.
NEGATIVE_EIGENVALUE_TOLERANCE = 1e-12


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """Separation, lever arm, torque and compliance of the segments of one mesh position.

    Parameters
    ----------
    separation : (n) array
        Normal gap S of each segment, unloaded, at zero rotation [mm].
    lever_arm : (n) array
        Lever arm r of the contact normal about the gear axis [mm]: dY/dtheta = -r. At least one must be positive.
    torque : float
        Torque T about the gear axis [N mm], not negative.
    compliance : (n, n) array, or pair of an (n) and an (n, k) array
        C [mm/N], symmetric and positive semidefinite; or the pair (d, V) that stands for C = diag(d) + V V^T, d >= 0.

    Raises
    ------
    InputError
        A wrong shape, a number that is not finite, a negative torque, no positive lever arm, an asymmetric compliance
        or a negative diagonal.

    Notes
    -----
    The arrays are copied and made read-only. An asymmetry of the size of rounding is averaged out.

    Examples
    --------
    >>> import numpy as np
    >>> problem = ContactProblem(np.zeros(2), np.array([40.0, 40.0]), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> problem.size
    2
    """

    separation: NDArray[np.float64]
    lever_arm: NDArray[np.float64]
    torque: float
    compliance: NDArray[np.float64] | tuple[NDArray[np.float64], NDArray[np.float64]]

    def __post_init__(self) -> None:
        separation = finite_array(self.separation, "separation", 1)
        if separation.size == 0:
            raise InputError("separation is empty: a contact problem has at least one segment")
        lever_arm = segment_array(self.lever_arm, "lever_arm", separation.size)
        if lever_arm.max() <= 0.0:
            raise InputError("lever_arm has no positive entry: no segment can carry the torque")
        given: Any = self.compliance
        is_pair = (
            isinstance(given, tuple | list) and len(given) == 2 and np.ndim(given[0]) == 1 and np.ndim(given[1]) == 2
        )
        check = structured_compliance if is_pair else symmetric_compliance
        object.__setattr__(self, "separation", separation)
        object.__setattr__(self, "lever_arm", lever_arm)
        object.__setattr__(self, "torque", nonnegative_torque(self.torque))
        object.__setattr__(self, "compliance", check(given, separation.size))

    @classmethod
    def of_modes(
        cls,
        separation: NDArray[np.float64],
        lever_arm: NDArray[np.float64],
        torque: float,
        local: NDArray[np.float64],
        basis: ModalBasis,
    ) -> ContactProblem:
        """Return the problem with C = diag(local) + U U^T, the factor U being compressed already.

        Parameters
        ----------
        separation, lever_arm, torque
            As of the class.
        local : (n) array
            Compliance of each segment by itself [mm/N], not negative.
        basis : ModalBasis
            Blocks of U.
        """
        problem = cls(separation, lever_arm, torque, (local, basis.factor))
        vars(problem)["modal_basis"] = basis  # what the cached property would find anew
        return problem

    @property
    def size(self) -> int:
        """Number of segments n."""
        return int(self.separation.size)

    @property
    def is_structured(self) -> bool:
        """Whether the compliance is the pair (diagonal, factor)."""
        return isinstance(self.compliance, tuple)

    @cached_property
    def dense_compliance(self) -> NDArray[np.float64]:
        """C as an (n, n) array [mm/N]."""
        if not isinstance(self.compliance, tuple):
            return self.compliance
        diagonal, factor = self.compliance
        dense = factor @ factor.T
        dense[np.diag_indices_from(dense)] += diagonal
        return read_only(dense)

    @cached_property
    def compliance_diagonal(self) -> NDArray[np.float64]:
        """Diagonal of C [mm/N], (n)."""
        if isinstance(self.compliance, tuple):
            diagonal, factor = self.compliance
            return read_only(diagonal + np.einsum("ij,ij->i", factor, factor))
        return read_only(self.compliance.diagonal().copy())

    @cached_property
    def local_fraction(self) -> float:
        """Least part that a segment's own compliance d has in the whole, min d_i / C_ii; zero if C is dense."""
        if not isinstance(self.compliance, tuple):
            return 0.0
        whole = self.compliance_diagonal
        return float((self.compliance[0] / whole).min()) if whole.min() > 0.0 else 0.0

    @cached_property
    def modal_basis(self) -> ModalBasis | None:
        """The factor of a structured compliance, compressed by blocks; None if the compliance is dense."""
        from .modal_basis import modal_basis  # the rest of this module needs no scipy

        return modal_basis(self.compliance[1]) if isinstance(self.compliance, tuple) else None

    @property
    def first_contact_rotation(self) -> float:
        """Rotation at which the rigid bodies touch first, min S/r over r > 0 [rad]: theta as the torque vanishes."""
        return self._first_contact[0]

    @property
    def separation_at_first_contact(self) -> NDArray[np.float64]:
        """S - r theta at first contact [mm], (n). Not negative where r > 0; computed so that this holds to the bit."""
        return self._first_contact[1]

    @cached_property
    def _first_contact(self) -> tuple[float, NDArray[np.float64]]:
        positive = (self.lever_arm > 0.0).nonzero()[0]
        rotation = self.separation[positive] / self.lever_arm[positive]
        first = int(rotation.argmin())
        shifted = self.separation - rotation[first] * self.lever_arm
        shifted[positive] = np.maximum(shifted[positive], 0.0)
        shifted[positive[first]] = 0.0
        return float(rotation[first]), read_only(shifted)

    @cached_property
    def is_positive_semidefinite(self) -> bool:
        """Whether C is positive semidefinite up to rounding, without which the problem is no minimum."""
        if self.is_structured:
            return True  # diag(d) + V V^T with d >= 0
        from scipy.linalg.lapack import dpotrf  # the rest of this module needs no scipy

        # The matrix is symmetric, so its transpose is the same matrix in the order LAPACK wants.
        if dpotrf(self.dense_compliance.T, lower=1, clean=0)[1] == 0:
            return True
        eigenvalues = np.linalg.eigvalsh(self.dense_compliance)
        return bool(eigenvalues[0] >= -NEGATIVE_EIGENVALUE_TOLERANCE * self.size * max(eigenvalues[-1], 0.0))

    @cached_property
    def scaling(self) -> Scaling:
        """The load-based scaling of this problem."""
        # Absurd data shall become a status, not a warning.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return Scaling.of(self)

    def deflection(self, force: NDArray[np.float64]) -> NDArray[np.float64]:
        """C F [mm], (n), in O(n k) when the compliance is structured."""
        if isinstance(self.compliance, tuple):
            diagonal, factor = self.compliance
            return diagonal * force + factor @ (force @ factor)
        return self.compliance @ force

    def gap(self, force: NDArray[np.float64], rotation: float) -> NDArray[np.float64]:
        """Y = C F + S - r theta [mm], (n), under the forces F [N] at the rotation theta [rad]."""
        elastic_rotation = rotation - self.first_contact_rotation
        return self.deflection(force) + self.separation_at_first_contact - elastic_rotation * self.lever_arm

    def with_torque(self, torque: float) -> ContactProblem:
        """Return the same segments under another torque [N mm]; what is known of the compliance is kept."""
        return self._changed(("scaling",), torque=nonnegative_torque(torque))

    def with_added_compliance(
        self, local: NDArray[np.float64], separation: NDArray[np.float64] | None = None
    ) -> ContactProblem:
        """Return the problem with a local compliance added to the diagonal.

        Parameters
        ----------
        local : (n) array
            Compliance of each segment by itself [mm/N], not negative.
        separation : (n) array, optional
            Another separation [mm].

        Raises
        ------
        InputError
            A wrong shape, a number that is not finite, a negative compliance.
        """
        local = compliance_array(local, "local compliance", self.size)
        if isinstance(self.compliance, tuple):
            compliance: Any = (read_only(self.compliance[0] + local), self.compliance[1])
        else:
            compliance = self.compliance.copy()
            compliance[np.diag_indices(self.size)] += local
            read_only(compliance)
        stale = ("scaling", "dense_compliance", "compliance_diagonal", "local_fraction", "is_positive_semidefinite")
        if separation is None:
            return self._changed(stale, compliance=compliance)
        separation = segment_array(separation, "separation", self.size)
        return self._changed((*stale, "_first_contact"), compliance=compliance, separation=separation)

    def _changed(self, stale: tuple[str, ...], **fields: Any) -> ContactProblem:
        """Return a copy with other fields, already checked, without the derived values that they make stale."""
        other = object.__new__(ContactProblem)
        vars(other).update({name: value for name, value in vars(self).items() if name not in stale} | fields)
        return other

    def as_qp(self, *, sparse: bool = False) -> qpsolvers.Problem:
        """Return the scaled problem for any solver behind qpsolvers.

        Parameters
        ----------
        sparse : bool
            Give the matrices in compressed sparse column form, as the sparse solvers want them.

        Returns
        -------
        qpsolvers.Problem
            Lower bounds zero and one equality, all numbers of order one. With a solution ``x`` and ``y``,
            ``problem.scaling.unscale(x, -y[0])`` gives forces and rotation: qpsolvers adds +y (A x - b), hence the
            sign.
        """
        return self.scaling.scale(self).as_qp(sparse=sparse)

    def identical(self, other: ContactProblem) -> bool:
        """Whether all data of two problems agree to the bit and in form."""
        return (
            self.torque == other.torque
            and self.is_structured == other.is_structured
            and all(np.array_equal(a, b) for a, b in zip(_arrays(self), _arrays(other), strict=True))
        )

    def to_dataset(self) -> xr.Dataset:
        """Return the problem as a Dataset with units, without loss: `from_dataset` gives the identical problem back."""
        return problem_to_dataset(self)

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> ContactProblem:
        """Rebuild a problem from `to_dataset`.

        Raises
        ------
        InputError
            The Dataset lacks a variable, or its data are no contact problem.
        """
        return cls(*problem_data(dataset))


def _arrays(problem: ContactProblem) -> tuple[NDArray[np.float64], ...]:
    parts = problem.compliance if isinstance(problem.compliance, tuple) else (problem.compliance,)
    return (problem.separation, problem.lever_arm, *parts)
