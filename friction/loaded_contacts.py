"""Loaded contacts of a stored result, in SI: forces, lengths, radii and surface velocities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.checks import instance
from ..core.errors import InputError
from ..geometry.vectors import dot
from .surface_velocities import SurfaceVelocities, action_splines, axes_of, surface_velocities

Array = NDArray[Any]


@dataclass(frozen=True)
class LoadedContacts:
    """Contact segments that carry force (n), over all torques and mesh positions of a result, in SI.

    Parameters
    ----------
    index
        Where each stands: torque, mesh position, segment (3, n); sorted.
    torque
        At the pinion [N m], of the result (t).
    force, length
        Normal force [N] and length [m] (n).
    hertz_pressure, equivalent_radius
        [Pa] and [m] (n).
    velocities
        At the segments (n), per angular velocity of the pinion.
    solved
        Whether torque and mesh position (t, k) have a certified solution.
    contact_modulus
        [Pa].
    on_line
        Which are on contact lines (n), not on tooth edges beside them.
    """

    index: NDArray[np.int64]
    torque: Array
    force: Array
    length: Array
    hertz_pressure: Array
    equivalent_radius: Array
    velocities: SurfaceVelocities
    solved: NDArray[np.bool_]
    contact_modulus: float
    on_line: NDArray[np.bool_]

    @property
    def half_width(self) -> Array:
        """Of the band of contact (n) [m], by Hertz."""
        return 2.0 * self.force / (np.pi * self.length * self.hertz_pressure)

    @property
    def group(self) -> NDArray[np.int64]:
        """Number of torque and mesh position (n), counted together."""
        return np.asarray(self.index[0] * self.solved.shape[1] + self.index[1])

    @property
    def friction_arms(self) -> tuple[Array, Array]:
        """Velocity of pinion's and gear's surface along the sliding direction (n) [m/rad].

        Friction of one newton takes as much torque of the pinion [N m], and gives as much to the gear over the ratio.
        Without sliding there is no direction and they are zero.
        """
        v = self.velocities
        sliding = v.along * v.sliding_along + v.across * v.sliding_across
        size = v.sliding_speed
        direction = np.divide(sliding, size, out=np.zeros_like(sliding), where=size > 0.0)
        return dot(v.pinion, direction), dot(v.gear, direction)


def loaded_segments(tree: xr.DataTree) -> xr.Dataset:
    """The group ``/loaded`` with torque, mesh position and segment first.

    Raises
    ------
    InputError
        If one of these dimensions was taken away.
    """
    instance("tree", tree, xr.DataTree)
    if lost := [name for name in ("ease_off", "loaded") if name not in tree.children]:
        raise InputError(f"tree = DataTree without {' and '.join(lost)}: must be a result of analyze or read_result")
    loaded, order = tree["loaded"].to_dataset(), ("torque", "mesh_position", "segment")
    if lost := [name for name in order if name not in loaded.dims]:
        raise InputError(
            f"the group loaded has no dimension {' and '.join(lost)}: to take one torque or position, keep the "
            "dimension, as in isel(torque=[0])"
        )
    return loaded.transpose(*order, ...)


@dataclass(frozen=True)
class PotentialSegments:
    """All segments of a result and their surface velocities, which are the same at every torque.

    Parameters
    ----------
    exists
        Which segments there are (mesh position, segment).
    velocities
        At those (n), per angular velocity of the pinion.
    """

    exists: NDArray[np.bool_]
    velocities: SurfaceVelocities

    def spread(self, values: Array) -> Array:
        """Values (n, ...) at the segments as a field (mesh position, segment, ...), NaN where there is none."""
        field = np.full((*self.exists.shape, *values.shape[1:]), np.nan)
        field[self.exists] = values
        return field


def potential_segments(tree: xr.DataTree) -> PotentialSegments:
    """Velocities at all segments of a result, whether they carry force or not.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.

    Raises
    ------
    InputError
        If the result is of an older version without points of action, or lacks a dimension, or its misalignment depends
        on the torque.
    """
    _require_one_assembly(tree)
    loaded, ease_off = loaded_segments(tree), tree["ease_off"].to_dataset()
    points = np.stack([loaded[n].values[0] for n in ("lengthwise", "profile")])
    exists = np.isfinite(points[0])
    velocities = surface_velocities(axes_of(ease_off), action_splines(ease_off), points[:, exists])
    return PotentialSegments(exists, velocities)


def _require_one_assembly(tree: xr.DataTree) -> None:
    """Refuse a result whose torques are not in the assembly that its ease-off is of."""
    instance("tree", tree, xr.DataTree)
    if "misalignment" not in tree.children:  # older results
        return
    for name, units in (("offset", "mm"), ("pinion_axial", "mm"), ("gear_axial", "mm"), ("shaft_angle", "rad")):
        of_ease_off = tree.attrs.get(f"misalignment_{name}_{units}")
        if of_ease_off is not None and np.any(tree["misalignment"][name].values != of_ease_off):
            raise InputError(
                "the misalignment of this result depends on the torque, and its ease-off is that without torque: for "
                "friction give the speed to the analysis itself, which knows every assembly"
            )


def loaded_contacts(tree: xr.DataTree, segments: PotentialSegments | None = None) -> LoadedContacts:
    """Gather the segments that carry force.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    segments
        Its ``potential_segments``, if they are known.

    Raises
    ------
    InputError
        If the result is of an older version.
    """
    segments = segments or potential_segments(tree)
    loaded = loaded_segments(tree)
    if "contact_modulus_MPa" not in loaded.attrs:
        raise InputError("this result has no contact modulus: it was written by an older version; make it anew")
    force = loaded["force"].values
    touching = force > 0.0
    length, radius = (1e-3 * loaded[name].values[touching] for name in ("length", "equivalent_radius"))
    modulus = 1e6 * float(loaded.attrs["contact_modulus_MPa"])
    index = np.stack(np.nonzero(touching))
    number = np.cumsum(segments.exists.ravel()).reshape(segments.exists.shape) - 1
    chosen = number[index[1], index[2]]
    return LoadedContacts(
        index=index,
        torque=loaded["torque"].values,
        force=force[touching],
        length=length,
        # Of the whole strip also where an edge cuts it: there the pressure has no limit.
        hertz_pressure=np.sqrt(force[touching] / length * modulus / (2.0 * np.pi * radius)),
        equivalent_radius=radius,
        velocities=segments.velocities.chosen(chosen),
        solved=loaded["status"].values == 0,
        contact_modulus=modulus,
        on_line=np.isnan(loaded["overhang"].values[touching]) if "overhang" in loaded else np.ones(length.size, bool),
    )
