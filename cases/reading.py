"""Reading and checking case and design files, with one message that names every mistake.

A case with supports from elsewhere.
"""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from pydantic import ValidationError

from ..core.checks import file_path, instance, truth
from ..core.errors import InputError, errors_about, printable, suggestion
from ..core.regular_file import TOML_SIZE_LIMIT, named, read_text, require_regular, status_of
from ..core.toml_text import toml_tables
from .mistakes import refusal
from .schema.blank_design_table import BlankDesignTable
from .schema.case_schema import Case, refuse_inches
from .schema.design_schema import Design
from .schema.supports_table import SupportFile, SupportsTable
from .shipped_files import CASES, DESIGNS, SUPPORTS, names

#: Key of the thickness that version 1 of a case had in the middle of the flank, and of that in version 2.
MEAN, MID_FLANK = "mean_normal_circular_thickness", "mid_flank_normal_circular_thickness"
NAME_LENGTH_LIMIT = 80  # of a case that results keep [characters]

Model = TypeVar("Model", Case, Design, SupportFile)


#: Files that are no cases, and what to do with them.
FOREIGN_SUFFIXES = {
    **dict.fromkeys((".rexs", ".xml"), "a REXS file: make a case of it with 'easeoff convert'"),
    ".ses": "a session script: make a case of it with 'easeoff convert'",
    ".nc": "a netCDF file, such as a result: 'easeoff show' shows one",
}


def _beside(path: Path) -> list[str]:
    """Paths of the TOML files in the folder of a path, as one would give them."""
    try:
        return [str(path.parent / entry) for entry in os.listdir(path.parent) if entry.endswith(".toml")]
    except (OSError, ValueError):
        return []


@dataclass(frozen=True)
class FileKind(Generic[Model]):
    """A kind of input file: its schema, the folder of the shipped files, and the reading of one."""

    name: str
    model: type[Model]
    folder: Path
    others: Mapping[str, str]  # advice by the name of the other kind; {0} stands for that of the file

    def names(self) -> list[str]:
        """Names of the shipped files."""
        return names(self.folder)

    def find(self, name_or_path: str | Path) -> tuple[str, Path | None]:
        """Text of a shipped file (by name) or of a user's file (by path), and the folder of the latter."""
        kind = self.name
        path: Path = file_path(kind, name_or_path, also=f"the name of a shipped {kind}, or ")
        name = os.fsdecode(name_or_path)
        if name in self.names():
            return self.folder.joinpath(f"{name}.toml").read_text(encoding="utf-8"), None
        status = status_of(path)
        if status is not None:
            require_regular(status, f"{kind} {name!r}")
        else:
            for other in KINDS:
                if name in other.names():
                    raise InputError(f"{name} is {self.others[other.name].format(name)}")
            whole = f"{name}.toml"  # people leave the suffix out, as of shipped names
            near = f"; did you mean {whole!r}?" if os.path.isfile(whole) else ""
            near = near or suggestion(name, [*self.names(), *_beside(path)])
            known = ", ".join(self.names())
            raise InputError(f"{kind} {name!r}: there is no such file, and the shipped {kind}s are: {known}{near}")
        if foreign := FOREIGN_SUFFIXES.get(path.suffix.lower()):
            raise InputError(f"{kind} {name!r} is {foreign}; a {kind} is a text file, in TOML")
        try:
            return read_text(path, TOML_SIZE_LIMIT), path.absolute().parent
        except InputError as error:
            raise InputError(f"{kind} {name!r} cannot be read: a {kind} is a text file, in TOML ({error})") from error

    def read(self, name_or_path: str | Path, *, allow_outside: bool = False) -> Model:
        """Read and check a file."""
        text, folder = self.find(name_or_path)
        origin = named(name_or_path)
        model, renamed = self._parsed(text, origin, folder, allow_outside=allow_outside)
        model._name = stem(name_or_path)
        for key in renamed:
            warnings.warn(
                f"{origin} is of version 1: {key} is read as the thickness in the middle of the flank, now "
                f"{MID_FLANK}; easeoff_case = 2 has ISO 23509's, on the pitch cone",
                UserWarning,
                stacklevel=3,
            )
        return model

    def parse(self, text: str, origin: str, folder: Path | None, *, allow_outside: bool = False) -> Model:
        """Check the text of a file called ``origin`` in messages, whose relative paths start in ``folder``.

        Unless ``allow_outside``, the files that it names must be in there.
        """
        return self._parsed(text, origin, folder, allow_outside=allow_outside)[0]

    def _parsed(self, text: str, origin: str, folder: Path | None, *, allow_outside: bool) -> tuple[Model, list[str]]:
        """The same, with the keys that were renamed since the version of the file."""
        instance("text", text, str)
        truth("allow_outside", allow_outside)
        if not text.strip():
            raise InputError(f"{origin} is empty")
        data = toml_tables(text, origin)
        kinds = [kind.name for kind in KINDS if f"easeoff_{kind.name}" in data]
        if kinds and self.name not in kinds:
            raise InputError(f"{origin} is {self.others[kinds[0]].format(origin)}")
        tables, renamed = _of_this_version(data)
        model = self.check(tables, origin, folder, allow_outside=allow_outside)
        model._text = text
        return model, renamed

    def check(
        self, data: Mapping[str, Any], origin: str, folder: Path | None = None, *, allow_outside: bool = False
    ) -> Model:
        """Check the tables of a file, also whether its basic data make blanks and its supports hold."""
        data, _ = _of_this_version(data)
        try:
            model = self.model.model_validate(data, context={"folder": folder, "allow_outside": allow_outside})
        except ValidationError as error:
            raise refusal(origin, self.model, error, _unsuited_basic_data(data, error)) from error
        with errors_about(f"{origin}:"):
            _require_possible(model)
        return model


