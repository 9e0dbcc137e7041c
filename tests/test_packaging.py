"""The package as it ships: public names are there, every docstring example works, messages name commands that run."""

from __future__ import annotations

import doctest
import importlib
import importlib.util
import pkgutil
import shlex
import subprocess
from pathlib import Path

import pytest

import easeoff
from easeoff.core.errors import how_to_install

PACKAGE = Path(easeoff.__file__).parent


def test_only_the_package_file_stands_at_the_root() -> None:
    assert [p.name for p in PACKAGE.glob("*.py")] == ["__init__.py"]


def test_examples_in_docstrings_work() -> None:
    tried = 0
    for name in ["easeoff", *(found.name for found in pkgutil.walk_packages(easeoff.__path__, "easeoff."))]:
        outcome = doctest.testmod(importlib.import_module(name))
        assert outcome.failed == 0, name
        tried += outcome.attempted
    assert tried > 3


def test_public_names_are_there_and_shown() -> None:
    for name in easeoff.__all__:
        assert getattr(easeoff, name) is not None
    shown = [name for name in dir(easeoff) if not name.startswith("_")]
    assert shown == sorted(easeoff.__all__)
    assert {"analyze", "contact", "friction", "geometry", "read_case", "verification"} <= set(shown)
    assert doctest.testmod(easeoff).failed == 0


@pytest.mark.parametrize("pip", [True, False])
def test_message_names_a_command_that_runs_here(pip: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether or not the environment has pip, is activated, or is the working folder."""
    if importlib.util.find_spec("pip") is None and pip:
        pytest.skip("this environment has no pip")
    real = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "pip" and not pip else real(name))
    said, command = how_to_install("easeoff[cad]").split(" installs it: ")
    assert said == "easeoff[cad]"
    words = shlex.split(command)
    runs, what = words[: words.index("install")], words[words.index("install") + 1 :]
    root = Path(easeoff.__file__).resolve().parent
    assert what == (["-e", f"{root}[cad]"] if (root / "pyproject.toml").exists() else ["easeoff[cad]"])
    found = subprocess.run([*runs, "--version"], capture_output=True, text=True, cwd="/", check=True)
    assert found.stdout.startswith("pip ")
    assert how_to_install("osqp").endswith(" install osqp")
