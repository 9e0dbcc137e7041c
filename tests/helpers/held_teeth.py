"""Another pair in mesh with the teeth of a known one, as derivatives hold them."""

from __future__ import annotations

from easeoff.contact import MeshCycle
from easeoff.geometry.pair.ease_off import drift, exact_ease_off
from easeoff.geometry.pair.gear_pair import GearPair, MemberGeometry, PairGeometry, ease_off_dataset, teeth_dataset


def anew(cycle: MeshCycle, pair: GearPair) -> MeshCycle:
    """The mesh of another pair from scratch, but for the tooth bodies, which derivatives hold."""
    members = cycle.geometry.members
    gear = pair.gear.flank(members.lengthwise, members.profile)
    exact = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    t, h = members.lengthwise, members.profile
    members = MemberGeometry(t, h, members.pinion, gear, members.bodies)
    feet = members.bodies[0].shell_coordinates(exact.pinion_position, exact.pinion_normal), members.gear_feet
    moving = drift(exact)
    teeth = teeth_dataset(t, h, members.bodies, feet)
    geometry = PairGeometry(pair, members, exact, moving, ease_off_dataset(t, h, exact, moving), teeth)
    return cycle.with_geometry(geometry)
