"""Rows of the unloaded contact: five equations of conventional analysis, contact ellipse, smallest gap."""

from __future__ import annotations

import numpy as np

from ..contact.lines.closest_approach import closest_approach
from .conventional_analysis import BothMethods, line_differences, methods_compared, point_differences
from .flank_rows import greatest
from .smallest_gap import smallest_envelope
from .verification_row import VerificationRow, not_applicable
from .verified_pair import VerifiedPair

ERROR_LIMIT = 0.1  # [urad], of the transmission error
PATH_LIMIT = 4e-4  # of the face width: the path is interpolated between 65 points of a line
#: [%], of the relative curvature: the analysis takes it on the line, not at the closest approach beside it. A pressure
#: changes half as much.
CURVATURE_LIMIT = 4.0
DIRECTION_LIMIT = 0.1  # [deg], of the contact line
LENGTH_LIMIT = 0.5  # [%], of the contact line
SEPARATIONS = (3.0, 1.5)  # [um] at the ends of the lines that are extrapolated to none
CONVENTIONAL_POSITIONS, GAP_POSITIONS = 48, 16


def conventional_rows(pair: VerifiedPair) -> list[VerificationRow]:
    """Transmission error, path of contact and contact lines against conventional contact analysis."""
    both = methods_compared(pair.state.cycle.geometry, CONVENTIONAL_POSITIONS)
    error, away = point_differences(both)
    count, missed = int(both.inside.sum()), int((~both.contact.converged).sum())
    compared = f"five equations, {count} points inside both flanks"
    unsolved_rotations = f"rotations of a tooth pair without a solution, of {both.contact.converged.size}"
    unsolved = VerificationRow("conventional analysis", unsolved_rotations, missed, 0, "1")
    if not count:
        reason = "no tooth pair touches inside both flanks, 2 % off their edges"
        names = ("transmission error of a tooth pair", "path of contact", "relative curvature across the line")
        return [unsolved, *(not_applicable(name, reason) for name in (*names, *LINE_QUANTITIES))]
    width = pair.state.pair.gear.section.face_width
    inside = both.inside
    return [
        unsolved,
        VerificationRow(
            "transmission error of a tooth pair", compared, 1e6 * greatest(error[inside]), ERROR_LIMIT, "urad"
        ),
        VerificationRow("path of contact", compared, 1e3 * greatest(away[inside]), 1e3 * PATH_LIMIT * width, "um"),
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
    return VerificationRow("relative curvature across the line", compared, difference, CURVATURE_LIMIT, "%")


def _line_rows(both: BothMethods) -> list[VerificationRow]:
    """Direction and length of the contact line against the major axis of the contact ellipse.

    The ellipse is of second order: the third order grows with the separation at the line's ends, and an extrapolation
    to none takes it away.
    """
    wide, narrow = (np.stack(line_differences(both, separation)) for separation in SEPARATIONS)
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
    difference = envelope - exact
    on_edge = int(np.count_nonzero(smallest.edge != ""))
    compared = f"smallest gap of the bounded flanks, {exact.size} mesh positions, {on_edge} at an edge"
    return [VerificationRow("unloaded transmission error", compared, greatest(difference), ERROR_LIMIT, "urad")]
