"""Tables of the page about chapter 5: the equivalent radius, ours and that of the dissertation."""

from __future__ import annotations

from typing import Any

import numpy as np
from dissertation_tables import table
from efficiency_tables import AT, DESIGNS, DIRECTIONS, PRINTED, inner, result, with_direction

import easeoff
from easeoff.cases import Case, read_design
from easeoff.friction import Operation, friction
from easeoff.study import CaseInMesh, contact_analysis, design_case

# Choices the dissertation leaves open, and another value of each.
CHOICES: dict[str, dict[str, Any]] = {
    "as they are": {},
    "gear's face 42 mm wide, not 35": {"gear_face_width": 42.0},
    "cutter of 105 mm, not 88": {"cutter_radius": 105.0},
    "teeth 2.2 modules deep, not 2.0": {"depth_factor": 2.2},
    "gear addendum 0.05 of the depth, not 0.2": {"gear_mean_addendum_factor": 0.05},
    "limit pressure angle left out, drive flank steeper": {"limit_pressure_angle_influence": 0.0},
    "face 42 mm, addendum 0.1, drive pressure angle 24°": {
        "gear_face_width": 42.0,
        "gear_mean_addendum_factor": 0.1,
        "nominal_drive_pressure_angle": 24.0,
    },
    "half the ease-off": {"ease_off": 0.5},
}


def changed_case(letter: str, ease_off: float = 1.0, **changed: float) -> Case:
    """The case of a design with other basic data, and its ease-off times a factor."""
    design = read_design(DESIGNS[letter])
    blank, target = design.blank_design, design.target
    drive = target.drive.model_copy(update={name: ease_off * value for name, value in target.drive})
    update = {
        "blank_design": blank.model_copy(update=changed),
        "target": target.model_copy(update={"drive": drive}),
    }
    return design_case(design.model_copy(update=update))[0]


def choices() -> str:
    """Table: greatest pressure, equivalent radius and what it is per rolling velocity, at 500 N m."""
    rows: list[tuple[object, ...]] = []
    for name, changed in CHOICES.items():
        cells: list[object] = [name]
        for letter in DESIGNS:
            tree = contact_analysis(CaseInMesh.of(changed_case(letter, **changed)), AT["torque"]).tree
            loaded = tree["loaded"].to_dataset().isel(torque=0)
            rolling = friction(tree, Operation(AT["speed"]))["rolling_velocity"].sel(speed=AT["speed"])
            radius = loaded["equivalent_radius"].where(loaded["force"] > 0.0)
            low, high, _ = inner(radius.values)
            cells += [
                f"{float(loaded['max_pressure']):.0f}",
                f"{low:.0f} to {high:.0f}",
                f"{float((radius / rolling).median()):.1f}",
            ]
        rows.append(tuple(cells))
    heads = ("pressure [MPa]", "radius [mm]", "radius per velocity [mm / (m/s)]")
    return table(rows, ["", *(f"{letter.upper()}: {head}" for letter in DESIGNS for head in heads)])


def everywhere() -> str:
    """Table: equivalent radius across and along the contact line, over the flank and where there is load."""
    rows: list[tuple[object, ...]] = []
    printed = dict(zip(DESIGNS, PRINTED["equivalent radius [mm]"], strict=True))
    for letter in DESIGNS:
        for direction in DIRECTIONS:
            found = result(letter, direction)["loaded"].to_dataset().sel(torque=AT["torque"])
            radius, force = found["equivalent_radius"], found["force"]
            middle = radius.where(np.abs(found["profile"] - 0.5) < 0.1)
            ends = (middle.where(found["lengthwise"] < 0.1), middle.where(found["lengthwise"] > 0.9))
            rows.append(
                (
                    f"{letter.upper()}, {direction} the line",
                    f"{float(radius.min()):.0f} to {float(radius.max()):.0f}",
                    f"{float(radius.where(force > 0).min()):.0f} to {float(radius.where(force > 0).max()):.0f}",
                    " to ".join(f"{float(end.mean()):.0f}" for end in ends),
                    printed[letter],
                )
            )
    heads = ["radius [mm]", "all segments", "loaded segments", "toe to heel, at half height", "dissertation"]
    return table(rows, heads)


def chapter_four() -> str:
    """Table: greatest pressure of the pairs of chapter 4 at 200 N m."""
    rows: list[tuple[object, ...]] = []
    for name, printed in (("fh-12x41-45", "to 800"), ("fm-11x41", "to 1200, with a loaded edge")):
        tree = contact_analysis(CaseInMesh.of(easeoff.read_case(name)), 200.0).tree
        loaded = (with_direction(tree, direction)["loaded"].to_dataset() for direction in DIRECTIONS)
        pressures = (float(found["max_pressure"].sel(torque=200.0)) for found in loaded)
        rows.append((f"`{name}`", *(f"{pressure:.0f}" for pressure in pressures), printed))
    return table(rows, ["greatest pressure [MPa]", "across", "along the line", "dissertation"])
