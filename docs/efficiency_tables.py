"""Tables of the page about chapter 5 of the dissertation: designs A and B, ours beside what it says."""

from __future__ import annotations

from functools import cache
from typing import Any, Literal

import numpy as np
import xarray as xr
from dissertation_method import by_its_method
from dissertation_radius import whole_sliding, with_radius_along_line
from dissertation_tables import table
from numpy.typing import NDArray

from easeoff.friction import FrictionModel, Operation, friction, friction_feedback
from easeoff.study import Analysis, CaseInMesh, contact_analysis
from easeoff.study.plot.friction_maps import FlankMap, loaded_map, velocity_maps
from easeoff.study.plot.tooth_view import ToothView, tooth_view

Array = NDArray[Any]
# The equivalent radius across the contact line, or along it as the dissertation seems to have it.
Direction = Literal["across", "along"]
DIRECTIONS: tuple[Direction, ...] = ("across", "along")

DESIGNS = {"a": "fh-design-a", "b": "fh-design-b"}
TORQUES = (100.0, 500.0, 1000.0)
SPEEDS = np.linspace(100.0, 3000.0, 30)
ROUGHNESSES = np.linspace(0.1, 1.3, 13)
AT = {"torque": 500.0, "speed": 1500.0, "temperature": 90.0, "roughness": 0.8}
HEADS = ("", ", radius along the line", ", dissertation")
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
    return with_direction(analysed(letter).tree, direction)


def with_direction(tree: xr.DataTree, direction: Direction) -> xr.DataTree:
    """A result with the radius of the direction."""
    return with_radius_along_line(tree) if direction == "along" else tree


@cache
def over_speed(letter: str, direction: Direction = "across") -> xr.Dataset:
    """Figure 5.11: torques and speeds at 90 degC and 0.8 um."""
    return friction(result(letter, direction), Operation(SPEEDS, 90.0, 0.8), segment_fields=False)


@cache
def over_roughness(letter: str, direction: Direction = "across") -> xr.Dataset:
    """Figure 5.12: roughnesses and temperatures at 500 N m and 1500 / min."""
    operation = Operation(1500.0, [50.0, 75.0, 100.0], ROUGHNESSES)
    found = friction(result(letter, direction), operation, segment_fields=False)
    return found.sel(torque=500.0, speed=1500.0)


@cache
def maps(letter: str, direction: Direction = "across") -> tuple[ToothView, dict[str, FlankMap], float]:
    """Figures 5.5 to 5.10: the flank, the maps by name, and the greatest pressure [MPa]."""
    tree = result(letter, direction)
    view, loaded = tooth_view(tree), tree["loaded"].to_dataset().sel(torque=AT["torque"])
    operation = Operation(AT["speed"], AT["temperature"], AT["roughness"])
    here = friction(tree, operation).sel(AT)
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
            cells += [*(cell(letter, name, direction) for direction in DIRECTIONS), theirs]
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
        medians = [float(inner(found[name].values)[2]) for found in (a, b)]
        digits = 1 if name == "equivalent_radius" else 4 if name == "friction_coefficient" else 2
        values = f"median {medians[0]:.{digits}f} and {medians[1]:.{digits}f}"
        more = percent(100.0 * (medians[1] / medians[0] - 1.0))
        rows.append((text, f"{values}, {more}", medians[1] > medians[0]))
    return rows


