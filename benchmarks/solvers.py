"""Time of one contact problem against its size: the modal method beside other ways, with BLAS pinned to one thread.

Usage: python benchmarks/solvers.py [SIZE ...]
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import platform
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any
from unittest.mock import patch

import numpy as np
from easeoff.contact.modal_basis import modal_basis
from easeoff.contact.problem import ContactProblem
from easeoff.contact.scaling import ScaledProblem
from easeoff.contact.solvers import solve
from easeoff.contact.solvers import modal_newton as modal
from easeoff.contact.solvers.modal_newton import modal_newton
from easeoff.contact.solvers.primal_dual_active_set import primal_dual_active_set
from numpy.polynomial.legendre import legvander
from scipy.linalg.lapack import dpotrf
from tabulate import tabulate

SIZES = (60, 150, 400, 1000, 2000)
POSITIONS = 8  # mesh positions, 1/16 of a pitch apart
PAIRS = 3
LENGTHWISE_MODES, PROFILE_MODES = 8, 5  # of each member
LOCAL = 3e-6  # compliance of a segment by itself [mm/N], order of magnitude
SECONDS = 0.4  # spent at most on a row, but one solve is always made


def tooth_modes(along: Any, height: Any, member: int) -> Any:
    """Bending modes at points of a tooth (n, 40) [(mm/N)^0.5]: Legendre along the face, clamped at the root."""
    from_root = height if member == 0 else 1.0 - height
    lengthwise = legvander(along, LENGTHWISE_MODES - 1)
    profile = from_root[:, None] ** (2.0 + np.arange(PROFILE_MODES))
    softness = 1.0 / np.outer(1.0 + np.arange(LENGTHWISE_MODES) ** 1.5, 1.0 + np.arange(PROFILE_MODES))
    values = lengthwise[:, :, None] * profile[:, None, :] * softness
    return np.sqrt(2.0 * LOCAL) * values.reshape(along.size, -1)


def problem(size: int, phase: float, *, refined: bool) -> ContactProblem:
    """Three tooth pairs under inclined, curved contact lines that move up the flank with the phase.

    With `refined` the local compliance of a segment grows as it gets shorter, as that of a true refinement does.
    """
    counts = np.full(PAIRS, size // PAIRS) + (np.arange(PAIRS) < size % PAIRS)
    gaps, blocks = [], []
    for pair, count in enumerate(counts):
        along = (np.arange(count) + 0.5) / count * 2.0 - 1.0
        height = np.clip(0.5 + 0.3 * along + 0.06 * along**2 + 0.45 * (pair - 1 + phase), 0.02, 0.98)
        blocks.append(np.hstack([tooth_modes(along, height, member) for member in (0, 1)]))
        across = 2.0 * height - 1.0
        gaps.append(0.032 * (along - 0.1) ** 2 + 0.018 * across**2 + 0.009 * along * across)
    factor = np.zeros((size, sum(block.shape[1] for block in blocks)))
    row = column = 0
    for block in blocks:
        factor[row : row + block.shape[0], column : column + block.shape[1]] = block
        row, column = row + block.shape[0], column + block.shape[1]
    position = np.arange(size) / size
    local = LOCAL * (1.0 + 0.4 * np.sin(9.0 * position)) * (size / 60.0 if refined else 1.0)
    arm = 42.0 + 2.0 * np.cos(5.0 * position)
    return ContactProblem(np.concatenate(gaps), arm, 1.5e6, (local, factor))


def median_seconds(work: list[Callable[[], Any]]) -> float:
    """Median time of the pieces of work, each done several times while there is time."""
    values: list[float] = []
    begun = time.perf_counter()
    while True:
        for piece in work:
            start = time.perf_counter()
            piece()
            values.append(time.perf_counter() - start)
            if time.perf_counter() - begun > SECONDS:
                return statistics.median(values[1:] or values)


def as_arrays(scaled: ScaledProblem, start: Any) -> Any:
    """The modal method as it runs without numba."""
    with patch.object(modal, "compiled_kernel", lambda: None):
        return modal.modal_newton(scaled, start)


def rows(size: int, *, refined: bool) -> tuple[dict[str, float], dict[str, float], list[str]]:
    """Seconds of every way, greatest error of a force against the dense active set, and notes."""
    cases = [problem(size, k / 16.0, refined=refined) for k in range(POSITIONS)]
    scaled = [case.scaling.scale(case) for case in cases]
    exact = [primal_dual_active_set(s, c.scaling.estimated_active) for s, c in zip(scaled, cases, strict=True)]
    assert all(answer is not None for answer in exact)
    starts = [case.scaling.estimated_active for case in cases]
    neighbours = [answer.force > 0.0 for answer in exact]  # type: ignore[union-attr]
    answers = [modal_newton(s, a) for s, a in zip(scaled, starts, strict=True)]
    warm = [modal_newton(s, a) for s, a in zip(scaled[1:], neighbours[:-1], strict=True)]
    error = max(
        float(np.abs(a.force - e.force).max() / e.force.max())  # type: ignore[union-attr]
        for a, e in zip(answers, exact, strict=True)
    )
    turn = max(
        abs(a.rotation / e.rotation - 1.0)  # type: ignore[union-attr]
        for a, e in zip(answers, exact, strict=True)
    )
    seconds = {
        "Cholesky factor of n x n": median_seconds(
            [lambda m=s.compliance: dpotrf(m.T, lower=1, clean=0) for s in scaled[:2]]
        ),
        "modal, cold": median_seconds(
            [lambda s=s, a=a: modal_newton(s, a) for s, a in zip(scaled, starts, strict=True)]
        ),
        "modal, warm from the position before": median_seconds(
            [lambda s=s, a=a: modal_newton(s, a) for s, a in zip(scaled[1:], neighbours[:-1], strict=True)]
        ),
        "modal as arrays, cold": median_seconds(
            [lambda s=s, a=a: as_arrays(s, a) for s, a in zip(scaled, starts, strict=True)]
        ),
        "compression of the factor": median_seconds([lambda c=c: modal_basis(c.compliance[1]) for c in cases]),
        "solve: all, cold": median_seconds([lambda c=c: solve(c.with_torque(c.torque)) for c in cases]),
        "dense active set, cold": median_seconds(
            [lambda s=s, a=a: primal_dual_active_set(s, a) for s, a in zip(scaled, starts, strict=True)]
        ),
    }
    for name in ("daqp", "piqp"):
        seconds[f"{name}, polished"] = median_seconds([lambda c=c, n=name: solve(c, n) for c in cases])
    active = statistics.mean(float(mask.mean()) for mask in neighbours)
    rank = cases[0].modal_basis.modes.shape[2]  # type: ignore[union-attr]
    cold_count = statistics.mean(a.iterations for a in answers)  # type: ignore[union-attr]
    warm_count = statistics.mean(a.iterations for a in warm)  # type: ignore[union-attr]
    notes = [f"{size}", f"{100 * active:.0f}", f"{rank}", f"{cold_count:.1f}", f"{warm_count:.1f}"]
    return seconds, {"force": error, "rotation": turn}, [*notes, f"{error:.0e}", f"{turn:.0e}"]


def main() -> None:
    """Print the tables."""
    sizes = tuple(int(word) for word in sys.argv[1:]) or SIZES
    print(f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}, one BLAS thread")
    print(f"modal method {'as arrays' if modal.compiled_kernel() is None else 'compiled'}\n")
    for refined in (False, True):
        print("local compliance " + ("grows with n, as under refinement" if refined else "the same for every n"))
        results = [rows(size, refined=refined) for size in sizes]
        notes = [note for _, _, note in results]
        headers = ["n", "touching %", "modes a pair", "cold", "warm", "force error", "rotation error"]
        print(tabulate(notes, headers=headers, disable_numparse=True), "\n")
        table = []
        for name in results[0][0]:
            seconds = [result[0][name] for result in results]
            unit = [result[0]["Cholesky factor of n x n"] for result in results]
            cells = [f"{1e6 * s:.0f} ({s / u:.2g})" for s, u in zip(seconds, unit, strict=True)]
            known = [(n, s) for n, s in zip(sizes, seconds, strict=True) if n >= 150]
            slope = np.polyfit(*np.log(np.array(known)).T, 1)[0] if len(known) > 1 else np.nan
            table.append([name, *cells, f"{slope:.2f}"])
        print("microseconds (over one Cholesky factorisation of n x n)")
        columns = [f"n = {n}" for n in sizes]
        print(tabulate(table, headers=["", *columns, "exponent, n >= 150"], disable_numparse=True), "\n")


if __name__ == "__main__":
    main()
