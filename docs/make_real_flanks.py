"""Write docs/real_flanks.md, its pictures and the shipped measured grids: python docs/make_real_flanks.py."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from dissertation_figures import ease_offs, patterns, save_small
from dissertation_tables import HEADS, compared, statements, table
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from real_flanks_examples import write_examples

import easeoff
from easeoff.cases import gear_pair
from easeoff.core.errors import GeometryError
from easeoff.core.files import whole_file
from easeoff.geometry import GearPair, pair_geometry
from easeoff.geometry.deviated_ease_off import Form, deviated_ease_off
from easeoff.geometry.deviation import Deviation
from easeoff.study.deviations import flank_deviations
from easeoff.study.plot.ease_off import draw_map
from easeoff.study.plot.page import BLUE, INK, SMALL_SIZE, VERMILION, WIDTH, plain_axes, plain_bar, sheet
from easeoff.study.plot.pressure import draw_surface, pressure_levels
from easeoff.study.plot.pressure_map import pressure_map
from easeoff.study.plot.tooth_view import draw_flank, tooth_view
from easeoff.study.plot.transmission_error import two_cycles
from easeoff.study.wear import WearLaw, wear

HERE = Path(__file__).parent
IMAGES = HERE / "images" / "real_flanks"
TORQUE = 200.0
EDGE = 0.2  # of the flank
Row = tuple[float, tuple[float, float, float], float]  # peak to peak, harmonics, rms [urad]
# Tables 4.2 and 4.4: (unloaded, loaded at 200 N m), theoretical and deviated.
PRINTED: dict[str, dict[str, tuple[Row, Row]]] = {
    "worn": {
        "designed": ((21.1, (8.3, 3.7, 2.0), 9.3), (14.2, (7.3, 0.3, 0.5), 7.4)),
        "deviating": ((15.0, (4.3, 4.3, 1.4), 6.3), (10.2, (4.5, 1.4, 0.4), 4.7)),
    },
    "measured": {
        "designed": ((36.9, (15.1, 4.0, 1.8), 15.7), (23.9, (12.1, 0.5, 0.7), 12.1)),
        "deviating": ((61.5, (28.9, 2.1, 1.5), 29.0), (29.8, (15.8, 2.8, 2.3), 16.2)),
    },
}
CASES = {"worn": "fm-11x41", "measured": "fh-12x41-45"}
MEMBERS = ("pinion", "gear")


def files(example: str, members: tuple[str, ...] = MEMBERS) -> dict[str, str]:
    """Shipped grids of an example."""
    return {member: f"{CASES[example]}-{example}-{member}" for member in members}


@cache
def analysed(example: str, members: tuple[str, ...] = MEMBERS, deviated: str = "ease_off") -> xr.DataTree:
    """The pair of an example with the deviations of these members."""
    options: Any = {"deviations": files(example, members), "deviated": deviated}
    return easeoff.analyze(CASES[example], torques=[TORQUE], **options)


def ours(tree: xr.DataTree) -> tuple[Row, Row]:
    """What the dissertation's tables print."""
    unloaded, loaded = tree["unloaded"].attrs, tree["loaded"].to_dataset().isel(torque=0)
    first, second = unloaded["harmonics"], loaded["harmonic"].values
    return (
        (unloaded["peak_to_peak"], (first[0], first[1], first[2]), unloaded["rms"]),
        (float(loaded["peak_to_peak"]), (second[0], second[1], second[2]), float(loaded["rms"])),
    )


def amplitudes(example: str) -> str:
    """Table 4.2 or 4.4, ours and printed."""
    rows: list[tuple[object, ...]] = []
    for which, members in (("designed", ()), ("deviating", MEMBERS)):
        for load, own, theirs in zip(
            ("unloaded", "200 N m"), ours(analysed(example, members)), PRINTED[example][which], strict=True
        ):
            rows.append(compared(f"{which}, {load}: peak to peak [µrad]", own[0], theirs[0]))
            rows += [compared(f"{which}, {load}: harmonic {n + 1}", own[1][n], theirs[1][n]) for n in range(3)]
            rows.append(compared(f"{which}, {load}: rms", own[2], theirs[2]))
    return table(rows, HEADS)


