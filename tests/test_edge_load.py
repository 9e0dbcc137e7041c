"""A pair whose edges carry much is told: there the contact on edges is coarse."""

from __future__ import annotations

from functools import cache

import numpy as np
import xarray as xr
from runs import small

import easeoff
from easeoff.study import result_summary
from easeoff.study.report.notes.edge_load import EDGE_SHARE_LIMIT, edge_notes


@cache
def loaded(name: str, *, edges: bool = True) -> xr.DataTree:
    return easeoff.analyze(small(name, "shell"), torques=50.0, edge_contact=edges)


def test_only_a_pair_that_rests_on_its_edges_is_told() -> None:
    tree = loaded("nasa-12x36")
    share = tree["loaded"]["edge_share"].max().item()
    assert share > EDGE_SHARE_LIMIT
    (note,) = edge_notes(tree["loaded"].to_dataset())
    assert f"up to {100 * share:.0f} % of the load (50 N m)" in note
    assert "tooth edges carry" in " ".join(result_summary(tree).split())
    assert edge_notes(loaded("fm-11x41")["loaded"].to_dataset()) == []
    assert edge_notes(loaded("nasa-12x36", edges=False)["loaded"].to_dataset()) == []


def test_the_torque_that_loads_the_edges_most_is_named() -> None:
    share = np.array([[0.05, np.nan], [0.3, 0.1]])
    told = xr.Dataset({"edge_share": (("torque", "mesh_position"), share)}, coords={"torque": [10.0, 20.0]})
    assert "30 % of the load (20 N m)" in edge_notes(told)[0]
    unsolved = told.assign(edge_share=told["edge_share"] * np.nan)
    assert edge_notes(unsolved) == []
