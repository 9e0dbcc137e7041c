"""Commands of studies of one pair: wear or lapping, V-H check, verification, modification."""

from __future__ import annotations

import re
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..progress import count, terminal_bar, working
from . import option
from .case_run import check_folders, check_output, opened_case, show_stage
from .command import EXIT_UNCERTIFIED, Command, echo, end_uncertified, next_commands, quick_start
from .option_values import by_member, keyed_texts, number_list, reader, two_counts, with_defaults
from .result_commands import draw

if TYPE_CHECKING:
    from ...verification.verified_pair import VerificationRow

OF_THE_LAW = ("revolutions", "largest_step", "largest_depth", "most_steps")  # options that a ``WearLaw`` takes


@reader
def duty_cycle(text: str) -> dict[float, float]:
    """Shares of the revolutions by torque [N m], from a torque alone or TORQUE=SHARE separated by commas."""
    wanted = "a torque in N m, or TORQUE=SHARE,..., such as 100=0.7,300=0.3; a decimal has a point"
    shares: dict[float, float] = {}
    parts = text.split(",")
    for part in parts:
        torque, equals, share = part.partition("=")
        if len(parts) > 1 and not equals:
            raise click.BadParameter(f"{text!r}: {part.strip()!r} has no share: must be {wanted}")
        try:
            key, value = float(torque), float(share) if equals else 1.0
        except ValueError as error:
            raise click.BadParameter(f"{part!r}: must be {wanted}") from error
        if key in shares:
            raise click.BadParameter(f"{text!r}: {key:g} comes twice")
        shares[key] = value
    return shares


@reader
def coefficients(text: str) -> tuple[float, float]:
    """Wear coefficients of pinion and gear [mm^2/N]."""
    entries = by_member(text, "a coefficient in mm^2/N", "1e-12/2e-12")
    if not any(entries):
        raise click.BadParameter(
            f"{text!r}: nothing wears; must be greater than zero in mm^2/N, or PINION/GEAR, one of which may be 0"
        )
    return entries[0], entries[-1]


@click.command(cls=Command)
@option.pair
@option.supports
@click.option(
    "--torque",
    callback=duty_cycle,
    required=True,
    metavar="T|T1=SHARE1,T2=SHARE2,...",
    help="Torque at the pinion in N m, or a duty cycle: torques with their shares of the revolutions.",
)
@option.number("--revolutions", "N", "Revolutions of the pinion after which to stop.", required=True)
@click.option(
    "--coefficient",
    callback=coefficients,
    default="1e-12",
    metavar="K|PINION/GEAR",
    help="Archard's wear coefficient in mm^2/N; greater by orders of magnitude for lapping.",
)
@option.value("--largest-step", "UM", "Wear depth in um after which the contact is computed anew.", default=0.5)
@option.number("--largest-depth", "UM", "Wear depth in um at which to stop.", "no limit")
@option.value(
    "--most-steps", "N", "The most steps to take; wear that needs more is refused before it begins.", default=1000
)
@option.output("netCDF file to write.")
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
        early = (
            f"the wear ended early, after {share:.3g} % of the revolutions; the file holds the steps that were solved"
        )
        end_uncertified([f"{early}. A smaller --largest-step may help"])


GRID_OF_PICTURES = (5, 5)


