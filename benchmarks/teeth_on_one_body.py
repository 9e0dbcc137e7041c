"""Loaded teeth on one body solved whole against the same teeth each on its sector, and against the modes of the body.

``python benchmarks/teeth_on_one_body.py``: under the forces of an analysis, held, how much farther the teeth turn than
separate ones, in % of the transmission error. Bricks of 8 x 3 x 2 in the tooth; a few minutes.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tabulate import tabulate

from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, MeshCycle
from easeoff.contact.compliance.elastic_model import solid_shells
from easeoff.contact.compliance.elastic_model import PITCHES_PER_PAIR, member_points
from easeoff.contact.compliance.finite_elements.elastic_body import elastic_body
from easeoff.contact.compliance.finite_elements.flank_compliance import (
    FlankCompliance,
    flank_loads,
    flank_shares,
    foot_displacements,
    square_root,
)
from easeoff.contact.compliance.finite_elements.tooth_ring import body_modes, ring_size, with_body
from easeoff.geometry import LatticeSize, pair_geometry, tooth_lattice
from easeoff.geometry.tooth.tooth_flanks import MemberName, named_member

sys.path.append(str(Path(__file__).parents[1] / "tests" / "helpers"))
from toothed_sector import toothed_sector

Array = NDArray[Any]
CASES = (("fm-11x41", 500.0), ("nasa-12x36", 200.0))
MEMBERS: tuple[MemberName, MemberName] = ("pinion", "gear")
SIZE = LatticeSize(8, 3, 2, 1, 0, 2, 1)
SECTORS = (3, 7, 11)  # teeth; all of the pinion for the last
HEAD = ["case", "mesh position", "tooth pairs", *(f"{n} teeth on a sector" for n in SECTORS), "modes", "of it between"]


def rows_of(name: str, torque: float) -> list[list[Any]]:
    """Rows of one pair at four mesh positions."""
    pair = gear_pair(read_case(name))
    model = solid_shells(pair, neighbours=False)
    cycle = MeshCycle.of(pair_geometry(pair, (31, 21)), model, mesh_positions=4)
    cases = cycle.solved([torque])
    extra = np.zeros((len(cases), len(SECTORS) + 2))
    for member, pitches in zip(MEMBERS, PITCHES_PER_PAIR, strict=True):
        teeth = named_member(pair, member).teeth
        pitch, alone = (tooth_lattice(pair, member, replace(SIZE, beside=n)) for n in (0, 2))
        body = elastic_body(alone.nodes, alone.cells, alone.fixed_nodes, STEEL)
        own = square_root(body.response(flank_loads(alone), foot_displacements(alone)))
        tooth = FlankCompliance(alone.lengthwise, alone.profile, own)
        coupled = with_body(tooth, *body_modes(pair, member, STEEL, ring_size()))
        assert coupled.body is not None
        whole = []
        for count in SECTORS:
            sector = toothed_sector(pitch, teeth, None if count >= teeth else count)
            middle = len(sector.angles) // 2
            whole.append([sector.compliance(STEEL, (middle + k) % len(sector.angles)) for k in (-1, 0, 1)])
        for number, case in enumerate(cases):
            loads = nodal_loads(cycle, member, case, alone.lengthwise, alone.profile)
            central = sorted(loads)[len(loads) // 2]
            own_turn = sum(float(np.sum((own @ load) ** 2)) for load in loads.values())
            found = np.zeros(extra.shape[1])
            found[-2] = sum(float(np.sum((coupled.factor @ load) ** 2)) for load in loads.values()) - own_turn
            found[:-2] = -own_turn
            for one, first in loads.items():
                for other, second in loads.items():
                    at, by = pitches * (one - central), pitches * (other - central)
                    on_modes = coupled.body.shapes @ first, coupled.body.shapes @ second
                    part = float(on_modes[0] @ coupled.body.coupling[(at - by) % teeth] @ on_modes[1])
                    found[-2:] += part, part * (one != other)
                    for place, solved in enumerate(whole):
                        between, at_feet = solved[by + 1]
                        matrix = at_feet if one == other else between[(len(between) // 2 + at) % len(between)]
                        found[place] += float(first @ matrix @ second)
            work = case.solution.rotation * float(case.solution.force @ case.segments.lever_arm)
            extra[number] += 100.0 * found / work
    return [[name, k / len(cases), pairs_of(case), *extra[k]] for k, case in enumerate(cases)]


def nodal_loads(cycle: MeshCycle, member: MemberName, case: Any, lengthwise: Array, profile: Array) -> dict[int, Array]:
    """Forces on the nodes of the flank by tooth pair."""
    force, of_pair = case.solution.force, case.segments.pair
    nodes, shares = flank_shares(lengthwise, profile, member_points(cycle.fields, member, case.segments.point))
    loads = {}
    for pair in np.unique(of_pair):
        here = of_pair == pair
        if force[here].sum() > 0.0:
            on_nodes = (shares * force[:, None])[here].ravel()
            loads[int(pair)] = np.bincount(nodes[here].ravel(), on_nodes, minlength=profile.size)
    return loads


def pairs_of(case: Any) -> int:
    """Number of tooth pairs that carry."""
    return int(np.unique(case.segments.pair[case.solution.force > 0.0]).size)


if __name__ == "__main__":
    table = [row for name, torque in CASES for row in rows_of(name, torque)]
    print(tabulate(table, HEAD, "github", ".2f"))
