"""Front of two objectives by convex programmes and by NSGA-II: the same pair, settings, limits and analysis.

Usage: python benchmarks/genetic_front.py [CASE] [--torque T] [--free PATTERN] [--points N] [--population N]
[--generations N] [--seed N] [--result FILE] [--picture FILE]

Prints both fronts, what each took, and their hypervolumes over the number of analyses; draws both into a
picture. Needs pymoo (the extra ``genetic``). The contact is coarse: 8 mesh positions, 15 segments a line. The root
line is limited for both; where NSGA-II passes that limit, no contact is analysed, and none is counted.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import argparse
import time
from typing import Any

import easeoff
import numpy as np
import xarray as xr
from easeoff.cases.schema.case_schema import Case
from easeoff.study.case_in_mesh import CaseInMesh, prepared_pair
from easeoff.study.design.optimization.analysed_settings import blade_tip_gaps, usual_root_line_change
from easeoff.study.design.optimization.free_setting import SettingSpace, free_settings
from numpy.typing import NDArray

Array = NDArray[np.float64]

OBJECTIVES = ("peak_to_peak", "max_pressure")
COARSE = {"mesh_positions": 8, "segments_per_line": 15, "lengthwise_nodes": 15, "profile_nodes": 11}
#: Ratio to the start of settings that cannot be analysed.
FAILED = 100.0
SHARES = (0.5, 0.8, 0.9, 0.95, 1.0)


def coarse_case(name: str, torque: float) -> Case:
    """A shipped case with coarse contact at one torque."""
    case = easeoff.read_case(name)
    return case.model_copy(update={"contact": case.contact.model_copy(update={**COARSE, "torques": (torque,)})})


class Evaluator:
    """Both objectives of settings, by an analysis with held teeth, and how far they pass the limit of the root line."""

    def __init__(self, case: Case, free: list[str] | None) -> None:
        self.state = CaseInMesh.of(case)
        self.space = SettingSpace(case, free_settings(case, ["drive"], free))
        self.torques = list(case.contact.torques)
        self.gaps = blade_tip_gaps(self.state.pair)
        self.limit = usual_root_line_change([self.state.pair])
        self.start = self.values(self.space.case_at(self.space.start))
        self.analyses = 0

    def values(self, case: Case) -> Array:
        """Peak to peak [urad] and greatest pressure [MPa]."""
        state = self.state.recut(case)
        loaded, _ = state.cycle.loaded(self.torques, edge_contact=case.contact.edge_contact)
        return np.array([loaded[name].item() for name in OBJECTIVES])

    def passed(self, case: Case) -> float:
        """Change of the root line over its limit, less one."""
        change = blade_tip_gaps(prepared_pair(case, "drive", None)) - self.gaps
        return float(np.abs(change).max()) / self.limit - 1.0

    def judged(self, settings: Array) -> tuple[Array, float]:
        """Objectives over the start, and by how much the limit is passed; analysed where it is not."""
        try:
            case = self.space.case_at(settings)
            passed = self.passed(case)
            if not passed <= 0.0:
                return np.full(2, FAILED), passed if np.isfinite(passed) else FAILED
            self.analyses += 1
            found = self.values(case) / self.start
        except easeoff.EaseoffError:
            return np.full(2, FAILED), FAILED
        return np.where(np.isfinite(found), found, FAILED), passed


def genetic(
    evaluator: Evaluator, low: Array, high: Array, population: int, generations: int, seed: int
) -> list[tuple[int, Array]]:
    """The front of NSGA-II after every generation, with the analyses so far."""
    history: list[tuple[int, Array]] = []
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import ElementwiseProblem
    from pymoo.optimize import minimize

    class Problem(ElementwiseProblem):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(n_var=low.size, n_obj=2, n_ieq_constr=1, xl=low, xu=high)

        def _evaluate(self, x: Array, out: dict[str, Any], *_args: Any, **_kwargs: Any) -> None:
            out["F"], out["G"] = evaluator.judged(x)

    def told(algorithm: Any) -> None:
        feasible = algorithm.opt.get("feasible").ravel()
        history.append((evaluator.analyses, np.asarray(algorithm.opt.get("F"))[feasible]))

    minimize(Problem(), NSGA2(pop_size=population), ("n_gen", generations), seed=seed, callback=told)
    return history


def hypervolume(ratios: Array) -> float:
    """Area that a front dominates below the start."""
    area, best = 0.0, 1.0
    for first, second in ratios[np.argsort(ratios[:, 0])]:
        if first < 1.0 and second < best:
            area += (1.0 - first) * (best - second)
            best = second
    return area


def growth(front: xr.Dataset) -> list[tuple[int, Array]]:
    """Front of the convex programmes with the analyses so far, as ``genetic`` has it."""
    counts, ratios = front["front_analyses"].values, front["front_ratio"].values
    return [(int(count), ratios[counts <= count]) for count in np.unique(counts)]


def reached(history: list[tuple[int, Array]], area: float) -> str:
    """After how many analyses a hypervolume was reached."""
    return str(next((count for count, found in history if hypervolume(found) >= area), "never"))


def parsed() -> argparse.Namespace:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(description="Front of two objectives by convex programmes and by NSGA-II.")
    parser.add_argument("case", nargs="?", default="nasa-12x36")
    parser.add_argument("--torque", type=float, default=150.0)
    parser.add_argument("--free", action="append")
    parser.add_argument("--points", type=int, default=5)
    parser.add_argument("--population", type=int, default=30)
    parser.add_argument("--generations", type=int, default=80)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--result")
    parser.add_argument("--picture")
    return parser.parse_args()


def main() -> None:
    """Run both and print."""
    given = parsed()
    case = coarse_case(given.case, given.torque)
    before = time.process_time()
    tree = easeoff.optimize(case, OBJECTIVES, form="pareto", points=given.points, free=given.free)
    used = time.process_time() - before
    front, record = tree["front"].to_dataset(), tree["optimal_settings"].to_dataset()
    evaluator = Evaluator(case, given.free)
    before = time.process_time()
    for _ in range(5):
        evaluator.values(case)
    each = (time.process_time() - before) / 5.0
    if given.result is not None:
        easeoff.write_result(tree, given.result)
    own = growth(front)
    area = hypervolume(own[-1][1])
    start = evaluator.start.round(2).tolist()
    print(f"{given.case}, {given.torque:g} N m, {record.sizes['setting']} settings; start {start}")
    print(f"one analysis takes {each:.3f} s")
    counts = [record.attrs[name] for name in ("analyses", "differentiated_analyses", "teeth_built")]
    print("convex programmes: {} analyses, {} with derivatives, teeth built {} times".format(*counts))
    print(f"processor time of {used / each:.0f} analyses")
    print(np.array2string(front["front_value"].values, precision=2))
    for count, ratios in own:
        print(f"after {count} analyses {len(ratios)} points, hypervolume {hypervolume(ratios):.4f}", flush=True)
    before = time.process_time()
    limits = record["setting_low"].values, record["setting_high"].values
    history = genetic(evaluator, *limits, given.population, given.generations, given.seed)
    ratios = history[-1][1]
    print(f"NSGA-II: {history[-1][0]} analyses, processor time of {(time.process_time() - before) / each:.0f}")
    print(np.array2string(ratios[np.argsort(ratios[:, 1])] * evaluator.start, precision=2))
    for count, found in history[:: max(1, len(history) // 12)]:
        print(f"after {count} analyses hypervolume {hypervolume(found):.4f}")
    print(f"at the end hypervolume {hypervolume(ratios):.4f}")
    for share in SHARES:
        part = f"{100.0 * share:.0f} % of the hypervolume {area:.4f}"
        print(f"{part}: programmes after {reached(own, share * area)}, NSGA-II after {reached(history, share * area)}")
    if given.picture is not None:
        others = {f"NSGA-II, {history[-1][0]} analyses": ratios * evaluator.start}
        easeoff.plot.front(tree, others=others).savefig(given.picture, dpi=100)


if __name__ == "__main__":
    main()
