"""A shaft on bearings that holds a member: sections, bearings, what every one carries, and the support that it is.

Force method: the shaft is held where the member sits, and released there. With the loads r of the bearings on the
shaft, the twist q of the member, the compliance F of the held beam between the bearings and that of the bearings,
(F + K^-1) r = -R q and R' r = -w. The beam is exact, and bearings may be as stiff as one likes.

The beam is round and stepped, with stretching, torsion, and bending in two planes with shear (Timoshenko). The
compliance of a cylindrical piece follows from the unit-load theorem in closed form. Pieces in a row carry the same
wrench, taken about one point, so their compliances about that point add up: without nodes, elements or meshing error.


"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array, record
from ...core.checks import array, bounded, check_fields, number, shown
from ...core.errors import InputError
from ...geometry.pair.assembly import Assembly
from ...geometry.tooth.tooth_flanks import MemberName
from ..compliance.material import Material
from ..lines.flank_splines import MonotoneCubic
from .support import ORIGIN, BearingReaction, Support, Supports, shift_matrix, shifted_wrench

POSITION = bounded("mm", least=-5000.0, most=5000.0)  # along the axis, either way
DIAMETER_RANGE = (1.0, 2000.0)  # [mm]
WALL_MINIMUM = 0.01  # outer less inner diameter over the outer one


def shear_coefficient(diameter_ratio: float, poisson_ratio: float) -> float:
    """Cowper's shear coefficient of a section by inner over outer diameter (1966, doi:10.1115/1.3625046)."""
    ratio, nu = diameter_ratio**2, poisson_ratio
    ring = (1.0 + ratio) ** 2
    return 6.0 * (1.0 + nu) * ring / ((7.0 + 6.0 * nu) * ring + (20.0 + 12.0 * nu) * ratio)


@dataclass(frozen=True)
class ShaftSection:
    """A cylindrical section of a shaft, from start to end along its axis [mm]."""

    start: float = field(metadata=POSITION)
    end: float = field(metadata=POSITION)
    outer_diameter: float = field(metadata=bounded("mm", least=DIAMETER_RANGE[0], most=DIAMETER_RANGE[1]))
    inner_diameter: float = field(default=0.0, metadata=bounded("mm", least=0.0))

    def __post_init__(self) -> None:
        check_fields(self)
        if self.end <= self.start:
            raise InputError(f"end = {shown(self.end)}: must be greater than start = {shown(self.start)} [mm]")
        if self.inner_diameter >= self.outer_diameter:
            raise InputError(
                f"inner_diameter = {shown(self.inner_diameter)}: must be smaller than outer_diameter = "
                f"{shown(self.outer_diameter)} [mm]"
            )
        if self.inner_diameter > (1.0 - WALL_MINIMUM) * self.outer_diameter:
            raise InputError(
                f"inner_diameter = {shown(self.inner_diameter)}: must leave a wall, at most "
                f"{shown((1.0 - WALL_MINIMUM) * self.outer_diameter)} [mm]"
            )

    @property
    def area(self) -> float:
        """Area of the cross section [mm^2]."""
        return math.pi / 4.0 * (self.outer_diameter**2 - self.inner_diameter**2)

    @property
    def second_moment(self) -> float:
        """Second moment of area about a diameter [mm^4]; the polar one is twice that."""
        return math.pi / 64.0 * (self.outer_diameter**4 - self.inner_diameter**4)


STIFFNESS_LIMIT = 1e15  # [N/mm, N mm/rad]
POINT_COUNT_LIMIT = 1000  # of a curve


