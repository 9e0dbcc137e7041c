"""Our results beside what the dissertation prints and says, as tables for ``make_dissertation_figures.py``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import xarray as xr
from dissertation_figures import error_of_a_pair, transfer
from dissertation_method import by_its_method
from tabulate import tabulate

import easeoff
from easeoff.contact.evaluation.pressure_map import pressure_map
from easeoff.contact.lines.contact_lines import boundary_distance
from easeoff.geometry import Misalignment
from easeoff.study.plot.contact_pattern_chart import ContactPattern, unloaded_pattern
from easeoff.study.plot.tooth_view import ToothView, tooth_view
from easeoff.study.summary.curves import torque_name

TOE, HEEL = 0.4, 0.6  # lengthwise fractions that are called so
MOVED = 0.03  # smallest movement, as a fraction, that is given a direction
EDGE_SHARE = 0.2  # of the greatest pressure; an edge with more is loaded
EDGE = 5e-3  # how far from the edge its pressure is taken, as a fraction


@dataclass(frozen=True)
class Printed:
    """A row of the dissertation's tables of transmission errors [urad]."""

    peak_to_peak: float
    harmonics: tuple[float, float, float]
    rms: float
    mean: float = math.nan


UNLOADED = Printed(21.1, (8.3, 3.7, 2.0), 9.3)  # Table 4.2(a), theoretical surfaces
# Table 3.1; mean levels read off figure 3.6.
LOADED = {
    50.0: Printed(12.8, (6.3, 0.6, 0.1), 6.3, 110.0),
    250.0: Printed(15.9, (7.9, 0.3, 0.4), 7.9, 290.0),
    500.0: Printed(21.9, (9.9, 2.3, 0.5), 10.1, 600.0),
}
MISALIGNED = {"(d)": 12.2, "(e)": 12.5}  # Table 3.1, 50 N m: peak to peak [urad]
# Magnitudes of E, P [mm] and shaft angle [minutes] as printed, with our signs.
BASE = (-0.15, 0.12, 0.0)
POSITIONS_2_11 = {
    "(a)": (0.0, 0.0, 0.0),
    "(b)": (-0.08, 0.10, 0.0),
    "(c)": (-0.15, 0.10, 0.0),
    "(d)": (-0.05, 0.0, 4.0),
}
OTHER_SIGNS = ((1, 1), (1, -1), (-1, -1))  # of E and P, or E and shaft angle
SAID_2_11 = {"(a)": "", "(b)": "toe", "(c)": "heel", "(d)": "toe"}
PANELS_3_7 = {
    "(a)": (50.0, BASE),
    "(b)": (250.0, BASE),
    "(c)": (500.0, BASE),
    "(d)": (50.0, (-0.08, 0.05, 0.0)),
    "(e)": (50.0, (-0.26, 0.13, 0.0)),
}


@cache
def analysed(position: tuple[float, float, float]) -> xr.DataTree:
    """The pair fm-11x41, by the method of the dissertation, in a position of E, P [mm] and shaft angle [minutes]."""
    offset, pinion_axial, minutes = position
    errors = Misalignment(offset, pinion_axial, shaft_angle=math.radians(minutes / 60.0))
    torques = list(LOADED) if position == BASE else [min(LOADED)]
    return easeoff.analyze(by_its_method("fm-11x41"), torques=torques, misalignment=errors)


def named(position: tuple[float, float, float]) -> str:
    """A position in words, in the units of the page."""
    units = (("E", "mm", "+.2f"), ("P", "mm", "+.2f"), ("Σ", "′", "+.0f"))
    parts = [f"{n} {v:{form}} {u}" for v, (n, u, form) in zip(position, units, strict=True) if v]
    return ", ".join(parts).replace("-", "−").replace(" ′", "′") or "no misalignment"


def table(rows: list[tuple[object, ...]], headers: list[str]) -> str:
    """A Markdown table; text as it is given."""
    return tabulate(rows, headers=headers, tablefmt="github", disable_numparse=True)


def statements(rows: list[tuple[str, str, bool]]) -> str:
    """Statements of the dissertation, what ours shows, and whether that agrees."""
    cells: list[tuple[object, ...]] = [(said, ours, "yes" if agrees else "no") for said, ours, agrees in rows]
    return table(cells, ["the dissertation says", "ours", "agrees"])


def compared(name: str, ours: float, theirs: float, digits: int = 1) -> tuple[object, ...]:
    """Row of a table: ours, the dissertation's, and the difference in percent or, for small ones, as it is."""
    difference = f"{100.0 * (ours / theirs - 1.0):+.0f} %" if theirs >= 3.0 else f"{ours - theirs:+.{digits}f}"
    return name, f"{ours:.{digits}f}", f"{theirs:.{digits}f}", difference


