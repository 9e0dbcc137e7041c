"""Basic machine settings: of a gear from its blank, and of the pinion that is conjugate to it.

The gear is Formate or generated, face-milled or face-hobbed. To a Formate gear there is an exactly conjugate pinion:
cut it on a machine whose cradle axis is the gear axis, whose ratio of roll is the ratio of the pair and whose
cutter is the gear's own blade, taken from the other side and, face-hobbed, turning in the same time. The cradle then
plays the gear, and the pinion is its envelope: the ease-off is zero everywhere. Machine root angle near zero and a
large cutter tilt are the marks of this set-up.

A generated gear shares its generating gear with the pinion: the cradle of its machine plays a crown gear that rolls on
the gear. Let the same crown gear roll on the pinion, at the tooth ratio, and let its flank be cut from the other side.
Where the axes intersect and the crown gear rolls on the pitch cone, all three bodies turn about one instantaneous axis,
and gear and pinion are exactly conjugate (Litvin & Fuentes 2004, Gear Geometry and Applied Theory, chapter 21). With an
offset they are so near the pitch point only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ...core.arrays import Array
from ...core.checks import bounded, check_fields, instance, number
from ...core.errors import GeometryError
from ..cutting.blade import Blade, BladeSide
from ..cutting.generating_surface import Flanks, GeneratingSurface, Hand
from ..cutting.machine import MachineSettings, machine_pose
from ..pair.assembly import Assembly
from ..vectors import rotate_z
from .blank import BlankDimensions, MeanPointAngles, blank_section, mean_point_angles
from .closest_fit import NO_STEPS, StandardSteps

GROUP_COUNT_LIMIT = 100  # of a face-hobbing cutter
ANGLE_TOLERANCE = 1e-11  # residual of the corrected flanks [rad]


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
    """Cutting of a gear: Formate without a ratio of roll, face-milled without blade groups."""

    blank: BlankDimensions
    cutter_radius: float = field(metadata=bounded("mm", above=0.0))
    hand: Hand
    number_of_blade_groups: int = field(metadata=bounded(most=GROUP_COUNT_LIMIT))
    corrected: bool
    steps: StandardSteps
    ratio: float | None

    def __post_init__(self) -> None:
        check_fields(self)

    def flanks(self) -> Flanks:
        """Convex and concave flank."""
        return self._face_hobbed() if self.number_of_blade_groups else self._face_milled()

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
            indexing_ratio=self.number_of_blade_groups / gear.number_of_teeth,
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
                raise GeometryError(
                    f"the gear's slot leaves a point width of {width:.3f} mm: no cutter fits; a larger "
                    "thickness_factor or gear_mean_slot_width, or a smaller depth_factor or clearance_factor helps"
                )
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
        blank, gear = self.blank, self.blank.gear
        cutter_radius, groups = self.cutter_radius, self.number_of_blade_groups
        along, height = self._mean_point
        lead_sine = groups * blank.mean_normal_module / (2.0 * cutter_radius)
        if not lead_sine < 1.0:
            raise GeometryError(f"number_of_blade_groups = {groups}: too many for cutter_radius = {cutter_radius:g} mm")
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
            f"to settings that cut no tooth of it ({lost}); change cutter_radius, the spiral angle, hypoid_offset or "
            "the pressure angles"
        ) from lost
    if not np.max(np.abs(error(solution.x))) < ANGLE_TOLERANCE:
        raise GeometryError(
            "no settings of the gear were found that give the blank's spiral angle and pressure angles: "
            f"an error of {np.degrees(np.max(np.abs(solution.fun))):.2g} degrees is left; check the blank's dedendum "
            "angle and cutter_radius"
        )
    return np.asarray(solution.x)


def conjugate_pinion(gear: GeneratingSurface, assembly: Assembly, blade_height: float) -> GeneratingSurface:
    """Machine settings that cut the pinion flank conjugate to a Formate gear flank.

    Parameters
    ----------
    gear
        Generating surface of the gear flank.
    assembly
        The pair; its misalignment is not used, the pinion is conjugate in the nominal position.
    blade_height
        Distance between the blade tips of the two cutters along the cutter axis [mm]: where the pinion's root is to be.

    Returns
    -------
    GeneratingSurface
        The pinion flank.

    Raises
    ------
    GeometryError
        If the gear is generated (no fixed cone stands for its flank), or the cone ends before ``blade_height``.

    Examples
    --------
    The ease-off of the conjugate pinion is zero:

    >>> from dataclasses import replace
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import Misalignment, ease_off
    >>> pair = gear_pair(read_case("fm-11x41")).misaligned(Misalignment())
    >>> surface = conjugate_pinion(pair.gear.loaded, pair.assembly, blade_height=10.0)
    >>> dataset = ease_off(replace(pair, pinion=replace(pair.pinion, loaded=surface)), (5, 5))
    >>> bool(abs(dataset["ease_off"]).max() < 1e-6)  # [um]
    True
    """
    instance("gear", gear, GeneratingSurface)
    instance("assembly", assembly, Assembly)
    number("blade_height", blade_height, "mm")
    settings = gear.settings
    if settings.generated:
        raise GeometryError(
            "the conjugate pinion of a Formate gear is asked for, but this gear is generated: take crown_gear_pinion"
        )
    # The gear's cutter in the frame of a right-hand gear: centre of the tip plane, axis towards the gear.
    still = np.zeros(1)
    pose = machine_pose(settings, still, gear.sense)
    tip_center = pose.to_member(pose.center, still, point=True)[:, 0]
    axis = pose.to_member(pose.frame[2], still, point=False)[:, 0]

    # The pinion's cutter reaches from the gear's body to the pinion; its machine frame is the gear's with z reversed.
    tip_center = tip_center - blade_height * axis
    towards_pinion = np.array([-axis[0], -axis[1], axis[2]])
    cradle_angle = float(np.arctan2(tip_center[1], tip_center[0]))
    pinion_settings = MachineSettings(
        radial_distance=float(np.hypot(tip_center[0], tip_center[1])),
        cradle_angle=cradle_angle,
        machine_root_angle=assembly.shaft_angle - np.pi / 2,
        work_offset=assembly.hypoid_offset,
        sliding_base=float(tip_center[2]),
        cutter_tilt=float(np.arccos(np.clip(towards_pinion[2], -1.0, 1.0))),
        cutter_swivel=cradle_angle - float(np.arctan2(towards_pinion[0], -towards_pinion[1])),
        ratio_of_roll=assembly.ratio,
        indexing_ratio=settings.indexing_ratio * assembly.ratio,
    )
    return _mate(gear, blade_height, pinion_settings)


def _mate(gear: GeneratingSurface, blade_height: float, settings: MachineSettings) -> GeneratingSurface:
    """The pinion flank that the other side of a gear's blade cuts."""
    hand: Hand = "left" if gear.hand == "right" else "right"
    return replace(gear, blade=other_side(gear.blade, blade_height), settings=settings, hand=hand, sense=-1)


