"""Supports of pinion and gear: shafts, bearings and housing as the compliance of rigid members.

A wrench is a force [N] and its moment [N mm] about a point, a twist the translation [mm] of that point and a rotation
[rad]: their product is work. All components are those of the pair's global frame.

In stiffness and compliance a member has six rows: x, y, z of the force and of the moment, or of the translation and of
the rotation; two members have twelve, the pinion first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array, record
from ...core.checks import array, check_fields, instance, instances, read_only, shown, two
from ...core.errors import InputError
from ...geometry.pair.assembly import Assembly

ORIGIN = (0.0, 0.0, 0.0)


def shift_matrix(start: ArrayLike, end: ArrayLike) -> Array:
    """The matrix X (6, 6) that takes a wrench about one point [mm] to that about another; X^-T does so for twists."""
    shift = np.eye(6)
    x, y, z = np.asarray(start, dtype=np.float64) - np.asarray(end, dtype=np.float64)
    shift[3:, :3] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]  # the cross product with (x, y, z) from the left
    return shift


def shifted_wrench(wrench: Array, start: ArrayLike, end: ArrayLike) -> Array:
    """A wrench (..., 6) about ``start``, about ``end``."""
    return np.asarray(wrench @ shift_matrix(start, end).T)


def shifted_compliance(compliance: Array, start: ArrayLike, end: ArrayLike) -> Array:
    """A compliance (6, 6), twist for wrench about ``start``, about ``end``."""
    shift = shift_matrix(end, start)
    return np.asarray(shift.T @ compliance @ shift)


ASYMMETRY_LIMIT = 1e-6  # of the size of the entries; what programs write to seven digits is symmetric
NEGATIVE_EIGENVALUE_LIMIT = 1e-9  # of the greatest eigenvalue; rounding
FREE_STIFFNESS_SHARE = 1e-10  # of the greatest stiffness; less is a free motion
FREE_MOTION_RESIDUAL = 1e-3  # share of a free motion that is not the rotation about the member's axis
#: Stiffness of the supports of gears against translation and rotation; bearings have 1e4 to 1e7 N/mm.
TRANSLATION_STIFFNESS_RANGE = (1e3, 1e9)  # [N/mm]
ROTATION_STIFFNESS_RANGE = (1e5, 1e15)  # [N mm/rad]
#: Root of the stiffness against rotation over that against translation [mm]: about half the distance of the bearings.
BEARING_DISTANCE_MINIMUM = 2.0


def checked_compliance(name: str, values: Any, members: int = 1) -> Array:
    """A compliance matrix that can be one of supports, made symmetric to the bit.

    Of one member (6, 6) or both (12, 12) [mm/N, 1/N, rad/(N mm)]; refused if not symmetric, with a negative eigenvalue,
    or of a size that no gear's support has.
    """
    matrix = _symmetric(name, values, members, "mm/N, 1/N, rad/(N mm)")
    stiffnesses = TRANSLATION_STIFFNESS_RANGE, ROTATION_STIFFNESS_RANGE
    ranges = [(1.0 / most, 1.0 / least) for least, most in stiffnesses]
    length = _length(name, matrix, ranges, ("mm/N", "rad/(N mm)"), "m/N and rad/(N m)", stiff=False)
    scale = _scale(length, members)
    least_eigenvalue, *_, greatest = np.linalg.eigvalsh(matrix * np.outer(scale, scale))
    if least_eigenvalue < -NEGATIVE_EIGENVALUE_LIMIT * greatest:
        raise InputError(
            f"{name} = {shown(matrix)}: must have no negative eigenvalue, or a force would pull the member towards it"
        )
    return matrix


def checked_stiffness(name: str, values: Any, members: int = 1, free: Sequence[tuple[Array, MemberAxis]] = ()) -> Array:
    """A stiffness matrix that can be one of supports, made symmetric to the bit.

    Of one member (6, 6) or both (12, 12) [N/mm, N, N mm/rad]. Refused if not symmetric, of an unlikely size, or not
    positive definite but for rotations ``free`` about an axis, with each member's reference point (3) [mm].
    """
    matrix = _symmetric(name, values, members, "N/mm, N, N mm/rad")
    ranges = TRANSLATION_STIFFNESS_RANGE, ROTATION_STIFFNESS_RANGE
    length = _length(name, matrix, ranges, ("N/mm", "N mm/rad"), "N/m and N m/rad", stiff=True)
    inverse_scale, scale = _scale(1.0 / length, members), _scale(length, members)
    eigenvalues, vectors = np.linalg.eigh(matrix * np.outer(inverse_scale, inverse_scale))
    if eigenvalues[0] < -FREE_STIFFNESS_SHARE * eigenvalues[-1]:
        raise InputError(f"{name} = {shown(matrix)}: must be positive definite; its least eigenvalue is negative")
    loose = vectors[:, eigenvalues < FREE_STIFFNESS_SHARE * max(eigenvalues[-1], 1e-300)]
    free_rotations = np.zeros((6 * members, len(free)))
    for number, (reference, axis) in enumerate(free):
        rotation_at = np.array(axis.rotation)  # the twist at the reference
        rotation_at[:3] += np.cross(rotation_at[3:], reference)
        free_rotations[6 * number : 6 * number + 6, number] = rotation_at
    allowed, _ = np.linalg.qr(free_rotations * scale[:, None])
    _, sizes, mixtures = np.linalg.svd(loose - allowed @ (allowed.T @ loose), full_matrices=False)
    if sizes.size and sizes[0] > FREE_MOTION_RESIDUAL:
        motion = _motion(loose @ mixtures[0], length, [point for point, _ in free])
        beside = ", which is not the axis of the member: check stiffness and reference" if free else ""
        raise InputError(f"{name} = {shown(matrix)}: must be positive definite; it leaves the {motion} free{beside}")
    return matrix


def inverse(stiffness: Array, free: Sequence[tuple[Array, MemberAxis]] = (), kept: tuple[int, ...] = ()) -> Array:
    """The compliance of a checked stiffness, with the rotations about the axes held.

    The stiffness itself holds those of the members ``kept``.
    """
    size = stiffness.shape[0]
    couples = np.zeros((size, len(free)))
    for number, (_, axis) in enumerate(free):
        couples[6 * number : 6 * number + 6, number] = axis.couple
    couples = np.delete(couples, kept, axis=1)
    # Twists that hold the rotations: without a part along the couples.
    whole = np.linalg.qr(couples, mode="complete")[0] if couples.size else np.eye(size)
    twists = whole[:, couples.shape[1] :]
    twists = twists / np.sqrt(np.diagonal(twists.T @ stiffness @ twists))
    compliance = twists @ np.linalg.solve(twists.T @ stiffness @ twists, twists.T)
    return np.asarray(0.5 * (compliance + compliance.T))


def constrained(compliance: Array, couples: Array) -> Array:
    """A compliance (n, n) with the rotations held that couples (n, m) turn."""
    for couple in couples.T:
        turned = compliance @ couple
        rotation = float(couple @ turned)
        if rotation > 0.0:
            compliance = compliance - np.outer(turned, turned) / rotation
    return compliance


def _symmetric(name: str, values: Any, members: int, units: str) -> Array:
    size = 6 * members
    matrix = array(name, values, units, ndim=2, fewest=1)
    if matrix.shape != (size, size):
        raise InputError(f"{name} = {shown(matrix)}: must have the shape ({size}, {size})")
    # Rows of translation and of rotation differ in their units: compare with what stands on the diagonal.
    size_of = np.sqrt(np.abs(np.diagonal(matrix)))
    allowed = ASYMMETRY_LIMIT * np.maximum(np.outer(size_of, size_of), np.abs(matrix))
    wrong = np.argwhere(np.abs(matrix - matrix.T) > allowed)
    if wrong.size:
        row, column = wrong[0]
        raise InputError(
            f"{name} = {matrix[row, column]:g} in row {row + 1}, column {column + 1}: must be symmetric; "
            f"row {column + 1}, column {row + 1} has {matrix[column, row]:g}"
        )
    return np.array(0.5 * (matrix + matrix.T))


def _length(
    name: str,
    matrix: Array,
    ranges: Sequence[tuple[float, float]],
    units: tuple[str, str],
    other_units: str,
    *,
    stiff: bool,
) -> float:
    """Length [mm] that relates rotation to translation, about half the distance of the bearings; 1 if one is zero.

    Of a compliance or a ``stiff`` matrix, by the greatest eigenvalues of the blocks of all members: refused if these
    are out of their ranges, or do not fit together.
    """
    blocks = [slice(first, first + 3) for first in range(0, matrix.shape[0], 3)]
    each = [float(np.abs(np.linalg.eigvalsh(matrix[block, block])).max()) for block in blocks]
    sizes, ways = (max(each[::2]), max(each[1::2])), ("translation", "rotation")
    limits = zip(ranges, units, ways, strict=True)
    wanted = " and ".join(f"from {least:g} to {most:g} {unit} against {way}" for (least, most), unit, way in limits)
    zero = "" if stiff else ", or zero where the support is rigid"
    for size, (least, most) in zip(sizes, ranges, strict=True):
        if size and not least <= size <= most:
            raise InputError(f"{name} = {size:g}: must be {wanted}{zero}; check its units")
    if not all(sizes):
        return 1.0
    length = float(np.sqrt(sizes[1] / sizes[0] if stiff else sizes[0] / sizes[1]))
    if length < BEARING_DISTANCE_MINIMUM:
        shares = " and ".join(f"{size:g} against {way}" for size, way in zip(sizes, ways, strict=True))
        raise InputError(
            f"{name} = {shares}: must be {wanted}; these two fit together in other units, such as {other_units}"
        )
    return length


def _scale(length: float, members: int) -> Array:
    """Factors (6 m) that make displacements at a length of the rotations of the members."""
    return np.tile(np.repeat([1.0, length], 3), members)


def _motion(motion: Array, length: float, references: Sequence[Array]) -> str:
    """A free motion (n), rotations as displacements at a length, in words."""
    member = int(np.argmax(np.linalg.norm(motion.reshape(-1, 6), axis=1)))
    translation, rotation = motion[6 * member : 6 * member + 3], motion[6 * member + 3 : 6 * member + 6] / length
    whose = "" if motion.size == 6 else f"{('pinion', 'gear')[member]}'s "
    turned = float(np.linalg.norm(rotation))
    if turned * length < FREE_MOTION_RESIDUAL * float(np.linalg.norm(translation)):
        return f"{whose}translation along {_direction(translation)}"
    reference = references[member] if references else np.zeros(3)
    point = reference + np.cross(rotation, translation) / turned**2
    place = "" if not references else " through ({:.4g}, {:.4g}, {:.4g})".format(*(point + 0.0))
    return f"{whose}rotation about {_direction(rotation)}{place}"


def _direction(vector: Array) -> str:
    unit = vector / np.linalg.norm(vector)
    axis = int(np.argmax(np.abs(unit)))
    if abs(unit[axis]) > 1.0 - FREE_MOTION_RESIDUAL**2:
        return "xyz"[axis]
    return "({:.4g}, {:.4g}, {:.4g})".format(*(np.sign(unit[axis]) * unit + 0.0))


@record(frozen=True, eq=False)
class MemberAxis:
    """Axis of a member, about which it is free to turn."""

    point: ArrayLike  # (3) [mm], global frame
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
    """The axes of pinion and gear."""
    frame = assembly.pinion_frame
    return MemberAxis(assembly.pinion_origin, frame[:, 2]), MemberAxis(assembly.gear_origin, np.array([0.0, 0.0, 1.0]))


@record(frozen=True, eq=False)
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


@record(frozen=True, eq=False)
class Support:
    """Support of one member: its motion as a rigid body under a wrench.

    The compliance is symmetric without negative eigenvalues, zero being rigid: forces, then moments about the
    reference.
    """

    reference: ArrayLike  # (3) [mm], global frame
    compliance: ArrayLike  # (6, 6) [mm, rad for N, N mm], x y z of the global frame
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

        Symmetric and positive definite, but for the rotation about an ``axis`` given, which is then held: it is that of
        the mesh.
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


@record(frozen=True, eq=False)
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
        diagonal = np.asarray(self.pinion.compliance), np.asarray(self.gear.compliance)
        return np.block([[diagonal[0], coupling], [coupling.T, diagonal[1]]])

    def at_origin(self, assembly: Assembly) -> Array:
        """Twists of pinion and gear for wrenches on them (12, 12), all about the origin, their free rotations held."""
        instance("assembly", assembly, Assembly)
        axes = member_axes(assembly)
        couples = np.zeros((12, 2))
        couples[:6, 0], couples[6:, 1] = axes[0].couple, axes[1].couple
        shift = np.zeros((12, 12))
        for i, member in enumerate((self.pinion, self.gear)):
            block = slice(6 * i, 6 * i + 6)
            shift[block, block] = shift_matrix(ORIGIN, member.reference)
        # A couple is the same about every point.
        return shift.T @ constrained(self.compliance, couples[:, 1:] if self.wind_up else couples) @ shift

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
