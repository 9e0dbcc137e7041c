"""A gear pair, and the three results of its geometry: flanks, ease-off and teeth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.checks import check_fields, frozen_arrays, instance, two_whole
from ...core.errors import InputError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, solve_flank
from .assembly import Assembly, Misalignment
from .datasets import ease_off_dataset, flank_dataset, flanks_dataset, teeth_dataset
from .ease_off import EaseOff, exact_ease_off
from .rolling import Drift, drift
from .tooth_body import ShellCoordinates, ToothBody, middle_angle, opposite_surface, tooth_body

Array = NDArray[Any]
FlankName = Literal["drive", "coast"]
MEMBERS = ("pinion", "gear")
DEFAULT_NODES = (31, 21)


@dataclass(frozen=True)
class Member:
    """One member of a pair, seen from the flank that carries the load.

    Parameters
    ----------
    teeth
        Number of teeth.
    section
        Axial section of the blank.
    loaded
        Generating surface of the loaded flank.
    opposite
        Generating surface of the other flank; ``None`` for the other blade in the same machine.
    mean_thickness
        Normal circular thickness in the middle of the flank [mm]; ``None`` to let the flanks or the mate decide.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> gear = gear_pair(read_case("nasa-12x36")).gear
    >>> gear.teeth, gear.flank(np.array([0.0, 1.0]), np.array([0.5])).position.shape
    (36, (3, 2))
    """

    teeth: int
    section: BlankSection
    loaded: GeneratingSurface
    opposite: GeneratingSurface | None = None
    mean_thickness: float | None = None

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def one_set_up(self) -> bool:
        """Whether both flanks are cut in one machine set-up, so that the cutter fixes the width of the slot.

        Not so for face hobbing: there the slot comes from the timing of the blades within their group.
        """
        settings = self.loaded.settings
        return self.opposite is not None and self.opposite.settings == settings and settings.indexing_ratio == 0.0

    @property
    def from_opposite(self) -> Member:
        """The same member seen from its other flank.

        Raises
        ------
        InputError
            If it does not know its other flank.
        """
        if self.opposite is None:
            raise InputError("the member has one flank only: give the settings of the other one, too")
        return replace(self, loaded=self.opposite, opposite=self.loaded)

    def flank(self, lengthwise: Array, profile: Array) -> Flank:
        """The loaded flank on a grid of fractions (nt) and (nh); nodes in lengthwise-major order."""
        t, h = np.meshgrid(lengthwise, profile, indexing="ij")
        axial, radial = self.section.points(t.ravel(), h.ravel())
        return solve_flank(self.loaded, self.section, axial, radial)

    def middle(self) -> Flank:
        """The loaded flank at its middle, one node."""
        return self.flank(np.array([0.5]), np.array([0.5]))


@dataclass(frozen=True)
class GearPair:
    """A pinion and a gear in mesh.

    Parameters
    ----------
    pinion, gear
        The members, seen from the flanks in contact.
    assembly
        Axes and misalignment.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> pair.assembly.ratio
    3.0
    """

    pinion: Member
    gear: Member
    assembly: Assembly

    def __post_init__(self) -> None:
        check_fields(self)

    def misaligned(self, misalignment: Misalignment) -> GearPair:
        """The same pair with other assembly errors."""
        return replace(self, assembly=self.assembly.misaligned(misalignment))


def grid(nodes: tuple[int, int]) -> tuple[Array, Array]:
    """Even fractions along the face and up the profile.

    Raises
    ------
    InputError
        If there are too few nodes for a smooth surface.
    """
    along, up = two_whole("nodes", nodes, 5)
    return np.linspace(0.0, 1.0, along), np.linspace(0.0, 1.0, up)


@frozen_arrays
@dataclass(frozen=True)
class MemberGeometry:
    """What the geometry of a pair has of each member alone: no assembly error changes it.

    Parameters
    ----------
    lengthwise, profile
        Fractions of the grid, the same on both flanks (nt), (nh).
    pinion, gear
        Loaded flanks on that grid, each on its own blank.
    bodies
        Teeth of pinion and gear.
    """

    lengthwise: Array
    profile: Array
    pinion: Flank
    gear: Flank
    bodies: tuple[ToothBody, ToothBody]

    @cached_property
    def flanks(self) -> xr.Dataset:
        """Both flanks as a dataset."""
        return flanks_dataset(self.lengthwise, self.profile, self.pinion, self.gear)

    @cached_property
    def gear_feet(self) -> ShellCoordinates:
        """Where the normals of the gear flank meet the middle surface of the gear's tooth."""
        return self.bodies[1].shell_coordinates(self.gear.position, self.gear.normal)


