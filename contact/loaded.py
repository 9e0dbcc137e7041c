"""Loaded contact over a mesh cycle: forces, pressures, transmission error at every torque (Kolivand 2009, ch. 3).

From the solved cases follow their dataset, and of a transmission error peak to peak and harmonics over one mesh cycle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import xarray as xr

from ..core.arrays import Array
from ..core.attributes import labelled, ordered
from ..core.checks import array
from ..core.process_settings import one_blas_thread
from .compliance.elastic_model import tooth_fields
from .compliance.weber_line_contact import WeberLineContact
from .line_contact.line_contact_solution import solve_at_torques
from .lines.closest_approach import PASSING_FIELDS
from .lines.contact_lines import contact_splines
from .lines.flank_splines import FlankSplines
from .problem.certificate import CERTIFICATE_FIELDS, CERTIFICATE_LIMITS
from .problem.contact_problem import ContactProblem
from .segments import CycleSegments, HeldMembers, Segments
from .solvers import ContactSolution, SolverChoice, Status

EXTREME_ROUNDS = 6
Peak = tuple[float, float]  # place and value
WINDOW = 4  # samples on either side of an extreme that its place is estimated from
PLACES = np.linspace(0.0, 1.0, 1001)[1:-1]  # between two samples, at which the estimate is looked at


def peak_to_peak(values: Array) -> float:
    """Largest minus smallest value of a cycle (n)."""
    return float(np.max(values) - np.min(values))


def continuous_range(values: Array, at: Callable[[Array], Array], tolerance: float) -> float:
    """Peak to peak of a periodic function, between its samples (n > 6) as well; NaN from any NaN.

    It may be the least of smooth functions: parabolas beside a kink meet at its peak, where it is evaluated anew until
    estimate and value differ by the tolerance. Places are fractions of the period.
    """
    (_, greatest), (_, least) = extremes(values, at, tolerance)
    return greatest - least


def extremes(values: Array, at: Callable[[Array], Array], tolerance: float) -> tuple[Peak, Peak]:
    """Place and value of the greatest and of the least value; arguments as of ``continuous_range``."""
    if not np.all(np.isfinite(values)):
        return (np.nan, np.nan), (np.nan, np.nan)
    windows = [(sign, *window) for sign in (1.0, -1.0) for window in _windows(sign * values)]
    open_ones = list(range(len(windows)))
    for _ in range(EXTREME_ROUNDS):
        estimates = [_estimated(*windows[k][1:]) for k in open_ones]
        samples = at(np.mod([place for place, _ in estimates], 1.0))
        following = []
        for k, (place, estimate), value in zip(open_ones, estimates, samples, strict=True):
            sign, places, heights = windows[k]
            index = np.searchsorted(places, place)
            windows[k] = sign, np.insert(places, index, place), np.insert(heights, index, sign * value)
            if abs(sign * value - estimate) > tolerance:
                following.append(k)
        open_ones = following
        if not open_ones:
            break

    def highest(sign: float) -> Peak:
        value, place = max((w[2][k], w[1][k]) for w in windows if w[0] == sign for k in [np.argmax(w[2])])
        return float(np.mod(place, 1.0)), float(sign * value)

    return highest(1.0), highest(-1.0)


def _windows(values: Array) -> list[tuple[Array, Array]]:
    """Places and values around every sample beside which the greatest value may lie."""
    before, after = np.roll(values, 1), np.roll(values, -1)
    rise = np.maximum(np.abs(values - before), np.abs(values - after))
    high = (values >= before) & (values >= after) & (values + rise >= np.max(values))
    around = np.flatnonzero(high)[:, None] + np.arange(-WINDOW, WINDOW + 1)
    return [(index / values.size, values[index % values.size]) for index in around]


def _estimated(places: Array, values: Array) -> Peak:
    """Place and value of the peak beside the greatest sample of a function that is the least of smooth ones."""
    middle = int(np.clip(np.argmax(values), 3, values.size - 4))
    tried, heights = [], []
    for left in (middle - 1, middle):
        x = places[left] + (places[left + 1] - places[left]) * PLACES
        sides = (slice(left - 2, left + 1), slice(left + 1, left + 4))
        tried.append(x)
        heights.append(np.minimum(*(_parabola(places[side], values[side], x) for side in sides)))
    x, height = np.concatenate(tried), np.concatenate(heights)
    best = int(np.argmax(height))
    return float(x[best]), float(height[best])


def _parabola(places: Array, values: Array, x: Array) -> Array:
    """Parabola through three points, at places (m)."""
    a, b, c = places
    slope, other = (values[1] - values[0]) / (b - a), (values[2] - values[1]) / (c - b)
    return np.asarray(values[0] + (x - a) * (slope + (x - b) * (other - slope) / (c - a)))


def harmonics(values: Array, orders: int = 3) -> Array:
    """Amplitudes (orders) of the first harmonics of a cycle sampled evenly at n points."""
    spectrum = np.abs(np.fft.rfft(values)) * 2.0 / len(values)
    if len(values) % 2 == 0:
        spectrum[-1] /= 2.0  # the highest order of an even sample is not shared with its mirror
    result = np.zeros(orders)
    count = min(orders, spectrum.size - 1)
    result[:count] = spectrum[1 : count + 1]
    return result


def rms(amplitudes: Array) -> float:
    """Root of the sum of the squared amplitudes, as in the dissertation's tables (without the factor 1/sqrt 2)."""
    return float(np.sqrt(np.sum(np.square(amplitudes))))


