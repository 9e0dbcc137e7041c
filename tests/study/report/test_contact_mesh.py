"""Contact of a result as files: in VTK, read back by another library, and in REXS, by its published schema."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from runs import output_of, read_only, refusal_of, small
from scipy.interpolate import RegularGridInterpolator
from scipy.spatial import cKDTree

import easeoff
from easeoff import InputError
from easeoff.cases import gear_pair, read_rexs
from easeoff.cases.rexs.rexs_reading import Component, Model, read_model
from easeoff.cases.rexs.rexs_vocabulary import Term
from easeoff.geometry.flanks.flank import solve_flank
from easeoff.study.report.contact_mesh import band_pressure, export_contact

Array = NDArray[Any]
TORQUE, POSITION = 100.0, 0.25
PINION, GEAR, BOTH = 0, 1, 2
FLANK, OTHER, SEGMENT = 0, 1, 2


@pytest.fixture(scope="module")
def tree() -> xr.DataTree:
    case = small("fm-11x41", "shell", mesh_positions=4, segments_per_line=21, lengthwise_nodes=31, profile_nodes=15)
    return read_only(easeoff.analyze(case, torques=[60.0, TORQUE], speed=1500.0))


class Written:
    """A file as meshio reads it."""

    def __init__(self, path: Path) -> None:
        mesh = meshio.read(path)
        self.points = mesh.points
        self.quads = mesh.cells_dict["quad"]
        self.cells: dict[str, Array] = {name: values[0] for name, values in mesh.cell_data.items()}
        self.nodes: dict[str, Array] = mesh.point_data

    def chosen(self, part: int, member: int) -> NDArray[np.bool_]:
        return np.asarray((self.cells["part"] == part) & (self.cells["member"] == member))

    def middles(self, part: int, member: int) -> Array:
        return np.asarray(self.points[self.quads[self.chosen(part, member)]].mean(axis=1))

    def area(self, part: int, member: int) -> Array:
        corners = self.points[self.quads[self.chosen(part, member)]]
        cross = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        return np.asarray(0.5 * np.linalg.norm(cross, axis=1))

    def at_nodes(self, name: str, part: int, member: int) -> Array:
        """Mean of the corners of each cell."""
        return np.asarray(self.nodes[name][self.quads[self.chosen(part, member)]].mean(axis=1))


@pytest.fixture(scope="module")
def written(tree: xr.DataTree, tmp_path_factory: pytest.TempPathFactory) -> Written:
    path = tmp_path_factory.mktemp("mesh") / "pattern.vtu"
    said = export_contact(tree, path, torque=TORQUE, mesh_position=POSITION)
    assert said == "3 tooth pairs in contact at 100 N m, mesh position 0.25"
    return Written(path)


@pytest.fixture(scope="module")
def here(tree: xr.DataTree) -> xr.Dataset:
    """Loaded segments of the result, in the order of the file: by pair."""
    found = tree["loaded"].to_dataset().isel(torque=1, mesh_position=1)
    friction = tree["friction"].to_dataset().isel(torque=1, mesh_position=1, speed=0, temperature=0, roughness=0)
    names = ("film_thickness", "friction_coefficient", "flash_temperature", "bulk_temperature")
    found = found.assign({name: friction[name] for name in names})
    chosen = np.flatnonzero(found["force"].values > 0.0)
    return found.isel(segment=chosen[np.argsort(found["tooth"].values[chosen], kind="stable")])


def test_segments_have_the_values_of_the_result(written: Written, here: xr.Dataset) -> None:
    on = written.chosen(SEGMENT, BOTH)
    expected = {
        "pair": here["tooth"],
        "pressure [MPa]": here["pressure"],
        "force [N]": here["force"],
        "load per length [N/mm]": here["force"] / here["length"],
        "film thickness [um]": here["film_thickness"],
        "friction coefficient [1]": here["friction_coefficient"],
        "contact temperature [degC]": here["flash_temperature"] + here["bulk_temperature"],
    }
    for name, values in expected.items():
        np.testing.assert_allclose(written.cells[name][on], values.values, rtol=1e-12, err_msg=name)
    assert np.all(np.isnan(written.cells["force [N]"][written.cells["part"] != SEGMENT]))
    wide = here["pressure"].notnull().values
    np.testing.assert_allclose(
        written.area(SEGMENT, BOTH)[wide], (2.0 * here["length"] * here["half_width"]).values[wide], rtol=1e-9
    )


def test_pressure_across_a_strip_is_the_half_ellipse_of_hertz() -> None:
    strip = np.array([[[-1.0, -0.2, 0.0], [1.0, -0.2, 0.0], [1.0, 0.2, 0.0], [-1.0, 0.2, 0.0]]])
    line = np.array([[[0.0, y, 0.0] for y in (0.0, 0.12, 0.3)]])
    np.testing.assert_allclose(band_pressure(line, strip, np.array([1000.0])), [[1000.0, 800.0, 0.0]], atol=1e-9)


def test_segments_lie_on_the_gear_flank_of_the_result(tree: xr.DataTree, written: Written, here: xr.Dataset) -> None:
    """Radius about the gear axis and height along it do not depend on the rotation: as of the nodes, interpolated."""
    position = tree["flanks"].to_dataset()["position"].sel(member="gear")
    x, y, z = (position.sel(xyz=axis, drop=True) for axis in "xyz")
    section = xr.Dataset({"radius": np.sqrt(x**2 + y**2), "height": z}).to_dataarray("axis")
    at = {name: xr.DataArray(here[name].values, dims="segment") for name in ("lengthwise", "profile")}
    expected = section.interp(at, method="linear").transpose("segment", "axis").values
    origin = np.asarray(tree["ease_off"].attrs["gear_origin_mm"])
    middles = written.middles(SEGMENT, BOTH) - origin
    found = np.stack([np.hypot(middles[:, 0], middles[:, 1]), middles[:, 2]], axis=1)
    np.testing.assert_allclose(found, expected, atol=2e-3)


@pytest.mark.parametrize("member", [PINION, GEAR])
def test_the_members_touch_where_they_carry(written: Written, member: int) -> None:
    """The distance of the segments from the surface of the nearest cell is as small as ease-off and elastic approach.

    It would be of the order of a millimetre if a tooth stood at the rotation of another pair or mesh position.
    """
    middles = written.middles(SEGMENT, BOTH)
    corners = written.points[written.quads[written.chosen(FLANK, member)]]
    centre = corners.mean(axis=1)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    _, nearest = cKDTree(centre).query(middles)
    apart = np.abs(np.sum((middles - centre[nearest]) * normal[nearest], axis=1))
    assert np.max(apart) < 0.03
    assert np.median(apart) < 0.01


@pytest.mark.parametrize("member", [PINION, GEAR])
def test_pressure_on_the_nodes_carries_the_load(written: Written, here: xr.Dataset, member: int) -> None:
    """The integral of a Hertzian pressure over its band is the normal force."""
    force = float(here["force"].where(here["pressure"].notnull()).sum())
    total = written.at_nodes("contact pressure [MPa]", FLANK, member) @ written.area(FLANK, member)
    assert total == pytest.approx(force, rel=0.05)
    assert np.nanmax(written.nodes["contact pressure [MPa]"]) <= float(here["pressure"].max()) * (1 + 1e-12)


@pytest.mark.parametrize("member", [PINION, GEAR])
def test_pattern_and_ease_off_are_those_of_the_result(tree: xr.DataTree, written: Written, member: int) -> None:
    nodes = np.unique(written.quads[written.chosen(FLANK, member)])
    pattern = written.nodes["greatest pressure over the cycle [MPa]"][nodes]
    greatest = float(tree["loaded"].to_dataset()["max_pressure"][1])
    assert 0.97 * greatest < pattern.max() <= greatest * (1 + 1e-12)
    assert pattern.min() == 0.0
    ease_off = written.nodes["ease-off [um]"][nodes]
    inside = tree["ease_off"].to_dataset()
    stored = inside["ease_off"].values[inside["inside"].values == 1]
    assert np.nanmax(ease_off) == pytest.approx(stored.max(), rel=0.15)  # beyond the nodes that are inside
    assert abs(np.nanmin(ease_off) - stored.min()) < 0.2
    others = np.unique(written.quads[written.cells["part"] != FLANK])
    assert np.all(np.isnan(written.nodes["ease-off [um]"][np.setdiff1d(others, nodes)])[-100:])


def test_mistakes_name_what_there_is(tree: xr.DataTree, tmp_path: Path) -> None:
    for given, said in (
        ({"torque": 75.0}, "torque = 75: must be one of the result's: 60, 100 N m"),
        (
            {"mesh_position": 0.26},
            "mesh_position = 0.26: must be one of the 4 of the result, K/4; the nearest is 0.2",
        ),
    ):
        with pytest.raises(InputError) as caught:
            export_contact(tree, tmp_path / "x.vtu", **given)  # type: ignore[arg-type]
        assert said in str(caught.value)
    with pytest.raises(InputError, match=r"must be \.vtu or \.rexs for the contact"):
        export_contact(tree, tmp_path / "x.stl")
    without = tree.copy()
    without.attrs = {name: value for name, value in tree.attrs.items() if name != "case"}
    with pytest.raises(InputError, match="keeps no case that can be read"):
        export_contact(without, tmp_path / "x.vtu")
    assert list(tmp_path.iterdir()) == []


def test_the_command_tells_results_from_cases(tree: xr.DataTree, tmp_path: Path) -> None:
    result = tmp_path / "x.nc"
    easeoff.write_result(tree, result)

    done = output_of(
        "export", result, "-o", tmp_path / "x.vtu", "--mesh-position", "0.5", "--torque", "60", "--nodes", "31x15"
    )
    assert "tooth pairs in contact at 60 N m, mesh position 0.5" in done
    assert np.unique(Written(tmp_path / "x.vtu").cells["pair"]).size >= 2
    for words, said in (
        ((result, "-o", tmp_path / "y.vtu", "--member", "gear"), "--member: must go with a CASE"),
        (("nasa-12x36", "-o", tmp_path / "y.stl", "--mesh-position", "0"), "--mesh-position: must go with a RESULT"),
        ((tmp_path / "no.nc", "-o", tmp_path / "y.vtu"), "there is no such file"),
        ((result, "-o", tmp_path / "y.rexs", "--mesh-position", "0"), "--mesh-position: must go with a .vtu file"),
    ):
        assert said in refusal_of("export", *words)
    assert not list(tmp_path.glob("y.*"))


# REXS


@pytest.fixture(scope="module")
def model(tree: xr.DataTree, tmp_path_factory: pytest.TempPathFactory) -> Model:
    path = tmp_path_factory.mktemp("rexs") / "pair.rexs"
    said = export_contact(tree, path, torque=TORQUE)
    assert said.endswith(" contact points on the gear flank at 100 N m")
    return read_model(path)


def only(model: Model, kind: str) -> Component:
    (found,) = [component for component in model.components.values() if component.kind == kind]
    return found


def column(component: Component, name: str, unit: str) -> Array:
    """Numbers of an attribute, whose unit must be that of the schema."""
    assert component.attributes[name].attrib["unit"] == unit
    return np.array([float(entry.text or "") for entry in component.attributes[name].iter("c")])


def test_points_and_values_hang_together_as_the_schema_of_rexs_says(model: Model) -> None:
    """Relations, roles and types of components that rexs_schema_2.0.0.xml allows."""
    points, values = only(model, "point_list"), only(model, "meshing_contact_stage_data_set")
    stage, (_, gear) = only(model, "bevel_stage"), [c for c in model.components.values() if c.kind == "bevel_gear"]
    (to_points,) = model.related("assembly", "part", points.number)
    data = model.components[to_points.roles["assembly"]]
    assert data.kind == "bevel_stage_gear_data"
    (to_gear,) = model.related("stage_gear_data", "stage_gear_data", data.number)
    assert to_gear.roles == {"stage": stage.number, "gear": gear.number, "stage_gear_data": data.number}
    (to_values,) = model.related("reference", "origin", points.number)
    assert to_values.roles["referenced"] == values.number
    assert points.text(Term("kind_of_point_list", "none")) == "meshing_contact_points"
    np.testing.assert_array_equal(column(points, "point_ids", "none"), column(values, "set_ids", "none"))


def test_the_loaded_flanks_are_those_of_the_drive_side(model: Model) -> None:
    for relation, loaded in zip(
        [relation for relation in model.relations if relation.kind == "stage_gear_data"],
        ("concave", "convex"),
        strict=True,
    ):
        role = model.components[relation.roles["stage_gear_data"]].text(Term("loaded_tooth_flank", "none"))
        (flanks,) = model.related("flank", "gear", relation.roles["gear"])
        assert role is not None
        assert model.components[flanks.roles[role]].text(Term("custom_easeoff_flank", "none")) == loaded


def test_points_lie_on_the_gear_flank_and_have_the_values_of_the_result(model: Model, tree: xr.DataTree) -> None:
    points, values = only(model, "point_list"), only(model, "meshing_contact_stage_data_set")
    u, v, w = (column(points, f"point_coordinates_{axis}_coord", "mm") for axis in "uvw")
    member = gear_pair(small("fm-11x41", "shell")).gear
    on = solve_flank(member.loaded, member.section, u, np.hypot(v, w)).position
    np.testing.assert_allclose([w, -v, u], on, rtol=0, atol=1e-3)
    at = {"torque": 1, "speed": 0, "temperature": 0, "roughness": 0}
    loaded, friction = (tree[group].to_dataset() for group in ("loaded", "friction"))
    loaded, friction = loaded.isel(torque=1), friction.isel(at)
    kept = (loaded["force"].values > 0.0) & np.isfinite(loaded["pressure"].values)
    assert np.count_nonzero(kept) == u.size
    for name, unit, expected in (
        ("local_hertzian_contact_stress", "MPa", loaded["pressure"]),
        ("local_normal_line_load", "N / mm", loaded["force"] / loaded["length"]),
        ("local_coefficient_of_friction", "none", friction["friction_coefficient"]),
        ("local_relative_lubricant_filmthickness", "none", friction["lambda_ratio"]),
        ("local_sliding_velocity", "m / s", friction["sliding_velocity"]),
        ("local_flash_temperature_blok_1937", "K", friction["flash_temperature"]),
    ):
        np.testing.assert_allclose(column(values, name, unit), expected.values[kept], rtol=1e-12)
    ease_off = tree["ease_off"].to_dataset()
    places = np.stack([loaded[name].values[kept] for name in ("lengthwise", "profile")], axis=-1)
    near = RegularGridInterpolator(
        (ease_off["lengthwise"].values, ease_off["profile"].values), ease_off["ease_off"].values
    )
    gap = 1e-3 * near(places)
    found, known = column(values, "ease_off", "mm"), np.isfinite(gap)
    np.testing.assert_allclose(found[known], gap[known], rtol=0, atol=5e-4)
    assert np.ptp(gap[known]) > 0.01


def test_the_case_of_the_file_has_the_misalignment_of_the_result(tree: xr.DataTree, tmp_path: Path) -> None:
    moved = tree.copy()
    moved.attrs = {**tree.attrs, "misalignment_offset_mm": 0.05, "misalignment_shaft_angle_rad": np.radians(0.1)}
    export_contact(moved, tmp_path / "pair.rexs")
    case, _ = read_rexs(tmp_path / "pair.rexs")
    assert case.misalignment.offset == 0.05
    assert case.misalignment.shaft_angle == pytest.approx(0.1, rel=1e-12)
    assert case.gear.convex == small("fm-11x41", "shell").gear.convex


def test_a_torque_without_contact_is_refused(tree: xr.DataTree, tmp_path: Path) -> None:
    empty = tree.copy()
    empty["loaded"] = xr.DataTree(tree["loaded"].to_dataset().assign(force=0.0 * tree["loaded"]["force"]))
    with pytest.raises(InputError, match="torque = 100: must be one with contact in the result"):
        export_contact(empty, tmp_path / "pair.rexs")
    assert list(tmp_path.iterdir()) == []


def test_the_least_backlash_stands_at_the_stage_and_at_the_gear(tree: xr.DataTree, tmp_path: Path) -> None:
    where = {"mean_normal": "bevel_stage", "outer_normal": "bevel_stage", "mean_transverse": "bevel_gear"}
    where["outer_transverse"] = "bevel_gear"
    known = tree.copy()
    columns = {
        f"{name}_backlash": ("mesh_position", [0.3, np.nan, 0.1 + 0.01 * at, 0.2]) for at, name in enumerate(where)
    }
    known["backlash"] = xr.DataTree(xr.Dataset(columns))
    export_contact(known, tmp_path / "pair.rexs")
    model = read_model(tmp_path / "pair.rexs")
    for at, (name, kind) in enumerate(where.items()):
        holders = [c for c in model.components.values() if f"{name}_backlash" in c.attributes]
        assert [(c.kind, c.number_of(Term(f"{name}_backlash", "mm"))) for c in holders] == [(kind, 0.1 + 0.01 * at)]
        assert kind == "bevel_stage" or holders[0].name == "gear"
