"""The command that finds the best low-order modification of the ease-off."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from .exit_codes import EXIT_UNCERTIFIED
from .options import misalignment, torques


def _misalignments(ctx: click.Context, param: click.Parameter, texts: tuple[str, ...]) -> list[Any]:
    return [misalignment(ctx, param, text) for text in texts]


@click.command()
@click.argument("case")
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="netCDF file to write.")
@click.option(
    "--flank",
    type=click.Choice(["drive", "coast"]),
    default="drive",
    show_default=True,
    help="Which flanks mesh: drive is pinion concave with gear convex.",
)
@click.option(
    "--torque",
    "torques",
    callback=torques,
    metavar="T1,T2,...",
    help="Torques at the pinion in N m, all of which count; the case's own if left out.",
)
@click.option(
    "--misalignment",
    "misalignments",
    callback=_misalignments,
    multiple=True,
    metavar="E=..,P=..,G=..,Sigma=..",
    help="A further assembly that counts as much as the case's own, in mm (Sigma in degrees); may be repeated.",
)
@click.option(
    "--objective",
    type=click.Choice(["peak_load", "peak_pressure", "even_load"]),
    default="peak_load",
    show_default=True,
    help="What shall become small.",
)
@click.option("--order", type=click.IntRange(2, 4), default=3, show_default=True, help="Total order of the terms.")
@click.option(
    "--transmission-error", type=float, metavar="URAD", help="Limit of its peak to peak under load; none if left out."
)
@click.option(
    "--end-load",
    type=float,
    metavar="N/MM",
    help="Limit of the line load on the flank's edges, inf for none; what they carry before if left out.",
)
@click.option("--largest", type=float, default=50.0, show_default=True, metavar="UM", help="Limit of the modification.")
@click.option("--solver", default="auto", show_default=True, help="Contact solver.")
@click.option(
    "--fitted-case",
    type=click.Path(path_type=Path),
    help="Case file to write, with pinion settings fitted to the modified ease-off.",
)
def optimize(case: str, output: Path, fitted_case: Path | None, **options: Any) -> None:
    """Find the low-order modification of CASE's ease-off that is best under load."""
    from tqdm import tqdm

    from ...cases import read_case, write_case
    from ...core.files import check_writable
    from ..fitted_settings import fit_modification, recorded_modification
    from ..optimization import optimize as optimized
    from ..report.optimization_report import optimization_text
    from ..report.result_summary import uncertified
    from ..result import write_result

    check_writable(output, case, suffix=".nc")
    if fitted_case is not None:
        check_writable(fitted_case, case)
    checked = read_case(case)
    with tqdm(desc="convex programmes", disable=None, leave=False) as bar:
        tree = optimized(checked, progress=lambda: _step(bar), **options)
    write_result(tree, output)
    click.echo(optimization_text(tree))
    click.echo(f"\nwrote {output}")
    if fitted_case is not None:
        fitted, fit = fit_modification(checked, recorded_modification(tree), flank=options["flank"])
        write_case(
            fitted, fitted_case, f"Made by easeoff from {Path(case).name} and the modification in {output.name}."
        )
        click.echo(f"wrote {fitted_case}: settings leave {1e3 * fit.rms:.2f} um (rms) of the modified ease-off")
    failures = uncertified(tree)
    if failures:
        click.echo("\n".join(failures), err=True)
        sys.exit(EXIT_UNCERTIFIED)


def _step(bar: Any) -> None:
    bar.update(1)
