"""First guesses of the surface parameters of a flank: its mean point, and a lattice of seeds about it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.surface_points import SurfacePoints
from ..newton import complex_steps, solve
from .blank_section import BlankSection

Array = NDArray[Any]
SEEDS = 25  # in either direction, the mean point in the middle
NEIGHBOURS = 9  # seeds near a target that are looked at
SHEET_DISTANCE = 4.0  # [seeds]; neighbours further apart than that lie on two sheets of a folded surface
STRAY_LIMIT = 6.0  # [seeds]; a solution further from its seed is not the one that was sought


@lru_cache(maxsize=64)
def mean_parameters(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Parameters (2, 1) of the flank's mean point, on the blade's profile, searched over every position of the cutter.

    Raises
    ------
    GeometryError
        If the cutter meets no tooth of this blank.
    """
    surface = surface.on("profile")
    target = section.points(np.array([0.5]), np.array([0.5]))
    depth = float(np.linalg.norm(section.corners[0, 1] - section.corners[0, 0]))
    # The blade's tip runs along the root cone: that tells how far up the blade the middle of the flank is cut, and with
    # it which of the cutter's several crossings with the blank is the tooth.
    expected = float(section.height_above_root(*target)[0]) / np.cos(surface.blade.pressure_angle)
    cutter_angle = np.linspace(-np.pi, np.pi, 91)
    second = np.linspace(-1.0, 1.0, 31) if surface.settings.generated else np.linspace(0.0, 3.0 * depth, 9)
    lattice = np.stack(np.meshgrid(cutter_angle, second, indexing="ij")).reshape(2, -1)
    with np.errstate(all="ignore"):
        position, _, distance = surface.evaluate(lattice)
        mismatch = np.hypot(position[2] - target[0], np.hypot(position[0], position[1]) - target[1])
        mismatch = mismatch + np.abs(distance - expected)
    candidates = np.flatnonzero(np.isfinite(mismatch))
    candidates = candidates[np.argsort(mismatch[candidates])[:24]]
    if candidates.size:
        found = solve(
            surface.axial_and_radial, lattice[:, candidates], np.repeat(target, candidates.size, 1), surface.max_step
        )
        _, _, distance = surface.evaluate(found.parameters)
        error = np.where(found.converged, np.abs(distance - expected), np.inf)
        best = int(np.argmin(error))
        if error[best] < 1.5 * depth:
            parameters = _nearest_slot(surface, found.parameters[:, [best]])
            parameters.setflags(write=False)  # remembered for the next caller
            return np.asarray(parameters)
    raise GeometryError(
        "these machine settings cut no tooth in this blank: the cutter does not pass through the middle of the face "
        f"(axial {target[0, 0]:.3f} mm, radial {target[1, 0]:.3f} mm); check radial_distance, cradle_angle, "
        "machine_root_angle, machine_center_to_crossing_point and the blank's cones"
    )


def _nearest_slot(surface: GeneratingSurface, parameters: Array) -> Array:
    """The same point (2, 1) in the slot nearest to the x axis.

    A whole turn of a face-hobbing cutter leads to another slot of the same member. Which one a search comes upon is
    chance, and the flank must not depend on it.
    """
    if surface.settings.indexing_ratio == 0.0:
        return parameters
    turns = parameters + np.outer([2.0 * np.pi, 0.0], np.arange(-2, 3))
    position, _, _ = surface.evaluate(turns)
    return np.asarray(turns[:, [int(np.argmax(position[0]))]])


@dataclass(frozen=True)
class SeedLattice:
    """Surface parameters spread over the whole flank and somewhat beyond, as first guesses.

    Parameters
    ----------
    points
        The seeds (m), m = ``SEEDS``^2.
    side
        Which seeds lie on the same side of the surface as the mean point (m).
    orientation
        Orientation sign of that side.
    step
        Distance of neighbouring seeds in each parameter (2).
    """

    points: SurfacePoints
    side: NDArray[np.bool_]
    orientation: float
    step: Array

    def nearest(self, coordinates: Array, usable: NDArray[np.bool_], target: Array) -> SurfacePoints:
        """The usable seeds (n) whose coordinates (2, m) lie nearest to each target (2, n).

        NaN if no seed is usable. The envelope of a motion may fold twice: beyond the second fold it is on the mean
        point's side again and covers targets a second time. Where near seeds lie on two such sheets, the one nearest to
        the mean point is taken.
        """
        from scipy.spatial import cKDTree

        kept = np.flatnonzero(usable & np.all(np.isfinite(coordinates), axis=0))
        if kept.size == 0:
            return self.points.at(np.zeros(target.shape[1], dtype=int)).moved(np.full(target.shape, np.nan))
        count = min(NEIGHBOURS, kept.size)
        _, found = cKDTree(coordinates[:, kept].T).query(target.T, k=count)
        found = kept[np.reshape(found, (target.shape[1], count))]
        middle = (SEEDS - 1) / 2.0
        places = np.stack(np.divmod(found, SEEDS)) - middle
        apart = np.max(np.abs(places - places[:, :, :1]), axis=0)
        best = np.argmin(np.hypot(*places), axis=1)
        choice = np.where(np.any(apart > SHEET_DISTANCE, axis=1), best, 0)
        return self.points.at(found[np.arange(found.shape[0]), choice])

    def strayed(self, start: Array, found: Array) -> NDArray[np.bool_]:
        """Whether solutions (2, n) lie so far from their starts (2, n) that they belong to another sheet."""
        return np.asarray(np.any(np.abs(found - start) > STRAY_LIMIT * self.step[:, None], axis=0))


@lru_cache(maxsize=64)
def seed_lattice(surface: GeneratingSurface, section: BlankSection) -> SeedLattice:
    """Seeds about the mean point of a flank.

    Parameters
    ----------
    surface
        Generating surface of the flank.
    section
        The blank.

    Raises
    ------
    GeometryError
        If the cutter meets no tooth of this blank.
    """
    mean = mean_parameters(surface, section)
    corners = section.corners.reshape(4, 2)
    reach = float(np.max(np.linalg.norm(corners - corners.mean(axis=0), axis=1)))
    orientation = float(np.sign(surface.orientation(mean))[0])
    # Linear reach of each parameter, doubled: contact may use more than the blank, and the flank is curved.
    _, derivatives = complex_steps(surface.axial_and_radial, mean)
    inverse = np.linalg.inv(derivatives[:, :, 0].T)
    span = 2.0 * reach * np.linalg.norm(inverse, axis=1)
    span = np.minimum(span, surface.max_step * np.array([4.0, 6.0]))
    axes = [np.linspace(-s, s, SEEDS) + m for s, m in zip(span, mean[:, 0], strict=True)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)
    with np.errstate(all="ignore"):
        points = SurfacePoints.of(surface, lattice)
        side = np.sign(points.orientation) == orientation
    for array in (lattice, points.values, points.slopes, side):
        array.setflags(write=False)  # remembered for the next caller
    return SeedLattice(points, side, orientation, 2.0 * span / (SEEDS - 1))
