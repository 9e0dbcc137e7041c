"""Make numbers and pictures of the worked designs: python docs/make designs FOLDER [PAGE] (a quarter of an hour).

It runs the commands that stand in each page, in FOLDER, and leaves out those whose output is there.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from click.testing import CliRunner
from design_picture import draw
from dissertation_figures import save_small
from folders import DESIGNS, IMAGES
from generated_part import with_generated

import easeoff
from easeoff.study.analysis.key_numbers import key_numbers
from easeoff.study.cli import main as easeoff_command
from easeoff.verification import RowStatus
from easeoff.verification.case_verification import difference_text

PICTURES = IMAGES / "designs"
#: Pages with the stem of their files' names; the results follow as ``STEM-NAME.nc``.
PAGES = {"milled_axle": "axle", "hobbed_axle": "hobbed", "aerospace_pair": "aero"}
RESULTS = {"drive": "drive", "coast": "coast", "best-drive": "drive, optimised", "best-coast": "coast, optimised"}
NOMINAL = 200.0  # [N m]
BLOCKS = re.compile(r"^```(\w*)\n(.*?)^```$", flags=re.MULTILINE | re.DOTALL)


def commands(page: str) -> Iterator[list[str]]:
    """Arguments of the commands of a page, in its order."""
    for language, block in BLOCKS.findall(page):
        for line in block.replace("\\\n", " ").splitlines() if language in ("", "sh") else ():
            words = shlex.split(line, comments=True)
            if words[:1] == ["easeoff"]:
                yield words[1:]


def run(page: str, folder: Path) -> None:
    """Run the commands of a page in a folder, unless their output is there; a verification may have rows outside."""
    os.chdir(folder)
    for words in commands(page):
        output = words[words.index("-o") + 1]
        if Path(output).exists():
            continue
        print(shlex.join(words), flush=True)
        outcome = CliRunner().invoke(easeoff_command, words)
        if outcome.exit_code != 0 and words[0] != "verify":
            sys.exit(f"{outcome.output}\n{shlex.join(words)}: exit code {outcome.exit_code}")


def results(folder: Path, stem: str) -> dict[str, xr.DataTree]:
    """Results in a folder by what they are of."""
    files = {label: folder / f"{stem}-{name}.nc" for name, label in RESULTS.items()}
    return {label: easeoff.read_result(path) for label, path in files.items() if path.exists()}


def numbers_table(found: Mapping[str, xr.DataTree]) -> str:
    """Key numbers, a column a result; of all torques, in their order."""
    known = [key_numbers(tree).isel(order=0) for tree in found.values()]

    def each(name: str, digits: int, factor: float = 1.0) -> list[str]:
        values = [factor * np.reshape(numbers[name].values, -1) for numbers in known]
        return [" / ".join(f"{value:.{digits}f}" for value in one) for one in values]

    torques = " / ".join(f"{value:g}" for value in known[0]["torque"].values)
    lines: dict[str, list[str]] = {
        "without load, peak to peak [µrad]": each("unloaded_peak_to_peak", 0),
        "peak to peak [µrad]": each("peak_to_peak", 0),
        "first harmonic [µrad]": each("harmonic", 0),
        "greatest pressure [MPa]": each("max_pressure", 0),
        "load on edges, up to [%]": each("max_edge_share", 1, 100.0),
        "pattern, centre from toe [%]": each("pattern_centre_lengthwise", 0, 100.0),
        "pattern, length [%]": each("pattern_length", 0, 100.0),
        "contact ratio": each("contact_ratio", 1),
        "efficiency [%]": each("efficiency", 2, 100.0),
        "certified mesh positions": each("certified_positions", 0),
    }
    head = f"| at {torques} N m | {' | '.join(found)} |"
    rule = "| --- |" + " --- |" * len(found)
    return "\n".join([head, rule, *(f"| {label} | {' | '.join(cells)} |" for label, cells in lines.items())])


def sheet_block(folder: Path, stem: str) -> str:
    """Cutters and machine settings of the summary sheet."""
    sheet = (folder / f"{stem}.txt").read_text(encoding="utf-8")
    settings = sheet[sheet.index("Cutters") :].split("\n\ndrive:")[0]
    return f"```text\n{settings.strip()}\n```"


def verification_table(folder: Path, stem: str) -> str:
    """How many rows of the verification are within their limits, and the rows nearest to them or beyond."""
    table = xr.open_dataset(folder / f"{stem}-verify.nc", engine="netcdf4").load()
    rows = table.isel(comparison=np.flatnonzero(table["comparison_status"].values != RowStatus.NOT_APPLICABLE))
    outside = rows["comparison_status"].values == RowStatus.OUTSIDE
    chosen = [*np.flatnonzero(outside), *(n for n in _telling(rows) if not outside[n])]
    lines = [
        f"{int((~outside).sum())} of {outside.size} comparisons are within their limits.",
        "",
        "| comparison | difference | limit | |",
        "| --- | --- | --- | --- |",
    ]
    for number in chosen:
        row = rows.isel(comparison=number)
        unit = str(row["difference_unit"].values)
        unit = "" if unit == "1" else f" {unit}"
        limit = float(row["limit"])
        found = difference_text(float(row["difference"]), limit)
        lines.append(
            f"| {row['quantity'].values} | {found}{unit} | {limit:.2g}{unit} | "
            f"{'outside' if outside[number] else 'within'} |"
        )
    return "\n".join(lines)


TELLING = (
    "flank position, pinion",
    "flank position, gear",
    "transmission error of a tooth pair",
    "unloaded transmission error",
    "fineness of the teeth: transmission error",
    "fineness of the teeth: greatest pressure",
)


def _telling(rows: xr.Dataset) -> Iterator[int]:
    names = [str(name) for name in rows["quantity"].values]
    return (names.index(name) for name in TELLING if name in names)


def updated(page: str, blocks: Mapping[str, str]) -> str:
    """A page with its generated blocks made anew."""
    for name, made in blocks.items():
        page = with_generated(page, name, made)
    return page


def make(folder: Path, name: str) -> None:
    """Make the generated parts and the picture of one page."""
    path, stem = DESIGNS / f"{name}.md", PAGES[name]
    page = path.read_text(encoding="utf-8")
    run(page, folder)
    found = results(folder, stem)
    PICTURES.mkdir(exist_ok=True)
    save_small(draw(found, NOMINAL), PICTURES / f"{name}.png")
    blocks = {
        "sheet": sheet_block(folder, stem),
        "numbers": numbers_table(found),
        "verification": verification_table(folder, stem),
    }
    path.write_text(updated(page, blocks), encoding="utf-8")


def main() -> None:
    """Make the pages, or one."""
    if len(sys.argv) < 2:
        sys.exit("python docs/make designs FOLDER [PAGE]: FOLDER keeps what the commands of the pages write")
    folder = Path(sys.argv[1]).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or PAGES:
        make(folder, name)


if __name__ == "__main__":
    main()
