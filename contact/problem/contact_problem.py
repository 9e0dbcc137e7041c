"""The contact problem of one mesh position: segments in contact, their loads, and the rotation.

The segments of all potential contact lines form one vector. Given their separation S, lever arm r and compliance C,
find the normal forces F and the rotation theta of the gear such that

    Y = C F + S - r theta >= 0,    F >= 0,    F'Y = 0,    r'F = T

(Kolivand 2009, Eq. 3.12-3.14, after Conry and Seireg 1971). These are the optimality conditions of the convex programme

    minimise 1/2 F'C F + S'F   subject to   r'F = T,  F >= 0,

whose equality multiplier is theta and whose bound multipliers are the gaps Y.

As a Dataset, and in files, its numbers have the units and meanings of one table.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array, record
from ...core.checks import array
from ...core.errors import InputError
from .compliance_matrix import ComplianceMatrix, ModalCompliance, compliance_matrix
from .first_contact import FirstContact, first_contact
from .modal_basis import ModalBasis
from .scaled_problem import ScaledProblem, Scaling

if TYPE_CHECKING:
    import qpsolvers


FORMAT = "easeoff contact problem"
FORMAT_VERSION = 1

#: Dimensions, units and meaning of every variable of a stored problem.
VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "separation": (("segment",), "mm", "normal gap of the unloaded segments at zero rotation"),
    "lever_arm": (("segment",), "mm", "lever arm of the contact normal about the gear axis"),
    "torque": ((), "N mm", "torque about the gear axis"),
    "compliance": (("segment", "segment_other"), "mm/N", "normal deflection of a segment by a unit force on another"),
    "compliance_diagonal": (("segment",), "mm/N", "diagonal part d of the compliance diag(d) + V V^T"),
    "compliance_factor": (("segment", "mode"), "(mm/N)^0.5", "factor V of the compliance diag(d) + V V^T"),
}
DIMENSIONS = {name: dimensions for name, (dimensions, *_) in VARIABLES.items()}
ATTRIBUTES = {name: {"units": units, "long_name": meaning} for name, (_, units, meaning) in VARIABLES.items()}


def number_names(structured: bool) -> tuple[str, ...]:
    """Names of the numbers of a problem in files; its compliance is the pair (d, V), or one matrix."""
    compliance = ("compliance_diagonal", "compliance_factor") if structured else ("compliance",)
    return ("separation", "lever_arm", "torque", *compliance)


def problem_numbers(problem: ContactProblem) -> dict[str, Any]:
    """Numbers of a problem by name; `InputError` where only products of the compliance are known."""
    numbers = dict(zip(number_names(problem.is_structured), _given(problem), strict=True))
    return numbers if problem.is_structured else numbers | {"compliance": problem.dense_compliance}


def problem_of_numbers(numbers: Mapping[str, Any]) -> ContactProblem:
    """Return the problem of numbers by name, see `problem_numbers`."""
    separation, lever_arm, torque, *parts = (numbers[n] for n in number_names("compliance_factor" in numbers))
    return ContactProblem(separation, lever_arm, torque, tuple(parts) if len(parts) == 2 else parts[0])


@record(frozen=True, eq=False, init=False, repr=False)
class ContactProblem:
    """Separation, lever arm, torque and compliance of the segments of one mesh position.

    Parameters
    ----------
    separation
        Normal gap S of each segment (n), unloaded, at zero rotation [mm].
    lever_arm
        Lever arm r of the contact normal about the gear axis (n) [mm]: dY/dtheta = -r. At least one must be positive.
    torque
        Torque T about the gear axis [N mm], not negative.
    compliance
        C (n, n) [mm/N], symmetric and positive semidefinite; or the pair (d, V) of an (n) and an (n, k) array that
        stands for C = diag(d) + V V^T, d >= 0. C and V may be sparse, d a diagonal matrix (n, n), sparse or not, a V of
        one column (n), or a `ModalBasis`. A
        `scipy.sparse.linalg.LinearOperator` for V is multiplied out; one for C is not, see `OperatorCompliance`. A
        `ComplianceMatrix` is not copied.

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
    >>> problem
    ContactProblem: 2 segments, dense matrix, torque 80000 N mm
    """

    separation: Array
    lever_arm: Array
    torque: float
    compliance_matrix: ComplianceMatrix

    def __init__(self, separation: ArrayLike, lever_arm: ArrayLike, torque: float, compliance: Any) -> None:
        gap = array("separation", separation, "mm", ndim=1, fewest=1, frozen=True)
        arm = array("lever_arm", lever_arm, "mm", ndim=1, size=gap.size, frozen=True)
        if arm.max() <= 0.0:
            raise InputError("lever_arm: must have a positive entry, or no segment can carry the torque")
        object.__setattr__(self, "separation", gap)
        object.__setattr__(self, "lever_arm", arm)
        object.__setattr__(self, "torque", float(array("torque", torque, "N mm", ndim=0, least=0.0)))
        object.__setattr__(self, "compliance_matrix", compliance_matrix(compliance, gap.size))

    @classmethod
    def of_modes(
        cls, separation: ArrayLike, lever_arm: ArrayLike, torque: float, local: ArrayLike, basis: ModalBasis
    ) -> ContactProblem:
        """Return the problem with C = diag(local) + U U^T, the factor U being compressed already.

        Parameters
        ----------
        separation, lever_arm, torque
            As of the class.
        local
            Compliance of each segment by itself (n) [mm/N], not negative.
        basis
            Blocks of U.
        """
        return cls(separation, lever_arm, torque, ModalCompliance(_local(local, basis.size), basis))

    def __repr__(self) -> str:
        """Size, form of the compliance and torque, in one line."""
        segments = f"{self.size} segment{'' if self.size == 1 else 's'}"
        return f"ContactProblem: {segments}, {self.compliance_matrix}, torque {self.torque:.10g} N mm"

    @property
    def size(self) -> int:
        """Number of segments n."""
        return int(self.separation.size)

    @property
    def compliance(self) -> Any:
        """C [mm/N] as given: an (n, n) array, the pair of d (n) and V (n, k), or an `OperatorCompliance`."""
        return self.compliance_matrix.given

    @property
    def is_structured(self) -> bool:
        """True if the compliance is the pair (diagonal, factor)."""
        return isinstance(self.compliance_matrix, ModalCompliance)

    @property
    def dense_compliance(self) -> Array:
        """C as an (n, n) array [mm/N]; `InputError` where only its products are known."""
        return self.compliance_matrix.dense

    @property
    def compliance_diagonal(self) -> Array:
        """Diagonal of C [mm/N], (n)."""
        return self.compliance_matrix.diagonal

    @property
    def modal_basis(self) -> ModalBasis | None:
        """The factor of a structured compliance, compressed by blocks; None if the compliance is dense."""
        matrix = self.compliance_matrix
        return matrix.modes.basis if isinstance(matrix, ModalCompliance) else None

    @property
    def is_positive_semidefinite(self) -> bool:
        """True if C is positive semidefinite up to rounding, without which the problem is no minimum.

        Of a compliance known by its products alone this is assumed unless they show a negative eigenvalue.
        """
        return self.compliance_matrix.is_positive_semidefinite

    @cached_property
    def first_contact(self) -> FirstContact:
        """First contact of the rigid bodies: its rotation to twice the digits of a double, the separations there."""
        return first_contact(self.separation, self.lever_arm)

    @property
    def first_contact_rotation(self) -> float:
        """Rotation at which the rigid bodies touch first, min S/r over r > 0 [rad]: theta as the torque vanishes."""
        return self.first_contact.rotation

    @property
    def separation_at_first_contact(self) -> Array:
        """S - r theta at first contact [mm], (n), each rounded once, however large S and r theta are.

        Not negative where r > 0; computed so that this holds to the bit.
        """
        return self.first_contact.separation

    def whole_rotation(self, elastic_rotation: float) -> float:
        """Return the rotation theta [rad] of a rotation beyond first contact [rad], rounded."""
        return self.first_contact.whole_rotation(elastic_rotation)

    def elastic_rotation(self, rotation: float) -> float:
        """Return the rotation beyond first contact [rad] of a rotation theta [rad]."""
        contact = self.first_contact
        return (rotation - contact.rotation) - contact.remainder

    @cached_property
    def scaling(self) -> Scaling:
        """The load-based scaling of this problem."""
        # Overflow becomes a status, not a warning.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return Scaling.of(self.first_contact, self.lever_arm, self.torque, self.compliance_matrix)

    def scaled(self, *, clip: bool = True) -> ScaledProblem:
        """Return the problem in scaled numbers, see `scaling`.

        Parameters
        ----------
        clip
            Lower separations that are so large that they cannot matter.
        """
        data = (self.separation_at_first_contact, self.lever_arm, self.torque, self.compliance_matrix)
        return self.scaling.scale(*data, clip=clip)

    def deflection(self, force: Array) -> Array:
        """C F [mm], (n), in O(n k) when the compliance is structured."""
        return self.compliance_matrix.deflection(force)

    def gap(self, force: Array, rotation: float) -> Array:
        """Y = C F + S - r theta [mm], (n), under the forces F [N] at the rotation theta [rad]."""
        turned = self.elastic_rotation(rotation) * self.lever_arm
        return self.deflection(force) + self.separation_at_first_contact - turned

    def with_torque(self, torque: float) -> ContactProblem:
        """Return the same segments under another torque [N mm]; what is known of the compliance is kept."""
        return self._changed(float(array("torque", torque, "N mm", ndim=0, least=0.0)), self.compliance_matrix)

    def _changed(self, torque: float, matrix: ComplianceMatrix) -> ContactProblem:
        """The same segments under another torque or with another compliance, both checked already."""
        changed = object.__new__(ContactProblem)
        attributes = changed.__dict__  # frozen
        attributes["separation"], attributes["lever_arm"], attributes["torque"], attributes["compliance_matrix"] = (
            self.separation, self.lever_arm, torque, matrix,
        )  # fmt: skip
        if "first_contact" in self.__dict__:
            attributes["first_contact"] = self.__dict__["first_contact"]
        return changed

    def with_secant(self, secant: Array) -> ContactProblem:
        """Return the problem with the local compliance (n) [mm/N] that a solution was found with, on the diagonal."""
        return self._changed(self.torque, self.compliance_matrix.with_added(secant))

    def with_added_compliance(self, local: Array, separation: Array | None = None) -> ContactProblem:
        """Return the problem with a local compliance added to the diagonal.

        Parameters
        ----------
        local
            Compliance of each segment by itself (n) [mm/N], not negative.
        separation
            Another separation (n) [mm].

        Raises
        ------
        InputError
            A wrong shape, a number that is not finite, a negative compliance.
        """
        added = self.compliance_matrix.with_added(_local(local, self.size))
        if separation is None:
            return self._changed(self.torque, added)
        return ContactProblem(separation, self.lever_arm, self.torque, added)

    def as_qp(self, *, sparse: bool = False) -> qpsolvers.Problem:
        """Return the scaled problem for any solver behind qpsolvers.

        Parameters
        ----------
        sparse
            Give the matrices in compressed sparse column form, as sparse solvers need them.

        Returns
        -------
        qpsolvers.Problem
            Lower bounds zero and one equality, all numbers of order one. With a solution ``x`` and ``y``,
            ``problem.scaling.unscale(x, -y[0])`` gives forces and rotation: qpsolvers adds +y (A x - b), hence the
            sign.
        """
        return self.scaled().as_qp(sparse=sparse)

    def identical(self, other: ContactProblem) -> bool:
        """True if all data of two problems agree to the bit and in form."""
        mine, others = _given(self), _given(other)
        return len(mine) == len(others) and all(
            one is another or np.array_equal(one, another) for one, another in zip(mine, others, strict=True)
        )

    def to_dataset(self) -> xr.Dataset:
        """Return the problem as a Dataset with units, without loss: `from_dataset` gives the identical problem back."""
        numbers = problem_numbers(self).items()
        variables = {name: (DIMENSIONS[name], np.array(values), ATTRIBUTES[name]) for name, values in numbers}
        return xr.Dataset(variables, attrs={"format": FORMAT, "format_version": FORMAT_VERSION})

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> ContactProblem:
        """Rebuild a problem from `to_dataset`.

        Raises
        ------
        InputError
            The Dataset lacks a variable, or its data are no contact problem.
        """
        names = number_names("compliance" not in dataset and "compliance_factor" in dataset)
        missing = [name for name in names if name not in dataset]
        if missing:
            raise InputError(f"no contact problem in this Dataset: it lacks {', '.join(missing)}")
        return problem_of_numbers({name: dataset[name].to_numpy() for name in names})


def _local(local: ArrayLike, size: int) -> Array:
    return array("local compliance", local, "mm/N", ndim=1, size=size, least=0.0, frozen=True)


def _given(problem: ContactProblem) -> tuple[Any, ...]:
    """Separation, lever arm, torque, and the compliance as given, or its two parts."""
    parts = problem.compliance if problem.is_structured else (problem.compliance,)
    return (problem.separation, problem.lever_arm, problem.torque, *parts)
