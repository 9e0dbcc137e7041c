"""One run and the folder of its files."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, field
from pathlib import Path

from bases import Bases
from mutations import option_values
from oracle import SECRET

INNER = "outer/inner"
"""Folder of a run within its box, deep enough for paths that lead out of it."""


@dataclass
class Input:
    """One run.

    Attributes
    ----------
    kind
        Which of the kinds it is.
    args
        Words of the command line; for ``call``, the file to read.
    inputs
        Files that it reads and must leave alone.
    call
        A reader that no command has, instead of a command.
    environment
        Variables of the environment.
    same_as
        The base file that the output must equal.
    fresh
        In a fresh interpreter instead of a forked one.
    """

    kind: str
    args: list[str]
    inputs: list[str] = field(default_factory=list)
    call: str = ""
    environment: dict[str, str] = field(default_factory=dict)
    same_as: str = ""
    fresh: bool = False

    @property
    def command(self) -> str:
        """Name of the command, or of the reader."""
        return self.call or next((word for word in self.args if word in option_values.OPTIONS), "none")


class Box:
    """Folder of a run, within folders that it must leave alone."""

    def __init__(self, root: Path, bases: Bases) -> None:
        self.root, self.bases = root, bases
        self.folder = root / INNER
        self.folder.mkdir(parents=True)
        self.temporary = root / "temporary"
        self.temporary.mkdir()
        (root / "secret.toml").write_text(f"{SECRET} = \"{SECRET}\"\ntitle = '{SECRET}'\n[{SECRET}\n")

    def copy(self, base: str, name: str = "") -> str:
        """Put a base file into the folder; return its name there."""
        name = name or Path(base).name
        target = self.folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(self.bases[base], target)
        return name

    def put(self, name: str, data: bytes) -> str:
        """Put bytes into the folder; return their name."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        return name
