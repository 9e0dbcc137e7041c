"""Pairs in mesh on supports of two bearings a member, and their contact."""

from __future__ import annotations

from functools import cache

import numpy as np
from pairs import mirrored

from easeoff.cases import gear_pair, read_case
from easeoff.contact import ElasticModel, MeshCycle
from easeoff.contact.supports.assembly_rounds import AssemblyRounds
from easeoff.contact.supports.support import (
    MemberAxis,
    Support,
    Supports,
    member_axes,
)
from easeoff.contact.supports.supported_contact import SupportedContact
from easeoff.geometry import Assembly, FlankName, pair_geometry

FIRST_ORDER = AssemblyRounds(update="none")
TORQUES = [120.0, 400.0]
POSITIONS = 2


@cache
def cycle(name: str = "fm-11x41", flank: FlankName = "drive", mirror: bool = False) -> MeshCycle:
    pair = gear_pair(read_case(name), flank)
    geometry = pair_geometry(mirrored(pair) if mirror else pair, (9, 7))
    return MeshCycle.of(geometry, ElasticModel(), mesh_positions=POSITIONS, segments_per_line=7)


def support(axis: MemberAxis, distance: float) -> Support:
    """Two bearings around a point on the axis: stiff along it, less so across; both take an even part."""
    direction = np.asarray(axis.direction)
    across = np.eye(3) - np.outer(direction, direction)
    stiffness = np.zeros((6, 6))
    stiffness[:3, :3] = 2e5 * across + 3e5 * np.outer(direction, direction)
    stiffness[3:, 3:] = 8e8 * across
    return Support.of_stiffness(np.asarray(axis.point) + distance * direction, stiffness, axis)


def supports(assembly: Assembly) -> Supports:
    pinion, gear = member_axes(assembly)
    return Supports(support(pinion, 60.0), support(gear, 30.0))


@cache
def found(
    name: str,
    flank: FlankName,
    rounds: AssemblyRounds = FIRST_ORDER,
    mirror: bool = False,
    edge_contact: bool = True,
) -> SupportedContact:
    here = cycle(name, flank, mirror)
    return here.supported(TORQUES, supports(here.geometry.pair.assembly), rounds=rounds, edge_contact=edge_contact)