@dataclass(frozen=True)
class PairGeometry:
    """The three results of a pair's geometry, on one grid of the gear flank, and what they were made of.

    Parameters
    ----------
    pair
        The pair.
    members
        Results of each member alone.
    exact
        Ease-off of the pair's flanks at the nodes, with the conjugate motion and the conjugate points of the pinion.
    drift
        Velocity and acceleration of those points past the nodes.
    ease_off
        Ease-off and surface of roll angle as a dataset: made of ``exact``, or updated for deviations or a modification,
        which leave ``exact`` as it is.
    teeth
        Both teeth as plates, and where contact forces meet them.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> dict(geometry.ease_off["ease_off"].sizes)
    {'lengthwise': 9, 'profile': 7}
    >>> geometry.misaligned(Misalignment(offset=0.05)).flanks is geometry.flanks
    True
    """

    pair: GearPair
    members: MemberGeometry
    exact: EaseOff
    drift: Drift
    ease_off: xr.Dataset
    teeth: xr.Dataset

    @property
    def nodes(self) -> tuple[int, int]:
        """Grid nodes lengthwise and along the profile."""
        return self.members.lengthwise.size, self.members.profile.size

    @property
    def flanks(self) -> xr.Dataset:
        """Both flanks, each on its own blank."""
        return self.members.flanks

    def misaligned(self, misalignment: Misalignment) -> PairGeometry:
        """Geometry of the same flanks in another assembly; updates of ``ease_off`` are not carried over.

        Raises
        ------
        GeometryError
            If the flanks do not meet.
        """
        pair = self.pair.misaligned(misalignment)
        return _in_mesh(pair, self.members, _exact_ease_off(pair, self.members.gear))

    def recut(self, pair: GearPair) -> PairGeometry:
        """Geometry of a pair with other settings of its flanks in the same blanks; the tooth bodies stay as they are.

        Parameters
        ----------
        pair
            The pair with the other settings, in any assembly.

        Raises
        ------
        GeometryError
            If a cutter meets no tooth of its blank, or the flanks do not meet.
        """
        own = self.members
        pinion, gear = (
            flank if member.loaded == before.loaded else member.flank(own.lengthwise, own.profile)
            for member, before, flank in (
                (pair.pinion, self.pair.pinion, own.pinion),
                (pair.gear, self.pair.gear, own.gear),
            )
        )
        members = MemberGeometry(own.lengthwise, own.profile, pinion, gear, own.bodies)
        return _in_mesh(pair, members, _exact_ease_off(pair, gear))


def pair_geometry(pair: GearPair, nodes: tuple[int, int] = DEFAULT_NODES) -> PairGeometry:
    """Everything the contact needs to know of a pair, computed once.

    Parameters
    ----------
    pair
        The gear pair, with its misalignment.
    nodes
        Grid nodes lengthwise and along the profile.

    Raises
    ------
    InputError
        If the grid is too coarse.
    GeometryError
        If a cutter meets no tooth of its blank, the flanks do not meet, or they leave no tooth between them.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> geometry.teeth["member"].values.tolist()
    ['pinion', 'gear']
    """
    instance("pair", pair, GearPair)
    t, h = grid(nodes)
    gear = pair.gear.flank(t, h)
    exact = _exact_ease_off(pair, gear)
    return _in_mesh(pair, MemberGeometry(t, h, pair.pinion.flank(t, h), gear, bodies(pair)), exact)


def _exact_ease_off(pair: GearPair, gear: Flank) -> EaseOff:
    return exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)


def _in_mesh(pair: GearPair, members: MemberGeometry, exact: EaseOff) -> PairGeometry:
    """The geometry of a pair from its members and their ease-off."""
    t, h = members.lengthwise, members.profile
    pinion_feet = members.bodies[0].shell_coordinates(exact.pinion_position, exact.pinion_normal)
    teeth = teeth_dataset(t, h, members.bodies, (pinion_feet, members.gear_feet))
    moving = drift(exact)
    return PairGeometry(pair, members, exact, moving, ease_off_dataset(t, h, exact, moving), teeth)


