"""Every number of the report is that of the variable it names, read from the file alone by units and digits."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from report_content import (
    checked_pattern,
    content,
    duty_result,
    strength_result,
    supported_result,
    unpacked,
    worn_flanks,
)

from easeoff import write_result
from easeoff.study import write_report
from easeoff.study.vh import write_vh_check

pytestmark = pytest.mark.thorough

Array = NDArray[Any]
CERTIFIED = "certified"
#: Factor from the unit of a variable to the one in print; others are alike in both.
FACTORS = {("1", "%"): 100.0, ("rad", "°"): 180.0 / np.pi}
ALIKE = {
    "µrad": "urad",
    "µm": "um",
    "°C": "degC",
    "N m/µrad": "N m urad-1",
    "MPa m/s": "MPa m s-1",
    "m/s": "m s-1",
    "": "1",
}
CONDITIONS = ("torque", "speed", "temperature", "roughness")


def factor(variable: xr.DataArray, unit: str) -> float:
    """By which the values of a variable come to be in a unit."""
    own = str(variable.attrs.get("units", "1"))
    found = FACTORS.get((own, unit))
    assert found or own == ALIKE.get(unit, unit), (variable.name, own, unit)
    return found or 1.0


def agrees(cell: str, value: float) -> bool:
    """Whether a cell is a value rounded to the digits of the cell; a dash is no value."""
    if cell == "–":
        return not np.isfinite(value)
    _, _, digits = cell.lstrip("+").partition(".")
    return abs(float(cell) - value) <= 0.5 * 10.0 ** -len(digits) * (1.0 + 1e-6)


def to_four_digits(cell: str, value: float) -> bool:
    """The same of a cell with digits that count."""
    return abs(float(cell) - value) <= 0.5e-3 * abs(value) + 1e-12


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with results of every kind, and the report of each."""
    folder = tmp_path_factory.mktemp("numbers")
    for name, tree in (("strength", strength_result()), ("axle", supported_result()), ("duty", duty_result())):
        write_result(tree, folder / f"{name}.nc")
    write_vh_check(checked_pattern(), folder / "check.nc")
    worn_flanks().to_netcdf(folder / "worn.nc", engine="netcdf4")
    write_report({"strength": strength_result(), "axle": supported_result()}, folder / "report.html")
    write_report({"duty": duty_result()}, folder / "duty.html")
    write_report({"check": checked_pattern(), "worn": worn_flanks()}, folder / "others.html")
    return folder


@pytest.fixture(scope="module")
def data(files: Path) -> dict[str, Any]:
    """Data of the pages by their names."""
    pages = {
        name: content((files / f"{name}.html").read_text(encoding="utf-8")) for name in ("report", "duty", "others")
    }
    return pages | {result["name"]: result for result in pages["report"]["results"]}


@pytest.fixture(params=["strength", "axle"])
def result(request: pytest.FixtureRequest, files: Path, data: dict[str, Any]) -> Iterator[tuple[Any, xr.DataTree]]:
    """A result of the report and its file."""
    with xr.open_datatree(files / f"{request.param}.nc", engine="netcdf4") as tree:
        yield data[request.param], tree


def named_values(tree: xr.DataTree, path: str, row: str) -> xr.DataArray:
    """Values that a path such as ``loaded/harmonic`` names, of the order or member that the row is about."""
    group, _, name = path.partition("/")
    if not name:
        group, _, attribute = path.partition(".")
        values = xr.DataArray(tree[group].attrs[attribute], attrs={"units": "urad"})
        values = values.rename(dict.fromkeys(values.dims, "order"))
        if values.ndim:
            values = values.assign_coords(order=np.arange(1, values.size + 1))
    else:
        values = tree[group].to_dataset()[name]
    if order := re.search(r"order (\d+)", row):
        values = values.sel(order=int(order[1]))
    if "member" in values.dims:
        values = values.sel(member=row.rpartition(", ")[2])
    return values


