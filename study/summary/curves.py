"""Curves of a result, which pictures and the report draw: over the mesh cycle, torque, speed, face and revolutions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.evaluation.tooth_passage import ToothPassage, tooth_passage, unloaded_curves
from ...core.arrays import Array
from ...core.attributes import ordered
from ..result import CONDITIONS
from .assembly import SHARES, bearing_loads
from .quantities import CONDITION_LABELS, LIMITED, MEAN_ROUGHNESS, TABLES, WEAR_DEPTH, Quantity, value_name

OVER, SEGMENTS = ("torque", "mesh_position"), ("torque", "mesh_position", "segment")
CYCLE = "mesh position"
ORDER_COUNT = 4  # of the orders drawn over torque


@dataclass(frozen=True)
class ChartKind:
    """Content of a chart: title, label of its ordinate, variable, label of its abscissa.

    ``by`` "torque": a series a torque, all but the chosen one pale; "only": those of the chosen one alone. ``down``:
    greater values are drawn lower.
    """

    title: str
    y: str
    source: str
    x: str = CYCLE
    by: str = "torque"
    down: bool = False


def capital(quantity: Quantity) -> str:
    """Label of a quantity as a title."""
    return quantity.label[0].upper() + quantity.label[1:]


def _of(number: str, source: str, x: str = CYCLE, by: str = "torque") -> ChartKind:
    """Content of the chart of a number."""
    quantity = WEAR_DEPTH if number == "wear_depth" else LIMITED[number]
    return ChartKind(capital(quantity), f"[{quantity.unit}]" if quantity.unit else "", source, x, by)


def _kind(title: str, y: str, source: str, x: str = CYCLE, by: str = "torque", down: bool = False) -> ChartKind:
    """Content of a chart, whose abscissa may be an operating condition."""
    return ChartKind(title, y, source, CONDITION_LABELS.get(x, x), by, down)


CHARTS = {
    **{name: _kind(*row) for name, row in TABLES["charts"].items()},
    **{name: _of(*row) for name, row in TABLES["number_charts"].items()},
    **{
        f"efficiency_{name}": _kind(
            f"Efficiency over {label.partition(' [')[0]}", "[%]", "friction/efficiency", name, ""
        )
        for name, label in CONDITION_LABELS.items()
    },
}


class Curve(NamedTuple):
    """A curve: its name in the legend, and its points."""

    name: str
    x: Array
    y: Array


@dataclass(frozen=True)
class Chart:
    """Curves of one of ``CHARTS``."""

    name: str
    curves: Sequence[Curve]
    member: str = ""
    per: int | None = None  # curves of one torque
    second: Mapping[str, Any] | None = None  # scale on the right: factor over that on the left, and label
    abscissa: str = ""  # its label, if not the usual one

    @property
    def kind(self) -> ChartKind:
        """Content of the chart."""
        return CHARTS[self.name]


def _course(name: str, names: Sequence[str], table: Array, member: str = "") -> Chart:
    """Chart over the mesh cycle with a curve a torque (torque, mesh_position)."""
    return Chart(name, [Curve(n, *_cycle(v)) for n, v in zip(names, table, strict=True)], member)


def torque_name(torque: float) -> str:
    """Torque [N m] as pictures show it, such as ``109 N m``."""
    return f"{torque:.4g} N m" if torque < 1e4 else f"{torque:.0f} N m"


def _torque_names(torques: Array) -> list[str]:
    return [torque_name(float(torque)) for torque in torques]


def _cycle(values: Array) -> tuple[Array, Array]:
    """Mesh positions from 0 to 1 and values (k) with the first one again at the end."""
    return np.arange(values.size + 1) / values.size, np.append(values, values[:1])


def _passage(share: Array, pairs: Array, number: int) -> tuple[Array, Array]:
    """Mesh positions from 0 to 1 and the share of a tooth pair, which ends where the pair before it begins; or NaN."""
    before = np.flatnonzero(pairs == pairs[number] - 1)
    end = share[0, before[0]] if before.size else 0.0
    values = np.append(share[:, number], end)
    carries = np.nan_to_num(values) > 0.0
    return np.arange(values.size) / share.shape[0], np.where(np.any(carries), values, np.nan)


def _greatest(table: Array) -> Array:
    """Greatest finite value (torque, mesh_position) over the segments; NaN where there is none."""
    most = np.where(np.isfinite(table), table, -np.inf).max(axis=2, initial=-np.inf)
    return np.where(np.isfinite(most), most, np.nan)


def _weighted_mean(table: Array, weight: Array) -> Array:
    """Mean (torque, mesh_position) over the segments by their weight; NaN where nothing has weight.

    By force it does not jump, unlike extremes, as segments begin and cease to carry.
    """
    known = np.isfinite(table) & (weight > 0.0)
    whole = np.where(known, weight, 0.0).sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(known, table * weight, 0.0).sum(axis=2) / np.where(whole > 0.0, whole, np.nan))


def _least(table: Array) -> Array:
    return -_greatest(-table)


def transmission_error_charts(
    unloaded: xr.Dataset, loaded: xr.Dataset, chosen: NDArray[Any], radius: float | None = None
) -> list[Chart]:
    """Charts of the transmission error: without and under load, about its mean, its orders by number and torque.

    The mean pitch radius of the gear [mm] gives a second scale of lengths [um] along its pitch circle.
    """
    orders, torques = loaded["order"].values.astype(float), loaded["torque"].values
    names = _torque_names(torques[chosen])
    error = ordered(loaded, "transmission_error", *OVER)[chosen]
    course, times, lowest = unloaded_curves(unloaded)
    about = [value - np.mean(value[np.isfinite(value)]) if np.any(np.isfinite(value)) else value for value in error]
    harmonic = ordered(loaded, "harmonic", "torque", "order")
    charts = [_course("te_loaded", names, error), _course("te_mean", names, np.array(about))]
    charts.append(Chart("te_orders", [Curve(n, orders, harmonic[i]) for n, i in zip(names, chosen, strict=True)]))
    if torques.size > 1:
        rank = np.argsort(torques)
        curves = [Curve("peak to peak", torques[rank], loaded["peak_to_peak"].values[rank])]
        curves += [Curve(f"order {o:g}", torques[rank], harmonic[rank, i]) for i, o in enumerate(orders[:ORDER_COUNT])]
        charts.append(Chart("te_torque", curves))
    if radius is not None:
        second = {"factor": 1e-3 * radius, "label": "[µm] at the mean pitch radius"}
        charts = [replace(one, second=second) for one in charts]
    carrying = [Curve("pair that carries", times, lowest)] if course.values.size else []
    return [Chart("te_unloaded", carrying), *charts]


def contact_charts(tree: xr.DataTree, chosen: NDArray[Any]) -> list[Chart]:
    """Load shares, greatest pressure, mesh stiffness and share on edges over the mesh cycle."""
    loaded = tree["loaded"].to_dataset()
    names = _torque_names(loaded["torque"].values[chosen])
    share = 100.0 * ordered(loaded, "load_share", *OVER, "pair")[chosen]
    pairs = loaded["pair"].values
    shares = [
        Curve(f"{name}, pair {pair:g}", *_passage(share[i], pairs, int(p)))
        for i, name in enumerate(names)
        for p, pair in enumerate(pairs)
    ]
    pressure = _greatest(ordered(loaded, "pressure", *SEGMENTS))
    charts = [
        Chart("load_share", shares, per=len(pairs)),
        _course("max_pressure", names, np.where(pressure > 0.0, pressure, np.nan)[chosen]),
    ]
    for variable, factor in (("mesh_stiffness", 1.0), ("edge_share", 100.0)):
        if variable in loaded:
            values = factor * ordered(loaded, variable, *OVER)[chosen]
            if variable != "edge_share" or np.any(np.nan_to_num(values) > 0.0):
                charts.append(_course(variable, names, values))
    return charts


def supports_charts(tree: xr.DataTree, chosen: NDArray[Any]) -> list[Chart]:
    """Parts of the gear's rotation over torque, and bearing loads over the mesh cycle."""
    group = tree["supports"].to_dataset()
    torques = group["torque"].values
    rank = np.argsort(torques)
    parts = [Curve(n, torques[rank], ordered(group, v, *OVER).mean(axis=1)[rank]) for n, v in SHARES.items()]
    charts = [Chart("rotation_parts", parts)] if torques.size > 1 else []
    names, radial, axial = bearing_loads(tree)
    place = np.argsort(rank)[chosen]  # these rise with the torque
    for name, force in (("bearing_radial", radial), ("bearing_axial", axial)):
        curves = [
            Curve(f"{torque_name(float(torques[i]))}, {bearing}", *_cycle(force[number, k]))
            for i, k in zip(chosen, place, strict=True)
            for number, bearing in enumerate(names)
        ]
        charts += [Chart(name, curves, per=len(names))] if curves else []
    return charts


