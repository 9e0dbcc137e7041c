"""Text and BibTeX of ``easeoff cite``."""

from __future__ import annotations

import xarray as xr

from ....core.errors import shortened
from .published_work import WORKS, package
from .result_sources import distinct_works, result_sources


def citation(tree: xr.DataTree | None = None, *, bibtex: bool = False) -> str:
    """How to cite the package, and with a result the sources that this rests on.

    Parameters
    ----------
    tree
        Content of a file of any command.
    bibtex
        Whether entries of BibTeX are wanted in place of lines of text.

    Examples
    --------
    >>> print(citation().splitlines()[0])
    If you publish results, please cite the program
    """
    sources = [] if tree is None else result_sources(tree)
    method = WORKS["kolivand_2009"]
    if bibtex:
        works = {work.key: work for work in (package(), method, *distinct_works(sources))}
        return "\n".join(work.bibtex() for work in works.values()).rstrip("\n")
    lines = [
        "If you publish results, please cite the program",
        f"  {package().text()}",
        "and the dissertation whose method it follows",
        f"  {method.text()}",
    ]
    if tree is None:
        return "\n".join([*lines, "'easeoff cite RESULT' names the sources that a result rests on."])
    made = tree.attrs.get("easeoff_version", "")
    lines += [f"This result was made by version {shortened(str(made))}."] if isinstance(made, str) and made else []
    listed = distinct_works(sources)
    numbers = {work.key: number for number, work in enumerate(listed, start=1)}
    lines += ["", "The result rests on"]
    for source in sources:
        marks = "".join(f"[{numbers[work.key]}]" for work in source.works)
        said = " ".join(part for part in (marks, source.remark) if part) or "no published source"
        lines.append(f"  {source.role}{f' ({source.model})' if source.model else ''}: {said}")
    if "friction" not in tree.children and "efficiency" in tree.dataset:
        lines.append("  friction: this file does not tell its models; they are those of the command or of the case")
    return "\n".join([*lines, "", *(f"[{number}] {work.text()}" for number, work in enumerate(listed, start=1))])
