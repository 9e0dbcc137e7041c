"""The contact problem of one mesh position: who touches, with what load, at what rotation.

The segments of all potential contact lines form one vector. Given their separation S, lever arm r and compliance C, find the
normal forces F and the rotation theta of the gear such that

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

from ..core.errors import InputError
from .scaling import Scaling

if TYPE_CHECKING:
    import qpsolvers

FORMAT = "easeoff contact problem"
FORMAT_VERSION = 1

#: Largest difference between C and its transpose, relative to the largest entry, that is taken for rounding.
ASYMMETRY_TOLERANCE = 1e-10
#: Smallest eigenvalue of C, relative to the largest, that is still taken for a rounded zero.
NEGATIVE_EIGENVALUE_TOLERANCE = 1e-12

#: Units and meaning of every variable of a stored problem.
ATTRIBUTES: dict[str, dict[str, str]] = {
    "separation": {"units": "mm", "long_name": "normal gap of the unloaded segments at zero rotation"},
    "lever_arm": {"units": "mm", "long_name": "lever arm of the contact normal about the gear axis"},
    "torque": {"units": "N mm", "long_name": "torque about the gear axis"},
    "compliance": {"units": "mm/N", "long_name": "normal deflection of a segment by a unit force on another"},
    "compliance_diagonal": {"units": "mm/N", "long_name": "diagonal part d of the compliance diag(d) + V V^T"},
    "compliance_factor": {"units": "(mm/N)^0.5", "long_name": "factor V of the compliance diag(d) + V V^T"},
}


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
        A wrong shape, a number that is not finite, a negative torque, no positive lever arm, an asymmetric compliance or
        a negative diagonal.

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
        separation = _finite_array(self.separation, "separation", 1)
        lever_arm = _finite_array(self.lever_arm, "lever_arm", 1)
        if separation.size == 0:
            raise InputError("separation is empty: a contact problem has at least one segment")
        if lever_arm.size != separation.size:
            raise InputError(f"lever_arm has {lever_arm.size} segments but separation has {separation.size}")
        if not (lever_arm > 0.0).any():
            raise InputError("lever_arm has no positive entry: no segment can carry the torque")
        torque = _torque(self.torque)
        if isinstance(self.compliance, tuple | list) and len(self.compliance) == 2 and np.ndim(self.compliance[0]) == 1:
            compliance: Any = _structured_compliance(self.compliance[0], self.compliance[1], separation.size)
        else:
            compliance = _symmetric_compliance(self.compliance, separation.size)
        for name, value in (("separation", separation), ("lever_arm", lever_arm), ("compliance", compliance)):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "torque", torque)

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
        dense.setflags(write=False)
        return dense

    @cached_property
    def compliance_diagonal(self) -> NDArray[np.float64]:
        """Diagonal of C [mm/N], (n)."""
        if isinstance(self.compliance, tuple):
            diagonal, factor = self.compliance
            return diagonal + np.einsum("ij,ij->i", factor, factor)
        return self.compliance.diagonal()

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
        shifted.setflags(write=False)
        return float(rotation[first]), shifted

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
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # absurd data become a status, not a warning
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
        other = object.__new__(ContactProblem)
        vars(other).update({name: value for name, value in vars(self).items() if name != "scaling"})
        object.__setattr__(other, "torque", _torque(torque))
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
            ``problem.scaling.unscale(x, -y[0])`` gives forces and rotation: qpsolvers adds +y (A x - b), hence the sign.
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
        variables: dict[str, tuple[tuple[str, ...], Any]] = {
            "separation": (("segment",), self.separation),
            "lever_arm": (("segment",), self.lever_arm),
            "torque": ((), self.torque),
        }
        if isinstance(self.compliance, tuple):
            variables["compliance_diagonal"] = (("segment",), self.compliance[0])
            variables["compliance_factor"] = (("segment", "mode"), self.compliance[1])
        else:
            variables["compliance"] = (("segment", "segment_other"), self.compliance)
        return xr.Dataset(
            {name: (dims, np.array(value), ATTRIBUTES[name]) for name, (dims, value) in variables.items()},
            attrs={"format": FORMAT, "format_version": FORMAT_VERSION},
        )

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> ContactProblem:
        """Rebuild a problem from `to_dataset`.

        Raises
        ------
        InputError
            The Dataset lacks a variable, or its data are no contact problem.
        """
        structured = "compliance" not in dataset and "compliance_factor" in dataset
        compliance_names = ("compliance_diagonal", "compliance_factor") if structured else ("compliance",)
        missing = [n for n in ("separation", "lever_arm", "torque", *compliance_names) if n not in dataset]
        if missing:
            raise InputError(f"no contact problem in this Dataset: it lacks {', '.join(missing)}")
        parts = [dataset[name].to_numpy() for name in compliance_names]
        return cls(
            dataset["separation"].to_numpy(),
            dataset["lever_arm"].to_numpy(),
            dataset["torque"].to_numpy()[()],
            (parts[0], parts[1]) if structured else parts[0],
        )


def _arrays(problem: ContactProblem) -> tuple[NDArray[np.float64], ...]:
    parts = problem.compliance if isinstance(problem.compliance, tuple) else (problem.compliance,)
    return (problem.separation, problem.lever_arm, *parts)


def _finite_array(value: Any, name: str, ndim: int) -> NDArray[np.float64]:
    """Return a read-only float64 copy of `value`, or say what is wrong with it."""
    try:
        array = np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is not an array of numbers: {error}") from error
    if array.ndim != ndim:
        raise InputError(f"{name} has {array.ndim} dimensions, expected {ndim}")
    if not np.isfinite(array).all():
        raise InputError(f"{name} has {np.count_nonzero(~np.isfinite(array))} entries that are not finite")
    array.setflags(write=False)
    return array


def _torque(value: Any) -> float:
    torque = float(_finite_array(value, "torque", 0))
    if torque < 0.0:
        raise InputError(f"torque is {torque:g} N mm: it must not be negative (reverse the lever arms for the other flank)")
    return torque


def _structured_compliance(diagonal: Any, factor: Any, size: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    diagonal = _finite_array(diagonal, "compliance diagonal", 1)
    factor = _finite_array(factor, "compliance factor", 2)
    if diagonal.size != size or factor.shape[0] != size:
        raise InputError(
            f"compliance has a diagonal of {diagonal.size} and a factor of {factor.shape[0]} rows for {size} segments"
        )
    if (diagonal < 0.0).any():
        raise InputError(f"compliance diagonal has a negative entry ({diagonal.min():g} mm/N)")
    return diagonal, factor


def _symmetric_compliance(value: Any, size: int) -> NDArray[np.float64]:
    compliance = _finite_array(value, "compliance", 2)
    if compliance.shape != (size, size):
        raise InputError(f"compliance has the shape {compliance.shape}, expected ({size}, {size})")
    if (compliance.diagonal() < 0.0).any():
        raise InputError(f"compliance has a negative diagonal entry ({compliance.diagonal().min():g} mm/N)")
    if np.array_equal(compliance, compliance.T):
        return compliance
    asymmetry = float(np.abs(compliance - compliance.T).max()) / float(np.abs(compliance).max())
    if asymmetry > ASYMMETRY_TOLERANCE:
        raise InputError(
            f"compliance is not symmetric (relative difference {asymmetry:.1e}): by reciprocity it must be, and solvers "
            "would read one triangle or the other"
        )
    compliance = 0.5 * (compliance + compliance.T)
    compliance.setflags(write=False)
    return compliance
