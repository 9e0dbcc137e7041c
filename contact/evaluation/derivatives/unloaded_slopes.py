"""Derivatives of the unloaded transmission error: those of the gap where the flanks touch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....geometry.flanks.flank import solve_flank
from ....geometry.pair.gap_slopes import gap_slopes
from ....geometry.pair.gear_pair import PairGeometry
from ....geometry.pair.pair_setting import PairSetting
from ...lines.flank_splines import fit
from ...lines.mesh_lines import MeshLines
from ...lines.turned_flanks import BOUNDS, TurnedFlanks
from ...pair_errors import ENVELOPE_REFINEMENT, PairErrors

Array = NDArray[Any]

#: Where the smallest gap may lie: within, or on an edge of the gear that is fixed on its flank.
FIXED_BOUNDS = (-1, *(BOUNDS.index(f"gear_{edge}") for edge in ("toe", "heel", "root", "tip")))


def unloaded_slopes(
    geometry: PairGeometry, mesh: MeshLines, settings: Sequence[PairSetting], slopes: Mapping[str, Array]
) -> tuple[Array, Array]:
    """Unloaded transmission error of the pair that carries, and its derivatives.

    Parameters
    ----------
    geometry
        The pair.
    mesh
        Contact lines, whose rotations (k) and tooth pairs count.
    settings
        By what to differentiate (j).
    slopes
        From ``geometry.pair.field_slopes``.

    Returns
    -------
    tuple
        Transmission error (n) [rad] and derivatives (n, j) at ``ENVELOPE_REFINEMENT`` times as many rotations; these
        are NaN where an edge of the pinion or the end of a blade touches, which moves with the settings.
    """
    count = ENVELOPE_REFINEMENT * mesh.rotations.size
    mesh = replace(mesh, rotations=mesh.rotations[0] + np.arange(count) / count * mesh.pinion_pitch)
    errors = PairErrors.of(TurnedFlanks(geometry), mesh)
    touching = errors.touching
    error = np.where(np.isfinite(errors.error), errors.error, np.inf)
    carrying = np.argmin(error, axis=0)
    at = touching.at(carrying * count + np.arange(count))
    rotation = mesh.rotations - errors.pairs[carrying] * mesh.pinion_pitch
    known = np.isfinite(at.gap)
    points = np.where(known, at.points, 0.5)
    gear = geometry.pair.gear
    flank = solve_flank(gear.loaded, gear.section, *gear.section.points(*points))
    of_pinion = (at.part % len(geometry.exact.motion.surface.flank_parts)).astype(np.int8)
    parameters = at.parameters.reshape(-1, 2, at.gap.size)[of_pinion, :, np.arange(at.gap.size)].T
    change = gap_slopes(geometry, settings, flank, parameters, of_pinion, rotation)
    members = geometry.members
    put_in = fit(members.lengthwise, members.profile, {"put_in": slopes["put_in"]})("put_in", points)
    fixed = known & np.isin(at.bound, FIXED_BOUNDS)
    return np.where(known, at.gap, np.nan), np.where(fixed[:, None], change + put_in.T, np.nan)
