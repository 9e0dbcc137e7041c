"""STEP files, read back by OpenCASCADE: distance from the true surface, sewing, names, units, copies."""

from __future__ import annotations

import builtins
import math
import re
import sys
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from closed_teeth import closed_tooth, ring_segment
from numpy.typing import NDArray
from runs import output_of, refusal_of

from easeoff import InputError, MissingPackageError
from easeoff.cases import gear_pair, read_case
from easeoff.geometry import tooth_angle, tooth_patches
from easeoff.geometry.formats import write_step
from easeoff.geometry.formats.step import require_opencascade, spline
from easeoff.geometry.tooth.tooth_flanks import placed_flanks

Array = NDArray[Any]


def read(path: Path) -> Any:
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    assert reader.ReadFile(str(path)) == IFSelect_RetDone
    reader.TransferRoots()
    return reader


def shape_of(path: Path) -> Any:
    return read(path).OneShape()


def faces_of(path: Path) -> dict[str, list[Any]]:
    """Faces by their names in the file."""
    reader = read(path)
    found: dict[str, list[Any]] = {}
    for face in parts(reader.OneShape(), "FACE"):
        entity = reader.WS().TransferReader().EntityFromShapeResult(face, -1)
        found.setdefault(entity.Name().ToCString(), []).append(face)
    return found


def parts(shape: Any, kind: str) -> list[Any]:
    """Sub-shapes of one kind, each as often as it occurs."""
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    found, explorer = [], TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}"))
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def feet(face: Any, points: Array) -> tuple[Array, Array]:
    """Distances [mm] from points (n, 3) to a face inside its borders, and outward normals at the feet (n, 3)."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepTools import BRepTools
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.GeomLProp import GeomLProp_SLProps
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_Orientation
    from OCP.TopoDS import TopoDS

    face = TopoDS.Face(face)
    surface = BRep_Tool.Surface_s(face)
    bounds = BRepTools.UVBounds_s(face)
    sense = -1.0 if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED else 1.0
    distances, normals = [], []
    for point in points.tolist():
        found = GeomAPI_ProjectPointOnSurf(gp_Pnt(*point), surface, *bounds)
        distances.append(found.LowerDistance())
        u, v = found.LowerDistanceParameters()
        normal = GeomLProp_SLProps(surface, u, v, 1, 1e-9).Normal()
        normals.append([sense * normal.X(), sense * normal.Y(), sense * normal.Z()])
    return np.array(distances), np.array(normals)


def measure(shape: Any, of: Literal["Surface", "Volume"]) -> float:
    """Area, or volume: positive for a closed surface that looks outwards."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    getattr(BRepGProp, f"{of}Properties_s")(shape, properties)
    return float(properties.Mass())


@pytest.mark.parametrize("case", ["fm-11x41", "nasa-12x36"])
@pytest.mark.parametrize("name", ["pinion", "gear"])
@pytest.mark.quick(1)
def test_faces_lie_within_a_fifth_of_a_micrometre_of_the_true_flanks(case: str, name: str, tmp_path: Path) -> None:
    """Points of the exact flanks between the nodes, edges included, projected onto the faces read back."""
    pair = gear_pair(read_case(case))
    patches = tooth_patches(pair, name, (61, 31))
    write_step(patches, tmp_path / "tooth.step")
    faces = faces_of(tmp_path / "tooth.step")
    assert set(faces) == set(patches)
    for side, flank in placed_flanks(getattr(pair, name), tooth_angle(pair, name)).items():
        (face,) = faces[f"{side}_flank"]
        nodes = patches[f"{side}_flank"]
        # The lowest row tells where the flank begins.
        _, low = flank.section.fractions(nodes[..., 2], np.hypot(nodes[..., 0], nodes[..., 1]))
        t, h = np.meshgrid(np.linspace(0, 1, 7), np.linspace(float(low[:, 0].max()), 1, 5), indexing="ij")
        exact = flank.at(*flank.section.points(t.ravel(), h.ravel()))
        distance, normal = feet(face, exact.position.T)
        assert np.max(distance) < 2e-4
        assert (
            np.min(np.sum(normal * exact.normal.T, axis=1)) > 1.0 - 1e-4
        )  # next to undercut a flank bends within one spacing of the nodes


