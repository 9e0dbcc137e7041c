"""Plausibility of a result: notes on certified values that no gear has, most often from a mistaken setting.

Told are the share of the load on tooth edges, with that beyond which the contact model is coarse; the greatest pressure
at the end of a contact line, and mesh positions where it stands out of its course; parts of the power loss beyond the
range of a friction model; settings that were corrected for measured flanks, and so are those of one machine alone; and
supports that hardly belong to the pair: of another one, bearings within a face, taper rollers that pull. Commands,
pictures, report and notebook take the words from here.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any, get_args

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.evaluation.flank_region import flank_share
from ...contact.evaluation.pressure_map import max_inner_pressure
from ...contact.outcomes import LineEnd
from ...core.arrays import RealArray as Array
from ...core.attributes import ROOT_RESOLUTION, ordered
from ...geometry.pair.member_names import MEMBERS
from ..result import CONDITIONS
from .assembly import added_notes, bearing_loads, deflection_notes, misfit, towards_heel
from .quantities import TABLES, roughness_words

#: [um] Ease-off on the common flank. Shipped pairs have up to 0.16 mm; a lost sign in a setting gives many mm.
EASE_OFF_LIMIT = 1000.0
#: [MPa] Greatest pressure. Case-hardened steel yields below the surface at 3 to 4 GPa: no contact is elastic beyond.
PRESSURE_LIMIT = 5000.0
#: Common flank over the gear flank. Teeth that belong together share most of it, 0.75 and more in the shipped cases.
COMMON_FLANK_LIMIT = 0.3


def plausibility(tree: xr.DataTree) -> list[str]:
    """Notes on what is not plausible in a result: ease-off, pressure, common flank and contradicting blanks.

    One more tells the resolution of root stresses, or why they are left out if they were asked for.
    """
    ease_off = tree["ease_off"].to_dataset()
    distance, inside = (ordered(ease_off, name, "lengthwise", "profile") for name in ("ease_off", "inside"))
    inside = inside == 1
    widest = float(np.max(np.abs(distance[inside]), initial=0.0))
    greatest = float(np.nan_to_num(tree["loaded"].to_dataset()["max_pressure"].values).max(initial=0.0))
    common = flank_share(inside)
    notes = []
    if widest > EASE_OFF_LIMIT:
        notes.append(
            f"Note: the ease-off reaches {1e-3 * widest:.3g} mm on the common flank, more than "
            f"{1e-3 * EASE_OFF_LIMIT:g} mm: are the settings of pinion and gear right, and their signs?"
        )
    if greatest > PRESSURE_LIMIT:
        notes.append(
            f"Note: the greatest pressure is {1e-3 * greatest:.3g} GPa, more than {1e-3 * PRESSURE_LIMIT:g} GPa, at "
            "which no steel is elastic: are torque and settings right?"
        )
    envelope = tree["unloaded"].to_dataset()["transmission_error_envelope"].values
    if untouched := int(np.count_nonzero(np.isnan(envelope))):
        notes.append(
            f"Note: without load the flanks do not touch at {untouched} of {envelope.size} mesh positions: there is no "
            "peak to peak of the unloaded transmission error."
        )
    if common < COMMON_FLANK_LIMIT:
        notes.append(
            f"Note: the flanks share {100 * common:.0f} % of the gear flank, less than "
            f"{100 * COMMON_FLANK_LIMIT:.0f} %: are blanks, settings and misalignment right?"
        )
    notes += [f"Warning: {text}." for text in str(tree.attrs.get("contradictions", "")).split("; ") if text]
    if "root_stress" in tree.children:
        notes.append(f"Note: the root stress is too low, {ROOT_RESOLUTION}.")
    notes += misfit(tree["backlash"].to_dataset()) if "backlash" in tree.children else []
    left_out = tree.attrs.get("root_stress_left_out")
    if left_out:
        notes.append(f"Note: no root stress. {left_out}")
    return notes


#: Greatest share of the load on edges at one mesh position that is not told: an edge bears no pressure in the result.
EDGE_SHARE = 0.03
#: The same beyond which the model is coarse. Against contact without the split, pairs
#: with less agree to 1.5 % in transmission error and line load, and ``nasa-12x36``, with 0.6, to 1.8 and 11 %.
EDGE_SHARE_LIMIT = 0.1


def edge_notes(loaded: xr.Dataset) -> list[str]:
    """Note on the torque at which edges carry most, if more than ``EDGE_SHARE``; longer beyond ``EDGE_SHARE_LIMIT``."""
    if "edge_share" not in loaded:
        return []
    share = np.nan_to_num(loaded["edge_share"].max("mesh_position").values)
    most = int(np.argmax(share))
    if share[most] <= EDGE_SHARE:
        return []
    carried = f"{100 * share[most]:.0f} % of the load ({loaded['torque'].values[most]:g} N m)"
    if share[most] <= EDGE_SHARE_LIMIT:
        return [f"Note: tooth edges beside the contact lines carry up to {carried}; no pressure is given for them."]
    return [
        f"Note: tooth edges carry up to {carried}; beside them the model is coarse: with 60 % on edges, loaded "
        "transmission errors were within 2 % and line loads within 11 %. The pressure on a sharp edge has no limit. "
        "'easeoff verify CASE --without-split' compares."
    ]


#: Part by which the greatest pressure at a line's end depends on where segments and mesh positions lie.
END_UNCERTAINTY = 0.06
INSIDE = (LineEnd.INSIDE, LineEnd.UNKNOWN)
#: Part by which a line load is too low at an end of one member's tooth beyond which the other's goes on.
TOO_LOW = 0.08
TOOTH_ENDS = (LineEnd.GEAR_TOE, LineEnd.GEAR_HEEL, LineEnd.PINION_TOE, LineEnd.PINION_HEEL)


def end_notes(loaded: xr.Dataset) -> list[str]:
    """Note on the torque whose greatest pressure, at the end of a contact line, exceeds that inside most.

    None if the greatest pressures are inside, or the result is too old to tell.
    """
    if "max_pressure_line_end" not in loaded:
        return []
    torques, greatest = loaded["torque"].values, loaded["max_pressure"].values
    ends = [LineEnd(int(value)) for value in loaded["max_pressure_line_end"].values]
    inner = max_inner_pressure(loaded)
    excess = np.nan_to_num(greatest / inner - 1.0, nan=0.0)
    indices = [number for number, end in enumerate(ends) if end not in INSIDE]
    if not indices:
        return []
    most = max(indices, key=lambda number: (excess[number], greatest[number]))
    above = "no pressure is inside"
    if np.isfinite(inner[most]):
        above = f"{100.0 * max(excess[most], 0.0):.0f} % above the greatest inside, {inner[most]:.0f} MPa"
    more = f"; likewise at {', '.join(f'{torques[n]:g}' for n in indices if n != most)} N m" if len(indices) > 1 else ""
    place = ends[most].name.lower().replace("_", " ")
    low = ""
    if ends[most] in TOOTH_ENDS:
        low = f", and up to some {100 * TOO_LOW:.0f} % too low where the mate's tooth goes on beyond this end"
    return [
        f"Note: at {torques[most]:g} N m the greatest pressure, {greatest[most]:.0f} MPa, is at the end of a contact "
        f"line ({place}): {above}; there it is uncertain by up to some {100 * END_UNCERTAINTY:.0f} %{low}; "
        f"a real edge is rounded{more}."
    ]


def execution_note(flanks: Sequence[str]) -> list[str]:
    """Note, in one line or none, on flanks with settings to execute, from ``corrected_flanks`` of a case."""
    if not flanks:
        return []
    return [
        f"Note: the settings of {', '.join(flanks)} are corrected for measured flanks, to execute on the machine that "
        "cut those; what is computed from them is of a machine without errors, on which they cut others."
    ]


def executed_settings(tree: xr.DataTree) -> list[str]:
    """Note on settings to execute, from the case that a result keeps."""
    try:
        named = tomllib.loads(str(tree.attrs.get("case", ""))).get("corrected_flanks")
    except tomllib.TOMLDecodeError:  # a case that was changed by hand
        return []
    if not isinstance(named, list):
        return []
    from ...cases.schema.case_schema import FlankOfMember  # most cases have none

    return execution_note([flank for flank in get_args(FlankOfMember) if flank in named])


#: Part by which the greatest pressure at a position exceeds that at both neighbours to be told. Shipped cases, either
#: flank, aligned or not, at 20 to 800 N m, have up to 0.12 at 32 mesh positions, where edges carry; less at more.
JUMP_LIMIT = 0.125
MESH_POSITION_MINIMUM = 16  # with fewer the course itself changes as much from one position to the next


def pressure_jumps(loaded: xr.Dataset) -> Array:
    """Excess (torque, mesh_position) of greatest pressures over the greater of both neighbours', as a fraction.

    First and last position are neighbours. Negative where a neighbour has more; NaN where one is not certified.
    """
    pressure = loaded["pressure"].transpose("torque", "mesh_position", "segment").values
    greatest = np.where(np.isfinite(pressure), pressure, -np.inf).max(axis=2)
    greatest = np.where(greatest > 0.0, greatest, np.nan)
    beside = np.maximum(np.roll(greatest, 1, axis=1), np.roll(greatest, -1, axis=1))
    return np.asarray(greatest / beside - 1.0)


def jump_notes(loaded: xr.Dataset) -> list[str]:
    """Note on the mesh position whose greatest pressure exceeds its neighbours' most, if by ``JUMP_LIMIT``."""
    if loaded.sizes["mesh_position"] < MESH_POSITION_MINIMUM:
        return []
    jumps = np.nan_to_num(pressure_jumps(loaded), nan=-1.0)
    if not jumps.max(initial=-1.0) > JUMP_LIMIT:
        return []
    torque, position = (int(i) for i in np.unravel_index(int(np.argmax(jumps)), jumps.shape))
    pressure = loaded["pressure"].isel(torque=torque, mesh_position=position).max().item()
    others = np.count_nonzero(np.delete(jumps.max(axis=1), torque) > JUMP_LIMIT)
    more = f", and likewise at {others} more torque{'s' if others > 1 else ''}" if others else ""
    return [
        f"Note: at {loaded['torque'].values[torque]:g} N m the greatest pressure jumps to {pressure:.0f} MPa at mesh "
        f"position {loaded['mesh_position'].values[position]:.4g}, {100.0 * jumps[torque, position]:.0f} % above both "
        f"neighbouring positions{more}: more mesh_positions and segments_per_line show whether it is the contact's or "
        "the grid's."
    ]


