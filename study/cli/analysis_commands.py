"""Command that analyses a case over swept coordinates."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from ...core.errors import time_in_words
from ...core.process_settings import THREAD_VARIABLES
from ..progress import terminal_bar, working
from . import option
from .case_run import TOLD_TIME, check_cost, check_folders, opened_case, outside_allowed, progress_bar
from .command import EXIT_UNCERTIFIED, Command, echo, next_commands, quick_start
from .option_values import given_model, keyed_texts, reader, with_defaults
from .result_commands import draw, end_with

if TYPE_CHECKING:
    from ...cases import Case, LoadCase
    from ..sweep.sweep_plan import SweepPlan

OF_THE_CASE = "case"  # instead of a file: the load cases of the case itself
SINGLE_CONDITIONS = ("temperature", "roughness")


def run_load_cases(case: Case, load_cases: str, output: Path, plots: Path | None, options: dict[str, Any]) -> None:
    """Analyse a case over a table of load cases, or ``case`` for its own, write the result, and show its table."""
    from ...cases import Deflections, read_load_cases
    from ...cases.analysis_size import AnalysisSize
    from ..load_case_analysis import analyze_load_cases
    from ..result import write_result
    from ..summary.load_case_summary import load_case_summary

    if options.pop("speed") is not None:
        raise click.UsageError("--speed: must not go with --load-cases, which have their own speeds")
    constant = None if isinstance(options["misalignment"], Deflections) else options["misalignment"]
    for name, value in (("--torque", options.pop("torques")), ("--misalignment", constant)):
        if value is not None:
            raise click.UsageError(f"{name}: must not go with --load-cases, which have their own")
    rows = None
    if load_cases != OF_THE_CASE:
        rows = read_load_cases(load_cases)
    elif not case.load_cases:
        raise click.UsageError("--load-cases = 'case': the case has no tables [[load_cases]]; give a file")
    _refuse_flank(rows or case.load_cases)
    check_cost(case, AnalysisSize.of(case, 1))
    for name in SINGLE_CONDITIONS:
        values = options[name]
        if values is not None and len(values) != 1:
            raise click.UsageError(f"--{name}: must be one value with --load-cases")
        options[name] = None if values is None else values[0]
    with progress_bar(case, len(rows or case.load_cases)) as shown:
        tree = analyze_load_cases(case, rows, **with_defaults(options), progress=shown.step, stage=shown.stage)
    write_result(tree, output)
    echo(load_case_summary(tree))
    echo(f"wrote {output}")
    end_with(tree, output, plots, certified=not tree["load_cases"].to_dataset()["status"].values.any())


def _refuse_flank(rows: Sequence[LoadCase]) -> None:
    """Refuse ``--flank`` beside load cases that name theirs."""
    given = click.get_current_context().get_parameter_source("flank") == ParameterSource.COMMANDLINE
    named = [at for at, row in enumerate(rows, start=1) if row.flank is not None]
    if given and named:
        raise click.UsageError(
            f"--flank: must not go with load cases that name their flank, as number {named[0]} does; change the table"
        )


@click.command(cls=Command)
@option.analysis
@option.output("netCDF file to write.")
@option.plots()
@option.marking()
@click.option(
    "--load-cases",
    metavar="FILE|case",
    help="Analyse over load cases instead of torques, each in its own misalignment: those of a table with the columns "
    "torque, E, P, G, Sigma, speed, share, flank and name, or those of the case itself.",
)
@option.friction
def run(
    case: str, output: Path, plots: Path | None, load_cases: str | None, supports: str | None, **options: Any
) -> None:
    """Analyse the contact of CASE and write the result.

    The result holds unloaded and loaded contact, and friction and efficiency if a speed is given. With --load-cases it
    holds that of every load case, a table of the numbers of all, and means over their shares of time.
    """
    if load_cases is None:
        quick_start(alone=options["solver"] == "auto")
    from ..analysis.case_analysis import analyze
    from ..analysis.operating import Operating, analysis_size
    from ..result import write_result
    from ..summary.result_summary import outcome, result_notes, uncertified

    tables = None if load_cases == OF_THE_CASE else load_cases
    checked = opened_case(case, output, tables, options["oil"], *options["deviations"].values(), supports=supports)
    check_folders(output, plots)
    models = any(options[name] is not None for name in ("friction_model", "film_heating"))
    models |= bool(options["clamp_temperature"] or options["friction_feedback"])
    options["friction_model"] = given_model(checked, options)
    if load_cases is not None:
        run_load_cases(checked, load_cases, output, plots, options)
        return
    if checked.load_cases:
        echo(f"{case} has {len(checked.load_cases)} load cases: --load-cases case analyses them", err=True)
    if checked.friction is None and all(options[name] is None for name in ("speed", "oil", *SINGLE_CONDITIONS)):
        if models:
            raise click.UsageError(
                "--friction-model, --film-heating, --clamp-temperature and --friction-feedback must go with --speed or "
                "a table [friction]"
            )
        options["friction_model"] = None
    options = with_defaults(options)
    operating = Operating.of(**options)
    load = operating.load(checked)
    check_cost(checked, analysis_size(checked, load.size, operating.friction.of_case(checked)))
    with progress_bar(checked, load.size) as shown:
        tree = analyze(checked, **options, progress=shown.step, stage=shown.stage)
    write_result(tree, output)
    echo(f"wrote {output}: {outcome(tree)}")
    end_with(tree, output, plots, result_notes(tree), certified=not uncertified(tree))


OVER = re.compile(r"([A-Za-z][\w.]*)\s*(=|~)\s*(.+)")
KEEP = re.compile(r"(worst|least)\s*=\s*(\w+)\s*:\s*(\d+)")


@reader
def _swept(texts: tuple[str, ...]) -> dict[str, str]:
    """Values or distributions by the name of the coordinate."""
    found = keyed_texts(texts, OVER, "NAME=FROM:TO:COUNT, NAME=V1,V2,... or NAME~normal(0,0.03)")
    for parts in found.values():
        if (parts[2] == "~") != ("(" in parts[3]):
            raise click.BadParameter(f"{parts.string!r}: '=' goes before values, '~' before a distribution")
    return {name: parts[3] for name, parts in found.items()}


@reader
def _kept(texts: tuple[str, ...]) -> list[tuple[str, str, int]]:
    """Points to keep whole: worst or least, the name of the number, and their count."""
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
@option.analysis
@click.option(
    "--over",
    multiple=True,
    callback=_swept,
    metavar="NAME=VALUES",
    help="What is swept: FROM:TO:COUNT, a list V1,V2,... or a distribution as in 'E~normal(0,0.03)'. NAME is torque, "
    "E, P, G, Sigma, speed, temperature, roughness, oil, flank, deviation.MEMBER, modification.TERM or the dotted key "
    "of a number of the case file. May be given several times: every combination is analysed.",
)
@option.file("--load-cases", text="CSV file of load cases, a row a point: torque, E, P, G, Sigma, speed, ..., share.")
@click.option("--samples", type=int, metavar="N", help="Number of samples of what is distributed.")
@click.option("--seed", metavar="S", default=0, help="Seed of the samples.")
@option.choice("--sampler", ("sobol", "latin_hypercube"), "How samples are drawn.")
@option.output("netCDF file to write.")
@option.plots()
@click.option(
    "--keep",
    multiple=True,
    callback=_kept,
    metavar="worst=NUMBER:COUNT",
    help="Write whole results of the points with the greatest (least=: least) values of a number.",
)
@option.marking()
@option.friction
@click.option("--workers", type=int, metavar="N", show_default="one a core", help="Processes; 1: this one alone.")
@click.option("--scheduler", metavar="ADDRESS", help="Scheduler of a dask cluster, in place of processes here.")
@option.file(
    "--store",
    text="Folder that keeps the batches; an interrupted sweep resumes from it.",
    folder=True,
    show_default="FILE.batches, removed at the end",
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


def _write_kept(plan: SweepPlan, chosen: Any, keep: Sequence[tuple[str, str, int]], output: Path) -> list[Path]:
    """Whole results of chosen points, in a folder named after the file of the sweep."""
    from ...core.errors import EaseoffError
    from ..result import write_result
    from ..sweep import worst_points
    from ..sweep.batch_analysis import point_tree

    written: dict[int, Path] = {}
    for side, name, count in keep:
        if name not in chosen:
            echo(f"--keep: no point has a number {name}", err=True)
            continue
        for row in worst_points(chosen, name, count, least=side == "least")["row"].values.tolist():
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
