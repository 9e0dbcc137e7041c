"""Meshes of surface patches: closed bodies with known volume, outward orientation, whole members, real flanks."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from closed_teeth import closed_tooth, ring_segment
from mesh_reader import read_mesh
from numpy.typing import NDArray
from runs import output_of

from easeoff import GeometryError, InputError
from easeoff.cases import gear_pair, read_case
from easeoff.geometry import GearPair, tooth_angle, tooth_patches
from easeoff.geometry.formats import write_mesh
from easeoff.geometry.formats.step import merged, oriented
from easeoff.geometry.tooth.tooth_flanks import placed_flanks

Array = NDArray[Any]


@pytest.fixture(scope="module")
def pair() -> GearPair:
    return gear_pair(read_case("fm-11x41"))


def volume(points: Array, triangles: Array) -> float:
    """Signed volume: positive for a closed surface that looks outwards."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    return float(np.sum(np.cross(a, b) * c)) / 6.0


def halves(quads: Array) -> Array:
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def directed_edges(cells: Array) -> Array:
    return np.concatenate([cells[:, [i, (i + 1) % cells.shape[1]]] for i in range(cells.shape[1])])


@pytest.mark.parametrize("suffix", [".stl", ".vtk", ".vtu"])
def test_closed_body_has_its_volume(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"ring{suffix}"
    write_mesh(ring_segment(41), path)
    found = read_mesh(path)
    triangles = found.cells if suffix == ".stl" else halves(found.cells)
    exact = 0.5 * math.pi / 6 * (12.0**2 - 10.0**2) * 3.0
    # Chords of the circles: the error is (angle between the nodes)^2 / 6.
    assert volume(found.points, triangles) == pytest.approx(exact, rel=(math.pi / 6 / 42) ** 2 / 5)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("flipped", [("top",), ("inner", "start", "end"), ("top", "bottom", "inner", "start", "end")])
def test_patches_are_turned_to_agree_with_the_first(flipped: tuple[str, ...], tmp_path: Path) -> None:
    patches = {name: points[:, ::-1] if name in flipped else points for name, points in ring_segment().items()}
    write_mesh(patches, tmp_path / "ring.vtu")
    found = read_mesh(tmp_path / "ring.vtu")
    assert volume(found.points, halves(found.cells)) > 0.0
    edges = directed_edges(found.cells)
    # Closed and consistent: every edge is passed once in each direction.
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert {tuple(edge) for edge in edges.tolist()} == {tuple(edge[::-1]) for edge in edges.tolist()}


def test_members_close_where_their_teeth_meet(tmp_path: Path) -> None:
    """Twelve segments of 30 degrees are a whole ring; the borders between them fall together."""
    segment = {name: points for name, points in ring_segment().items() if name not in ("start", "end")}
    write_mesh(segment, tmp_path / "ring.vtu", teeth=12)
    found = read_mesh(tmp_path / "ring.vtu")
    cells = found.cells
    edges = directed_edges(cells)
    assert {tuple(edge) for edge in edges.tolist()} == {tuple(edge[::-1]) for edge in edges.tolist()}
    assert volume(found.points, halves(cells)) == pytest.approx(math.pi * 44.0 * 3.0, rel=1e-3)
    assert np.bincount(found.data["tooth"]).tolist() == [len(cells) // 12] * 12


def test_cells_know_their_patch(tmp_path: Path) -> None:
    patches = ring_segment()
    for suffix in (".vtk", ".vtu"):
        write_mesh(patches, tmp_path / f"x{suffix}", teeth=2, pitch=1.0)
        found = read_mesh(tmp_path / f"x{suffix}")
        number, tooth = found.data["patch"], found.data["tooth"]
        middle = found.points[found.cells].mean(axis=1)
        outer = number == list(patches).index("outer")
        np.testing.assert_allclose(np.hypot(middle[outer, 0], middle[outer, 1]), 12.0, atol=0.01)
        assert np.array_equal(found.data["outer"] == 1, outer)
        angle = np.arctan2(middle[:, 1], middle[:, 0])
        for which in (0, 1):
            assert angle[tooth == which].min() == pytest.approx(which)
            assert angle[tooth == which].max() == pytest.approx(which + math.pi / 6)


@pytest.mark.parametrize("suffix", [".vtk", ".vtu"])
def test_a_patch_may_have_any_name(suffix: str, tmp_path: Path) -> None:
    name = 'left & "right" <flank>, 50 %'
    write_mesh({name: ring_segment()["outer"]}, tmp_path / f"x{suffix}")
    assert list(read_mesh(tmp_path / f"x{suffix}").data) == ["patch", "tooth", name]


def test_border_without_length_makes_no_empty_triangle(tmp_path: Path) -> None:
    """A disc: one border is its centre, and two borders are the same line."""
    radius, angle = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 2.0 * math.pi, 33)
    disc = np.stack([np.outer(radius, np.cos(angle)), np.outer(radius, np.sin(angle)), np.zeros((5, 33))], axis=-1)
    write_mesh({"disc": disc}, tmp_path / "disc.stl")
    found = read_mesh(tmp_path / "disc.stl")
    a, b, c = found.points[found.cells].transpose(1, 0, 2)
    area = 0.5 * np.cross(b - a, c - a)
    assert np.all(area[:, 2] > 1e-4)
    assert area[:, 2].sum() == pytest.approx(16.0 * math.sin(2.0 * math.pi / 32), rel=1e-6)
    assert len(area) == 32 * 7


@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_tooth_between_its_flanks_has_its_volume(name: str, tmp_path: Path) -> None:
    closed, exact = closed_tooth(gear_pair(read_case("nasa-12x36")), name, (41, 21))
    write_mesh(closed, tmp_path / "tooth.stl")
    found = read_mesh(tmp_path / "tooth.stl")
    assert volume(found.points.astype(float), found.cells) == pytest.approx(exact, rel=1e-3)


def test_points_fall_together_within_rounding_only() -> None:
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1e-9], [0.0, 0.0, 1e-4], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    kept, number = merged(points)
    assert len(kept) == 3
    assert number[0] == number[1] == number[4]
    np.testing.assert_allclose(kept[number], points, atol=1e-8)


