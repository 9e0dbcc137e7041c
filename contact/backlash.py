"""Backlash of a pair: rotation of the gear from contact on the loaded flanks to contact on the others, pinion held.

Each contact is a gap, as a gear rotation, from where the machines cut the flanks. The thickness of the teeth turns the
other flank of either member from there (``placed_flanks``). The angle between both contacts, less whole pitches, is the
backlash. Its derivatives by assembly errors are those of both gaps, along the normals at the points of contact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np
import xarray as xr

from ..core.arrays import Array
from ..core.attributes import labelled, ordered
from ..core.checks import instance
from ..core.errors import GeometryError
from ..geometry.flanks.flank import solve_flank
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.conjugate_motion import ConjugateMotion
from ..geometry.pair.gear_pair import GearPair, Member, PairGeometry, pair_geometry, spiral_cosine, tooth_angles
from ..geometry.tooth.tooth_flanks import placing_rotation
from ..geometry.vectors import cross, dot, rotate_z
from .lines.touching_points import touching_points
from .lines.turned_flanks import TurnedFlanks

OTHER_NODES = (21, 15)  # of the flanks that do not carry; the gap at a point is exact on any grid
ERRORS = tuple(each.name for each in fields(Misalignment))


def backlash_unknown(pair: GearPair) -> str:
    """Reason why the backlash of a pair is not known; empty if it is.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> backlash_unknown(gear_pair(read_case("nasa-12x36")))
    'the thickness of the teeth of the pinion is not given'
    """
    instance("pair", pair, GearPair)
    for name, member in (("pinion", pair.pinion), ("gear", pair.gear)):
        if member.opposite is None:
            return f"the other flank of the {name} is not given"
    for name, known in (("gear", pair.gear.one_set_up), ("pinion", False)):
        if getattr(pair, name).mean_thickness is None and not known:
            return f"the thickness of the teeth of the {name} is not given"
    return ""


def backlash(geometry: PairGeometry, unloaded: xr.Dataset) -> xr.Dataset:
    """Backlash over a mesh cycle, without load.

    Parameters
    ----------
    geometry
        The pair in its assembly, with both flanks of both members and the thickness of their teeth.
    unloaded
        Its unloaded contact, as of ``MeshCycle.unloaded``.

    Returns
    -------
    xr.Dataset
        Over ``mesh_position``: the rotation of the gear [urad]; the backlash at the gear's mean point and at its heel
        on the pitch cone, along the pitch circle (transverse) and between the flanks (normal) [mm]; derivatives of the
        outer normal backlash by the assembly errors, and, without a dimension, by the mean normal circular thickness of
        a tooth. Negative where the teeth do not fit, NaN where flanks do not touch.

    Raises
    ------
    GeometryError
        If it is not known (``backlash_unknown``), or the other flanks do not meet.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> thin = [replace(member, mean_thickness=4.0) for member in (pair.pinion, pair.gear)]
    >>> geometry = pair_geometry(replace(pair, pinion=thin[0], gear=thin[1]), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> bool((backlash(geometry, cycle.unloaded())["outer_normal_backlash"] > 0.0).all())
    True
    """
    instance("geometry", geometry, PairGeometry)
    pair = geometry.pair
    if reason := backlash_unknown(pair):
        raise GeometryError(f"the backlash is not known: {reason}")
    other = pair_geometry(replace(pair, pinion=pair.pinion.from_opposite, gear=pair.gear.from_opposite), OTHER_NODES)
    ratio, pitch, sense = pair.assembly.ratio, pair.assembly.pinion_pitch, geometry.exact.motion.pinion_sense
    designed = replace(pair, pinion=_designed(pair.pinion), gear=_designed(pair.gear))
    pinion_turn, gear_turn = map(placing_rotation, (designed.pinion, designed.gear), tooth_angles(designed))
    rolled, envelope, points = _carrying(unloaded, pitch)
    gap = geometry.ease_off.attrs["first_contact_rad"] + envelope
    # The other flanks drive in the other sense, from where their own machines cut them.
    turned = unloaded["pinion_rotation"].values + geometry.exact.motion.center
    other_turned = -(turned + sense * pinion_turn) - other.exact.motion.center
    other_rolled, other_gap, other_points = _smallest_gap(other, other_turned, pitch)
    play = gap + other_gap + sense * (pinion_turn / ratio + gear_turn)
    known = play[np.isfinite(play)]
    if known.size:
        play = play - pitch / ratio * np.round(np.median(known) / (pitch / ratio))
    slopes = _error_slopes(geometry, rolled, gap, points) + _error_slopes(other, other_rolled, other_gap, other_points)
    section = pair.gear.section
    (mean, mean_arm, mean_cosine), (outer, outer_arm, _) = (
        _radius_arm_and_cosine(pair.gear, each) for each in (section.middle_distance, section.outer_cone_distance)
    )
    values = {
        "backlash_rotation": 1e6 * play,
        "mean_transverse_backlash": mean * play,
        "mean_normal_backlash": mean_arm * play,
        "outer_transverse_backlash": outer * play,
        "outer_normal_backlash": outer_arm * play,
        **{f"backlash_by_{name}": outer_arm * slope for name, slope in zip(ERRORS, slopes, strict=True)},
    }
    coordinates = {"mesh_position": unloaded["mesh_position"].values}
    dataset = xr.Dataset({name: ("mesh_position", each) for name, each in values.items()}, coords=coordinates)
    return labelled(dataset.assign(backlash_by_thickness=-outer_arm / (mean * mean_cosine)))


def _designed(member: Member) -> Member:
    """The member without a deviation, which does not turn its teeth."""
    return replace(member, loaded=member.loaded.designed)


def _carrying(unloaded: xr.Dataset, pitch: float) -> tuple[Array, Array, Array]:
    """Roll angle of the tooth pair that carries (k) [rad], its gap (k) [rad] and its point (2, k) of the gear flank."""
    error, along, up = (
        ordered(unloaded, name, "pair", "mesh_position")
        for name in ("transmission_error", "path_lengthwise", "path_profile")
    )
    best, column = np.argmin(np.where(np.isfinite(error), error, np.inf), axis=0), np.arange(error.shape[1])
    rolled = unloaded["pinion_rotation"].values - pitch * unloaded["pair"].values[best]
    return rolled, 1e-6 * error[best, column], np.stack([along, up])[:, best, column]


def _smallest_gap(geometry: PairGeometry, rolled: Array, pitch: float) -> tuple[Array, Array, Array]:
    """The same of the tooth pair that touches first, at pinion rotations of one of them (k) [rad]."""
    roll = geometry.exact.roll_angle[geometry.exact.inside]
    low, high = (float(roll.min()) - pitch, float(roll.max()) + pitch)
    pairs = np.arange(math.floor((low - rolled.max()) / pitch), math.ceil((high - rolled.min()) / pitch) + 1)
    every = rolled + pairs[:, None] * pitch
    touching = touching_points(TurnedFlanks(geometry), every.ravel())
    gaps = np.where(np.isfinite(touching.gap), touching.gap, np.inf).reshape(every.shape)
    best, column = np.argmin(gaps, axis=0), np.arange(rolled.size)
    least = np.where(np.isfinite(gaps[best, column]), gaps[best, column], np.nan)
    points = touching.points.reshape(2, *every.shape)[:, best, column]
    return every[best, column], geometry.ease_off.attrs["first_contact_rad"] + least, points


def _error_slopes(geometry: PairGeometry, rolled: Array, gap: Array, points: Array) -> Array:
    """Derivatives (4, k) of gaps (k) [rad] by the assembly errors, at roll angles (k) and points of the gear (2, k)."""
    gear, motion = geometry.pair.gear, geometry.exact.motion
    flank = solve_flank(gear.loaded, gear.section, *gear.section.points(*points))
    turn = -motion.pinion_sense * ((rolled + motion.center) / motion.assembly.ratio - gap)
    position, normal = rotate_z(turn, flank.position), rotate_z(turn, flank.normal)
    return np.stack([dot(normal, moved) for moved in _displacements(motion, position)]) / _arm(position, normal)


def _displacements(motion: ConjugateMotion, position: Array) -> Sequence[Array]:
    """Displacements (3, n) of the pinion against the gear at points (3, n), by each of the assembly errors."""
    assembly = motion.assembly
    side = 1.0 if assembly.pinion_hand == "left" else -1.0
    whole = np.ones_like(position)
    upward, across = np.array([[0.0], [0.0], [1.0]]), np.array([[0.0], [1.0], [0.0]])
    space = position + assembly.gear_origin[:, None]
    return (
        side * across * whole,
        assembly.pinion_frame[:, 2:] * whole,
        -upward * whole,
        cross(across * whole, space),
    )


def _radius_arm_and_cosine(gear: Member, distance: float) -> tuple[float, float, float]:
    """Pitch radius at a cone distance, mean lever arm of both flanks [mm], and mean cosine of their spiral angles."""
    place = gear.section.on_pitch_cone(distance)
    flanks = [solve_flank(each, gear.section, *place[:, None]) for each in (gear.loaded, gear.other)]
    arms, cosines = zip(*((_arm(e.position, e.normal), spiral_cosine(e, gear.section)) for e in flanks), strict=True)
    return float(place[1]), float(np.mean(arms)), float(np.mean(cosines))


def _arm(position: Array, normal: Array) -> Array:
    """Lever arms (n) of normals at points (3, n) about the gear's axis."""
    return np.asarray(np.abs(position[0] * normal[1] - position[1] * normal[0]))
