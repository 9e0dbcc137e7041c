"""Options of the commands that compute friction: operating conditions and models."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

import click

from ..terminal.word_completion import friction_models, oil_names
from .shared_options import numbers, roughnesses

# Everything heavy is imported where it is needed: ``easeoff --help`` stays quick.
if TYPE_CHECKING:
    from ....cases.schema.friction_table import FrictionTable
    from ....friction import FrictionModel

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
    from ....friction import FrictionModel

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