@pytest.mark.thorough
def test_faces_converge_with_fourth_order(tmp_path: Path) -> None:
    """Cubic splines through a torus: the distance falls with the fourth power of the distance of the nodes."""
    errors = []
    for count in (11, 21, 41):
        patch = torus(np.linspace(0.2, 1.4, count), np.linspace(-0.5, 1.0, count))
        write_step({"torus": patch}, tmp_path / "torus.step")
        (face,) = parts(shape_of(tmp_path / "torus.step"), "FACE")
        true = torus(np.linspace(0.2, 1.4, 23), np.linspace(-0.5, 1.0, 19)).reshape(-1, 3)
        errors.append(feet(face, true)[0].max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 3.5), errors


def torus(about: Array, round_: Array) -> Array:
    a, b = np.meshgrid(about, round_, indexing="ij")
    arm = 20.0 + 5.0 * np.cos(b)
    return np.stack([arm * np.cos(a), arm * np.sin(a), 5.0 * np.sin(b)], axis=-1)


def test_spline_goes_through_every_point() -> None:
    from scipy.interpolate import NdBSpline

    points = np.random.default_rng(1).normal(size=(9, 6, 3))
    for grid in (points, points[:, :2], points[:3, :3], points.transpose(1, 0, 2)):
        poles, knots, degrees = spline(grid)
        assert degrees == tuple(min(3, size - 1) for size in grid.shape[:2])
        u, v = (np.linspace(0.0, 1.0, size) for size in grid.shape[:2])
        nodes = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)
        np.testing.assert_allclose(NdBSpline(tuple(knots), poles, degrees)(nodes), grid, rtol=0, atol=1e-12)


def test_neighbours_are_sewn_into_one_closed_shell(tmp_path: Path) -> None:
    from OCP.BRep import BRep_Tool

    patches = {name: points[:, ::-1] if name == "end" else points for name, points in ring_segment().items()}
    write_step(patches, tmp_path / "ring.stp")
    shape = shape_of(tmp_path / "ring.stp")
    (shell,) = parts(shape, "SHELL")
    assert BRep_Tool.IsClosed_s(shell)
    assert len(parts(shape, "FACE")) == 6
    # Six faces of four edges, each edge shared by two.
    edges = parts(shape, "EDGE")
    assert len(edges) == 24
    assert all(sum(edge.IsSame(other) for other in edges) == 2 for edge in edges)
    exact = math.pi / 6 * (44.0 + 3.0 * 22.0) + 2 * 6.0
    assert measure(shape, "Surface") == pytest.approx(exact, rel=1e-6)
    for name, (face,) in faces_of(tmp_path / "ring.stp").items():
        points = ring_segment()[name]
        inner = points[1:-1, 1:-1].reshape(-1, 3)
        distance, normal = feet(face, inner)
        assert np.max(distance) < 1e-6, name
        centre = np.array([11.0 * math.cos(math.pi / 12), 11.0 * math.sin(math.pi / 12), 1.5])
        assert np.all(np.sum(normal * (inner - centre), axis=1) > 0.0), name


@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_tooth_between_its_flanks_is_closed_and_has_its_volume(name: str, tmp_path: Path) -> None:
    """Curved borders of real flanks are sewn; the volume shows that both flanks stand in their places."""
    from OCP.BRep import BRep_Tool

    closed, exact = closed_tooth(gear_pair(read_case("nasa-12x36")), name, (41, 21))
    write_step(closed, tmp_path / "tooth.step")
    shape = shape_of(tmp_path / "tooth.step")
    (shell,) = parts(shape, "SHELL")
    assert BRep_Tool.IsClosed_s(shell)
    edges = parts(shape, "EDGE")
    assert all(sum(edge.IsSame(other) for other in edges) == 2 for edge in edges)
    assert measure(shape, "Volume") == pytest.approx(exact, rel=1e-6)
    assert set(faces_of(tmp_path / "tooth.step")) == set(closed)


