"""The contact without the split against other computations. Prints Markdown tables.

``python benchmarks/flank_contact.py [calculix] [patch]``: both if none is named. ``calculix`` presses two blocks
together in CalculiX (``ccx``); ``patch`` loads a spot on a generated tooth, with bricks small enough to see it.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from tabulate import tabulate

from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL
from easeoff.contact.compliance.finite_elements.elastic_body import elastic_body
from easeoff.contact.compliance.finite_elements.elastic_body import quadratic
from easeoff.verification import flank_response
from easeoff.verification.surface_cells import SurfaceCells
from easeoff.verification.flank_contact import half_space_compliance
from easeoff.geometry.tooth.tooth_lattice import LatticeSpacing
from easeoff.geometry.tooth.tooth_lattice import with_middles
from easeoff.geometry import LatticeSize, tooth_lattice

BLOCK, RADII, CLOSURE = (6.0, 8.0, 8.0), (12.0, 600.0), 0.012  # half sides and height, radii, approach [mm]
SPOT = (1.0, 0.3)  # half sides of the loaded spot along the face and up the flank, about [mm]


def steps(fine: float, count: int, end: float, ratio: float) -> np.ndarray:
    """Places from zero, even up to ``fine``, then growing."""
    places, step = np.linspace(0.0, fine, count + 1).tolist(), fine / count
    while places[-1] < end:
        step *= ratio
        places.append(places[-1] + step if places[-1] + 1.6 * step < end else end)
    return np.array(places)


def calculix() -> None:
    """Force at 12 um of approach of two blocks, one crowned; a quarter of them in eight-node bricks."""
    rows = []
    for fineness, stiffness in ((0.7, 1e7), (1.2, 1e7)):
        axes = (
            steps(0.42, int(10 * fineness), BLOCK[0], 1.35),
            steps(4.2, int(12 * fineness), BLOCK[1], 1.5),
            steps(0.08, int(2 * fineness), BLOCK[2], 1.35),
        )
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "blocks.inp").write_text(deck(axes, stiffness))
            subprocess.run(["ccx", "blocks"], cwd=folder, check=True, capture_output=True)
            lines = Path(folder, "blocks.dat").read_text().splitlines()
        force = next(lines[i + 2] for i, line in enumerate(lines) if "total force" in line)
        rows.append([6 * np.prod([a.size for a in axes]), f"{stiffness:g}", -4.0 * float(force.split()[2])])
    print(tabulate(rows, ["unknowns", "N/mm^3", "force N"], "github", ".1f"))


def deck(axes: tuple[np.ndarray, ...], stiffness: float) -> str:
    """Input of CalculiX: lower block flat, upper one crowned, both a quarter, x and y planes of symmetry."""
    x, y, depth = np.meshgrid(*axes, indexing="ij")
    rise = 0.5 * x**2 / RADII[0] + 0.5 * y**2 / RADII[1]
    number = np.arange(x.size).reshape(x.shape) + 1
    numbers = (number, number + x.size)
    heights = (-depth, rise + (BLOCK[2] - rise) * depth / BLOCK[2])
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    lines, surfaces = ["*NODE"], []
    for ids, z in zip(numbers, heights, strict=True):
        table = zip(ids.ravel(), x.ravel(), y.ravel(), z.ravel(), strict=True)
        lines += [f"{n}, {a:.12e}, {b:.12e}, {c:.12e}" for n, a, b, c in table]
    for block, ids in enumerate(numbers):
        ends = [ids[i : i - 1 or None, j : j - 1 or None, k : k - 1 or None] for i, j, k in corners]
        bricks = np.stack(ends if block else ends[4:] + ends[:4], axis=-1)
        elements = np.arange(bricks[..., 0].size).reshape(bricks.shape[:3]) + 1 + block * bricks[..., 0].size
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET=BLOCK{block}")
        numbered = zip(elements.ravel(), bricks.reshape(-1, 8), strict=True)
        lines += [f"{e}, " + ", ".join(map(str, brick)) for e, brick in numbered]
        wide, long = np.searchsorted(axes[0], 1.5) + 1 - block, np.searchsorted(axes[1], 7.0) + 1 - block
        surfaces += [f"*SURFACE, NAME=SURFACE{block}"]
        surfaces += [f"{e}, S{2 - block}" for e in elements[:wide, :long, 0].ravel()]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{STEEL.elastic_modulus}, {STEEL.poisson_ratio}"]
    lines += [f"*SOLID SECTION, ELSET=BLOCK{block}, MATERIAL=STEEL" for block in range(2)] + surfaces
    sets = {
        "SIDE": np.concatenate([ids[0].ravel() for ids in numbers]),
        "FRONT": np.concatenate([ids[:, 0].ravel() for ids in numbers]),
        "BOTTOM": numbers[0][:, :, -1].ravel(),
        "TOP": numbers[1][:, :, -1].ravel(),
    }
    for name, members in sets.items():
        lines += [f"*NSET, NSET={name}", *(f"{n}," for n in members)]
    lines += ["*SURFACE INTERACTION, NAME=CONTACT", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness:g}"]
    lines += ["*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE", "SURFACE1, SURFACE0"]
    lines += ["*BOUNDARY", "SIDE, 1, 1", "FRONT, 2, 2", "BOTTOM, 1, 3", "TOP, 1, 2", "*STEP", "*STATIC", "1., 1."]
    lines += ["*BOUNDARY", f"TOP, 3, 3, {-CLOSURE}", "*NODE PRINT, NSET=TOP, TOTALS=ONLY", "RF", "*END STEP", ""]
    return "\n".join(lines)


def bunched(middle: float, half: float, count: int, widest: float) -> np.ndarray:
    """Places from 0 to 1: ``count`` bricks within ``half`` of the middle, growing ones beyond."""

    def outwards(start: float, end: float, sense: float) -> list[float]:
        places, step = [start], 2.0 * half / count
        while places[-1] != end:
            step = min(1.7 * step, widest)
            left = sense * (end - places[-1])
            places.append(places[-1] + sense * step if left > 1.6 * step else end)
        return places[1:]

    within = np.linspace(middle - half, middle + half, count + 1)
    before, beyond = outwards(within[0], 0.0, -1.0)[::-1], outwards(within[-1], 1.0, 1.0)
    return with_middles(np.concatenate([before, within, beyond]))


def spot_on_tooth(middle: tuple[float, float], count: int) -> tuple[int, float, float, float]:
    """Unknowns; mean deflection, over the pressure's mean, of a parabolic pressure on a spot of the fm-11x41 gear [nm].

    By bricks that resolve it, and by closed form and response; last the share of the response.
    """
    pair = gear_pair(read_case("fm-11x41"))
    halves = (SPOT[0] / 40.0, SPOT[1] / 11.0)
    lengthwise, upward = (
        bunched(m, half, count, widest) for m, half, widest in zip(middle, halves, (0.08, 0.15), strict=True)
    )
    through = with_middles(steps(2.0 * SPOT[1] / count / 7.0, 1, 1.0, 1.7))
    lattice = tooth_lattice(pair, "gear", spacing=LatticeSpacing(lengthwise, upward, through))
    body = elastic_body(lattice.nodes, lattice.cells, lattice.fixed_nodes, STEEL)
    x, w = np.polynomial.legendre.leggauss(4)
    shape = quadratic(x)[0]
    load = np.zeros_like(lattice.nodes)
    cells, weights = [], []
    flank, normal = lattice.nodes[lattice.flank], lattice.flank_normal
    for i in range(0, lengthwise.size - 2, 2):
        for j in range(0, upward.size - 2, 2):
            places = [p[k + 1] + x * 0.5 * (p[k + 2] - p[k]) for p, k in ((lengthwise, i), (upward, j))]
            profile = [1.0 - ((p - m) / half) ** 2 for p, m, half in zip(places, middle, halves, strict=True)]
            if min(p.min() for p in profile) < 0.0:
                continue
            sides = flank[i + 2, j + 1] - flank[i, j + 1], flank[i + 1, j + 2] - flank[i + 1, j]
            area = float(np.linalg.norm(np.cross(*sides)))
            first, second = (shape.T @ (0.5 * w * p) for p in profile)
            window = (slice(i, i + 3), slice(j, j + 3))
            load[lattice.flank[window]] -= area * np.outer(first, second)[..., None] * normal[window]
            # The same on four by four cells, which know nothing of nodes.
            for a in (-0.75, -0.25, 0.25, 0.75):
                for b in (-0.75, -0.25, 0.25, 0.75):
                    at = [p[k + 1] + c * 0.5 * (p[k + 2] - p[k]) for p, k, c in ((lengthwise, i, a), (upward, j, b))]
                    height = [1.0 - ((p - m) / half) ** 2 for p, m, half in zip(at, middle, halves, strict=True)]
                    both = np.outer(quadratic(np.array(a))[0], quadratic(np.array(b))[0])
                    point = np.einsum("ab,abx->x", both, flank[window])
                    fraction = np.sum(both * lattice.profile[window])
                    cells.append((point, *(side / 4.0 for side in sides), at[0], fraction))
                    weights.append(area / 16.0 * height[0] * height[1])
    moved = body.solve(load.reshape(-1, 1))[:, 0]
    direct = float(load.ravel() @ moved) / float(np.linalg.norm(load.sum(axis=0)))
    position, along, across = (np.array([c[k] for c in cells]) for k in range(3))
    lengths = np.linalg.norm(along, axis=1)
    along = along / lengths[:, None]
    across = across - np.sum(across * along, axis=1)[:, None] * along
    widths = np.linalg.norm(across, axis=1)
    nothing = np.zeros(len(cells))
    place = np.array([c[3:] for c in cells]).T
    flat = SurfaceCells(
        *(nothing.astype(np.int64),) * 2,
        along,
        across / widths[:, None],
        np.stack([lengths, widths], axis=1),
        position,
        place,
        place,
        nothing,
        nothing,
    )
    response = flank_response(pair, "gear", STEEL, LatticeSize(lengthwise=20, upward=7))
    force = np.array(weights)
    shares = response.shares(place)
    local = force @ half_space_compliance(flat, (STEEL, STEEL)) @ force / 2.0 / force.sum()
    added = force @ (shares @ (shares @ response.beyond_half_space).T) @ force / force.sum()
    return body.unknowns, 1e6 * direct, 1e6 * (local + added), 100.0 * added / (local + added)


def patch() -> None:
    """A spot on a tooth: more and more bricks against one coarse response."""
    rows = []
    for middle, count in (*(((0.5, 0.5), n) for n in (2, 4, 6)), *(((0.3, 0.9), n) for n in (2, 4))):
        unknowns, direct, ours, share = spot_on_tooth(middle, count)
        rows.append([*middle, count, unknowns, direct, ours, 100.0 * (ours / direct - 1.0), share])
    head = ["lengthwise", "up the side", "bricks across", "unknowns", "bricks nm", "response nm", "difference %"]
    print(tabulate(rows, [*head, "of it the body's %"], "github", ".2f"))


if __name__ == "__main__":
    parts = {"calculix": calculix, "patch": patch}
    for part in sys.argv[1:] or parts:
        parts[part]()
        print()
