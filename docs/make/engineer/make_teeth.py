"""Draw docs/images/teeth.png, the pair nasa-12x36 in mesh: python docs/make teeth."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from dissertation_figures import save_small
from folders import IMAGES
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from easeoff.cases import case_text, gear_pair, parse_case
from easeoff.geometry import BlankSection, GearPair, tooth_patches
from easeoff.geometry.formats.step import oriented, rotations
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.gear_pair import grid
from easeoff.geometry.tooth.tooth_flanks import MemberName, named_member
from easeoff.geometry.vectors import rotate, rotate_z
from easeoff.verification.conventional_analysis import path_of_contact

Array = NDArray[Any]

EDGE_RADIUS = 0.6  # [mm]; the case has none, and a whole tooth needs its fillet
NODES = (41, 15)
RIM = 7.0  # depth of the blank below the root line [mm]
HUB = {"pinion": 0.0, "gear": 1e3}  # radius [mm] to which the ends are closed; the gear stays a ring
COLOURS = {"pinion": np.array([0.30, 0.50, 0.68]), "gear": np.array([0.72, 0.73, 0.74])}
LIGHT, AMBIENT, SHINE = np.array([0.25, 0.60, 0.75]), 0.50, 0.18
WIDTH, DPI, FINER = 8.6, 128, 3  # [in]; drawn finer by this factor than it is written


@dataclass(frozen=True)
class Camera:
    """A view from far away, its axes in the global frame.

    Parameters
    ----------
    right, up, towards
        Unit vectors (3) of the picture's right and top and towards the eye.
    """

    right: Array
    up: Array
    towards: Array

    @classmethod
    def looking(cls, azimuth: float, elevation: float) -> Camera:
        """From the side of the gear's teeth: azimuth in the plane of the gear, elevation above it [rad]."""
        # The gear's teeth look against its axis.
        up = np.array([0.0, 0.0, -1.0])
        level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        towards = np.cos(elevation) * level + np.sin(elevation) * up
        right = np.cross(up, towards)
        right /= np.linalg.norm(right)
        return cls(right, np.cross(towards, right), towards)


def whole_pair() -> GearPair:
    """The pair with an edge radius on all its cutters."""
    text = re.sub(r"(blade_pressure_angle = .*)", rf"\1\ntool_edge_radius = {EDGE_RADIUS}", case_text("nasa-12x36"))
    return gear_pair(parse_case(text))


def closed(patches: dict[str, Array], section: BlankSection, hub: float) -> dict[str, Array]:
    """The patches of a tooth, and what closes them at toe and heel down to the rim and on to a hub of some radius."""
    root = section.points(np.array([0.0, 1.0]), np.zeros(2))  # (axial and radial, toe and heel)
    tip = section.points(np.array([0.5]), np.ones(1))[:, 0]
    along = root[:, 1] - root[:, 0]
    down = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    down *= -np.sign(down @ (tip - root[:, 0]))
    result = oriented(patches)
    for name, points in list(result.items()):
        for end, side in ((0, "toe"), (-1, "heel")):
            # Patches that were turned round run from heel to toe.
            index = end if _from_toe(points) else -1 - end
            border = points[index]
            outline = np.stack([border[:, 2], np.hypot(border[:, 0], border[:, 1])])
            rim = root[:, end] + RIM * down
            rows = _rows(outline, rim, 16)
            if hub < rim[1]:
                rows = np.concatenate([rows, _rows(rows[-1], np.array([rim[0], hub]), 6)[1:]])
            azimuth = np.arctan2(border[:, 1], border[:, 0])
            cap = np.stack([rows[:, 1] * np.cos(azimuth), rows[:, 1] * np.sin(azimuth), rows[:, 0]], axis=-1)
            result[f"{name}_{side}"] = cap[::-1] if index == 0 else cap
    return result


def _rows(start: Array, end: Array, count: int) -> Array:
    """Axial and radial coordinates (count, 2, n) [mm] from an outline (2, n) to one place (2)."""
    share = np.linspace(0.0, 1.0, count)[:, None, None]
    return (1.0 - share) * start + share * end[:, None]


