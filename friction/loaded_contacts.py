"""Loaded contacts of a stored result, in SI: forces, lengths, radii and surface velocities.

Velocities are sliding and rolling, along and across the contact line. At its conjugate position a point of the flank
moves with v = w a x (r - o) on either member (Kolivand 2009, Eq. 5.1). The members turn at their ratio, so both
velocities have the same part along the common normal (Eq. 5.2): the points of action and the pinion's normals there are
where that holds to rounding. On the gear's own flank it holds to the slope of the ease-off only.

The contact line is the level set of the roll angle. All velocities are per angular velocity of the pinion.
"""

from __future__ import annotations

from dataclasses import dataclass, fields as dataclass_fields
from typing import Any

import numpy as np
import xarray as xr

from ..contact.lines.flank_splines import FlankSplines, fit
from ..core.arrays import Array, Bools, Integers
from ..core.checks import instance
from ..core.errors import InputError
from ..geometry.newton import cramers_rule, determinant
from ..geometry.vectors import column, cross, dot

AXIS_ATTRIBUTES = ("pinion_axis", "pinion_origin_mm", "gear_axis", "gear_origin_mm", "ratio")


@dataclass(frozen=True)
class Axes:
    """Both axes of a pair in the global frame: unit vectors (3) of positive drive rotation, and a point on each."""

    pinion_axis: Array
    pinion_origin: Array  # [m]
    gear_axis: Array
    gear_origin: Array
    ratio: float

    def velocities(self, position: Array) -> tuple[Array, Array]:
        """Velocities (3, ...) of points (3, ...) [m] of pinion and gear [m/rad], per angular velocity of the pinion."""
        pinion = cross(column(self.pinion_axis, position), position - column(self.pinion_origin, position))
        gear = cross(column(self.gear_axis, position), position - column(self.gear_origin, position))
        return pinion, gear / self.ratio


@dataclass(frozen=True)
class SurfaceVelocities:
    """Velocities (3, ...) at points of contact per angular velocity of the pinion [m/rad], in the global frame."""

    pinion: Array
    gear: Array
    normal: Array  # the pinion's outward
    along: Array  # the contact line, towards the heel
    across: Array  # as the line moves over the gear
    line_over_gear: Array  # speed of the line over the gear's flank, across

    def chosen(self, index: Any) -> SurfaceVelocities:
        """The velocities of some of the points."""
        return SurfaceVelocities(**{f.name: getattr(self, f.name)[..., index] for f in dataclass_fields(self)})

    @property
    def sliding(self) -> Array:
        """Velocity (3, ...) of the pinion's surface relative to the gear's."""
        return np.asarray(self.pinion - self.gear)

    @property
    def sliding_along(self) -> Array:
        """Sliding along the contact line (Eq. 5.4a)."""
        return dot(self.sliding, self.along)

    @property
    def sliding_across(self) -> Array:
        """Sliding across the contact line (Eq. 5.4b)."""
        return dot(self.sliding, self.across)

    @property
    def sliding_speed(self) -> Array:
        """Size of the sliding velocity in the tangent plane (Eq. 5.5)."""
        return np.hypot(self.sliding_along, self.sliding_across)

    @property
    def rolling(self) -> Array:
        """Mean of both surface velocities across the contact line, in the fixed frame (Eq. 5.6)."""
        return 0.5 * (dot(self.pinion, self.across) + dot(self.gear, self.across))

    @property
    def over_line(self) -> tuple[Array, Array]:
        """Velocities of pinion and gear relative to the contact line, across it."""
        return np.asarray(self.sliding_across - self.line_over_gear), -self.line_over_gear

    @property
    def rolling_over_line(self) -> Array:
        """Rolling relative to the contact line, which itself moves across the flank's normal: what draws the oil in."""
        return np.asarray(0.5 * self.sliding_across - self.line_over_gear)


def axes_of(ease_off: xr.Dataset) -> Axes:
    """Axes of the pair a result's ``/ease_off`` belongs to; refused in results of older versions."""
    if "action_position" not in ease_off or any(name not in ease_off.attrs for name in AXIS_ATTRIBUTES):
        raise InputError(
            "this result has no points of action in its group ease_off, which friction needs: it was written by an "
            "older version; make it anew with 'easeoff run'"
        )
    given = (np.asarray(ease_off.attrs[name], float) for name in AXIS_ATTRIBUTES)
    pinion_axis, pinion_origin, gear_axis, gear_origin, ratio = given
    return Axes(pinion_axis, 1e-3 * pinion_origin, gear_axis, 1e-3 * gear_origin, float(ratio))


def action_splines(ease_off: xr.Dataset) -> FlankSplines:
    """Splines of the points of action [m], normals and roll angle, over the gear's flank."""
    order = ("lengthwise", "profile")
    fields = {
        "position": 1e-3 * ease_off["action_position"].transpose(*order, "space").values,
        "normal": ease_off["action_normal"].transpose(*order, "space").values,
        "roll_angle": ease_off["roll_angle"].transpose(*order).values,
    }
    return fit(ease_off["lengthwise"].values, ease_off["profile"].values, fields)