@dataclass(frozen=True)
class StiffnessCurve:
    """Stiffness of a bearing that depends on its load, by increasing loads and displacements.

    A monotone cubic on logarithmic scales, exact for a power law such as that of a line contact; beyond the loads the
    stiffness is that of the curve's end.
    """

    load: tuple[float, ...]  # [N, or N mm]
    displacement: tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("load", "displacement"):
            values = array(name, getattr(self, name), "N, mm, N mm, rad", ndim=1, fewest=2, above=0.0)
            if np.any(np.diff(values) <= 0.0):
                raise InputError(f"{name} = {shown(values)}: must increase from point to point")
            object.__setattr__(self, name, tuple(values.tolist()))
        if not len(self.load) == len(self.displacement) <= POINT_COUNT_LIMIT:
            raise InputError(
                f"{len(self.load)} loads and {len(self.displacement)} displacements: must be as many of both, at most "
                f"{POINT_COUNT_LIMIT}"
            )

    @classmethod
    def of_stiffness(cls, points: Sequence[tuple[float, float]]) -> StiffnessCurve:
        """The curve of points (load, load over displacement), refused if the displacement falls."""
        table = array("points", points, "N, N/mm", ndim=2, above=0.0)
        if table.shape[1] != 2:
            raise InputError(f"points = {shown(points)}: must be pairs of load and stiffness")
        displacement = table[:, 0] / table[:, 1]
        for (before, now), (load, stiffness) in zip(itertools.pairwise(displacement), table[1:], strict=True):
            if now <= before:
                raise InputError(
                    f"stiffness {shown(stiffness)} at load {shown(load)}: must be load over displacement, smaller than "
                    f"{shown(load / before)}: with it the displacement would not grow with the load"
                )
        return cls(tuple(table[:, 0]), tuple(displacement))

    @cached_property
    def _logarithms(self) -> MonotoneCubic:
        return MonotoneCubic(np.log(self.load), np.log(self.displacement))

    def stiffness(self, load: float) -> float:
        """Load over displacement at a load [N/mm, or N mm/rad]; of load zero that of the first point."""
        within = float(np.log(np.clip(abs(load), self.load[0], self.load[-1])))
        within = min(max(within, float(self._logarithms.places[0])), float(self._logarithms.places[-1]))
        return float(np.exp(within - self._logarithms(np.array(within))))


Stiffness = float | StiffnessCurve


@dataclass(frozen=True)
class Bearing:
    """A bearing at a place of a shaft. It leaves the rotation about the axis free; a stiffness of zero is none."""

    name: str
    position: float = field(metadata=POSITION)  # on the axis [mm]; of a taper roller bearing its load centre
    radial: Stiffness  # [N/mm]
    axial: Stiffness = 0.0  # [N/mm], both senses alike
    tilting: Stiffness = 0.0  # [N mm/rad]

    def __post_init__(self) -> None:
        check_fields(self)
        for name, unit in (("radial", "N/mm"), ("axial", "N/mm"), ("tilting", "N mm/rad")):
            if not isinstance(value := getattr(self, name), StiffnessCurve):
                number(f"{name} stiffness", value, unit, least=0.0, most=STIFFNESS_LIMIT)
        if not np.any(self.stiffness > 0.0):
            raise InputError(f"bearing {self.name}: must have a stiffness above 0: radial, axial or tilting")

    @property
    def is_linear(self) -> bool:
        """True if no stiffness depends on the load."""
        return not any(isinstance(value, StiffnessCurve) for value in (self.radial, self.axial, self.tilting))

    def _at(self, loads: Sequence[float]) -> list[float]:
        """Radial, axial and tilting stiffness at loads."""
        each = zip((self.radial, self.axial, self.tilting), loads, strict=True)
        return [value.stiffness(load) if isinstance(value, StiffnessCurve) else value for value, load in each]

    @property
    def stiffness(self) -> Array:
        """Stiffness (5) along x, y, z and about x and y [N/mm, N mm/rad]; of curves that without load."""
        radial, axial, tilting = self._at((0.0, 0.0, 0.0))
        return np.array([radial, radial, axial, tilting, tilting], dtype=np.float64)

    def under(self, load: Array) -> Bearing:
        """The linear bearing with the stiffness, load over displacement, of a load (6) on it [N, N mm]."""
        sizes = float(np.hypot(*load[:2])), float(load[2]), float(np.hypot(*load[3:5]))
        radial, axial, tilting = self._at(sizes)
        return replace(self, radial=radial, axial=axial, tilting=tilting)


SECTION_COUNT_LIMIT = 200
JOINT_TOLERANCE = 1e-9  # between the end of a section and the start of the next [mm]


