"""Rows of the geometry: flanks against the cutter's motion, unloaded contact against conventional analysis.

Of one flank the envelope of the cutter by differences, and curvatures from two directions; of the unloaded contact five
equations of conventional analysis, contact ellipse and smallest gap.

"""

from __future__ import annotations

import numpy as np

from ..contact.lines.closest_approach import closest_approach
from ..core.arrays import Array, Bools
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.flanks.blank_section import BlankSection
from ..geometry.flanks.flank import Flank, NodeStatus, on_parts, principal_curvatures
from ..geometry.vectors import dot
from . import conventional_analysis as conventional
from .conventional_analysis import BothMethods
from .envelope_condition import envelope_condition
from .smallest_gap import smallest_envelope
from .verified_pair import VerificationRow, VerifiedPair, not_applicable

POSITION_LIMIT = 1e-11  # of the outer cone distance: 1e-9 mm at 100 mm
NORMAL_LIMIT = 1e-10  # [rad]
CURVATURE_LIMIT = 1e-8  # of the greater curvature
LEFT_OUT = {
    NodeStatus.NO_SOLUTION: "out of the cutter's reach",
    NodeStatus.UNDERCUT: "undercut",
    NodeStatus.BEYOND_BLADE_TIP: "beyond the blade tip",
    NodeStatus.OUTSIDE_BLANK: "outside the blank",
}
SQUARE_LIMIT = 1e-6  # least squared sine between the two directions; below it rounding is all that is left


def flank_rows(member: str, flank: Flank, section: BlankSection) -> list[VerificationRow]:
    """Rows of one member's flank on the nodes of the analysis."""
    usable = np.isfinite(flank.position[0])
    nodes = f"{usable.sum()} of {usable.size} nodes{_others(flank, usable)}"
    limit = POSITION_LIMIT * section.outer_cone_distance
    condition = envelope_condition(flank)
    carried = f"blade carried through the machine joint by joint, {nodes}"
    moved = f"edge and cutting motion by differences, {nodes}"
    rows = [
        VerificationRow(f"flank position, {member}", carried, greatest(condition.position[usable]), limit, "mm"),
        VerificationRow(f"flank normal, {member}", moved, greatest(condition.normal[usable]), NORMAL_LIMIT, "rad"),
    ]
    envelope = f"envelope condition, {member}"
    if flank.surface.settings.generated:
        compared = f"cutter's motion by differences, along the blade, {nodes}"
        rows.append(VerificationRow(envelope, compared, greatest(condition.along_blade[usable]), limit, "mm"))
    else:
        rows.append(not_applicable(envelope, "cut without rolling: the blade itself sweeps the flank"))
    return [*rows, _curvature(member, flank, usable, nodes)]


def _others(flank: Flank, usable: Bools) -> str:
    """Description of the nodes without a flank."""
    left = flank.status[~usable]
    phrases = [f"{np.count_nonzero(left == kind)} {words}" for kind, words in LEFT_OUT.items() if np.any(left == kind)]
    return f" (the others: {', '.join(phrases)})" if phrases else ""


def greatest(values: Array) -> float:
    """Greatest magnitude; NaN if any value is NaN or there is none."""
    return float(np.max(np.abs(values))) if values.size else float("nan")


def _curvature(member: str, flank: Flank, usable: Bools, nodes: str) -> VerificationRow:
    """Principal curvatures and torsion from two directions against the fundamental forms, over the greater one."""

    def other(surface: GeneratingSurface, parameters: Array) -> Array:
        curvatures = conventional.directional_curvatures(surface, parameters)
        sine = dot(curvatures.across[0], curvatures.tangent[1])
        principal = curvatures.shape_operator().principal().curvature
        return np.concatenate([principal, [curvatures.torsion_residual(), sine]])

    values = on_parts(flank.surface.flank_parts, flank.part, flank.parameters, other)[:, usable]
    expected = principal_curvatures(flank).curvature[:, usable]
    scale = np.max(np.abs(expected), axis=0)
    difference = np.max(np.abs([*(values[:2] - expected), values[2]]), axis=0) / scale
    # Two directions that nearly coincide tell one curvature only.
    skew = values[3] ** 2 < SQUARE_LIMIT
    left = f", {skew.sum()} left out whose directions coincide" if skew.any() else ""
    quantity = f"principal curvatures, {member}"
    compared = f"from two directions against the fundamental forms, {nodes}{left}"
    return VerificationRow(quantity, compared, greatest(difference[~skew]), CURVATURE_LIMIT, "1")


ERROR_LIMIT = 0.1  # [urad], of the transmission error
PATH_LIMIT = 4e-4  # of the face width: the path is interpolated between 65 points of a line
#: [%], of the relative curvature: the analysis takes it on the line, not at the closest approach beside it. A pressure
#: changes half as much.
RELATIVE_CURVATURE_LIMIT = 4.0
DIRECTION_LIMIT = 0.1  # [deg], of the contact line
LENGTH_LIMIT = 0.5  # [%], of the contact line
SEPARATIONS = (3.0, 1.5)  # [um] at the ends of the lines that are extrapolated to none
CONVENTIONAL_POSITIONS, GAP_POSITIONS = 48, 16