def surface_velocities(axes: Axes, splines: FlankSplines, points: Array) -> SurfaceVelocities:
    """Surface velocities at points (2, ...) of the gear in conjugate position; splines of ``action_splines``."""
    fields = splines.evaluate(["position", "normal"], points)
    position = fields["position"]
    normal = fields["normal"] / np.sqrt(dot(fields["normal"], fields["normal"]))
    pinion, gear = axes.velocities(position)
    slopes = [splines.evaluate(["position", "roll_angle"], points, d) for d in ((1, 0), (0, 1))]
    rates = [s["roll_angle"] for s in slopes]
    # Along a level set of the roll angle the points of action are those of one moment: the contact line.
    line = rates[0] * slopes[1]["position"] - rates[1] * slopes[0]["position"]
    line = (line - normal * dot(line, normal)) * np.where(rates[1] <= 0.0, 1.0, -1.0)
    along = line / np.sqrt(dot(line, line))
    # On the gear, turning with it, the same points make the flank. Its tangents are what is left of the derivatives.
    tangents = [s["position"] - rate * gear for s, rate in zip(slopes, rates, strict=True)]
    first, mixed, second = (dot(tangents[i], tangents[j]) for i, j in ((0, 0), (0, 1), (1, 1)))
    squared = second * rates[0] ** 2 - 2.0 * mixed * rates[0] * rates[1] + first * rates[1] ** 2
    climb = squared / determinant((first, mixed), (mixed, second))
    by_first, by_second = cramers_rule((first, mixed), (mixed, second), rates)
    uphill = tangents[0] * by_first + tangents[1] * by_second
    across = cross(normal, along)
    across = across * np.sign(dot(across, uphill))
    return SurfaceVelocities(pinion, gear, normal, along, across, 1.0 / np.sqrt(climb))


@dataclass(frozen=True)
class LoadedContacts:
    """Contact segments that carry force (n), over all torques (t) and mesh positions (k) of a result, in SI."""

    index: Integers  # torque, mesh position, segment (3, n), sorted
    torque: Array  # at the pinion (t) [N m]
    force: Array
    length: Array
    hertz_pressure: Array
    equivalent_radius: Array
    velocities: SurfaceVelocities
    solved: Bools  # (t, k) certified
    contact_modulus: float
    on_line: Bools  # not on tooth edges (n)

    @property
    def half_width(self) -> Array:
        """Of the band of contact (n) [m], by Hertz."""
        return 2.0 * self.force / (np.pi * self.length * self.hertz_pressure)

    @property
    def group(self) -> Integers:
        """Number of torque and mesh position (n), counted together."""
        return np.asarray(self.index[0] * self.solved.shape[1] + self.index[1])

    @property
    def friction_arms(self) -> tuple[Array, Array]:
        """Velocity of pinion's and gear's surface along the sliding direction (n) [m/rad]; zero without sliding.

        Friction of one newton takes as much torque of the pinion [N m], and gives as much to the gear over the ratio.
        """
        v = self.velocities
        sliding = v.along * v.sliding_along + v.across * v.sliding_across
        size = v.sliding_speed
        direction = np.divide(sliding, size, out=np.zeros_like(sliding), where=size > 0.0)
        return dot(v.pinion, direction), dot(v.gear, direction)


def loaded_segments(tree: xr.DataTree) -> xr.Dataset:
    """The group ``/loaded`` with torque, mesh position and segment first; refused if one is missing."""
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
    """All segments of a result and their surface velocities, which are the same at every torque."""

    exists: Bools  # (mesh position, segment)
    velocities: SurfaceVelocities

    def spread(self, values: Array) -> Array:
        """Values (n, ...) at the segments as a field (mesh position, segment, ...), NaN where there is none."""
        field = np.full((*self.exists.shape, *values.shape[1:]), np.nan)
        field[self.exists] = values
        return field


def potential_segments(tree: xr.DataTree) -> PotentialSegments:
    """Velocities at all segments of a result, loaded or not; refused if misalignment depends on torque."""
    loaded, ease_off = loaded_segments(tree), tree["ease_off"].to_dataset()
    _require_one_assembly(tree)
    points = np.stack([loaded[n].values[0] for n in ("lengthwise", "profile")])
    exists = np.isfinite(points[0])
    velocities = surface_velocities(axes_of(ease_off), action_splines(ease_off), points[:, exists])
    return PotentialSegments(exists, velocities)


def _require_one_assembly(tree: xr.DataTree) -> None:
    """Refuse a result whose torques are not in the assembly that its ease-off is of."""
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
    """Segments of a result that carry force; its ``potential_segments`` may be given if known."""
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
