"""The command line, one module a command.

Everything heavy is imported by the command that needs it: `easeoff --help` stays quick.
"""

from __future__ import annotations

from typing import Any

import click

from ...core.errors import EaseoffError
from .cases_command import cases
from .compare_command import compare
from .convert_command import convert
from .correct_command import correct
from .design_command import design
from .exit_codes import EXIT_MISTAKE
from .export_command import export
from .library_command import library
from .optimize_command import optimize
from .plot_command import plot
from .problems_command import problems
from .run_command import run
from .show_command import show
from .wear_command import wear


class _Mistake(click.ClickException):
    """What the user can put right."""

    exit_code = EXIT_MISTAKE


class _Group(click.Group):
    """Turns the package's own exceptions into one message and exit code 2."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except EaseoffError as error:
            raise _Mistake(str(error)) from error


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="easeoff")
def main() -> None:
    """Contact of spiral bevel and hypoid gears: from machine settings to certified loaded contact."""


for _command in (run, show, plot, optimize, design, cases, problems, library, compare, export, convert, correct, wear):
    main.add_command(_command)
