"""Options of the commands that analyse a case, and their progress bar.

Options of the commands that compute friction: operating conditions and models.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from ...core.errors import time_in_words
from ..terminal_bar import terminal_bar
from .shared_options import (
    DEFLECTION_FILE,
    MISALIGNMENT,
    allow_outside_option,
    deviation_option,
    flank_option,
    misalignment,
    numbers,
    outside_allowed,
    roughnesses,
    torques,
)
from .word_completion import case_names, friction_models, oil_names, solver_names, support_names

if TYPE_CHECKING:
    from ...cases import Case
    from ...cases.analysis_size import AnalysisSize
    from ...cases.schema.friction_table import FrictionTable
    from ...friction import FrictionModel

# Everything heavy is imported where it is needed: ``easeoff --help`` stays quick.

#: How the stages begin in which teeth are built; see ``cases.conversion.finite_elements``.
TOOTH_STAGES = ("solid shell", "finite elements")

_PAIR = (
    click.argument("case", shell_complete=case_names),
    allow_outside_option,
    flank_option,
    click.option(
        "--misalignment",
        callback=misalignment,
        metavar=MISALIGNMENT,
        show_default="from the case",
        help=f"Assembly errors in mm, Sigma in degrees; {DEFLECTION_FILE}.",
    ),
    deviation_option(
        "Deviation of a member's flank from the designed one: a measured grid (a file, or the name of a shipped one) "
        "or a file of 'easeoff wear'. May be given for both members."
    ),
    click.option(
        "--interpolation",
        type=click.Choice(["spline", "smooth", "weighted_average"]),
        show_default="spline",
        help="Interpolation between the nodes of measured grids; smooth evens out their scatter.",
    ),
)
_SOLVER = click.option(
    "--solver",
    metavar="NAME",
    shell_complete=solver_names,
    default="auto",
    show_default=True,
    help="Contact solver; MODULE:FUNCTION for one of your own.",
)
_DEVIATED = click.option(
    "--deviated",
    type=click.Choice(["ease_off", "surface"]),
    show_default="ease_off",
    help="How deviations are taken in: the ease-off is updated, or the deviating surfaces are computed.",
)
supports_option = click.option(
    "--supports",
    metavar="NAME|FILE",
    show_default="from the case",
    shell_complete=support_names,
    help="Shafts, bearings and housing that hold pinion and gear: a file, or the name of shipped ones.",
)
_ANALYSIS = (
    click.option(
        "--edge-contact/--lines-only",
        "edge_contact",
        default=None,
        show_default="edges, unless the case says lines only",
        help="Contact of tooth edges beside the contact lines, or of the lines only.",
    ),
    click.option(
        "--torque",
        "torques",
        callback=torques,
        metavar="T1,T2,...",
        show_default="from the case",
        help="Torques at the pinion in N m.",
    ),
    supports_option,
    _DEVIATED,
)

TOLD_TIME = 60.0  # [s]; the cost of an analysis that takes longer is told before it
DEVIATING = {"interpolation": "spline", "deviated": "ease_off"}


def pair_options(command: Any) -> Any:
    """Add the argument CASE and the options of its pair to a command: flank, misalignment, deviations, solver."""
    for option in reversed((*_PAIR, _SOLVER)):
        command = option(command)
    return command


def unloaded_options(command: Any) -> Any:
    """Add the argument CASE and the options of its pair without load to a command: those of a pair but the solver."""
    for option in reversed((*_PAIR, _DEVIATED)):
        command = option(command)
    return command


def analysis_options(command: Any) -> Any:
    """Add the argument CASE and the options of an analysis to a command."""
    for option in reversed(_ANALYSIS):
        command = option(command)
    return pair_options(command)


def with_defaults(options: dict[str, Any]) -> dict[str, Any]:
    """Options with the defaults of ``--interpolation`` and ``--deviated``, which must go with ``--deviation``."""
    defaults = {name: value for name, value in DEVIATING.items() if name in options}
    for name in defaults:
        if options[name] is not None and not options["deviations"]:
            raise click.UsageError(f"--{name} = {options[name]}: must go with --deviation")
    return options | {name: value for name, value in defaults.items() if options[name] is None}


def chosen_case(case: str, supports: str | None) -> Case:
    """The case of a name or path, with the supports of ``--supports``."""
    from ...cases import read_case

    checked = read_case(case, allow_outside=outside_allowed())
    if supports is None:
        return checked
    from ...cases import with_supports

    return with_supports(checked, supports)


class Progress(NamedTuple):
    """Calls that show progress: after every step, and with the name of a stage before it."""

    step: Callable[[], None]
    stage: Callable[[str], None]


def check_cost(case: Case, size: AnalysisSize) -> None:
    """Refuse an analysis that needs more memory than is free; say on stderr what takes more than a minute."""
    size.require_memory()
    teeth = size.teeth_seconds(case)
    if teeth > TOLD_TIME:
        made = f"elastic teeth with fineness = {case.compliance.fineness:g}: {time_in_words(teeth)}"
        click.echo(f"{made}, unless they are kept from an earlier run", err=True)
    if size.seconds > TOLD_TIME:
        each = size.speeds * size.temperatures * size.roughnesses
        friction = f", each at {each} operating conditions" if each > 1 else ""
        click.echo(f"{size.solved_positions} contact problems{friction}: {time_in_words(size.seconds)}", err=True)


@contextmanager
def progress_bar(case: Case, torques: Any) -> Iterator[Progress]:
    """Show a progress bar on a terminal, with the name of the stage; the case's own torques if ``None``."""
    total = len(torques or case.contact.torques) * case.contact.mesh_positions
    with terminal_bar(total=total, desc="geometry", unit="solve") as bar:
        yield Progress(lambda: _step(bar), lambda name: show_stage(bar, name))