#: Inputs that the flags of ``/friction/formula_flags`` are about, 1, 2, 4 and so on.
INPUTS: dict[int, str] = {2**bit: name for bit, name in enumerate(TABLES["lists"]["flagged_inputs"])}
#: Least part of the power loss that is told: a pitch line, where nothing slides, has one or two per cent.
TOLD_SHARE = 0.05
TOLD_TRANSITION = 0.1  # the same where two expressions of a formula meet


def range_notes(friction: xr.Dataset, at: Mapping[str, int] | None = None) -> list[str]:
    """Notes on power loss beyond the range of a model: one each for formula, oil, temperature and film.

    ``at`` holds numbers of torque, speed, temperature and roughness; without it the worst condition is named.
    """
    if "film_thinning" not in friction:
        return []
    subset = friction.isel({name: [int(number)] for name, number in (at or {}).items()})
    named = at is None
    texts = (*_formula(subset, named), *_oil(subset), *_temperature(subset), *_film(subset, named))
    return [f"Note: {text}" for text in texts]


def _formula(friction: xr.Dataset, named: bool) -> list[str]:
    """Sentences on the range of the friction formula, and on where its expressions meet."""
    sentences = []
    worst, place = _worst(friction, "extrapolated_share", TOLD_SHARE)
    if place is not None:
        parts: dict[str, float] = {}
        for flag, share in zip(
            friction["formula_flag"].values, friction["flagged_share"].isel(place).values, strict=True
        ):
            name = INPUTS.get(int(flag), "another input")
            parts[name] = parts.get(name, 0.0) + float(share)
        largest = sorted(parts, key=lambda name: -round(parts[name], 4))  # alike but for rounding stay in order
        main_inputs = [name for name in largest if parts[name] >= TOLD_SHARE]
        inputs = [name for name in main_inputs if name != "coefficient"] or main_inputs or largest[:1]
        sentences.append(
            f"{_percent(worst)} of the power loss{_at(friction, place, 'roughness', named)} lies outside the range "
            f"of the friction formula ({', '.join(inputs)})."
        )
    worst, place = _worst(friction, "transition_share", TOLD_TRANSITION)
    if place is not None:
        smooth = friction.attrs["friction_coefficient"] == "kolivand_blended"
        passing = "passes smoothly" if smooth else "jumps"
        sentences.append(
            f"{_percent(worst)} of the power loss{_at(friction, place, 'roughness', named)} is where two expressions "
            "of the friction formula meet (lambda ratio 0.9 to 1.1 or 2.7 to 3.3); they differ by 10 to 30 % as a "
            f"rule, and the coefficient {passing} from one to the other."
        )
    return sentences


