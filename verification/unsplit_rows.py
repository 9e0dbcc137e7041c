"""Rows of the contact without the split into bending and indentation, at some mesh positions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from ..cases.conversion import materials
from ..contact.lines.flank_splines import FlankSplines
from .flank_contact import (
    FlankContact,
    contact_of_flanks,
    greatest_stretch_load,
    line_directions,
    response_size,
    stretch_load,
)
from .flank_response import FlankResponse, flank_response
from .flank_rows import greatest
from .loaded_rows import positions
from .verification_row import VerificationRow
from .verified_pair import VerifiedPair

ROTATION_LIMIT = 2.5  # [%], of the transmission error
SHARE_LIMIT = 1.0  # [%], of the torque
LINE_LOAD_LIMIT = 4.0  # [%], of the greatest line load
UNSPLIT_POSITIONS = 4
COARSER_CELLS = 0.7  # resolution of the cells that tell what their size matters


@dataclass(frozen=True)
class UnsplitContact:
    """Contact without the split at some mesh positions, each tooth with a body of its own, as in the analysis."""

    pair: VerifiedPair
    cells_per_half_width: float = 8.0

    @cached_property
    def separate(self) -> VerifiedPair:
        """The pair with every tooth on a body of its own."""
        table = self.pair.case.compliance
        coupled = table.model != "shell" and table.neighbours
        return self.pair.changed("compliance", neighbours=False) if coupled else self.pair

    @property
    def places(self) -> list[tuple[int, int]]:
        """Numbers of torque and mesh position of every solution."""
        chosen = positions(self.pair, UNSPLIT_POSITIONS)
        return [(torque, position) for torque in range(self.pair.torques.size) for position in chosen]

    @cached_property
    def responses(self) -> tuple[FlankResponse, FlankResponse]:
        """Of pinion and gear; minutes the first time, kept on disk afterwards."""
        state = self.pair.state
        depths, (first, second) = state.case.compliance.rim_depth or (None, None), materials(state.case)
        return (
            flank_response(state.pair, "pinion", first, response_size(state.pair, "pinion"), depths[0]),
            flank_response(state.pair, "gear", second, response_size(state.pair, "gear"), depths[1]),
        )

    @property
    def coarser(self) -> UnsplitContact:
        """The same on larger cells, which tells how much the size of the cells matters."""
        coarser = UnsplitContact(self.pair, COARSER_CELLS * self.cells_per_half_width)
        coarser.__dict__["responses"] = self.responses
        return coarser

    def solved(self, torque: int, position: int) -> FlankContact:
        """Contact at one torque and mesh position, by their numbers."""
        loaded = self.separate.analysis.tree["loaded"].to_dataset().isel(torque=torque)
        # Of the analysis no more is taken than where to lay the cells, and how small they should be.
        return contact_of_flanks(
            self.pair.flanks,
            self.responses,
            materials(self.pair.case),
            self.pair.state.cycle.lines,
            position,
            float(self.pair.torques[torque]),
            half_width=float(loaded["half_width"].max()),
            rotation=1e-6 * float(loaded["transmission_error"].max()),
            cells_per_half_width=self.cells_per_half_width,
        )


def unsplit_rows(contact: UnsplitContact, solutions: dict[tuple[int, int], FlankContact]) -> Iterator[VerificationRow]:
    """Rows of all torques and mesh positions, from solutions by the numbers of both."""
    loaded = contact.separate.analysis.tree["loaded"].to_dataset()
    compared = f"contact without the split, {len(solutions)} positions and torques"
    splines = contact.pair.flanks.splines
    rotation, share, load, unsettled = [], [], [], []
    for torque in range(contact.pair.torques.size):
        contacts = {k: one for (number, k), one in solutions.items() if number == torque}
        analysis = loaded.isel(torque=torque, mesh_position=list(contacts))
        rotation += [100.0 * d for d in rotation_differences(analysis, list(contacts.values()))]
        share += [100.0 * d for d in share_differences(analysis, list(contacts.values()))]
        load.append(100.0 * line_load_difference(analysis, list(contacts.values()), splines))
        stretch = strip_width(analysis)
        theirs = {k: stretch_load(one, stretch) for k, one in contacts.items()}
        most = max(theirs, key=lambda k: theirs[k])
        coarse = stretch_load(contact.coarser.solved(torque, most), stretch)
        unsettled.append(100.0 * abs(coarse / theirs[most] - 1.0) if theirs[most] else np.nan)
    yield VerificationRow("transmission error", compared, greatest(np.array(rotation)), ROTATION_LIMIT, "%")
    yield VerificationRow("load share of a tooth pair", compared, greatest(np.array(share)), SHARE_LIMIT, "%")
    cells = f"{compared}; larger cells change it by {unsettled[int(np.argmax(np.nan_to_num(np.abs(load))))]:.2g} %"
    yield VerificationRow("greatest line load", cells, greatest(np.array(load)), LINE_LOAD_LIMIT, "%")


def rotation_differences(loaded: xr.Dataset, solutions: list[FlankContact]) -> list[float]:
    """Relative differences of the transmission error (mesh_position) of an analysis at one torque."""
    errors = loaded["transmission_error"].values
    return [float(1e-6 * errors[k] / one.rotation - 1.0) for k, one in enumerate(solutions)]


def share_differences(loaded: xr.Dataset, solutions: list[FlankContact]) -> list[float]:
    """Differences of the load shares of all tooth pairs that carry in either."""
    differences = []
    for k, one in enumerate(solutions):
        shares = dict(zip(loaded["pair"].values.tolist(), loaded["load_share"].values[k].tolist(), strict=True))
        theirs = dict(zip(one.pairs, one.load_share.tolist(), strict=True))
        differences += [shares.get(pair, 0.0) - theirs.get(pair, 0.0) for pair in shares.keys() | theirs.keys()]
    return differences


def strip_width(loaded: xr.Dataset) -> float:
    """Greatest width of the pressed strips of an analysis at one torque [mm]."""
    return 2.0 * float(loaded["half_width"].max())


def line_load_difference(loaded: xr.Dataset, solutions: list[FlankContact], splines: FlankSplines) -> float:
    """Relative difference of the greatest line load over the mesh positions, both over the ``strip_width``."""
    stretch, loads = strip_width(loaded), [0.0]
    for k, one in enumerate(solutions):
        segments = loaded.isel(mesh_position=k)
        for pair, direction in zip(one.pairs, line_directions(one), strict=True):
            chosen = (segments["tooth"].values == pair) & (segments["force"].values > 0.0)
            length, force = (segments[name].values[chosen] for name in ("length", "force"))
            points = np.stack([segments[name].values[chosen] for name in ("lengthwise", "profile")])
            place = np.einsum("x,xn->n", direction, splines("position", points))
            loads.append(greatest_stretch_load(place, length, force, stretch))
    theirs = max((stretch_load(one, stretch) for one in solutions), default=0.0)
    return max(loads) / theirs - 1.0 if theirs else np.nan