def share_passage(at_torque: xr.Dataset) -> ToothPassage:
    """Share of the torque of one tooth pair over its passage, NaN outside contact but for a zero at both ends."""
    course = tooth_passage(at_torque["pair"].values, at_torque["load_share"].transpose("pair", "mesh_position").values)
    share = course.values
    loaded = share > 0.0
    beside = loaded.copy()
    beside[1:] |= loaded[:-1]
    beside[:-1] |= loaded[1:]
    return ToothPassage(course.first, course.per_cycle, np.where(beside, share, np.nan))


def mean_pairs_in_contact(at_torque: xr.Dataset) -> float:
    """Tooth pairs under load at the same time, on average over the mesh cycle; NaN if a position has no solution."""
    share = at_torque["load_share"].transpose("pair", "mesh_position").values
    if np.any(np.all(np.isnan(share), axis=0)):
        return float("nan")
    return float(np.mean(np.sum(share > 0.0, axis=0)))


def root_stress_charts(stress: xr.Dataset, chosen: NDArray[Any]) -> list[Chart]:
    """Root stress of both members along the face, and over the mesh cycle."""
    torques = _torque_names(stress["torque"].values[chosen])
    charts = []
    for number, member in enumerate(stress["member"].values):
        along = ordered(stress, "root_stress", "torque", "member", "lengthwise")[chosen, number]
        face = 100.0 * stress["lengthwise"].values
        charts.append(Chart("root", [Curve(n, face, values) for n, values in zip(torques, along, strict=True)], member))
        history = ordered(stress, "root_stress_history", "torque", "member", "mesh_position", "pair")[chosen, number]
        charts.append(_course("root_cycle", torques, _greatest(history), member))
    return charts