@dataclass(frozen=True)
class Beam:
    """A beam of cylindrical sections along z, in their order and without gaps."""

    sections: tuple[ShaftSection, ...]
    material: Material

    def __post_init__(self) -> None:
        if not 1 <= len(self.sections) <= SECTION_COUNT_LIMIT:
            raise InputError(f"{len(self.sections)} sections: must be 1 to {SECTION_COUNT_LIMIT}")
        for at, (before, section) in enumerate(zip(self.sections, self.sections[1:], strict=False), start=2):
            if abs(section.start - before.end) > JOINT_TOLERANCE:
                what = "overlaps the one before it" if section.start < before.end else "leaves a gap before it"
                raise InputError(
                    f"section {at} {what}: start = {shown(section.start)}: must be {shown(before.end)} [mm], where the "
                    "section before it ends; give sections in the order of their positions"
                )

    @property
    def start(self) -> float:
        """Beginning of the first section [mm]."""
        return self.sections[0].start

    @property
    def end(self) -> float:
        """End of the last section [mm]."""
        return self.sections[-1].end

    def compliance(self, start: float, end: float, origin: float = 0.0) -> Array:
        """Twist of the cross section at ``end`` against that at ``start`` for a wrench (6, 6) [mm/N, 1/N, 1/(N mm)].

        Forces along x, y, z, then moments, about the place ``origin`` on the axis; start and end in either order [mm].
        """
        lower, upper = min(start, end), max(start, end)
        total = np.zeros((6, 6))
        for section in self.sections:
            first, last = max(lower, section.start), min(upper, section.end)
            if last > first:
                total += _piece(section, self.material, first - origin, last - origin)
        return total

    def torsion(self, start: float, end: float) -> float:
        """Rotation about the axis between two places for a unit torque [1/(N mm)]."""
        return float(self.compliance(start, end)[5, 5])


def _piece(section: ShaftSection, material: Material, start: float, end: float) -> Array:
    """Compliance (6, 6) of a cylindrical piece about the origin of its ends [mm]."""
    length, middle = end - start, 0.5 * (start + end)
    shear = shear_coefficient(section.inner_diameter / section.outer_diameter, material.poisson_ratio)
    stretching = length / (material.elastic_modulus * section.area)
    sliding = length / (shear * material.shear_modulus * section.area)
    bending = length / (material.elastic_modulus * section.second_moment)
    twisting = length / (2.0 * material.shear_modulus * section.second_moment)
    # A force at the origin has the bending moment z F at z: the mean of z^2 is middle^2 + length^2 / 12.
    forced = sliding + bending * (middle**2 + length**2 / 12.0)
    compliance = np.diag([forced, forced, stretching, bending, bending, twisting])
    compliance[0, 4] = compliance[4, 0] = -middle * bending
    compliance[1, 3] = compliance[3, 1] = middle * bending
    return compliance


STEEL = Material(206000.0, 0.3)
BEARING_COUNT_LIMIT = 20
STEP_COUNT_LIMIT = 500  # of bearings whose stiffness depends on the load
STIFFNESS_CHANGE_LIMIT = 1e-13  # relative, at which they have converged


