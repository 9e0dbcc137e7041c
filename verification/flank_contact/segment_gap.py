"""Gap of potential contact segments against that of the turned flanks, on contact lines and on edges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...contact.loaded_cases import LoadedCase
from ...contact.mesh_cycle import MeshCycle
from ...core.checks import frozen_arrays
from ...geometry.flanks.flank import solve_flank
from ..flank_gap import flank_gap
from .surface_cells import FlanksInMesh

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class SegmentGaps:
    """Gaps of the segments (n) of one solved case, as gear rotations [rad].

    Parameters
    ----------
    own
        The analysis's.
    exact
        Those of the turned flanks; NaN where no pinion flank is met.
    share
        Share of every segment in one more unit of torque, zero where it does not touch.

    Examples
    --------
    >>> gaps = SegmentGaps(np.array([2e-6, 5e-6]), np.array([1e-6, 5e-6]), np.array([0.25, 0.75]))
    >>> print(round(gaps.rotation_error, 9))
    2.5e-07
    """

    own: Array
    exact: Array
    share: Array

    @property
    def rotation_error(self) -> float:
        """Error of the transmission error by those of the gaps, to first order [rad].

        By Betti's theorem the rotation changes with a gap as the force there changes with the torque.
        """
        touching = self.share != 0.0
        return float(self.share[touching] @ (self.own - self.exact)[touching])


def segment_gaps(flanks: FlanksInMesh, cycle: MeshCycle, case: LoadedCase) -> SegmentGaps:
    """Gaps of a solved case's segments against those of the turned flanks.

    Parameters
    ----------
    flanks
        The pair.
    cycle
        The pair in mesh.
    case
        One of its solved cases.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> from easeoff.verification.flank_contact.surface_cells import flanks_of
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=9)
    >>> gaps = segment_gaps(flanks_of(geometry), cycle, cycle.solved([100.0])[1])
    >>> bool(abs(gaps.rotation_error) < 1e-6)
    True
    """
    # Where edges may touch, the lines end at the edges and know how far these are.
    cut = bool(np.any(np.isfinite(case.segments.line_contact.overhang)))
    found = cycle.segments.to_edges if cut else cycle.segments
    segments, on_lines, lines = case.segments, found.on_lines, found.on_lines.lines
    here = np.flatnonzero(lines.position == case.mesh_position)
    points, weights = on_lines.quadrature
    places = (points + found.closest.shift)[:, here].reshape(2, -1)
    pairs = np.repeat(lines.pair[here], points.shape[2])
    # The segments of the lines come first, then pieces of edges.
    count = here.size * on_lines.count
    places = np.concatenate([places, segments.point[:, count:]], axis=1)
    pairs = np.concatenate([pairs, segments.pair[count:]])
    rotation = lines.rotations[case.mesh_position] - pairs * lines.pinion_pitch
    gap, _ = exact_gap(flanks, places, rotation)
    edge = count * weights.size
    exact = np.concatenate([gap[:edge].reshape(-1, weights.size) @ weights, gap[edge:]])
    return SegmentGaps(segments.separation_angle, exact, _share_of_more_torque(case))


def _share_of_more_torque(case: LoadedCase) -> Array:
    """Share (n) of the segments in a small increase of the torque, from the compliance of those that touch."""
    touching = case.solution.force > 0.0
    arm = case.problem.lever_arm[touching]
    force = np.linalg.solve(case.problem.dense_compliance[np.ix_(touching, touching)], arm)
    share = np.zeros(touching.size)
    share[touching] = force * arm / (force @ arm)
    return share


def exact_gap(flanks: FlanksInMesh, places: Array, rotation: Array) -> tuple[Array, Array]:
    """Gap of the turned flanks along the gear's normals.

    Parameters
    ----------
    flanks
        The pair.
    places
        Lengthwise and profile fractions on the gear (2, n).
    rotation
        Rotation of the pinion (n) from the middle of its flank [rad].

    Returns
    -------
    tuple
        Gap as a gear rotation (n) [rad], zero at first contact, and fractions on the pinion (2, n); NaN where no
        pinion flank is met.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.verification import flanks_in_mesh
    >>> flanks = flanks_in_mesh(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> middle = np.array([[0.5], [0.5]])
    >>> gap, _ = exact_gap(flanks, middle, flanks.splines("roll_angle", middle))
    >>> bool(abs(gap[0] - flanks.splines("ease_off_angle", middle)[0]) < 1e-5)
    True
    """
    gear, pinion = flanks.pair.gear, flanks.pair.pinion.section
    nodes = solve_flank(gear.loaded, gear.section, *gear.section.points(*places))
    arm = np.abs(nodes.position[0] * nodes.normal[1] - nodes.position[1] * nodes.normal[0])
    start = flanks.splines("pinion_parameters", np.clip(places, 0.0, 1.0))
    gap, fractions = np.full(rotation.shape, np.nan), np.full(places.shape, np.nan)
    for here in np.unique(rotation):
        own = np.flatnonzero(rotation == here)
        turned = here + flanks.motion.center
        found = flank_gap(
            flanks.motion, nodes.position[:, own], nodes.normal[:, own], turned, flanks.first_contact, start[:, own]
        )
        gap[own] = found.gap / arm[own]
        axial, radial = found.pinion_position[2], np.hypot(*found.pinion_position[:2])
        fractions[:, own] = np.stack(pinion.fractions(axial, radial))
    return gap, fractions
