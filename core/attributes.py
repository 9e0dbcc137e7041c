"""Attributes of variables: units, long names and comments of everything that leaves the package, in one table.

Stored status: how a computation ended, as an integer in results.

Values of a dataset's variables with their dimensions in a given order.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import EnumMeta, IntEnum
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from .checks import shown
from .errors import EaseoffError, InputError

#: Of root stresses: 6 to 7 % on shipped pairs, 17 % at the gear of a 20x45 pair.
ROOT_RESOLUTION = "6 to 17 % below that of a lattice twice as fine"
#: Units and long name of each variable, a label for an axis or a column; where it needs one, a comment that defines it.
VARIABLES: Mapping[str, tuple[str, str] | tuple[str, str, str]] = {
    # dimensions and coordinates
    "lengthwise": ("1", "place along the face", "0 at the toe, 1 at the heel"),
    "profile": ("1", "place up the profile", "0 at the root, 1 at the tip"),
    "mesh_position": ("1", "mesh position", "fraction of a pinion pitch"),
    "fine_position": ("1", "mesh position, closer", "fraction of a pinion pitch"),
    "pinion_rotation": ("rad", "pinion rotation", "drive sense, zero at the middle of its flank"),
    "torque": ("N m", "torque at the pinion"),
    "order": ("1", "harmonic order of the mesh frequency"),
    "pair": ("1", "tooth pair", "0 the pair followed, negative before it"),
    "segment": ("1", "contact segment"),
    "setting": ("", "setting", "that moves, or by which is differentiated"),
    "setting_units": ("", "unit of the setting"),
    "member": ("", "member of the pair"),
    "space": ("", "global component", "z along the gear axis, x to the mesh, y along the offset"),
    "xyz": ("", "component in the member's frame", "z along its axis from the crossing point to the heel"),
    "flank": ("", "flank of the member"),
    "row": ("1", "row of the measuring grid", "1 at the root"),
    "column": ("1", "column of the measuring grid", "1 at the toe"),
    # flanks
    "position": ("mm", "position in the member's frame"),
    "normal": ("1", "outward unit normal of the flank"),
    "principal_curvature": ("mm-1", "principal curvature", "positive where convex"),
    "principal_direction": ("1", "first principal direction"),
    "flank_status": ("", "status of a node"),
    "inside": ("1", "usable nodes"),
    # ease-off
    "ease_off": ("um", "ease-off", "along the normal, positive where there is a gap"),
    "ease_off_angle": ("rad", "ease-off as a rotation of the gear"),
    "roll_angle": ("rad", "pinion rotation of conjugate contact", "zero at the middle of its flank"),
    "lever_arm": ("mm", "arm of the force about the gear axis", "in the ease-off that of the gear's point"),
    "separation_curvature": ("rad-1", "second derivative of the gap", "by the pinion rotation"),
    "separation_skew": ("rad-2", "third derivative of the gap", "by the pinion rotation"),
    "pinion_lengthwise": ("1", "lengthwise place of the conjugate pinion point"),
    "pinion_profile": ("1", "profile place of the conjugate pinion point"),
    "pinion_lengthwise_rate": (
        "rad-1",
        "lengthwise rate of the pinion point",
        "by the pinion rotation, opposite a node",
    ),
    "pinion_profile_rate": ("rad-1", "profile rate of the pinion point", "by the pinion rotation, opposite a node"),
    "pinion_lengthwise_acceleration": ("rad-2", "lengthwise acceleration of the pinion point"),
    "pinion_profile_acceleration": ("rad-2", "profile acceleration of the pinion point"),
    "action_position": ("mm", "conjugate contact in the global frame", "place of the pinion's point"),
    "action_normal": ("1", "outward pinion normal in conjugate contact"),
    "blade_distance": ("mm", "distance from the blade's edge radius", "along the blade, the smaller of both members"),
    "status": ("", "status"),
    # deviations
    "deviation": ("um", "deviation of the flank", "along its outward normal, positive where there is more metal"),
    "measured_position": ("mm", "measured point in the member's frame"),
    "extrapolated": ("1", "deviation extrapolated beyond its nodes"),
    "pinion_deviation": ("um", "deviation of the pinion flank", "positive where there is more metal"),
    "gear_deviation": ("um", "deviation of the gear flank", "positive where there is more metal"),
    "ease_off_change": ("um", "change of the ease-off by deviations"),
    # teeth
    "shell_height": ("mm", "height of the force above the root line", "at the tooth's middle"),
    "shell_arc": ("mm", "distance of the force from the toe", "along the trace, at the tooth's middle"),
    "shell_direction": ("1", "direction of the contact force"),
    "depth": ("mm", "normal distance from contact to tooth middle"),
    "trace_length": ("mm", "length of the tooth at mid height"),
    "trace_radius": ("mm", "radius of the tooth trace at mid face"),
    "tooth_height": ("mm", "tooth height above the root cone"),
    "tooth_thickness": ("mm", "tooth thickness", "normal, circular, in the middle of the flank"),
    "plate_thickness": ("mm", "normal thickness of the plate"),
    "fitted_thickness": ("mm", "normal thickness of the fitted plate"),
    "bulge": ("mm", "mid-height bulge of the fitted plate"),
    "fanning": ("mm-1", "relative growth of the trace per height"),
    "shell_axis": ("", "axis of the plate"),
    "tooth_end": ("", "end of the tooth"),
    "plate_edge": ("", "edge of the plate"),
    "side": ("", "side of the tooth"),
    "upward": ("1", "number of the node from the root land to the tip"),
    "level": ("1", "fraction of the height", "from the fillet's end to the tip"),
    "region": ("", "region of the tooth"),
    "transverse_thickness": ("mm", "transverse thickness", "chord at right angles to the member's axis"),
    "principal": ("1", "number of the principal curvature"),
    "end": ("1", "end of the contact line"),
    # unloaded
    "transmission_error": ("urad", "transmission error", "rotation of the gear, positive where it lags"),
    "transmission_error_envelope": ("urad", "transmission error of the carrying pair"),
    "fine_envelope": ("urad", "transmission error of the carrying pair between the mesh positions, too"),
    "carrying_pair": ("1", "carrying tooth pair"),
    "path_lengthwise": ("1", "lengthwise place of the contact point"),
    "path_profile": ("1", "profile place of the contact point"),
    "contact_edge": ("", "edge on which the pair touches"),
    "line_lengthwise": ("1", "lengthwise place of the contact line's end"),
    "line_profile": ("1", "profile place of the contact line's end"),
    "line_length": ("mm", "length of the contact line"),
    "peak_to_peak": ("urad", "transmission error, peak to peak"),
    "mean_level": ("urad", "transmission error, mean"),
    "harmonic": ("urad", "transmission error, amplitude of a harmonic"),
    "rms": ("urad", "root sum of squares of three harmonics"),
    # loaded
    "force": ("N", "normal force on a segment"),
    "pressure": ("MPa", "greatest contact pressure of a segment"),
    "gap": ("um", "gap left at a segment"),
    "separation": ("mm", "normal gap before loading", "at the nominal rotation"),
    "length": ("mm", "length of a segment"),
    "equivalent_radius": ("mm", "equivalent radius across the contact line"),
    "half_width": ("mm", "half width of the contact band", "on contact lines of the whole strip, as pressure"),
    "tooth": ("1", "tooth pair of a segment"),
    "overhang": ("mm", "overhang beyond a tooth edge", "NaN on contact lines"),
    "edge_share": ("1", "torque share of edges beside contact lines"),
    "load_share": ("1", "torque share of a tooth pair"),
    "equilibrium": ("1", "certificate: torque error over the torque"),
    "negative_force": ("1", "certificate: largest negative force over the greatest force"),
    "negative_gap": ("1", "certificate: largest penetration over the mean deflection"),
    "complementarity": ("1", "certificate: largest of the smaller one of force and gap, each scaled"),
    "duality_gap": ("1", "certificate: relative duality gap"),
    "resolution": ("1", "certificate: bound of the rounding in its violations"),
    "cancellation": ("1", "certificate: terms of torque or gaps over torque or deflection; above 1e5 costs digits"),
    "iterations": ("1", "iterations of the solver"),
    "max_pressure": ("MPa", "greatest contact pressure", "NaN where sharp edges carry all of the load"),
    # evaluation of a mesh cycle
    "contact_ratio": ("1", "contact ratio"),
    "geometric_contact_ratio": ("1", "geometric contact ratio", "of contact lines alone"),
    "least_gap": ("um", "least gap", "of the unloaded flanks, with the carrying pair in contact"),
    "pattern_centre_lengthwise": ("1", "lengthwise place of the pattern's centroid"),
    "pattern_centre_profile": ("1", "profile place of the pattern's centroid"),
    "pattern_length": ("1", "pattern length over the face width"),
    "pattern_height": ("1", "pattern height over that of the flank"),
    "load_centre_lengthwise": (
        "1",
        "lengthwise centre of the load",
        "mean of all normal forces of the mesh cycle, on the gear",
    ),
    "load_centre_profile": (
        "1",
        "profile centre of the load",
        "mean of all normal forces of the mesh cycle, on the gear",
    ),
    "load_extent_lengthwise": (
        "1",
        "lengthwise extent of the load",
        "root mean square about its centre, over the face width",
    ),
    "load_extent_profile": (
        "1",
        "profile extent of the load",
        "root mean square about its centre, over the flank's height",
    ),
    "max_load_share": ("1", "greatest torque share of a tooth pair"),
    "max_pressure_position": ("1", "mesh position of the greatest pressure"),
    "max_pressure_pair": ("1", "tooth pair with the greatest pressure"),
    "max_pressure_lengthwise": ("1", "lengthwise place of the greatest pressure"),
    "max_pressure_profile": ("1", "profile place of the greatest pressure"),
    "max_pressure_line_end": ("", "border near the greatest pressure"),
    "pinion_mean_level": ("urad", "transmission error of the pinion, mean"),
    "pinion_peak_to_peak": ("urad", "transmission error of the pinion, peak to peak"),
    "mesh_stiffness": ("N m urad-1", "mesh stiffness", "derivative of the gear torque"),
    "mean_mesh_stiffness": ("N m urad-1", "mean mesh stiffness"),
    "min_film_thickness": ("um", "least film thickness of the mesh cycle"),
    "min_film_position": ("1", "mesh position of the least film"),
    "min_film_lengthwise": ("1", "lengthwise place of the least film"),
    "min_film_profile": ("1", "profile place of the least film"),
    # key numbers
    "marking": ("um", "thickness of the marking compound", "gap within which unloaded flanks count as in contact"),
    "common_flank": ("1", "common flank", "share of the gear flank that meets the pinion flank"),
    "max_ease_off": ("um", "greatest ease-off on the common flank"),
    "max_edge_share": ("1", "greatest torque share of edges"),
    "certified_positions": ("1", "certified mesh positions"),
    "worst_certificate": ("1", "greatest entry of the certificates"),
    # root stress
    "root_stress": ("MPa", "greatest root stress", f"tensile, around the loaded side's fillet; {ROOT_RESOLUTION}"),
    "root_stress_history": ("MPa", "root stress", f"greatest along the face; {ROOT_RESOLUTION}"),
    "max_root_stress": (
        "MPa",
        "greatest root stress of face and mesh cycle",
        f"between the nodes of the face, too; {ROOT_RESOLUTION}",
    ),
    # wear
    "step": ("1", "step of the wear", "0 at the start"),
    "wear_depth": ("um", "wear depth", "along the normal of the member's own flank"),
    "revolutions": ("1", "revolutions of the pinion"),
    "revolution_share": ("1", "share of the revolutions at each torque"),
    "largest_depth": ("um", "greatest wear depth"),
    "removed_volume": ("mm3", "volume worn off one tooth", "from force and sliding"),
    "depth_integral": ("mm3", "integral of the wear depth", "volume worn off one tooth"),
    # load cases
    "load_case": ("", "load case"),
    "offset": ("mm", "E: increase of the offset"),
    "pinion_axial": ("mm", "P: pinion away from its crossing point, along its axis"),
    "gear_axial": ("mm", "G: gear away from its crossing point, along its axis"),
    "shaft_angle": ("rad", "Sigma: increase of the shaft angle"),
    # supports
    "whole_rotation": ("urad", "whole rotation of the gear", "with supports, from first contact without load"),
    "support_rotation": ("urad", "mean rotation of the gear by supports", "whole rotation less transmission error"),
    "pinion_support_rotation": ("urad", "own rotation of the pinion", "by the supports about its axis, drive sense"),
    "gear_support_rotation": ("urad", "own rotation of the gear", "by the supports about its axis, drive sense"),
    "teeth_rotation": ("urad", "whole rotation, part of teeth and roots"),
    "contact_rotation": ("urad", "whole rotation, part of the contact's flattening"),
    "supports_rotation": ("urad", "whole rotation, part of the supports"),
    "ease_off_rotation": ("urad", "whole rotation, part of the ease-off"),
    "mesh_force": ("N", "force of the mesh on the member"),
    "mesh_moment": ("N m", "moment on the member about its reference"),
    "reference": ("mm", "reference point of the support"),
    "bearing": ("", "bearing of a member"),
    "bearing_force": ("N", "force on the bearing"),
    "bearing_moment": ("N m", "moment on the bearing about its centre"),
    "bearing_position": ("mm", "centre of the bearing"),
    "rounds": ("1", "rounds of the ease-off under load"),
    "last_change": ("um", "greatest change of the gap by the last round"),
    "rounds_status": ("", "how the rounds ended"),
    "misalignment_offset": ("mm", "E: increase of the offset"),
    "misalignment_pinion_axial": ("mm", "P: pinion away from its crossing point, along its axis"),
    "misalignment_gear_axial": ("mm", "G: gear away from its crossing point, along its axis"),
    "misalignment_shaft_angle": ("rad", "increase of the shaft angle"),
    "share": ("1", "share of time"),
    "reason": ("", "reason of a failure", "why the load case could not be analysed; empty if it was"),
    "damage_exponent": ("1", "exponent of the damage", "life in cycles is in proportion to the torque to the power -p"),
    "equivalent_torque": ("N m", "equivalent torque", "at the pinion; does the same damage in as many cycles"),
    "damage_share": ("1", "share of the damage", "of the load case in that of its flank"),
    "duty_power_loss": ("W", "power loss, mean over time"),
    "duty_input_power": ("W", "input power, mean over time", "torque times angular velocity of the pinion"),
    "duty_efficiency": ("1", "efficiency over time", "one less mean power loss over mean power in"),
    # V-H check
    "place": ("", "place of the pattern", "on the gear flank"),
    "v": ("mm", "V", "displacement along the offset, added to E of the misalignment"),
    "h": ("mm", "H", "displacement of the pinion along its axis, added to P of the misalignment"),
    "place_lengthwise": ("1", "lengthwise place wanted of the pattern's centroid"),
    "place_profile": ("1", "profile place wanted of the pattern's centroid"),
    "v_grid": ("mm", "V of a pattern in the grid"),
    "h_grid": ("mm", "H of a pattern in the grid"),
    "total_v": ("mm", "total V", "V at the heel less V at the toe"),
    "total_h": ("mm", "total H", "H at the heel less H at the toe"),
    "h_over_v": ("1", "total H over total V"),
    "pattern_from": ("1", "toe end of the pattern, lengthwise"),
    "pattern_to": ("1", "heel end of the pattern, lengthwise"),
    "print_excess": (
        "1",
        "excess of the print",
        "gap over marking thickness, less one, or distance beyond the common flank: negative within",
    ),
    "in_plane": ("mm", "position in the projection plane", "along the face from the toe, and across it"),
    "plane_axis": ("", "axis of the projection plane"),
    # optimal modification
    "term": ("", "term of the modification"),
    "coefficient": ("um", "coefficient of a term"),
    "modification": ("um", "addition to the ease-off along the normal"),
    "stage": ("", "stage of the optimization"),
    "assembly": ("1", "assembly", "0 the case's own, then the other misalignments"),
    "gear_axial_error": ("mm", "assembly error G"),
    "shaft_angle_error": ("rad", "assembly error Sigma"),
    "max_line_load": ("N mm-1", "greatest line load"),
    "max_end_load": ("N mm-1", "greatest line load at the edges"),
    "least_line_load": ("N mm-1", "line load if evenly spread", "in the worst mesh position"),
    "load_norm": ("N mm-0.5", "load norm", "root of the sum of line load squared times length"),
    "programme": ("1", "number of the convex programme"),
    "search": ("", "start of the search"),
    "reach": ("um", "reach of the programme"),
    "promised_objective": ("1", "objective promised", "over that of the start"),
    "fresh_objective": ("1", "objective solved afresh"),
    "promised_violation": ("1", "violation promised", "part by which limits are passed"),
    "fresh_violation": ("1", "violation solved afresh", "part by which limits are passed"),
    "accepted": ("1", "search went on from the answer"),
    "mending": ("1", "began at the step before, to mend it"),
    "programme_status": ("", "programme status by CVXPY"),
    "refusal": ("", "why the settings were refused", "empty if they were analysed"),
    # optimal settings
    "setting_start": ("", "setting in the case", "in setting_units"),
    "setting_found": ("", "setting found", "in setting_units"),
    "setting_value": ("", "setting found, rounded", "to the resolution of the machine, in setting_units"),
    "setting_low": ("", "least setting allowed", "in setting_units"),
    "setting_high": ("", "greatest setting allowed", "in setting_units"),
    "ease_off_per_setting": (
        "um per setting_units",
        "ease-off per setting",
        "greatest change by one unit, a rotation left out",
    ),
    "low_multiplier": (
        "1 per setting_units",
        "multiplier of the least setting",
        "fall of the objective per unit by which it is lowered",
    ),
    "high_multiplier": (
        "1 per setting_units",
        "multiplier of the greatest setting",
        "fall of the objective per unit by which it is raised",
    ),
    "objective": ("", "quantity that is minimised"),
    "objective_units": ("", "unit of the objective"),
    "objective_weight": ("1", "weight of the objective"),
    "objective_start": ("", "objective at the start", "greatest of all loads, in objective_units"),
    "objective_value": ("", "objective found", "greatest of all loads, in objective_units"),
    "objective_ratio": ("1", "ratio to the start", "greatest of all loads"),
    "ratio_by_assembly": ("1", "ratio to the start in an assembly", "greatest of its loads"),
    "quantity_limit": ("", "limit of a quantity"),
    "limit_units": ("", "unit of the limited quantity"),
    "limit_bound": ("", "bound of the limit", "in limit_units"),
    "limited_start": ("", "limited quantity at the start", "worst of all loads, in limit_units"),
    "limited_value": ("", "limited quantity found", "worst of all loads, in limit_units"),
    "limit_multiplier": (
        "1 per limit_units",
        "multiplier of the limit",
        "fall of the objective per unit by which it is widened",
    ),
    "search_number": ("1", "number of the search", "each has teeth built anew"),
    "programme_settings": ("", "settings that were analysed", "in setting_units"),
    "sample": ("1", "number of the sample"),
    "sample_ratio": ("1", "ratio to the start of a sample", "greatest, in an assembly that the search did not know"),
    "sample_limited": (
        "",
        "limited quantity of a sample",
        "worst, in limit_units, in an assembly that the search did not know",
    ),
    "point": ("1", "number of the point of the front"),
    "front_ratio": ("1", "ratio to the start", "greatest of all loads"),
    "front_value": ("", "objective", "greatest of all loads, in objective_units"),
    "front_limited": ("", "limited quantity", "worst of all loads, in limit_units"),
    "front_setting": ("", "setting, rounded", "to the resolution of the machine, in setting_units"),
    "front_found": ("", "setting before rounding", "in setting_units"),
    "front_ceiling": ("1", "ceiling of the second objective", "of its ratio to the start; NaN at the ends"),
    "front_multiplier": ("1", "multiplier of the ceiling", "fall of the first ratio per rise of it; NaN at the ends"),
    "front_limit_multiplier": (
        "1 per limit_units",
        "multiplier of the limit",
        "fall of the first ratio per unit that it is widened",
    ),
    "front_low_multiplier": (
        "1 per setting_units",
        "multiplier of the least setting",
        "fall of the first ratio per unit by which it is lowered",
    ),
    "front_high_multiplier": (
        "1 per setting_units",
        "multiplier of the greatest setting",
        "fall of the first ratio per unit by which it is raised",
    ),
    "front_violation": ("1", "violation of limits", "sum of the shares by which they are passed"),
    "front_converged": ("1", "whether the search had nothing left to gain", ""),
    "front_rounding_change": ("um", "greatest change of the ease-off by rounding", "a rotation left out"),
    "front_rounding_loss": ("1", "rise of the merit by rounding", "and by teeth of its own"),
    "front_analyses": ("1", "analyses until the point was found", "of one side in one assembly each"),
    # friction
    "speed": ("1/min", "speed of the pinion"),
    "temperature": ("degC", "oil temperature at the inlet"),
    "roughness": ("um", "RMS roughness Rq", "of unlike flanks the quadratic mean"),
    "roughness_pinion": ("um", "RMS roughness Rq of the pinion"),
    "roughness_gear": ("um", "RMS roughness Rq of the gear"),
    "viscosity": ("mPa s", "dynamic viscosity of the oil"),
    "pressure_viscosity": ("GPa-1", "pressure-viscosity coefficient of the oil"),
    "temperature_clamped": ("1", "oil temperature clamped to its data"),
    "sliding_velocity": ("m s-1", "sliding velocity"),
    "sliding_along": ("m s-1", "sliding along the line", "of the pinion on the gear, towards the heel"),
    "sliding_across": (
        "m s-1",
        "sliding across the line",
        "of the pinion on the gear, positive as the line moves over the gear",
    ),
    "rolling_velocity": ("m s-1", "rolling velocity", "mean of both surfaces across the line"),
    "slide_to_roll": ("1", "slide-to-roll ratio", "magnitude, across the contact line unless chosen otherwise"),
    "film_thickness": ("um", "film thickness", "least, between smooth flanks"),
    "lambda_ratio": ("1", "lambda ratio", "least film over composite roughness"),
    "friction_coefficient": ("1", "friction coefficient", "of an edge that of its whole strip"),
    "formula_flags": ("", "range of the friction formula"),
    "formula_flag": ("", "flag of formula_flags"),
    "extrapolated_share": ("1", "share of the loss out of range", "of the friction formula"),
    "flagged_share": ("1", "share of the loss with the flag"),
    "transition_share": ("1", "share of the loss in transition", "between two expressions of the formula"),
    "film_thinning": ("1", "greatest thinning of the film", "by heat of the inlet, even if film_heating is none"),
    "thinned_share": ("1", "share of the loss with thinning", "by more than a tenth"),
    "flash_temperature": ("K", "flash temperature", "greatest rise over the teeth's temperature"),
    "pressure_velocity": ("MPa m s-1", "greatest pressure times sliding velocity of a segment"),
    "bulk_temperature": ("degC", "bulk temperature", "of the teeth; that of the oil unless given"),
    "max_flash_temperature": ("K", "greatest flash temperature", "on contact lines"),
    "max_flash_position": ("1", "mesh position of the greatest flash temperature"),
    "max_flash_lengthwise": ("1", "lengthwise place of the greatest flash temperature"),
    "max_flash_profile": ("1", "profile place of the greatest flash temperature"),
    "max_contact_temperature": ("degC", "greatest contact temperature", "bulk and flash temperature"),
    "max_pressure_velocity": ("MPa m s-1", "greatest pressure times sliding velocity"),
    "power_loss": ("W", "power loss of a segment"),
    "mesh_power_loss": ("W", "power loss at a mesh position"),
    "mesh_efficiency": ("1", "efficiency at a mesh position"),
    "mean_power_loss": ("W", "power loss, mean over the mesh cycle"),
    "mean_sliding_loss": ("W", "part of the power loss by sliding"),
    "mean_rolling_loss": ("W", "part of the power loss by rolling"),
    "mean_friction_coefficient": ("1", "mean friction coefficient", "sliding loss over the sum of force times sliding"),
    "efficiency": ("1", "efficiency, mean over the mesh cycle"),
    "output_torque": ("N m", "output torque of the gear, with friction"),
    "energy_balance": ("1", "energy balance", "residual over the input power"),
    "input_power": ("W", "input power"),
    # lubricated line contact
    "rolling_position": ("um", "rolling position", "from the middle of the dry contact along the rolling direction"),
    "time": ("us", "time since the heights began to grow"),
    "kept_time": ("us", "time of the kept fields"),
    "film_pressure": ("MPa", "pressure", "of film and touching asperities together"),
    "asperity_pressure": ("MPa", "pressure on statistical asperities"),
    "film": ("um", "film thickness", "behind the end of the film the gap"),
    "node_state": ("", "state of a node"),
    "settled": ("1", "settled steps", "1 for steps that count in averages, 0 elsewhere"),
    "leak": ("1", "leak", "lubricant made or lost over what flows through in a step; rounding but for failed steps"),
    "minimum_film": ("um", "smallest film thickness within the dry contact"),
    # friction study
    "combination": ("1", "number of the combination in the design of the study"),
    "failure": ("", "what went wrong in a case that failed"),
    "contact_pressure": ("GPa", "greatest pressure of the dry contact"),
    "contact_radius": ("mm", "equivalent radius of the contact"),
    "roughness_1": ("um", "rms height of the first surface"),
    "roughness_2": ("um", "rms height of the second surface"),
    "film_friction": ("1", "friction force of the film over the load"),
    "asperity_friction": ("1", "friction force of touching asperities over the load"),
    "asperity_share": ("1", "part of the load that touching asperities carry"),
    "mean_film": ("um", "mean film thickness within the dry contact"),
    "smooth_film": ("um", "smallest film thickness between smooth surfaces"),
    "certified_share": ("1", "part of the steps in time whose answer is certified"),
    "newton_steps": ("1", "mean number of Newton steps of a step in time"),
    "nodes": ("1", "number of nodes of the grid"),
    # comparison of solvers
    "problem_file": ("", "file the problem is from"),
    "problem": ("1", "number of the problem in its file, from 0"),
    "problem_name": ("", "name of the problem, where the file has names"),
    "kind": ("", "kind of the problem, where the file has kinds"),
    "size": ("1", "number of segments"),
    "gear_torque": ("N m", "torque about the gear axis"),
    "solver": ("", "name of the solver"),
    "settings": ("", "what the solver was given: scaled, polished, raw or sweep"),
    "solver_tolerance": ("1", "tolerance given to the solver in a sweep; 0: that of its settings"),
    "start": ("", "cold, or warm from the answer to the problem before"),
    "repetition": ("1", "number of the attempt of its kind, from 1"),
    "load_factor": ("1", "factor of the separations and the torque in this attempt"),
    "run_time": ("s", "wall time of the call: check, scaling, solver, polish, certificate"),
    "processor_time": ("s", "processor time of the call"),
    "call_time": ("s", "wall time of the bare call of the solver"),
    "setup_time": ("s", "set-up time of the solver"),
    "solve_time": ("s", "solve time of the solver"),
    "time_source": ("", "who measured set-up and solve time: solver, interface or nobody"),
    "polish_time": ("s", "wall time of the polish"),
    "claim": ("", "how the solver says it ended"),
    "certified": ("1", "whether the certificate of the answer reaches the tolerance"),
    "worst_residual": ("1", "certificate: the largest of its entries"),
    "posed_residual": ("1", "largest of primal, dual residual and duality gap on the problem as the solver got it"),
    "rotation_error": ("1", "relative error of the rotation beyond first contact, against the certified reference"),
    "polished": ("1", "whether the answer was made exact by one solve on the active set that the solver found"),
    "exchanges": ("1", "exchanges of segments made by the polish"),
    "message": ("", "the solver's own words"),
    # torque path of a contact problem
    "event_torque": ("N mm", "gear torque of the event", "at which the segment enters or leaves the contact"),
    "event_segment": ("1", "segment that enters or leaves"),
    "event_enters": ("1", "entering", "1 where the segment enters the contact, 0 where it leaves"),
    "path_torque": ("N mm", "gear torque of the breakpoints", "about the gear axis"),
    "path_rotation": ("rad", "gear rotation at the breakpoints"),
    "path_force": ("N", "normal force at the breakpoints"),
    "path_gap": ("mm", "gap at the breakpoints"),
    # verification
    "quantity": ("", "what was checked"),
    "compared": ("", "what it was compared with, or why not"),
    "difference": ("", "greatest difference", "in its own unit"),
    "limit": ("", "limit of the difference"),
    "difference_unit": ("", "unit of difference and limit"),
    "comparison_status": ("", "whether the difference is within its limit"),
    # reductions of sweeps
    "coordinate": ("", "swept coordinate"),
    "slope": ("", "slope", "derivative of the number by the coordinate"),
    "scale": ("", "scale of the coordinate", "standard deviation of its samples, or half the range of its grid"),
    "effect": ("", "effect of the coordinate", "change of the number with one scale of it"),
    "variance_share": ("1", "share of the variance", "that is due to the coordinate alone, to first order"),
    # library of problems
    "name": ("", "name of the problem in the library"),
    "case": ("", "shipped case of the problem"),
    "flanks": ("", "flanks in mesh"),
    "pinion_torque": ("N m", "torque at the pinion"),
    "depends_on_torque": ("1", "assembly depends on the torque", "its errors are then those without torque"),
    "offset_error": ("mm", "assembly error E"),
    "pinion_axial_error": ("mm", "assembly error P"),
    "segments_per_line": ("1", "segments of a contact line"),
    "change": ("", "change of a real problem", "empty for a real one"),
    "amount": ("", "amount of the change"),
    "sequence": ("", "sequence of problems", "empty if in none"),
    "sequence_step": ("1", "number in the sequence", "-1 if in none"),
    "checksum": ("", "SHA-256 of the numbers", "torque, separation, lever arm, compliance"),
    "elastic_rotation": ("rad", "reference rotation", "beyond first contact"),
    "touching": ("1", "reference number of loaded segments", "-1 where not determined"),
    "condition_number": ("1", "condition number of the compliance", "infinite where the least eigenvalue is rounding"),
}

#: States of the contact that may stand before the name of a variable.
STATES: Mapping[str, str] = {"unloaded_": "without load", "light_load_": "at light load", "grid_": "in the grid"}


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """A copy with ``units``, ``long_name`` and ``comment`` on every variable; those that are there are kept."""
    result = dataset.copy()
    for name, variable in result.variables.items():
        variable.attrs = {**variable_attributes(str(name)), **variable.attrs}
    return result


def variable_attributes(name: str) -> dict[str, Any]:
    """``long_name``, ``units`` and ``comment`` of a variable; ``unloaded_`` or ``light_load_`` tells the contact."""
    for state, words in STATES.items():
        if name not in VARIABLES and name.startswith(state):
            of_any = variable_attributes(name.removeprefix(state))
            return {**of_any, "long_name": f"{words}: {of_any['long_name']}"}
    if name not in VARIABLES:
        raise EaseoffError(f"variable = {name!r}: must have a row in the table of attributes")
    units, *words_of_it = VARIABLES[name]
    attributes = dict(zip(("long_name", "comment"), words_of_it, strict=False))
    return {**attributes, "units": units} if units else attributes


def units_of(name: str) -> str | None:
    """Units of a variable of numbers; ``None`` where it is a text or a flag, or not in the table."""
    try:
        units: str | None = variable_attributes(name).get("units")
    except EaseoffError:
        return None
    return units


def flag_attributes(meanings: Mapping[int, str]) -> dict[str, Any]:
    """CF attributes ``flag_values`` and ``flag_meanings`` of an integer status variable."""
    return {
        "flag_values": np.array(list(meanings), dtype=np.int8),
        "flag_meanings": " ".join(name.lower() for name in meanings.values()),
    }


class _Asked(EnumMeta):
    """Class of statuses: what is none of them is an ``InputError``."""

    def __call__(cls, value: Any, *names: Any, **options: Any) -> Any:
        """The status of a number."""
        try:
            return super().__call__(value, *names, **options)
        except ValueError as error:
            known = ", ".join(f"{int(one)} ({one.name})" for one in cls)  # type: ignore[var-annotated]
            raise InputError(f"{cls.__name__} = {shown(value)}: must be one of {known}") from error


class StoredStatus(IntEnum, metaclass=_Asked):
    """Status that prints as its name; arrays and files hold the integer."""

    def __str__(self) -> str:
        return self.name

    def __format__(self, spec: str) -> str:
        return format(int(self), spec) if spec else self.name

    @classmethod
    def flag_attributes(cls) -> dict[str, Any]:
        """CF attributes ``flag_values`` and ``flag_meanings`` of a variable with this status."""
        return flag_attributes({int(status): status.name for status in cls})


def ordered(dataset: xr.Dataset, name: str, *dimensions: str) -> NDArray[Any]:
    """Values of a variable by all of its dimensions in the wanted order, read fast, without coordinates."""
    variable = dataset.variables[name]
    if variable.dims != dimensions:
        variable = variable.transpose(*dimensions)
    return np.asarray(variable.values)