def _oil(friction: xr.Dataset) -> list[str]:
    """Sentence on an oil that the formula was not made for."""
    attrs = friction.attrs
    if "formula_oil" not in attrs:
        return []
    sliding = friction["mean_sliding_loss"] / friction["mean_power_loss"]
    values = sliding.values[np.isfinite(sliding.values)]
    share = float(values.max()) if values.size else 1.0
    return [
        f"{_percent(share)} of the power loss is by a friction formula made for {attrs['formula_oil']}; the oil "
        f"{attrs['oil']} enters it through its viscosity and pressure-viscosity coefficient alone."
    ]


def _temperature(friction: xr.Dataset) -> list[str]:
    """Sentence on temperatures beyond the oil's data."""
    clamped = friction["temperature"].values[friction["temperature_clamped"].values > 0]
    if not clamped.size:
        return []
    ends = np.atleast_1d(friction.attrs["oil_temperature_range_degC"])
    asked = ", ".join(f"{value:g}" for value in clamped)
    return [
        f"100 % of the power loss at {asked} degC is computed with the oil's properties at the end of its data, which "
        f"are from {ends[0]:g} to {ends[1]:g} degC."
    ]


def _film(friction: xr.Dataset, named: bool) -> list[str]:
    """Sentence on the thinning of the film by heat of the inlet."""
    from ...friction.kolivand_formula import TOLD_THINNING  # most results have no friction

    worst, place = _worst(friction, "film_thinning", TOLD_THINNING)
    if place is None:
        return []
    share, heating = float(friction["thinned_share"].isel(place)), friction.attrs["film_heating"]
    end = "it is left out; film_heating = 'gupta_cheng' includes it" if heating == "none" else "it is included"
    return [
        f"heat of the inlet thins the film by up to {_percent(worst)}{_at(friction, place, 'temperature', named)}, and "
        f"by more than 10 % for {_percent(share)} of the power loss "
        f"({'gupta_cheng' if heating == 'none' else heating}): {end}."
    ]


