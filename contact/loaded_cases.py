"""Solved cases of the loaded contact, and their dataset."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.attributes import labelled
from .compliance.weber_line_contact import WeberLineContact
from .mesh_harmonics import harmonics, peak_to_peak, rms
from .problem.certificate import CERTIFICATE_FIELDS, CERTIFICATE_LIMITS
from .problem.contact_problem import ContactProblem
from .segments import Segments
from .solvers import ContactSolution, Status

Array = NDArray[Any]
HARMONIC_ORDER_COUNT = 10


@dataclass(frozen=True)
class LoadedCase:
    """One torque at one mesh position.

    Parameters
    ----------
    torque, mesh_position
        Their numbers.
    segments
        Potential contact segments.
    solution
        Forces, rotation and certificate.
    problem
        The contact problem with the local compliance of the solution.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> case = cycle.solved([100.0])[0]
    >>> case.problem.torque == 1e3 * cycle.ratio * 100.0
    True
    """

    torque: int
    mesh_position: int
    segments: Segments
    solution: ContactSolution
    problem: ContactProblem


def loaded_dataset(
    segments: list[Segments | None], cases: list[LoadedCase], torques: Array, rotations: Array
) -> xr.Dataset:
    """The group ``/loaded`` of a result.

    Parameters
    ----------
    segments
        Segments of every mesh position (k).
    cases
        Solved cases.
    torques
        Torques at the pinion (t) [N m].
    rotations
        Pinion rotations (k) [rad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> torques = np.array([100.0])
    >>> found = loaded_dataset(cycle.segments.by_position, cycle.solved(torques), torques, cycle.lines.rotations)
    >>> found["load_share"].dims
    ('torque', 'mesh_position', 'pair')
    """
    size = max(s.pair.size for s in segments if s is not None)
    cycle = (torques.size, rotations.size)
    pairs = np.unique(np.concatenate([s.pair for s in segments if s is not None]))
    status = np.full(cycle, Status.INFEASIBLE, dtype=np.int8)
    entries = (*CERTIFICATE_FIELDS, *CERTIFICATE_LIMITS)
    names = ("transmission_error", "edge_share", "iterations", *entries)
    scalars = {name: np.full(cycle, np.nan) for name in names}
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
            "overhang",
        )
    }
    for case in cases:
        solution, at = case.solution, (case.torque, case.mesh_position)
        status[at] = solution.status
        scalars["transmission_error"][at] = 1e6 * solution.rotation
        scalars["iterations"][at] = solution.iterations
        for name in entries:
            scalars[name][at] = getattr(solution.certificate, name)
    if cases:
        sizes = [case.segments.pair.size for case in cases]
        at_cases = np.array([(case.torque, case.mesh_position) for case in cases])
        places = *np.repeat(at_cases, sizes, axis=0).T, np.concatenate([np.arange(size) for size in sizes])
        for name, values in _of_segments(cases).items():
            per_segment[name][places] = values
    certified = status == Status.CERTIFIED
    moment = np.nan_to_num(per_segment["force"]) * np.nan_to_num(per_segment["lever_arm"])
    of_pair = [np.sum(np.where(per_segment["tooth"] == pair, moment, 0.0), axis=2) for pair in pairs]
    on_edges = np.sum(np.where(np.isfinite(per_segment["overhang"]), moment, 0.0), axis=2)
    whole = np.where(certified, np.sum(moment, axis=2), np.nan)
    share = np.stack(of_pair, axis=2) / whole[:, :, None]
    scalars["edge_share"] = on_edges / whole
    error = scalars["transmission_error"]
    data: dict[str, Any] = {name: (("torque", "mesh_position"), value) for name, value in scalars.items()}
    data |= {name: (("torque", "mesh_position", "segment"), value) for name, value in per_segment.items()}
    data["status"] = (("torque", "mesh_position"), status, Status.flag_attributes())
    data["load_share"] = (("torque", "mesh_position", "pair"), share)
    data["pinion_rotation"] = ("mesh_position", rotations)
    data |= rotation_numbers(error)
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
    """The transmission error (t, k) [urad], and its numbers over the mesh cycle, with their dimensions.

    Examples
    --------
    >>> rotation_numbers(np.array([[1.0, 3.0]]))["peak_to_peak"]
    (('torque',), array([2.]))
    """
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
    contact, known = WeberLineContact.joined([here.line_contact for here in segments]), np.isfinite(force)
    point = np.concatenate([here.point for here in segments], axis=1)
    pressure = contact.pressure(force)
    # Of the strip that the pressure is of, the whole one also where an edge cuts it, as of flash temperatures.
    half_width, hertzian = contact.half_width(force), pressure > 0.0
    np.divide(2.0 * force, np.pi * contact.length * pressure, out=half_width, where=hertzian)
    return {
        "force": force,
        "pressure": np.where(known, pressure, np.nan),
        "half_width": np.where(known, half_width, np.nan),
        "gap": 1e3 * np.concatenate([solution.gap for solution in solutions]),
        "separation": np.concatenate([here.separation for here in segments]),
        "length": contact.length,
        "equivalent_radius": contact.equivalent_radius,
        "lever_arm": np.concatenate([here.lever_arm for here in segments]),
        "tooth": np.concatenate([here.pair for here in segments]),
        "lengthwise": point[0],
        "profile": point[1],
        "overhang": np.where(contact.overhang >= 0.0, contact.overhang, np.nan),
    }