def _from_toe(points: Array) -> bool:
    return bool(np.linalg.norm(points[0], axis=-1).mean() < np.linalg.norm(points[-1], axis=-1).mean())


def quads(patches: dict[str, Array], teeth: int) -> Array:
    """Corners (n, 4, 3) of the quadrilaterals of all teeth [mm], anticlockwise seen from outside."""
    one = np.concatenate(
        [np.stack([p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]], axis=2).reshape(-1, 4, 3) for p in patches.values()]
    )
    points = one.reshape(-1, 3).T
    return np.concatenate([rotate_z(np.full(points.shape[1], a), points).T for a in rotations(teeth, None)]).reshape(
        -1, 4, 3
    )


def in_mesh(pair: GearPair, corners: dict[str, Array]) -> dict[str, Array]:
    """The quadrilaterals of both members in the global frame, at a moment of contact in the middle of the flank."""
    gear = pair.gear.flank(*grid((15, 9)))
    surface = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    contact = path_of_contact(gear, surface, np.zeros(1))
    motion, turn = surface.motion, contact.pinion_rotation
    placed = {}
    for member, points in corners.items():
        flat = points.reshape(-1, 3).T
        if member == "pinion":
            there, _ = pair.assembly.pinion_to_global(flat, flat)
            origin = pair.assembly.pinion_origin[:, None]
            flat = rotate(motion.pinion_axis, turn, there - origin) + origin
        else:
            flat = rotate(motion.gear_axis, turn / pair.assembly.ratio - contact.closing_angle, flat)
        placed[member] = flat.T.reshape(-1, 4, 3)
    return placed


def shaded(corners: Array, colour: Array, camera: Camera) -> tuple[Array, Array, Array]:
    """Visible quadrilaterals in the picture (n, 4, 2), their colours (n, 3) and distances towards the eye (n)."""
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    size = np.linalg.norm(normal, axis=1)
    seen = (size > 1e-9) & (normal @ camera.towards > 0.0)
    corners, normal = corners[seen], normal[seen] / size[seen, None]
    light = LIGHT @ np.stack([camera.right, camera.up, camera.towards])
    light /= np.linalg.norm(light)
    half = light + camera.towards
    half /= np.linalg.norm(half)
    diffuse = np.clip(normal @ light, 0.0, None)
    shine = np.clip(normal @ half, 0.0, None) ** 24
    colours = np.clip((AMBIENT + (1.0 - AMBIENT) * diffuse)[:, None] * colour + SHINE * shine[:, None], 0.0, 1.0)
    flat = np.stack([corners @ camera.right, corners @ camera.up], axis=-1)
    return flat, colours, corners.mean(axis=1) @ camera.towards


def draw() -> Figure:
    """Draw the pair."""
    pair = whole_pair()
    members: tuple[MemberName, ...] = ("pinion", "gear")
    corners: dict[str, Array] = {}
    for member in members:
        which = named_member(pair, member)
        corners[member] = quads(closed(tooth_patches(pair, member, NODES), which.section, HUB[member]), which.teeth)
    camera = Camera.looking(np.radians(122.0), np.radians(36.0))
    parts = [shaded(points, COLOURS[member], camera) for member, points in in_mesh(pair, corners).items()]
    flat, colours, depth = (np.concatenate(values) for values in zip(*parts, strict=True))
    order = np.argsort(depth)  # the far ones first
    low, high = flat.min(axis=(0, 1)) - 2.0, flat.max(axis=(0, 1)) + 2.0
    figure = Figure(
        figsize=(WIDTH, WIDTH * (high[1] - low[1]) / (high[0] - low[0])), dpi=FINER * DPI, facecolor="white"
    )
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.add_collection(
        PolyCollection(list(flat[order]), facecolors=colours[order], edgecolors=colours[order], linewidths=0.2)
    )
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.axis("off")
    return figure


if __name__ == "__main__":
    save_small(draw(), IMAGES / "teeth.png", FINER)
    print("wrote docs/images/teeth.png")