def conventional_rows(pair: VerifiedPair) -> list[VerificationRow]:
    """Transmission error, path of contact and contact lines against conventional contact analysis."""
    both = conventional.methods_compared(pair.state.cycle.geometry, CONVENTIONAL_POSITIONS)
    errors, distances = conventional.point_differences(both)
    count, missed = int(both.inside.sum()), int((~both.contact.converged).sum())
    compared = f"five equations, {count} points inside both flanks"
    unsolved_rotations = f"rotations of a tooth pair without a solution, of {both.contact.converged.size}"
    unsolved = VerificationRow("conventional analysis", unsolved_rotations, missed, 0, "1")
    if not count:
        reason = "no tooth pair touches inside both flanks, 2 % off their edges"
        names = ("transmission error of a tooth pair", "path of contact", "relative curvature across the line")
        return [unsolved, *(not_applicable(name, reason) for name in (*names, *LINE_QUANTITIES))]
    path_limit = 1e3 * PATH_LIMIT * pair.state.pair.gear.section.face_width
    error, away = 1e6 * greatest(errors[both.inside]), 1e3 * greatest(distances[both.inside])
    return [
        unsolved,
        VerificationRow("transmission error of a tooth pair", compared, error, ERROR_LIMIT, "urad"),
        VerificationRow("path of contact", compared, away, path_limit, "um"),
        _curvature_row(both),
        *_line_rows(both),
    ]


LINE_QUANTITIES = ("direction of the contact line", "length of the contact line")


def _curvature_row(both: BothMethods) -> VerificationRow:
    """Relative curvature across the line, from the roll angle and from both members' curvatures."""
    inside, mesh = both.inside, both.mesh
    closest = closest_approach(both.splines, mesh.lines.points)
    lines = np.arange(mesh.pair.size)
    least = np.argmin(closest.separation_angle, axis=1)
    # A line may come in pieces: the one that touches first is the tooth pair's.
    order = np.argsort(-closest.separation_angle[lines, least], kind="stable")
    pairs = np.unique(mesh.pair)
    curvature = np.full((pairs.size, mesh.rotations.size), np.nan)
    row = np.searchsorted(pairs, mesh.pair)
    curvature[row[order], mesh.position[order]] = closest.curvature[lines, least][order]
    exact = both.relative.across_line[inside]
    compared = f"from the roll angle against both members' curvatures, {inside.sum()} points"
    difference = 100.0 * greatest(curvature.ravel()[inside] / exact - 1.0)
    return VerificationRow("relative curvature across the line", compared, difference, RELATIVE_CURVATURE_LIMIT, "%")


def _line_rows(both: BothMethods) -> list[VerificationRow]:
    """Direction and length of the contact line against the major axis of the contact ellipse.

    The ellipse is of second order: the third order grows with the separation at the line's ends, and an extrapolation
    to none takes it away.
    """
    wide, narrow = (np.stack(conventional.line_differences(both, separation)) for separation in SEPARATIONS)
    left = 2.0 * narrow - wide
    whole = np.all(np.isfinite(left), axis=0)
    if not whole.any():
        return [not_applicable(name, "the edges of the flanks end every line before 3 um") for name in LINE_QUANTITIES]
    angle, longer = left[:, whole]
    compared = f"major axis of the contact ellipse, {whole.sum()} lines"
    return [
        VerificationRow(LINE_QUANTITIES[0], compared, float(np.degrees(greatest(angle))), DIRECTION_LIMIT, "deg"),
        VerificationRow(LINE_QUANTITIES[1], compared, 100.0 * greatest(longer), LENGTH_LIMIT, "%"),
    ]


def smallest_gap_rows(pair: VerifiedPair) -> list[VerificationRow]:
    """Envelope of the unloaded transmission error against the smallest gap between the bounded flanks."""
    cycle = pair.state.cycle
    rotations = cycle.lines.rotations
    step = -(-rotations.size // GAP_POSITIONS)
    zero = cycle.geometry.ease_off.attrs["first_contact_rad"]
    smallest, _ = smallest_envelope(cycle.geometry, rotations[::step])
    exact = 1e6 * (smallest.closing_angle - zero)
    envelope = cycle.unloaded()["transmission_error_envelope"].values[::step]
    on_edge = int(np.count_nonzero(smallest.edge != ""))
    compared = f"smallest gap of the bounded flanks, {exact.size} mesh positions, {on_edge} at an edge"
    return [VerificationRow("unloaded transmission error", compared, greatest(envelope - exact), ERROR_LIMIT, "urad")]
