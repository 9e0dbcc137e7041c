"""Case of a command: opened, with the files to write checked, its cost told, and the progress of its run shown."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from ...core.errors import time_in_words
from ..progress import terminal_bar

if TYPE_CHECKING:
    from ...cases import Case
    from ...cases.analysis_size import AnalysisSize

#: Key of the answer to ``--allow-outside``.
ALLOW_OUTSIDE = "easeoff.allow_outside"
#: How the stages begin in which teeth are built; see ``cases.conversion.finite_elements``.
TOOTH_STAGES = ("solid shell", "finite elements")
TOLD_TIME = 60.0  # [s]; the cost of an analysis that takes longer is told before it


def outside_allowed() -> bool:
    """True if ``--allow-outside`` was given to the command that runs."""
    return bool(click.get_current_context().meta.get(ALLOW_OUTSIDE, False))


def opened_case(case: str, output: Path | None, *sources: object, supports: str | None = None) -> Case:
    """The case of a name or path, on the supports of ``--supports``, for a netCDF file to write; see `check_output`.

    What was taken for basic data that it leaves out is told on stderr.
    """
    from ...cases import read_case, with_supports

    checked = read_case(case, allow_outside=outside_allowed())
    for line in basic_data_lines(checked):
        click.echo(line, err=True)
    oil = None if checked.friction is None else checked.friction.oil_file
    check_output(output, case, supports, oil, *sources, suffix=".nc")
    return checked if supports is None else with_supports(checked, supports)


def basic_data_lines(case: Case) -> list[str]:
    """Values taken for what the basic data of a case leave out, and spiral angles that differ, a line each."""
    if case.blank_design is None:
        return []
    from ...cases import designed_blanks
    from ...cases.conversion import TOLD_SPIRAL_DIFFERENCE, spiral_angle_difference

    blank = designed_blanks(case.blank_design, (case.pinion.number_of_teeth, case.gear.number_of_teeth), case.pair)
    difference, text = spiral_angle_difference(case.blank_design, blank)
    taken = [f"  {each}" for each in case.blank_design.defaults]
    head = ["Taken for what [blank_design] leaves out:"] if taken else []
    return [*head, *taken, *([f"Warning: {text}"] if abs(difference) > TOLD_SPIRAL_DIFFERENCE else [])]


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
