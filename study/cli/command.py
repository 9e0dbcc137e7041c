"""Class of all commands: it refuses options given twice, and values torn apart by blanks or decimal commas.

What commands have in common: exit codes (0 is success), lines for the user, a quick start.
"""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

from ...core.errors import printable_lines
from ...core.file_name import check_text
from ...core.process_settings import without_garbage_collection

DECIMAL_COMMA = re.compile(r"([+-]?\d+),(\d+(?:e[+-]?\d+)?)", re.IGNORECASE)
PART_OF_A_LIST = re.compile(r"\S*[=,]\S*|[+-]?[\d.]+(?:e[+-]?\d+)?", re.IGNORECASE)
#: The result holds uncertified values, the wear ended early, a verification is outside its limits, or a designed member
#: has no whole tooth.
EXIT_UNCERTIFIED = 1
#: The user's mistake; one message says which.
EXIT_MISTAKE = 2
#: What commands find in the context of click where their process does nothing else.
PROGRAM = "program"
#: Key of the relative paths of the command line, by the absolute ones that stand for them.
GIVEN = "easeoff.given"


class Command(click.Command):
    """Command whose options come at most once, unless they may be repeated; click would take the last value."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; its paths stay what they are wherever code of somebody else may go."""
        options = {param.name for param in self.params if isinstance(param, click.Option)}
        given: dict[str, str] = ctx.meta.setdefault(GIVEN, {})
        with suppress(OSError):  # the current folder is gone
            for name, value in ctx.params.items():
                ctx.params[name] = _absolute(value, given, option=name in options)
        return super().invoke(ctx)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Check the words of the command line, then parse them as click does."""
        for word in args:
            check_text(word)  # names and titles, which results and case files must be able to hold
        values, rest, given = self.make_parser(ctx).parse_args(args=list(args))
        if not any(param.is_eager for param in given):  # --help
            for param in dict.fromkeys(given):
                if isinstance(param, click.Option):
                    _check_option(ctx, param, values[str(param.name)], given.count(param))
            _check_rest(ctx, rest)
        try:
            return super().parse_args(ctx, args)
        except click.MissingParameter as error:
            if isinstance(error.param, click.Option) and error.param.help:
                raise click.MissingParameter(error.param.help, error.ctx, error.param) from error
            raise


def _absolute(value: Any, given: dict[str, str], *, option: bool) -> Any:
    """A path, or several, from the root; but an argument without a file may be the name of something shipped."""
    if isinstance(value, tuple):
        return tuple(_absolute(one, given, option=option) for one in value)
    if not isinstance(value, Path) or value.is_absolute() or not (option or value.exists()):
        return value
    given[str(value.absolute())] = str(value)
    return value.absolute()


def as_given(text: str) -> str:
    """A text for the user, with the paths of the command line as they were given."""
    context = click.get_current_context(silent=True)  # of this thread
    given: dict[str, str] = context.meta.get(GIVEN, {}) if context else {}
    for path in sorted(given, key=len, reverse=True):
        text = text.replace(path, given[path])
    return text


#: Packages that xarray imports where they are installed, for arrays of kinds that no command makes.
FOREIGN_ARRAYS = ("dask", "pint", "cupy", "sparse")


def quick_start(*, alone: bool = True) -> None:
    """Leave out garbage collection and what xarray imports for foreign arrays: as long as the work of a command.

    With ``alone`` false, as for a solver of somebody else's, these packages can be imported.
    """
    context = click.get_current_context()
    context.with_resource(without_garbage_collection(at_all=alone and context.obj == PROGRAM))
    if alone and not {"xarray", *FOREIGN_ARRAYS} & sys.modules.keys():  # else xarray knows them already
        for package in FOREIGN_ARRAYS:
            sys.modules[package] = None  # type: ignore[assignment]  # Python's own sign for a package that is not there
            context.call_on_close(lambda package=package: sys.modules.pop(package, None))


def _check_option(ctx: click.Context, option: click.Option, value: Any, count: int) -> None:
    """Refuse an option given twice, a list that ends in a comma, and a number with a decimal comma."""
    name = "/".join(max(names, key=len) for names in (option.opts, option.secondary_opts) if names)
    listed = option.type is click.STRING and option.callback is not None
    if count > 1 and not option.multiple:
        ctx.fail(f"{name}: must come once, but comes {'twice' if count == 2 else f'{count} times'}")
    for text in value if option.multiple else [value]:
        if not isinstance(text, str):
            continue
        if listed and text.strip(", ") and text.rstrip().endswith(","):
            ctx.fail(f"{name} = {text!r}: ends in a comma; leave out the blanks after commas, or quote the whole value")
        decimal = DECIMAL_COMMA.fullmatch(text.strip())
        if decimal and not listed and option.type in (click.FLOAT, click.STRING):
            ctx.fail(f"{name} = {text!r}: must be one number; decimals have a point: {'.'.join(decimal.groups())}")


def _check_rest(ctx: click.Context, rest: list[str]) -> None:
    """Say of a word too many that looks like a part of a list how lists are written."""
    for word in rest:
        if PART_OF_A_LIST.fullmatch(word):
            ctx.fail(
                f"{word!r}: belongs to no option; a blank ends a value: leave out the blanks around commas and equals "
                "signs, or quote the whole value"
            )


def echo(text: str, *, err: bool = False) -> None:
    """Print lines with foreign text in them, which must not steer the terminal."""
    click.echo(printable_lines(as_given(text)), err=err)


def next_commands(*commands: Sequence[object]) -> None:
    """Say which commands take what was written; each is given by its words after ``easeoff``."""
    words = (shlex.join(["easeoff", *map(str, command)]) for command in commands)
    echo(f"next: {', or '.join(words)}")


def end_uncertified(failures: Sequence[str]) -> None:
    """End by the exit code of an uncertified result if there are failures, and say them."""
    if failures:
        echo("\n".join(failures), err=True)
        sys.exit(EXIT_UNCERTIFIED)
