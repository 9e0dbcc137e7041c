"""The structure of the package, and the package as it ships."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import pkgutil
import shlex
import subprocess
import sys
import tomllib
from graphlib import CycleError, TopologicalSorter
from itertools import chain
from pathlib import Path
from types import ModuleType

import pytest
from package_imports import PACKAGE, ROOMS, imports, modules
from packaging.requirements import Requirement
from places import ROOT, TESTS

import easeoff
from easeoff.core.errors import how_to_install

#: Each imports from those before it alone; what is not named comes after all that is.
ORDER = {
    "": ROOMS,
    "geometry": ("vectors", "newton", "cutting", "flanks", "pair", "tooth", "design", "deviation", "formats"),
    "contact": (
        *("outcomes", "problem", "solvers", "lines", "compliance", "line_contact", "mesh_wrench", "segments", "loaded"),
        "supports",
    ),
    # Studies return labelled data; what shows them stands above, the commands on top.
    "study": (
        *("result", "progress", "deviations", "geometry_export", "case_in_mesh"),
        *("case_correction", "analysis", "sweep", "design", "load_case_analysis", "vh", "wear_simulation", "library"),
        *("compare", "summary", "plot", "report", "notebook", "cli"),
    ),
}
#: The one module of the product that imports yardsticks, when its command is run.
VERIFYING = "easeoff.study.cli.study_commands"
PUBLIC = ("cases", "contact", "friction", "friction.ehl", "friction.ehl.study", "geometry", "geometry.tooth", "study")
#: Where users come in; adapters of solvers are imported by the names of the solvers.
ENTRIES = {"easeoff", "easeoff.study.cli", *(f"easeoff.{name}" for name in PUBLIC)}


def entry(name: str, within: str) -> str | None:
    """The module or folder in a folder of the package that a module is or is in; nothing if it is elsewhere."""
    parts = name.split(".")[1:]
    if within:
        parts = parts[1:] if parts[:1] == [within] else []
    return parts[0] if parts else None


@pytest.mark.parametrize("within", ORDER)
def test_folders_import_those_before_them_alone(within: str) -> None:
    order = ORDER[within]
    rank = {name: order.index(at) if at in order else len(order) for name in modules() if (at := entry(name, within))}
    upward = [
        f"{name} imports {other}"
        for name in rank
        for other in imports(name) & rank.keys()
        if rank[name] < rank[other] and not (name == VERIFYING and entry(other, "") == "verification")
    ]
    assert upward == []


def test_one_command_alone_reaches_the_yardsticks_and_only_when_it_is_run() -> None:
    """The exception from the order, by name: it imports them within its function, so that nothing else loads them."""
    outside = {name for name in modules() if entry(name, "") not in (None, "verification")}
    assert {name for name in outside if any(entry(o, "") == "verification" for o in imports(name))} == {VERIFYING}


@pytest.mark.parametrize(
    "name",
    [
        "geometry",
        "contact",
        "contact.compliance",
        "contact.solvers",
        "friction",
        "friction.ehl",
        "friction.ehl.study",
        "cases",
        "study.plot",
        "study.sweep",
    ],
)
def test_names_imported_on_first_use_are_there(name: str) -> None:
    """And none is that of a module in its folder: once imported, the module would stand in its place."""
    package = importlib.import_module(f"easeoff.{name}")
    beside = {each.stem for each in modules()[f"easeoff.{name}"].parent.iterdir()}
    assert not set(package.__all__) & beside
    for each in package.__all__:
        assert getattr(package, each) is not None
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = package.no_such_name


#: Code and what is not loaded after it, each after what stands above it in one process.
ONE_BY_ONE: dict[str, dict[str, tuple[str, ...]]] = {
    "commands": {
        "import easeoff": ("numpy", "click", "xarray", "pandas", "easeoff.study.plot"),
        "import easeoff.study.cli": ("numpy", "pydantic", "xarray", "easeoff.verification"),
        "from easeoff.study.cli import main; main(['--help'], standalone_mode=False)": (
            *("numpy", "scipy", "xarray", "matplotlib", "pydantic", "cvxpy", "qpsolvers", "netCDF4"),
        ),
        "main(['cases'], standalone_mode=False)": ("numpy", "pydantic", "xarray", "pandas", "scipy", "netCDF4"),
        "easeoff.read_case('fm-11x41')": ("xarray", "pandas", "scipy", "netCDF4", "easeoff.contact.loaded"),
        "import easeoff.study.analysis.case_analysis": (
            *("scipy.optimize", "scipy.interpolate", "scipy.spatial", "matplotlib"),
        ),
    },
    "results": {
        "import easeoff.study.result": ("scipy", "matplotlib", "pydantic"),
        "import easeoff.study.summary.load_case_summary, easeoff.study.sweep.sweep_file": (
            *("scipy", "matplotlib", "pydantic", "easeoff.contact.loaded", "easeoff.study.sweep.parameter_sweep"),
            *(
                "easeoff.geometry.pair.gear_pair",
                "easeoff.contact.solvers.solution",
                "easeoff.study.report.report_file",
            ),
        ),
        "from easeoff.study.report import report_file, page_data": ("scipy", "matplotlib"),
        "easeoff.plot.pressure; from easeoff import plot; assert plot is easeoff.plot": ("matplotlib",),
        "import easeoff.study.plot.mesh_cycle_charts": ("matplotlib.pyplot",),
    },
    "arrays of other kinds": {
        "import click; from easeoff.study.cli.command import quick_start": ("numpy", "xarray"),
        "with click.Context(click.Command('any')):\n quick_start()\n import xarray\n xarray.Dataset({'x': [0]})": (
            *("dask", "pint", "cupy", "sparse"),
        ),
    },
}


@pytest.mark.parametrize("steps", ONE_BY_ONE.values(), ids=list(ONE_BY_ONE))
def test_what_is_not_needed_is_not_loaded(steps: dict[str, tuple[str, ...]]) -> None:
    """Most of the processor time of a command went into imports."""
    lines = ["import sys"]
    for code, spared in steps.items():
        lines += [code, f"print('loaded:', [name for name in {spared!r} if name in sys.modules])"]
    done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, check=True)
    loaded = [line for line in done.stdout.splitlines() if line.startswith("loaded:")]
    assert dict(zip(steps, loaded, strict=True)) == dict.fromkeys(steps, "loaded: []")


def test_modules_import_each_other_in_no_circle() -> None:
    """Neither for types alone."""
    try:
        TopologicalSorter({name: imports(name) for name in modules()}).prepare()
    except CycleError as error:
        raise AssertionError(" <- ".join(error.args[1])) from None


def test_every_module_is_reached_from_an_entry_or_is_a_yardstick() -> None:
    reached: set[str] = set()
    waiting = ENTRIES | {name for name in modules() if name.startswith("easeoff.contact.solvers.adapters.")}
    while waiting:
        name = waiting.pop()
        reached.add(name)
        above = {".".join(name.split(".")[:n]) for n in range(1, name.count(".") + 1)}
        waiting |= (imports(name) | above) - reached
    left = {name for name in modules() if not name.startswith("easeoff.verification")} - reached
    assert sorted(left) == []


@pytest.mark.parametrize("name", ["tests", "docs", "benchmarks", "fuzz"])
def test_what_stands_beside_the_package_is_no_part_of_it(name: str) -> None:
    """In a checkout these folders stand in that of the package; here in a fresh process, as the first import."""
    done = subprocess.run([sys.executable, "-c", f"import easeoff.{name}"], capture_output=True, text=True, check=False)
    assert f"ModuleNotFoundError: No module named 'easeoff.{name}'" in done.stderr


def test_every_folder_with_code_is_listed_as_a_package() -> None:
    """A sub-package missing from the list works in a checkout and is absent from the wheel."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    packages = [name for name, path in modules().items() if path.name == "__init__.py"]
    assert sorted(packages) == sorted(project["tool"]["setuptools"]["packages"])
    assert {path.parent for path in modules().values()} == {modules()[name].parent for name in packages}


def test_tests_stand_in_the_folders_of_the_package() -> None:
    folders = {path.parent.relative_to(TESTS) for path in TESTS.rglob("test_*.py")}
    assert [str(folder) for folder in sorted(folders) if not (PACKAGE / folder).is_dir()] == ["project"]


def test_every_requirement_has_a_lower_bound() -> None:
    """`make lowest` would otherwise take the very first version of a package, or none."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = chain(project["dependencies"], *project["optional-dependencies"].values())
    wanted = [Requirement(line) for line in lines]
    own = [requirement for requirement in wanted if requirement.name == "easeoff"]
    assert own, "the extra test asks for others of this package"
    for requirement in wanted:
        assert requirement in own or ">=" in {part.operator for part in requirement.specifier}, str(requirement)


# The package as it ships: public names are there, messages name commands that run


WITH_NAMES = (
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


@pytest.mark.parametrize("name", WITH_NAMES)
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
    assert [name for name in packages if hasattr(importlib.import_module(name), "__all__")] == sorted(WITH_NAMES[1:])


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
