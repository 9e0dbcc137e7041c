"""Supports of pinion and gear: shafts, bearings and housing as the compliance of rigid members."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.checks import array, check_fields, frozen_arrays, instance, instances, read_only, two
from ...core.errors import InputError
from ...geometry.pair.assembly import Assembly
from .support_matrix import checked_compliance, checked_stiffness, held, inverse
from .wrench import ORIGIN, shift_matrix, shifted_compliance

Array = NDArray[np.float64]


@frozen_arrays
@dataclass(frozen=True, eq=False)
class MemberAxis:
    """Axis of a member, about which it is free to turn.

    Parameters
    ----------
    point
        A point on it (3) [mm], global frame.
    direction
        Unit vector (3).

    Examples
    --------
    >>> MemberAxis((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)).rotation.tolist()
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    """

    point: ArrayLike
    direction: ArrayLike

    @property
    def rotation(self) -> Array:
        """The twist (6) at the origin of the unit rotation about it."""
        point, direction = np.asarray(self.point, dtype=np.float64), np.asarray(self.direction, dtype=np.float64)
        return np.concatenate([np.cross(point, direction), direction])

    @property
    def couple(self) -> Array:
        """The wrench (6) of a unit couple about it, the same about every point."""
        return np.concatenate([np.zeros(3), np.asarray(self.direction, dtype=np.float64)])


def member_axes(assembly: Assembly) -> tuple[MemberAxis, MemberAxis]:
    """The axes of pinion and gear.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pinion, gear = member_axes(gear_pair(read_case("fm-11x41")).assembly)
    >>> pinion.direction.round(12).tolist()
    [1.0, 0.0, 0.0]
    """
    frame = assembly.pinion_frame
    return MemberAxis(assembly.pinion_origin, frame[:, 2]), MemberAxis(assembly.gear_origin, np.array([0.0, 0.0, 1.0]))


@frozen_arrays
@dataclass(frozen=True, eq=False)
class BearingReaction:
    """Load on one bearing under a wrench on the member that it holds.

    Parameters
    ----------
    name
        Name of the bearing.
    point
        Its centre (3) [mm], global frame.
    reaction
        Force [N] and moment about ``point`` [N mm] on the bearing for a wrench on the member about the reference of its
        support (6, 6).

    Examples
    --------
    >>> BearingReaction("front", (0.0, 0.0, 20.0), np.eye(6)).name
    'front'
    """

    name: str
    point: ArrayLike
    reaction: ArrayLike

    def __post_init__(self) -> None:
        object.__setattr__(self, "point", array("point", self.point, "mm", ndim=1, size=3, frozen=True))
        reaction = array("reaction", self.reaction, "N, N mm", ndim=2, size=36, frozen=True)
        object.__setattr__(self, "reaction", reaction)

    def load(self, wrench: Array) -> Array:
        """Force and moment (..., 6) on the bearing under wrenches (..., 6) on the member about its reference."""
        return np.asarray(wrench @ np.asarray(self.reaction).T)


@frozen_arrays
@dataclass(frozen=True, eq=False)
class Support:
    """Support of one member: how it moves as a rigid body under a wrench.

    Parameters
    ----------
    reference
        Point (3) [mm] in the pair's global frame.
    compliance
        Translation of that point [mm] and rotation [rad] for force [N] and moment about it [N mm] (6, 6), in the order
        x, y, z of the global frame; symmetric, without negative eigenvalues. Zero is rigid.
    bearings
        Bearings whose loads are wanted.

    Raises
    ------
    InputError
        If the compliance is not symmetric, has a negative eigenvalue, or is of a size that no gear's support has.

    Examples
    --------
    >>> spring = Support((0.0, 0.0, 100.0), np.diag([1e-5, 1e-5, 2e-6, 1e-9, 1e-9, 0.0]))
    >>> round(float(spring.at_origin[0, 0]), 12)
    2e-05
    """

    reference: ArrayLike
    compliance: ArrayLike
    bearings: tuple[BearingReaction, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "reference", array("reference", self.reference, "mm", ndim=1, size=3, frozen=True))
        object.__setattr__(self, "compliance", read_only(checked_compliance("compliance", self.compliance)))
        object.__setattr__(self, "bearings", instances("bearings", self.bearings, BearingReaction))

    @classmethod
    def of_stiffness(
        cls,
        reference: ArrayLike,
        stiffness: ArrayLike,
        axis: MemberAxis | None = None,
        bearings: tuple[BearingReaction, ...] = (),
    ) -> Support:
        """The support of a stiffness (6, 6) [N/mm, N, N mm/rad], wrench for twist.

        Parameters
        ----------
        reference, bearings
            As of the class.
        stiffness
            Symmetric, with positive eigenvalues, but for the free rotation about ``axis``.
        axis
            Axis of the member, from ``member_axes``. With it the stiffness may leave the rotation about it free, which
            is then held: it is that of the mesh.

        Raises
        ------
        InputError
            If the stiffness is not symmetric, not positive definite, of a size that no gear's support has, or leaves
            another motion free.

        Examples
        --------
        >>> stiffness = np.diag([1e5, 1e5, 5e5, 1e9, 1e9, 0.0])
        >>> axis = MemberAxis((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        >>> Support.of_stiffness((0.0, 0.0, 50.0), stiffness, axis).compliance.diagonal().round(12).tolist()
        [1e-05, 1e-05, 2e-06, 1e-09, 1e-09, 0.0]
        """
        point = array("reference", reference, "mm", ndim=1, size=3)
        free = [] if axis is None else [(point, axis)]
        return cls(point, inverse(checked_stiffness("stiffness", stiffness, 1, free), free), bearings)

    @classmethod
    def rigid(cls) -> Support:
        """A support that does not give way."""
        return cls(ORIGIN, np.zeros((6, 6)))

    @property
    def at_origin(self) -> Array:
        """The compliance (6, 6) about the origin."""
        return shifted_compliance(np.asarray(self.compliance), self.reference, ORIGIN)


@frozen_arrays
@dataclass(frozen=True, eq=False)
class Supports:
    """Supports of pinion and gear.

    Parameters
    ----------
    pinion, gear
        Support of each.
    coupling
        Twist of the pinion for a wrench on the gear (6, 6), each about its reference, as of a housing that holds both;
        none if left out.
    wind_up
        Whether the pinion turns about its axis by the compliance of its support; else this rotation is held, as that of
        the gear is always.

    Examples
    --------
    >>> Supports(Support.rigid(), Support.rigid()).compliance.shape
    (12, 12)
    """

    pinion: Support
    gear: Support
    coupling: ArrayLike | None = None
    wind_up: bool = False

    def __post_init__(self) -> None:
        check_fields(self)
        if self.coupling is not None:
            coupling = array("coupling", self.coupling, "mm/N, 1/N, rad/(N mm)", ndim=2, size=36, frozen=True)
            object.__setattr__(self, "coupling", coupling)
            checked_compliance("compliance", self.compliance, 2)

    @classmethod
    def of_matrix(
        cls,
        references: tuple[ArrayLike, ArrayLike],
        *,
        compliance: ArrayLike | None = None,
        stiffness: ArrayLike | None = None,
        axes: tuple[MemberAxis, MemberAxis] | None = None,
        bearings: tuple[tuple[BearingReaction, ...], tuple[BearingReaction, ...]] = ((), ()),
        wind_up: bool = False,
    ) -> Supports:
        """The supports of one matrix (12, 12) for both members, the pinion first.

        Parameters
        ----------
        references
            Reference points of pinion and gear (3) [mm].
        compliance, stiffness
            One of them, as of ``Support`` and ``Support.of_stiffness``.
        axes
            Axes of the members, from ``member_axes``: rotations about them may be free in the stiffness.
        bearings
            Bearings of pinion and gear.
        wind_up
            As of the class; the stiffness must then hold the rotation of the pinion.

        Raises
        ------
        InputError
            If not one of the two is given, or as ``Support`` and ``Support.of_stiffness``.

        Examples
        --------
        >>> both = np.kron(np.eye(2), np.diag([1e-5] * 3 + [1e-9] * 3))
        >>> Supports.of_matrix(((50.0, 0.0, 0.0), (0.0, 0.0, 50.0)), compliance=both).gear.reference.tolist()
        [0.0, 0.0, 50.0]
        """
        points = [array("reference", one, "mm", ndim=1, size=3) for one in two("references", references, "points [mm]")]
        bearings = two("bearings", bearings, "tuples of bearings")
        if (compliance is None) == (stiffness is None):
            raise InputError("compliance, stiffness: must be given one of them, not both or none")
        if compliance is not None:
            matrix = checked_compliance("compliance", compliance, 2)
        else:
            free = list(zip(points, axes, strict=True)) if axes is not None else []
            known = checked_stiffness("stiffness", stiffness, 2, free)
            matrix = inverse(known, free, kept=(0,) if wind_up else ())
        pinion, gear = (Support(points[i], matrix[6 * i : 6 * i + 6, 6 * i : 6 * i + 6], bearings[i]) for i in (0, 1))
        return cls(pinion, gear, matrix[:6, 6:], wind_up)

    @classmethod
    def rigid(cls) -> Supports:
        """Supports that do not give way."""
        return cls(Support.rigid(), Support.rigid())

    @property
    def compliance(self) -> Array:
        """Twists of pinion and gear for wrenches on them (12, 12), each about its reference."""
        coupling = np.zeros((6, 6)) if self.coupling is None else np.asarray(self.coupling)
        own = np.asarray(self.pinion.compliance), np.asarray(self.gear.compliance)
        return np.block([[own[0], coupling], [coupling.T, own[1]]])

    def at_origin(self, assembly: Assembly) -> Array:
        """Twists of pinion and gear for wrenches on them (12, 12), all about the origin, their free rotations held."""
        instance("assembly", assembly, Assembly)
        axes = member_axes(assembly)
        couples = np.zeros((12, 2))
        couples[:6, 0], couples[6:, 1] = axes[0].couple, axes[1].couple
        shift = np.zeros((12, 12))
        for i, member in enumerate((self.pinion, self.gear)):
            own = slice(6 * i, 6 * i + 6)
            shift[own, own] = shift_matrix(ORIGIN, member.reference)
        # A couple is the same about every point.
        return shift.T @ held(self.compliance, couples[:, 1:] if self.wind_up else couples) @ shift

    def relative(self, assembly: Assembly) -> Array:
        """Twist of the pinion relative to the gear for the wrench of the gear on the pinion, about the origin (6, 6).

        Examples
        --------
        >>> from easeoff.cases import gear_pair, read_case
        >>> assembly = gear_pair(read_case("fm-11x41")).assembly
        >>> spring = Support((0.0, 0.0, 0.0), np.diag([1e-5, 1e-5, 1e-5, 0.0, 0.0, 0.0]))
        >>> Supports(spring, spring).relative(assembly).diagonal().tolist()
        [2e-05, 2e-05, 2e-05, 0.0, 0.0, 0.0]
        """
        whole = self.at_origin(assembly)
        apart = np.concatenate([np.eye(6), -np.eye(6)])
        return np.asarray(apart.T @ whole @ apart)

    def at(self, pinion_wrench: Array, gear_wrench: Array) -> Supports:
        """These supports themselves: they do not depend on the load, see ``LoadedSupports``."""
        return self


@runtime_checkable
class LoadedSupports(Protocol):
    """Supports whose stiffness may depend on the load."""

    def at(self, pinion_wrench: Array, gear_wrench: Array) -> Supports:
        """The supports under wrenches (6) on pinion and gear about the origin.

        Their compliance times the wrenches is the motion from the unloaded state: a secant.
        """