def _unsuited_basic_data(data: Mapping[str, Any], error: ValidationError) -> list[str]:
    """What basic data lack, which pydantic does not come to while keys of the file have mistakes of their own.

    None where it could be by one of these mistakes.
    """
    wrong = {item["loc"][:2] for item in error.errors(include_input=False, include_url=False)}
    basic, pair = (data[name] if isinstance(data.get(name), Mapping) else {} for name in ("blank_design", "pair"))
    certain = {(), ("blank_design",), ("pair",), ("blank_design", "method"), ("blank_design", "process")}
    if not basic or not wrong.isdisjoint(certain):
        return []
    counted = wrong.isdisjoint([(name, *key) for name in ("pinion", "gear") for key in ((), ("number_of_teeth",))])
    teeth = [data[name]["number_of_teeth"] if counted else 36 for name in ("pinion", "gear")]
    unsure = {str(place[1]) for place in wrong if place[0] == "blank_design"}
    known = BlankDesignTable.model_fields
    sound = {key: value for key, value in basic.items() if key not in unsure and key in known}
    table = BlankDesignTable.model_validate({"cutter_radius": 1e3, **sound})
    table = table.model_copy(update=dict.fromkeys(unsure.intersection(basic, known), 1))
    offset = 1.0 if ("pair", "hypoid_offset") in wrong else pair.get("hypoid_offset", 0.0)
    shaft = 90.0 if ("pair", "shaft_angle") in wrong else pair.get("shaft_angle", 90.0)
    texts = table.mistakes((teeth[0], teeth[1]), shaft, offset)
    return [text for text in texts if not unsure.intersection(re.findall(r"\w+", text))]


def _of_this_version(data: Mapping[str, Any]) -> tuple[Mapping[str, Any], list[str]]:
    """Tables of a file, those of a case of version 1 in the names of version 2; and the keys that were renamed."""
    if data.get("easeoff_case") != 1:
        return data, []
    renamed, keys = {}, []
    for name in ("pinion", "gear"):
        table = data.get(name)
        if isinstance(table, Mapping) and MEAN in table and MID_FLANK not in table:
            renamed[name] = {MID_FLANK if key == MEAN else key: value for key, value in table.items()}
            keys.append(f"{name}.{MEAN}")
    return {**data, "easeoff_case": 2, **renamed}, keys


def stem(name_or_path: str | Path) -> str:
    """Printable name of a shipped file, or of a user's file without folder and suffix."""
    return printable(file_path("path", name_or_path).stem)[:NAME_LENGTH_LIMIT]


def _require_possible(file: Case | Design | SupportFile) -> None:
    """Refuse radii in inches, basic data that make no blanks, and supports that do not hold."""
    if isinstance(file, SupportFile):
        return  # to be checked with the case whose axes they hold
    if file.blank_design is not None:
        refuse_inches(file.blank_design, file.gear.number_of_teeth)
        from .conversion import designed_blanks

        designed_blanks(file.blank_design, (file.pinion.number_of_teeth, file.gear.number_of_teeth), file.pair)
    if isinstance(file, Case) and file.supports is not None:
        from .support_conversion import support_system

        support_system(file)


OF_SUPPORTS = "a file of supports: give it beside a case with --supports {0}"
OF_CASE = "a case already: analyse it with 'easeoff run {0} -o RESULT'"
OF_DESIGN = "a design: make a case of it with 'easeoff design {0} -o CASE'"
CASE = FileKind("case", Case, CASES, {"design": OF_DESIGN, "support": OF_SUPPORTS})
DESIGN = FileKind("design", Design, DESIGNS, {"case": OF_CASE, "support": OF_SUPPORTS})
SUPPORT = FileKind(
    "support",
    SupportFile,
    SUPPORTS,
    {
        "case": "a case: give a file of supports, or the tables in the case",
        "design": "a design: give a file of supports",
    },
)
KINDS: tuple[FileKind[Any], ...] = (CASE, DESIGN, SUPPORT)


