"""Case design: blanks, gear and a pinion fitted to the wanted ease-off of both sides, as a case.

Fitted settings: machine settings of the pinion that realise a modification of the ease-off.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from operator import attrgetter

import numpy as np
import xarray as xr

from ...cases import conversion
from ...cases.deflections import misalignment_at
from ...cases.schema.case_schema import MATING_SIDES, Case, MemberTable, PinionTable, TargetsTable
from ...cases.schema.design_schema import Design
from ...cases.writing import blank_table, flank_settings, recorded_thicknesses
from ...core.arrays import Array
from ...core.checks import instance
from ...core.errors import GeometryError, InputError
from ...geometry.design.fitting_proportions import FREE_PROPORTIONS, fitting_proportions
from ...geometry.design.iso23509.usual_proportions import DefaultValue
from ...geometry.design.pair_design import SIDES, PairDesign, design_pair
from ...geometry.design.slot_width import require_whole_tooth
from ...geometry.design.synthesis import Synthesis, fit_pinion
from ...geometry.flanks.flank import solve_flank
from ...geometry.pair.ease_off import exact_ease_off
from ...geometry.pair.gear_pair import FlankName, GearPair
from ...geometry.pair.modification import Modification
from .design_check import DesignReport, checked_design, failure_advice, require_elastic_tooth


def design_case(design: Design) -> tuple[Case, DesignReport]:
    """Design a pair: a case with all four flanks.

    Parameters
    ----------
    design
        A design, see ``easeoff.cases.read_design``.

    Returns
    -------
    tuple
        The case, with drive and coast flanks of both members, and a report.

    Raises
    ------
    InputError
        If values of the design do not fit together.
    GeometryError
        If there are no such blanks, no cutter fits them, or the flanks do not meet.

    Examples
    --------
    >>> from easeoff.cases import read_design
    >>> design = read_design("fh-design-a")
    >>> shells = design.compliance.model_copy(update={"model": "shell"})
    >>> case, report = design_case(design.model_copy(update={"compliance": shells}))
    >>> case.pinion.number_of_teeth, sorted(report.sides)
    (12, ['coast', 'drive'])
    """
    instance("design", design, Design)
    failure: GeometryError | None = None
    incomplete: tuple[Case, DesignReport] | None = None
    alternatives = list(_alternatives(design))
    for attempt in (design, *alternatives):
        try:
            case, report = _designed(attempt)
        except GeometryError as error:
            failure = failure or error
            continue
        if report.analysable:
            return case, report
        incomplete = incomplete or (case, report)
    if incomplete is not None:
        return incomplete
    assert failure is not None
    searched = [value for each in alternatives for value in each.defaults if value.source == SEARCHED]
    tried = ", ".join(str(value).partition(" (")[0] for value in searched)
    raise GeometryError(f"{failure}" + (f"; tried in vain: {tried}" if tried else "")) from failure


#: Values that are tried in turn where a design as completed has no pinion or no whole teeth, by what is left out.
ALTERNATIVES = (
    ("depth_taper", "standard"),
    ("depth_taper", "uniform"),
    ("limit_pressure_angle_influence", 0.0),
    ("gear.generation", "generated"),
    ("pinion.method", "tilt"),
)
SEARCHED = "search: without it no pinion, or no whole teeth"


def _alternatives(design: Design) -> Iterator[Design]:
    """The design with another value for one thing that its file leaves out."""
    left_out = {each.name for each in design.defaults}
    if design.pinion.model_fields_set.isdisjoint(("method", "limits", "free_settings", "follow_root")):
        left_out.add("pinion.method")
    for name, value in ALTERNATIVES:
        now = attrgetter(name if "." in name else f"blank_design.{name}")(design)
        if name not in left_out or now == value:
            continue
        if name == "depth_taper" and design.blank_design.process == "face_hobbed":
            continue
        yield design.with_defaults((DefaultValue(name, value, SEARCHED),))


def _designed(design: Design) -> tuple[Case, DesignReport]:
    """Case and report of a design as it is."""
    teeth = (design.pinion.number_of_teeth, design.gear.number_of_teeth)
    basic_data = conversion.blank_design(design.blank_design, teeth, design.pair)
    free = [each.name for each in design.blank_design.defaults if each.name in FREE_PROPORTIONS]
    basic_data, changes = fitting_proportions(basic_data, free, generated_gear=design.gear.generation == "generated")
    design = design.with_defaults(changes)
    given = conversion.misalignment(design.misalignment)
    try:
        designed = design_pair(
            basic_data,
            conversion.case_assembly(design, misalignment_at(given, 0.0, "drive")),
            {side: conversion.ease_off_target(getattr(design.target, side)) for side in SIDES},
            method=design.pinion.method,
            limits=conversion.setting_limits(design.pinion.limits),
            free=design.pinion.free_settings,
            follow_root=design.pinion.follow_root,
            generated=design.gear.generation == "generated",
            corrected=design.gear.basic_settings == "mean_point",
            steps=conversion.standard_steps(design.cutter_steps),
            edge_radii=(design.pinion.tool_edge_radius, design.gear.tool_edge_radius),
            require=require_whole_tooth if design.compliance.model == "shell" else require_elastic_tooth,
        )
    except GeometryError as error:
        raise GeometryError("; ".join([str(error), *failure_advice(design, basic_data)])) from error
    try:
        case = _case(design, designed)
    except InputError as error:
        raise GeometryError(
            f"the design gives values that a case file does not allow; change its basic data or its target: {error}"
        ) from error
    return case, checked_design(design, designed)


def _case(design: Design, designed: PairDesign) -> Case:
    blank, (convex, concave) = designed.blank, designed.gear
    teeth = designed.assembly.pinion_teeth, designed.assembly.gear_teeth
    thickness = recorded_thicknesses(designed.pair())
    return Case(
        easeoff_case=2,
        title=design.title,
        description=design.description,
        pair=design.pair,
        pinion=PinionTable(
            number_of_teeth=teeth[0],
            hand_of_spiral=design.pinion.hand_of_spiral,
            mean_normal_circular_thickness=thickness[0],
            blank=blank_table(blank.pinion, blank.clearance),
            concave=flank_settings(designed.pinion["drive"].surface, teeth[0]),
            convex=flank_settings(designed.pinion["coast"].surface, teeth[0]),
            material=design.pinion.material,
        ),
        gear=MemberTable(
            number_of_teeth=teeth[1],
            mean_normal_circular_thickness=thickness[1],
            blank=blank_table(blank.gear, blank.clearance),
            concave=flank_settings(concave, teeth[1]),
            convex=flank_settings(convex, teeth[1]),
            material=design.gear.material,
        ),
        misalignment=design.misalignment,
        contact=design.contact,
        compliance=design.compliance,
        friction=design.friction,
        target=TargetsTable(drive=design.target.drive, coast=design.target.coast),
        drawing=design.drawing,
    )


@dataclass(frozen=True)
class _Wanted:
    """Ease-off of a pair with a modification, as a target of the fit."""

    pair: GearPair
    modification: Modification

    def __call__(self, lengthwise: Array, profile: Array) -> Array:
        """Wanted ease-off (n) [mm] at lengthwise and profile fractions (n)."""
        gear = self.pair.gear
        flank = solve_flank(gear.loaded, gear.section, *gear.section.points(lengthwise, profile))
        now = exact_ease_off(flank, self.pair.pinion.loaded, self.pair.pinion.section, self.pair.assembly)
        return np.asarray(now.angle * now.lever_arm + 1e-3 * self.modification(lengthwise, profile))


def recorded_modification(tree: xr.DataTree) -> Modification:
    """Modification of a result of ``modify``."""
    terms = tree["modification"].to_dataset()["coefficient"]
    return Modification({str(k): float(v) for k, v in zip(terms["term"].values, terms.values, strict=True)})


def fit_modification(case: Case, modification: Modification, *, flank: FlankName = "drive") -> tuple[Case, Synthesis]:
    """The case with its pinion fitted to the ease-off with a modification added, and the fit.

    ``drive`` fits the pinion's concave flank, ``coast`` its convex one; a target recorded for this side is dropped.
    Raises as ``easeoff.geometry.fit_pinion``.
    """
    pair = conversion.gear_pair(case, flank)
    fit = fit_pinion(pair, _Wanted(pair, modification))
    side, _ = MATING_SIDES[flank]
    settings = flank_settings(fit.surface, case.pinion.number_of_teeth)
    return case.with_tables(pinion={side: settings}, target={flank: None}), fit
