"""Attributes of variables: units and long names of everything that leaves the package, in one table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from .errors import EaseoffError

VARIABLES: Mapping[str, tuple[str, str]] = {
    # dimensions and coordinates
    "lengthwise": ("1", "fraction along the face, 0 at the toe, 1 at the heel"),
    "profile": ("1", "fraction of the flank's height, 0 at the root, 1 at the tip"),
    "mesh_position": ("1", "fraction of the mesh cycle (one pinion pitch)"),
    "pinion_rotation": ("rad", "pinion rotation in the drive sense, zero where the middle of its flank is in contact"),
    "torque": ("N m", "torque at the pinion"),
    "order": ("1", "harmonic order of the mesh frequency"),
    "pair": ("1", "tooth pair: 0 the pair followed, negative before it, positive after it"),
    "segment": ("1", "contact segment, counted over all contact lines"),
    "setting": ("", "setting, assembly error, deviation or load by which is differentiated"),
    "setting_units": ("", "unit of the setting"),
    "member": ("", "member of the pair"),
    "space": ("", "component in the global frame: z along the gear axis, x to the mesh, y along the offset"),
    "xyz": ("", "component in the member's frame: z along its axis from the crossing point to the heel"),
    "flank": ("", "flank of the member"),
    "row": ("1", "row of the measuring grid, 1 at the root"),
    "column": ("1", "column of the measuring grid, 1 at the toe"),
    # flanks
    "position": ("mm", "position on the flank in the member's frame"),
    "normal": ("1", "unit normal of the flank, out of the tooth"),
    "principal_curvature": ("mm-1", "principal curvature, positive where the tooth is convex"),
    "principal_direction": ("1", "unit vector of the first principal direction"),
    "flank_status": ("", "why a node can or cannot be used"),
    "inside": ("1", "1 where the node is usable, 0 elsewhere"),
    # ease-off
    "ease_off": ("um", "ease-off along the normal, positive where there is a gap"),
    "ease_off_angle": ("rad", "ease-off as a rotation of the gear, positive where there is a gap"),
    "roll_angle": (
        "rad",
        "pinion rotation at which the node is in conjugate contact, zero at the middle of the pinion",
    ),
    "lever_arm": ("mm", "arm of the normal force about the gear axis"),
    "separation_curvature": ("rad-1", "second derivative of the gap, as a gear rotation, by the pinion rotation"),
    "separation_skew": ("rad-2", "third derivative of the gap, as a gear rotation, by the pinion rotation"),
    "pinion_lengthwise": ("1", "lengthwise fraction of the conjugate point on the pinion"),
    "pinion_profile": ("1", "profile fraction of the conjugate point on the pinion"),
    "pinion_lengthwise_rate": ("rad-1", "derivative by the pinion rotation of the lengthwise fraction opposite a node"),
    "pinion_profile_rate": ("rad-1", "derivative by the pinion rotation of the profile fraction opposite a node"),
    "pinion_lengthwise_acceleration": ("rad-2", "second derivative by the pinion rotation of that lengthwise fraction"),
    "pinion_profile_acceleration": ("rad-2", "second derivative by the pinion rotation of that profile fraction"),
    "action_position": ("mm", "where the node makes conjugate contact, in the global frame"),
    "action_normal": ("1", "the pinion's outward normal there"),
    "blade_distance": (
        "mm",
        "distance from the end of the edge radius along the blade that cuts here, the smaller of both members",
    ),
    "status": ("", "why a node or a solution can or cannot be used"),
    # deviations
    "deviation": (
        "um",
        "deviation from the designed flank along its outward normal, positive where there is more metal",
    ),
    "measured_position": ("mm", "measured point of the flank in the member's frame"),
    "extrapolated": ("1", "1 where a deviation is taken beyond its outermost nodes, 0 elsewhere"),
    "pinion_deviation": (
        "um",
        "deviation of the pinion flank at the conjugate point, positive where there is more metal",
    ),
    "gear_deviation": ("um", "deviation of the gear flank, positive where there is more metal"),
    "ease_off_change": ("um", "change of the ease-off by the deviations, along the normal"),
    # teeth
    "shell_height": ("mm", "height above the root line where the line of the contact force meets the tooth's middle"),
    "shell_arc": ("mm", "distance from the toe along the tooth trace where the force meets the tooth's middle"),
    "shell_direction": (
        "1",
        "direction of the contact force on the tooth: along height, along trace, through thickness",
    ),
    "depth": ("mm", "distance from the contact point to the tooth's middle along the normal"),
    "trace_length": ("mm", "length of the tooth along its trace at mid height"),
    "trace_radius": ("mm", "radius of the tooth trace at mid face"),
    "tooth_height": ("mm", "tooth height above the root cone"),
    "tooth_thickness": ("mm", "normal circular thickness of the tooth in the middle of the flank"),
    "plate_thickness": ("mm", "normal thickness of the plate that stands for the tooth"),
    "fitted_thickness": ("mm", "normal thickness of the plate with a bulge that stands for the tooth"),
    "bulge": ("mm", "what the plate with a bulge is thicker at mid height than an even taper"),
    "fanning": ("mm-1", "growth of the tooth trace's length per height, over its length at mid height"),
    "shell_axis": ("", "axis of the plate that stands for the tooth"),
    "tooth_end": ("", "end of the tooth"),
    "plate_edge": ("", "edge of the plate"),
    "side": ("", "side of the tooth"),
    "upward": ("1", "number of the node from the root land to the tip"),
    "level": ("1", "fraction of the height from the fillet's end to the tip"),
    "region": ("", "what part of the tooth a node lies on"),
    "transverse_thickness": ("mm", "chord across the tooth at right angles to the member's axis"),
    "principal": ("1", "number of the principal curvature"),
    "end": ("1", "end of the contact line"),
    # unloaded
    "transmission_error": ("urad", "transmission error as a rotation of the gear, positive where the gear lags"),
    "transmission_error_envelope": ("urad", "transmission error of the pair that carries"),
    "carrying_pair": ("1", "tooth pair that carries"),
    "path_lengthwise": ("1", "lengthwise fraction of the point of contact on the gear"),
    "path_profile": ("1", "profile fraction of the point of contact on the gear"),
    "contact_edge": ("", "edge of a flank on which the tooth pair touches"),
    "line_lengthwise": ("1", "lengthwise fraction of the two ends of the contact line on the gear"),
    "line_profile": ("1", "profile fraction of the two ends of the contact line on the gear"),
    "line_length": ("mm", "length of the contact line within the chosen separation"),
    "peak_to_peak": ("urad", "peak to peak of the transmission error over a mesh cycle"),
    "mean_level": ("urad", "mean of the transmission error over a mesh cycle"),
    "harmonic": ("urad", "amplitude of a harmonic of the transmission error"),
    "rms": ("urad", "root of the sum of the squared amplitudes of the first three harmonics"),
    # loaded
    "force": ("N", "normal force on a segment"),
    "pressure": ("MPa", "greatest contact pressure of a segment"),
    "gap": ("um", "gap left at a segment along the normal"),
    "separation": ("mm", "normal gap before loading at the nominal rotation"),
    "length": ("mm", "length of a segment"),
    "equivalent_radius": ("mm", "radius of relative curvature across the contact line"),
    "half_width": ("mm", "half width of the contact band"),
    "tooth": ("1", "tooth pair the segment belongs to"),
    "overhang": ("mm", "how far beyond a tooth edge the flanks would come closest; NaN on contact lines"),
    "edge_share": ("1", "share of the gear torque carried by tooth edges beside the contact lines"),
    "load_share": ("1", "share of the gear torque carried by a tooth pair"),
    "equilibrium": ("1", "certificate: torque error over the torque"),
    "negative_force": ("1", "certificate: largest negative force over the greatest force"),
    "negative_gap": ("1", "certificate: largest penetration over the mean deflection"),
    "complementarity": ("1", "certificate: largest of the smaller one of force and gap, each scaled"),
    "duality_gap": ("1", "certificate: relative duality gap"),
    "resolution": ("1", "certificate: bound of the rounding in its violations"),
    "cancellation": ("1", "certificate: terms of torque or gaps over torque or deflection; above 1e5 costs digits"),
    "iterations": ("1", "iterations of the solver"),
    "max_pressure": (
        "MPa",
        "greatest contact pressure over the mesh cycle; NaN where sharp edges carry all of the load",
    ),
    # evaluation of a mesh cycle
    "contact_ratio": ("1", "rotation over which a tooth pair is in contact, over the pitch; see the page on results"),
    "geometric_contact_ratio": ("1", "rotation over which a tooth pair has contact lines, over the pitch"),
    "least_gap": ("um", "least gap of the unloaded flanks over the mesh cycle, the carrying pair in contact"),
    "pattern_centre_lengthwise": ("1", "lengthwise fraction of the centroid of the contact pattern on the gear"),
    "pattern_centre_profile": ("1", "profile fraction of the centroid of the contact pattern on the gear"),
    "pattern_length": ("1", "length of the contact pattern along the gear's face, over the face width"),
    "pattern_height": ("1", "height of the contact pattern on the gear, over that of the flank"),
    "load_centre_lengthwise": ("1", "mean lengthwise fraction on the gear of all normal forces of the mesh cycle"),
    "load_centre_profile": ("1", "mean profile fraction on the gear of all normal forces of the mesh cycle"),
    "load_extent_lengthwise": ("1", "root-mean-square distance from that mean along the face, over the face width"),
    "load_extent_profile": ("1", "root-mean-square distance from that mean along the profile, over the flank's height"),
    "max_load_share": ("1", "greatest share of the gear torque carried by a tooth pair"),
    "max_pressure_position": ("1", "mesh position of the greatest contact pressure"),
    "max_pressure_pair": ("1", "tooth pair with the greatest contact pressure"),
    "max_pressure_lengthwise": ("1", "lengthwise fraction of the greatest contact pressure on the gear"),
    "max_pressure_profile": ("1", "profile fraction of the greatest contact pressure on the gear"),
    "max_pressure_line_end": ("", "border of the common flank near the greatest contact pressure, if there is one"),
    "pinion_mean_level": ("urad", "mean of the transmission error as a rotation of the pinion"),
    "pinion_peak_to_peak": ("urad", "peak to peak of the transmission error as a rotation of the pinion"),
    "mesh_stiffness": ("N m urad-1", "derivative of the gear torque by the rotation of the gear"),
    "mean_mesh_stiffness": ("N m urad-1", "mean of the mesh stiffness over the mesh cycle"),
    "min_film_thickness": ("um", "least film thickness over the mesh cycle"),
    "min_film_position": ("1", "mesh position of the least film thickness"),
    "min_film_lengthwise": ("1", "lengthwise fraction of the least film thickness on the gear"),
    "min_film_profile": ("1", "profile fraction of the least film thickness on the gear"),
    # key numbers
    "marking": ("um", "thickness of the marking compound, the gap within which unloaded flanks count as in contact"),
    "common_flank": ("1", "share of the gear flank that meets the pinion flank"),
    "max_ease_off": ("um", "greatest ease-off on the common flank"),
    "max_edge_share": ("1", "greatest share of the gear torque carried by tooth edges, of all mesh positions"),
    "certified_positions": ("1", "number of mesh positions with a certified solution"),
    "worst_certificate": ("1", "greatest entry of the certificates of all mesh positions"),
    # root stress
    "root_stress": ("MPa", "largest tensile stress around the loaded side's fillet over the mesh cycle"),
    "root_stress_history": ("MPa", "largest tensile stress around the loaded side's fillet, anywhere along the face"),
    "max_root_stress": ("MPa", "largest tensile stress in the root over face and mesh cycle"),
    # wear
    "step": ("1", "step of the wear, 0 at the start"),
    "wear_depth": ("um", "metal worn off along the normal, on the member's own flank"),
    "revolutions": ("1", "revolutions of the pinion"),
    "revolution_share": ("1", "share of the revolutions at each torque"),
    "largest_depth": ("um", "largest depth of wear on the flank"),
    "removed_volume": ("mm3", "volume worn off one tooth, from force and sliding"),
    "depth_integral": ("mm3", "volume worn off one tooth, as the integral of the depth over the flank"),
    # load cases
    "load_case": ("", "load case"),
    "offset": ("mm", "E: increase of the offset"),
    "pinion_axial": ("mm", "P: pinion away from its crossing point, along its axis"),
    "gear_axial": ("mm", "G: gear away from its crossing point, along its axis"),
    "shaft_angle": ("rad", "Sigma: increase of the shaft angle"),
    # supports
    "whole_rotation": ("urad", "rotation of the gear with that by the supports, from first contact without load"),
    "support_rotation": ("urad", "rotation of the gear by the supports, on average over the mesh cycle"),
    "pinion_support_rotation": (
        "urad",
        "rotation of the pinion about its axis in the motion of the supports, drive sense",
    ),
    "gear_support_rotation": ("urad", "rotation of the gear about its axis in the motion of the supports, drive sense"),
    "teeth_rotation": ("urad", "part of the whole rotation by the bending of teeth and roots"),
    "contact_rotation": ("urad", "part of the whole rotation by the flattening of the contact"),
    "supports_rotation": ("urad", "part of the whole rotation by the supports"),
    "ease_off_rotation": ("urad", "part of the whole rotation by the ease-off where the load is carried"),
    "mesh_force": ("N", "force of the mesh on the member"),
    "mesh_moment": ("N m", "moment of the mesh on the member about its reference point"),
    "reference": ("mm", "reference point of the member's support"),
    "bearing": ("", "bearing of a member"),
    "bearing_force": ("N", "force on the bearing"),
    "bearing_moment": ("N m", "moment on the bearing about its centre"),
    "bearing_position": ("mm", "centre of the bearing"),
    "rounds": ("1", "rounds in which the ease-off was computed anew in the assembly under load"),
    "last_change": ("um", "greatest change of the gap by what the last round still changed of the assembly"),
    "rounds_status": ("", "how the rounds ended"),
    "misalignment_offset": ("mm", "E: increase of the offset"),
    "misalignment_pinion_axial": ("mm", "P: pinion away from its crossing point, along its axis"),
    "misalignment_gear_axial": ("mm", "G: gear away from its crossing point, along its axis"),
    "misalignment_shaft_angle": ("rad", "increase of the shaft angle"),
    "share": ("1", "share of time"),
    "reason": ("", "why the load case could not be analysed; empty if it was"),
    "damage_exponent": ("1", "exponent p of a life, in cycles, in proportion to the torque to the power -p"),
    "equivalent_torque": ("N m", "torque at the pinion that does the same damage to the flank in as many cycles"),
    "damage_share": ("1", "share of the load case in the damage of its flank"),
    "duty_power_loss": ("W", "power loss of the pair, mean over time"),
    "duty_input_power": ("W", "torque times angular velocity of the pinion, mean over time"),
    "duty_efficiency": ("1", "one less mean power loss over mean power in"),
    # V-H check
    "place": ("", "place on the gear flank at which the pattern is centred"),
    "v": ("mm", "V: displacement along the offset, added to E of the misalignment"),
    "h": ("mm", "H: displacement of the pinion along its axis, added to P of the misalignment"),
    "place_lengthwise": ("1", "lengthwise fraction at which the centre of the pattern is wanted"),
    "place_profile": ("1", "profile fraction at which the centre of the pattern is wanted"),
    "v_grid": ("mm", "V of a pattern in the grid"),
    "h_grid": ("mm", "H of a pattern in the grid"),
    "total_v": ("mm", "V at the heel less V at the toe"),
    "total_h": ("mm", "H at the heel less H at the toe"),
    "h_over_v": ("1", "total H over total V"),
    "pattern_from": ("1", "least lengthwise fraction of the contact pattern on the gear"),
    "pattern_to": ("1", "greatest lengthwise fraction of the contact pattern on the gear"),
    "print_excess": (
        "1",
        "gap over the thickness of the marking compound, less one, or distance beyond the common flank: negative "
        "within the print",
    ),
    "in_plane": ("mm", "position of the flank in its projection plane: along the face from the toe, and across it"),
    "plane_axis": ("", "axis of the projection plane"),
    # optimal modification
    "term": ("", "term of the modification, in fractions from -1 to 1 lengthwise and up the profile"),
    "coefficient": ("um", "coefficient of a term"),
    "modification": ("um", "addition to the ease-off along the normal"),
    "stage": ("", "before or after the modification"),
    "assembly": ("1", "number of the assembly: 0 the case's own, then the other misalignments"),
    "gear_axial_error": ("mm", "assembly error G"),
    "shaft_angle_error": ("rad", "assembly error Sigma"),
    "max_line_load": ("N mm-1", "greatest line load over the mesh cycle"),
    "max_end_load": ("N mm-1", "greatest line load at the ends of the contact lines over the mesh cycle"),
    "least_line_load": ("N mm-1", "line load were it even along all contact lines of the worst mesh position"),
    "load_norm": ("N mm-0.5", "root of the sum over the mesh cycle of line load squared times length"),
    "programme": ("1", "number of the convex programme"),
    "search": ("", "start of the search: all segments held in contact, the present ease-off, or a tighter limit"),
    "reach": ("um", "how far the programme could move the surface"),
    "promised_objective": ("1", "objective over that of the start, as the programme promised"),
    "fresh_objective": ("1", "the same, solved afresh"),
    "promised_violation": ("1", "part by which the worst limit is passed, as the programme promised"),
    "fresh_violation": ("1", "the same, solved afresh"),
    "accepted": ("1", "1 where the search went on from the answer"),
    "mending": ("1", "1 where a programme began at the answer of the one before, which broke a limit"),
    "programme_status": ("", "status of the programme in the words of CVXPY"),
    # friction
    "speed": ("1/min", "rotational speed of the pinion"),
    "temperature": ("degC", "temperature of the oil at the inlet of the contact"),
    "roughness": ("um", "RMS roughness Rq of the flanks; of unlike ones the quadratic mean"),
    "roughness_pinion": ("um", "RMS roughness Rq of the pinion's flank"),
    "roughness_gear": ("um", "RMS roughness Rq of the gear's flank"),
    "viscosity": ("mPa s", "dynamic viscosity of the oil at ambient pressure"),
    "pressure_viscosity": ("GPa-1", "pressure-viscosity coefficient of the oil"),
    "temperature_clamped": ("1", "1 where the oil's data end and their last value was taken, 0 elsewhere"),
    "sliding_velocity": ("m s-1", "speed of the flanks relative to each other"),
    "sliding_along": ("m s-1", "sliding of the pinion on the gear along the contact line, positive towards the heel"),
    "sliding_across": (
        "m s-1",
        "sliding of the pinion on the gear across the contact line, positive the way the line moves over the gear",
    ),
    "rolling_velocity": ("m s-1", "mean speed of both surfaces across the contact line, in the chosen frame"),
    "slide_to_roll": (
        "1",
        "size of the sliding over the rolling velocity, both across the contact line unless chosen otherwise",
    ),
    "film_thickness": ("um", "least thickness of the oil film between smooth flanks"),
    "lambda_ratio": ("1", "least film thickness over the composite roughness"),
    "friction_coefficient": (
        "1",
        "coefficient of sliding friction; of an edge, which has no pressure, that of its whole strip",
    ),
    "formula_flags": ("", "where the formula's arguments were clamped or lie outside its data"),
    "formula_flag": ("", "flag of the formula's range, one of those of formula_flags"),
    "extrapolated_share": ("1", "part of the power loss where an input of the friction formula is beyond its range"),
    "flagged_share": ("1", "part of the power loss where the flag is set"),
    "transition_share": ("1", "part of the power loss where two expressions of the friction formula meet"),
    "film_thinning": (
        "1",
        "greatest part by which heat of the inlet thins the film; left out of film_thickness if film_heating is none",
    ),
    "thinned_share": ("1", "part of the power loss where heat of the inlet thins the film by more than a tenth"),
    "flash_temperature": ("K", "greatest rise of the contact's temperature over that of the teeth"),
    "pressure_velocity": ("MPa m s-1", "greatest contact pressure of a segment times its sliding velocity"),
    "bulk_temperature": ("degC", "temperature of the teeth; that of the oil unless given"),
    "max_flash_temperature": ("K", "greatest flash temperature over the mesh cycle, on contact lines"),
    "max_flash_position": ("1", "mesh position of the greatest flash temperature"),
    "max_flash_lengthwise": ("1", "lengthwise fraction of the greatest flash temperature on the gear"),
    "max_flash_profile": ("1", "profile fraction of the greatest flash temperature on the gear"),
    "max_contact_temperature": ("degC", "bulk temperature and greatest flash temperature over the mesh cycle"),
    "max_pressure_velocity": ("MPa m s-1", "greatest pressure times sliding velocity over the mesh cycle"),
    "power_loss": ("W", "power loss of a segment, sliding and rolling"),
    "mesh_power_loss": ("W", "power loss of the pair at a mesh position"),
    "mesh_efficiency": ("1", "power out over power in at a mesh position"),
    "mean_power_loss": ("W", "power loss of the pair, mean over the mesh cycle"),
    "mean_sliding_loss": ("W", "part of the mean power loss that is due to sliding"),
    "mean_rolling_loss": ("W", "part of the mean power loss that is due to rolling"),
    "mean_friction_coefficient": ("1", "sliding loss over the sum of force times sliding velocity, of the mesh cycle"),
    "efficiency": ("1", "power out over power in, mean over the mesh cycle"),
    "output_torque": ("N m", "torque the gear gives out, friction taken into account"),
    "energy_balance": ("1", "input power less output power less losses, over the input power"),
    "input_power": ("W", "torque times angular velocity of the pinion"),
    # lubricated line contact
    "rolling_position": ("um", "distance from the middle of the dry contact along the rolling direction"),
    "time": ("us", "time since the heights began to grow"),
    "kept_time": ("us", "time of the fields that were kept"),
    "film_pressure": ("MPa", "pressure of film and touching asperities together"),
    "asperity_pressure": ("MPa", "part of the pressure that statistical asperities carry"),
    "film": ("um", "film thickness; behind the end of the film the gap"),
    "node_state": ("", "what holds at a node"),
    "settled": ("1", "1 for steps that count in averages, 0 elsewhere"),
    "leak": (
        "1",
        "lubricant made or lost over what flows through in a step; rounding but for failed steps",
    ),
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
    "event_torque": ("N mm", "torque about the gear axis at which the segment enters or leaves the contact"),
    "event_segment": ("1", "segment that enters or leaves the contact"),
    "event_enters": ("1", "1 where the segment enters the contact, 0 where it leaves"),
    "path_torque": ("N mm", "torque about the gear axis at the breakpoints of the path"),
    "path_rotation": ("rad", "rotation of the gear at the breakpoints"),
    "path_force": ("N", "normal force on a segment at the breakpoints"),
    "path_gap": ("mm", "gap left at a segment at the breakpoints"),
    # verification
    "quantity": ("", "what was checked"),
    "compared": ("", "with what it was compared, or why the comparison does not apply"),
    "difference": ("", "greatest difference, in its own unit"),
    "limit": ("", "greatest difference that is within the stated limit"),
    "difference_unit": ("", "unit of difference and limit"),
    "comparison_status": ("", "whether the difference is within its limit"),
    # reductions of sweeps
    "coordinate": ("", "swept coordinate"),
    "slope": ("", "derivative of the number by the coordinate"),
    "scale": ("", "standard deviation of the samples of the coordinate, or half the range of its grid"),
    "effect": ("", "change of the number with one scale of the coordinate"),
    "variance_share": ("1", "share of the variance of the number that is due to the coordinate alone, to first order"),
    # library of problems
    "name": ("", "name of the problem in the library"),
    "case": ("", "shipped case the problem comes from"),
    "flanks": ("", "which flanks mesh: drive or coast"),
    "pinion_torque": ("N m", "torque at the pinion in the instant the problem comes from"),
    "depends_on_torque": ("1", "1 where the assembly depends on the torque; its errors are then those without torque"),
    "offset_error": ("mm", "assembly error E"),
    "pinion_axial_error": ("mm", "assembly error P"),
    "segments_per_line": ("1", "segments of a contact line"),
    "change": ("", "how the problem was made from a real one; empty for a real one"),
    "amount": ("", "how much of that change"),
    "sequence": ("", "name of the sequence of neighbouring problems; empty if in none"),
    "sequence_step": ("1", "number in the sequence; -1 if in none"),
    "checksum": ("", "SHA-256 of the numbers: torque, separation, lever arm, compliance"),
    "elastic_rotation": ("rad", "reference: rotation beyond first contact"),
    "touching": ("1", "reference: number of segments that carry load; -1 where that is not determined"),
    "condition_number": ("1", "greatest over least eigenvalue of the compliance; infinite where the least is rounding"),
}

#: States of the contact that may stand before the name of a variable.
STATES: Mapping[str, str] = {"unloaded_": "without load", "light_load_": "at light load", "grid_": "in the grid"}


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """Attach ``units`` and ``long_name`` to every variable and coordinate of a dataset.

    Attributes that a variable already has are kept.

    Raises
    ------
    EaseoffError
        If a variable is not in the table.

    Examples
    --------
    >>> labelled(xr.Dataset({"force": ("segment", [1.0])}))["force"].attrs["units"]
    'N'
    """
    result = dataset.copy()
    for name, variable in result.variables.items():
        units, long_name = described(str(name))
        attributes: dict[str, Any] = {"long_name": long_name}
        if units:
            attributes["units"] = units
        variable.attrs = {**attributes, **variable.attrs}
    return result


def described(name: str) -> tuple[str, str]:
    """Units and long name of a variable; ``unloaded_`` and ``light_load_`` before a name say of which contact."""
    for state, words in STATES.items():
        if name not in VARIABLES and name.startswith(state):
            units, long_name = described(name.removeprefix(state))
            return units, f"{words}: {long_name}"
    if name not in VARIABLES:
        raise EaseoffError(f"variable = {name!r}: must have a row in the table of attributes")
    return VARIABLES[name]


def flag_attributes(meanings: Mapping[int, str]) -> dict[str, Any]:
    """CF attributes ``flag_values`` and ``flag_meanings`` of an integer status variable."""
    return {
        "flag_values": np.array(list(meanings), dtype=np.int8),
        "flag_meanings": " ".join(name.lower() for name in meanings.values()),
    }