def _step(bar: Any) -> None:
    bar.update(1)


def show_stage(bar: Any, name: str) -> None:
    """Name the stage on a progress bar, and measure the time from here."""
    if not bar.disable:
        bar.reset()
        total = vars(bar).setdefault("steps_in_all", bar.total)
        # Friction comes in parts of which the number is not known, and teeth are built, not solved.
        bar.total = None if name == "friction" or name.startswith(TOOTH_STAGES) else total
    bar.set_description_str(name)


# Everything heavy is imported where it is needed: ``easeoff --help`` stays quick.

_FRICTION = (
    click.option(
        "--speed",
        callback=numbers,
        metavar="N1,N2,...",
        help="Speeds of the pinion in 1/min, or FROM:TO:COUNT; adds friction, power loss and efficiency. The table "
        "[friction] of the case replaces the defaults of this and the following options.",
    ),
    click.option(
        "--oil",
        metavar="OIL",
        show_default="75w90",
        shell_complete=oil_names,
        help="Lubricant: the name of a shipped one, or a TOML file.",
    ),
    click.option(
        "--temperature",
        callback=numbers,
        metavar="T1,T2,...",
        show_default="90",
        help="Oil temperatures in degC, or FROM:TO:COUNT.",
    ),
    click.option(
        "--roughness",
        callback=roughnesses,
        metavar="R1,R2,...",
        show_default="0.8",
        help="RMS roughnesses Rq of the flanks in um, each a number or PINION/GEAR.",
    ),
    click.option(
        "--friction-model",
        metavar="MODEL",
        shell_complete=friction_models,
        show_default="kolivand_blended",
        help="Friction coefficient: a model (kolivand_blended, kolivand, mixed_lubrication, xu_kahraman, "
        "benedict_kelly), or a number from 0 to 1.",
    ),
    click.option(
        "--film-heating",
        metavar="FACTOR",
        show_default="none",
        help="Heat of the inlet thins the film: none, gupta_cheng or murch_wilson.",
    ),
    click.option(
        "--clamp-temperature/--no-clamp-temperature",
        default=None,
        show_default="no",
        help="Beyond the oil's data, take the last value and flag it.",
    ),
    click.option(
        "--friction-feedback/--no-friction-feedback",
        default=None,
        show_default="no",
        help="Include friction in the balance of torque, which changes the normal forces.",
    ),
)


def friction_options(command: Any) -> Any:
    """Add the options of friction to a command: operating conditions and models."""
    for option in reversed(_FRICTION):
        command = option(command)
    return command


def chosen_model(
    table: FrictionTable | None, name: str | None, film_heating: str | None, clamp: bool | None
) -> FrictionModel:
    """Friction models of the case, with the coefficient, film heating and rule beyond the oil's data that are given."""
    from ...friction import FrictionModel

    changed: dict[str, Any] = {}
    if name is not None:
        changed["coefficient"] = name
        with suppress(ValueError):
            changed["coefficient"] = float(name)
    if film_heating is not None:
        changed["film_heating"] = film_heating
    if clamp is not None:
        changed["out_of_range"] = "clamp" if clamp else "error"
    return FrictionModel(**changed) if table is None else table.model(**changed)
