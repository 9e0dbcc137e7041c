"""Stiffness and compliance matrices of supports: what is checked of them, and the inverse of a stiffness.

A member has six rows: x, y, z of the force and of the moment, or of the translation and of the rotation; two members
have twelve, the pinion first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...core.checks import array, shown
from ...core.errors import InputError

Array = NDArray[np.float64]
ASYMMETRY_LIMIT = 1e-6  # of the size of the entries; what programs write to seven digits is symmetric
NEGATIVE_EIGENVALUE_LIMIT = 1e-9  # of the greatest eigenvalue; rounding
FREE_STIFFNESS_SHARE = 1e-10  # of the greatest stiffness; less is a free motion
FREE_MOTION_RESIDUAL = 1e-3  # share of a free motion that is not the rotation about the member's axis
#: Stiffness of the supports of gears against translation and rotation; bearings have 1e4 to 1e7 N/mm.
TRANSLATION_STIFFNESS_RANGE = (1e3, 1e9)  # [N/mm]
ROTATION_STIFFNESS_RANGE = (1e5, 1e15)  # [N mm/rad]
#: Root of the stiffness against rotation over that against translation [mm]: about half the distance of the bearings.
BEARING_DISTANCE_MINIMUM = 2.0


class FreeRotation(Protocol):
    """An axis about which a member may turn, see ``support.MemberAxis``."""

    @property
    def rotation(self) -> Array:
        """The twist (6) at the origin of the unit rotation about it."""

    @property
    def couple(self) -> Array:
        """The wrench (6) of a unit couple about it."""


def checked_compliance(name: str, values: Any, members: int = 1) -> Array:
    """A compliance matrix that can be one of supports, made symmetric to the bit.

    Parameters
    ----------
    name
        As the user writes it.
    values
        Compliance (6, 6) [mm/N, 1/N, rad/(N mm)] of one member, or (12, 12) of both.
    members
        Their number.

    Raises
    ------
    InputError
        If it is not symmetric, has a negative eigenvalue, or is of a size that no gear's support has.

    Examples
    --------
    >>> checked_compliance("compliance", 1e-12 * np.eye(6))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    easeoff.core.errors.InputError: compliance = 1e-12: must be from 1e-09 to 0.001 mm/N against translation ...
    """
    matrix = _symmetric(name, values, members, "mm/N, 1/N, rad/(N mm)")
    translation, rotation = _sizes(matrix)
    low, high = (1.0 / limit for limit in reversed(TRANSLATION_STIFFNESS_RANGE))
    flat, steep = (1.0 / limit for limit in reversed(ROTATION_STIFFNESS_RANGE))
    units = (
        f"from {low:g} to {high:g} mm/N against translation and from {flat:g} to {steep:g} rad/(N mm) against rotation"
    )
    for size, least, most in ((translation, low, high), (rotation, flat, steep)):
        if size and not least <= size <= most:
            raise InputError(f"{name} = {size:g}: must be {units}, or zero where the support is rigid; check its units")
    if translation and rotation and np.sqrt(translation / rotation) < BEARING_DISTANCE_MINIMUM:
        shares = f"{translation:g} against translation and {rotation:g} against rotation"
        raise InputError(
            f"{name} = {shares}: must be {units}; these two fit together in other units, such as m/N and rad/(N m)"
        )
    scaled = _scaled(matrix, np.sqrt(translation / rotation) if translation and rotation else 1.0)
    least_eigenvalue, *_, greatest = np.linalg.eigvalsh(scaled)
    if least_eigenvalue < -NEGATIVE_EIGENVALUE_LIMIT * greatest:
        raise InputError(
            f"{name} = {shown(matrix)}: must have no negative eigenvalue, or a force would pull the member towards it"
        )
    return matrix


def checked_stiffness(
    name: str, values: Any, members: int = 1, free: Sequence[tuple[Array, FreeRotation]] = ()
) -> Array:
    """A stiffness matrix that can be one of supports, made symmetric to the bit.

    Parameters
    ----------
    name
        As the user writes it.
    values
        Stiffness (6, 6) [N/mm, N, N mm/rad] of one member, or (12, 12) of both.
    members
        Their number.
    free
        For every member its reference point (3) [mm] and the axis about which it may be free to turn; empty if no
        motion may be free.

    Raises
    ------
    InputError
        If it is not symmetric or not positive definite but for those rotations, or is of a size that no gear's support
        has.

    Examples
    --------
    >>> checked_stiffness("stiffness", np.diag([1e5, 1e5, 0.0, 1e9, 1e9, 1e9]))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    easeoff.core.errors.InputError: stiffness = array of shape (6, 6): must be positive definite; ...
    """
    matrix = _symmetric(name, values, members, "N/mm, N, N mm/rad")
    translation, rotation = _sizes(matrix)
    ranges = TRANSLATION_STIFFNESS_RANGE, ROTATION_STIFFNESS_RANGE
    units = "from {:g} to {:g} N/mm against translation".format(*ranges[0])
    units += " and from {:g} to {:g} N mm/rad against rotation".format(*ranges[1])
    for size, (least, most) in zip((translation, rotation), ranges, strict=True):
        if size and not least <= size <= most:
            raise InputError(f"{name} = {size:g}: must be {units}; check its units")
    if translation and rotation and np.sqrt(rotation / translation) < BEARING_DISTANCE_MINIMUM:
        shares = f"{translation:g} against translation and {rotation:g} against rotation"
        raise InputError(
            f"{name} = {shares}: must be {units}; these two fit together in other units, such as N/m and N m/rad"
        )
    length = np.sqrt(rotation / translation) if translation and rotation else 1.0
    eigenvalues, vectors = np.linalg.eigh(_scaled(matrix, 1.0 / length))
    if eigenvalues[0] < -FREE_STIFFNESS_SHARE * eigenvalues[-1]:
        raise InputError(f"{name} = {shown(matrix)}: must be positive definite; its least eigenvalue is negative")
    loose = vectors[:, eigenvalues < FREE_STIFFNESS_SHARE * max(eigenvalues[-1], 1e-300)]
    own = np.zeros((6 * members, len(free)))
    for number, (reference, axis) in enumerate(free):
        own[6 * number : 6 * number + 6, number] = rotation_at(axis, reference)
    allowed, _ = np.linalg.qr(_unscaled(own, length))
    _, sizes, mixtures = np.linalg.svd(loose - allowed @ (allowed.T @ loose), full_matrices=False)
    if sizes.size and sizes[0] > FREE_MOTION_RESIDUAL:
        motion = _motion(loose @ mixtures[0], length, [point for point, _ in free])
        beside = ", which is not the axis of the member: check stiffness and reference" if free else ""
        raise InputError(f"{name} = {shown(matrix)}: must be positive definite; it leaves the {motion} free{beside}")
    return matrix


def rotation_at(axis: FreeRotation, reference: Array) -> Array:
    """The twist (6) at a reference point (3) of the unit rotation about an axis."""
    rotation = np.array(axis.rotation)
    rotation[:3] += np.cross(rotation[3:], reference)
    return rotation


def inverse(stiffness: Array, free: Sequence[tuple[Array, FreeRotation]] = (), kept: tuple[int, ...] = ()) -> Array:
    """The compliance of a checked stiffness, with the rotations about the axes held.

    Parameters
    ----------
    stiffness, free
        As of ``checked_stiffness``.
    kept
        Numbers of the members whose rotation the stiffness holds, and is not held otherwise.

    Examples
    --------
    >>> inverse(np.diag([1e5, 1e5, 1e5, 1e8, 1e8, 1e8])).diagonal().tolist()
    [1e-05, 1e-05, 1e-05, 1e-08, 1e-08, 1e-08]
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


