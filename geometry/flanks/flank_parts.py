"""Flanks cut by several sections of a blade: each cuts a surface of its own, and the deepest cut remains.

At every node each section's surface is solved on its own. Those whose touched point lies within the section's ends are
candidates. Where sections join without a kink exactly one is; at a kink, where the blade protrudes on both sides, both
or neither may be, and the one that has removed more metal decides. Where the section in question cuts no point there is
no flank: the others do not reach beyond their ends.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cutting.generating_surface import GeneratingSurface

Array = NDArray[Any]

JOINT_TOLERANCE = 1e-9  # [mm]


def deepest(
    parts: Sequence[GeneratingSurface], coordinates: Sequence[Array], depths: Sequence[Array]
) -> NDArray[np.int8]:
    """Index of the flank part that cuts deepest at each of n nodes.

    Parameters
    ----------
    parts
        Surfaces of the sections that cut the flank, from the tip of the blade upwards.
    coordinates
        Blade coordinate for each part (n).
    depths
        How much each part has removed, in any unit (n); NaN where it has no point.

    Returns
    -------
    NDArray
        Index into ``parts`` (n); of one that has no point where there is no flank.
    """
    depth = np.stack([np.where(np.isfinite(d), d, -np.inf) for d in depths])
    within = np.stack(
        [
            (c <= part.section.end + JOINT_TOLERANCE) & ((index == 0) | (c >= part.section.begin - JOINT_TOLERANCE))
            for index, (part, c) in enumerate(zip(parts, coordinates, strict=True))
        ]
    )
    within &= np.isfinite(depth)
    # Where two sections join at a kink: beyond the end of the lower one, before the beginning of the upper one.
    beyond = np.stack([c > part.section.end for c, part in zip(coordinates, parts, strict=True)])
    before = np.stack([c < part.section.begin for c, part in zip(coordinates, parts, strict=True)])
    gap = np.isfinite(depth[:-1]) & np.isfinite(depth[1:]) & beyond[:-1] & before[1:]
    joint = np.zeros_like(within)
    joint[:-1] |= gap
    joint[1:] |= gap
    candidates = np.where(within | (joint & ~np.any(within, axis=0)), depth, -np.inf)
    missing = np.argmin(np.isfinite(depth), axis=0)
    chosen = np.where(np.any(np.isfinite(candidates), axis=0), np.argmax(candidates, axis=0), missing)
    return np.asarray(chosen, dtype=np.int8)


def pick(values: Sequence[Array], choice: NDArray[np.int8]) -> Array:
    """Take from k arrays (..., n), node by node, the one with the given index (n)."""
    picked = np.array(values[0])
    for index in range(1, len(values)):
        mask = choice == index
        picked[..., mask] = values[index][..., mask]
    return picked


def on_parts(
    parts: Sequence[GeneratingSurface],
    choice: NDArray[np.int8],
    parameters: Array,
    function: Callable[[GeneratingSurface, Array], Array],
) -> Array:
    """Evaluate a function (..., n) of the surface parameters (2, n), each node on its own part."""
    return pick([function(part, parameters) for part in parts], choice)
