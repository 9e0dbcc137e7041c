"""Compute the rough flank of ``half_space.md`` and draw it: python docs/make rough_flank [--cells N].

Prints the rows of the page's tables and writes docs/images/rough_flank.png.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from time import process_time

import numpy as np
from dissertation_figures import save_small
from folders import IMAGES
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, ContactProblem, ContactSolution, HalfSpaceCompliance, solve
from easeoff.geometry import pair_geometry
from easeoff.verification import relative_curvature
from easeoff.verification.conventional_analysis import path_of_contact

Array = NDArray[np.float64]

PICTURE = IMAGES / "rough_flank.png"
CASE = "nasa-12x36"
GEAR_TORQUE = 450e3  # 150 N m at the pinion, carried by one tooth pair [N mm]
PATCH = (18.0, 1.1)  # lengths along the contact line and across it [mm]
ROUGHNESS = 2e-4  # root mean square [mm]
#: Wavelengths of the roughness over the sides of the patch, and exponent of Hurst of its self-affine spectrum.
WAVELENGTHS, HURST = (1.0 / 48.0, 1.0 / 8.0), 0.8
SEED = 1


@dataclass(frozen=True)
class FlankPatch:
    """Patch of a flank around the point of first contact, divided into cells.

    Parameters
    ----------
    along, across
        Middles of the cells (count) [mm].
    separation, lever_arm
        Of the cells (count, count) [mm].
    """

    along: Array
    across: Array
    separation: Array
    lever_arm: Array

    @property
    def sides(self) -> tuple[float, float]:
        """Sides of a cell [mm]."""
        return float(self.along[1] - self.along[0]), float(self.across[1] - self.across[0])

    def pressed(self, roughness: Array) -> tuple[ContactProblem, ContactSolution, float]:
        """The problem with a roughness (count, count) [mm] on the flanks, its solution, and the processor time [s]."""
        start = process_time()
        compliance = HalfSpaceCompliance(self.separation.shape, self.sides, (STEEL, STEEL))
        separation = (self.separation + roughness).ravel()
        problem = ContactProblem(separation, self.lever_arm.ravel(), GEAR_TORQUE, compliance)
        return problem, solve(problem), process_time() - start


def patch(count: int) -> FlankPatch:
    """Second-order gap and lever arm of the pair around its point of contact in the middle of the mesh."""
    geometry = pair_geometry(gear_pair(read_case(CASE)), (31, 21))
    path = path_of_contact(geometry.members.gear, geometry.exact, np.zeros(1))
    curvature = relative_curvature(geometry.exact.motion, geometry.members.gear.surface, path)
    normal = np.cross(curvature.line[:, 0], curvature.across[:, 0])
    along, across = (side * ((np.arange(count) + 0.5) / count - 0.5) for side in PATCH)
    separation = 0.5 * (curvature.along_line[0] * along[:, None] ** 2 + curvature.across_line[0] * across[None] ** 2)
    # (axis x p) . n, with the gear's axis as the third coordinate of its frame
    turn = np.array([normal[1], -normal[0], 0.0])
    arm = np.array([float(turn @ point[:, 0]) for point in (path.gear_position, curvature.line, curvature.across)])
    arm *= np.sign(arm[0])
    return FlankPatch(along, across, separation, arm[0] + arm[1] * along[:, None] + arm[2] * across[None])


def roughness(count: int) -> Array:
    """Self-affine roughness (count, count) [mm] with random phases, the same waves on every grid."""
    waves = np.arange(-48, 49)
    first, second = np.meshgrid(waves, waves, indexing="ij")
    number = np.hypot(first, second)
    chosen = (number >= 1.0 / WAVELENGTHS[1]) & (number <= 1.0 / WAVELENGTHS[0])
    phase = np.random.default_rng(SEED).random(number.shape)
    amplitude = np.where(chosen, np.maximum(number, 1.0) ** -(1.0 + HURST), 0.0) * np.exp(2j * np.pi * phase)
    middle = (np.arange(count) + 0.5) / count
    turned = np.exp(2j * np.pi * waves[:, None] * middle[None])
    height = np.einsum("ax,ab,by->xy", turned, amplitude, turned, optimize=True).real
    return np.asarray(ROUGHNESS * height / np.sqrt(0.5 * np.sum(np.abs(amplitude) ** 2)))


def drawn(flank: FlankPatch, smooth: Array, rough: Array) -> Figure:
    """Pressures of the smooth and the rough flank, as maps and in a section across the contact line."""
    figure = Figure(figsize=(8.6, 5.4), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.25, 1.0))
    highest = float(np.ceil(np.quantile(rough[rough > 0.0], 0.99) / 500.0) * 500.0)
    extent = (-0.5 * PATCH[0], 0.5 * PATCH[0], -0.5 * PATCH[1], 0.5 * PATCH[1])
    for column, (title, pressure) in enumerate((("smooth", smooth), ("rough", rough))):
        axes = figure.add_subplot(grid[0, column])
        shown = np.ma.masked_less_equal(pressure.T, 0.0)
        image = axes.imshow(
            shown,
            origin="lower",
            extent=extent,
            aspect="auto",
            vmin=0.0,
            vmax=highest,
            cmap="viridis",
            interpolation="none",
        )
        axes.set(title=title, xlabel="along the contact line [mm]", ylabel="across [mm]")
    figure.colorbar(image, ax=figure.axes, label="pressure [MPa]", extend="max", shrink=0.9)
    section = figure.add_subplot(grid[1, :])
    row = flank.along.size // 2
    section.plot(1e3 * flank.across, rough[row], color="#c44e52", linewidth=0.8, label="rough")
    section.plot(1e3 * flank.across, smooth[row], color="black", linewidth=1.4, label="smooth")
    section.set(xlabel="across the contact line, in its middle [um]", ylabel="pressure [MPa]", ylim=(0.0, None))
    section.margins(x=0.0)
    section.legend(frameon=False)
    return figure


def main() -> None:
    """Solve on several grids, print the table, draw the finest."""
    finest = int(sys.argv[sys.argv.index("--cells") + 1]) if "--cells" in sys.argv else 512
    pressures = {}
    print("cells | surface | steps | time [s] | certificate | rotation [urad] | peak [MPa] | in contact | area [mm2]")
    for count in (finest // 4, finest // 2, finest):
        flank = patch(count)
        area = flank.sides[0] * flank.sides[1]
        for name, height in (("smooth", np.zeros((count, count))), ("rough", roughness(count))):
            _, solution, seconds = flank.pressed(height)
            pressures[name] = solution.force.reshape(count, count) / area
            touching = int(solution.active.sum())
            numbers = f"{solution.iterations} | {seconds:.1f} | {solution.certificate.worst:.0e}"
            numbers += f" | {1e6 * solution.elastic_rotation:.3f} | {pressures[name].max():.0f} | {touching}"
            print(f"{count} x {count} | {name} | {numbers} | {touching * area:.2f}")
    save_small(drawn(flank, pressures["smooth"], pressures["rough"]), PICTURE)


if __name__ == "__main__":
    main()