def flank(member: Member, nodes: tuple[int, int] = DEFAULT_NODES) -> xr.Dataset:
    """The loaded flank of one member on its own blank: positions, normals, curvatures over (lengthwise, profile).

    Raises as ``pair_geometry``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pinion = gear_pair(read_case("nasa-12x36")).pinion
    >>> flank(pinion, (9, 7))["position"].sizes["xyz"]
    3
    """
    instance("member", member, Member)
    t, h = grid(nodes)
    return flank_dataset(t, h, member.flank(t, h))


def ease_off(pair: GearPair, nodes: tuple[int, int] = DEFAULT_NODES) -> xr.Dataset:
    """Ease-off and surface of roll angle over (lengthwise, profile) of the gear (Kolivand 2009, chapter 2).

    Raises as ``pair_geometry``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> found = ease_off(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> found["ease_off"].attrs["units"]
    'um'
    """
    instance("pair", pair, GearPair)
    t, h = grid(nodes)
    exact = _exact_ease_off(pair, pair.gear.flank(t, h))
    return ease_off_dataset(t, h, exact, drift(exact))


def tooth_angles(pair: GearPair) -> tuple[float, float]:
    """Angular thickness of the teeth of pinion and gear in the middle of the flank [rad].

    The gear's is the one given, or what its cutter leaves if one set-up cuts both flanks, or half the pitch. The
    pinion's is the one given, or else that of the gear's slot in the middle of the gear's flank: thicker than the slot
    admits where the middles do not meet, see ``backlash``.

    Raises
    ------
    GeometryError
        If a cutter meets no tooth of its blank.
    """
    gear, pinion = pair.gear, pair.pinion
    gear_angle = _given(gear) or (_left_by_cutter(gear) if gear.one_set_up else np.pi / gear.teeth)
    return _given(pinion) or (2.0 * np.pi - gear.teeth * gear_angle) / pinion.teeth, gear_angle


def bodies(pair: GearPair) -> tuple[ToothBody, ToothBody]:
    """Teeth of pinion and gear between their flanks, as thick as ``tooth_angles`` says.

    Raises
    ------
    GeometryError
        If the flanks of a member leave no tooth.
    """
    pinion_angle, gear_angle = tooth_angles(pair)
    return _body(pair.pinion, pinion_angle), _body(pair.gear, gear_angle)


def _body(member: Member, mean_angle: float) -> ToothBody:
    opposite = member.opposite or opposite_surface(member.loaded)
    return tooth_body(member.section, member.loaded, opposite, mean_angle)


def _left_by_cutter(member: Member) -> float:
    """Angular thickness [rad] of the tooth between two slots of one set-up."""
    opposite = member.opposite or opposite_surface(member.loaded)
    _, angle = middle_angle(member.section, member.loaded, opposite)
    return float(np.mod(angle, 2.0 * np.pi / member.teeth))


def _given(member: Member) -> float | None:
    """Angular thickness [rad] from the given normal thickness, or ``None``."""
    return None if member.mean_thickness is None else member.mean_thickness / thickness_per_angle(member)


def thickness_per_angle(member: Member) -> float:
    """Normal circular thickness per angle about the member's axis, in the middle of the flank [mm/rad]."""
    middle = member.middle()
    return float(np.hypot(middle.position[0, 0], middle.position[1, 0])) * spiral_cosine(middle, member.section)


def spiral_cosine(point: Flank, section: BlankSection) -> float:
    """Cosine of the spiral angle at the only point of a flank: normal arc over circumferential arc."""
    position, normal = point.position[:, 0], point.normal[:, 0]
    radius = float(np.hypot(position[0], position[1]))
    # Circumferential arc to normal arc: the flank's normal without its part along the pressure angle.
    circumferential = (position[0] * normal[1] - position[1] * normal[0]) / radius
    up = np.array([-np.sin(section.pitch_angle), np.cos(section.pitch_angle)])
    outward = np.array([position[0] / radius * up[1], position[1] / radius * up[1], up[0]])
    in_pitch_plane = np.sqrt(1.0 - float(normal @ outward) ** 2)
    return float(abs(circumferential) / in_pitch_plane)