def other_side(blade: Blade, height: float) -> Blade:
    """Same edge as a blade that points the other way, its tip ``height`` [mm] further up the cutter axis.

    Both are written along radius, tangent and their own axis; the new axis is the old one reversed. The plane of the
    edge stays: its normal fixes rake and hook.
    """
    (tip_r, tip_t), edge, (outward, upward) = blade.tip, np.array(blade.edge), blade.plane
    reversed_axis = np.array([1.0, 1.0, -1.0])
    along = -height / edge[2]
    tip = complex(tip_r + along * edge[0], tip_t + along * edge[1])
    if blade.offset_angle == 0.0 and tip.real <= 0.0:
        raise GeometryError(f"the gear's cutter cone ends before the pinion's root, {height} mm from its blade tip")
    offset_angle = math.atan2(tip.imag, tip.real)

    def from_tip(vector: Array) -> Array:
        """Components with the radius through the new tip."""
        lateral = complex(vector[0], vector[1]) * abs(tip) / tip
        return np.array([lateral.real, lateral.imag, vector[2]])

    across = from_tip(blade.side_sign * np.cross(outward, upward) * reversed_axis)
    rake_angle, hook_angle = -math.asin(across[0]), math.atan2(across[2], across[1])
    side: BladeSide = "outside" if blade.side == "inside" else "inside"
    turned = Blade(abs(tip), 0.0, side, offset_angle, rake_angle, hook_angle)
    new_edge, new_outward = -edge * reversed_axis, np.array(turned.plane[0])
    pressure_angle = math.asin(float(new_edge @ new_outward))
    touching = (along - blade.reference_height / math.cos(blade.pressure_angle)) * math.cos(pressure_angle)
    return replace(
        turned,
        pressure_angle=pressure_angle,
        spheric_radius=None if blade.spheric_radius is None else -blade.spheric_radius,
        reference_height=touching if blade.spheric_radius is not None else 0.0,
        edge_radius=blade.edge_radius,
    )