HARMONIC_ORDER_COUNT = 10


@dataclass(frozen=True)
class LoadedCase:
    """Solution at one torque and one mesh position, given by their numbers."""

    torque: int
    mesh_position: int
    segments: Segments
    solution: ContactSolution
    problem: ContactProblem  # with the local compliance of the solution


def loaded_dataset(
    segments: list[Segments | None], cases: list[LoadedCase], torques: Array, rotations: Array
) -> xr.Dataset:
    """The group ``/loaded`` of a result, from pinion torques (t) [N m] and pinion rotations (k) [rad]."""
    size = max(s.pair.size for s in segments if s is not None)
    cycle = (torques.size, rotations.size)
    pairs = np.unique(np.concatenate([s.pair for s in segments if s is not None]))
    status = np.full(cycle, Status.INFEASIBLE, dtype=np.int8)
    entries = (*CERTIFICATE_FIELDS, *CERTIFICATE_LIMITS)
    scalars = {name: np.full(cycle, np.nan) for name in ("transmission_error", "edge_share", "iterations", *entries)}
    for case in cases:
        solution, at = case.solution, (case.torque, case.mesh_position)
        status[at] = solution.status
        scalars["transmission_error"][at] = 1e6 * solution.rotation
        scalars["iterations"][at] = solution.iterations
        for name in entries:
            scalars[name][at] = getattr(solution.certificate, name)
    sizes = [case.segments.pair.size for case in cases]
    at_cases = np.array([(case.torque, case.mesh_position) for case in cases])
    places = *np.repeat(at_cases, sizes, axis=0).T, np.concatenate([np.arange(size) for size in sizes])
    per_segment = {}
    for name, values in _of_segments(cases).items():
        per_segment[name] = np.full((*cycle, size), np.nan)
        per_segment[name][places] = values
    certified = status == Status.CERTIFIED
    moment = np.nan_to_num(per_segment["force"]) * np.nan_to_num(per_segment["lever_arm"])
    of_pair = [np.sum(np.where(per_segment["tooth"] == pair, moment, 0.0), axis=2) for pair in pairs]
    on_edges = np.sum(np.where(np.isfinite(per_segment["overhang"]), moment, 0.0), axis=2)
    whole = np.where(certified, np.sum(moment, axis=2), np.nan)
    scalars["edge_share"] = on_edges / whole
    data: dict[str, Any] = {name: (("torque", "mesh_position"), value) for name, value in scalars.items()}
    data |= {name: (("torque", "mesh_position", "segment"), value) for name, value in per_segment.items()}
    data["status"] = (("torque", "mesh_position"), status, Status.flag_attributes())
    data["load_share"] = (("torque", "mesh_position", "pair"), np.stack(of_pair, axis=2) / whole[:, :, None])
    data["pinion_rotation"] = ("mesh_position", rotations)
    data |= rotation_numbers(scalars["transmission_error"])
    pressure = per_segment["pressure"].reshape(torques.size, -1)
    # Where sharp edges carry all of the load, there is no pressure to compare: what carries nothing does not count.
    greatest = np.where(pressure > 0.0, pressure, -np.inf).max(axis=1)
    data["max_pressure"] = ("torque", np.where(np.isfinite(greatest), greatest, np.nan))
    coords = {
        "torque": torques,
        "mesh_position": np.arange(rotations.size) / rotations.size,
        "order": np.arange(1, HARMONIC_ORDER_COUNT + 1),
        "pair": pairs,
    }
    line_contact = next(s.line_contact for s in segments if s is not None)
    attributes: dict[str, Any] = {
        "contact_modulus_MPa": 2.0 / line_contact.flexibility,
        "searched_segments": sum(int(np.count_nonzero(s.searched)) for s in segments if s is not None),
    }
    failures = [case.solution.message for case in cases if not case.solution.certified]
    attributes |= {"first_failure": failures[0]} if failures else {}
    return labelled(xr.Dataset(data, coords=coords, attrs=attributes))


