"""Loaded contact over a mesh cycle: forces, pressures, transmission error at every torque (Kolivand 2009, ch. 3)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from dataclasses import fields as dataclass_fields
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.attributes import labelled
from ..core.errors import InputError
from .bending import ElasticModel, shells, tooth_fields, whitened_loads
from .certificate import Certificate
from .compliance import WeberLineContact
from .curves import contact_fields
from .fields import FlankFields
from .harmonics import harmonics, peak_to_peak, rms
from .line_contact_solution import solve_line_contact
from .problem import ContactProblem
from .segments import MeshLines, closest_approach, gauss_points
from .solvers import ContactSolution, Status

Array = NDArray[Any]
CERTIFICATE = tuple(field.name for field in dataclass_fields(Certificate))
ORDERS = 10
SMALLEST_DEPTH = 0.05  # [mm]; nearer to a sharp edge than this there is no half space for a line contact
SMALLEST_CURVATURE = 1e-5  # [1/mm]; flanks that fit closer than this make no line contact, and a wider band is no harm


@dataclass(frozen=True)
class Segments:
    """Potential contact segments of one mesh position (n).

    Parameters
    ----------
    pair
        Tooth pair of each segment.
    place
        Lengthwise and profile fractions on the gear (2, n).
    separation_angle
        Gap as a gear rotation [rad].
    lever_arm, length, equivalent_radius
        [mm].
    bending
        Compliance (n, n) of teeth and roots [mm/N].
    line_contact
        Local compliance.
    """

    pair: NDArray[np.int64]
    place: Array
    separation_angle: Array
    lever_arm: Array
    length: Array
    equivalent_radius: Array
    bending: Array
    line_contact: WeberLineContact

    @property
    def separation(self) -> Array:
        """Normal gap (n) [mm]."""
        return np.asarray(self.separation_angle * self.lever_arm)


def all_segments(
    fields: FlankFields, teeth: xr.Dataset, model: ElasticModel, mesh: MeshLines, count: int
) -> list[Segments | None]:
    """Segments of every mesh position, with their compliance.

    Parameters
    ----------
    fields
        Splines of ``curves.contact_fields`` and ``bending.tooth_fields``.
    teeth
        The geometry's ``teeth``.
    model
        How the teeth give way.
    mesh
        Contact lines from ``segments.lines_in_mesh``.
    count
        Segments per contact line.

    Returns
    -------
    list
        One entry a mesh position; ``None`` where no tooth pair can touch.
    """
    lines = mesh.lines
    points, weights = gauss_points(lines, count)
    closest = closest_approach(fields, points)
    # Two depths and all segments at once: the splines cost more to call than to evaluate.
    shape = (lines.level.size, count, weights.size)
    depths = fields.evaluate(["depth_pinion", "depth_gear"], points)
    averaged = (closest.separation_angle, closest.lever_arm, closest.curvature, *depths.values())
    means = [np.reshape(v, shape) @ weights for v in averaged]
    place = np.reshape(points, (2, *shape)) @ weights
    per_segment = np.reshape(points, (2, -1, weights.size))
    whitened = whitened_loads(shells(teeth, model), fields, per_segment, weights)
    length = np.repeat(lines.length / count, count).reshape(shape[:2])
    result: list[Segments | None] = []
    for k in range(mesh.rotations.size):
        chosen = np.flatnonzero(mesh.position == k)
        if chosen.size == 0:
            result.append(None)
            continue
        angles, arms, curvature, pinion_depth, gear_depth = (m[chosen].ravel() for m in means)
        columns = (chosen[:, None] * count + np.arange(count)).ravel()
        pairs = np.repeat(mesh.pair[chosen], count)
        factor = whitened[:, columns]
        # Segments on different teeth are coupled through the blanks alone, which are taken as rigid.
        bending = np.where(pairs[:, None] == pairs[None, :], factor.T @ factor, 0.0)
        lengths = length[chosen].ravel()
        radii = 1.0 / np.maximum(curvature, SMALLEST_CURVATURE)
        depths_at = (np.maximum(depth, SMALLEST_DEPTH) for depth in (pinion_depth, gear_depth))
        contact = WeberLineContact(lengths, radii, *depths_at, model.pinion, model.gear)
        result.append(Segments(pairs, place[:, chosen].reshape(2, -1), angles, arms, lengths, radii, bending, contact))
    return result


@dataclass(frozen=True)
class LoadedCase:
    """One torque at one mesh position."""

    torque: int
    mesh_position: int
    segments: Segments
    solution: ContactSolution
    problem: ContactProblem


def solve_all(
    segments: list[Segments | None], torques: Array, ratio: float, solver: str, options: dict[str, Any]
) -> Iterator[LoadedCase | tuple[int, int]]:
    """Solve every torque at every mesh position, each torque starting from the one before.

    Yields
    ------
    LoadedCase or tuple
        The case, or (torque, mesh position) where no tooth pair can touch.
    """
    order = np.argsort(torques)
    for k, here in enumerate(segments):
        start: Array | None = None
        for index in order:
            if here is None:
                yield int(index), k
                continue
            solution, problem = solve_line_contact(
                here.separation,
                here.lever_arm,
                1e3 * ratio * float(torques[index]),
                here.bending,
                here.line_contact,
                solver,
                initial_force=start,
                **options,
            )
            start = solution.force if solution.status == Status.CERTIFIED else None
            yield LoadedCase(int(index), k, here, solution, problem)


def loaded_fields(flanks: xr.Dataset, ease_off: xr.Dataset, teeth: xr.Dataset) -> FlankFields:
    """Splines of everything the loaded contact needs on the gear flank."""
    return contact_fields(flanks, ease_off, tooth_fields(teeth))


def loaded_contact(
    fields: FlankFields,
    teeth: xr.Dataset,
    mesh: MeshLines,
    *,
    ratio: float,
    torques: Array,
    model: ElasticModel | None = None,
    segments_per_line: int = 31,
    solver: str = "auto",
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> tuple[xr.Dataset, list[LoadedCase]]:
    """Loaded contact over one mesh cycle.

    Parameters
    ----------
    fields
        Splines from ``loaded_fields``.
    teeth
        The geometry's ``teeth``.
    mesh
        Contact lines from ``segments.lines_in_mesh``.
    ratio
        Gear teeth over pinion teeth.
    torques
        Torques at the pinion (t) [N m].
    model
        How the teeth give way.
    segments_per_line
        Segments of a contact line.
    solver
        Name of the solver, see ``solvers.available_solvers``.
    progress
        Called after every solved case.
    **options
        Passed to the solver.

    Returns
    -------
    tuple
        The dataset over (torque, mesh_position, segment), and every case with its contact problem.

    Raises
    ------
    InputError
        If a torque is not positive.
    """
    torques = np.asarray(torques, dtype=float)
    if torques.size == 0 or not np.all(np.isfinite(torques) & (torques > 0.0)):
        raise InputError(f"torques = {torques.tolist()}: every torque must be a positive number in N m")
    segments = all_segments(fields, teeth, model or ElasticModel(), mesh, segments_per_line)
    cases = []
    for case in solve_all(segments, torques, ratio, solver, options):
        if isinstance(case, LoadedCase):
            cases.append(case)
        if progress is not None:
            progress()
    return _dataset(segments, cases, torques, mesh.rotations), cases


def _dataset(segments: list[Segments | None], cases: list[LoadedCase], torques: Array, rotations: Array) -> xr.Dataset:
    """The tree's ``/loaded`` group from the solved cases."""
    size = max(s.pair.size for s in segments if s is not None)
    cycle = (torques.size, rotations.size)
    pairs = np.unique(np.concatenate([s.pair for s in segments if s is not None]))
    status = np.full(cycle, Status.INFEASIBLE, dtype=np.int8)
    scalars = {name: np.full(cycle, np.nan) for name in ("transmission_error", "iterations", *CERTIFICATE)}
    per_segment = {
        name: np.full((*cycle, size), np.nan)
        for name in (
            "force",
            "pressure",
            "gap",
            "half_width",
            "separation",
            "length",
            "equivalent_radius",
            "lever_arm",
            "tooth",
            "lengthwise",
            "profile",
        )
    }
    share = np.full((*cycle, pairs.size), np.nan)
    for case in cases:
        here, solution, at = case.segments, case.solution, (case.torque, case.mesh_position)
        status[at] = solution.status
        scalars["transmission_error"][at] = 1e6 * solution.rotation
        scalars["iterations"][at] = solution.iterations
        for name in CERTIFICATE:
            scalars[name][at] = getattr(solution.certificate, name)
        certified = solution.status == Status.CERTIFIED
        nothing = np.full(here.pair.size, np.nan)
        values = {
            "force": solution.force,
            "pressure": here.line_contact.pressure(solution.force) if certified else nothing,
            "half_width": here.line_contact.half_width(solution.force) if certified else nothing,
            "gap": 1e3 * solution.gap,
            "separation": here.separation,
            "length": here.length,
            "equivalent_radius": here.equivalent_radius,
            "lever_arm": here.lever_arm,
            "tooth": here.pair,
            "lengthwise": here.place[0],
            "profile": here.place[1],
        }
        for name, value in values.items():
            per_segment[name][at][: here.pair.size] = value
        if certified:
            moment = solution.force * here.lever_arm
            share[at] = [np.sum(moment[here.pair == p]) / np.sum(moment) for p in pairs]
    error = scalars["transmission_error"]
    amplitudes = np.array([harmonics(row, ORDERS) for row in error])
    data: dict[str, Any] = {name: (("torque", "mesh_position"), value) for name, value in scalars.items()}
    data |= {name: (("torque", "mesh_position", "segment"), value) for name, value in per_segment.items()}
    data["status"] = (("torque", "mesh_position"), status, Status.flag_attributes())
    data["load_share"] = (("torque", "mesh_position", "pair"), share)
    data["pinion_rotation"] = ("mesh_position", rotations)
    data["peak_to_peak"] = ("torque", [peak_to_peak(row) for row in error])
    data["mean_level"] = ("torque", error.mean(axis=1))
    data["rms"] = ("torque", [rms(row[:3]) for row in amplitudes])
    data["harmonic"] = (("torque", "order"), amplitudes)
    pressure = per_segment["pressure"].reshape(torques.size, -1)
    greatest = np.where(np.isfinite(pressure), pressure, -np.inf).max(axis=1)
    data["max_pressure"] = ("torque", np.where(np.isfinite(greatest), greatest, np.nan))
    coords = {
        "torque": torques,
        "mesh_position": np.arange(rotations.size) / rotations.size,
        "order": np.arange(1, ORDERS + 1),
        "pair": pairs,
    }
    return labelled(xr.Dataset(data, coords=coords))
