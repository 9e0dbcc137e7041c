"""Tables of the page about chapter 5: what the choices in designs A and B do, and what a doubled radius would."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from dissertation_tables import table
from efficiency_tables import AT, DESIGNS, ROUGHNESSES, SPEEDS, TORQUES, analysed, dip, inner

from easeoff.cases import Case, read_design
from easeoff.friction import Operation, friction
from easeoff.study.analysis import analyze_in_full
from easeoff.study.design import design_case

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
            tree = analyze_in_full(changed_case(letter, **changed), torques=(AT["torque"],)).tree
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


@cache
def with_radius(letter: str, factor: float) -> tuple[xr.Dataset, dict[str, xr.DataArray]]:
    """The contacts at 500 N m with the radius times a factor and the Hertz pressure to it; what comes of it."""
    tree = analysed(letter).tree
    loaded = tree["loaded"].to_dataset()
    loaded = loaded.assign(
        equivalent_radius=factor * loaded["equivalent_radius"], pressure=loaded["pressure"] / np.sqrt(factor)
    )
    other = xr.DataTree.from_dict({"ease_off": tree["ease_off"].to_dataset(), "loaded": loaded})
    here = friction(other, Operation(AT["speed"], AT["temperature"], AT["roughness"])).sel(AT)
    over_speed = friction(other, Operation(SPEEDS, 90.0, 0.8), segment_fields=False)["efficiency"].squeeze()
    rough = friction(other, Operation(1500.0, [50.0, 75.0, 100.0], ROUGHNESSES), segment_fields=False)["efficiency"]
    at = loaded.sel(torque=AT["torque"])
    found = here.assign(
        equivalent_radius=at["equivalent_radius"].where(at["force"] > 0.0), max_pressure=at["pressure"].max()
    )
    return found, {"over_speed": over_speed, "over_roughness": rough.sel(torque=500.0)}


def doubled_radius() -> str:
    """Table: as computed, with the radius doubled, and printed."""
    printed = {
        "greatest pressure [MPa]": ("to 1000", "to 1000"),
        "equivalent radius [mm]": ("35 to 50", "35 to 55"),
        "lambda ratio": ("0.10 to 0.30", "0.10 to 0.30"),
        "friction coefficient": ("0.01 to 0.06", "0.01 to 0.06"),
        "mean coefficient by power": ("", ""),
        "mean coefficient of all segments": ("", "higher than A"),
        "efficiency [%]": ("96 to 99.5", "96 to 99.5"),
        "falls with speed by, at 100 / 500 / 1000 N m [%]": ("slightly", "slightly"),
    }
    columns = []
    for i, letter in enumerate(DESIGNS):
        columns += [quantities(letter, factor) for factor in (1.0, 2.0)]
        columns.append([both[i] for both in printed.values()])
    heads = [f"{letter.upper()}{what}" for letter in DESIGNS for what in ("", ", radius doubled", ", dissertation")]
    return table(list(zip(printed, *columns, strict=True)), ["", *heads])


def quantities(letter: str, factor: float) -> list[str]:
    """A column of the table above."""
    found, efficiency = with_radius(letter, factor)

    def span(name: str, digits: int) -> str:
        low, high, _ = inner(found[name].values)
        return f"{low:.{digits}f} to {high:.{digits}f}"

    both = [efficiency["over_speed"], efficiency["over_roughness"]]
    falls = [dip(efficiency["over_speed"].sel(torque=torque))[2] for torque in TORQUES]
    return [
        f"{float(found['max_pressure']):.0f}",
        span("equivalent_radius", 0),
        span("lambda_ratio", 2),
        span("friction_coefficient", 3),
        f"{float(found['mean_friction_coefficient']):.4f}",
        f"{float(found['friction_coefficient'].mean()):.4f}",
        f"{100 * min(float(e.min()) for e in both):.1f} to {100 * max(float(e.max()) for e in both):.1f}",
        " / ".join(f"{fall:.2f}" for fall in falls),
    ]