def _worst(friction: xr.Dataset, name: str, least: float) -> tuple[float, dict[str, int] | None]:
    """Greatest value of a share and where it is; nowhere if it is below the least that is told."""
    if name not in friction:
        return 0.0, None
    values: NDArray[Any] = np.nan_to_num(friction[name].transpose(*CONDITIONS).values)
    worst = float(values.max(initial=0.0))
    if worst < least:
        return worst, None
    # Shares that are alike but for rounding count as one: the first of them is named.
    number = int(np.argmax(values.ravel() >= worst - 1e-6))
    return worst, {name: int(i) for name, i in zip(CONDITIONS, np.unravel_index(number, values.shape), strict=True)}


def _at(friction: xr.Dataset, place: Mapping[str, int], more: str, named: bool) -> str:
    """Torque, speed and another condition in words, and those of which the result has several; or nothing."""
    if not named:
        return ""
    units = {"torque": "N m", "speed": "1/min", "temperature": "degC", "roughness": "um"}
    chosen = [name for name in CONDITIONS if name in ("torque", "speed", more) or friction.sizes[name] > 1]
    values = {name: f"{float(friction[name].values[place[name]]):.4g}" for name in chosen}
    if "roughness" in values:
        values["roughness"] = roughness_words(friction, place["roughness"])
    return " at " + ", ".join(f"{values[name]} {units[name]}" for name in chosen)


def _percent(share: float) -> str:
    """A share in per cent; 100 for the whole alone."""
    percent = 100.0 * share
    return f"{min(percent, 99.0) if percent < 99.95 else 100.0:.0f} %"


#: Axial load of a bearing over the greatest of its member, from which both count as loaded in the same sense.
SHARED_LOAD_SHARE = 0.1


def supports_notes(tree: xr.DataTree) -> list[str]:
    """Notes on supports of another pair, bearings within the teeth, and bearings that share an axial load."""
    if "supports" not in tree.children:
        return []
    return [*_other_pair(tree), *_within_face(tree), *_pulled(tree)]


