"""Command that searches for the best machine settings of a case."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import click

from ..terminal_bar import terminal_bar
from .analysis_options import show_stage
from .case_commands import resolution_option
from .command import Command
from .shared_options import (
    case_argument,
    check_output,
    echo,
    end_uncertified,
    force_option,
    further_misalignments_option,
    next_commands,
    number_list,
    opened_case,
    output_option,
    reader,
    torque_option,
)

SPREAD = re.compile(r"(E|P|G|Sigma)\s*~\s*(.+)")
RANGE = re.compile(r"(.+?)\s*=\s*([^=:]+):([^=:]+)")


@reader
def _spread(texts: tuple[str, ...]) -> dict[str, str]:
    """Distributions of assembly errors."""
    distributions: dict[str, str] = {}
    for text in texts:
        parts = SPREAD.fullmatch(text.strip())
        if parts is None:
            raise click.BadParameter(f"{text!r}: must be E, P, G or Sigma with a distribution, as E~normal(0,0.03)")
        if parts[1] in distributions:
            raise click.BadParameter(f"{parts[1]} comes twice")
        distributions[parts[1]] = parts[2]
    return distributions


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
@case_argument()
@output_option("netCDF file to write.")
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
@click.option(
    "--form",
    type=click.Choice(["worst", "weighted", "pareto"]),
    default="worst",
    help="The worst ratio to the start decides; the weighted sum of the mean ratios; or the front of two objectives.",
)
@click.option(
    "--weight",
    "weights",
    callback=reader(lambda text: number_list(text, "numbers separated by commas, such as 1,0.5")),
    metavar="W1,W2,...",
    help="Weights of the objectives.",
)
@click.option("--points", type=int, metavar="N", show_default="9", help="Points of the front.")
@click.option(
    "--flank", type=click.Choice(["drive", "coast", "both"]), default="drive", help="Flanks in mesh that are analysed."
)
@torque_option()
@further_misalignments_option(
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
@click.option("--seed", type=int, metavar="S", default=0, help="Seed of the samples.")
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
    type=float,
    metavar="UM",
    default=100.0,
    help="By how much one setting alone may change the ease-off in um, where it has no limits of its own.",
)
@resolution_option
@click.option("--steps", type=int, metavar="N", default=30, help="Programmes for one optimum.")
@click.option(
    "--case",
    "best_case",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Case file to write, with the settings found.",
)
@click.option("--resume", type=click.Path(path_type=Path), metavar="FILE", help="Result to go on from.")
@force_option
def optimize(case: str, output: Path, best_case: Path | None, resume: Path | None, force: bool, **options: Any) -> None:
    """Search for the machine settings that are best under load.

    Convex programmes propose, certified analyses judge. The settings found are rounded to the machine's resolution and
    analysed rounded.
    """
    from ...cases import parse_case, write_case
    from ..design.optimization.setting_optimization import USUAL_OBJECTIVES, optimize as optimized
    from ..result import read_result, write_result
    from ..summary.correction_report import setting_report
    from ..summary.result_summary import uncertified

    checked = opened_case(case, output)
    check_output(best_case, case, suffix=".toml", force=force)
    earlier = None if resume is None else read_result(resume)
    bar: Any
    with terminal_bar(desc="search", unit="programme") as bar:
        tree = optimized(
            checked,
            options.pop("minimize") or USUAL_OBJECTIVES,
            resume=earlier,
            progress=bar.update,
            stage=lambda name: show_stage(bar, name),
            **options,
        )
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