def test_names_units_and_schema_are_in_the_file(tmp_path: Path) -> None:
    write_step(ring_segment(), tmp_path / "ring.step", teeth=3, name="a ring")
    text = (tmp_path / "ring.step").read_text()
    assert sorted(re.findall(r"ADVANCED_FACE\('(\w+)'", text)) == sorted(ring_segment())
    assert "AUTOMOTIVE_DESIGN" in text
    assert "SI_UNIT(.MILLI.,.METRE.)" in text
    assert re.search(r"PRODUCT\('a ring','a ring'", text)


def test_copies_stand_a_pitch_apart(tmp_path: Path) -> None:
    """The further teeth refer to the first one: the file hardly grows."""
    write_step(ring_segment(), tmp_path / "one.step")
    write_step(ring_segment(), tmp_path / "five.step", teeth=5, pitch=1.0)
    assert (tmp_path / "five.step").stat().st_size < 1.5 * (tmp_path / "one.step").stat().st_size
    shape = shape_of(tmp_path / "five.step")
    assert len(parts(shape, "SHELL")) == 5
    assert measure(shape, "Surface") == pytest.approx(
        5.0 * measure(shape_of(tmp_path / "one.step"), "Surface"), rel=1e-9
    )
    outer = ring_segment()["outer"][2:-2:2, 2:-2:2].reshape(-1, 3)
    for number, face in enumerate(faces_of(tmp_path / "five.step")["outer"]):
        cosine, sine = math.cos(number), math.sin(number)
        turned = outer @ np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        assert np.max(feet(face, turned)[0]) < 1e-6


def test_border_without_length_is_no_obstacle(tmp_path: Path) -> None:
    """A spherical cap: all points of one border are the pole."""
    polar, about = np.linspace(0.0, 0.8, 15), np.linspace(0.0, 1.2, 15)
    p, a = np.meshgrid(polar, about, indexing="ij")
    cap = 7.0 * np.stack([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)], axis=-1)
    write_step({"cap": cap}, tmp_path / "cap.step")
    assert measure(shape_of(tmp_path / "cap.step"), "Surface") == pytest.approx(
        49.0 * 1.2 * (1.0 - math.cos(0.8)), rel=1e-5
    )


def test_command_writes_and_says_nothing_else(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "gear.step"
    said = output_of("export", "fm-11x41", "-o", path, "--member", "gear", "--teeth", "all")
    sides = [f"{side}_{part}" for side in ("convex", "concave") for part in ("flank", "fillet", "root_land")]
    patches = ", ".join([*sides, "top_land"])
    assert said == f"wrote {path}: 41 of 41 teeth of the gear: {patches}\n"
    assert capfd.readouterr().out == ""
    assert len(parts(shape_of(path), "FACE")) == 7 * 41
    assert [p.name for p in tmp_path.iterdir()] == ["gear.step"]


def test_without_opencascade_the_message_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "OCP.collections", None)
    with pytest.raises(MissingPackageError, match=r"easeoff\[cad\] installs it: .* install .*\[cad\]"):
        write_step(ring_segment(), tmp_path / "x.step")
    assert "easeoff[cad]" in refusal_of("export", "fm-11x41", "-o", tmp_path / "x.step")
    assert list(tmp_path.iterdir()) == []


def test_other_suffixes_and_patches_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.step or \.stp"):
        write_step(ring_segment(), tmp_path / "x.iges")
    with pytest.raises(InputError, match="no finite numbers"):
        write_step({"a": np.full((4, 4, 3), np.nan)}, tmp_path / "x.step")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("interrupted", [True, False])
def test_only_a_missing_package_is_called_missing(interrupted: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Control-C while it loads, and a system library it lacks, are no reasons to install what is there."""
    real = builtins.__import__

    def fails(name: str, *arguments: Any, **more: Any) -> Any:
        if name.startswith("OCP"):
            raise ImportError("initialization failed") from (KeyboardInterrupt() if interrupted else None)
        return real(name, *arguments, **more)

    monkeypatch.setattr(builtins, "__import__", fails)
    expected: Any = KeyboardInterrupt if interrupted else MissingPackageError
    with pytest.raises(expected) as caught:
        require_opencascade()
    assert "installs it" not in str(caught.value)
    assert interrupted or "does not load: initialization failed" in str(caught.value)
