"""Command that modifies the ease-off of a case."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ..terminal_bar import terminal_bar, working
from .analysis_options import show_stage, supports_option
from .command import Command
from .shared_options import (
    DEFLECTION_FILE,
    MISALIGNMENT,
    case_argument,
    check_output,
    echo,
    end_uncertified,
    flank_option,
    force_option,
    further_misalignments_option,
    next_commands,
    opened_case,
    output_option,
    solver_option,
    torque_option,
)


@click.command(cls=Command)
@case_argument()
@output_option("netCDF file to write.")
@flank_option
@torque_option("Torques at the pinion in N m, all of equal weight.")
@further_misalignments_option(
    f"Further assembly in mm, Sigma in degrees, of the same weight as the case's own; {DEFLECTION_FILE}.", MISALIGNMENT
)
@supports_option
@click.option(
    "--objective",
    type=click.Choice(["peak_load", "peak_pressure", "even_load"]),
    default="peak_load",
    help="Quantity to minimise.",
)
@click.option("--order", type=click.IntRange(2, 4), metavar="N", default=3, help="Greatest order of the terms.")
@click.option(
    "--transmission-error",
    type=float,
    metavar="URAD",
    show_default="no limit",
    help="Limit of the loaded transmission error, peak to peak, in urad.",
)
@click.option(
    "--end-load",
    type=float,
    metavar="N/MM",
    show_default="that of the present ease-off",
    help="Limit of the line load at the edges of the flank in N/mm; inf for no limit.",
)
@click.option("--largest", type=float, metavar="UM", default=50.0, help="Limit of the modification in um.")
@solver_option("Contact solver; MODULE:FUNCTION for your own.")
@click.option(
    "--fitted-case",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Case file to write, with pinion settings fitted to the modified ease-off.",
)
@force_option
def modify(
    case: str, output: Path, fitted_case: Path | None, force: bool, supports: str | None, **options: Any
) -> None:
    """Search for the ease-off of CASE that is best under load.

    Loads or pressures become small or even. The result is a modification of low order: the addition to the ease-off.
    The contact is that on lines alone, without tooth edges.
    """
    from ...cases import write_case
    from ..design.case_design import fit_modification, recorded_modification
    from ..design.optimal_modification import modify as modified
    from ..result import write_result
    from ..summary.correction_report import modification_report
    from ..summary.result_summary import uncertified

    checked = opened_case(case, output, supports=supports)
    check_output(fitted_case, case, supports, suffix=".toml", force=force)
    bar: Any
    with terminal_bar(desc="convex programmes", unit="programme") as bar:
        tree = modified(checked, progress=bar.update, stage=lambda name: show_stage(bar, name), **options)
    write_result(tree, output)
    echo(modification_report(tree))
    echo(f"\nwrote {output}")
    if fitted_case is not None:
        with working("fitting the pinion's settings"):
            fitted, fit = fit_modification(checked, recorded_modification(tree), flank=options["flank"])
        write_case(
            fitted, fitted_case, f"Made by easeoff from {Path(case).name} and the modification in {output.name}."
        )
        echo(f"wrote {fitted_case}: settings leave {1e3 * fit.rms:.2f} um (rms) of the modified ease-off")
    fitted_run = [] if fitted_case is None else [("run", fitted_case, "-o", "RESULT.nc")]
    next_commands(("show", output), ("plot", output, "FOLDER"), *fitted_run)
    end_uncertified(uncertified(tree))
