"""Basic machine settings of a gear from its blank: Formate or generated, face-milled or face-hobbed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from ...core.arrays import Array
from ...core.checks import instance, one_of, positive, truth, whole
from ...core.errors import GeometryError
from ..cutting.blade import Blade, BladeSide
from ..cutting.generating_surface import GeneratingSurface, Hand
from ..cutting.machine import MachineSettings
from ..flanks.blank_section import BlankSection
from .blank import BlankDimensions, MeanPointAngles, mean_point_angles
from .closest_fit import StandardSteps
from .iso23509.blank_dimensions import MemberBlank

Flanks = tuple[GeneratingSurface, GeneratingSurface]
NO_STEPS = StandardSteps()
GROUP_COUNT_LIMIT = 100  # of a face-hobbing cutter
ANGLE_TOLERANCE = 1e-11  # residual of the corrected flanks [rad]


def blank_section(member: MemberBlank, clearance: float) -> BlankSection:
    """Axial section of one member of a blank; the flank ends at the clearance above the root cone.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> blank_section(blanks.gear, blanks.clearance).face_width == blanks.gear.face_width
    True
    """
    instance("member", member, MemberBlank)
    return BlankSection(
        pitch_angle=member.pitch_angle,
        face_angle=member.face_angle,
        root_angle=member.root_angle,
        outer_cone_distance=member.outer_cone_distance,
        face_width=member.face_width,
        pitch_apex=member.pitch_apex,
        face_apex=member.face_apex,
        root_apex=member.root_apex,
        clearance=clearance,
    )


def formate_gear(
    blank: BlankDimensions,
    cutter_radius: float,
    hand: Hand,
    number_of_blade_groups: int = 0,
    *,
    corrected: bool = True,
    steps: StandardSteps = NO_STEPS,
) -> Flanks:
    """Convex and concave flank of a Formate gear.

    The machine centre is the apex of the root cone and the cutter axis stands at right angles to the root line.

    *Face-milled*, one spread-blade cutter cuts both flanks: its centre gives the mean spiral angle to the middle of the
    slot, and its point width leaves the blank's tooth thickness. The two flanks are circles about one centre, so each
    has its own spiral angle.

    *Face-hobbed*, both blades pass the mean point at the cutter's mean radius, one after the other, and each flank has
    the mean spiral angle itself. The cutter centre is that of the crown gear, at the distance rho_P0 from the apex and
    with the lead angle nu taken off the spiral angle; each edge stands at right angles to its path (its rake angle,
    counted from the radius of its tip, is nu less what the blade's taper changes). The slot comes from the timing of
    the blades in their group, which the two flanks do not tell: the tooth thickness is to be given apart.

    Parameters
    ----------
    blank
        Dimensions of the pair.
    cutter_radius
        Mean cutter radius (r_c0) [mm].
    hand
        Hand of spiral of the gear.
    number_of_blade_groups
        Starts of a face-hobbing cutter (z0); zero for face milling.
    corrected
        Whether the settings are corrected until spiral angle, pressure angles and, face-milled, the thickness measured
        on the generated flanks at the mean point are those of the blank. If not, the closed form stands: it takes the
        angles as if the root line were the pitch line.
    steps
        Standard steps of blade angles and, face-milled, point width. The rest is corrected once more: of the blank
        there remain spiral angle and middle of the slot; pressure angles and thickness are as near as the steps allow.

    Returns
    -------
    tuple
        Generating surfaces of the convex (drive) and the concave (coast) flank.

    Raises
    ------
    GeometryError
        If the slot is too narrow for a cutter, the cutter too small for its blade groups, or no settings give the
        blank's angles.

    Notes
    -----
    Source: ISO 23509:2016, formulas 34 to 40 (crown gear).

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> convex, concave = formate_gear(blanks, cutter_radius=95.25, hand="right", corrected=False)
    >>> convex.settings == concave.settings, convex.settings.generated
    (True, False)
    """
    return _GearCut(blank, cutter_radius, hand, number_of_blade_groups, corrected, steps, None).flanks()


def generated_gear(
    blank: BlankDimensions,
    cutter_radius: float,
    hand: Hand,
    number_of_blade_groups: int = 0,
    *,
    corrected: bool = True,
    steps: StandardSteps = NO_STEPS,
) -> Flanks:
    """Convex and concave flank of a generated gear: the cutter of ``formate_gear``, rolled with a crown gear.

    The cradle axis passes through the pitch apex and the ratio of roll is cos(dedendum angle) / sin(pitch angle): the
    pitch cone rolls without sliding.
    """
    gear = blank.gear
    ratio = math.cos(gear.pitch_angle - gear.root_angle) / math.sin(gear.pitch_angle)
    return _GearCut(blank, cutter_radius, hand, number_of_blade_groups, corrected, steps, ratio).flanks()


@dataclass(frozen=True)
class _GearCut:
    """How a gear is cut: Formate without a ratio of roll, face-milled without blade groups."""

    blank: BlankDimensions
    cutter_radius: float
    hand: Hand
    groups: int
    corrected: bool
    steps: StandardSteps
    ratio: float | None

    def __post_init__(self) -> None:
        instance("blank", self.blank, BlankDimensions)
        positive("cutter_radius", self.cutter_radius, "mm")
        one_of("hand", self.hand, get_args(Hand))
        truth("corrected", self.corrected)
        instance("steps", self.steps, StandardSteps)
        whole("number_of_blade_groups", self.groups, 0, GROUP_COUNT_LIMIT)

    def flanks(self) -> Flanks:
        """Convex and concave flank."""
        return self._face_hobbed() if self.groups else self._face_milled()

    @property
    def _machine_center(self) -> float:
        """Machine centre to crossing point [mm].

        The cradle axis of a Formate gear meets the work axis in the root apex; to roll on the pitch cone, in its apex.
        """
        return self.blank.gear.root_apex if self.ratio is None else self.blank.gear.pitch_apex

    @property
    def _mean_point(self) -> tuple[float, float]:
        """The mean point on the machine: distance from the cradle axis along the root line, height above it [mm]."""
        gear, (axial, radial) = self.blank.gear, self.blank.gear.mean_point
        sine, cosine = math.sin(gear.root_angle), math.cos(gear.root_angle)
        along = (axial + self._machine_center) * cosine + radial * sine
        return along, radial * cosine - (axial + gear.root_apex) * sine

    def _machine(self, horizontal: float, vertical: float) -> MachineSettings:
        gear, center = self.blank.gear, self._machine_center
        return MachineSettings(
            radial_distance=math.hypot(horizontal, vertical),
            cradle_angle=math.atan2(vertical, horizontal),
            machine_root_angle=gear.root_angle,
            sliding_base=(gear.root_apex - center) * math.sin(gear.root_angle),
            machine_center_to_crossing_point=center,
            ratio_of_roll=self.ratio,
            indexing_ratio=self.groups / gear.number_of_teeth,
        )

    def _angles(self, flank: GeneratingSurface) -> MeanPointAngles:
        return mean_point_angles(flank, blank_section(self.blank.gear, self.blank.clearance), self.blank.gear)

    def _face_milled(self) -> Flanks:
        blank, gear, cutter_radius, hand = self.blank, self.blank.gear, self.cutter_radius, self.hand
        along, spiral = self._mean_point[0], gear.mean_spiral_angle
        drive, coast = float(blank.generated_drive_pressure_angle), float(blank.generated_coast_pressure_angle)
        slot = math.pi * blank.mean_normal_module - gear.mean_normal_thickness
        point_width = slot - gear.mean_dedendum * (math.tan(drive) + math.tan(coast))

        def flanks(values: Array) -> Flanks:
            horizontal, vertical, width, inside_angle, outside_angle = (float(v) for v in values)
            if width <= 0.0:
                raise GeometryError(f"the gear's slot leaves a point width of {width:.3f} mm: no cutter fits")
            settings = self._machine(horizontal, vertical)
            inside = Blade(cutter_radius - width / 2.0, inside_angle, "inside")
            outside = Blade(cutter_radius + width / 2.0, outside_angle, "outside")
            return GeneratingSurface(inside, settings, hand, 1), GeneratingSurface(outside, settings, hand, 1)

        def error(values: Array) -> Array:
            convex, concave = map(self._angles, flanks(values))
            cut = (convex.azimuth - concave.azimuth) * gear.mean_pitch_diameter / 2.0 * math.cos(spiral)
            return np.array(
                [
                    (convex.spiral_angle + concave.spiral_angle) / 2.0 - spiral,
                    convex.azimuth + concave.azimuth,
                    (cut - slot) / cutter_radius,
                    convex.pressure_angle - drive,
                    concave.pressure_angle - coast,
                ]
            )

        def to_steps(cutter: Array) -> Array:
            return np.array([self.steps.width(cutter[0]), *map(self.steps.angle, cutter[1:])])

        horizontal, vertical = along - cutter_radius * math.sin(spiral), cutter_radius * math.cos(spiral)
        return flanks(self._settled(error, np.array([horizontal, vertical, point_width, drive, coast]), 2, to_steps))

    def _face_hobbed(self) -> Flanks:
        blank, gear, cutter_radius = self.blank, self.blank.gear, self.cutter_radius
        along, height = self._mean_point
        lead_sine = self.groups * blank.mean_normal_module / (2.0 * cutter_radius)
        if not lead_sine < 1.0:
            raise GeometryError(
                f"number_of_blade_groups = {self.groups}: too many for cutter_radius = {cutter_radius:g} mm"
            )
        lead = math.asin(lead_sine)
        course = gear.mean_spiral_angle - lead
        settings = self._machine(along - cutter_radius * math.sin(course), cutter_radius * math.cos(course))

        def flank(side: BladeSide, pressure_angle: float) -> GeneratingSurface:
            def surface(values: Array) -> GeneratingSurface:
                radius, angle = float(values[0]) * cutter_radius, float(values[1])
                return GeneratingSurface(hobbing_blade(radius, angle, side, height, lead), settings, self.hand, 1)

            def error(values: Array) -> Array:
                angles = self._angles(surface(values))
                return np.array([angles.spiral_angle - gear.mean_spiral_angle, angles.pressure_angle - pressure_angle])

            def to_steps(angle: Array) -> Array:
                return np.array([self.steps.angle(angle[0])])

            return surface(self._settled(error, np.array([1.0, pressure_angle]), 1, to_steps))

        return (
            flank("inside", float(blank.generated_drive_pressure_angle)),
            flank("outside", float(blank.generated_coast_pressure_angle)),
        )

    def _settled(
        self, error: Callable[[Array], Array], start: Array, first: int, to_steps: Callable[[Array], Array]
    ) -> Array:
        """Values without errors; those of the cutter, from ``first`` on, at steps and the others corrected anew."""
        solution = self._solved(error, start)
        cutter = to_steps(solution[first:])
        if np.array_equal(cutter, solution[first:]):
            return solution
        place = self._solved(lambda values: error(np.concatenate([values, cutter]))[:first], solution[:first])
        return np.concatenate([place, cutter])

    def _solved(self, error: Callable[[Array], Array], start: Array) -> Array:
        return _corrected(error, start) if self.corrected else start


def hobbing_blade(
    reference_radius: float, pressure_angle: float, side: BladeSide, reference_height: float, lead: float
) -> Blade:
    """Face-hobbing blade whose edge stands at right angles to its path [mm, rad].

    The reference point is at a radius from the cutter axis and a height above the tip; ``lead`` (nu) is between that
    radius and the normal of the path.
    """
    plain = Blade(reference_radius, pressure_angle, side)
    # The edge runs in a plane turned by the lead angle; the tip then stands at a radius and an angle of its own.
    reach = plain.side_sign * reference_height * math.tan(pressure_angle)
    tip = complex(reference_radius - reach * math.cos(lead), -reach * math.sin(lead))
    return replace(plain, point_radius=abs(tip), rake_angle=lead - math.atan2(tip.imag, tip.real))


def _corrected(error: Callable[[Array], Array], start: Array) -> Array:
    """Settings near the start at which the measured errors vanish."""
    from scipy.optimize import root

    error(start)  # what is wrong with the blank itself is told in its own words
    try:
        solution = root(error, start, tol=1e-14)
    except GeometryError as lost:
        raise GeometryError(
            "no settings of the gear were found that give the blank's spiral angle and pressure angles: the search ran "
            "to settings that cut no tooth of it; change cutter_radius, the spiral angle, hypoid_offset or the "
            "pressure angles"
        ) from lost
    if not np.max(np.abs(error(solution.x))) < ANGLE_TOLERANCE:
        raise GeometryError(
            "no settings of the gear were found that give the blank's spiral angle and pressure angles: "
            f"an error of {np.degrees(np.max(np.abs(solution.fun))):.2g} degrees is left; check the blank's dedendum "
            "angle and cutter_radius"
        )
    return np.asarray(solution.x)