@click.command(cls=Command)
@option.unloaded
@option.output("netCDF file to write.")
@option.plots("Folder for the picture.")
@option.marking("Thickness of the marking compound in um.")
@click.option(
    "--share",
    default=0.25,
    help="Where the centre shall be at toe and heel: its distance from the end of the tooth over the face width.",
)
@click.option(
    "--height", default=0.5, help="Height of the centre on the gear flank, from 0 at the root to 1 at the tip."
)
@option.number("--largest", "MM", "Greatest size of V and of H in mm that is tried.", "a tenth of the face width")
@click.option(
    "--grid",
    callback=reader(lambda text: two_counts(text, "NUMBERxNUMBER of values of V and H, such as 5x5")),
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
@option.case()
@option.flank
@option.misalignment
@option.torque()
@option.supports
@click.option(
    "--without-split",
    is_flag=True,
    help="Solve the contact without the split into bending and indentation at some mesh positions, too; takes minutes.",
)
@option.output("netCDF file to write the table to.", required=False)
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

        def echo_row(row: VerificationRow) -> None:
            bar.clear()
            echo(row_lines(row))

        verification = run_verification(checked, flank=flank, progress=progress, on_row=echo_row, **options)
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
@option.case()
@option.output("netCDF file to write.")
@option.flank
@option.torque("Torques at the pinion in N m, all of equal weight.")
@option.further_misalignments(
    f"Further assembly in mm, Sigma in degrees, of the same weight as the case's own; {option.DEFLECTION_FILE}.",
    option.MISALIGNMENT,
)
@option.supports
@option.choice("--objective", ("peak_load", "peak_pressure", "even_load"), "Quantity to minimise.")
@click.option("--order", type=click.IntRange(2, 4), metavar="N", default=3, help="Greatest order of the terms.")
@option.number(
    "--transmission-error", "URAD", "Limit of the loaded transmission error, peak to peak, in urad.", "no limit"
)
@option.number(
    "--end-load",
    "N/MM",
    "Limit of the line load at the edges of the flank in N/mm; inf for no limit.",
    "that of the present ease-off",
)
@click.option("--largest", metavar="UM", default=50.0, help="Limit of the modification in um.")
@option.solver("Contact solver; MODULE:FUNCTION for your own.")
@option.file("--fitted-case", text="Case file to write, with pinion settings fitted to the modified ease-off.")
@option.force
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
    from ..summary.result_summary import uncertified
    from ..summary.settings_report import modification_report

    checked = opened_case(case, output, supports=supports)
    check_output(fitted_case, case, supports, suffix=".toml", force=force)
    with terminal_bar(desc="convex programmes", unit="programme") as bar:
        tree = modified(checked, progress=bar.update, stage=partial(show_stage, bar), **options)
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


SPREAD = re.compile(r"(E|P|G|Sigma)\s*~\s*(.+)")
RANGE = re.compile(r"(.+?)\s*=\s*([^=:]+):([^=:]+)")


@reader
def _spread(texts: tuple[str, ...]) -> dict[str, str]:
    """Distributions of assembly errors."""
    found = keyed_texts(texts, SPREAD, "E, P, G or Sigma with a distribution, as E~normal(0,0.03)")
    return {name: parts[2] for name, parts in found.items()}


@reader
def _ranges(texts: tuple[str, ...]) -> dict[str, tuple[float, float]]:
    """Least and greatest value of settings by key."""
    ranges: dict[str, tuple[float, float]] = {}
    for text in texts:
        parts = RANGE.fullmatch(text.strip())
        try:
            if parts is None:
                raise ValueError
            ranges[parts[1]] = float(parts[2]), float(parts[3])
        except ValueError as error:
            raise click.BadParameter(f"{text!r}: must be KEY=LOW:HIGH, as '*.sliding_base=20:25'") from error
    return ranges


@click.command(cls=Command)
@option.case()
@option.output("netCDF file to write.")
@click.option(
    "--minimize",
    multiple=True,
    metavar="QUANTITY",
    show_default="peak_to_peak and max_pressure",
    help="peak_to_peak, harmonic_1, harmonic_2, ..., max_pressure, unloaded_peak_to_peak, pinion_root_stress, "
    "gear_root_stress, mean_power_loss, load_centre_lengthwise, load_extent_lengthwise (and profile), ease_off_change, "
    "root_line_change; "
    "with @TORQUE at one torque alone, with drive. or coast. before it on one side. May be repeated.",
)
@click.option(
    "--limit",
    "limits",
    multiple=True,
    metavar="'QUANTITY<=VALUE'",
    help="Limit of a quantity in urad, MPa, W, um or mm, such as 'max_pressure@250<=1500'. May be repeated; the "
    "root line is kept within 1 % of the flank's height unless limited.",
)
@option.choice(
    "--form",
    ("worst", "weighted", "pareto"),
    "The worst ratio to the start decides; the weighted sum of the mean ratios; or the front of two objectives.",
)
@click.option(
    "--weight",
    "weights",
    callback=reader(lambda text: number_list(text, "numbers separated by commas, such as 1,0.5")),
    metavar="W1,W2,...",
    help="Weights of the objectives.",
)
@click.option("--points", type=int, metavar="N", show_default="9", help="Points of the front.")
@option.choice("--flank", ("drive", "coast", "both"), "Flanks in mesh that are analysed.")
@option.torque()
@option.further_misalignments(
    "Further assembly in mm, Sigma in degrees, that counts as much as the case's own.", "E=..,P=..,G=..,Sigma=.."
)
@click.option(
    "--spread",
    callback=_spread,
    multiple=True,
    metavar="'E~normal(0,0.03)'",
    help="Distribution of an assembly error in mm, Sigma in degrees: normal, uniform or triangular. May be repeated.",
)
@click.option("--samples", type=int, metavar="N", help="Number of assemblies drawn from the distributions.")
@click.option("--seed", metavar="S", default=0, help="Seed of the samples.")
@click.option(
    "--free",
    callback=reader(lambda texts: texts or None),
    multiple=True,
    metavar="PATTERN",
    show_default="machine settings that the pinion's set-up uses",
    help="Keys of the settings that move, such as 'pinion.*.machine.*'. May be repeated.",
)
@click.option(
    "--limit-setting",
    "limit_settings",
    callback=_ranges,
    multiple=True,
    metavar="KEY=LOW:HIGH",
    help="Least and greatest value of a setting in mm or degrees. May be repeated.",
)
@click.option(
    "--move",
    metavar="UM",
    default=100.0,
    help="By how much one setting alone may change the ease-off in um, where it has no limits of its own.",
)
@option.resolution
@click.option("--steps", metavar="N", default=30, help="Programmes for one optimum.")
@option.file("--case", "best_case", text="Case file to write, with the settings found.")
@option.file("--resume", text="Result to go on from.")
@option.force
def optimize(case: str, output: Path, best_case: Path | None, resume: Path | None, force: bool, **options: Any) -> None:
    """Search for the machine settings that are best under load.

    Convex programmes propose, certified analyses judge. The settings found are rounded to the machine's resolution and
    analysed rounded.
    """
    from ...cases import parse_case, write_case
    from ..design.optimization.setting_optimization import USUAL_OBJECTIVES, optimize as optimized
    from ..result import read_result, write_result
    from ..summary.result_summary import uncertified
    from ..summary.settings_report import setting_report

    checked = opened_case(case, output)
    check_output(best_case, case, suffix=".toml", force=force)
    earlier = None if resume is None else read_result(resume)
    with terminal_bar(desc="search", unit="programme") as bar:
        shown = {"progress": bar.update, "stage": partial(show_stage, bar)}
        tree = optimized(checked, options.pop("minimize") or USUAL_OBJECTIVES, resume=earlier, **shown, **options)
    write_result(tree, output)
    echo(setting_report(tree))
    echo(f"\nwrote {output}")
    if best_case is not None:
        final_case = parse_case(tree.attrs["case"], allow_outside=True)
        write_case(final_case, best_case, f"Made by easeoff from {Path(case).name}: settings of {output.name}.")
        echo(f"wrote {best_case}")
    sheet = [] if best_case is None else [("sheet", best_case, "-o", "SHEET.html")]
    next_commands(("show", output), ("plot", output, "FOLDER"), *sheet)
    end_uncertified(uncertified(tree))