HEADS = ["", "ours", "dissertation", "difference"]


def place(lengthwise: float) -> str:
    """Toe, middle or heel."""
    return "toe" if lengthwise < TOE else "heel" if lengthwise > HEEL else "middle"


def seen(tree: xr.DataTree) -> tuple[ToothView, ContactPattern]:
    """The gear flank of a result and the unloaded pattern on it."""
    view = tooth_view(tree)
    return view, unloaded_pattern(tree["unloaded"].to_dataset(), view.fields)


def centre(pattern: ContactPattern) -> tuple[float, float]:
    """Centre of the area of a pattern, lengthwise and profile fraction."""
    area, moment = 0.0, np.zeros(2)
    for span in pattern.ranges:
        here, there = span.outline, np.roll(span.outline, -1, axis=1)
        cross = here[0] * there[1] - there[0] * here[1]
        sign = math.copysign(1.0, cross.sum())
        area += sign * cross.sum() / 2.0
        moment += sign * np.sum((here + there) * cross, axis=1) / 6.0
    return float(moment[0] / area), float(moment[1] / area)


def centre_of_load(at_torque: xr.Dataset) -> tuple[float, float]:
    """Centre of the forces over the mesh cycle, lengthwise and profile fraction."""
    force = at_torque["force"]
    t, h = (float((force * at_torque[name]).sum() / force.sum()) for name in ("lengthwise", "profile"))
    return t, h


def loaded_edges(at_torque: xr.Dataset, view: ToothView) -> list[str]:
    """Edges of the common flank beside which the pressure exceeds its share of the peak."""
    surface = pressure_map(at_torque)
    points = np.clip(surface.points, 0.0, 1.0)
    on_pinion = view.fields("pinion_lengthwise", points)
    toe, heel = np.minimum(points[0], on_pinion) < EDGE, np.maximum(points[0], on_pinion) > 1.0 - EDGE
    across = (boundary_distance(view.fields, points) < EDGE) | (points[1] < EDGE) | (points[1] > 1.0 - EDGE)
    across &= ~toe & ~heel
    carries = surface.pressure > EDGE_SHARE * surface.peak
    places = {"toe": toe, "heel": heel, "root": across & (points[1] < 0.5), "tip": across & (points[1] >= 0.5)}
    return [name for name, there in places.items() if np.any(carries & there)]


def figure_2_9() -> tuple[str, str]:
    """Amplitudes and statements of the unloaded error."""
    tree = analysed(BASE)
    own = tree["unloaded"].attrs
    rows = [compared("peak to peak [µrad]", own["peak_to_peak"], UNLOADED.peak_to_peak)]
    for k, theirs in enumerate(UNLOADED.harmonics):
        rows.append(compared(f"harmonic {k + 1} [µrad]", own["harmonics"][k], theirs))
    rows.append(compared("rms [µrad]", own["rms"], UNLOADED.rms))
    course = error_of_a_pair(tree)
    _, level = transfer(course)
    greatest = float(tree["unloaded"]["transmission_error_envelope"].max())
    said = [
        (
            "the error is greatest where the next pair takes over, at M<sub>1</sub> and M<sub>2</sub>",
            f"{level:.1f} µrad there, {greatest:.1f} µrad at most at the mesh positions between",
            greatest < level,
        )
    ]
    return table(rows, HEADS), statements(said)


def figure_2_11() -> tuple[str, str]:
    """Centres of the patterns, with our signs and with the others."""
    rows: list[tuple[object, ...]] = []
    found = {}
    for name, position in POSITIONS_2_11.items():
        t, h = found[name] = centre(seen(analysed(position))[1])
        e, p, minutes = (abs(value) for value in position)
        turned = [(a * e, b * p, b * minutes) for a, b in OTHER_SIGNS] if any(position) else []
        others = " / ".join(f"{centre(seen(analysed(other))[1])[0]:.2f}" for other in turned)
        rows.append((name, named(position), f"{t:.2f}, {h:.2f}", place(t), SAID_2_11[name] or "not said", others))
    headers = ["", "position", "centre, ours", "ours", "dissertation", "lengthwise, other signs"]
    b, c, d = (found[name][0] for name in ("(b)", "(c)", "(d)"))
    said = [
        ("(c) is farther to the heel than (b)", f"{c:.2f} against {b:.2f}", c > b + MOVED),
        ("(b) and (d) are similar", f"{b:.2f} and {d:.2f} lengthwise", place(b) == place(d)),
    ]
    return table(rows, headers), statements(said)