TILT_ROUNDING = 1e-9  # [rad]; a smaller tilt is none


def crown_gear_pinion(
    gear: GeneratingSurface, assembly: Assembly, blade_height: float, pitch_point_azimuth: float = 0.0
) -> GeneratingSurface:
    """Pinion flank cut by the crown gear that generates a gear flank: a spiral bevel pair of both has no ease-off.

    The crown gear has to roll on the pitch cone for that. The misalignment is not used; ``blade_height`` [mm], between
    the tips of both cutters along their axis, is where the pinion's root is to be.
    """
    settings = gear.settings
    if settings.ratio_of_roll is None:
        raise GeometryError("the gear is Formate: no crown gear generates it, take conjugate_pinion")
    still = np.zeros(1)
    pose = machine_pose(settings, still, gear.sense)
    turn = np.full(1, pitch_point_azimuth)

    def in_space(vector: object, *, point: bool = False) -> np.ndarray:
        """A vector in the cradle's frame as the nominal pair has it, seen from a right-hand gear."""
        column = np.reshape(np.asarray(vector, dtype=float), (3, 1))
        return np.asarray(rotate_z(turn, pose.to_member(column, still, point=point)))[:, 0]

    cutter_axis = in_space(pose.frame[2])
    tip_center = in_space(pose.center, point=True) - blade_height * cutter_axis
    machine_center = in_space((0.0, 0.0, 0.0), point=True)

    # The pinion's machine: its cradle axis is the same, reversed; a left-hand pinion is described by its mirror image.
    z = -in_space((0.0, 0.0, 1.0))
    work_axis = np.array([math.sin(assembly.shaft_angle), 0.0, math.cos(assembly.shaft_angle)])
    sine = float(work_axis @ z)
    cosine = math.sqrt(max(0.0, 1.0 - sine**2))
    if cosine < 1e-6:
        raise GeometryError("the axis of the crown gear is the pinion's: it cannot generate the pinion")
    x = (work_axis - sine * z) / cosine
    axes = np.stack([x, -np.cross(z, x), z])
    tip = axes @ (tip_center - machine_center)
    crossing_point = axes @ (np.array([0.0, assembly.hypoid_offset, 0.0]) - machine_center)
    towards_pinion = axes @ -cutter_axis
    cradle_angle = math.atan2(tip[1], tip[0])
    center = float(crossing_point[0]) / cosine
    tilt = math.atan2(math.hypot(towards_pinion[0], towards_pinion[1]), towards_pinion[2])
    if tilt < TILT_ROUNDING:
        tilt, swivel = 0.0, 0.0
    else:
        swivel = cradle_angle - math.atan2(towards_pinion[0], -towards_pinion[1])
    pinion_settings = MachineSettings(
        radial_distance=math.hypot(tip[0], tip[1]),
        cradle_angle=cradle_angle,
        machine_root_angle=math.asin(min(1.0, max(-1.0, sine))),
        work_offset=float(crossing_point[1]),
        sliding_base=float(crossing_point[2] - tip[2]) - center * sine,
        machine_center_to_crossing_point=center,
        cutter_tilt=tilt,
        cutter_swivel=swivel,
        ratio_of_roll=settings.ratio_of_roll * assembly.ratio,
        indexing_ratio=settings.indexing_ratio * assembly.ratio,
    )
    return _mate(gear, blade_height, pinion_settings)


def pitch_point_azimuth(blank: BlankDimensions, hypoid_offset: float) -> float:
    """Azimuth of the pitch point about the gear axis [rad], towards the pinion's offset [mm] with its sign.

    The common normal of the pitch cones stands at the pitch angle to either axis.
    """
    if hypoid_offset == 0.0:
        return 0.0
    pinion, gear, shaft = blank.pinion.pitch_angle, blank.gear.pitch_angle, blank.shaft_angle
    cosine = (math.sin(pinion) + math.cos(shaft) * math.sin(gear)) / (math.sin(shaft) * math.cos(gear))
    return math.copysign(math.acos(min(1.0, max(-1.0, cosine))), hypoid_offset)