def rotation_numbers(error: Array) -> dict[str, tuple[tuple[str, ...], Array]]:
    """The transmission error (t, k) [urad] and its numbers over the mesh cycle, with their dimensions."""
    amplitudes = np.array([harmonics(row, HARMONIC_ORDER_COUNT) for row in error])
    return {
        "transmission_error": (("torque", "mesh_position"), error),
        "peak_to_peak": (("torque",), np.array([peak_to_peak(row) for row in error])),
        "mean_level": (("torque",), error.mean(axis=1)),
        "rms": (("torque",), np.array([rms(row[:3]) for row in amplitudes])),
        "harmonic": (("torque", "order"), amplitudes),
    }


def _of_segments(cases: list[LoadedCase]) -> dict[str, Array]:
    """Values of the segments of all cases, one after the other."""
    segments, solutions = [case.segments for case in cases], [case.solution for case in cases]
    force = np.concatenate([solution.force for solution in solutions])
    contact, known = WeberLineContact.joined([group.line_contact for group in segments]), np.isfinite(force)
    point = np.concatenate([group.point for group in segments], axis=1)
    pressure = contact.pressure(force)
    # Of the strip that the pressure is of, the whole one also where an edge cuts it, as of flash temperatures.
    half_width, hertzian = contact.half_width(force), pressure > 0.0
    np.divide(2.0 * force, np.pi * contact.length * pressure, out=half_width, where=hertzian)
    return {
        "force": force,
        "pressure": np.where(known, pressure, np.nan),
        "gap": 1e3 * np.concatenate([solution.gap for solution in solutions]),
        "half_width": np.where(known, half_width, np.nan),
        "separation": np.concatenate([group.separation for group in segments]),
        "length": contact.length,
        "equivalent_radius": contact.equivalent_radius,
        "lever_arm": np.concatenate([group.lever_arm for group in segments]),
        "tooth": np.concatenate([group.pair for group in segments]),
        "lengthwise": point[0],
        "profile": point[1],
        "overhang": np.where(contact.overhang >= 0.0, contact.overhang, np.nan),
    }


EDGE_SEARCH_ROTATION_MINIMUM = 1e-5  # [rad]; start of a search without a known rotation
EDGE_SEARCH_ROTATION_LIMIT = 0.02  # [rad]; beyond it no edge is met
EDGE_SEARCH_POSITIONS = 2  # mesh positions at which the rotation is found first, to search edges for all
EDGE_SEARCH_ROTATION_FACTOR = 1.1  # times the rotation within which an edge must be met to be taken in


def loaded_splines(flanks: xr.Dataset, ease_off: xr.Dataset, teeth: xr.Dataset) -> FlankSplines:
    """Splines of everything the loaded contact needs on the gear flank, from ``geometry.pair_geometry``."""
    passing = {name: ordered(ease_off, name, "lengthwise", "profile") for name in PASSING_FIELDS}
    return contact_splines(flanks, ease_off, tooth_fields(teeth) | passing)