@record(frozen=True)
class Shaft:
    """A shaft along z on bearings, with a member on it that is rigid.

    An ``InputError`` refuses bearings, seat or torque off the shaft, equal names, and bearings that leave a motion
    free.
    """

    sections: tuple[ShaftSection, ...]
    bearings: tuple[Bearing, ...]
    reference: float = field(metadata=POSITION)
    seat: float | None = None  # of the member [mm]; None for the reference
    torque_position: float | None = None  # winds up from there to the seat [mm]; None holds rotation at the seat
    material: Material = STEEL

    def __post_init__(self) -> None:
        check_fields(self)
        if not 1 <= len(self.bearings) <= BEARING_COUNT_LIMIT:
            raise InputError(f"{len(self.bearings)} bearings: must be 1 to {BEARING_COUNT_LIMIT}")
        names = [bearing.name for bearing in self.bearings]
        if twice := [name for name in names if names.count(name) > 1]:
            raise InputError(f"two bearings have the name {shown(twice[0])}: must be a name of its own")
        places = {f"bearing {bearing.name}: position": bearing.position for bearing in self.bearings}
        if self.seat is None:
            places["seat (the middle of the face, as it is left out)"] = self.reference
        else:
            places["seat"] = self.seat
        if self.torque_position is not None:
            places["torque_position"] = self.torque_position
        for name, place in places.items():
            if not self.beam.start <= place <= self.beam.end:
                raise InputError(
                    f"{name} = {shown(place)}: must be on the shaft, from {shown(self.beam.start)} to "
                    f"{shown(self.beam.end)} [mm]"
                )
        self._require_held()

    def _require_held(self) -> None:
        radial, axial, tilting = (sum(bearing.stiffness[at] > 0.0 for bearing in self.bearings) for at in (0, 2, 3))
        if not axial:
            raise InputError(
                "the shaft is free to move along its axis: one bearing at least must have an axial stiffness above 0"
            )
        if not radial:
            raise InputError(
                "the shaft is free to move across its axis: one bearing at least must have a radial stiffness above 0"
            )
        places = {bearing.position for bearing in self.bearings if bearing.stiffness[0] > 0.0}
        if len(places) < 2 and not tilting:
            raise InputError(
                "the shaft is free to tilt: two bearings at different positions must have a radial stiffness, or one a "
                "tilting stiffness above 0"
            )

    @cached_property
    def beam(self) -> Beam:
        """The shaft without its bearings."""
        return Beam(self.sections, self.material)

    @cached_property
    def _seat(self) -> float:
        return self.reference if self.seat is None else self.seat

    @cached_property
    def _response(self) -> tuple[Array, Array]:
        """Compliance (6, 6), and loads on the bearings (bearing, 6, 6) at their positions, for wrenches at the seat."""
        # Columns of ``acting``: wrenches at the seat of the components that each bearing takes.
        shifts = [_shift(bearing.position, self._seat) for bearing in self.bearings]
        taken = [np.flatnonzero(bearing.stiffness > 0.0) for bearing in self.bearings]
        acting = [shift[:, components] for shift, components in zip(shifts, taken, strict=True)]
        given = np.concatenate([1.0 / bearing.stiffness[at] for bearing, at in zip(self.bearings, taken, strict=True)])
        rows = np.array([[self._between(a, b) for b in self.bearings] for a in self.bearings])
        of_beam = [[a.T @ rows[i, j] @ b for j, b in enumerate(acting)] for i, a in enumerate(acting)]
        flexibility = np.block(of_beam) + np.diag(given)
        every = np.concatenate(acting, axis=1)[:5]  # without the rotation about the axis
        # Units such that rotations and displacements, moments and forces are alike.
        scale = 1.0 / np.sqrt(flexibility.diagonal())
        try:
            lower = np.linalg.cholesky(scale[:, None] * flexibility * scale)
        except np.linalg.LinAlgError as error:
            raise InputError(
                "the bearings are too stiff for the shaft to tell what each one carries: two at one place must be one, "
                "and diameters must be those of a shaft"
            ) from error
        half = np.linalg.solve(lower, scale[:, None] * every.T)
        orthogonal, triangle = np.linalg.qr(half)
        inverse = np.linalg.inv(triangle)  # compliance = inverse inverse'; loads = scale lower^-T orthogonal inverse'
        compliance = np.zeros((6, 6))
        compliance[:5, :5] = inverse @ inverse.T
        if self.torque_position is not None:
            compliance[5, 5] = self.beam.torsion(self._seat, self.torque_position)
        carried = scale[:, None] * np.linalg.solve(lower.T, orthogonal @ inverse.T)
        carried += np.linalg.pinv(every) @ (np.eye(5) - every @ carried)  # equilibrium to the last digit
        loads, at = np.zeros((len(self.bearings), 6, 6)), 0
        for load, components in zip(loads, taken, strict=True):
            load[components, :5] = carried[at : at + components.size]
            at += components.size
        return compliance, loads

    def _between(self, one: Bearing, other: Bearing) -> Array:
        """Compliance (6, 6) about the seat of what lies between the seat and both bearings."""
        first, second = one.position - self._seat, other.position - self._seat
        if first * second <= 0.0:
            return np.zeros((6, 6))
        nearer = first if abs(first) < abs(second) else second
        return self.beam.compliance(self._seat, self._seat + nearer, self._seat)

    @property
    def compliance(self) -> Array:
        """Twist of the member for a wrench on it (6, 6), both at ``reference`` [mm/N, 1/N, 1/(N mm)]."""
        shift = _shift(self.reference, self._seat)
        return np.asarray(shift.T @ self._response[0] @ shift)

    @property
    def loads(self) -> Array:
        """Force and moment on every bearing at its position, for a wrench on the member at ``reference`` (n, 6, 6).

        Without the torque about the axis, which leaves the shaft at the seat or at ``torque_position``.
        """
        return np.asarray(self._response[1] @ _shift(self.reference, self._seat))

    @property
    def is_linear(self) -> bool:
        """True if no bearing's stiffness depends on its load."""
        return all(bearing.is_linear for bearing in self.bearings)

    def under(self, wrench: Array) -> Shaft:
        """The shaft with the bearings' stiffness, load over displacement, under a wrench (6) at ``reference``."""
        if self.is_linear:
            return self
        shaft = replace(self, bearings=tuple(bearing.under(np.zeros(6)) for bearing in self.bearings))
        for _ in range(STEP_COUNT_LIMIT):
            loads = shaft.loads @ wrench
            bearings = tuple(bearing.under(load) for bearing, load in zip(self.bearings, loads, strict=True))
            new, old = (np.array([bearing.stiffness for bearing in each]) for each in (bearings, shaft.bearings))
            shaft = replace(self, bearings=bearings)
            if np.all(np.abs(new - old) <= STIFFNESS_CHANGE_LIMIT * old):
                return shaft
        raise InputError(
            f"the stiffness of the bearings does not converge in {STEP_COUNT_LIMIT} steps: their displacement must "
            "grow more evenly with the load"
        )