def figure_3_6() -> tuple[str, str]:
    """Levels and amplitudes under load."""
    loaded = analysed(BASE)["loaded"].to_dataset()
    rows: list[tuple[object, ...]] = []
    amplitudes = []
    for torque, theirs in LOADED.items():
        own = loaded.sel(torque=torque)
        harmonic, name = own["harmonic"].values, torque_name(torque)
        amplitudes.append(harmonic)
        rows.append(compared(f"mean, {name} [µrad]", float(own["mean_level"]), theirs.mean, 0))
        rows.append(compared(f"peak to peak, {name} [µrad]", float(own["peak_to_peak"]), theirs.peak_to_peak))
        rows.append(compared(f"harmonic 1, {name} [µrad]", harmonic[0], theirs.harmonics[0]))
        rows.append(compared(f"rms, {name} [µrad]", float(own["rms"]), theirs.rms))

    grows = [loaded["peak_to_peak"].values, np.array(amplitudes)[:, 0], loaded["rms"].values]
    shares = [100.0 * h[0] / math.sqrt(float(np.sum(h[:3] ** 2))) for h in amplitudes]
    grown = float(loaded["mean_level"].sel(torque=500.0) / loaded["mean_level"].sel(torque=250.0))
    said = [
        (
            "the first harmonic dominates at every torque",
            "; ".join(f"{s:.0f} %" for s in shares) + " of the rms of the first three",
            all(h[0] > 2.0 * max(h[1:3]) for h in amplitudes),
        ),
        (
            "peak to peak, first harmonic and rms grow with the torque",
            "as above",
            all(bool(np.all(np.diff(values) > 0.0)) for values in grows),
        ),
        (
            "from 250 to 500 N m the mean grows in proportion or more (figure)",
            f"by {grown:.2f}, the dissertation's by {LOADED[500.0].mean / LOADED[250.0].mean:.2f}",
            grown >= 2.0,
        ),
    ]
    return table(rows, HEADS), statements(said)


def moved(start: tuple[float, float], end: tuple[float, float]) -> str:
    """Direction of a movement on the flank."""
    names = [
        names[0] if e < s else names[1]
        for s, e, names in zip(start, end, (("toe", "heel"), ("root", "tip")), strict=True)
        if abs(e - s) > MOVED
    ]
    return "towards " + " and ".join(names) if names else "not moved"


def figure_3_7() -> tuple[str, str]:
    """Centres of load, loaded edges and greatest pressures."""
    rows: list[tuple[object, ...]] = []
    centres, edges, peaks, swings = {}, {}, {}, {}
    for name, (torque, position) in PANELS_3_7.items():
        tree = analysed(position)
        own = tree["loaded"].to_dataset().sel(torque=torque)
        centres[name], edges[name] = centre_of_load(own), loaded_edges(own, tooth_view(tree))
        peaks[name], swings[name] = float(own["max_pressure"]), float(own["peak_to_peak"])
        theirs = MISALIGNED.get(name, LOADED[torque].peak_to_peak)
        rows.append(
            (
                name,
                torque_name(torque),
                named(position),
                "{:.2f}, {:.2f}".format(*centres[name]),
                ", ".join(edges[name]) or "none",
                f"{peaks[name]:.0f}",
                *compared("", swings[name], theirs)[1:],
            )
        )
    headers = ["", "torque", "position", "centre", "edges loaded", "peak [MPa]", "peak to peak, ours [µrad]"]
    a, d, e = (centres[name] for name in ("(a)", "(d)", "(e)"))

    def shown(name: str) -> str:
        return ", ".join(edges[name]) or "no edge"

    said = [
        ("(a) is in the middle", f"{place(a[0])}, {a[0]:.2f}", place(a[0]) == "middle"),
        ("(a) loads no edge", shown("(a)"), not edges["(a)"]),
        *(
            (f"{name} loads the edges at tip and root", shown(name), {"tip", "root"} <= set(edges[name]))
            for name in ("(b)", "(c)")
        ),
        ("(d) moves towards toe and root from (a)", moved(a, d), moved(a, d) == "towards toe and root"),
        ("(e) moves the other way, towards the heel", moved(a, e), "heel" in moved(a, e)),
        (
            "(e) has less pressure",
            f"{peaks['(e)']:.0f} MPa; (a) {peaks['(a)']:.0f}, (d) {peaks['(d)']:.0f}",
            peaks["(e)"] < min(peaks["(a)"], peaks["(d)"]),
        ),
        (
            "(d) and (e) have slightly less transmission error than (a)",
            f"{swings['(d)']:.1f} and {swings['(e)']:.1f} against {swings['(a)']:.1f} µrad",
            all(0.8 * swings["(a)"] < swings[name] < swings["(a)"] for name in MISALIGNED),
        ),
    ]
    return table(rows, [*headers, "dissertation", "difference"]), statements(said)
