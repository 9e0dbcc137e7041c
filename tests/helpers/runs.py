"""What many tests start from: commands, small cases, and results that are computed once and shared."""

from __future__ import annotations

import contextlib
import json
import os
import re
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import xarray as xr
from click.testing import CliRunner, Result
from tooth_models import with_teeth

from easeoff import analyze, read_case
from easeoff.cases import case_text
from easeoff.cases.schema.case_schema import Case
from easeoff.study.cli import main

Computed = TypeVar("Computed", xr.DataTree, xr.Dataset)

#: Keys of [contact] by which an analysis takes a hundredth of a second on shells.
SMALL = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}

#: The end of a case file whose teeth are shells.
SHELLS = '\n[compliance]\nmodel = "shell"\n'


def call(*arguments: object) -> Result:
    """Run a command of ``easeoff`` in this process."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def output_of(*arguments: object) -> str:
    """What a command says that does its work."""
    found = call(*arguments)
    assert found.exit_code == 0, (found.output, found.exception)
    return found.output


def refusal_of(*arguments: object) -> str:
    """What a command says that refuses its words or files."""
    found = call(*arguments)
    assert found.exit_code == 2, (found.output, found.exception)
    return found.output


def text_file(path: Path, text: str) -> Path:
    """A file with a text."""
    path.write_text(text, encoding="utf-8")
    return path


def replaced(text: str, pattern: str, replacement: str) -> str:
    """A text in which a pattern, which is there, is replaced once."""
    text, count = re.subn(pattern, replacement, text, count=1, flags=re.MULTILINE)
    assert count == 1
    return text


def in_copies(count: int, work: Callable[[int], object]) -> None:
    """Call a function with a number each in copies of this process, all at once; none may fail."""
    children = []
    for number in range(count):
        children.append(os.fork())
        if children[-1] == 0:
            code = 1
            with contextlib.suppress(BaseException):
                work(number)
                code = 0
            os._exit(code)
    assert [os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children] == [0] * count


def small(name: str = "nasa-12x36", compliance: str | None = None, **contact: Any) -> Case:
    """A shipped case with few mesh positions, segments and nodes; other keys of [contact] by name.

    Its teeth are of a model in ``compliance``, coarse ones; of the case if there is none given.
    """
    case = read_case(name)
    case = case.model_copy(update={"contact": case.contact.model_copy(update=SMALL | contact)})
    return case if compliance is None else with_teeth(case, compliance)


def small_text(name: str = "nasa-12x36", more: str = "") -> str:
    """The text of a shipped case with few mesh positions, segments and nodes, and further lines at its end."""
    keys = "\n".join(f"{key} = {value}" for key, value in SMALL.items())
    return case_text(name).replace("[contact]", f"[contact]\n{keys}") + more


def small_file(folder: Path, name: str = "nasa-12x36", more: str = "") -> Path:
    """The file of such a case."""
    return text_file(folder / f"{name}.toml", small_text(name, more))


def analysed(name: str = "nasa-12x36", contact: dict[str, Any] | None = None, **keywords: Any) -> xr.DataTree:
    """The analysis of a small case with keywords of ``analyze``: computed once, a copy each of read-only arrays."""
    return _analysed(name, json.dumps(contact or {}), json.dumps(keywords, sort_keys=True)).copy(deep=False)


@cache
def _analysed(name: str, contact: str, keywords: str) -> xr.DataTree:
    return read_only(analyze(small(name, **json.loads(contact)), **json.loads(keywords)))


def read_only(result: Computed) -> Computed:
    """The same tree or dataset, whose numbers cannot be changed."""
    groups: Iterable[xr.DataTree | xr.Dataset] = getattr(result, "subtree", [result])
    for group in groups:
        for variable in group.variables.values():
            variable.values.flags.writeable = False
    return result
