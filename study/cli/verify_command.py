"""Command that puts the pair of a case through the independent methods."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..terminal_bar import terminal_bar
from .analysis_options import supports_option
from .command import EXIT_UNCERTIFIED, Command
from .shared_options import (
    case_argument,
    echo,
    flank_option,
    misalignment_option,
    opened_case,
    output_option,
    torque_option,
)

if TYPE_CHECKING:
    from ...verification.verification_row import VerificationRow


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