def _shift(start: float, end: float) -> Array:
    """The matrix (6, 6) that takes a wrench at one place of the axis to another."""
    return shift_matrix((0.0, 0.0, start), (0.0, 0.0, end))


@dataclass(frozen=True, eq=False)
class ShaftSupport:
    """A shaft with its place in the global frame."""

    shaft: Shaft
    origin: ArrayLike  # the member's crossing point (3) [mm], global frame
    frame: ArrayLike  # axes in columns (3, 3), z along the shaft

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", array("origin", self.origin, "mm", ndim=1, size=3, frozen=True))
        object.__setattr__(self, "frame", array("frame", self.frame, ndim=2, size=9, frozen=True))

    @classmethod
    def of(cls, shaft: Shaft, assembly: Assembly, member: MemberName) -> ShaftSupport:
        """The shaft of a member of a pair."""
        if member == "gear":
            return cls(shaft, assembly.gear_origin, np.eye(3))
        return cls(shaft, assembly.pinion_origin, assembly.pinion_frame)

    def at(self, wrench: Array) -> Support:
        """The support under a wrench (6) on the member about the global origin [N, N mm], with the bearings' loads."""
        turned = np.kron(np.eye(2), np.asarray(self.frame))
        reference = self._point(self.shaft.reference)
        shaft = self.shaft.under(turned.T @ shifted_wrench(wrench, ORIGIN, reference))
        bearings = tuple(
            BearingReaction(bearing.name, self._point(bearing.position), turned @ load @ turned.T)
            for bearing, load in zip(shaft.bearings, shaft.loads, strict=True)
        )
        return Support(reference, turned @ shaft.compliance @ turned.T, bearings)

    def _point(self, place: float) -> Array:
        return np.asarray(self.origin) + place * np.asarray(self.frame)[:, 2]


@dataclass(frozen=True, eq=False)
class ShaftSupports:
    """Supports of pinion and gear of which one or both are shafts whose bearings may depend on the load."""

    pinion: ShaftSupport | Support
    gear: ShaftSupport | Support
    wind_up: bool = False

    @property
    def is_linear(self) -> bool:
        """True if the supports do not depend on the load."""
        return all(not isinstance(one, ShaftSupport) or one.shaft.is_linear for one in (self.pinion, self.gear))

    def at(self, pinion_wrench: Array, gear_wrench: Array) -> Supports:
        """The supports under wrenches (6) on pinion and gear about the origin, see ``LoadedSupports``."""
        pinion, gear = (
            one.at(wrench) if isinstance(one, ShaftSupport) else one
            for one, wrench in ((self.pinion, pinion_wrench), (self.gear, gear_wrench))
        )
        return Supports(pinion, gear, wind_up=self.wind_up)
