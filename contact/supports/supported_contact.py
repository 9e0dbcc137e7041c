"""Loaded contact of a pair on its supports, with the motion of its members under load."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ..loaded_cases import LoadedCase, loaded_dataset, rotation_numbers
from .assembly_rounds import AssemblyRounds, CycleInAssembly, FoundRound
from .relative_motion import PARTS
from .support_datasets import misalignment_dataset, supports_dataset
from .supported_pair import SupportedPair, cycle_mean

Array = NDArray[np.float64]


@frozen_arrays
@dataclass(frozen=True, eq=False)
class SupportedContact:
    """Loaded contact on supports at torques (t) and mesh positions (k).

    Parameters
    ----------
    pair
        The pair and its supports.
    torques
        Torques at the pinion (t) [N m].
    rounds
        Last rounds of all torques.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.contact.supports.support import Support, Supports
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=9)
    >>> spring = Support((0.0, 0.0, 0.0), np.diag([5e-6, 5e-6, 5e-6, 1e-10, 1e-10, 1e-10]))
    >>> found = cycle.supported([100.0], Supports(spring, spring))
    >>> found.misalignment["offset"].dims
    ('torque', 'mesh_position')
    """

    pair: SupportedPair
    torques: Array
    rounds: tuple[FoundRound, ...]

    @classmethod
    def of(cls, pair: SupportedPair, torques: Array, rounds: AssemblyRounds) -> SupportedContact:
        """Solve the contact of a pair on its supports."""
        return cls(pair, torques, tuple(pair.solved(torques, rounds)))

    @cached_property
    def cases(self) -> list[LoadedCase]:
        """Every solved case with its contact problem."""
        found = [replace(case, torque=one.torques[case.torque]) for one in self.rounds for case in one.found.cases]
        return sorted(found, key=lambda case: (case.mesh_position, float(self.torques[case.torque])))

    @cached_property
    def assemblies(self) -> list[tuple[tuple[int, ...], CycleInAssembly]]:
        """Numbers of the torques and the pair in the assembly of their geometry."""
        return [(one.torques, one.found.cycle) for one in self.rounds]

    def over_torque(self, name: str) -> Array:
        """An array of the rounds over all torques (t, ...)."""
        found = {number: getattr(one.found, name)[i] for one in self.rounds for i, number in enumerate(one.torques)}
        return np.stack([found[number] for number in range(self.torques.size)])

    @property
    def mesh_wrench(self) -> Array:
        """Force and moment of the gear on the pinion about the origin of the global frame (t, k, 6) [N, N mm]."""
        return self.over_torque("wrench")

    @property
    def transmission_error(self) -> Array:
        """Rotation of the gear (t, k) [rad] against the drive sense, without ``support_rotation``."""
        return np.asarray(self.over_torque("rotation") - self.support_rotation[:, None])

    @property
    def support_rotation(self) -> Array:
        """Rotation of the gear by the supports (t) [rad], on average over the mesh cycle.

        By the rotations of both members within their relative motion, and by the first contact in the assembly found.
        How it varies over the cycle belongs to the transmission error: E, P, G and Sigma vary with it, and turn the
        gear as well.
        """
        parts, ratio = cycle_mean(self.over_torque("parts")), self.pair.assembly.ratio
        pinion, gear = (parts[:, PARTS.index(name)] for name in ("pinion_rotation", "gear_rotation"))
        return np.asarray(self.over_torque("first_contact") + gear - pinion / ratio)

    @cached_property
    def loaded(self) -> xr.Dataset:
        """The group ``/loaded``; its transmission error leaves out ``support_rotation``."""
        segments = [here for one in self.rounds for here in one.found.segments]
        rotations = self.pair.cycle.lines.rotations
        found = loaded_dataset(segments, self.cases, self.torques, rotations)
        numbers = rotation_numbers(1e6 * self.transmission_error)
        return found.assign({name: (dims, values, found[name].attrs) for name, (dims, values) in numbers.items()})

    @cached_property
    def misalignment(self) -> xr.Dataset:
        """E, P, G and Sigma under load (t, k)."""
        given = np.array(list(vars(self.pair.assembly.misalignment).values()))
        return misalignment_dataset(given + self.over_torque("parts")[..., :4], self.torques)

    @cached_property
    def supports(self) -> xr.Dataset:
        """Motion, mesh force, bearing loads and shares of the rotation (t, k)."""
        return supports_dataset(self.pair.assembly, self.torques, self.rounds, self.cases, self.support_rotation)