def case_text(name_or_path: str | Path) -> str:
    """Text of a shipped case (by name) or of a case file (by path).

    Raises
    ------
    InputError
        If there is neither a shipped case nor a readable file of that name.

    Examples
    --------
    >>> case_text("nasa-12x36").splitlines()[0]
    '# Spiral bevel pair 12 x 36, face-milled, both members generated, no tilt, constant roll.'
    """
    return CASE.find(name_or_path)[0]


def design_text(name_or_path: str | Path) -> str:
    """Text of a shipped design (by name) or of a design file (by path). Raises as ``case_text``.

    Examples
    --------
    >>> design_text("fm-11x41").splitlines()[0]
    '# The design that makes the shipped case fm-11x41: easeoff design fm-11x41 -o my-case.toml'
    """
    return DESIGN.find(name_or_path)[0]


def read_case(name_or_path: str | Path, *, allow_outside: bool = False) -> Case:
    """Read and check a case.

    Parameters
    ----------
    name_or_path
        Name of a shipped case, or path of a case file in TOML.
    allow_outside
        Whether files that the case names may be outside its folder; for cases that you trust.

    Raises
    ------
    InputError
        Naming every wrong key, its value and what is allowed.

    Examples
    --------
    >>> read_case("nasa-12x36").pinion.number_of_teeth
    12
    """
    return CASE.read(name_or_path, allow_outside=allow_outside)


def read_design(name_or_path: str | Path, *, allow_outside: bool = False) -> Design:
    """Read and check a design. Takes and raises what ``read_case`` does.

    Examples
    --------
    >>> read_design("fm-11x41").gear.number_of_teeth
    41
    """
    return DESIGN.read(name_or_path, allow_outside=allow_outside)


def read_supports(name_or_path: str | Path) -> SupportsTable:
    """Read and check a file of supports, for ``with_supports``.

    Parameters
    ----------
    name_or_path
        Name of shipped supports, or path of a file in TOML.

    Raises
    ------
    InputError
        Naming every wrong key, its value and what is allowed.

    Examples
    --------
    >>> read_supports("axle-fm-11x41").gear.shaft.seat
    63.0
    """
    return SUPPORT.read(name_or_path).supports


def parse_case(text: str, origin: str = "case", folder: Path | None = None, *, allow_outside: bool = False) -> Case:
    """Check the text of a case.

    Parameters
    ----------
    text
        Content of a case file, in TOML.
    origin
        Name of the case in messages.
    folder
        Where relative paths in it start; the working folder if left out.
    allow_outside
        Whether files that the case names may be outside this folder.

    Raises
    ------
    InputError
        As ``read_case``.

    Examples
    --------
    >>> parse_case("easeoff_case = 2", "mine.toml")
    Traceback (most recent call last):
    easeoff.core.errors.InputError: mine.toml has 4 mistakes:
      title: is missing; it must be given
      pair: is missing; it must be given
      pinion: is missing; it must be given
      gear: is missing; it must be given
    """
    return CASE.parse(text, origin, folder, allow_outside=allow_outside)


def parse_design(
    text: str, origin: str = "design", folder: Path | None = None, *, allow_outside: bool = False
) -> Design:
    """Check the text of a design. Takes and raises what ``parse_case`` does.

    Examples
    --------
    >>> parse_design("easeoff_case = 2", "mine.toml")
    Traceback (most recent call last):
    easeoff.core.errors.InputError: mine.toml is a case already: analyse it with 'easeoff run mine.toml -o RESULT'
    """
    return DESIGN.parse(text, origin, folder, allow_outside=allow_outside)


def check_case(data: Mapping[str, Any], origin: str = "case") -> Case:
    """Check the tables of a case, wherever they come from; messages call it ``origin``. Raises as ``read_case``."""
    return CASE.check(data, origin)


def with_supports(case: Case, supports: SupportsTable | str | Path) -> Case:
    """The case with other supports.

    Parameters
    ----------
    case
        A checked case.
    supports
        Supports, the name of shipped ones, or the path of a file of supports.

    Raises
    ------
    InputError
        If there is no such file, its supports have mistakes, or they do not hold the members of this case.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> with_supports(read_case("fm-11x41"), "axle-fm-11x41").supports.gear.shaft.seat
    63.0
    """
    instance("case", case, Case)
    from .support_conversion import support_system

    table = supports if isinstance(supports, SupportsTable) else read_supports(supports)
    new_case = case.model_copy(update={"supports": table})
    try:
        support_system(new_case)
    except InputError as error:
        origin = "" if isinstance(supports, SupportsTable) else f"{supports}: "
        raise InputError(f"{origin}{error}") from error
    new_case._supports_name = "" if isinstance(supports, SupportsTable) else stem(supports)
    return new_case
