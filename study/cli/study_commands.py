"""Commands of studies of one pair: wear or lapping, V-H check, verification, modification."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..terminal_bar import count, terminal_bar, working
from .analysis_options import pair_options, show_stage, supports_option, unloaded_options, with_defaults
from .command import EXIT_UNCERTIFIED, Command, quick_start
from .result_commands import draw
from .shared_options import (
    DEFLECTION_FILE,
    MISALIGNMENT,
    case_argument,
    check_folders,
    check_output,
    coefficients,
    duty_cycle,
    echo,
    end_uncertified,
    flank_option,
    force_option,
    further_misalignments_option,
    marking_option,
    misalignment_option,
    next_commands,
    opened_case,
    output_option,
    plots_option,
    reader,
    solver_option,
    torque_option,
    two_counts,
)

if TYPE_CHECKING:
    from ...verification.verified_pair import VerificationRow

OF_THE_LAW = ("revolutions", "largest_step", "largest_depth", "most_steps")  # options that a ``WearLaw`` takes


@click.command(cls=Command)
@pair_options
@supports_option
@click.option(
    "--torque",
    callback=duty_cycle,
    required=True,
    metavar="T|T1=SHARE1,T2=SHARE2,...",
    help="Torque at the pinion in N m, or a duty cycle: torques with their shares of the revolutions.",
)
@click.option(
    "--revolutions", type=float, required=True, metavar="N", help="Revolutions of the pinion after which to stop."
)
@click.option(
    "--coefficient",
    callback=coefficients,
    default="1e-12",
    metavar="K|PINION/GEAR",
    help="Archard's wear coefficient in mm^2/N; greater by orders of magnitude for lapping.",
)
@click.option(
    "--largest-step",
    type=float,
    metavar="UM",
    default=0.5,
    help="Wear depth in um after which the contact is computed anew.",
)
@click.option(
    "--largest-depth", type=float, metavar="UM", show_default="no limit", help="Wear depth in um at which to stop."
)
@click.option(
    "--most-steps",
    type=int,
    metavar="N",
    default=1000,
    help="The most steps to take; wear that needs more is refused before it begins.",
)
@output_option("netCDF file to write.")
def wear(case: str, coefficient: tuple[float, float], output: Path, supports: str | None, **options: Any) -> None:
    """Wear the flanks of CASE step by step.

    The file holds depth and contact of every step; the contact is that on lines alone, without tooth edges. The worn
    flanks are deviations: '--deviation pinion=FILE --deviation gear=FILE' continues the wear, or analyses the worn pair
    in 'easeoff run'.
    """
    from ...core.netcdf_file import write_netcdf
    from ..summary.sweep_report import wear_summary
    from ..wear_simulation import WearLaw, wear as worn

    checked = opened_case(case, output, *options["deviations"].values(), supports=supports)
    law = WearLaw(*coefficient, **{name: options.pop(name) for name in OF_THE_LAW})
    bar: Any
    with terminal_bar(total=law.revolutions, desc="wear", unit="revolution", unit_scale=True) as bar:
        history = worn(
            checked, law, progress=partial(count, bar), stage=partial(show_stage, bar), **with_defaults(options)
        )
    write_netcdf(history, output)
    echo(wear_summary(history))
    echo(f"wrote {output}")
    worn_flanks = [word for member in ("pinion", "gear") for word in ("--deviation", f"{member}={output}")]
    on_supports = [] if supports is None else ["--supports", supports]
    next_commands(("run", case, *on_supports, *worn_flanks, "-o", "RESULT.nc"))
    if not history.attrs["completed"]:
        share = 100 * float(history["revolutions"][-1]) / law.revolutions
        echo(
            f"the wear ended early, after {share:.3g} % of the revolutions; "
            "the file holds the steps that were solved. A smaller --largest-step may help",
            err=True,
        )
        sys.exit(EXIT_UNCERTIFIED)


GRID_OF_PICTURES = (5, 5)


@reader
def _counts(text: str) -> tuple[int, int]:
    """Numbers of values of V and H."""
    return two_counts(text, "NUMBERxNUMBER of values of V and H, such as 5x5")


@click.command(cls=Command)
@unloaded_options
@output_option("netCDF file to write.")
@plots_option("Folder for the picture.")
@marking_option("Thickness of the marking compound in um.")
@click.option(
    "--share",
    type=float,
    default=0.25,
    help="Where the centre shall be at toe and heel: its distance from the end of the tooth over the face width.",
)
@click.option(
    "--height",
    type=float,
    default=0.5,
    help="Height of the centre on the gear flank, from 0 at the root to 1 at the tip.",
)
@click.option(
    "--largest",
    type=float,
    metavar="MM",
    show_default="a tenth of the face width",
    help="Greatest size of V and of H in mm that is tried.",
)
@click.option(
    "--grid",
    callback=_counts,
    metavar="NVxNH",
    show_default="5x5 with --plots, else none",
    help="Numbers of values of V and H at which patterns are computed besides.",
)
def vh(case: str, output: Path, plots: Path | None, **options: Any) -> None:
    """Shift the pattern of CASE to toe, middle and heel.

    This is the V-H check of the shop, without load.

    V is a displacement along the offset, positive as E: the offset grows. H is one of the pinion along its axis,
    positive as P: away from the crossing point. Both are added to the misalignment. The centre is that of the marking
    print. The exit code is 1 if it cannot be brought to one of the three places.
    """
    quick_start()
    from ..summary.sweep_report import vh_table
    from ..vh import vh_check, write_vh_check

    checked = opened_case(case, output, *options["deviations"].values())
    check_folders(output, plots)
    if plots is not None:
        options["grid"] = options["grid"] or GRID_OF_PICTURES
    with terminal_bar(desc="V-H check", unit="pattern") as bar:
        check = vh_check(checked, progress=lambda: bar.update(1), **with_defaults(options))
    write_vh_check(check, output)
    echo(vh_table(check))
    echo(f"wrote {output}")
    if plots is not None:
        draw(check, plots)
    else:
        next_commands(("plot", output, "FOLDER"))
    if check["status"].values.any():
        sys.exit(EXIT_UNCERTIFIED)


@click.command(cls=Command)
@case_argument()
@flank_option
@misalignment_option
@torque_option()
@supports_option
@click.option(
    "--without-split",
    is_flag=True,
    help="Solve the contact without the split into bending and indentation at some mesh positions, too; takes minutes.",
)
@output_option("netCDF file to write the table to.", required=False)
def verify(case: str, flank: Any, supports: str | None, output: Path | None, **options: Any) -> None:
    """Check CASE by independent methods, row by row.

    A row of the table is a comparison: what was compared, the difference, and whether it is within the limit; below one
    that is not stands what that means. Rows are printed as they come. The exit code is 1 if a difference is outside
    its limit.
    """
    from ...core.netcdf_file import write_netcdf
    from ...verification.case_verification import closing, head_lines, row_lines, verify as run_verification

    checked = opened_case(case, output, supports=supports)
    echo(f"{checked.title}, {flank} flanks\n\n{head_lines()}")
    with terminal_bar(desc="verification", unit="step") as bar:

        def progress(done: int, total: int, name: str) -> None:
            bar.total = total
            bar.set_postfix_str(name)
            bar.update(done - bar.n)

        def told(row: VerificationRow) -> None:
            bar.clear()
            echo(row_lines(row))

        verification = run_verification(checked, flank=flank, progress=progress, on_row=told, **options)
    if verification.passed:
        echo("\nevery comparison that applies is within its limit")
    else:
        names = "; ".join(row.quantity for row in verification.outside)
        echo(
            f"\n{len(verification.outside)} of {len(verification.rows)} comparisons outside their limits: {names}",
            err=True,
        )
        if said := closing(verification.outside):
            echo(said, err=True)
    if output is not None:
        write_netcdf(verification.dataset(), output)
        echo(f"wrote {output}: the table, for xarray.open_dataset")
    if not verification.passed:
        sys.exit(EXIT_UNCERTIFIED)


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
