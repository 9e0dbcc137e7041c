"""Tables of the page about chapter 5 of the dissertation: designs A and B, ours beside what it says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any, Literal

import numpy as np
import xarray as xr
from dissertation_method import by_its_method
from dissertation_radius import whole_sliding, with_radius_along
from dissertation_tables import table
from numpy.typing import NDArray

from easeoff.friction import FrictionModel, Operation, friction, friction_feedback
from easeoff.study import Analysis, CaseInMesh
from easeoff.study.analysis.contact_analysis import contact_analysis
from easeoff.study.plot.friction_charts import FlankMap, loaded_map, velocity_maps
from easeoff.study.plot.tooth_view import ToothView, tooth_view

Array = NDArray[Any]
# The equivalent radius across the contact line, as the text says, or along it or the tooth trace, as figure 5.8 has it.
Direction = Literal["across", "line", "trace"]
DIRECTIONS: dict[Direction, str] = {
    "across": "across the line", "line": "along the line", "trace": "along the tooth trace"
}  # fmt: skip
# Those whose numbers are listed; along the tooth trace they are nearly those along the line.
LISTED: tuple[Direction, ...] = ("across", "line")
THEIRS = FrictionModel("kolivand")  # the formula as it is printed, with its steps

DESIGNS = {"a": "fh-design-a", "b": "fh-design-b"}
TORQUES = (100.0, 500.0, 1000.0)
SPEEDS = np.linspace(100.0, 3000.0, 30)
ROUGHNESSES = np.linspace(0.1, 1.3, 13)
AT = {"torque": 500.0, "speed": 1500.0, "temperature": 90.0, "roughness": 0.8}
HEADS = (*(f", {DIRECTIONS[direction]}" for direction in LISTED), ", dissertation")
# Contours and axes of the figures (Kolivand 2009, figures 5.4 to 5.10), for A and for B.
PRINTED = {
    "greatest pressure [MPa]": ("to 1000", "to 1000"),
    "rolling velocity [m/s]": ("0.5 to 3.5", "1.0 to 4.5"),
    "sliding velocity [m/s]": ("1.0 to 2.0", "1.5 to 3.0"),
    "slide-to-roll ratio": ("0.1 to 0.8", "0.1 to 0.8"),
    "equivalent radius [mm]": ("35 to 50", "35 to 55"),
    "lambda ratio": ("0.10 to 0.30", "0.10 to 0.30"),
    "friction coefficient": ("0.01 to 0.06", "0.01 to 0.06"),
}
MAPS = ("rolling_velocity", "sliding_velocity", "slide_to_roll", "equivalent_radius", "lambda_ratio",
        "friction_coefficient")  # fmt: skip


@cache
def analysed(letter: str) -> Analysis:
    """A design at three torques, by the method of the dissertation."""
    return contact_analysis(CaseInMesh.of(by_its_method(DESIGNS[letter])), TORQUES)


@cache
def result(letter: str, direction: Direction = "across") -> xr.DataTree:
    """The result of a design at three torques, with the radius of the direction."""
    tree = analysed(letter).tree
    return tree if direction == "across" else with_radius_along(tree, direction)


@cache
def over_speed(letter: str, direction: Direction = "across") -> xr.Dataset:
    """Figure 5.11: torques and speeds at 90 degC and 0.8 um."""
    return friction(result(letter, direction), Operation(SPEEDS, 90.0, 0.8), THEIRS, segment_fields=False)


@cache
def over_roughness(letter: str, direction: Direction = "across") -> xr.Dataset:
    """Figure 5.12: roughnesses and temperatures at 500 N m and 1500 / min."""
    operation = Operation(1500.0, [50.0, 75.0, 100.0], ROUGHNESSES)
    found = friction(result(letter, direction), operation, THEIRS, segment_fields=False)
    return found.sel(torque=500.0, speed=1500.0)


@cache
def maps(letter: str, direction: Direction = "across") -> tuple[ToothView, dict[str, FlankMap], float]:
    """Figures 5.5 to 5.10: the flank, the maps by name, and the greatest pressure [MPa]."""
    tree = result(letter, direction)
    view, loaded = tooth_view(tree), tree["loaded"].to_dataset().sel(torque=AT["torque"])
    operation = Operation(AT["speed"], AT["temperature"], AT["roughness"])
    here = friction(tree, operation, THEIRS).sel(AT)
    found = velocity_maps(tree, view, AT["speed"])
    found["equivalent_radius"] = loaded_map(loaded, loaded["equivalent_radius"])
    for name in ("lambda_ratio", "friction_coefficient"):
        found[name] = loaded_map(loaded, here[name])
    return view, found, float(loaded["max_pressure"])


def inner(values: Array) -> Array:
    """Range [2] of the middle 90 % of values, and their median."""
    return np.asarray(np.nanpercentile(values, [5.0, 95.0, 50.0]))


def ranges() -> str:
    """Table of figures 5.4 to 5.10: the range of the middle 90 % of each flank, beside the printed contours."""

    def cell(letter: str, name: str, direction: Direction) -> str:
        _, found, greatest = maps(letter, direction)
        if name == "pressure":
            return f"{greatest:.0f}"
        low, high, _ = inner(found[name].values)
        digits = 0 if name == "equivalent_radius" else 3 if name == "friction_coefficient" else 2
        return f"{low:.{digits}f} to {high:.{digits}f}"

    rows: list[tuple[object, ...]] = []
    for name, (label, printed) in zip(("pressure", *MAPS), PRINTED.items(), strict=True):
        cells: list[object] = [label]
        for letter, theirs in zip(DESIGNS, printed, strict=True):
            cells += [*(cell(letter, name, direction) for direction in LISTED), theirs]
        rows.append(tuple(cells))
    return table(rows, ["", *(f"{letter.upper()}{head}" for letter in DESIGNS for head in HEADS)])


def percent(value: float) -> str:
    """A number with its sign, in percent."""
    return f"{value:+.0f} %".replace("-", "−")


def claims_on_maps(direction: Direction = "across") -> list[tuple[str, str, bool]]:
    """What the text says of figures 5.4 to 5.10."""
    said = {
        "rolling_velocity": "B rolls faster than A",
        "sliding_velocity": "B slides faster than A",
        "slide_to_roll": "B has the higher slide-to-roll ratio",
        "equivalent_radius": "B has the larger equivalent radius",
        "lambda_ratio": "B has the higher lambda ratio",
        "friction_coefficient": "B has nevertheless the higher friction coefficient",
    }
    (_, a, pressure_a), (_, b, pressure_b) = (maps(letter, direction) for letter in DESIGNS)
    less = 100.0 * (pressure_b / pressure_a - 1.0)
    ours = f"greatest pressure of B {percent(less)} against A"
    rows = [("A and B have similar pressures", ours, abs(less) < 20.0)]
    for name, text in said.items():
        values_of = [found[name].values for found in (a, b)]
        if name == "equivalent_radius":  # of the whole flank: figure 5.8 knows no torque
            values_of = [result(letter, direction)["loaded"].to_dataset()[name].values for letter in DESIGNS]
        medians = [float(inner(values)[2]) for values in values_of]
        digits = 1 if name == "equivalent_radius" else 4 if name == "friction_coefficient" else 2
        values = f"median {medians[0]:.{digits}f} and {medians[1]:.{digits}f}"
        more = percent(100.0 * (medians[1] / medians[0] - 1.0))
        rows.append((text, f"{values}, {more}", medians[1] > medians[0]))
    return rows


def dip(efficiency: xr.DataArray) -> float:
    """Greatest fall of an efficiency with speed [%]."""
    values = 100.0 * efficiency.values
    return float((np.maximum.accumulate(values) - values).max())


def claims_on_efficiency(direction: Direction = "across") -> list[tuple[str, str, bool]]:
    """What the text says of figures 5.11 and 5.12."""
    rows: list[tuple[str, str, bool]] = []
    fast = [over_speed(letter, direction).squeeze(("temperature", "roughness")) for letter in DESIGNS]
    both = [100.0 * found["efficiency"] for found in fast]
    rough = [100.0 * over_roughness(letter, direction)["efficiency"] for letter in DESIGNS]
    low, high = min(float(e.min()) for e in (*both, *rough)), max(float(e.max()) for e in (*both, *rough))
    rows.append(
        (
            "efficiencies of 96 to 99.5 % (axes of both figures)",
            f"{low:.1f} to {high:.1f} %",
            low > 96.0 and high < 99.5,
        )
    )
    lead = both[0] - both[1]
    rows.append(
        (
            "A is always more efficient, by about 1.5 % on average",
            f"by {float(lead.min()):.1f} to {float(lead.max()):.1f} %, {float(lead.mean()):.1f} % on average",
            bool(lead.min() > 0.0) and abs(float(lead.mean()) - 1.5) < 0.3,
        )
    )
    for letter, efficiency in zip("AB", both, strict=True):
        fallen = [dip(efficiency.sel(torque=torque) / 100.0) for torque in TORQUES]
        text = f"by {', '.join(f'{fall:.2f}' for fall in fallen)} %"
        rises = bool(np.all(efficiency.sel(speed=3000.0) - efficiency.sel(speed=1500.0) > 0.0))
        holds = all(fall > 0.01 for fall in fallen) and rises
        rows.append((f"{letter}: falls slightly with speed where that is low, then rises", text, holds))
    for letter, efficiency in zip("AB", both, strict=True):
        order = np.sign(efficiency.diff("torque").values)
        speeds = efficiency["speed"].values
        up = speeds[np.all(order > 0.0, axis=0)]
        down = speeds[np.all(order < 0.0, axis=0)]
        text = (
            f"up with the torque to {up.max():.0f} / min, down from {down.min():.0f} / min"
            if down.size
            else "up throughout"
        )
        rows.append(
            (f"{letter}: more torque, more efficient at low speed, less at medium and high speed", text,
             bool(up.size and down.size and up.max() < down.min()))
        )  # fmt: skip
    for letter, efficiency in zip("AB", rough, strict=True):
        rise = float(efficiency.diff("roughness").max())
        whole = efficiency.isel(roughness=0) - efficiency.isel(roughness=-1)
        text = f"by {float(whole.min()):.1f} to {float(whole.max()):.1f} %"
        text += f"; but for +{rise:.2f} % at a change of regime" if rise > 0.0 else ""
        rows.append((f"{letter}: smoother flanks are more efficient", text, rise < 0.05))
    for letter, efficiency in zip("AB", rough, strict=True):
        gain = efficiency.sel(temperature=100.0) - efficiency.sel(temperature=50.0)
        text = f"{gain.values[0]:+.2f} %, {float(gain.min()):+.2f} %"
        rows.append(
            (f"{letter}: hotter oil helps smooth flanks and hurts rough ones", text.replace("-", "−"),
             bool(gain.values[0] > 0.0 and np.all(gain.values[2:] < 0.0)))
        )  # fmt: skip
    return rows


READINGS: dict[str, Direction] = {"radius along the contact line": "line"}


def options() -> str:
    """Efficiency at the conditions of figures 5.9 and 5.10 by other models and with options."""
    operation = Operation(AT["speed"], AT["temperature"], AT["roughness"])
    choices: dict[str, FrictionModel | None] = {
        "as above: formula of the dissertation, Pan and Hamrock, fixed frame": THEIRS,
        "formula, smooth between its regimes (the default)": FrictionModel(),
        "film of Dowson and Higginson": replace(THEIRS, film="dowson_higginson"),
        "film thinned by heat of the inlet, Gupta and others": replace(THEIRS, film_heating="gupta_cheng"),
        "rolling velocity relative to the contact line": replace(THEIRS, rolling_frame="contact_line"),
        "slide-to-roll from the whole sliding": FrictionModel(whole_sliding),
        "radius along the contact line": THEIRS,
        "torque of friction fed back to the forces": None,
        "coefficient of our own study of mixed films": FrictionModel("mixed_lubrication"),
        "coefficient of Xu and others, full film": FrictionModel("xu_kahraman"),
        "coefficient of Benedict and Kelly": FrictionModel("benedict_kelly"),
        "constant coefficient, 0.05": FrictionModel("constant"),
    }
    rows: list[tuple[object, ...]] = []
    for name, model in choices.items():
        cells: list[object] = [name]
        for letter in DESIGNS:
            tree = result(letter, READINGS.get(name, "across"))
            found = (
                friction(tree, operation, model)
                if model
                else friction_feedback(tree, analysed(letter).cases, operation, THEIRS)
            )
            here = found.sel(AT)
            cells += [f"{float(here['mean_friction_coefficient']):.4f}", f"{100 * float(here['efficiency']):.2f}"]
        rows.append(tuple(cells))
    return table(rows, ["", "A: mean coefficient", "A: efficiency [%]", "B: mean coefficient", "B: efficiency [%]"])


Claims = list[tuple[str, str, bool]]


def by_reading(claims: Callable[[Direction], Claims]) -> str:
    """Statements of the dissertation, and what comes of them with each reading of the equivalent radius."""
    heads = [
        "the dissertation says",
        *(head for direction in LISTED for head in (f"radius {DIRECTIONS[direction]}", "agrees")),
    ]
    found = {direction: claims(direction) for direction in LISTED}
    cells: list[tuple[object, ...]] = []
    for rows in zip(*found.values(), strict=True):
        said, first, _ = rows[0]
        cell: list[object] = [said]
        for number, (_, one, agrees) in enumerate(rows):
            cell += ["the same" if number and one == first else one, "yes" if agrees else "no"]
        cells.append(tuple(cell))
    return table(cells, heads)


def statements_lost() -> str:
    """Which of the statements each reading of the equivalent radius does not give."""
    rows: list[tuple[object, ...]] = []
    for direction, words in DIRECTIONS.items():
        claims = [*claims_on_maps(direction), *claims_on_efficiency(direction)]
        lost = [said for said, _, agrees in claims if not agrees]
        rows.append((words, f"{len(lost)} of {len(claims)}", "; ".join(lost)))
    return table(rows, ["equivalent radius", "statements lost", "which"])


def parts() -> dict[str, str]:
    """What the template of the page leaves open."""
    return {
        "ranges": ranges(),
        "claims_on_maps": by_reading(claims_on_maps),
        "claims_on_efficiency": by_reading(claims_on_efficiency),
        "statements_lost": statements_lost(),
        "options": options(),
    }
