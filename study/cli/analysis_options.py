"""What the commands that analyse a case have in common: their options and a progress bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from .options import deviations, misalignment, torques

# Everything heavy is imported by the command that needs it: `easeoff --help` stays quick.
if TYPE_CHECKING:
    from ...cases import Case

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
    """The options, with defaults for those on deviations that are left out.

    Raises
    ------
    click.UsageError
        If one of them is given and no deviation is.

    Examples
    --------
    >>> with_defaults({"deviations": {}, "interpolation": None})
    {'deviations': {}, 'interpolation': 'spline'}
    """
    own = {name: value for name, value in DEVIATING.items() if name in options}
    for name in own:
        if options[name] is not None and not options["deviations"]:
            raise click.UsageError(f"--{name} goes with --deviation: without one there is nothing that it changes")
    return options | {name: value for name, value in own.items() if options[name] is None}


@contextmanager
def progress_bar(case: Case, torques: Any) -> Iterator[Callable[[], None]]:
    """Show the progress of an analysis, unless the output is no terminal; gives what the analysis calls as it goes on.

    Parameters
    ----------
    case
        A checked case.
    torques
        Torques at the pinion [N m]; the case's own if ``None``.
    """
    from tqdm import tqdm

    total = len(torques or case.contact.torques) * case.contact.mesh_positions
    with tqdm(total=total, desc="loaded contact", unit="solve", disable=None, leave=False) as bar:
        yield lambda: _step(bar)


def _step(bar: Any) -> None:
    bar.update(1)
