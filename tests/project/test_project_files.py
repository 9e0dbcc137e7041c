"""What the project shows and publishes: classifiers, requirements, recipe, workflows, source distribution."""

from __future__ import annotations

import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from places import ROOT

CONFIGURATION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = CONFIGURATION["project"]
RECIPE = yaml.safe_load((ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8"))
WORKFLOWS = {
    path.stem: yaml.safe_load(path.read_text(encoding="utf-8")) for path in ROOT.glob(".github/workflows/*.yml")
}
PYTHONS = [found[1] for line in PROJECT["classifiers"] if (found := re.fullmatch(r".*:: (3\.\d+)", line))]
#: Requirements that conda packages call otherwise.
NAMES_FOR_CONDA = {"matplotlib": "matplotlib-base", "lazy-loader": "lazy_loader"}


def requirements(*lines: str, system: str = "linux", python: str = "3.14") -> dict[str, str]:
    """Names and bounds of the requirements of a system."""
    wanted = [Requirement(line) for line in lines]
    place = {"sys_platform": system, "python_version": python}
    return {
        canonicalize_name(each.name): str(each.specifier)
        for each in wanted
        if each.marker is None or each.marker.evaluate(place)
    }


def test_pythons_of_classifiers_readme_and_workflows_are_the_same() -> None:
    first = int(PROJECT["requires-python"].removeprefix(">=3."))
    assert [f"3.{first + number}" for number in range(len(PYTHONS))] == PYTHONS
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"with Python {', '.join(PYTHONS[:-1])} or {PYTHONS[-1]}" in readme
    page = (ROOT / "docs" / "python" / "compatibility.md").read_text(encoding="utf-8")
    assert f"from {PYTHONS[0]} on: now {PYTHONS[0]} to {PYTHONS[-1]}" in page
    assert WORKFLOWS["tests"]["jobs"]["quick"]["strategy"]["matrix"]["python"] == PYTHONS
    assert WORKFLOWS["release"]["jobs"]["installed"]["strategy"]["matrix"]["python"] == PYTHONS
    assert CONFIGURATION["tool"]["distutils"]["bdist_wheel"]["py-limited-api"] == f"cp3{first}"


def test_every_system_of_the_classifiers_is_tried_and_has_wheels() -> None:
    runners = {"ubuntu": "POSIX :: Linux", "windows": "Microsoft :: Windows", "macos": "MacOS"}
    named = {line.partition(" :: ")[2] for line in PROJECT["classifiers"] if line.startswith("Operating System")}
    for job in (WORKFLOWS["tests"]["jobs"]["quick"], WORKFLOWS["release"]["jobs"]["wheel"]):
        assert {runners[system.partition("-")[0]] for system in job["strategy"]["matrix"]["system"]} == named


def test_windows_runs_what_make_test_runs() -> None:
    """Where there is no make; as the README has it for Linux."""
    steps = WORKFLOWS["tests"]["jobs"]["quick"]["steps"]
    lines = next(step["run"] for step in steps if step.get("if") == "runner.os == 'Windows'").splitlines()
    arguments = '-m pytest -q -n 2 --dist loadscope -m "not thorough"'
    assert lines[-1].endswith(arguments)
    assert arguments in (ROOT / "README.md").read_text(encoding="utf-8")
    make = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "pytest -q -n $(WORKERS) --dist loadscope\n" in make
    assert '$(PYTEST) -m "not thorough"' in make
    assert "WORKERS ?= 2" in make


def test_nothing_is_published_without_checks_nor_but_by_a_tag() -> None:
    jobs = WORKFLOWS["release"]["jobs"]
    assert set(jobs["publish"]["needs"]) == set(jobs) - {"publish", "announce"}
    assert jobs["publish"]["if"] == "github.ref_type == 'tag'"
    assert jobs["announce"]["needs"] == "publish"
    assert jobs["publish"]["permissions"] == {"id-token": "write"}
    assert all("permissions" not in jobs[name] for name in jobs["publish"]["needs"])
    assert all(workflow["permissions"] == {"contents": "read"} for workflow in WORKFLOWS.values())


def test_requirements_of_the_recipe_are_those_of_the_project() -> None:
    def listed(name: str) -> list[str]:
        return [line for line in RECIPE["requirements"][name] if isinstance(line, str)]

    wanted = {"python": PROJECT["requires-python"]} | requirements(*PROJECT["dependencies"])
    assert requirements(*listed("run")) == {
        canonicalize_name(NAMES_FOR_CONDA.get(name, name)): bound for name, bound in wanted.items()
    }
    build = requirements("python" + PROJECT["requires-python"], "pip", *CONFIGURATION["build-system"]["requires"])
    assert requirements(*listed("host")) == build
    assert RECIPE["context"] == {"name": PROJECT["name"], "version": PROJECT["version"]}
    assert RECIPE["about"]["license"] == PROJECT["license"]
    assert RECIPE["about"]["repository"] == PROJECT["urls"]["Repository"]


@pytest.mark.parametrize("system", ["linux", "win32", "darwin"])
def test_what_does_not_exist_in_browsers_is_asked_for_elsewhere(system: str) -> None:
    lines = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["solvers"]]
    here, there = requirements(*lines, system=system), requirements(*lines, system="emscripten")
    assert here.keys() - there.keys() == {"osqp", "scs", "cvxpy"}
    assert there.keys() - here.keys() == {"cvxpy-base"}
    assert there["cvxpy-base"] == here["cvxpy"]


def test_source_distribution_holds_the_whole_repository() -> None:
    """By the lines of MANIFEST.in: tests and pages that it holds look at the rest."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a repository")
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    lines = [line.split() for line in (ROOT / "MANIFEST.in").read_text(encoding="utf-8").splitlines()]
    grafted = {word for command, *words in lines if command == "graft" for word in words}
    packages = {name.split(".")[1] for name in CONFIGURATION["tool"]["setuptools"]["packages"] if "." in name}
    patterns = [word for command, *words in lines if command == "include" for word in words]
    always = ("README.md", "LICENSE", "pyproject.toml", "MANIFEST.in", "__init__.py", "__init__.pyi", "py.typed")
    left = [
        name
        for name in listed
        if name.partition("/")[0] not in grafted | packages
        and not ("/" not in name and (name in always or any(Path(name).match(pattern) for pattern in patterns)))
    ]
    assert left == [".gitignore"]


def test_addresses_are_those_of_one_repository() -> None:
    home = PROJECT["urls"]["Repository"]
    assert all(address.startswith(home) for address in PROJECT["urls"].values())
    files = [*ROOT.glob("*.md"), *(ROOT / ".github").rglob("*.*"), ROOT / "recipe" / "recipe.yaml"]
    found = {
        match[0]
        for path in files
        if path.is_file()
        for match in re.finditer(r"https://github\.com/[\w.-]+/[\w.-]+", path.read_text(encoding="utf-8"))
    }
    assert found == {home}


@pytest.mark.parametrize("path", sorted(ROOT.glob(".github/ISSUE_TEMPLATE/*.yml")), ids=lambda path: path.stem)
def test_issue_forms_have_what_the_code_host_asks_for(path: Path) -> None:
    form: dict[str, Any] = yaml.safe_load(path.read_text(encoding="utf-8"))
    if path.stem == "config":
        assert all({"name", "url", "about"} == link.keys() for link in form["contact_links"])
        return
    assert {"name", "description", "body"} <= form.keys()
    names = [part["id"] for part in form["body"]]
    assert len(set(names)) == len(names)
    assert all(part["attributes"]["label"] for part in form["body"])
