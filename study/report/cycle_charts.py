"""Charts of the report: courses over the mesh cycle, over torque, speed and face, each with the variable it shows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.evaluation.tooth_passage import unloaded_curves
from ...core.attributes import ordered
from ..summary.plausibility import TOLD_SHARE
from ..summary.supports_report import SHARES, bearing_loads
from .packed_array import packed_exactly

Array = NDArray[Any]
LOADED, SEGMENTS = ("torque", "mesh_position"), ("torque", "mesh_position", "segment")
CYCLE = "mesh position"
#: Conditions over which efficiencies are drawn.
AXES = {
    "torque": "torque at the pinion [N m]",
    "speed": "speed of the pinion [1/min]",
    "temperature": "oil temperature [°C]",
    "roughness": "RMS roughness [µm]",
}
CONDITION_UNITS = {"speed": "1/min", "temperature": "°C", "roughness": "µm"}


def chart(
    name: str, title: str, x: str, y: str, source: str, series: Sequence[tuple[str, Array, Array]], *, by: str = ""
) -> dict[str, Any]:
    """Chart for the page, without series that have no finite value.

    ``by`` "torque": a series a torque, all but the chosen one pale; "only" and "each": those of the chosen one alone.
    """
    shown = [
        {"name": label, "x": packed_exactly(at), "y": packed_exactly(values), "number": number}
        for number, (label, at, values) in enumerate(series)
        if np.any(np.isfinite(values))
    ]
    return {
        "id": name,
        "title": title,
        "x": x,
        "y": y,
        "source": source,
        "series": shown,
        "by": by,
        "cycle": x == CYCLE,
    }


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


def over_torque(tree: xr.DataTree) -> dict[str, Any]:
    """Courses of the main numbers over torque, by name; efficiency at the middle speed, temperature and roughness."""
    groups = {name: tree[name].to_dataset() for name in ("loaded", "friction") if name in tree.children}
    courses = {}
    for group, variable, title, unit, factor in (
        ("loaded", "peak_to_peak", "Transmission error, peak to peak,", "µrad", 1.0),
        ("loaded", "max_pressure", "Greatest pressure", "MPa", 1.0),
        ("loaded", "contact_ratio", "Contact ratio", "", 1.0),
        ("loaded", "mean_mesh_stiffness", "Mesh stiffness", "N m/µrad", 1.0),
        ("friction", "efficiency", "Efficiency", "%", 100.0),
    ):
        if group not in groups or variable not in groups[group]:
            continue
        values = groups[group][variable].sortby("torque")
        conditions = []
        for name in values.dims:
            if name != "torque":
                values = values.isel({name: int(np.argsort(values[name].values)[(values.sizes[name] - 1) // 2])})
                conditions += [f"{values[name].item():g} {CONDITION_UNITS[str(name)]}"]
        if np.any(np.isfinite(values.values)):
            courses[variable] = {
                "title": title,
                "at": ", ".join(conditions),
                "unit": unit,
                "source": f"{group}/{variable}",
                "x": packed_exactly(values["torque"].values),
                "y": packed_exactly(factor * values.values),
            }
    return courses


def transmission_error_charts(
    tree: xr.DataTree, chosen: NDArray[Any], radius: float | None = None
) -> list[dict[str, Any]]:
    """Charts of the transmission error: without and under load, about its mean, its orders by number and torque.

    The mean pitch radius of the gear [mm] gives a second scale of lengths [um] along its pitch circle.
    """
    loaded = tree["loaded"].to_dataset()
    names = [f"{torque:g} N m" for torque in loaded["torque"].values[chosen]]
    error = ordered(loaded, "transmission_error", *LOADED)[chosen]
    course, times, lowest = unloaded_curves(tree["unloaded"].to_dataset())
    unloaded = [("pair that carries", times / 1.0, lowest)] if course.values.size else []
    about = [value - np.mean(value[np.isfinite(value)]) if np.any(np.isfinite(value)) else value for value in error]
    harmonic = ordered(loaded, "harmonic", "torque", "order")
    orders, torques = loaded["order"].values.astype(float), loaded["torque"].values
    labels = ("rotation of the gear [µrad]", "loaded/transmission_error")
    charts = [
        chart(
            "te_unloaded",
            "Transmission error without load",
            "mesh cycles",
            labels[0],
            "unloaded/transmission_error",
            unloaded,
        ),
        chart(
            "te_loaded",
            "Transmission error under load",
            CYCLE,
            *labels,
            [(n, *_cycle(v)) for n, v in zip(names, error, strict=True)],
            by="torque",
        ),
        chart(
            "te_mean",
            "Transmission error under load, about its mean",
            CYCLE,
            *labels,
            [(n, *_cycle(v)) for n, v in zip(names, about, strict=True)],
            by="torque",
        ),
        chart(
            "te_orders",
            "Orders of the transmission error",
            "order of the mesh frequency",
            "amplitude [µrad]",
            "loaded/harmonic",
            [(n, orders, harmonic[i]) for n, i in zip(names, chosen, strict=True)],
            by="torque",
        ),
    ]
    if torques.size > 1:
        rank = np.argsort(torques)
        series = [(f"order {o:g}", torques[rank], harmonic[rank, i]) for i, o in enumerate(orders[:4])]
        series.insert(0, ("peak to peak", torques[rank], loaded["peak_to_peak"].values[rank]))
        charts.append(
            chart(
                "te_torque",
                "Transmission error over torque",
                "torque at the pinion [N m]",
                "[µrad]",
                "loaded/peak_to_peak, loaded/harmonic",
                series,
            )
        )
    if radius is not None:
        second = {"factor": 1e-3 * radius, "label": "[µm] at the mean pitch radius"}
        charts = [one | {"second": second} if one["id"] != "te_unloaded" else one for one in charts]
    return charts


def contact_charts(tree: xr.DataTree, chosen: NDArray[Any]) -> list[dict[str, Any]]:
    """Load shares, greatest pressure, mesh stiffness and share on edges over the mesh cycle."""
    loaded = tree["loaded"].to_dataset()
    names = [f"{torque:g} N m" for torque in loaded["torque"].values[chosen]]
    share = 100.0 * ordered(loaded, "load_share", *LOADED, "pair")[chosen]
    pairs = loaded["pair"].values
    shares = [
        (f"{name}, pair {pair:g}", *_passage(share[i], pairs, int(p)))
        for i, name in enumerate(names)
        for p, pair in enumerate(pairs)
    ]
    charts = [
        {
            **chart(
                "load_share", "Load share", CYCLE, "share of the torque [%]", "loaded/load_share", shares, by="only"
            ),
            "per": len(pairs),
        },
        _course("max_pressure", "Greatest pressure", "[MPa]", "loaded/pressure", names, _pressure(loaded)[chosen]),
    ]
    for variable, title, unit, factor in (
        ("mesh_stiffness", "Mesh stiffness", "[N m/µrad]", 1.0),
        ("edge_share", "Share of the load on tooth edges", "[%]", 100.0),
    ):
        if variable in loaded:
            values = factor * ordered(loaded, variable, *LOADED)[chosen]
            if variable != "edge_share" or np.any(np.nan_to_num(values) > 0.0):
                charts.append(_course(variable, title, unit, f"loaded/{variable}", names, values))
    return charts


def _pressure(loaded: xr.Dataset) -> Array:
    pressure = _greatest(ordered(loaded, "pressure", *SEGMENTS))
    return np.where(pressure > 0.0, pressure, np.nan)


def _course(name: str, title: str, y: str, source: str, names: Sequence[str], table: Array) -> dict[str, Any]:
    """Chart over the mesh cycle with a series a torque (torque, mesh_position)."""
    return chart(
        name, title, CYCLE, y, source, [(n, *_cycle(v)) for n, v in zip(names, table, strict=True)], by="torque"
    )


def supports_charts(tree: xr.DataTree, chosen: NDArray[Any]) -> list[dict[str, Any]]:
    """Parts of the gear's rotation over torque, and bearing loads over the mesh cycle."""
    group = tree["supports"].to_dataset()
    torques = group["torque"].values
    rank = np.argsort(torques)
    parts = [(n, torques[rank], ordered(group, v, *LOADED).mean(axis=1)[rank]) for n, v in SHARES.items()]
    charts = []
    if torques.size > 1:
        source = "supports/teeth_rotation, contact_rotation, supports_rotation, ease_off_rotation"
        title = "Parts of the gear's rotation, mean over the mesh cycle"
        charts.append(chart("rotation_parts", title, "torque at the pinion [N m]", "[µrad]", source, parts))
    names, radial, axial = bearing_loads(tree)
    place = np.argsort(rank)[chosen]  # these rise with the torque
    for name, title, force in (("radial", "Radial", radial), ("axial", "Axial", axial)):
        series = [
            (f"{torques[i]:g} N m, {bearing}", *_cycle(force[number, k]))
            for i, k in zip(chosen, place, strict=True)
            for number, bearing in enumerate(names)
        ]
        if series:
            words = f"{title} bearing loads" + (", positive towards the heel" if name == "axial" else "")
            one = chart(f"bearing_{name}", words, CYCLE, "[N]", "supports/bearing_force", series, by="only")
            charts.append(one | {"per": len(names)})
    return charts