def pressures(tree: xr.DataTree) -> dict[str, float]:
    """Greatest pressure within a fifth of either edge of the gear, and anywhere [MPa]."""
    loaded = tree["loaded"].to_dataset()
    t, h = loaded["lengthwise"], loaded["profile"]
    places = {"root": h < EDGE, "tip": h > 1.0 - EDGE, "toe": t < EDGE, "heel": t > 1.0 - EDGE, "anywhere": h >= 0.0}
    return {name: float(loaded["pressure"].where(here).max()) for name, here in places.items()}


def ratios(example: str, part: int) -> tuple[float, float]:
    """Peak to peak with deviations over that without: ours and the dissertation's."""
    own = ours(analysed(example))[part][0] / ours(analysed(example, ()))[part][0]
    return own, PRINTED[example]["deviating"][part][0] / PRINTED[example]["designed"][part][0]


def said_worn() -> str:
    """What the dissertation says of figures 4.6 to 4.9."""
    tree, plain = analysed("worn"), analysed("worn", ())
    unloaded, loaded = ratios("worn", 0), ratios("worn", 1)
    lengths = [float(t["unloaded"]["line_length"].sel(pair=0).mean()) for t in (plain, tree)]
    before, after = pressures(plain), pressures(tree)
    others = ("tip", "toe", "heel", "anywhere")
    both = [t["loaded"].to_dataset()["transmission_error"].values[0] for t in (tree, plain)]
    difference = both[0] - both[1]
    return statements(
        [
            ("the unloaded peak to peak is reduced", f"by {100 - 100 * unloaded[0]:.0f} %", unloaded[0] < 1.0),
            ("the loaded one is reduced, too", f"by {100 - 100 * loaded[0]:.0f} %", loaded[0] < 1.0),
            ("contact lines grow longer", f"{lengths[0]:.1f} to {lengths[1]:.1f} mm", lengths[1] > lengths[0]),
            (
                "edge loading at the gear's root is reduced significantly",
                f"{before['root']:.0f} to {after['root']:.0f} MPa",
                after["root"] < 0.8 * before["root"],
            ),
            (
                "(not said: no other edge pays for it by more than 6 %)",
                "; ".join(f"{name} {before[name]:.0f} to {after[name]:.0f} MPa" for name in others),
                all(after[name] < 1.06 * before[name] for name in others),
            ),
            (
                "loaded curves agree where the dents are not in contact",
                f"they differ by {np.abs(difference).min():.1f} to {np.abs(difference).max():.1f} µrad",
                bool(np.abs(difference).min() < 0.5),
            ),
        ]
    )


def said_measured() -> str:
    """What the dissertation says of figures 4.11 to 4.14."""

    def changed(members: tuple[str, ...]) -> float:
        ease_off = analysed("measured", members)["ease_off"]
        return float(ease_off["ease_off_change"].where(ease_off["inside"] == 1).std())

    alone, both = [changed((m,)) for m in MEMBERS], changed(MEMBERS)
    peaks = [pressures(analysed("measured", m))["anywhere"] for m in ((), MEMBERS)]
    unloaded, loaded = ratios("measured", 0), ratios("measured", 1)
    centre = [float(analysed("measured", m)["unloaded"]["path_lengthwise"].sel(pair=0).mean()) for m in ((), MEMBERS)]
    return statements(
        [
            (
                "either deviation alone changes the ease-off considerably, both together compensate",
                f"rms change by the pinion {alone[0]:.1f} µm, by the gear {alone[1]:.1f}; by both {both:.1f} µm",
                both < 0.7 * min(alone),
            ),
            (
                "the unloaded peak to peak grows, by two thirds",
                f"by {100 * unloaded[0] - 100:.0f} %",
                unloaded[0] > 1.2,
            ),
            (
                "the loaded one grows less, by a quarter",
                f"by {100 * loaded[0] - 100:.0f} %",
                1.0 < loaded[0] < unloaded[0],
            ),
            (
                "the contact moves slightly to the heel",
                f"{centre[0]:.3f} to {centre[1]:.3f} of the face",
                centre[1] > centre[0] + 0.005,
            ),
            (
                "contact pressures are rather close",
                f"greatest {peaks[0]:.0f} to {peaks[1]:.0f} MPa",
                abs(peaks[1] / peaks[0] - 1.0) < 0.1,
            ),
        ]
    )


