"""Reading case and design files and telling the user, in one message, what is wrong with them."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from ..core.errors import EaseoffError, InputError
from ..geometry.cutting.named_settings import scale_of
from .conversion import designed_blanks
from .mistakes import count, mistakes
from .schema.case_schema import Case
from .schema.design_schema import Design

Model = TypeVar("Model", bound=BaseModel)


def shipped_cases() -> dict[str, str]:
    """Names and titles of the cases that come with the package."""
    return {name: read_case(name).title for name in _names(_folder("case"))}


def shipped_designs() -> dict[str, str]:
    """Names and titles of the designs that come with the package."""
    return {name: read_design(name).title for name in _names(_folder("design"))}


def _folder(kind: str) -> Traversable:
    root = resources.files(__package__)
    return root if kind == "case" else root.joinpath("designs")


def _names(folder: Traversable) -> list[str]:
    return sorted(f.name[:-5] for f in folder.iterdir() if f.name.endswith(".toml"))


def case_text(name_or_path: str | Path) -> str:
    """Text of a shipped case (by name) or of a case file (by path).

    Raises
    ------
    InputError
        If there is neither a shipped case nor a readable file of that name.
    """
    return _text("case", name_or_path)


def _text(kind: str, name_or_path: str | Path) -> str:
    return _found(kind, name_or_path)[0]


def _found(kind: str, name_or_path: str | Path) -> tuple[str, Path | None]:
    """The text, and the folder of the file; none of a shipped one."""
    name, folder = str(name_or_path), _folder(kind)
    if name in _names(folder):
        return folder.joinpath(f"{name}.toml").read_text(encoding="utf-8"), None
    path = Path(name_or_path)
    if not os.path.isfile(path):  # unlike Path.is_file it takes a name of any length
        known = ", ".join(_names(folder))
        raise InputError(f"{kind} {name!r}: there is no such file, and the shipped {kind}s are: {known}")
    try:
        return path.read_text(encoding="utf-8"), path.absolute().parent
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{kind} {name!r} cannot be read: a {kind} is a text file, in TOML ({error})") from error


def read_case(name_or_path: str | Path) -> Case:
    """Read and check a case.

    Parameters
    ----------
    name_or_path
        Name of a shipped case, or path of a case file in TOML.

    Raises
    ------
    InputError
        Naming every wrong key, its value and what is allowed.

    Examples
    --------
    >>> read_case("nasa-12x36").pinion.number_of_teeth
    12
    """
    text, folder = _found("case", name_or_path)
    return parse_case(text, str(name_or_path), folder)


def parse_case(text: str, origin: str = "case", folder: Path | None = None) -> Case:
    """Check the text of a case. Raises as ``read_case``.

    Parameters
    ----------
    text
        In TOML.
    origin
        What messages call it.
    folder
        Where relative paths in it start; the working folder if left out.
    """
    case = _checked(Case, text, origin, folder)
    _check_blanks(case, origin)
    case._text = text
    return case


def read_design(name_or_path: str | Path) -> Design:
    """Read and check a design.

    Parameters
    ----------
    name_or_path
        Name of a shipped design, or path of a design file in TOML.

    Raises
    ------
    InputError
        Naming every wrong key, its value and what is allowed.

    Examples
    --------
    >>> read_design("fm-11x41").gear.number_of_teeth
    41
    """
    text, folder = _found("design", name_or_path)
    return parse_design(text, str(name_or_path), folder)


def parse_design(text: str, origin: str = "design", folder: Path | None = None) -> Design:
    """Check the text of a design. Raises as ``read_design``.

    Parameters
    ----------
    text
        In TOML.
    origin
        What messages call it.
    folder
        Where relative paths in it start; the working folder if left out.
    """
    design = _checked(Design, text, origin, folder)
    _check_blanks(design, origin)
    try:
        for name in design.pinion.free_settings or ():
            scale_of(name)
    except InputError as error:
        raise InputError(f"{origin} has a mistake:\n  pinion.free_settings: {error}") from error
    return design


def _checked(model: type[Model], text: str, origin: str, folder: Path | None) -> Model:
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{origin} is not a TOML file: {error}") from error
    if model is Case and "easeoff_design" in data and "easeoff_case" not in data:
        raise InputError(f"{origin} is a design: make a case of it with 'easeoff design {origin} -o CASE'")
    if model is Design and "easeoff_case" in data and "easeoff_design" not in data:
        raise InputError(f"{origin} is a case already: analyse it with 'easeoff run {origin} -o RESULT'")
    return _validated(model, data, origin, folder)


def _validated(model: type[Model], data: Mapping[str, Any], origin: str, folder: Path | None = None) -> Model:
    try:
        return model.model_validate(data, context={"folder": folder})
    except ValidationError as error:
        raise InputError(f"{origin} has {count(error)}:\n{mistakes(model, error)}") from error


def check_case(data: Mapping[str, Any], origin: str = "case") -> Case:
    """Check the tables of a case, wherever they come from; messages call it ``origin``. Raises as ``read_case``."""
    case = _validated(Case, data, origin)
    _check_blanks(case, origin)
    return case


def _check_blanks(case: Case | Design, origin: str) -> None:
    """Whether basic data make blanks; a quick computation that no table can stand for."""
    if case.blank_design is None:
        return
    try:
        designed_blanks(case.blank_design, (case.pinion.number_of_teeth, case.gear.number_of_teeth), case.pair)
    except EaseoffError as error:
        raise type(error)(f"{origin}: {error}") from error
