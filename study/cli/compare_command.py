"""The command that compares solvers on contact problems."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .options import problem_files, solvers


@click.command()
@click.argument("problems", type=click.Path(path_type=Path), nargs=-1, required=True, callback=problem_files)
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), default="comparison", show_default=True, help="Folder."
)
@click.option(
    "--solvers",
    callback=solvers,
    metavar="A,B,...",
    help="Solvers, or MODULE:FUNCTION for one of your own; all that are installed if left out.",
)
@click.option("--repetitions", type=int, default=3, show_default=True, help="Attempts of each kind.")
@click.option("--time-limit", type=float, default=10.0, show_default=True, help="Of one attempt, in seconds.")
@click.option("--tolerance", type=float, default=1e-5, show_default=True, help="Of the certificate, for all solvers.")
@click.option("--raw", is_flag=True, help="Run backends without polish, and without our scaling and settings, as well.")
@click.option("--fresh", is_flag=True, help="Forget earlier measurements in the folder.")
@click.option("--test-set", is_flag=True, help="Write the problems as a test set of qpbenchmark as well.")
def compare(problems: tuple[Path, ...], output: Path, test_set: bool, **options: Any) -> None:
    """Compare solvers on the contact problems of one or more files written by 'easeoff problems'.

    A solver that fails, hangs or crashes is a line in the report: the exit code is 0. A comparison that was
    interrupted goes on where it stopped.
    """
    from tqdm import tqdm

    from ..compare import compare as run_comparison
    from ..compare import write_comparison

    with tqdm(desc="comparison", unit="measurement", disable=None, leave=False) as bar:

        def progress(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        table = run_comparison(problems, output, progress=progress, **options)
    for path in write_comparison(table, output):
        click.echo(f"wrote {path}")
    if test_set:
        from ...contact.problem.problem_file import read_problems
        from ..compare.test_set import write_test_set

        for path in write_test_set([item for file in problems for item in read_problems(file)], output / "test_set"):
            click.echo(f"wrote {path}")