def deviation_maps(example: str) -> Figure:
    """Figures 4.5 and 4.10: the deviations, metal missing, on their own flanks."""
    pair = gear_pair(easeoff.read_case(CASES[example]), "drive")
    deviations = flank_deviations(pair, files(example))  # type: ignore[arg-type]
    figure = sheet(2.3)
    t, h = np.linspace(0, 1, 81), np.linspace(0, 1, 61)
    for axes, (name, deviation) in zip(figure.subplots(1, 2), deviations.items(), strict=True):
        dataset = deviation.on_grid(t, h)
        missing = -dataset["deviation"].values.T
        drawn = axes.contourf(t, h, missing, 12, cmap="viridis")
        axes.contour(t, h, dataset["extrapolated"].values.T, [0.5], colors="white", linestyles="--", linewidths=0.9)
        place = deviation.section.fractions(deviation.axial, deviation.radial)
        axes.plot(place[0].ravel(), place[1].ravel(), ".", color="white", markersize=1.5)
        axes.set_title(f"{name}: metal missing [µm]", fontsize=SMALL_SIZE + 1, color=INK, loc="left")
        axes.set_xlabel("toe to heel", fontsize=SMALL_SIZE, color=INK)
        axes.set_ylabel("root to tip", fontsize=SMALL_SIZE, color=INK)
        plain_bar(figure.colorbar(drawn, ax=axes), "")
    return figure


def change_map(example: str) -> Figure:
    """Figure 4.6d: what the deviations add to the ease-off."""
    tree = analysed(example)
    view = tooth_view(tree)
    gap = tree["ease_off"]["ease_off_change"].values
    figure = sheet((WIDTH - 1.4) * view.aspect + 0.4)
    axes = figure.subplots()
    draw_flank(axes, view)
    values = easeoff_map(tree, gap)
    levels = np.linspace(0.0, np.ceil(np.nanmax(values[1][values[2]])), 9)
    shading = draw_map(axes, view, values, levels)
    if shading is not None:
        plain_bar(figure.colorbar(shading, ax=axes, shrink=0.8), "gap added [µm]")
    return figure


def easeoff_map(tree: xr.DataTree, gap: Any) -> Any:
    """As ``ease_off_map``, for another variable of the ease-off's grid."""
    from easeoff.study.plot.ease_off import ease_off_map

    swapped = tree.copy()
    dataset = swapped["ease_off"].to_dataset().assign(ease_off=(("lengthwise", "profile"), gap))
    lever = dataset["lever_arm"].values
    swapped["ease_off"] = xr.DataTree(dataset.assign(ease_off_angle=(("lengthwise", "profile"), 1e-3 * gap / lever)))
    return ease_off_map(tooth_view(swapped))


