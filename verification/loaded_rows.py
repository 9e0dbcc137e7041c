"""Rows of the loaded contact: other solvers, finer resolution, and contact without the split.

Compared are gaps of the segments that carry, other solvers on the same contact problems, key numbers at the case's
resolution against a finer one, and contact without the split into bending and indentation at some mesh positions.


"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from ..cases.conversion import materials
from ..cases.schema.case_schema import Case
from ..contact.evaluation.pressure_map import LineEnd
from ..contact.lines.flank_splines import FlankSplines
from ..contact.loaded import LoadedCase
from ..contact.solvers import SOLVERS, available_solvers, solve
from ..core.arrays import Array
from ..study.analysis.key_numbers import key_numbers
from . import flank_contact
from .flank_contact import FlankContact, response_size
from .flank_response import FlankResponse, flank_response
from .geometry_rows import greatest
from .surface_cells import segment_gaps
from .verified_pair import VerificationRow, VerifiedPair, not_applicable

GAP_LIMIT = 0.2  # [%], of the rotation
POLISHED_LIMIT = 1e-9  # of the rotation; polished answers agree to rounding
UNPOLISHED_LIMIT = 1e-5  # of the rotation: what interior-point methods leave within their tolerance
GAP_POSITIONS, SOLVER_POSITIONS = 8, 4


def positions(pair: VerifiedPair, count: int) -> list[int]:
    """Evenly spread mesh positions, at most so many."""
    number = pair.case.contact.mesh_positions
    return sorted({number * k // count for k in range(min(count, number))})


def cases_at(pair: VerifiedPair, count: int) -> list[LoadedCase]:
    """Solved cases at so many mesh positions, all torques."""
    chosen = set(positions(pair, count))
    return [case for case in pair.analysis.cases if case.mesh_position in chosen]


def certificate_row(pair: VerifiedPair) -> VerificationRow:
    """Mesh positions and torques without a certified solution."""
    status = pair.analysis.tree["loaded"].to_dataset()["status"].values
    failed = float(np.count_nonzero(status))
    return VerificationRow("certificates", f"solutions without one, of {status.size}", failed, 0.0, "1")


def gap_row(pair: VerifiedPair) -> VerificationRow:
    """Effect of gap errors of loaded segments on the transmission error."""
    chosen = [case for case in cases_at(pair, GAP_POSITIONS) if case.solution.certified]
    gaps = [segment_gaps(pair.flanks, pair.state.cycle, case) for case in chosen]
    errors = [gap.rotation_error / case.solution.rotation for gap, case in zip(gaps, chosen, strict=True)]
    compared = f"gaps of the turned flanks where they carry, {len(chosen)} positions and torques"
    error = 100.0 * greatest(np.array(errors))
    return VerificationRow("loaded transmission error by its gaps", compared, error, GAP_LIMIT, "%")


def solver_rows(pair: VerifiedPair, solvers: Sequence[str] | None = None) -> list[VerificationRow]:
    """Rotations by other solvers on the same contact problems, over those of the analysis.

    A row a solver, polished, and one for the least accurate answer that was not; all that are installed by default.
    """
    chosen = cases_at(pair, SOLVER_POSITIONS)
    greatest_size = max((case.problem.size for case in chosen), default=0)
    rows, plain = [], []
    for name in available_solvers() if solvers is None else solvers:
        if name == "native":
            continue
        largest = SOLVERS[name].largest if name in SOLVERS else None
        if largest is not None and greatest_size > largest:
            rows.append(not_applicable(f"solver {name}", f"{greatest_size} segments: known to work up to {largest}"))
            continue
        certified, apart = _apart(chosen, name, polish=True)
        compared = f"polished, {certified} of {len(chosen)} contact problems certified"
        rows.append(VerificationRow(f"solver {name}", compared, apart, POLISHED_LIMIT, "1"))
        certified, apart = _apart(chosen, name, polish=False)
        # Without polish a solver may miss its own tolerance, too: such an answer is refused, and nobody gets it.
        if certified:
            plain.append((apart, f"{name}, {certified} of {len(chosen)} contact problems certified"))
    apart, compared = max(plain, default=(float("nan"), "none"))
    if not plain:
        return [*rows, not_applicable("solvers without polish", "no answer of another solver was certified")]
    return [*rows, VerificationRow("solvers without polish", compared, apart, UNPOLISHED_LIMIT, "1")]


def _apart(cases: list[LoadedCase], name: str, *, polish: bool) -> tuple[int, float]:
    """Number of certified answers and greatest rotation difference; NaN if a polished one is not certified."""
    tolerance = SOLVERS[name].tolerance if name in SOLVERS and not polish else None
    solutions = [solve(case.problem, name, polish=polish, tolerance=tolerance) for case in cases]
    answers = [(one, case) for one, case in zip(solutions, cases, strict=True) if one.certified]
    ratios = [one.rotation / case.solution.rotation for one, case in answers]
    return len(ratios), greatest(np.array(ratios) - 1.0) if len(ratios) == len(cases) or not polish else float("nan")


GRID_FACTOR, SEGMENTS_FACTOR, POSITIONS_FACTOR, MODES_FACTOR, FINENESS_FACTOR = 1.5, 2.0, 2.0, 1.4, 1.4
#: Numbers that tell the state of the solution, or look at the nodes on the common flank, whose border lies between
#: nodes; and of the greatest pressure all but its value: between two that are nearly as great its place jumps.
NOT_COMPARED = {
    "common_flank",
    "max_ease_off",
    "certified_positions",
    "worst_certificate",
    *(f"max_pressure_{place}" for place in ("lengthwise", "profile", "position", "pair", "line_end")),
}
ERRORS, UNLOADED, PLACES = "transmission error", "unloaded transmission error", "shares, ratios and places"
PRESSURE, PRESSURE_AT_END, OTHERS = "greatest pressure", "greatest pressure, at a line's end", "other numbers"
#: Greatest change [%] by what is finer, group by group; none where it has no part in the numbers.
LIMITS: dict[str, dict[str, float]] = {
    "grid of the flank": dict.fromkeys((ERRORS, UNLOADED, PLACES, PRESSURE, PRESSURE_AT_END, OTHERS), 0.5),
    "segments of a line": {ERRORS: 0.5, PLACES: 1.6, PRESSURE: 1.0, PRESSURE_AT_END: 10.0, OTHERS: 0.5},
    "mesh positions": {ERRORS: 0.5, UNLOADED: 1.0, PLACES: 2.0, PRESSURE: 1.0, PRESSURE_AT_END: 10.0, OTHERS: 0.5},
    "fineness of the teeth": {ERRORS: 2.0, PLACES: 2.0, PRESSURE: 4.0, PRESSURE_AT_END: 10.0, OTHERS: 4.0},
    "shell modes along the face": {ERRORS: 1.0, PLACES: 1.0, PRESSURE: 2.0, PRESSURE_AT_END: 10.0, OTHERS: 1.0},
    "shell modes up the profile": {ERRORS: 1.0, PLACES: 1.0, PRESSURE: 2.0, PRESSURE_AT_END: 10.0, OTHERS: 1.0},
}
UNLOADED_ERROR_MINIMUM = 1.0  # [urad]; the errors of a pair without any are compared with this


@dataclass(frozen=True)
class Refinement:
    """One way of computing a case more finely: finer values for keys of a table of the case file."""

    name: str
    table: str
    values: Mapping[str, int | float]

    def described(self, case: Case) -> str:
        """Coarse and fine values."""
        table = getattr(case, self.table)
        coarse = " x ".join(f"{getattr(table, key):g}" for key in self.values)
        return f"{coarse} against {' x '.join(f'{value:g}' for value in self.values.values())}"


def refinements(case: Case) -> list[Refinement]:
    """Refinements that make sense for a case; those of the elastic teeth depend on its model."""
    contact, elastic = case.contact, case.compliance
    keys = ("lengthwise_nodes", "profile_nodes")
    nodes = {key: math.ceil((getattr(contact, key) - 1) * GRID_FACTOR) + 1 for key in keys}
    segments = {"segments_per_line": round(SEGMENTS_FACTOR * contact.segments_per_line)}
    positions = {"mesh_positions": round(POSITIONS_FACTOR * contact.mesh_positions)}
    common_refinements = [
        Refinement("grid of the flank", "contact", nodes),
        Refinement("segments of a line", "contact", segments),
        Refinement("mesh positions", "contact", positions),
    ]
    if elastic.model != "shell":
        fineness = {"fineness": round(FINENESS_FACTOR * elastic.fineness, 3)}
        return [*common_refinements, Refinement("fineness of the teeth", "compliance", fineness)]
    face = {"lengthwise_modes": math.ceil(MODES_FACTOR * elastic.lengthwise_modes)}
    profile = {"profile_modes": math.ceil(MODES_FACTOR * elastic.profile_modes)}
    return [
        *common_refinements,
        Refinement("shell modes along the face", "compliance", face),
        Refinement("shell modes up the profile", "compliance", profile),
    ]


def convergence_rows(pair: VerifiedPair, refinement: Refinement) -> list[VerificationRow]:
    """Change of the key numbers by one refinement, a row a group of numbers."""
    finer = pair.changed(refinement.table, **refinement.values)
    compared, limits = refinement.described(pair.case), LIMITS[refinement.name]
    return [
        VerificationRow(f"{refinement.name}: {group}", f"{compared}, {label}", value, limits[group], "%")
        for group, value, label in changes(key_numbers(pair.analysis.tree), key_numbers(finer.analysis.tree))
        if group in limits
    ]


def changes(coarse: xr.Dataset, fine: xr.Dataset) -> Iterator[tuple[str, float, str]]:
    """Greatest change of every group of key numbers [%], and the number that changes so much.

    Transmission errors count over the mean level at their torque, unloaded ones over the peak to peak; fractions in
    points, ratios above one and all other numbers over themselves.
    """
    worst: dict[str, tuple[float, str]] = {}
    for name, values in coarse.data_vars.items():
        if name in NOT_COMPARED or str(name).startswith(("pinion_", "unloaded_pinion_")):
            continue  # what refers to the pinion is in proportion to what refers to the gear
        other = fine[name] if name in fine and fine[name].dims == values.dims else values * np.nan
        scale, relative = _scale(coarse, str(name))
        for place in np.ndindex(values.shape):
            number, finer = float(values.values[place]), float(other.values[place])
            change = 0.0 if np.isnan(number) and np.isnan(finer) else 100.0 * abs(finer - number) / float(scale[place])
            group = _group((coarse, fine), str(name), place)
            # A change without a number is the worst of all, and stays so.
            if group not in worst or change > worst[group][0] or (np.isnan(change) and not np.isnan(worst[group][0])):
                at = f" at {coarse['torque'].values[place[0]]:g} N m" if values.dims[:1] == ("torque",) else ""
                unit = values.attrs.get("units", "1")
                words = f"{name}{at} {number:.5g} and {finer:.5g} {unit}".removesuffix(" 1")
                itself = scale[place] == abs(number)
                worst[group] = change, words + ("" if itself else relative.format(scale[place]))
    return ((group, value, label) for group, (value, label) in worst.items())


def _group(both: tuple[xr.Dataset, xr.Dataset], name: str, place: tuple[int, ...]) -> str:
    """Group of a key number; the greatest pressure is at a line's end if that of either computation is."""
    values = both[0][name]
    if name == "max_pressure":
        ends = [int(one["max_pressure_line_end"].values[place]) for one in both if "max_pressure_line_end" in one]
        return PRESSURE if all(end == LineEnd.INSIDE for end in ends) else PRESSURE_AT_END
    unit = values.attrs.get("units", "1")
    if unit == "urad":
        return ERRORS if "torque" in values.dims else UNLOADED
    return PLACES if unit == "1" else OTHERS