def friction_charts(tree: xr.DataTree, chosen: NDArray[Any], at: dict[str, int]) -> list[Chart]:
    """Charts of efficiency, and of coefficient, film, sliding and p v over the mesh cycle.

    ``chosen`` are numbers of torques; ``at`` holds those of speed, temperature and roughness.
    """
    loaded, friction = tree["loaded"].to_dataset(), tree["friction"].to_dataset()
    subset = friction.isel(at)
    names = _torque_names(loaded["torque"].values[chosen])
    pressure = ordered(loaded, "pressure", *SEGMENTS)
    carries = np.nan_to_num(pressure) > 0.0
    charts = []
    force = np.where(carries, np.nan_to_num(ordered(loaded, "force", *SEGMENTS)), 0.0)

    def mean(table: Array) -> Array:
        return _weighted_mean(table, force)

    extremes = {"friction_coefficient": mean, "film_thickness": _least, "flash_temperature": _greatest}
    for variable, reduce in extremes.items():
        if variable in subset:
            table = np.where(carries, subset[variable].transpose(*SEGMENTS).values, np.nan)
            charts.append(_course(variable, names, reduce(table)[chosen]))
    if "sliding_velocity" in subset:
        sliding = subset["sliding_velocity"].transpose(..., "mesh_position", "segment").values  # maybe of each torque
        table = np.where(carries, sliding, np.nan)
        charts.append(_course("sliding", names, mean(table)[chosen]))
        charts.append(_course("pv", names, _greatest(table * pressure)[chosen]))
    if "mesh_power_loss" in subset:
        charts.append(_course("power_loss", names, subset["mesh_power_loss"].transpose(*OVER).values[chosen]))
    for along in CONDITIONS:
        by = "speed" if along == "torque" else "torque"
        if friction.sizes[along] > 1:
            rows = range(friction.sizes[by]) if by == "speed" else chosen
            charts.append(efficiency_chart(friction, along, by, at, rows))
    return charts


def efficiency_chart(friction: xr.Dataset, along: str, by: str, at: Mapping[str, int], rows: Iterable[int]) -> Chart:
    """Efficiency along an operating condition, a curve for some values of another, the rest as given by number."""
    fixed = {name: number for name, number in at.items() if name not in (along, by)}
    values = 100.0 * friction["efficiency"].isel(fixed).transpose(by, along).sortby(along)
    curves = [Curve(value_name(friction, by, int(i)), values[along].values, values.values[i]) for i in rows]
    unlike = along == "roughness" and any(friction["roughness_pinion"].values != friction["roughness_gear"].values)
    return Chart(f"efficiency_{along}", curves, abscissa=MEAN_ROUGHNESS if unlike else "")


def wear_charts(history: xr.Dataset) -> list[Chart]:
    """Greatest depth on both members, transmission error and greatest pressure over the revolutions."""
    turned = history["revolutions"].values.astype(float)
    torques = _torque_names(history["torque"].values)
    members = [str(member) for member in history["member"].values]
    return [
        Chart(name, [Curve(n, turned, values) for n, values in zip(names, table.T, strict=True)])
        for name, variable, over, names in (
            ("wear_depth", "largest_depth", "member", members),
            ("wear_error", "peak_to_peak", "torque", torques),
            ("wear_pressure", "max_pressure", "torque", torques),
        )
        for table in (ordered(history, variable, "step", over),)
    ]
