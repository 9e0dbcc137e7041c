"""Processor time of one contact problem against its size: the native solver beside all others, BLAS on one thread.

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
from functools import partial
from typing import Any

import numpy as np
import qpsolvers
from easeoff.contact.problem.modal_basis import modal_basis
from easeoff.contact import ContactProblem, OperatorCompliance
from easeoff.contact import available_solvers, solve, solve_many
from easeoff.contact.solvers.compiled.compiled_answer import LARGEST_DENSE, dense_answer, scaled_answer
from easeoff.contact.solvers.primal_dual_active_set import primal_dual_active_set
from numpy.polynomial.legendre import legvander
from scipy.linalg.lapack import dpotrf
from scipy.sparse import csr_array
from scipy.sparse.linalg import aslinearoperator
from tabulate import tabulate

SIZES = (20, 60, 150, 400, 1000, 2000, 5000, 10000)
POSITIONS = 16  # mesh positions, 1/16 of a pitch apart
PAIRS = 3
LENGTHWISE_MODES, PROFILE_MODES = 8, 5  # of each member
LOCAL = 3e-6  # compliance of a segment by itself [mm/N], order of magnitude
SECONDS = 0.4  # spent at most on a row, but one solve is always made
LARGEST = {"Cholesky": 5000, "dense active set": 2000, "matrix": 2000}  # beyond, a row would take minutes
PATIENCE = 3.0  # a backend that takes longer is left out at larger sizes [s]


def tooth_modes(along: Any, height: Any, member: int) -> Any:
    """Bending modes at points of a tooth (n, 40) [(mm/N)^0.5]: Legendre along the face, clamped at the root."""
    from_root = height if member == 0 else 1.0 - height
    lengthwise = legvander(along, LENGTHWISE_MODES - 1)
    profile = from_root[:, None] ** (2.0 + np.arange(PROFILE_MODES))
    softness = 1.0 / np.outer(1.0 + np.arange(LENGTHWISE_MODES) ** 1.5, 1.0 + np.arange(PROFILE_MODES))
    values = lengthwise[:, :, None] * profile[:, None, :] * softness
    return np.sqrt(2.0 * LOCAL) * values.reshape(along.size, -1)


def problem(size: int, phase: float, *, refined: bool) -> ContactProblem:
    """A problem as the analysis makes them, with its bending modes compressed."""
    given = whole_problem(size, phase, refined=refined)
    basis = modal_basis(given.compliance[1])
    return ContactProblem.of_modes(given.separation, given.lever_arm, given.torque, given.compliance[0], basis)


def whole_problem(size: int, phase: float, *, refined: bool) -> ContactProblem:
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
    """Median processor time of the pieces of work, each done several times while there is time."""
    values: list[float] = []
    begun = time.perf_counter()
    while True:
        for piece in work:
            start = time.process_time()
            piece()
            values.append(time.process_time() - start)
            if time.perf_counter() - begun > SECONDS:
                return statistics.median(values[1:] or values)


def answered(answer: Any) -> Any:
    """The answer of a method that must not give up here."""
    assert answer is not None
    return answer


def relative_difference(force: Any, other: Any) -> float:
    """Greatest difference of two solutions over the greatest force."""
    return float(np.abs(force - other).max() / force.max())


class Rows:
    """Seconds of every way at one size, and what was found."""

    def __init__(self, size: int, *, refined: bool, given_up: set[str]) -> None:
        self.cases = [problem(size, k / 16.0, refined=refined) for k in range(POSITIONS)]
        self.size, self.given_up = size, given_up
        self.seconds: dict[str, float] = {}
        self.solutions = solve_many(self.cases)
        assert all(solution.certified for solution in self.solutions)
        self.scaled = [case.scaled() for case in self.cases]
        self._kernels()
        self._doors()
        self._others()
        whole = [whole_problem(size, k / 16.0, refined=refined) for k in range(POSITIONS)]
        self._whole_calls(whole[0])
        self.seconds["compression of the factor"] = median_seconds(
            [partial(modal_basis, c.compliance[1]) for c in whole]
        )

    def _kernels(self) -> None:
        starts = [case.scaling.estimated_active for case in self.cases]
        neighbours = [solution.active for solution in self.solutions]
        cold, warm = list(zip(self.scaled, starts, strict=True)), list(zip(self.scaled[1:], neighbours, strict=False))
        if self.size <= LARGEST["Cholesky"]:
            matrix = self.scaled[0].compliance
            self.seconds["Cholesky factor of n x n"] = median_seconds([lambda: dpotrf(matrix.T, lower=1, clean=0)])
        self.seconds["modal, scaled, cold"] = median_seconds([partial(scaled_answer, s, a) for s, a in cold])
        before: list[Callable[[], Any]] = [partial(scaled_answer, s, a) for s, a in warm]
        self.seconds["modal, scaled, warm from the position before"] = median_seconds(before)
        self.iterations = [
            statistics.mean(answered(scaled_answer(s, a))[2] for s, a in those) for those in (cold, warm)
        ]
        self.error = np.nan
        if self.size <= LARGEST["dense active set"]:
            exact = [answered(primal_dual_active_set(s, a)) for s, a in zip(self.scaled, neighbours, strict=True)]
            self.error = max(
                relative_difference(solution.force, case.scaling.unscale_force(answer.force))
                for solution, case, answer in zip(self.solutions, self.cases, exact, strict=True)
            )
            self.seconds["dense active set, cold"] = median_seconds(
                [partial(primal_dual_active_set, s, a) for s, a in cold[:2]]
            )

    def _doors(self) -> None:
        def fresh() -> list[ContactProblem]:
            return [case.with_torque(case.torque) for case in self.cases]  # scaled anew

        def anew(case: ContactProblem, active: Any = None) -> Any:
            return solve(case.with_torque(case.torque), initial_active=active)

        warm = list(zip(self.cases[1:], self.solutions, strict=False))
        self.seconds["solve, cold"] = median_seconds([partial(anew, c) for c in self.cases])
        self.seconds["solve, warm"] = median_seconds([partial(anew, c, s.active) for c, s in warm])
        self.seconds["solve_many, each"] = median_seconds([lambda: solve_many(fresh())]) / POSITIONS
        one, gaps = self.cases[0], np.array([case.separation for case in self.cases])
        torques = np.array([case.torque for case in self.cases])
        seconds = median_seconds([lambda: solve_many(one, separation=gaps, torque=torques)])
        self.seconds["solve_many of arrays, each"] = seconds / POSITIONS

    def _whole_calls(self, given: ContactProblem) -> None:
        """From the user's arrays to the answer, in every form of the compliance."""
        local, factor = (np.array(part) for part in given.compliance)
        forms: dict[str, Any] = {
            "modes known": (local, modal_basis(factor)),
            "V as array": (local, factor),
            "V sparse": (local, csr_array(factor)),
            "V as operator": (local, aslinearoperator(factor)),
        }
        if self.size <= LARGEST["matrix"]:
            matrix = np.array(given.dense_compliance)
            operator = OperatorCompliance(aslinearoperator(matrix), matrix.diagonal())
            forms |= {"C as array": matrix, "C sparse": csr_array(matrix), "C as operator": operator}
        parts = given.separation, given.lever_arm, given.torque
        for form, compliance in forms.items():
            work = partial(lambda compliance: solve(ContactProblem(*parts, compliance)), compliance)
            self.seconds[f"whole call, {form}"] = median_seconds([work])
        if self.size > LARGEST["matrix"]:
            return
        dense = ContactProblem(*parts, matrix)
        scaled, start = dense.scaled(), dense.scaling.estimated_active
        compiled = self.size <= LARGEST_DENSE
        bare = partial(dense_answer, dense) if compiled else partial(primal_dual_active_set, scaled, start)
        self.seconds["bare, C as array"] = median_seconds([bare])
        for name in ("daqp", "piqp"):
            if name in self.given_up or name not in available_solvers():
                continue
            work = partial(lambda name: solve(ContactProblem(*parts, matrix), name), name)
            self.seconds[f"whole call, C as array, {name}"] = median_seconds([work])
            programme, named = dense.as_qp(), partial(qpsolvers.solve_problem, solver=name)
            self.seconds[f"bare, C as array, {name}"] = median_seconds([partial(named, programme)])

    def _others(self) -> None:
        for name in available_solvers():
            if name in ("native", "lemke", "cvxpy") or name in self.given_up:
                continue
            solution = solve(self.cases[0], name)
            taken = median_seconds([partial(solve, c, name) for c in self.cases])
            if solution.certified and solution.polished:
                self.seconds[f"{name}, polished"] = taken
            if taken > PATIENCE or not solution.certified:
                self.given_up.add(name)

    def notes(self) -> list[str]:
        """Size, part that touches, rank, iterations and errors, as text."""
        touching = statistics.mean(float(solution.active.mean()) for solution in self.solutions)
        basis = self.cases[0].modal_basis
        assert basis is not None
        worst = max(solution.certificate.worst for solution in self.solutions)
        counts = [f"{count:.1f}" for count in self.iterations]
        return [
            f"{self.size}",
            f"{100 * touching:.0f}",
            f"{basis.modes.shape[2]}",
            *counts,
            f"{self.error:.0e}",
            f"{worst:.0e}",
        ]