@dataclass(frozen=True)
class CycleSolver:
    """Solver of the loaded contact over a mesh cycle, see ``MeshCycle.loaded``."""

    ratio: float
    edge_contact: bool = True
    solver: SolverChoice = "auto"
    options: Mapping[str, Any] = field(default_factory=dict)
    progress: Callable[[], None] | None = None
    greater: Sequence[LoadedCase] = ()

    @one_blas_thread()
    def loaded(self, cycle: CycleSegments, torques: Array) -> tuple[xr.Dataset, list[LoadedCase]]:
        """Dataset and cases at pinion torques (t) [N m]."""
        torques = array("torques", torques, "N m", ndim=1, fewest=1, above=0.0)
        segments, cases = self.cases(cycle, torques)
        return loaded_dataset(segments, cases, torques, cycle.on_lines.lines.rotations), cases

    def cases(
        self, cycle: CycleSegments, torques: Array, members: HeldMembers | None = None
    ) -> tuple[list[Segments | None], list[LoadedCase]]:
        """Segments that may touch at every mesh position, and the solved cases.

        With supports (``members``), the segments must know their wrenches.
        """

        def on_supports(segments: list[Segments | None]) -> list[Segments | None]:
            return segments if members is None else members.holding(segments)

        count = cycle.on_lines.lines.rotations.size
        if self.greater:
            segments: list[Segments | None] = [None] * count
            for case in self.greater:
                segments[case.mesh_position] = case.segments
            return segments, self.solved(segments, torques)
        if not self.edge_contact:
            segments = on_supports(cycle.by_position)
            return segments, self.solved(segments, torques)
        # Edges can only hold the pair back: with contact on lines alone it turns farther.
        some = on_supports(cycle.to_edges.at_every(max(count // EDGE_SEARCH_POSITIONS, 1)))
        turned = _turned(CycleSolver(self.ratio).solved(some, np.array([torques.max()])), count, members)
        farthest = EDGE_SEARCH_ROTATION_FACTOR * max(float(turned.max()), EDGE_SEARCH_ROTATION_MINIMUM)
        widest, solver = np.full(count, farthest), self
        while True:
            segments = on_supports(cycle.with_edges(widest))
            cases = solver.solved(segments, torques)
            turned = _turned(cases, count, members)
            # Where there is no line the pair turns until edges hold it, and may meet further ones.
            turned[[group is None for group in segments]] = 2.0 * widest.max()
            if np.all((turned <= widest) | (widest > EDGE_SEARCH_ROTATION_LIMIT)):
                return segments, cases
            widest, solver = np.maximum(widest, EDGE_SEARCH_ROTATION_FACTOR * turned), replace(self, progress=None)

    def solved(self, segments: list[Segments | None], torques: Array) -> list[LoadedCase]:
        """Cases at all pinion torques (t) [N m] wherever tooth pairs can touch, each starting from the one before."""
        present = [(k, group) for k, group in enumerate(segments) if group is not None]
        contacts = [group.line_contact for _, group in present]
        order, problems = np.argsort(torques, kind="stable"), [group.bending_problem for _, group in present]
        cases = []
        by_torque = solve_at_torques(problems, contacts, 1e3 * self.ratio * torques[order], self.solver, **self.options)
        for index, solved in zip(order, by_torque, strict=True):
            for (k, group), (solution, secant) in zip(present, solved, strict=True):
                cases.append(LoadedCase(int(index), k, group, solution, secant))
                if self.progress is not None:
                    self.progress()
        return sorted(cases, key=lambda case: (case.mesh_position, float(torques[case.torque])))


def _turned(cases: list[LoadedCase], positions: int, members: HeldMembers | None) -> Array:
    """Greatest gap that closes at every mesh position, as a gear rotation [rad]; zero where nothing was solved."""
    turned = np.zeros(positions)
    for case in cases:
        if case.solution.certified:
            closing = 0.0 if members is None else members.closing(case.segments, case.solution.force)
            turned[case.mesh_position] = max(turned[case.mesh_position], case.solution.rotation + closing)
    return turned
