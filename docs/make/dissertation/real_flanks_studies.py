"""Where the update of the ease-off is good enough, and wear by our own law: tables of worn_and_measured_flanks.md."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from dissertation_method import by_its_method
from dissertation_tables import HEADS, table
from real_flanks_analyses import CASES, MEMBERS, PRINTED, TORQUE, analysed, files, ours, pressures

import easeoff
from easeoff import GeometryError
from easeoff.cases import gear_pair
from easeoff.geometry import Deviation, GearPair, pair_geometry
from easeoff.geometry.deviation.deviated_flank import deviated_ease_off
from easeoff.study import WearLaw, wear
from easeoff.study.deviations import deviated_geometry, flank_deviations

DUTY = {100.0: 0.4, 200.0: 0.3, 300.0: 0.2, 400.0: 0.1}
TORQUES = (25.0, 50.0, 100.0, 200.0, 300.0, 400.0)


def scaled(deviations: dict[str, Deviation], factor: float) -> dict[str, Deviation]:
    """Deviations times a factor."""
    return {name: Deviation(d.section, d.axial, d.radial, factor * d.value, d.method) for name, d in deviations.items()}


def printed_update(pair: GearPair, designed: xr.Dataset, update: xr.Dataset) -> xr.Dataset:
    """Ease-off of deviating flanks by Kolivand 2009, Eq. 4.5a and 4.6 as printed, from its ``deviated_ease_off``.

    A deviation d turns a flank by (u . n) d / L, where d / (L (u . n)) is right: u the circumferential direction, L the
    distance from the axis.
    """
    lever, ratio = designed["lever_arm"], pair.assembly.ratio
    nodes = np.meshgrid(designed["lengthwise"].values, designed["profile"].values, indexing="ij")
    _, gear_radius = pair.gear.section.points(*nodes)
    _, pinion_radius = pair.pinion.section.points(
        designed["pinion_lengthwise"].values, designed["pinion_profile"].values
    )
    by_gear = 1e-3 * update["gear_deviation"] * lever / gear_radius**2
    by_pinion = 1e-3 * update["pinion_deviation"] * lever / ratio / pinion_radius**2
    change = -(by_pinion / ratio + by_gear)
    return update.assign(
        ease_off_angle=designed["ease_off_angle"] + change,
        ease_off_change=1e3 * change * lever,
        roll_angle=designed["roll_angle"] - by_pinion,
    ).assign_attrs(first_contact_rad=designed.attrs["first_contact_rad"])


def judged(pair: GearPair, deviations: dict[str, Deviation], printed: bool) -> tuple[float, float, float]:
    """Largest change of the ease-off, error of its update [um] and of the roll angle [mrad]."""
    geometry = pair_geometry(pair)
    designed = geometry.ease_off
    update = deviated_ease_off(geometry, pinion=deviations["pinion"], gear=deviations["gear"])
    if printed:
        update = printed_update(pair, designed, update)
    exact = deviated_geometry(pair, (31, 21), deviations, "surface").ease_off
    inside = (update["inside"].values & exact["inside"].values).astype(bool)
    angle = [e["ease_off_angle"].values + e.attrs["first_contact_rad"] for e in (update, exact)]
    error = 1e3 * np.abs(angle[0] - angle[1]) * update["lever_arm"].values
    roll = 1e3 * np.abs((update["roll_angle"] - exact["roll_angle"]).values)
    change = np.abs(update["ease_off_change"].values)
    return tuple(float(np.max(v[inside])) for v in (change, error, roll))  # type: ignore[return-value]


def swing(name: str, deviations: dict[str, Deviation], way: str) -> float:
    """Unloaded peak to peak [urad]; NaN if the flanks have no line contact somewhere."""
    options: Any = {"deviations": deviations, "deviated": way}
    try:
        return ours(easeoff.analyze(by_its_method(name), torques=[TORQUE], **options))[0][0]
    except GeometryError:
        return float("nan")


def shortcut() -> str:
    """Where the update of the ease-off is good enough."""
    rows: list[tuple[object, ...]] = []
    for example, name in CASES.items():
        pair = gear_pair(easeoff.read_case(name), "drive")
        whole = flank_deviations(pair, files(example))  # type: ignore[arg-type]
        for factor in (2.0, 1.0, 0.5):
            deviations = scaled(whole, factor)
            change, error, roll = judged(pair, deviations, printed=False)
            _, printed, printed_roll = judged(pair, deviations, printed=True)
            update, surface = (swing(name, deviations, way) for way in ("ease_off", "surface"))
            shown = (f"{surface:.1f}", f"{update - surface:+.2f}") if np.isfinite(surface) else ("refused", "")
            rows.append(
                (
                    f"{example}, × {factor:g}", f"{change:.1f}", f"{error:.3f}", f"{printed:.1f}", f"{roll:.2f}",
                    f"{printed_roll:.2f}", *shown,
                )
            )  # fmt: skip
    return table(
        rows,
        ["deviations", "change [µm]", "error [µm]", "as printed", "error of roll angle [mrad]", "as printed",
         "unloaded peak to peak [µrad]", "error"],
    )  # fmt: skip


def own_wear() -> str:
    """The pair worn by our own law at 200 N m until the pinion is as deep as the dissertation's."""
    law = WearLaw(1e-12, 1e-12, revolutions=1e12, largest_step=0.5, largest_depth=10.0)
    history = wear(by_its_method(CASES["worn"]), law, torque=TORQUE)
    last = history.isel(step=-1)
    left: Any = {member: last[["deviation"]].sel(member=member) for member in MEMBERS}
    tree = easeoff.analyze(by_its_method(CASES["worn"]), torques=[TORQUE], deviations=left)
    before, after = ours(analysed("worn", ())), ours(tree)
    theirs = PRINTED["worn"]
    rows: list[tuple[object, ...]] = [
        ("greatest depth, pinion [µm]", f"{float(last['largest_depth'].sel(member='pinion')):.1f}", "10"),
        ("greatest depth, gear [µm]", f"{float(last['largest_depth'].sel(member='gear')):.1f}", "5"),
        ("revolutions of the pinion, k = 10⁻¹² mm²/N", f"{float(last['revolutions']):.1e}", "not said"),
    ]
    for part, load in enumerate(("unloaded", "200 N m")):
        for index, name in ((0, "peak to peak"), (2, "rms")):
            own = f"{before[part][index]:.1f} to {after[part][index]:.1f}"
            printed = f"{theirs['designed'][part][index]:.1f} to {theirs['deviating'][part][index]:.1f}"
            rows.append((f"{name}, {load} [µrad]", own, printed))
    lines = [float(t["unloaded"]["line_length"].sel(pair=0).mean()) for t in (analysed("worn", ()), tree)]
    roots = [pressures(t) for t in (analysed("worn", ()), tree)]
    rows.append(("contact lines [mm]", f"{lines[0]:.1f} to {lines[1]:.1f}", "longer"))
    for place, said in (("root", "reduced"), ("anywhere", "not said")):
        own = " to ".join(f"{t[place]:.0f}" for t in roots)
        rows.append((f"greatest pressure, {'gear root' if place == 'root' else place} [MPa]", own, said))
    return table(rows, HEADS[:3])


def wear_by_torque() -> str:
    """Peak to peak under load, designed and worn at one torque or a duty cycle until the pinion is 10 um deep."""
    law = WearLaw(1e-12, 1e-12, revolutions=1e12, largest_step=1.0, largest_depth=10.0)
    rows: list[tuple[object, ...]] = []
    for name, cycle in (
        ("designed", None),
        ("worn at 100 N m", 100.0),
        ("worn at 300 N m", 300.0),
        ("duty cycle", DUTY),
    ):
        left: Any = {}
        if cycle is not None:
            last = wear(by_its_method(CASES["worn"]), law, torque=cycle).isel(step=-1)
            left = {member: last[["deviation"]].sel(member=member) for member in MEMBERS}
        tree = easeoff.analyze(by_its_method(CASES["worn"]), torques=TORQUES, deviations=left)
        swings = [ours(tree)[0][0], *map(float, tree["loaded"].to_dataset()["peak_to_peak"])]
        rows.append((name, *(f"{swing:.1f}" for swing in swings)))
    return table(rows, ["peak to peak [µrad]", "unloaded", *(f"{t:g} N m" for t in TORQUES)])