def test_numbers_under_load_are_those_of_their_variables(result: tuple[Any, xr.DataTree]) -> None:
    part, tree = result
    numbers, checked = part["loaded_numbers"], 0
    torques = [float(torque) for torque in numbers["torques"]]
    for row, unit, path, *cells in numbers["rows"]:
        variable, _, operation = path.partition(" ")
        values = named_values(tree, variable, row).sel(torque=torques)
        if "flag_meanings" in values.attrs:
            meanings = dict(zip(values.attrs["flag_values"], values.attrs["flag_meanings"].split(), strict=True))
            words = [[meanings[code] for code in np.atleast_1d(codes)] for codes in values.values]
            if values.ndim == 1:
                told = [word.replace("none", "inside").replace("_", " ") for (word,) in words]
            else:
                told = [f"{word.count(CERTIFIED)} of {len(word)}" for word in words]
            assert told == cells, row
            checked += 1
            continue
        if values.ndim > 1:
            assert row.startswith("greatest"), row
            values = values.max([name for name in values.dims if name != "torque"])
        if operation:  # as the row says it: × a length [mm], or over its square and another
            lengths = [float(length) for length in re.findall(r"([\d.]+) mm", operation)]
            scale = 1e-3 * lengths[0] if len(lengths) == 1 else 1e6 / lengths[0] ** 2 / lengths[1]
            tolerance = 1e-3  # the lengths have four digits
            for cell, value in zip(cells, scale * values.values, strict=True):
                assert float(cell) == pytest.approx(
                    value, rel=tolerance, abs=0.5 * 10.0 ** -len(cell.partition(".")[2])
                )
        else:
            for cell, value in zip(cells, factor(values, unit) * values.values, strict=True):
                assert agrees(cell, float(value)), (row, cell, value)
        checked += 1
    assert checked == len(numbers["rows"]) > 20


def test_numbers_without_load_are_those_of_their_variables(result: tuple[Any, xr.DataTree]) -> None:
    part, tree = result
    ease_off = tree["ease_off"].to_dataset()
    inside = ease_off["inside"] == 1
    for row, unit, path, cell in part["unloaded_numbers"]:
        values = named_values(tree, path, row)
        if path == "ease_off/inside":
            weights = xr.ones_like(values, dtype=float)  # of the nodes of an even grid: half at its edges
            for name in values.dims:
                weights[{name: [0, -1]}] *= 0.5
            values = (inside * weights).sum() / weights.sum()
            values.attrs["units"] = "1"
        elif values.ndim:
            assert row.startswith("greatest"), row
            values = values.where(inside).max(keep_attrs=True)
        assert agrees(cell, factor(values, unit) * float(values)), (row, cell)
    assert len(part["unloaded_numbers"]) >= 11


def test_numbers_of_friction_are_those_of_their_variables(data: dict[str, Any], files: Path) -> None:
    table = data["strength"]["friction"]["table"]
    with xr.open_datatree(files / "strength.nc", engine="netcdf4") as tree:
        friction, loaded = tree["friction"].to_dataset(), tree["loaded"].to_dataset()
        for row in table["rows"]:
            place = {name: float(cell) for name, cell in zip(CONDITIONS, row, strict=False)}
            for head, path, cell in zip(table["heads"], table["variables"], row, strict=True):
                values = friction[path.removeprefix("friction/")]
                unit = (re.findall(r"\[(.*)\]", head) or [""])[0]
                scale = factor(values, unit)
                values = values.sel({name: at for name, at in place.items() if name in values.dims}, method="nearest")
                if values.ndim:
                    assert head.startswith("greatest"), head
                    values = values.where(loaded["pressure"].sel(torque=place["torque"]) > 0.0).max()
                assert agrees(cell, scale * float(values)), (head, cell)
    assert len(table["rows"]) == 4


def test_numbers_of_supports_are_those_of_their_variables(data: dict[str, Any], files: Path) -> None:
    shares, loads = data["axle"]["supports"]
    with xr.open_datatree(files / "axle.nc", engine="netcdf4") as tree:
        group, moved = tree["supports"].to_dataset(), tree["misalignment"].to_dataset()
        for torque, whole, *parts in shares["rows"]:
            at, (first, *others) = group.sel(torque=float(torque)), shares["variables"]
            mean = float(at[first.removeprefix("supports/")].mean())
            assert agrees(whole, mean)
            for path, cell in zip(others, parts, strict=True):
                assert agrees(cell, 100.0 * float(at[path.removeprefix("supports/")].mean()) / mean)
        axes = tree["ease_off"].attrs
        for torque, *cells in loads["rows"]:
            for head, cell in zip(loads["heads"][1:], cells, strict=True):
                force = group["bearing_force"].sel(torque=float(torque), bearing=head)
                axis = np.asarray(axes[f"{head.split()[0]}_axis"])
                along = force.values @ axis
                across = np.linalg.norm(force.values - along[:, None] * axis, axis=1)
                radial, axial = cell.split(", ")
                assert agrees(radial, float(across.mean()))
                assert agrees(axial.lstrip("+-"), abs(float(along.mean())))  # the sign is towards the heel
        for torque, *cells in data["axle"]["misalignment"][0]["rows"]:
            for name, cell in zip(("offset", "pinion_axial", "gear_axial", "shaft_angle"), cells, strict=True):
                if float(torque):  # without torque there is none
                    values = moved[name].sel(torque=float(torque))
                    assert agrees(cell, factor(values, "°" if name == "shaft_angle" else "mm") * float(values.mean()))


