"""Random contact problems in sixteen classes, from ordinary to degenerate, for tests of solvers.

Each class is a function of a random generator; every problem has a solution. The classes were chosen to hurt: ties,
duplicates, loads and separations over many decades, compliances that are numerically singular.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from ..contact.problem.contact_problem import ContactProblem
from ..core.arrays import RealArray as Array
from ..core.checks import one_of, whole

ProblemClass = Callable[[np.random.Generator], ContactProblem]

#: Local compliance of a segment [mm/N], order of magnitude.
LOCAL_COMPLIANCE = 3e-6


def problems(name: str, count: int, seed: int = 0) -> Iterator[ContactProblem]:
    """Yield ``count`` problems of a class, the same for the same seed.

    Examples
    --------
    >>> from easeoff.contact import solve
    >>> [solve(problem).certified for problem in problems("lattice", 3)]
    [True, True, True]
    """
    number = list(PROBLEM_CLASSES).index(one_of("name", name, PROBLEM_CLASSES))
    generator = np.random.default_rng([whole("seed", seed, 0), number])
    for _ in range(whole("count", count, 0)):
        yield PROBLEM_CLASSES[name](generator)


def _parts(rng: np.random.Generator, *, signed: bool = False) -> tuple[Array, Array, float, Array, Array]:
    """Return S, r, T, d, V of a problem of 1 to 40 segments with smooth coupling and gaps of some microns."""
    n = int(rng.integers(1, 41))
    position = np.sort(rng.uniform(-1.0, 1.0, n))
    modes = int(rng.integers(1, 9))
    factor = np.sqrt(LOCAL_COMPLIANCE) * rng.uniform(0.3, 1.5, modes) * position[:, None] ** np.arange(modes)
    factor = factor if signed else np.abs(factor)
    if signed:
        factor = factor + 0.3 * np.sqrt(LOCAL_COMPLIANCE) * rng.standard_normal((n, modes))
    separation = 0.03 * (position - rng.uniform(-0.5, 0.5)) ** 2 + 0.002 * rng.uniform(size=n)
    arm = rng.uniform(30.0, 55.0, n)
    return separation, arm, float(10.0 ** rng.uniform(4.0, 6.0)), LOCAL_COMPLIANCE * rng.uniform(0.5, 1.5, n), factor


def _varied(
    vary: Callable[[np.random.Generator, Array, Array, float, Array, Array], tuple[Array, Array, float, Any]],
    *,
    signed: bool = False,
) -> ProblemClass:
    """Class of problems made from S, r, T, d, V of ``_parts``, and further random numbers."""
    return lambda rng: ContactProblem(*vary(rng, *_parts(rng, signed=signed)))


def _duplicated(rng: np.random.Generator) -> ContactProblem:
    s, r, t, d, v = _parts(rng)
    pick = rng.integers(0, s.size, s.size)
    return ContactProblem(s[pick], r[pick], t, (d[pick], v[pick]))


def _lattice(rng: np.random.Generator) -> ContactProblem:
    n, modes = int(rng.integers(1, 41)), int(rng.integers(1, 5))
    factor = rng.integers(0, 3, (n, modes)).astype(float)
    separation = rng.integers(0, 4, n).astype(float)
    arm, torque = rng.integers(1, 4, n).astype(float), float(rng.integers(1, 21))
    return ContactProblem(separation, arm, torque, (np.ones(n), factor))


def _mixed_arms(rng: np.random.Generator) -> ContactProblem:
    s, r, t, d, v = _parts(rng)
    kind = rng.integers(0, 4, s.size)
    r = np.where(kind == 0, 0.0, np.where(kind == 1, -r, r))
    r[rng.integers(s.size)] = 40.0
    return ContactProblem(s, r, t, (d, v))


def _realistic(rng: np.random.Generator) -> ContactProblem:
    """Two or three tooth pairs under inclined contact lines, each with its own bending modes."""
    pairs = int(rng.integers(2, 4))
    per_pair = int(rng.integers(6, 21))
    blocks, gaps = [], []
    for pair in range(pairs):
        along = np.linspace(-1.0, 1.0, per_pair)
        height = np.clip(0.5 + 0.4 * along + 0.25 * (pair - 0.5 * (pairs - 1)), 0.0, 1.0)
        shapes = np.polynomial.legendre.legvander(along, 5) * (0.15 + height**1.5)[:, None]
        blocks.append(np.sqrt(LOCAL_COMPLIANCE) * shapes / (1.0 + np.arange(6)))
        mismatch = 0.032 * (along - 0.2) ** 2 + 0.018 * (2.0 * height - 1.0) ** 2 + 0.009 * along * (2.0 * height - 1.0)
        gaps.append(mismatch + 0.004 * (pair - 0.5 * (pairs - 1)) ** 2)
    factor, n = block_diag(*blocks), pairs * per_pair
    return ContactProblem(
        np.concatenate(gaps) + 1e-4 * rng.uniform(size=n),
        rng.normal(42.0, 1.0, n),
        float(rng.uniform(3e5, 9e5)),
        (LOCAL_COMPLIANCE * rng.uniform(0.7, 1.5, n), factor),
    )


def _random_dense(rng: np.random.Generator) -> ContactProblem:
    s, r, t, d, _ = _parts(rng)
    n = s.size
    root = np.sqrt(LOCAL_COMPLIANCE / n) * rng.standard_normal((n, int(rng.integers(1, n + 1))))
    dense = root @ root.T
    dense[np.diag_indices(n)] += d * 10.0 ** rng.uniform(-10.0, -4.0)
    return ContactProblem(s, r, t, dense)


#: The classes by name.
PROBLEM_CLASSES: dict[str, ProblemClass] = {
    "plain": _varied(lambda _, s, r, t, d, v: (s, r, t, (d, v))),
    "touching": _varied(lambda _, s, r, t, d, v: (np.zeros_like(s), r, t, (d, v))),
    "duplicated": _duplicated,
    "light_load": _varied(lambda rng, s, r, t, d, v: (s, r, 10.0 ** rng.uniform(-11.0, -3.0), (d, v))),
    "heavy_load": _varied(lambda rng, s, r, t, d, v: (s, r, 10.0 ** rng.uniform(9.0, 17.0), (d, v))),
    "far_apart": _varied(
        lambda rng, s, r, t, d, v: (s + 10.0 ** rng.uniform(-3.0, 9.0) * rng.uniform(size=s.size) ** 3, r, t, (d, v))
    ),
    "far_together": _varied(lambda rng, s, r, t, d, v: (s + 10.0 ** rng.uniform(0.0, 5.0) * r, r, t, (d, v))),
    "weak_local": _varied(lambda rng, s, r, t, d, v: (s, r, t, (d * 10.0 ** rng.uniform(-8.0, -3.0), v))),
    "nearly_singular": _varied(lambda _, s, r, t, d, v: (s, r, t, (d * 1e-14, v))),
    "spread_local": _varied(lambda rng, s, r, t, d, v: (s, r, t, (d * 10.0 ** rng.uniform(-8.0, 0.0, s.size), v))),
    "lattice": _lattice,
    "mixed_arms": _mixed_arms,
    "realistic": _realistic,
    "signed_modes": _varied(lambda _, s, r, t, d, v: (s, r, t, (d, v)), signed=True),
    "interfering": _varied(
        lambda rng, s, r, t, d, v: (s - 10.0 ** rng.uniform(-3.0, 2.0) * rng.uniform(size=s.size), r, t, (d, v))
    ),
    "random_dense": _random_dense,
}
