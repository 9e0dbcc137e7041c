"""Command line ``easeoff``: a module a group of commands.

Each command imports what it needs when it runs, so that ``easeoff --help`` stays quick.
"""

from __future__ import annotations

import io
import os
import sys
import warnings
from contextlib import suppress
from typing import Any, NoReturn

import click

from ...core import errors
from ...core.errors import EaseoffError
from .analysis_commands import run, sweep
from .case_commands import cases, convert, design, new, oil, sheet
from .command import EXIT_MISTAKE, PROGRAM, as_given, echo
from .geometry_commands import correct, export
from .result_commands import cite, plot, report, show
from .solver_commands import compare, library, problems
from .study_commands import modify, optimize, verify, vh, wear
from .word_completion import completion


class _Mistake(click.ClickException):
    """Mistake of the user, with its exit code."""

    exit_code = EXIT_MISTAKE


def _show_warning(message: Warning | str, category: type[Warning], *_place: Any, **_options: Any) -> None:
    """Show a warning to users once, as a note of one line without the place in the code that it comes from."""
    kind = "" if category is UserWarning else f"{category.__name__}: "
    note = f"Note: {kind}{' '.join(str(message).split())}"
    context = click.get_current_context(silent=True)  # of the thread
    notes = context.meta.setdefault("easeoff.notes", set()) if context else set()
    if note not in notes:
        notes.add(note)
        echo(note, err=True)


class _Group(click.Group):
    """Group of commands that turns the package's exceptions into one message and exit code 2."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run a command; what a terminal or file cannot show of the output is written as an escape sequence."""
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="backslashreplace")
        try:
            return super().main(*args, **kwargs)
        except OSError as error:  # of a full disk, above all, that holds the output
            if not kwargs.get("standalone_mode", True):
                raise
            _discard_output()
            with suppress(OSError):
                _Mistake(f"{error.filename or 'the output'}: {error.strerror or error}").show()
            sys.exit(EXIT_MISTAKE)

    def invoke(self, ctx: click.Context) -> Any:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _show_warning
                return super().invoke(ctx)
        except EaseoffError as error:
            raise _Mistake(as_given(str(error))) from error
        except click.ClickException as error:
            # The words of the command line in the message are made harmless to a terminal, and shortened.
            said = errors.message(as_given(error.format_message()))
            raise (
                click.UsageError(said, error.ctx) if isinstance(error, click.UsageError) else _Mistake(said)
            ) from error
        except MemoryError as error:
            said = f" ({str(error)[:150]})" if str(error) else ""
            raise _Mistake(
                f"there is not enough memory for this{said}: lower the numbers that decide its size, such as torques, "
                "mesh_positions, segments_per_line, nodes and fineness"
            ) from error


def _discard_output() -> None:
    """Discard what the standard output, on a full disk for example, does not take; it would fail again at the end."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"], "show_default": True})
@click.version_option(package_name="easeoff")
def main() -> None:
    """Contact of spiral bevel and hypoid gears, from machine settings to certified loaded contact.

    'easeoff COMMAND --help' describes a command. CASE, in all of them, is the name of a shipped case or the path of a
    case file.
    """


for _command in (
    run,
    show,
    plot,
    report,
    sweep,
    verify,
    vh,
    modify,
    optimize,
    cases,
    new,
    design,
    sheet,
    problems,
    library,
    compare,
    export,
    convert,
    correct,
    wear,
    oil,
    cite,
    completion,
):
    main.add_command(_command)


def program() -> None:
    """Run a command in a process that does nothing else, and ends with it."""
    process, leave = os.getpid(), os._exit

    def leave_copy(status: int) -> NoReturn:
        """`os._exit` for foreign code, which must not end a command as if all were done; copies of it may end."""
        if os.getpid() == process:
            raise SystemExit(status)
        leave(status)

    os._exit = leave_copy
    main(obj=PROGRAM)