def test_numbers_of_load_cases_are_those_of_their_variables(data: dict[str, Any], files: Path) -> None:
    (part,) = data["duty"]["load_cases"]
    with xr.open_datatree(files / "duty.nc", engine="netcdf4") as tree:
        numbers = tree["load_cases"].to_dataset()
        for table in part["tables"]:
            assert len(table["heads"]) == len(table["variables"])
            for head, path, *cells in zip(table["heads"], table["variables"], *table["rows"], strict=True):
                group, _, name = path.partition("/")
                values, unit = numbers[name], (re.findall(r"\[(.*)\]", head) or [""])[0]
                assert group == "load_cases"
                for cell, value in zip(cells, values.values, strict=True):
                    if isinstance(value, str):
                        assert cell == value
                    else:
                        exact = factor(values, unit) * float(value)
                        assert (to_four_digits if table is part["tables"][0] else agrees)(cell, exact), (
                            head,
                            cell,
                            exact,
                        )


def test_numbers_of_a_check_and_of_wear_are_those_of_their_variables(data: dict[str, Any], files: Path) -> None:
    (check,), (worn,) = data["others"]["checks"], data["others"]["wear"]
    with xr.open_dataset(files / "check.nc") as found:
        assert found["place"].values.tolist() == [row[0] for row in check["table"]["rows"]]
        scale = {name: factor(found[name], "mm" if name in "vh" else "µrad" if "peak" in name else "%")
                 for name in check["table"]["variables"]}  # fmt: skip
        for place, *cells in check["table"]["rows"]:
            told = [part for cell in cells for part in cell.split(", ")]
            for name, cell in zip(check["table"]["variables"], told, strict=True):
                assert agrees(cell, scale[name] * float(found[name].sel(place=place))), (name, cell)
    with xr.open_dataset(files / "worn.nc") as found:
        revolutions = found["revolutions"].values
        for turned, pinion, gear, error, pressure in worn["table"]["rows"]:
            step = int(np.argmin(np.abs(revolutions - float(turned))))
            here = found.isel(step=step)
            assert agrees(turned, float(here["revolutions"]))
            for cell, member in ((pinion, "pinion"), (gear, "gear")):
                assert agrees(cell, float(here["largest_depth"].sel(member=member)))
            assert agrees(error, float(here["peak_to_peak"][0]))
            assert agrees(pressure, float(here["max_pressure"][0]))


def test_curves_run_through_values_of_their_variables(result: tuple[Any, xr.DataTree]) -> None:
    """Of every chart that shows a variable as it is, or the greatest or least of its segments."""
    part, tree = result
    derived = {
        "te_mean",
        "te_unloaded",
        "pv",
        "sliding",
        "friction_coefficient",
        "rotation_parts",
        "bearing_radial",
        "bearing_axial",
    }
    checked = set()
    for chart in (chart for group in part["charts"].values() for chart in group):
        if chart["id"] in derived:
            continue
        values = []
        for path in chart["source"].split(", "):
            own, unit = named_values(tree, path, chart["title"]), (re.findall(r"\[(.*)\]", chart["y"]) or [""])[0]
            values.append(factor(own, unit) * own.values.ravel())
        known = np.sort(np.concatenate([*values, [0.0]]))  # a share of a pair that does not carry ends at nothing
        known = known[np.isfinite(known)]
        for series in chart["series"]:
            shown = unpacked(series["y"]).astype(float)
            shown = shown[np.isfinite(shown)]
            after = np.clip(np.searchsorted(known, shown), 1, known.size - 1)
            nearest = np.minimum(np.abs(known[after] - shown), np.abs(known[after - 1] - shown))
            assert np.all(nearest <= 1e-6 * np.abs(shown) + 1e-6), (chart["id"], series["name"])
        checked.add(chart["id"])
    assert {"te_loaded", "te_orders", "load_share", "max_pressure", "mesh_stiffness"} <= checked
