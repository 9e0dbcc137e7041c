"""Surface patches of a tooth: structured grids of points, checked and turned so that all of them look outwards.

A patch is an array (m, n, 3) [mm]. Neighbouring patches share the points of their common border. The derivative along
the first index times the derivative along the second one is the patch's normal.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core import checks
from ...core.errors import InputError

Array = NDArray[Any]

COPY_COUNT_LIMIT = 1000  # of a tooth; no gear has more
NO_AREA = 1e-6  # [mm^2]
SAME_POINT = 1e-6  # [mm]; far below any tolerance of a drawing, far above rounding


def checked(patches: Mapping[str, Array]) -> dict[str, Array]:
    """The patches as float arrays.

    Raises
    ------
    InputError
        If there is none, or one is no grid of finite points or has no area.
    """
    checks.instance("patches", patches, Mapping)
    if not patches:
        raise InputError("no surface patches to write")
    result = {}
    for name, points in patches.items():
        checks.instance("name of a patch", name, str)
        array = checks.array(f"patch {name!r}", points, "mm", anything=True)
        if array.ndim != 3 or array.shape[2] != 3 or min(array.shape[:2]) < 2:
            raise InputError(f"patch {name!r} has the shape {array.shape}: must be (m, n, 3) with m and n at least 2")
        if not np.all(np.isfinite(array)):
            raise InputError(f"patch {name!r} has points that are no finite numbers: a surface has no holes")
        diagonals = array[1:, 1:] - array[:-1, :-1], array[1:, :-1] - array[:-1, 1:]
        if 0.5 * np.sum(np.linalg.norm(np.cross(*diagonals), axis=-1)) < NO_AREA:
            raise InputError(f"patch {name!r} has no area: leave it out")
        result[name] = array
    return result


def merged(points: Array) -> tuple[Array, Array]:
    """Points without repetition, and where each one went.

    Parameters
    ----------
    points
        Points (n, 3) [mm].

    Returns
    -------
    tuple
        Different points (k, 3) and the number (n) of the one each point became.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(points).query_pairs(SAME_POINT, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    _, label = connected_components(graph, directed=False)
    _, first, number = np.unique(label, return_index=True, return_inverse=True)
    return points[first], number


def oriented(patches: Mapping[str, Array]) -> dict[str, Array]:
    """Patches whose normals agree across every common border.

    The first patch of every connected group is kept; others are turned, by reversing their first index, until they
    agree with it.

    Parameters
    ----------
    patches
        Patches by name.

    Raises
    ------
    InputError
        If a patch is no grid of finite points, or the patches cannot agree.
    """
    arrays = checked(patches)
    names = list(arrays)
    _, number = merged(np.concatenate([array.reshape(-1, 3) for array in arrays.values()]))
    # Who runs along which piece of border, and in which sense.
    users: dict[tuple[int, int], list[tuple[str, int]]] = defaultdict(list)
    start = 0
    for name, array in arrays.items():
        m, n = array.shape[:2]
        border = _border(number[start : start + m * n].reshape(m, n))
        start += m * n
        for a, b in zip(border, np.roll(border, -1), strict=True):
            if a != b:
                users[(min(a, b), max(a, b))].append((name, 1 if a < b else -1))
    neighbours: dict[str, list[tuple[str, int]]] = defaultdict(list)
    for along in users.values():
        for i, (one, sense) in enumerate(along):
            for other, other_sense in along[i + 1 :]:
                neighbours[one].append((other, -sense * other_sense))
                neighbours[other].append((one, -sense * other_sense))
    turn: dict[str, int] = {}
    for name in names:
        if name in turn:
            continue
        turn[name] = 1
        queue = deque([name])
        while queue:
            current = queue.popleft()
            for other, agreement in neighbours[current]:
                if other not in turn:
                    turn[other] = turn[current] * agreement
                    queue.append(other)
                elif turn[other] != turn[current] * agreement:
                    raise InputError(
                        f"patches {current!r} and {other!r} share a border, but cannot both look outwards: the surface "
                        "has one side only, or more than two patches meet there"
                    )
    return {name: array if turn[name] > 0 else array[::-1] for name, array in arrays.items()}


def rotations(teeth: int, pitch: float | None) -> Array:
    """Angles [rad] of the copies of a tooth about the axis.

    Parameters
    ----------
    teeth
        Number of copies.
    pitch
        Angle from one to the next [rad]; ``None`` to spread them over the whole turn.

    Raises
    ------
    InputError
        If there is no tooth to write.
    """
    count = checks.whole("teeth", teeth, 1, COPY_COUNT_LIMIT)
    return np.arange(count) * (2.0 * np.pi / count if pitch is None else checks.number("pitch", pitch, "rad"))


def _border(grid: Array) -> Array:
    """Numbers of the border's points, round once in the sense of the normal."""
    return np.concatenate([grid[:-1, 0], grid[-1, :-1], grid[:0:-1, -1], grid[0, :0:-1]])
