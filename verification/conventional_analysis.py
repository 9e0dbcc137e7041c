"""Ease-off method against conventional contact analysis: error, path, direction and length of the contact line.

Conventional analysis knows the flanks and nothing of ease-off or roll angle: five equations give the point of contact,
both members' curvatures the line through it, as the major axis of an ellipse. The ellipse is of second order: by the
flanks' symmetric third-order terms both direction and length of a true line differ from it in proportion to the
separation at which the line ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..contact.lines.closest_approach import closest_approach
from ..contact.lines.contact_lines import contact_splines
from ..contact.lines.flank_splines import FlankSplines
from ..contact.lines.mesh_lines import MeshLines, lines_in_mesh
from ..contact.unloaded import unloaded_contact
from ..core.checks import frozen_arrays
from ..geometry.flanks.seed_lattice import seed_lattice
from ..geometry.pair.conjugate_motion import ConjugateMotion
from ..geometry.pair.gear_pair import DEFAULT_NODES, GearPair, Member, PairGeometry, pair_geometry
from ..geometry.vectors import dot
from .point_contact import PointContact, path_of_contact
from .relative_curvature import RelativeCurvature, relative_curvature

Array = NDArray[Any]
EDGE_MARGIN = 0.02  # fraction of face and profile; nearer to an edge the contact leaves the clipped contact line
BLADE_DISTANCE_MARGIN = 0.1  # [mm]


@frozen_arrays
@dataclass(frozen=True)
class BothMethods:
    """Analysis of a pair by both methods at n rotations, tooth pair by tooth pair.

    Parameters
    ----------
    geometry
        Geometry of the ease-off method.
    splines, mesh
        Its splines and contact lines.
    contact
        Conventional points of contact; NaN where they did not converge.
    relative
        Relative curvature there.
    inside
        Where the point of contact lies within both flanks, by a margin (n).
    first_contact
        Closing angle at which the ease-off method counts its error zero [rad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> both = both_methods(pair, (9, 7), mesh_positions=2)
    >>> bool(both.inside.any()), sorted(both.unloaded().sizes)
    (True, ['end', 'fine_position', 'mesh_position', 'pair'])
    """

    geometry: PairGeometry
    splines: FlankSplines
    mesh: MeshLines
    contact: PointContact
    relative: RelativeCurvature
    inside: NDArray[np.bool_]
    first_contact: float

    @property
    def motion(self) -> ConjugateMotion:
        """The conjugate motion of the ease-off method."""
        return self.geometry.exact.motion

    def unloaded(self, separation: float = 6.0) -> xr.Dataset:
        """The ease-off method's unloaded contact, lines ending at a separation [um]; of the pairs that have lines."""
        found = unloaded_contact(self.geometry, self.splines, self.mesh, separation=separation)
        return found.sel(pair=np.unique(self.mesh.pair))


def both_methods(pair: GearPair, nodes: tuple[int, int] = DEFAULT_NODES, mesh_positions: int = 48) -> BothMethods:
    """Analyse a pair by the ease-off method and conventionally.

    Parameters
    ----------
    pair
        The pair, with its misalignment.
    nodes
        Grid of the ease-off method.
    mesh_positions
        Rotations in a pitch; every tooth pair counts.

    Raises
    ------
    GeometryError
        As ``geometry.pair_geometry``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> both = both_methods(pair, (9, 7), mesh_positions=2)
    >>> bool(both.contact.converged[both.inside].all())
    True
    """
    return methods_compared(pair_geometry(pair, nodes), mesh_positions)


def methods_compared(geometry: PairGeometry, mesh_positions: int = 48) -> BothMethods:
    """As ``both_methods``, from a geometry: the ease-off method takes its ease-off, the conventional one its flanks.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> both = methods_compared(geometry, mesh_positions=2)
    >>> bool(both.contact.converged[both.inside].all())
    True
    """
    pair, gear, surface = geometry.pair, geometry.members.gear, geometry.exact
    splines = contact_splines(geometry.flanks, geometry.ease_off)
    mesh = lines_in_mesh(splines, pair.assembly.pinion_pitch, mesh_positions)
    pairs = np.unique(mesh.pair)
    rotation = (mesh.rotations[None, :] - pairs[:, None] * pair.assembly.pinion_pitch).ravel()
    contact = path_of_contact(gear, surface, rotation)
    on_gear = _on_flank(pair.gear, contact.gear_position, contact.gear_parameters)
    on_pinion = _on_flank(pair.pinion, contact.pinion_position, contact.pinion_parameters)
    inside = contact.converged & on_gear & on_pinion
    relative = relative_curvature(surface.motion, pair.gear.loaded, contact)
    zero = geometry.ease_off.attrs["first_contact_rad"]
    return BothMethods(geometry, splines, mesh, contact, relative, inside, zero)


def _on_flank(member: Member, position: Array, parameters: Array) -> NDArray[np.bool_]:
    """Where points (3, n) with surface parameters (2, n) lie within a flank by the margins, and are not undercut."""
    fractions = np.stack(member.section.fractions(position[2], np.hypot(position[0], position[1])))
    with np.errstate(invalid="ignore"):
        valid_side = (
            member.loaded.orientation(parameters) * seed_lattice(member.loaded, member.section).orientation > 0.0
        )
        cut = member.loaded.evaluate(parameters)[2] > BLADE_DISTANCE_MARGIN
    return np.asarray(np.all(np.abs(fractions - 0.5) < 0.5 - EDGE_MARGIN, axis=0) & valid_side & cut)


def point_differences(both: BothMethods) -> tuple[Array, Array]:
    """Differences of transmission error (n) [rad] and of the point of contact on the gear flank (n) [mm].

    NaN where the point of contact is not inside both flanks.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> error, away = point_differences(both_methods(pair, (15, 11), mesh_positions=2))
    >>> bool(np.nanmax(np.abs(error)) < 1e-6), bool(np.nanmax(away) < 0.1)
    (True, True)
    """
    own = both.unloaded()
    error, t, h = (_flat(own, name)[0] for name in ("transmission_error", "path_lengthwise", "path_profile"))
    point = both.splines("position", np.stack([t, h]))
    away = np.linalg.norm(point - both.contact.gear_position, axis=0)
    difference = 1e-6 * error - (both.contact.closing_angle - both.first_contact)
    return np.where(both.inside, difference, np.nan), np.where(both.inside, away, np.nan)


def line_differences(both: BothMethods, separation: float) -> tuple[Array, Array]:
    """Differences between the contact line and the major axis of the contact ellipse.

    Parameters
    ----------
    both
        From ``both_methods``.
    separation
        Of the flanks at the ends of the line [um].

    Returns
    -------
    tuple
        Angle about the gear's normal (n) [rad] from the major axis to the chord between the points of closest approach
        at both ends, and length over that of the major axis, less one (n). NaN where the edge of a flank ends the line.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> angle, longer = line_differences(both_methods(pair, (15, 11), mesh_positions=2), separation=3.0)
    >>> bool(np.nanmax(np.abs(angle)) < 0.1), bool(np.nanmax(np.abs(longer)) < 0.1)
    (True, True)
    """
    own = both.unloaded(separation)
    ends = np.stack([_flat(own, "line_lengthwise"), _flat(own, "line_profile")])
    smallest, length = 1e-6 * _flat(own, "transmission_error")[0], _flat(own, "line_length")[0]
    closest = closest_approach(both.splines, ends)
    gap = 1e3 * (closest.separation_angle - smallest) * closest.lever_arm
    whole = both.inside & np.all(np.abs(gap / separation - 1.0) < 0.01, axis=0)
    start, end = both.splines("position", ends + closest.shift).swapaxes(0, 1)
    chord = end - start
    relative = both.relative
    with np.errstate(invalid="ignore"):
        chord = chord * np.sign(dot(chord, relative.line))
        angle = np.arctan2(dot(chord, relative.across), dot(chord, relative.line))
        longer = length / (2.0 * relative.half_length(1e-3 * separation)) - 1.0
    return np.where(whole, angle, np.nan), np.where(whole, longer, np.nan)


def _flat(dataset: xr.Dataset, name: str) -> Array:
    """A variable over tooth pairs and mesh positions as (1 or 2, n)."""
    variable = dataset[name].transpose("pair", "mesh_position", ...).values
    return np.asarray(variable.reshape(variable.shape[0] * variable.shape[1], -1).T)
