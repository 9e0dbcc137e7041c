"""Cost of a tolerance study of one pair: E, P, G and Sigma sampled, two torques; measured on a part of it.

Usage: python benchmarks/sweep.py [CASE] [SAMPLES]

Prints the processor time of a sample with both torques, what 40,000 points (20,000 samples at two torques, or 40,000
samples) take of one core, the memory, and how much faster two processes are than one.
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import resource
import sys
import time

import easeoff
import xarray as xr
from easeoff.study.sweep import parameter_sweep

POINT_COUNT = 40_000
TORQUES = [100.0, 250.0]
TOLERANCES = {"E": "normal(0,0.03)", "P": "normal(0,0.03)", "G": "normal(0,0.03)", "Sigma": "normal(0,0.02)"}


def measured(case: str, samples: int, workers: int) -> tuple[xr.Dataset, float, float]:
    """A sweep with its time on the clock and its processor time [s], that of its processes included."""
    start, before = time.perf_counter(), processor_time()
    found = easeoff.sweep(case, {**TOLERANCES, "torque": TORQUES}, samples=samples, workers=workers)
    return found, time.perf_counter() - start, processor_time() - before


def processor_time() -> float:
    """Processor time of this process and of those it started that have ended [s]."""
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, USERS))


USERS = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)


def main() -> None:
    """Measure and print."""
    case = sys.argv[1] if len(sys.argv) > 1 else "fm-11x41"
    samples = int(sys.argv[2]) if len(sys.argv) > 2 else 400
    easeoff.sweep(case, {"E": [0.0]}, torques=TORQUES, workers=1)  # elastic teeth made, kernels compiled
    parameter_sweep.POOL_TIME = 0.0
    alone, clock, used = measured(case, samples, 1)
    memory = [resource.getrusage(user).ru_maxrss / 1e6 for user in USERS]
    shared, clock_of_two, used_by_two = measured(case, samples, 2)
    memory = [max(memory[0], resource.getrusage(user).ru_maxrss / 1e6) for user in USERS]
    each = used / samples
    bad = int((alone["status"] != 0).sum())
    print(f"{case}: {samples} samples of E, P, G and Sigma at {len(TORQUES)} torques, {bad} points not certified")
    print(f"a sample with both torques: {1e3 * each:.0f} ms of processor, {1e3 * clock / samples:.0f} ms on the clock")
    print(f"{POINT_COUNT} points, two a sample: {each * POINT_COUNT / 2 / 3600:.2f} core-hours")
    print(f"{POINT_COUNT} samples at both torques: {each * POINT_COUNT / 3600:.2f} core-hours")
    print(f"greatest memory of a process: {max(memory):.2f} GB")
    print(f"two processes: {clock / clock_of_two:.2f} times as fast as one, with {used_by_two / used:.2f} of its work")
    other = [str(name) for name in alone.variables if not alone[name].identical(shared[name])]
    print(f"the numbers of both are {'not the same: ' + ', '.join(other) if other else 'the same to the bit'}")


if __name__ == "__main__":
    main()