def root_stress_charts(stress: xr.Dataset, chosen: NDArray[Any]) -> list[dict[str, Any]]:
    """Root stress of both members along the face, and over the mesh cycle."""
    torques = [f"{torque:g} N m" for torque in stress["torque"].values[chosen]]
    charts = []
    for number, member in enumerate(stress["member"].values):
        along = ordered(stress, "root_stress", "torque", "member", "lengthwise")[chosen, number]
        face = 100.0 * stress["lengthwise"].values
        charts.append(
            chart(
                f"root_{member}",
                f"Root stress along the face, {member}",
                "from the toe [%]",
                "[MPa]",
                "root_stress/root_stress",
                [(name, face, values) for name, values in zip(torques, along, strict=True)],
                by="torque",
            )
        )
        history = ordered(stress, "root_stress_history", "torque", "member", "mesh_position", "pair")[chosen, number]
        title = f"Greatest root stress of the teeth in mesh, {member}"
        charts.append(
            _course(
                f"root_cycle_{member}", title, "[MPa]", "root_stress/root_stress_history", torques, _greatest(history)
            )
        )
    return charts


def friction_charts(tree: xr.DataTree, chosen: NDArray[Any], at: dict[str, int]) -> list[dict[str, Any]]:
    """Charts of efficiency, and of coefficient, film, sliding and p v over the mesh cycle.

    ``chosen`` are numbers of torques; ``at`` holds those of speed, temperature and roughness.
    """
    loaded, friction = tree["loaded"].to_dataset(), tree["friction"].to_dataset()
    subset = friction.isel(at)
    names = [f"{torque:g} N m" for torque in loaded["torque"].values[chosen]]
    carries = np.nan_to_num(ordered(loaded, "pressure", *SEGMENTS)) > 0.0
    charts = []
    force = np.where(carries, np.nan_to_num(ordered(loaded, "force", *SEGMENTS)), 0.0)

    def mean(table: Array) -> Array:
        return _weighted_mean(table, force)

    for variable, title, unit, reduce in (
        ("friction_coefficient", "Friction coefficient, mean weighted by force", "", mean),
        ("film_thickness", "Least film thickness", "[µm]", _least),
        ("flash_temperature", "Greatest flash temperature", "[K]", _greatest),
    ):
        if variable in subset:
            table = np.where(carries, subset[variable].transpose(*SEGMENTS).values, np.nan)
            source = f"friction/{variable}"
            charts.append(_course(variable, title, unit, source, names, reduce(table)[chosen]))
    if "sliding_velocity" in subset:
        sliding = subset["sliding_velocity"].transpose(..., "mesh_position", "segment").values  # maybe of each torque
        source = "friction/sliding_velocity"
        table = np.where(carries, sliding, np.nan)
        charts.append(
            _course("sliding", "Sliding velocity, mean weighted by force", "[m/s]", source, names, mean(table)[chosen])
        )
        table = table * ordered(loaded, "pressure", *SEGMENTS)
        source = "loaded/pressure × friction/sliding_velocity"
        charts.append(
            _course("pv", "Greatest pressure × sliding velocity", "[MPa m/s]", source, names, _greatest(table)[chosen])
        )
    if "mesh_power_loss" in subset:
        table = subset["mesh_power_loss"].transpose(*LOADED).values[chosen]
        charts.append(_course("power_loss", "Power loss", "[W]", "friction/mesh_power_loss", names, table))
    efficiency = 100.0 * friction["efficiency"]
    for along, label in AXES.items():
        by = "speed" if along == "torque" else "torque"
        if friction.sizes[along] < 2:
            continue
        fixed = {name: number for name, number in at.items() if name not in (along, by)}
        curves = efficiency.isel(fixed).transpose(by, along).sortby(along)
        rows = range(curves.sizes[by]) if by == "speed" else chosen
        unit = "1/min" if by == "speed" else "N m"
        series = [(f"{curves[by].values[i]:g} {unit}", curves[along].values, curves.values[i]) for i in rows]
        title = f"Efficiency over {label.partition(' [')[0]}"
        charts.append(chart(f"efficiency_{along}", title, label, "[%]", "friction/efficiency", series))
    return charts


def efficiency_map(friction: xr.Dataset, at: dict[str, int]) -> dict[str, Any] | None:
    """Efficiency [%] over torque and speed, and the share of the loss beyond the formula; ``None`` unless several."""
    if min(friction.sizes["torque"], friction.sizes["speed"]) < 2:
        return None
    subset = friction.isel(temperature=at["temperature"], roughness=at["roughness"])
    subset = subset.sortby("torque").sortby("speed")
    outside = (
        subset["extrapolated_share"].transpose("torque", "speed").values if "extrapolated_share" in subset else None
    )
    return {
        "torques": subset["torque"].values.tolist(),
        "speeds": subset["speed"].values.tolist(),
        "values": packed_exactly(100.0 * subset["efficiency"].transpose("torque", "speed").values),
        "outside": None if outside is None else packed_exactly(outside),
        "told": TOLD_SHARE,
    }