def held(compliance: Array, couples: Array) -> Array:
    """A compliance (n, n) with the rotations held that couples (n, m) turn.

    Examples
    --------
    >>> held(1e-5 * np.eye(6), np.eye(6)[:, 5:]).diagonal().tolist()
    [1e-05, 1e-05, 1e-05, 1e-05, 1e-05, 0.0]
    """
    for couple in couples.T:
        turned = compliance @ couple
        own = float(couple @ turned)
        if own > 0.0:
            compliance = compliance - np.outer(turned, turned) / own
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


def _sizes(matrix: Array) -> tuple[float, float]:
    """Greatest eigenvalues of the blocks of translation and of rotation of all members."""
    blocks = [slice(first, first + 3) for first in range(0, matrix.shape[0], 3)]
    sizes = [float(np.abs(np.linalg.eigvalsh(matrix[own, own])).max()) for own in blocks]
    return max(sizes[::2]), max(sizes[1::2])


def _scaled(matrix: Array, length: float) -> Array:
    scale = np.tile(np.repeat([1.0, length], 3), matrix.shape[0] // 6)
    return np.asarray(matrix * np.outer(scale, scale))


def _unscaled(twists: Array, length: float) -> Array:
    """Twists (n, m), rotations as displacements at a length."""
    return np.asarray(twists * np.tile(np.repeat([1.0, length], 3), twists.shape[0] // 6)[:, None])


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
