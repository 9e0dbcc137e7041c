"""A gear pair, and the three results of its geometry as labelled datasets: flanks, ease-off and teeth."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import Array, record
from ...core.attributes import flag_attributes, labelled
from ...core.checks import check_fields, instance, two_whole
from ...core.errors import InputError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, NodeStatus, principal_curvatures, solve_flank
from .assembly import Assembly, Misalignment
from .ease_off import Drift, EaseOff, drift, exact_ease_off
from .member_names import MEMBERS as MEMBERS, FlankName as FlankName
from .tooth_body import ShellCoordinates, ToothBody, middle_angle, opposite_surface, tooth_body

#: Fields of an ``EaseOff`` that a result has as they are: numbers, and vectors in space.
NODE_FIELDS = (
    "roll_angle",
    "lever_arm",
    "separation_curvature",
    "separation_skew",
    "pinion_lengthwise",
    "pinion_profile",
)
NODE_VECTORS = ("action_position", "action_normal")
STATUS = flag_attributes({int(s): s.name for s in NodeStatus})


def _on_grid(values: Array, shape: tuple[int, int]) -> Array:
    """Components-first values (..., n) as (lengthwise, profile, ...)."""
    return np.moveaxis(values.reshape(*values.shape[:-1], *shape), (-2, -1), (0, 1))


def flank_dataset(lengthwise: Array, profile: Array, flank: Flank) -> xr.Dataset:
    """One flank of nt * nh nodes, lengthwise-major, on its own grid (lengthwise, profile)."""
    shape = (lengthwise.size, profile.size)
    curvatures = principal_curvatures(flank)
    grid = ("lengthwise", "profile")
    return labelled(
        xr.Dataset(
            {
                "position": ((*grid, "xyz"), _on_grid(flank.position, shape)),
                "normal": ((*grid, "xyz"), _on_grid(flank.normal, shape)),
                "principal_curvature": ((*grid, "principal"), _on_grid(curvatures.curvature, shape)),
                "principal_direction": ((*grid, "xyz"), _on_grid(curvatures.direction, shape)),
                "flank_status": (grid, flank.status.reshape(shape), STATUS),
                "inside": (grid, flank.inside.astype(np.int8).reshape(shape)),
            },
            coords={"lengthwise": lengthwise, "profile": profile, "xyz": list("xyz"), "principal": [1, 2]},
        )
    )


def first_contact(angle: Array, inside: Array) -> float:
    """Smallest value of a field (nt, nh) over its valid nodes, refined by the paraboloid through those around it."""
    row, column = np.unravel_index(np.argmin(np.where(inside, angle, np.inf)), angle.shape)
    least = float(angle[row, column])
    patch = angle[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
    if patch.shape != (3, 3) or not np.all(np.isfinite(patch)) or np.min(patch) < least:
        return least
    gradient = np.array([patch[2, 1] - patch[0, 1], patch[1, 2] - patch[1, 0]]) / 2.0
    mixed = (patch[2, 2] - patch[2, 0] - patch[0, 2] + patch[0, 0]) / 4.0
    bend = np.array([[patch[2, 1] - 2 * least + patch[0, 1], mixed], [mixed, patch[1, 2] - 2 * least + patch[1, 0]]])
    if np.linalg.det(bend) <= 0.0 or bend[0, 0] <= 0.0:
        return least
    return least - 0.5 * float(gradient @ np.linalg.solve(bend, gradient))


def ease_off_dataset(lengthwise: Array, profile: Array, ease_off: EaseOff, drift: Drift) -> xr.Dataset:
    """Ease-off and roll angle on the gear's grid (lengthwise, profile); the ease-off is zero at first contact.

    The attribute ``first_contact_rad`` is the gear rotation to it; others are the ratio and the axes, with a point on
    each, oriented so that the drive rotation is positive.
    """
    shape = (lengthwise.size, profile.size)
    grid = ("lengthwise", "profile")
    zero = first_contact(ease_off.angle.reshape(shape), ease_off.inside.reshape(shape))
    angle = ease_off.angle - zero
    values = {
        "ease_off": 1e3 * angle * ease_off.lever_arm,
        "ease_off_angle": angle,
        **{name: getattr(ease_off, name) for name in NODE_FIELDS},
        **drift.of_fractions,
        "blade_distance": ease_off.blade_distance,
    }
    motion = ease_off.motion
    dataset = xr.Dataset(
        {name: (grid, value.reshape(shape)) for name, value in values.items()}
        | {name: ((*grid, "space"), _on_grid(getattr(ease_off, name), shape)) for name in NODE_VECTORS}
        | {
            "status": (grid, ease_off.status.reshape(shape), STATUS),
            "inside": (grid, ease_off.inside.astype(np.int8).reshape(shape)),
        },
        coords={"lengthwise": lengthwise, "profile": profile, "space": list("xyz")},
        attrs={
            "first_contact_rad": zero,
            "pinion_axis": motion.pinion_axis,
            "pinion_origin_mm": motion.assembly.pinion_origin,
            "gear_axis": motion.gear_axis,
            "gear_origin_mm": motion.assembly.gear_origin,
            "ratio": motion.assembly.ratio,
        },
    )
    return labelled(dataset)


def teeth_dataset(
    lengthwise: Array,
    profile: Array,
    bodies: tuple[ToothBody, ToothBody],
    coordinates: tuple[ShellCoordinates, ShellCoordinates],
) -> xr.Dataset:
    """Both teeth as plates, and the feet of the contact normals, over (member, lengthwise, profile)."""
    shape = (lengthwise.size, profile.size)
    grid = ("member", "lengthwise", "profile")
    ends, edges = ("member", "tooth_end"), ("member", "tooth_end", "plate_edge")
    data: dict[str, Any] = {
        "shell_height": (grid, np.stack([c.height.reshape(shape) for c in coordinates])),
        "shell_arc": (grid, np.stack([c.arc.reshape(shape) for c in coordinates])),
        "depth": (grid, np.stack([c.depth.reshape(shape) for c in coordinates])),
        "shell_direction": ((*grid, "shell_axis"), np.stack([_on_grid(c.direction, shape) for c in coordinates])),
        "trace_length": ("member", [b.trace_length for b in bodies]),
        "trace_radius": ("member", [b.trace_radius for b in bodies]),
        "tooth_height": (ends, np.stack([b.height for b in bodies])),
        "plate_thickness": (edges, np.stack([b.thickness for b in bodies])),
        "fitted_thickness": (edges, np.stack([b.fitted_thickness for b in bodies])),
        "bulge": (ends, np.stack([b.bulge for b in bodies])),
        "fanning": ("member", [b.fanning for b in bodies]),
    }
    coords = {
        "member": ["pinion", "gear"],
        "lengthwise": lengthwise,
        "profile": profile,
        "shell_axis": ["height", "trace", "outward"],
        "tooth_end": ["toe", "heel"],
        "plate_edge": ["root", "tip"],
    }
    return labelled(xr.Dataset(data, coords=coords))


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
        """True if both flanks are cut in one machine set-up, so that the cutter fixes the width of the slot.

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

    @property
    def other(self) -> GeneratingSurface:
        """The opposite flank; if it is not given, that of the other blade in the same machine."""
        return self.opposite or opposite_surface(self.loaded)

    def middle_angle(self) -> tuple[float, float]:
        """Sense of rotation into the tooth, and angle between the middles of its flanks as cut: ``tooth_body``."""
        return middle_angle(self.section, self.loaded, self.other)

    def flank(self, lengthwise: Array, profile: Array) -> Flank:
        """The loaded flank on a grid of fractions (nt) and (nh); nodes in lengthwise-major order."""
        t, h = np.meshgrid(lengthwise, profile, indexing="ij")
        axial, radial = self.section.points(t.ravel(), h.ravel())
        return solve_flank(self.loaded, self.section, axial, radial)

    def middle(self) -> Flank:
        """The loaded flank at its middle, one node."""
        return self.flank(np.array([0.5]), np.array([0.5]))


