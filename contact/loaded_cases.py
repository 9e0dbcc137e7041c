"""What the loaded contact works on and makes: segments of a mesh position, solved cases, and their dataset."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import fields as dataclass_fields
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.attributes import labelled
from .compliance import WeberLineContact
from .harmonics import harmonics, peak_to_peak, rms
from .problem.certificate import Certificate
from .problem.contact_problem import ContactProblem
from .problem.modal_basis import ModalBasis
from .solvers import ContactSolution, Status

Array = NDArray[Any]
CERTIFICATE = tuple(field.name for field in dataclass_fields(Certificate))
ORDERS = 10


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
    lever_arm
        Of the normal force about the gear axis [mm].
    bending
        Compliance of teeth and roots in modes, a block for every tooth pair.
    line_contact
        Local compliance.
    searched
        Where flanks bend over so short a way that their closest approach was searched for, see ``closest_approach``.
    """

    pair: NDArray[np.int64]
    place: Array
    separation_angle: Array
    lever_arm: Array
    bending: ModalBasis
    line_contact: WeberLineContact
    searched: NDArray[np.bool_]

    @property
    def separation(self) -> Array:
        """Normal gap (n) [mm]."""
        return np.asarray(self.separation_angle * self.lever_arm)

    @property
    def length(self) -> Array:
        """Length along the contact line (n) [mm]."""
        return self.line_contact.length

    @property
    def equivalent_radius(self) -> Array:
        """Radius of relative curvature across the contact line (n) [mm]."""
        return self.line_contact.equivalent_radius

    @property
    def overhang(self) -> Array:
        """How far beyond a tooth edge the flanks would come closest (n) [mm]; NaN on contact lines."""
        return self.line_contact.overhang

    @cached_property
    def bending_problem(self) -> ContactProblem:
        """The contact problem without local compliance and without torque."""
        nothing = np.zeros(self.pair.size)
        return ContactProblem.of_modes(self.separation, self.lever_arm, 0.0, nothing, self.bending)


@dataclass(frozen=True)
class LoadedCase:
    """One torque at one mesh position."""

    torque: int
    mesh_position: int
    segments: Segments
    solution: ContactSolution
    problem: ContactProblem


def loaded_dataset(
    segments: list[Segments | None], cases: list[LoadedCase], torques: Array, rotations: Array
) -> xr.Dataset:
    """The tree's ``/loaded`` group from the solved cases."""
    size = max(s.pair.size for s in segments if s is not None)
    cycle = (torques.size, rotations.size)
    pairs = np.unique(np.concatenate([s.pair for s in segments if s is not None]))
    status = np.full(cycle, Status.INFEASIBLE, dtype=np.int8)
    names = ("transmission_error", "edge_share", "iterations", *CERTIFICATE)
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
            "overhang": here.overhang,
        }
        for name, value in values.items():
            per_segment[name][at][: here.pair.size] = value
        if certified:
            moment = solution.force * here.lever_arm
            share[at] = [np.sum(moment[here.pair == p]) / np.sum(moment) for p in pairs]
            scalars["edge_share"][at] = np.sum(moment[np.isfinite(here.overhang)]) / np.sum(moment)
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
    line_contact = next(s.line_contact for s in segments if s is not None)
    attributes = {
        "contact_modulus_MPa": 2.0 / line_contact.flexibility,
        "searched_segments": sum(int(np.count_nonzero(s.searched)) for s in segments if s is not None),
    }
    return labelled(xr.Dataset(data, coords=coords, attrs=attributes))