def _scale(numbers: xr.Dataset, name: str) -> tuple[Array, str]:
    """Divisor of the changes of a key number, and what to say of it, with its value, where it is not the number."""
    values = numbers[name]
    unit, size = values.attrs.get("units", "1"), np.abs(values.values)
    if unit == "urad" and "torque" in values.dims:
        level = np.abs(numbers["mean_level"].values)
        scale = np.broadcast_to(level.reshape(-1, *(1,) * (values.ndim - 1)), values.shape)
        return scale, ", over the mean level {:.4g}"
    if unit == "urad":
        least = np.maximum(float(numbers["unloaded_peak_to_peak"]), UNLOADED_ERROR_MINIMUM)
        return np.full(values.shape, least), ", over the unloaded peak to peak {:.4g}"
    return np.asarray(np.maximum(size, 1.0) if unit == "1" else size), ", in points of 1"


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
        return flank_contact.contact_of_flanks(
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
        analysis, solved = loaded.isel(torque=torque, mesh_position=list(contacts)), list(contacts.values())
        rotation += [100.0 * d for d in rotation_differences(analysis, solved)]
        share += [100.0 * d for d in share_differences(analysis, solved)]
        load.append(100.0 * line_load_difference(analysis, solved, splines))
        stretch = strip_width(analysis)
        theirs = {k: flank_contact.stretch_load(one, stretch) for k, one in contacts.items()}
        most = max(theirs, key=lambda k: theirs[k])
        coarse = flank_contact.stretch_load(contact.coarser.solved(torque, most), stretch)
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
        for pair, direction in zip(one.pairs, flank_contact.line_directions(one), strict=True):
            chosen = (segments["tooth"].values == pair) & (segments["force"].values > 0.0)
            length, force = (segments[name].values[chosen] for name in ("length", "force"))
            points = np.stack([segments[name].values[chosen] for name in ("lengthwise", "profile")])
            place = np.einsum("x,xn->n", direction, splines("position", points))
            loads.append(flank_contact.greatest_stretch_load(place, length, force, stretch))
    theirs = max((flank_contact.stretch_load(one, stretch) for one in solutions), default=0.0)
    return max(loads) / theirs - 1.0 if theirs else np.nan