def shares_set_up(member: Member) -> bool:
    """True if both flanks of a member are cut in one set-up: by one cutter at the same machine settings.

    So are spread-blade and completing members. Unlike ``Member.one_set_up`` it counts face hobbing in.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fh-12x41-45"))
    >>> shares_set_up(pair.gear), shares_set_up(pair.pinion)
    (True, False)
    """
    instance("member", member, Member)
    return member.opposite is not None and member.opposite.settings == member.loaded.settings


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
    """Even fractions along the face and up the profile; too few nodes for a smooth surface are refused."""
    along, up = two_whole("nodes", nodes, 5)
    return np.linspace(0.0, 1.0, along), np.linspace(0.0, 1.0, up)


@record(frozen=True)
class MemberGeometry:
    """Geometry of each member alone on one grid (nt), (nh) of fractions: no assembly error changes it."""

    lengthwise: Array
    profile: Array
    pinion: Flank
    gear: Flank
    bodies: tuple[ToothBody, ToothBody]

    @cached_property
    def flanks(self) -> xr.Dataset:
        """Both flanks on their own grids, over (member, lengthwise, profile); see ``flank_dataset``."""
        each = [flank_dataset(self.lengthwise, self.profile, flank) for flank in (self.pinion, self.gear)]
        names = xr.DataArray(["pinion", "gear"], dims="member", name="member")
        return labelled(xr.concat(each, names, combine_attrs="override"))

    @cached_property
    def gear_feet(self) -> ShellCoordinates:
        """Feet of the normals of the gear flank on the middle surface of the gear's tooth."""
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
        known = self.members

        def flank(member: Member, before: Member, old: Flank) -> Flank:
            return old if member.loaded == before.loaded else member.flank(known.lengthwise, known.profile)

        pinion, gear = flank(pair.pinion, self.pair.pinion, known.pinion), flank(pair.gear, self.pair.gear, known.gear)
        members = MemberGeometry(known.lengthwise, known.profile, pinion, gear, known.bodies)
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
    >>> dataset = ease_off(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> dataset["ease_off"].attrs["units"]
    'um'
    """
    instance("pair", pair, GearPair)
    t, h = grid(nodes)
    exact = _exact_ease_off(pair, pair.gear.flank(t, h))
    return ease_off_dataset(t, h, exact, drift(exact))


def tooth_angles(pair: GearPair) -> tuple[float, float]:
    """Angular thickness of the teeth of pinion and gear in the middle of the flank [rad].

    The gear's is given, else left by its cutter in one set-up, else half the pitch. The pinion's is given, else that of
    the gear's slot: thicker than it admits where the middles do not meet, see ``backlash``.
    """
    gear, pinion = pair.gear, pair.pinion
    gear_angle = _given(gear) or (left_by_cutter(gear) if gear.one_set_up else np.pi / gear.teeth)
    return _given(pinion) or (2.0 * np.pi - gear.teeth * gear_angle) / pinion.teeth, gear_angle


def bodies(pair: GearPair) -> tuple[ToothBody, ToothBody]:
    """Teeth of pinion and gear between their flanks, as thick as ``tooth_angles`` says."""
    pinion_angle, gear_angle = tooth_angles(pair)
    pinion, gear = (
        tooth_body(member.section, member.loaded, member.other, angle)
        for member, angle in ((pair.pinion, pinion_angle), (pair.gear, gear_angle))
    )
    return pinion, gear


def left_by_cutter(member: Member) -> float:
    """Angular thickness [rad] of the tooth between two slots of one set-up."""
    return float(np.mod(member.middle_angle()[1], 2.0 * np.pi / member.teeth))


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
