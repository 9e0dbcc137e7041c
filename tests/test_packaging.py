"""The package as it ships: public names are there, messages name commands that run."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import pkgutil
import shlex
import subprocess
from pathlib import Path
from types import ModuleType

import pytest

import easeoff
from easeoff.core.errors import how_to_install

PACKAGE = Path(easeoff.__file__).parent
PUBLIC = (
    "easeoff",
    "easeoff.cases",
    "easeoff.contact",
    "easeoff.contact.compliance",
    "easeoff.contact.solvers",
    "easeoff.friction",
    "easeoff.friction.ehl",
    "easeoff.friction.ehl.study",
    "easeoff.geometry",
    "easeoff.geometry.formats",
    "easeoff.geometry.tooth",
    "easeoff.study",
    "easeoff.study.compare",
    "easeoff.study.library",
    "easeoff.study.plot",
    "easeoff.study.sweep",
    "easeoff.verification",
)


def test_only_the_package_file_stands_at_the_root() -> None:
    assert [p.name for p in PACKAGE.glob("*.py")] == ["__init__.py"]


@pytest.mark.parametrize("package", [easeoff, easeoff.study])
def test_public_names_are_there_and_shown(package: ModuleType) -> None:
    shown = [name for name in dir(package) if not name.startswith("_")]
    assert shown == sorted(package.__all__)
    assert all(getattr(package, name) is not None for name in shown)
    with pytest.raises(AttributeError, match="no attribute 'missing'"):
        package.missing  # noqa: B018


@pytest.mark.parametrize(
    ("package", "name", "said"),
    [
        (easeoff, "report", ": it is easeoff.study.write_report$"),
        (easeoff, "shipped_cases", ": it is easeoff.cases.shipped_cases$"),
        (easeoff, "read_sweep", r": it is easeoff\.study\.sweep\.read_sweep$"),
        (easeoff, "analyse", "did you mean 'analyze'"),
        (easeoff.plot, "presure", "did you mean 'pressure'"),
        (easeoff.contact, "solv", "did you mean 'solve'"),
    ],
)
def test_a_name_that_is_elsewhere_or_misspelt_is_told(package: ModuleType, name: str, said: str) -> None:
    with pytest.raises(AttributeError, match=said):
        getattr(package, name)


def test_names_at_the_top() -> None:
    names = {"analyze", "contact", "friction", "geometry", "read_case", "verification", "EaseoffError", "InputError"}
    assert names <= set(dir(easeoff))


@pytest.mark.parametrize("name", PUBLIC)
def test_public_functions_and_classes_have_examples(name: str) -> None:
    """That they work says ``test_docstrings``."""
    package = importlib.import_module(name)
    for public in package.__all__:
        thing = getattr(package, public)
        if inspect.isclass(thing) or inspect.isroutine(thing):
            _, _, examples = (thing.__doc__ or "").partition("Examples\n")
            assert ">>> " in examples, public


def test_public_packages_are_those_that_list_their_names() -> None:
    packages = [found.name for found in pkgutil.walk_packages(easeoff.__path__, "easeoff.") if found.ispkg]
    assert [name for name in packages if hasattr(importlib.import_module(name), "__all__")] == sorted(PUBLIC[1:])


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