def main() -> None:
    """Print the tables."""
    sizes = tuple(int(word) for word in sys.argv[1:]) or SIZES
    print(f"{platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}, one BLAS thread")
    print()
    for refined in (False, True):
        print("local compliance " + ("grows with n, as under refinement" if refined else "the same for every n"))
        given_up: set[str] = set()
        results = [Rows(size, refined=refined, given_up=given_up) for size in sizes]
        headers = ["n", "touching %", "modes a pair", "cold", "warm", "force error", "certificate"]
        print(tabulate([result.notes() for result in results], headers=headers, disable_numparse=True), "\n")
        names = list(dict.fromkeys(name for result in results for name in result.seconds))
        print("microseconds of processor time (over one Cholesky factorisation of n x n)")
        table = [row_of(name, results) for name in names]
        columns = [f"n = {n}" for n in sizes]
        print(tabulate(table, headers=["", *columns, "exponent, n >= 150"], disable_numparse=True), "\n")
        print("solve, cold: times faster than the fastest backend with an exact answer")
        for result in results:
            others = {name: taken for name, taken in result.seconds.items() if name.endswith("polished")}
            best = min(others, key=lambda name: others[name])
            print(f"  n = {result.size}: {others[best] / result.seconds['solve, cold']:.1f} ({best})")
        print()


def row_of(name: str, results: list[Rows]) -> list[str]:
    """Cells of one way: time at each size, and the exponent of its growth."""
    cells = []
    for result in results:
        unit = result.seconds.get("Cholesky factor of n x n")
        seconds = result.seconds.get(name)
        ratio = "" if unit is None or seconds is None else f" ({seconds / unit:.2g})"
        cells.append("" if seconds is None else f"{1e6 * seconds:.0f}{ratio}")
    known = [(r.size, r.seconds[name]) for r in results if r.size >= 150 and name in r.seconds]
    slope = np.nan
    if len(known) > 1:
        sizes, seconds_of = np.log(np.array(known)).T
        slope = float(np.polyfit(sizes, seconds_of, 1)[0])
    return [name, *cells, f"{slope:.2f}"]


if __name__ == "__main__":
    main()