def errors(example: str) -> Figure:
    """Figures 4.8 and 4.13: transmission errors of designed and deviating flanks."""
    figure = sheet(2.6)
    for axes, group in zip(figure.subplots(1, 2), ("unloaded", "loaded"), strict=True):
        for members, name, colour in (((), "designed", BLUE), (MEMBERS, "deviating", VERMILION)):
            tree = analysed(example, members)
            variable = "transmission_error_envelope" if group == "unloaded" else "transmission_error"
            values = np.atleast_2d(tree[group].to_dataset()[variable].values)[0]
            axes.plot(*two_cycles(values - (values.min() if group == "unloaded" else 0.0)), color=colour, label=name)
        plain_axes(axes)
        axes.set_xlim(0.0, 2.0)
        axes.xaxis.set_major_locator(MultipleLocator(0.5))
        axes.set_title(
            "unloaded [µrad]" if group == "unloaded" else "200 N m [µrad]", fontsize=SMALL_SIZE + 1, loc="left"
        )
        axes.set_xlabel("mesh cycles", fontsize=SMALL_SIZE, color=INK)
    axes.legend(fontsize=SMALL_SIZE, frameon=False)
    return figure


def pressure_maps(example: str) -> Figure:
    """Figures 4.9 and 4.14: greatest pressure over the cycle."""
    trees = [analysed(example, members) for members in ((), MEMBERS)]
    views = [tooth_view(tree) for tree in trees]
    maps = [pressure_map(tree["loaded"].to_dataset().sel(torque=TORQUE)) for tree in trees]
    levels = pressure_levels(max(surface.peak for surface in maps))
    figure = sheet((WIDTH - 1.6) / 2.0 * views[0].aspect + 0.6)
    grid = figure.subplots(1, 2)
    shading = None
    for axes, view, surface, name in zip(grid, views, maps, ("designed", "deviating"), strict=True):
        draw_flank(axes, view, labels=(True, axes is grid[0]))
        axes.tick_params(axis="y", pad=16, length=0)  # beyond the word at the toe
        shading = draw_surface(axes, view, surface, levels) or shading
        axes.set_title(f"{name}, peak {surface.peak:.0f} MPa", fontsize=SMALL_SIZE + 1, color=INK, loc="left")
    if shading is not None:
        plain_bar(figure.colorbar(shading, ax=list(grid), shrink=0.8), "pressure [MPa]")
    return figure


def draw() -> None:
    """Write the pictures."""
    for example, numbers in (("worn", "4_5 4_6 4_7 4_8 4_9"), ("measured", "4_10 4_11 4_12 4_13 4_14")):
        names = [IMAGES / f"figure_{number}.png" for number in numbers.split()]
        both = [("designed", "", analysed(example, ())), ("deviating", "", analysed(example))]
        alone = [(f"{m} alone", "", analysed(example, (m,))) for m in MEMBERS]
        save_small(deviation_maps(example), names[0])
        save_small(ease_offs(both if example == "worn" else [both[0], *alone, both[1]]), names[1])
        save_small(patterns(both), names[2])
        save_small(errors(example), names[3])
        save_small(pressure_maps(example), names[4])
    save_small(change_map("worn"), IMAGES / "figure_4_6d.png")


def scaled(deviations: dict[str, Deviation], factor: float) -> dict[str, Deviation]:
    """Deviations times a factor."""
    return {name: Deviation(d.section, d.axial, d.radial, factor * d.value, d.method) for name, d in deviations.items()}


def judged(pair: GearPair, deviations: dict[str, Deviation], form: Form) -> tuple[float, float, float, float]:
    """Largest change of the ease-off, error of its update [um], of the roll angle, and without one [mrad]."""
    from easeoff.study.deviations import deviated_geometry

    designed = pair_geometry(pair).ease_off
    update = deviated_ease_off(pair, designed, form=form, pinion=deviations["pinion"], gear=deviations["gear"])
    exact = deviated_geometry(pair, (31, 21), deviations, "surface").ease_off
    inside = (update["inside"].values & exact["inside"].values).astype(bool)
    angle = [e["ease_off_angle"].values + e.attrs["first_contact_rad"] for e in (update, exact)]
    error = 1e3 * np.abs(angle[0] - angle[1]) * update["lever_arm"].values
    roll = 1e3 * np.abs((update["roll_angle"] - exact["roll_angle"]).values)
    change = np.abs(update["ease_off_change"].values)
    still = 1e3 * np.abs((designed["roll_angle"] - exact["roll_angle"]).values)
    return tuple(float(np.max(v[inside])) for v in (change, error, roll, still))  # type: ignore[return-value]