def dip(efficiency: xr.DataArray) -> tuple[float, float, float]:
    """Greatest fall of an efficiency with speed [%]: from which speed, to which, how much."""
    values, speeds = 100.0 * efficiency.values, efficiency["speed"].values
    falls = np.maximum.accumulate(values) - values
    end = int(np.argmax(falls))
    start = int(np.argmax(values[: end + 1]))
    return float(speeds[start]), float(speeds[end]), float(falls[end])


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
        text = "; ".join(
            f"{torque:g} N m: −{fall:.2f} % from {start:.0f} to {end:.0f} / min" if fall else f"{torque:g} N m: no fall"
            for torque, (start, end, fall) in zip(TORQUES, fallen, strict=True)
        )
        rises = bool(np.all(efficiency.sel(speed=3000.0) - efficiency.sel(speed=1500.0) > 0.0))
        holds = all(fall > 0.01 for _, _, fall in fallen) and rises
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
        text = f"by {float(whole.min()):.1f} to {float(whole.max()):.1f} % from 1.3 to 0.1 µm"
        text += f"; but for +{rise:.2f} % at a change of regime" if rise > 0.0 else ""
        rows.append((f"{letter}: smoother flanks are more efficient", text, rise < 0.05))
    for letter, efficiency in zip("AB", rough, strict=True):
        gain = efficiency.sel(temperature=100.0) - efficiency.sel(temperature=50.0)
        turn = float(gain["roughness"][np.argmax(gain.values < 0.0)])
        text = f"{gain.values[0]:+.2f} % from 50 to 100 °C at 0.1 µm, {float(gain.min()):+.2f} % at the worst, "
        text += f"{gain.values[-1]:+.2f} % at 1.3 µm; sign changes below {turn:.1f} µm"
        rows.append(
            (f"{letter}: hotter oil helps smooth flanks and hurts rough ones", text.replace("-", "−"),
             bool(gain.values[0] > 0.0 and np.all(gain.values[2:] < 0.0)))
        )  # fmt: skip
    return rows


def options() -> str:
    """Efficiency at the conditions of figures 5.9 and 5.10 by other models and with options."""
    operation = Operation(AT["speed"], AT["temperature"], AT["roughness"])
    choices: dict[str, FrictionModel | None] = {
        "as above: formula of the dissertation, Pan and Hamrock, fixed frame": FrictionModel(),
        "formula, smooth between its regimes": FrictionModel("kolivand_blended"),
        "film of Dowson and Higginson": FrictionModel(film="dowson_higginson"),
        "rolling velocity relative to the contact line": FrictionModel(rolling_frame="contact_line"),
        "slide-to-roll from the whole sliding": FrictionModel(whole_sliding),
        "radius along the contact line": FrictionModel(),
        "rolling traction without heating": FrictionModel(thermal_factor="none"),
        "torque of friction fed back to the forces": None,
        "coefficient of Xu and others, full film": FrictionModel("xu_kahraman"),
        "coefficient of Benedict and Kelly": FrictionModel("benedict_kelly"),
        "constant coefficient, 0.05": FrictionModel("constant"),
    }
    rows: list[tuple[object, ...]] = []
    for name, model in choices.items():
        cells: list[object] = [name]
        for letter in DESIGNS:
            tree = result(letter, "along" if name == "radius along the contact line" else "across")
            found = (
                friction(tree, operation, model)
                if model
                else friction_feedback(tree, analysed(letter).cases, operation)
            )
            here = found.sel(AT)
            cells += [f"{float(here['mean_friction_coefficient']):.4f}", f"{100 * float(here['efficiency']):.2f}"]
        rows.append(tuple(cells))
    return table(rows, ["", "A: mean coefficient", "A: efficiency [%]", "B: mean coefficient", "B: efficiency [%]"])


def both_ways(ours: list[tuple[str, str, bool]], theirs: list[tuple[str, str, bool]]) -> str:
    """Statements of the dissertation, what comes of them with our radius and with the dissertation's."""
    heads = ["the dissertation says", "ours", "agrees", "radius along the line", "agrees"]
    cells: list[tuple[object, ...]] = [
        (said, one, "yes" if agrees else "no", "the same" if other == one else other, "yes" if so else "no")
        for (said, one, agrees), (_, other, so) in zip(ours, theirs, strict=True)
    ]
    return table(cells, heads)


def parts() -> dict[str, str]:
    """What the template of the page leaves open."""
    return {
        "ranges": ranges(),
        "claims_on_maps": both_ways(*(claims_on_maps(direction) for direction in DIRECTIONS)),
        "claims_on_efficiency": both_ways(*(claims_on_efficiency(direction) for direction in DIRECTIONS)),
        "options": options(),
    }