@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_flanks_look_out_of_the_tooth(pair: GearPair, name: str, tmp_path: Path) -> None:
    """Triangles against the exact normals of the flanks at their middles."""
    patches = tooth_patches(pair, name, (31, 15))
    write_mesh({key: points for key, points in patches.items() if key.endswith("flank")}, tmp_path / "x.stl")
    found = read_mesh(tmp_path / "x.stl")
    a, b, c = found.points[found.cells].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    middle = (a + b + c) / 3.0
    flanks = placed_flanks(getattr(pair, name), tooth_angle(pair, name))
    best = np.full(len(middle), np.inf)
    agreement = np.zeros(len(middle))
    for flank in flanks.values():
        exact = flank.at(middle[:, 2], np.hypot(middle[:, 0], middle[:, 1]))
        distance = np.linalg.norm(exact.position.T - middle, axis=1)
        nearer = distance < best
        best[nearer] = distance[nearer]
        agreement[nearer] = np.sum(exact.normal.T * normal, axis=1)[nearer]
    assert np.max(best) < 0.02
    assert np.min(agreement) > 0.998


def test_flanks_of_the_whole_member_turn_by_its_pitch(pair: GearPair, tmp_path: Path) -> None:
    said = output_of(
        "export", "fm-11x41", "-o", tmp_path / "x.vtu", "--teeth", "all", "--nodes", "9x7", "--flank", "convex"
    )
    assert "11 of 11 teeth of the pinion: convex_flank, convex_fillet, convex_root_land" in said
    found = read_mesh(tmp_path / "x.vtu")
    first = tooth_patches(pair, "pinion", (9, 7))["convex_flank"].reshape(-1, 3)
    chosen = found.data["convex_flank"] == 1
    tooth, cells = found.data["tooth"][chosen], found.cells[chosen]
    for number in range(11):
        points = found.points[np.unique(cells[tooth == number])]
        turned = 2.0 * math.pi * number / 11
        cosine, sine = math.cos(turned), math.sin(turned)
        expected = first @ np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        gap = np.linalg.norm(points[:, None] - expected[None], axis=-1).min(axis=1)
        assert len(points) == len(first)
        assert gap.max() < 1e-9


@pytest.mark.parametrize(
    ("patches", "words"),
    [
        ({}, "no surface patches"),
        ({"a": np.zeros((4, 3))}, r"'a' has the shape \(4, 3\)"),
        ({"a": np.zeros((1, 4, 3))}, "m and n at least 2"),
        ({"a": np.full((4, 4, 3), np.nan)}, "'a' has points that are no finite numbers"),
        ({"edge": np.arange(12.0).reshape(4, 1, 3).repeat(2, axis=1)}, "'edge' has no area"),
    ],
)
def test_what_is_no_surface_is_refused(patches: dict[str, Array], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        write_mesh(patches, tmp_path / "x.stl")
    assert list(tmp_path.iterdir()) == []


def test_one_sided_surface_is_refused() -> None:
    """A Moebius band of two patches."""
    angle, across = np.linspace(0.0, 2.0 * math.pi, 41), np.linspace(-1.0, 1.0, 5)
    half, arm = np.outer(0.5 * angle, np.ones(5)), 5.0 + np.outer(np.cos(0.5 * angle), across)
    band = np.stack([arm * np.cos(2 * half), arm * np.sin(2 * half), np.sin(half) * across], axis=-1)
    with pytest.raises(InputError, match="one side only"):
        oriented({"a": band[:21], "b": band[20:]})


def test_other_suffixes_teeth_and_members_are_refused(pair: GearPair, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.stl, \.vtk, \.vtu"):
        write_mesh(ring_segment(), tmp_path / "x.obj")
    with pytest.raises(InputError, match="teeth = 0"):
        write_mesh(ring_segment(), tmp_path / "x.stl", teeth=0)
    with pytest.raises(InputError, match="must be one of pinion, gear"):
        tooth_patches(pair, "wheel", (9, 7))
    with pytest.raises(InputError, match=r"nodes\[1\] = 4: must be a whole number of 5 or more"):
        tooth_patches(pair, "gear", (9, 4))


@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_whole_member_is_one_surface(name: str, tmp_path: Path) -> None:
    """Flanks, fillets and lands of all teeth share their borders: only the toe and the heel are open."""
    pair = gear_pair(read_case("nasa-12x36"))
    write_mesh(tooth_patches(pair, name, (9, 7)), tmp_path / "x.vtu", teeth=getattr(pair, name).teeth)
    found = read_mesh(tmp_path / "x.vtu")
    edges = directed_edges(found.cells)
    both = {tuple(edge) for edge in edges.tolist()}
    open_ends = np.unique([edge for edge in both if edge[::-1] not in both])
    section = getattr(pair, name).section
    x, y, z = found.points[open_ends].T
    lengthwise, _ = section.fractions(z, np.hypot(x, y))
    np.testing.assert_allclose(np.minimum(lengthwise, 1.0 - lengthwise), 0.0, atol=1e-3)


def test_teeth_too_thick_for_the_pitch_leave_no_pinion(pair: GearPair) -> None:
    from dataclasses import replace

    fat = replace(pair, gear=replace(pair.gear, mean_thickness=40.0))
    with pytest.raises(GeometryError, match="tooth of the pinion would be -"):
        tooth_patches(fat, "pinion", (9, 7))