def swing(name: str, deviations: dict[str, Deviation], way: str) -> float:
    """Unloaded peak to peak [urad]; NaN if the flanks have no line contact somewhere."""
    options: Any = {"deviations": deviations, "deviated": way}
    try:
        return ours(easeoff.analyze(name, torques=[TORQUE], **options))[0][0]
    except GeometryError:
        return float("nan")


def shortcut() -> str:
    """Where the update of the ease-off is good enough."""
    rows: list[tuple[object, ...]] = []
    for example, name in CASES.items():
        pair = gear_pair(easeoff.read_case(name), "drive")
        whole = flank_deviations(pair, files(example))  # type: ignore[arg-type]
        for factor in (2.0, 1.0, 0.5, 0.25):
            deviations = scaled(whole, factor)
            change, error, roll, still = judged(pair, deviations, "correct")
            _, printed, printed_roll, _ = judged(pair, deviations, "printed")
            update, surface = (swing(name, deviations, way) for way in ("ease_off", "surface"))
            shown = (f"{surface:.1f}", f"{update - surface:+.2f}") if np.isfinite(surface) else ("refused", "")
            rows.append(
                (
                    f"{example}, × {factor:g}", f"{change:.1f}", f"{error:.3f}", f"{printed:.1f}", f"{roll:.2f}",
                    f"{printed_roll:.2f}",
                    f"{still:.2f}", *shown,
                )
            )  # fmt: skip
    return table(
        rows,
        ["deviations", "change [µm]", "error [µm]", "as printed", "error of roll angle [mrad]", "as printed",
         "not updated", "unloaded peak to peak [µrad]", "error"],
    )  # fmt: skip


def own_wear() -> str:
    """The pair worn by our own law at 200 N m until the pinion is as deep as the dissertation's."""
    law = WearLaw(1e-12, 1e-12, revolutions=1e12, largest_step=0.5, largest_depth=10.0)
    history = wear(CASES["worn"], law, torque=TORQUE)
    last = history.isel(step=-1)
    left: Any = {member: last[["deviation"]].sel(member=member) for member in MEMBERS}
    tree = easeoff.analyze(CASES["worn"], torques=[TORQUE], deviations=left)
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


DUTY = {100.0: 0.4, 200.0: 0.3, 300.0: 0.2, 400.0: 0.1}
TORQUES = (25.0, 50.0, 100.0, 200.0, 300.0, 400.0)


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
            last = wear(CASES["worn"], law, torque=cycle).isel(step=-1)
            left = {member: last[["deviation"]].sel(member=member) for member in MEMBERS}
        tree = easeoff.analyze(CASES["worn"], torques=TORQUES, deviations=left)
        swings = [ours(tree)[0][0], *map(float, tree["loaded"].to_dataset()["peak_to_peak"])]
        rows.append((name, *(f"{swing:.1f}" for swing in swings)))
    return table(rows, ["peak to peak [µrad]", "unloaded", *(f"{t:g} N m" for t in TORQUES)])


def main() -> None:
    """Write everything."""
    write_examples()
    draw()
    page = (HERE / "real_flanks.template.md").read_text(encoding="utf-8")
    parts = {
        "table_4_2": amplitudes("worn"),
        "table_4_4": amplitudes("measured"),
        "said_worn": said_worn(),
        "said_measured": said_measured(),
        "shortcut": shortcut(),
        "own_wear": own_wear(),
        "wear_by_torque": wear_by_torque(),
    }
    for name, text in parts.items():
        page = page.replace(f"{{{name}}}", text)
    with whole_file(HERE / "real_flanks.md") as temporary:
        temporary.write_text(page, encoding="utf-8")
    print("wrote docs/real_flanks.md")


if __name__ == "__main__":
    main()
