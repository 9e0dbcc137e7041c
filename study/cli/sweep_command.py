"""Command that analyses a case over swept coordinates."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ...core.errors import time_in_words
from ...core.process_settings import THREAD_VARIABLES
from ..terminal_bar import terminal_bar, working
from .analysis_options import TOLD_TIME, analysis_options, friction_options, given_model, with_defaults
from .command import EXIT_UNCERTIFIED, Command
from .result_commands import draw
from .shared_options import (
    check_folders,
    echo,
    marking_option,
    next_commands,
    opened_case,
    output_option,
    outside_allowed,
    plots_option,
    reader,
)

if TYPE_CHECKING:
    from ..sweep.sweep_plan import SweepPlan

OVER = re.compile(r"([A-Za-z][\w.]*)\s*(=|~)\s*(.+)")
KEEP = re.compile(r"(worst|least)\s*=\s*(\w+)\s*:\s*(\d+)")


@reader
def _swept(texts: tuple[str, ...]) -> dict[str, str]:
    """Values or distributions by the name of the coordinate."""
    coordinates: dict[str, str] = {}
    for text in texts:
        parts = OVER.fullmatch(text.strip())
        if parts is None:
            raise click.BadParameter(f"{text!r}: must be NAME=FROM:TO:COUNT, NAME=V1,V2,... or NAME~normal(0,0.03)")
        name, sign, values = parts.groups()
        if name in coordinates:
            raise click.BadParameter(f"{name} comes twice")
        if (sign == "~") != ("(" in values):
            raise click.BadParameter(f"{text!r}: '=' goes before values, '~' before a distribution")
        coordinates[name] = values
    return coordinates


@reader
def _kept(texts: tuple[str, ...]) -> list[tuple[str, str, int]]:
    """Which points to keep whole: worst or least, the name of the number, and how many."""
    choices = []
    for text in texts:
        parts = KEEP.fullmatch(text.strip())
        if parts is None or not 1 <= int(parts[3]) <= 1000:
            raise click.BadParameter(
                f"{text!r}: must be worst=NUMBER:COUNT, such as worst=max_pressure:3, or least=..."
            )
        choices.append((parts[1], parts[2], int(parts[3])))
    return choices


@click.command(cls=Command)
@analysis_options
@click.option(
    "--over",
    multiple=True,
    callback=_swept,
    metavar="NAME=VALUES",
    help="What is swept: FROM:TO:COUNT, a list V1,V2,... or a distribution as in 'E~normal(0,0.03)'. NAME is torque, "
    "E, P, G, Sigma, speed, temperature, roughness, oil, flank, deviation.MEMBER, modification.TERM or the dotted key "
    "of a number of the case file. May be given several times: every combination is analysed.",
)
@click.option(
    "--load-cases",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="CSV file of load cases, a row a point: torque, E, P, G, Sigma, speed, ..., share.",
)
@click.option("--samples", type=int, metavar="N", help="Number of samples of what is distributed.")
@click.option("--seed", type=int, metavar="S", default=0, help="Seed of the samples.")
@click.option(
    "--sampler", type=click.Choice(["sobol", "latin_hypercube"]), default="sobol", help="How samples are drawn."
)
@output_option("netCDF file to write.")
@plots_option()
@click.option(
    "--keep",
    multiple=True,
    callback=_kept,
    metavar="worst=NUMBER:COUNT",
    help="Write whole results of the points with the greatest (least=: least) values of a number.",
)
@marking_option()
@friction_options
@click.option("--workers", type=int, metavar="N", show_default="one a core", help="Processes; 1: this one alone.")
@click.option("--scheduler", metavar="ADDRESS", help="Scheduler of a dask cluster, in place of processes here.")
@click.option(
    "--store",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="FOLDER",
    show_default="FILE.batches, removed at the end",
    help="Folder that keeps the batches; an interrupted sweep resumes from it.",
)
@click.option("--fresh", is_flag=True, help="Ignore and replace what the folder of batches has.")
def sweep(
    case: str,
    over: dict[str, str],
    load_cases: Path | None,
    supports: str | None,
    output: Path,
    plots: Path | None,
    keep: list[tuple[str, str, int]],
    workers: int | None,
    scheduler: str | None,
    store: Path | None,
    fresh: bool,
    **options: Any,
) -> None:
    """Analyse CASE over swept coordinates.

    One file holds the numbers of all points. Points that cannot be analysed are rows with a status and a reason.
    Interrupted, the same command goes on where it was.
    """
    if "numpy" not in sys.modules:  # the processes of the pool have one thread each, too
        os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    from ...core.errors import EaseoffError
    from ..analysis.operating import Operating
    from ..summary.sweep_report import outcome, sweep_summary
    from ..sweep.parameter_sweep import batch_store, run_plan
    from ..sweep.sweep_file import write_sweep
    from ..sweep.sweep_plan import planned_sweep

    checked = opened_case(case, output, load_cases, options["oil"], *options["deviations"].values(), supports=supports)
    folder = store if store is not None else output.with_name(f"{output.name}.batches")
    check_folders(output, plots, store=store)
    drawn = {name: options.pop(name) for name in ("samples", "seed", "sampler")}
    options["friction_model"] = given_model(checked, options)
    operating = Operating.of(**with_defaults(options))
    plan = planned_sweep(checked, over, operating, load_cases=load_cases, allow_outside=outside_allowed(), **drawn)
    _check_kept(plan, keep)
    _tell_cost(plan)
    done = 0
    try:
        with terminal_bar(total=plan.points, desc="sweep", unit="point") as bar:

            def progress(number: int, _: int) -> None:
                nonlocal done
                done = number
                bar.update(done - bar.n)

            dataset = run_plan(plan, workers=workers, scheduler=scheduler, store=folder, fresh=fresh, progress=progress)
        write_sweep(dataset, output)
    except (KeyboardInterrupt, EaseoffError) as error:
        if done:
            why = "interrupted: " if isinstance(error, KeyboardInterrupt) else ""
            echo(f"{why}the batches so far are kept in {folder}; the same command goes on from them", err=True)
        raise
    echo(f"wrote {output}: {outcome(dataset)}")
    kept = _write_kept(plan, dataset, keep, output)
    if plots is not None and not bool(dataset["max_pressure"].notnull().any() if "max_pressure" in dataset else False):
        echo("no point has numbers: there are no pictures", err=True)
    elif plots is not None:
        draw(dataset, plots)
    if store is None:
        batch_store(plan, folder).remove()
    echo("\n" + sweep_summary(dataset))
    next_commands(("show", kept[0] if kept else output), *([] if plots is not None else [("plot", output, "FOLDER")]))
    if bool((dataset["status"] != 0).any()):
        sys.exit(EXIT_UNCERTIFIED)


def _tell_cost(plan: SweepPlan) -> None:
    """Say on stderr how long a sweep may take that is long."""
    from ..sweep.parameter_sweep import usable_cores

    seconds = plan.table.count * max(plan.size.seconds - 3.0, 0.05)
    if seconds > TOLD_TIME:
        cores = usable_cores()
        echo(
            f"{plan.description}; {plan.table.count} analyses: {time_in_words(seconds)} of one core, "
            f"{time_in_words(seconds / cores)} on the {cores} here",
            err=True,
        )


def _check_kept(plan: SweepPlan, keep: Sequence[tuple[str, str, int]]) -> None:
    """Refuse a number that no point will have."""
    from ..analysis.key_numbers import number_names

    names = number_names(friction=plan.friction is not None)
    for side, name, count in keep:
        if name not in names:
            raise click.UsageError(f"--keep = '{side}={name}:{count}': must name one of {', '.join(names)}")


def _write_kept(plan: SweepPlan, found: Any, keep: Sequence[tuple[str, str, int]], output: Path) -> list[Path]:
    """Whole results of chosen points, in a folder named after the file of the sweep."""
    from ...core.errors import EaseoffError
    from ..result import write_result
    from ..sweep import worst_points
    from ..sweep.batch_analysis import point_tree

    written: dict[int, Path] = {}
    for side, name, count in keep:
        if name not in found:
            echo(f"--keep: no point has a number {name}", err=True)
            continue
        for row in worst_points(found, name, count, least=side == "least")["row"].values.tolist():
            if row in written:
                continue
            path = output.with_name(f"{output.stem}-points") / f"{row:06d}.nc"
            try:
                with working(f"analysing point {row}"):
                    tree = point_tree(plan.setup, plan.table.values(row))
            except EaseoffError as error:
                echo(f"point {row}: {error}", err=True)
                continue
            write_result(tree, path)
            written[row] = path
            said = ", ".join(
                f"{key} = {value:g}" if isinstance(value, float) else f"{key} = {value}"
                for key, value in plan.table.values(row).items()
            )
            echo(f"wrote {path}: {said or plan.description}")
    return list(written.values())
