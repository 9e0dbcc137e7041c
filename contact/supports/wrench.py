"""Wrenches, twists, stiffness and compliance, and how they change with the reference point.

A wrench is a force [N] and its moment [N mm] about a point, a twist the translation [mm] of that point and a rotation
[rad]: their product is work. All components are those of the pair's global frame.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
ORIGIN = (0.0, 0.0, 0.0)
#: Components of wrenches and twists.
COMPONENTS = ("force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z")


def cross_matrix(vector: ArrayLike) -> Array:
    """The matrix (3, 3) of the cross product with a vector (3) from the left.

    Examples
    --------
    >>> (cross_matrix([0.0, 0.0, 1.0]) @ [1.0, 0.0, 0.0]).tolist()
    [0.0, 1.0, 0.0]
    """
    x, y, z = np.asarray(vector, dtype=np.float64)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def shift_matrix(start: ArrayLike, end: ArrayLike) -> Array:
    """The matrix X (6, 6) that takes a wrench about one point to that about another; X^-T does so for twists.

    Parameters
    ----------
    start, end
        The points (3) [mm].

    Examples
    --------
    A force of 1 N along y at 10 mm along x has a moment of 10 N mm about the origin:

    >>> float((shift_matrix([10.0, 0.0, 0.0], [0.0, 0.0, 0.0]) @ [0.0, 1.0, 0.0, 0.0, 0.0, 0.0])[5])
    10.0
    """
    shift = np.eye(6)
    shift[3:, :3] = cross_matrix(np.asarray(start, dtype=np.float64) - np.asarray(end, dtype=np.float64))
    return shift


def shifted_wrench(wrench: Array, start: ArrayLike, end: ArrayLike) -> Array:
    """A wrench (..., 6) about ``start``, about ``end``."""
    return np.asarray(wrench @ shift_matrix(start, end).T)


def shifted_twist(twist: Array, start: ArrayLike, end: ArrayLike) -> Array:
    """The twist (..., 6) of a rigid body at ``start``, at ``end``."""
    return np.asarray(twist @ shift_matrix(end, start))


def shifted_compliance(compliance: Array, start: ArrayLike, end: ArrayLike) -> Array:
    """A compliance (6, 6), twist for wrench about ``start``, about ``end``."""
    shift = shift_matrix(end, start)
    return np.asarray(shift.T @ compliance @ shift)


def shifted_stiffness(stiffness: Array, start: ArrayLike, end: ArrayLike) -> Array:
    """A stiffness (6, 6), wrench for twist at ``start``, at ``end``."""
    shift = shift_matrix(start, end)
    return np.asarray(shift @ stiffness @ shift.T)


def unit_wrenches(position: Array, normal: Array) -> Array:
    """Wrenches (n, 6) about the origin of unit forces along normals (3, n) at positions (3, n) [mm].

    Examples
    --------
    >>> unit_wrenches(np.array([[10.0], [0.0], [0.0]]), np.array([[0.0], [1.0], [0.0]])).tolist()
    [[0.0, 1.0, 0.0, 0.0, 0.0, 10.0]]
    """
    return np.concatenate([normal, np.cross(position, normal, axis=0)]).T
