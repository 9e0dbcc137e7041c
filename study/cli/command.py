"""Class of all commands: it refuses options given twice, and values torn apart by blanks or decimal commas.

What commands have in common: exit codes (0 is success), checks of what they read and write, progress.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from ...core.errors import printable_lines, time_in_words
from ...core.file_name import check_text
from ...core.process_settings import without_garbage_collection
from ..terminal_bar import terminal_bar

if TYPE_CHECKING:
    from ...cases import Case
    from ...cases.analysis_size import AnalysisSize

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
#: Key of the answer to ``--allow-outside``.
ALLOW_OUTSIDE = "easeoff.allow_outside"


#: How the stages begin in which teeth are built; see ``cases.conversion.finite_elements``.
TOOTH_STAGES = ("solid shell", "finite elements")
TOLD_TIME = 60.0  # [s]; the cost of an analysis that takes longer is told before it


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


def outside_allowed() -> bool:
    """True if ``--allow-outside`` was given to the command that runs."""
    return bool(click.get_current_context().meta.get(ALLOW_OUTSIDE, False))


def opened_case(case: str, output: Path | None, *sources: object, supports: str | None = None) -> Case:
    """The case of a name or path, on the supports of ``--supports``, for a netCDF file to write; see `check_output`."""
    from ...cases import read_case, with_supports

    checked = read_case(case, allow_outside=outside_allowed())
    oil = None if checked.friction is None else checked.friction.oil_file
    check_output(output, case, supports, oil, *sources, suffix=".nc")
    return checked if supports is None else with_supports(checked, supports)


def check_output(output: Path | None, *sources: object, suffix: str | None = None, force: bool | None = None) -> None:
    """Refuse a file to write, if there is one, that cannot be written or is one of the files read.

    With ``force`` false a case file that was edited by hand, too.
    """
    from ...core.output_file import check_writable

    if output is None:
        return
    check_writable(output, *(str(source) for source in sources if source is not None), suffix=suffix)
    if force is not None:
        from ...cases.writing import require_replaceable

        require_replaceable(output, force)


def check_folders(output: Path | None, plots: Path | None, **folders: Path | None) -> None:
    """Refuse folders, by the names of their options, with the name of the output, and pictures that have no place."""
    from ...core.output_file import check_folder

    for option, folder in {**folders, "plots": plots}.items():
        if folder is not None and output is not None and os.path.abspath(folder) == os.path.abspath(output):
            raise click.UsageError(f"--{option} = {str(folder)!r}: must be another name than that of the file")
    if plots is not None:
        check_folder(plots, "pictures")


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
