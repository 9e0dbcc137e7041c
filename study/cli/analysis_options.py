"""Options of the commands that analyse a case, and their progress bar.

Options of the commands that compute friction: operating conditions and models.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from ...core.errors import time_in_words
from ..terminal_bar import terminal_bar
from .shared_options import (
    adding,
    case_argument,
    deviation_option,
    flank_option,
    misalignment_option,
    numbers,
    reader,
    roughnesses,
    solver_option,
    torque_option,
)
from .word_completion import friction_models, oil_names, support_names

if TYPE_CHECKING:
    from ...cases import Case
    from ...cases.analysis_size import AnalysisSize
    from ...friction import FrictionModel

# Everything heavy is imported where it is needed: ``easeoff --help`` stays quick.

#: How the stages begin in which teeth are built; see ``cases.conversion.finite_elements``.
TOOTH_STAGES = ("solid shell", "finite elements")

_PAIR: tuple[Any, ...] = (
    case_argument(),
    flank_option,
    misalignment_option,
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
_ANALYSIS: tuple[Any, ...] = (
    click.option(
        "--edge-contact/--lines-only",
        "edge_contact",
        default=None,
        show_default="edges, unless the case says lines only",
        help="Contact of tooth edges beside the contact lines, or of the lines only.",
    ),
    torque_option(),
    supports_option,
    _DEVIATED,
)

TOLD_TIME = 60.0  # [s]; the cost of an analysis that takes longer is told before it
DEVIATING = {"interpolation": "spline", "deviated": "ease_off"}


#: The argument CASE and the options of its pair: flank, misalignment, deviations; with a solver, without load, and of
#: a whole analysis.
pair_options = adding(*_PAIR, solver_option())
unloaded_options = adding(*_PAIR, _DEVIATED)
analysis_options = adding(*_PAIR, solver_option(), *_ANALYSIS)


def with_defaults(options: dict[str, Any]) -> dict[str, Any]:
    """Options with the defaults of ``--interpolation`` and ``--deviated``, which must go with ``--deviation``."""
    defaults = {name: value for name, value in DEVIATING.items() if name in options}
    for name in defaults:
        if options[name] is not None and not options["deviations"]:
            raise click.UsageError(f"--{name} = {options[name]}: must go with --deviation")
    return options | {name: value for name, value in defaults.items() if options[name] is None}


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
def progress_bar(case: Case, torques: int) -> Iterator[Progress]:
    """Show a progress bar on a terminal, with the name of the stage, for a number of torques."""
    total = torques * case.contact.mesh_positions
    with terminal_bar(total=total, desc="geometry", unit="solve") as bar:
        yield Progress(bar.update, partial(show_stage, bar))


def show_stage(bar: Any, name: str) -> None:
    """Name the stage on a progress bar, and measure the time from here."""
    if not bar.disable:
        bar.reset()
        total = vars(bar).setdefault("steps_in_all", bar.total)
        # Friction comes in parts of which the number is not known, and teeth are built, not solved.
        bar.total = None if name == "friction" or name.startswith(TOOTH_STAGES) else total
    bar.set_description_str(name)


_FRICTION = (
    click.option(
        "--speed",
        callback=reader(numbers),
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
        callback=reader(lambda text: numbers(text, from_zero=True)),
        metavar="T1,T2,...",
        show_default="90",
        help="Oil temperatures in degC, or FROM:TO:COUNT.",
    ),
    click.option(
        "--roughness",
        callback=reader(roughnesses),
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


#: Options of friction: operating conditions and models.
friction_options = adding(*_FRICTION)


def given_model(case: Case, options: dict[str, Any]) -> FrictionModel | None:
    """Friction models of the case with what options say of them, which is taken out; ``None`` if nothing is said."""
    name, film_heating, clamp = (options.pop(key) for key in ("friction_model", "film_heating", "clamp_temperature"))
    if name is None and film_heating is None and clamp is None:
        return None
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
    return FrictionModel(**changed) if case.friction is None else case.friction.model(**changed)