def axial_face(tree: xr.DataTree, member: str) -> tuple[float, float]:
    """Range of a member's flank on its axis [mm], from its crossing point, positive towards the heel."""
    position = tree["flanks"].to_dataset()["position"].sel(member=member, xyz="z").values  # in the member's own frame
    return float(np.nanmin(position)), float(np.nanmax(position))


def _other_pair(tree: xr.DataTree) -> list[str]:
    """Shipped supports bear the name of their case: ``axle-fm-11x41``."""
    from ...cases.reading import read_case  # most pairs have none
    from ...cases.shipped_files import shipped_cases, shipped_supports

    name = str(tree.attrs.get("supports_name", ""))
    if name not in shipped_supports():
        return []
    owner = next((case for case in shipped_cases() if name.endswith(f"-{case}")), None)
    if owner is None:
        return []
    pair = read_case(owner)
    teeth = [pair.pinion.number_of_teeth, pair.gear.number_of_teeth]
    if teeth == [int(tree.attrs[f"{member}_teeth"]) for member in MEMBERS]:
        return []
    return [
        f"Note: the supports {name} are those of another pair, {owner}: are places and stiffness right for this one?"
    ]


def _within_face(tree: xr.DataTree) -> list[str]:
    """Bearings whose place on the axis is between toe and heel of their member."""
    group, ease_off = tree["supports"].to_dataset(), tree["ease_off"].to_dataset()
    if "bearing_position" not in group:
        return []
    notes = []
    places = ordered(group, "bearing_position", "bearing", "space")
    for member in MEMBERS:
        first, last = axial_face(tree, member)
        origin = np.asarray(ease_off.attrs[f"{member}_origin_mm"], dtype=float)
        for bearing, place in zip(group["bearing"].values, places, strict=True):
            along = float((place - origin) @ towards_heel(ease_off, member))
            if str(bearing).startswith(f"{member} ") and first < along < last:
                notes.append(
                    f"Note: the bearing {bearing} is at {along:.1f} mm on the axis, within the teeth, which reach from "
                    f"{first:.1f} to {last:.1f} mm: is its position right?"
                )
    return notes


def _pulled(tree: xr.DataTree) -> list[str]:
    """Members whose bearings all carry axial load in one sense, at the torque where they carry most."""
    names, _, axial = bearing_loads(tree)
    torques = np.sort(tree["supports"].to_dataset()["torque"].values)
    phrases = []
    for member in MEMBERS:
        bearings = [number for number, name in enumerate(names) if name.startswith(f"{member} ")]
        if len(bearings) < 2:
            continue
        mean = axial[bearings].mean(axis=2)
        weakest, largest = np.abs(mean).min(axis=0), np.abs(mean).max(axis=0)
        shared = (mean.min(axis=0) * mean.max(axis=0) > 0.0) & (weakest > SHARED_LOAD_SHARE * largest)
        if shared.any():
            at = int(np.argmax(np.where(shared, largest, -1.0)))
            loads = ", ".join(f"{names[number]} {mean[row, at]:+.0f} N" for row, number in enumerate(bearings))
            phrases.append(f"{loads} at {torques[at]:g} N m")
    if not phrases:
        return []
    return [
        f"Note: bearings of a member carry axial load in the same sense ({'; '.join(phrases)}): of two opposed taper "
        "roller bearings one is relieved, which holds as long as its preload lasts; these springs hold in both senses."
    ]


def doubts(tree: xr.DataTree) -> list[str]:
    """Notes on implausible numbers, extrapolation, supports, edges and line ends, pressures that jump, and friction."""
    ranges = range_notes(tree["friction"].to_dataset()) if "friction" in tree.children else []
    loaded = tree["loaded"].to_dataset()
    contact = [*edge_notes(loaded), *end_notes(loaded), *jump_notes(loaded)]
    supported = [*added_notes(tree), *deflection_notes(tree), *supports_notes(tree)]
    return [*plausibility(tree), *supported, *contact, *_searched(loaded), *ranges]


def _searched(loaded: xr.Dataset) -> list[str]:
    """Note on segments whose closest approach was searched for."""
    searched = int(loaded.attrs.get("searched_segments", 0))  # older results lack the attribute
    if not searched:
        return []
    lines = int((loaded["length"].notnull() & loaded["overhang"].isnull()).sum(["mesh_position", "segment"]).max())
    return [
        f"Note: at {searched} of {lines} segments the curvature of the flanks changes so quickly that the closest "
        "approach was searched for; forces and pressures there are approximate."
    ]
