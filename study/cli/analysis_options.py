"""What the commands that analyse a case have in common: their options, and the analysis with a progress bar."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .options import deviations, misalignment, torques

# Everything heavy is imported by the command that needs it: `easeoff --help` stays quick.
if TYPE_CHECKING:
    from ...cases import Case
    from ..analysis import Analysis

_PAIR = (
    click.argument("case"),
    click.option(
        "--flank",
        type=click.Choice(["drive", "coast"]),
        default="drive",
        show_default=True,
        help="Which flanks mesh: drive is pinion concave with gear convex.",
    ),
    click.option(
        "--misalignment",
        callback=misalignment,
        metavar="E=..,P=..,G=..,Sigma=..",
        help="Assembly errors in mm (Sigma in degrees); the case's own if left out.",
    ),
    click.option(
        "--deviation",
        "deviations",
        multiple=True,
        callback=deviations,
        metavar="MEMBER=FILE",
        help="Departure of a member's flank from the designed one: a measured grid, a file or a shipped one, or a "
        "file of easeoff wear; may be given for both.",
    ),
    click.option(
        "--interpolation",
        type=click.Choice(["spline", "smooth", "weighted_average"]),
        help="Between the nodes of measured grids; smooth evens out their scatter.  [default: spline]",
    ),
    click.option("--solver", default="auto", show_default=True, help="Contact solver."),
)
_ANALYSIS = (
    click.option(
        "--edge-contact/--lines-only",
        "edge_contact",
        default=None,
        help="Whether tooth edges may touch beside the contact lines; if left out as the case says, or with fe and "
        "solid_shell.",
    ),
    click.option(
        "--torque",
        "torques",
        callback=torques,
        metavar="T1,T2,...",
        help="Torques at the pinion in N m; the case's own if left out.",
    ),
    click.option(
        "--deviated",
        type=click.Choice(["ease_off", "surface"]),
        help="Update the ease-off for the deviations, or compute with the deviating flanks themselves.  "
        "[default: ease_off]",
    ),
)

DEVIATING = {"interpolation": "spline", "deviated": "ease_off"}


def pair_options(command: Any) -> Any:
    """Add the argument CASE and what says in which state its pair is to a command."""
    for option in reversed(_PAIR):
        command = option(command)
    return command


def analysis_options(command: Any) -> Any:
    """Add the argument CASE and the options of an analysis to a command."""
    for option in reversed(_ANALYSIS):
        command = option(command)
    return pair_options(command)


def with_defaults(options: dict[str, Any]) -> dict[str, Any]:
    """The options with what stands for those that say how deviations are taken, where they are left out.

    Raises
    ------
    click.UsageError
        If one of them is given and no deviation is.
    """
    own = {name: value for name, value in DEVIATING.items() if name in options}
    for name in own:
        if options[name] is not None and not options["deviations"]:
            raise click.UsageError(f"--{name} goes with --deviation: without one there is nothing that it changes")
    return options | {name: value for name, value in own.items() if options[name] is None}


def analysed(case: str | Case, *, torques: Any, **options: Any) -> Analysis:
    """Analyse a case with a progress bar, which keeps quiet when the output is not a terminal.

    Parameters
    ----------
    case
        A checked case, or the name or path of one.
    torques
        Torques at the pinion [N m]; the case's own if ``None``.
    **options
        The other arguments of ``analyze_in_full``.
    """
    from tqdm import tqdm

    from ...cases import read_case
    from ..analysis import analyze_in_full

    checked = read_case(case) if isinstance(case, str) else case
    total = len(torques or checked.contact.torques) * checked.contact.mesh_positions
    with tqdm(total=total, desc="loaded contact", unit="solve", disable=None, leave=False) as bar:
        return analyze_in_full(checked, torques=torques, progress=lambda: _step(bar), **with_defaults(options))


def _step(bar: Any) -> None:
    bar.update(1)
