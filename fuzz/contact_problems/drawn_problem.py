"""Contact problems drawn from a seed: ties, duplicates, large shifts, singular compliances, odd arms and scales."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from easeoff.contact import ContactProblem
from easeoff.contact.problem.modal_basis import modal_basis
from numpy.typing import NDArray

Array = NDArray[np.float64]
Compliance = Array | tuple[Array, Array]
Generator = np.random.Generator

#: Compliance of a segment [mm/N], separation [mm] and lever arm [mm], orders of magnitude.
COMPLIANCE, SEPARATION, ARM = 2e-6, 0.01, 40.0


def drawn_problem(seed: int) -> tuple[str, ContactProblem]:
    """Return a problem and what it is called in the count."""
    rng = np.random.default_rng([19, seed])
    size = int(rng.choice([rng.integers(1, 7), rng.integers(7, 13), rng.integers(13, 41)], p=[0.75, 0.2, 0.05]))
    name = str(rng.choice(list(COMPLIANCES)))
    if name == "whole_numbers":
        return name, _whole_numbers(rng, size)
    if name == "shared":
        size = int(rng.integers(8, 25))
    compliance = COMPLIANCES[name](rng, size)
    arm, separation = _arms(rng, size), _separations(rng, size)
    if rng.random() < 0.2:  # segments that are the same
        pick = rng.integers(0, size, size)
        arm, separation, compliance = arm[pick], separation[pick], _picked(compliance, pick)
        arm[0] = ARM if arm.max() <= 0.0 else arm[0]
    torque = float(10.0 ** rng.uniform(3.0, 7.0))
    kind = rng.random()
    if kind < 0.1:
        torque *= 10.0 ** rng.uniform(-14.0, -3.0)
    elif kind < 0.2:
        torque *= 10.0 ** rng.uniform(3.0, 10.0)
    elif kind < 0.23:
        torque = 0.0
    if rng.random() < 0.4:  # rotations counted from far away
        separation = separation + float(rng.choice([-1.0, 1.0])) * 10.0 ** rng.uniform(-9.0, 9.0) * arm
    if rng.random() < 0.1:  # some segments far away
        separation = separation + 10.0 ** rng.uniform(-3.0, 9.0) * rng.integers(0, 2, size)
    if rng.random() < 0.1:  # other units
        force, length = 10.0 ** rng.uniform(-12.0, 12.0, 2)
        separation, arm, torque = separation * length, arm * length, torque * force * length
        unit = length / force
        if isinstance(compliance, tuple):
            compliance = (compliance[0] * unit, compliance[1] * np.sqrt(unit))
        else:
            compliance = compliance * unit
    if isinstance(compliance, tuple) and rng.random() < 0.5:  # modes that are compressed, as those of gears
        return name, ContactProblem.of_modes(separation, arm, torque, compliance[0], modal_basis(compliance[1]))
    return name, ContactProblem(separation, arm, torque, compliance)


def _arms(rng: Generator, size: int) -> Array:
    kind = rng.random()
    if kind < 0.3:
        return np.full(size, ARM)
    arm = rng.uniform(30.0, 55.0, size)
    if kind < 0.45:  # segments that turn the gear back, or not at all
        arm *= rng.choice([-1.0, 0.0, 1.0, 1.0], size)
        arm[rng.integers(size)] = ARM
    elif kind < 0.55:
        arm *= 10.0 ** rng.uniform(-6.0, 3.0, size)
    return arm


def _separations(rng: Generator, size: int) -> Array:
    kind = rng.random()
    if kind < 0.15:
        return np.zeros(size)
    if kind < 0.4:  # ties
        return SEPARATION * rng.integers(0, 3, size).astype(np.float64)
    if kind < 0.5:
        return SEPARATION * rng.standard_normal(size)
    return SEPARATION * rng.random(size) * float(rng.choice([1.0, 1e-3, 1e-9, 1e3]))


def _modes(rng: Generator, size: int, count: int) -> Array:
    position = np.sort(rng.uniform(-1.0, 1.0, size))[:, np.newaxis]
    smooth: Array = np.sqrt(COMPLIANCE) * rng.uniform(0.3, 1.5, count) * position ** np.arange(count)
    rough: Array = 0.3 * np.sqrt(COMPLIANCE) * rng.standard_normal((size, count)) * rng.integers(0, 2)
    return np.asarray(smooth + rough)


def _springs(rng: Generator, size: int) -> Compliance:
    springs = COMPLIANCE * rng.uniform(0.5, 1.5, size) * 10.0 ** (rng.uniform(-8.0, 0.0, size) * (rng.random() < 0.3))
    return np.diag(springs) if rng.random() < 0.5 else (springs, np.zeros((size, 1)))


def _structured(rng: Generator, size: int) -> Compliance:
    local = COMPLIANCE * rng.uniform(0.5, 1.5, size) * 10.0 ** float(rng.choice([0.0, 0.0, rng.uniform(-14.0, 0.0)]))
    return local, _modes(rng, size, int(rng.integers(1, 6)))


def _shared(rng: Generator, size: int) -> Compliance:
    """Groups of segments with modes of their own, and modes that all share, stiff or soft beside them."""
    local = COMPLIANCE * rng.uniform(0.5, 1.5, size)
    groups = np.array_split(np.arange(size), int(rng.integers(1, 5)))
    own = np.zeros((size, 2 * len(groups)))
    for number, rows in enumerate(groups):
        own[rows, 2 * number : 2 * number + 2] = _modes(rng, rows.size, 2)
    softness = 10.0 ** rng.uniform(-8.0, 4.0)
    shared = np.sqrt(softness) * _modes(rng, size, int(rng.integers(1, 4)))
    if rng.random() < 0.3:  # some groups stand apart
        shared[groups[-1]] = 0.0
    return local, np.hstack([own, shared])


def _rank_deficient(rng: Generator, size: int) -> Compliance:
    """Some segments without compliance of their own, or all; modes that repeat each other."""
    factor = _modes(rng, size, int(rng.integers(1, 4)))
    if rng.random() < 0.5:
        factor = np.hstack([factor, factor[:, :1] * rng.uniform(0.1, 1.0)])
    return COMPLIANCE * rng.random(size) * rng.integers(0, 2, size) * float(rng.integers(0, 2)), factor


def _dense(rng: Generator, size: int) -> Compliance:
    root = np.sqrt(COMPLIANCE / size) * rng.standard_normal((size, int(rng.integers(1, size + 1))))
    dense: Array = root @ root.T
    dense = 0.5 * (dense + dense.T)
    dense[np.diag_indices(size)] += COMPLIANCE * rng.random(size) * 10.0 ** rng.uniform(-10.0, 0.0)
    return dense


def _nearly_equal(rng: Generator, size: int) -> Compliance:
    """Segments that differ by little from each other."""
    share = 1.0 - 10.0 ** rng.uniform(-16.0, -3.0)
    dense = np.full((size, size), COMPLIANCE * share)
    np.fill_diagonal(dense, COMPLIANCE)
    return dense


def _rigid(rng: Generator, size: int) -> Compliance:
    springs = COMPLIANCE * rng.integers(0, 2, size).astype(np.float64)
    return np.diag(springs) if rng.random() < 0.5 else (springs, np.zeros((size, 1)))


#: Kinds of compliances; of whole numbers are all data, so that forces and gaps vanish together.
COMPLIANCES: dict[str, Callable[[Generator, int], Compliance]] = {
    "springs": _springs,
    "structured": _structured,
    "rank_deficient": _rank_deficient,
    "dense": _dense,
    "nearly_equal": _nearly_equal,
    "rigid": _rigid,
    "shared": _shared,
    "whole_numbers": _springs,
}


def _whole_numbers(rng: Generator, size: int) -> ContactProblem:
    arm = rng.integers(-1 if rng.random() < 0.3 else 1, 3, size).astype(np.float64)
    arm[rng.integers(size)] = 1.0
    separation = rng.integers(-3 if rng.random() < 0.3 else 0, 4, size).astype(np.float64)
    factor = rng.integers(-1 if rng.random() < 0.5 else 0, 2, (size, int(rng.integers(1, 4)))).astype(np.float64)
    local = np.ones(size) if rng.random() < 0.5 else rng.integers(0, 2, size) * float(rng.integers(0, 2))
    compliance = (local, factor) if rng.random() < 0.5 else np.diag(local) + factor @ factor.T
    shift = float(2 ** int(rng.integers(0, 40))) if rng.random() < 0.5 else 0.0
    return ContactProblem(separation + shift * arm, arm, float(rng.integers(0, 10)), compliance)


def _picked(compliance: Compliance, pick: NDArray[np.int64]) -> Compliance:
    if isinstance(compliance, tuple):
        return compliance[0][pick], compliance[1][pick]
    return compliance[np.ix_(pick, pick)]
