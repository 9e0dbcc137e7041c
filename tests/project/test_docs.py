"""The documentation cannot rot: its code runs, its tables are those of the code, its links lead somewhere."""

from __future__ import annotations

import importlib
import inspect
import json
import pkgutil
import re
import shlex
import tomllib
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import netCDF4
import numpy as np
import pytest
from browser import Browser, chromium
from click.testing import CliRunner
from PIL import Image
from places import ROOT
from runs import SHELLS, SMALL

import easeoff
from easeoff.cases import gear_pair, parse_case, parse_design
from easeoff.cases.reading import CASE, DESIGN, FileKind
from easeoff.cases.schema import case_schema as model, cutting_table, design_schema as design_model
from easeoff.cases.schema.blank_design_table import BlankDesignTable
from easeoff.cases.schema.schema_table import Table
from easeoff.contact import SOLVERS, ContactProblem, read_problems, solve
from easeoff.geometry import MachineSettings, ease_off
from easeoff.geometry.cutting.machine import IncrementSense, machine_pose
from easeoff.geometry.cutting.named_settings import BLADE_STEPS, CURVATURE_STEPS, MACHINE_STEPS, MODIFIED_ROLL_ORDERS
from easeoff.geometry.design.synthesis import FREE_SETTINGS
from easeoff.study.cli import main
from easeoff.study.library import entries, reference_answers
from easeoff.study.library.library_files import labels

DOCS = ROOT / "docs"
#: Pages by their place under docs, such as "python/recipes".
PAGES = {
    path.relative_to(DOCS).with_suffix("").as_posix(): path
    for path in sorted(DOCS.rglob("*.md"))
    if not {"paper", "_build"} & set(path.relative_to(DOCS).parts)
}
#: Pages that are run at once, with few points: what begins, and those in whose code a number stands that is looked at.
QUICK = ("researcher/contact_problems", "engineer/reference/results", "index")


def text(name: str) -> str:
    (path,) = [PAGES[name]] if name in PAGES else [path for path in PAGES.values() if path.stem == name]
    return path.read_text(encoding="utf-8")


def blocks(page: str, *languages: str) -> list[tuple[str, str]]:
    """Language and code of the fenced blocks of a page."""
    found = re.findall(r"^```(\w+)\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)
    return [(language, code) for language, code in found if language in languages]


def rows(page: str, heading: str) -> list[list[str]]:
    """Cells of the first table behind a heading, without its head."""
    table = page.split(f"{heading}\n", 1)[1].split("\n| ", 1)[1].split("\n\n", 1)[0]
    return [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in table.splitlines()[2:]]


def run(page: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Write the tables of a page, named by their first lines, and run its commands and code, in order in one folder."""
    import matplotlib

    matplotlib.use("Agg")
    monkeypatch.chdir(folder)
    namespace: dict[str, Any] = {}
    for language, code in blocks(page, "sh", "python", "csv", "toml"):
        if language in ("csv", "toml"):
            name, colon, _ = code.removeprefix("# ").partition(":")
            if colon and name.endswith(f".{language}") and " " not in name:
                (folder / name).write_text(code, encoding="utf-8")
            continue
        if language == "python":
            exec(compile(code, "documentation", "exec"), namespace)
            continue
        for line in code.replace("\\\n", " ").splitlines():
            command, *arguments = shlex.split(line, comments=True)
            assert command == "easeoff"
            outcome = CliRunner().invoke(main, arguments)
            assert outcome.exit_code == 0, outcome.output
    return namespace


WITH_CODE = [name for name in PAGES if blocks(PAGES[name].read_text(encoding="utf-8"), "python", "sh")]


def with_few_points(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shipped cases have few mesh positions, segments and nodes; teeth, of shipped designs too, are shells."""
    find = FileKind.find
    few = "\n".join(f"{key} = {value}" for key, value in SMALL.items())

    def found(kind: FileKind[Any], name_or_path: str | Path) -> tuple[str, Path | None]:
        text, folder = find(kind, name_or_path)
        if kind is CASE and name_or_path in CASE.names():
            text = text.replace("[contact]", f"[contact]\n{few}")
        if name_or_path in kind.names() and kind in (CASE, DESIGN):
            text += SHELLS
        return text, folder

    monkeypatch.setattr(FileKind, "find", found)


@pytest.mark.usefixtures("reading_in_copies")  # a page leaves a file open
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in QUICK else pytest.mark.thorough) for name in WITH_CODE]
)
def test_code_of_the_page_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if name in QUICK:
        with_few_points(monkeypatch)
    namespace = run(text(name), tmp_path, monkeypatch)
    if name == "researcher/contact_problems":
        # The script that knows nothing of the package finds the answer of the package.
        solution = solve(read_problems(tmp_path / "problems.nc")[0])
        assert namespace["rotation"] == pytest.approx(solution.rotation, rel=1e-12)
        np.testing.assert_allclose(namespace["force"], solution.force, rtol=0, atol=1e-9 * solution.force.max())
        np.testing.assert_allclose(namespace["gap"], solution.gap, rtol=0, atol=1e-9 * solution.gap.max())
        # So do the other forms.
        assert namespace["by_displacements"].rotation == pytest.approx(solution.rotation, rel=1e-8)
        assert namespace["by_pivoting"].rotation == pytest.approx(solution.rotation, rel=1e-13)


def test_bibliography_has_every_doi_that_is_cited() -> None:
    """A closing parenthesis ends a DOI of prose, unless one was opened in it."""
    found = {}
    folders = [ROOT / name for name in ("core", "geometry", "contact", "friction", "cases", "study", "verification")]
    listed = unquote(text("bibliography"))
    for path in [*(p for f in folders for p in f.rglob("*.py")), *(p for f in folders for p in f.rglob("*.toml")),
                 *PAGES.values()]:  # fmt: skip
        for doi in re.findall(r"10\.\d{4,}/(?:[\w.:;/-]|\([\w-]+\))+", unquote(path.read_text(encoding="utf-8"))):
            found[doi.rstrip(".;:")] = path.name
    assert len(found) > 20
    assert {doi: name for doi, name in found.items() if f"[{doi}]" not in listed} == {}


GALLERY = sorted((DOCS / "python" / "gallery").glob("*.py"))


def test_gallery_has_a_dozen_examples_with_titles() -> None:
    """The site runs them: ``make docs``."""
    assert len(GALLERY) >= 12
    for example in GALLERY:
        assert re.match(r'"""\n.+\n=+\n\n\S', example.read_text(encoding="utf-8"))


def test_folders_are_small_enough_to_be_seen_at_once() -> None:
    built = {DOCS / "_build", DOCS / "python" / "api", DOCS / "python" / "examples"}
    for folder in [DOCS, *(path for path in DOCS.rglob("*") if path.is_dir())]:
        if not built & {folder, *folder.parents}:
            names = {path for path in folder.iterdir() if path.name != "__pycache__" and path not in built}
            assert len(names) <= 16, folder


def test_every_page_stands_once_in_the_reading_order() -> None:
    pytest.importorskip("sphinx")
    order = importlib.import_module("reading_order")
    listed = [
        (Path(index).parent / page).as_posix()
        for index, parts in order.READING_ORDER.items()
        for pages in parts.values()
        for page in pages
    ]
    assert len(set(listed)) == len(listed)
    made = {page for page in listed if page.startswith(("python/examples/", "python/api/"))}
    assert set(listed) - made == set(PAGES) - {"index"}
    assert {path.stem for path in GALLERY} == set(order.EXAMPLES)


def test_reference_of_the_interface_has_every_public_package() -> None:
    listed = set(importlib.import_module("reference_pages").PACKAGES)
    others = {"easeoff.contact.compliance", "easeoff.contact.solvers", "easeoff.verification"}
    public = {"easeoff", *(found.name for found in pkgutil.walk_packages(easeoff.__path__, "easeoff.") if found.ispkg)}
    public = {name for name in public if hasattr(importlib.import_module(name), "__all__")}
    assert listed == public - others


def test_links_lead_somewhere() -> None:
    for page in [*PAGES.values(), *ROOT.glob("*.md")]:
        for target in re.findall(r"\]\(([^)#\s]*(?:#[^)\s]*)?)\)", page.read_text(encoding="utf-8")):
            if target.startswith("http"):
                assert re.fullmatch(r"https?://[\w.-]+\.[a-z]+(/[^\s<>|]*)?", target), f"{page.name}: {target}"
                continue
            file, _, anchor = target.partition("#")
            other = page if not file else page.parent / file
            assert other.exists(), f"{page.name}: {target}"
            if anchor:
                headings = re.findall(r"^#+ (.*)$", other.read_text(encoding="utf-8"), flags=re.MULTILINE)
                assert anchor in {re.sub(r"[^\w\- ]", "", h).lower().replace(" ", "-") for h in headings}, target


def test_tables_of_the_problem_library_are_those_of_its_description() -> None:
    """If not: run docs/make problem_library."""
    tables, page = importlib.import_module("make_problem_library"), text("problem_library")
    assert page == tables.updated(page)
    assert all(table() in page for table in tables.TABLES.values())


def test_labels_of_the_problem_library_are_those_of_the_page() -> None:
    named = re.findall(r"`(\w+)`", text("problem_library").split("Labels:\n\n")[1].split("\n\n")[0])
    springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.eye(2))
    assert named == list(labels([entries()[0]], reference_answers(), [springs]))


def test_case_reference_is_what_the_schema_makes() -> None:
    """If not: run docs/make case_reference."""
    reference = importlib.import_module("make_case_reference")
    page = text("case_file_keys")
    assert page == reference.updated(page)
    assert reference.case_tables() in page
    described = {table for _, table in reference.sections()}
    for _, table in inspect.getmembers(model, lambda m: inspect.isclass(m) and issubclass(m, Table)):
        keys = [k for k, field in table.model_fields.items() if not reference.sub_table(field.annotation)]
        assert table in described or not keys or any(issubclass(other, table) for other in described), table


def test_design_reference_is_what_the_schema_makes() -> None:
    """If not: run docs/make case_reference."""
    reference = importlib.import_module("make_case_reference")
    page = text("design_file_keys")
    assert page == reference.updated_design(page)
    assert reference.design_tables() in page
    # Tables of its own are described here, the others among the keys of case files.
    shared = {table for _, table in reference.sections()}
    for name, field in design_model.Design.model_fields.items():
        table = field.annotation
        if inspect.isclass(table) and issubclass(table, Table):
            assert table in shared or f"`[{name}" in page, name


def test_example_designs_are_designs() -> None:
    """One with all keys, one as drawn, for which values are taken."""
    (_, whole), (_, drawn) = blocks(text("design_file"), "toml")
    assert [each.name for each in parse_design(whole).defaults] == ["gear.generation"]
    assert {"gear_face_width", "depth_taper", "gear.generation"} <= {each.name for each in parse_design(drawn).defaults}


def test_free_settings_of_the_page_are_those_of_the_code() -> None:
    table = rows(text("design_file_keys"), "## Free settings")
    listed = [row[0].strip("`") for row in table]
    assert listed == [*BLADE_STEPS, *CURVATURE_STEPS, *MACHINE_STEPS, *MODIFIED_ROLL_ORDERS, "..._motion_1"]
    assert set(FREE_SETTINGS) == {row[0].strip("`") for row in table if row[2] == "yes"}


def over_dimensions(page: str, group: str) -> dict[str, tuple[str, str]]:
    """Dimensions and unit of the variables in the table under the heading that names a group; pure numbers have 1."""
    heading = next(line for line in page.splitlines() if line.startswith("### ") and group in line[4:].split(", "))
    found: dict[str, tuple[str, str]] = {}
    over = "own"
    for first, _ in rows(page, heading):
        if first.startswith("*"):
            over = first.strip("*").removeprefix("over ").removeprefix("single values")
        else:
            names, _, unit = first.removesuffix("]").partition(" [")
            found |= {
                each: (each if over == "own" else over, unit or "1") for each in names.replace("`", "").split(", ")
            }
    return found


def test_result_reference_is_what_an_analysis_makes(tmp_path: Path) -> None:
    """If not: run docs/make result_reference."""
    reference = importlib.import_module("make_result_reference")
    page, tree = text("result_variables"), reference.coarse_analysis()
    assert set(tree.children) == importlib.import_module("make_overview").groups_in_the_flow()
    assert f"\n\n{reference.result_tables(tree)}\n\n" in page
    assert f"\n\n{reference.summary()}\n\n" in text("results")

    # And what stands in the file is what stands in the page.
    easeoff.write_result(tree, tmp_path / "result.nc")
    with netCDF4.Dataset(tmp_path / "result.nc") as file:
        assert all(f"`{name}`" in page for name in file.ncattrs())
        coordinates = over_dimensions(page, "Coordinates")
        for group in file.groups.values():
            listed = {name: row for name, row in coordinates.items() if name in group.variables}
            listed |= over_dimensions(page, f"`/{group.name}`")
            assert set(group.variables) == set(listed)
            for name, variable in group.variables.items():
                dimensions = [d for d in variable.dimensions if not d.startswith("string")]
                assert listed[name][0] == ", ".join(dimensions)
                assert listed[name][1] == getattr(variable, "units", "1")
            assert all(f"`{name}`" in page for name in group.ncattrs())


def test_way_in_is_read_in_a_few_minutes() -> None:
    assert len((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split()) < 1200


def test_pictures_of_flow_and_imports_show_what_is_there() -> None:
    """If not: run docs/make overview."""
    overview = importlib.import_module("make_overview")
    for path, shown in ((overview.FLOW, overview.shown_flow()), (overview.IMPORTS, overview.shown_imports())):
        with Image.open(path) as picture:
            assert json.loads(picture.info["Description"]) == json.loads(json.dumps(shown)), path.name


def test_numbers_beside_the_dissertation_are_those_of_the_program() -> None:
    """If not: run docs/make dissertation_figures."""
    tables = importlib.import_module("dissertation_tables")
    page = text("dissertation")
    made = {"2.9: unloaded": tables.figure_2_9, "3.6: loaded": tables.figure_3_6}
    for name, make in made.items():
        printed = {row[0]: row[1] for row in rows(page, f"## Figure {name} transmission error")}
        fresh = {row[0]: row[1] for row in rows(f"here\n\n{make()[0]}", "here")}
        assert list(printed) == list(fresh)
        for quantity, value in fresh.items():
            assert float(printed[quantity]) == pytest.approx(float(value), rel=0.02, abs=0.15), quantity


@pytest.mark.thorough
def test_claims_of_chapter_five_are_those_of_the_program() -> None:
    """If not: run docs/make efficiency_figures."""
    tables = importlib.import_module("efficiency_tables")
    page = text("efficiency")
    radius = importlib.import_module("efficiency_radius")
    for before, made in (
        ("## Figures 5.4 to 5.10: the flank", tables.ranges()),
        ("(constant height on the gear's flank):", radius.everywhere()),
    ):
        printed, fresh = rows(page, before), rows(f"here\n\n{made}", "here")
        for one, other in zip(printed, fresh, strict=True):
            assert one[0] == other[0]
            for cell, expected in zip(one[1:], other[1:], strict=True):
                found, numbers = ([float(n) for n in re.findall(r"[\d.]+", text)] for text in (cell, expected))
                assert found == pytest.approx(numbers, rel=0.05, abs=0.011), one[0]
    for claims in (tables.claims_on_maps, tables.claims_on_efficiency):
        for readings in zip(*(claims(direction) for direction in tables.LISTED), strict=True):
            said = readings[0][0]
            row = next(line for line in page.splitlines() if line.startswith(f"| {said} "))
            assert [row.split("|")[i].strip() == "yes" for i in (3, 5)] == [so for _, _, so in readings], said
    assert f"\n{tables.statements_lost()}\n" in page
    lost = {
        row[0]: row[1] for row in rows(page, "No reading gives all of the seventeen statements of the tables above:")
    }
    assert lost == dict.fromkeys(tables.DIRECTIONS.values(), "3 of 17")


def test_example_case_is_a_case() -> None:
    whole, formate, basic, friction = (code for _, code in blocks(text("case_file"), "toml"))
    case = parse_case(whole + friction)
    middle = ease_off(gear_pair(case), (7, 7))
    assert np.mean(middle["inside"].values) > 0.5
    machine = cutting_table.Machine.model_validate(tomllib.loads(formate)["gear"]["convex"]["machine"])
    assert machine.ratio_of_roll is None
    BlankDesignTable.model_validate(tomllib.loads(basic)["blank_design"])


def test_problem_file_holds_the_variables_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from easeoff.contact import write_problems
    from easeoff.verification import problems

    labels = {"name": np.array(list("abcd")), "pinion_torque": np.ones(4), "mesh_position": np.zeros(4)}
    write_problems([*problems("plain", 2), *problems("random_dense", 2)], tmp_path / "problems.nc", labels)
    listed: dict[str, tuple[str, str]] = {}
    for names, dimensions, units, _ in rows(text("problem_files"), "## The file"):
        for name, unit in zip(names.split(", "), units.split(", "), strict=True):
            listed[name.strip("`")] = (dimensions, unit)
    with netCDF4.Dataset(tmp_path / "problems.nc") as file:
        assert set(file.variables) == set(listed)
        for name, variable in file.variables.items():
            assert ", ".join(variable.dimensions) == listed[name][0]
            assert getattr(variable, "units", listed[name][1]) == listed[name][1]


def test_table_of_solvers_is_that_of_the_code() -> None:
    table = rows(text("solvers"), "## Names and licences")
    listed = {row[0].strip("`"): (*row[1:3], row[3].strip("`")) for row in table}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    always = {re.split(r"[^\w-]", requirement)[0] for requirement in project["dependencies"]}
    expected = {
        name: (entry.kind, entry.licence, "easeoff" if {entry.package} <= always | {""} else entry.requirement)
        for name, entry in SOLVERS.items()
    }
    assert listed == expected
    for name, (_, licence, requirement) in expected.items():
        assert ("GPL" in licence) == (requirement == "easeoff[copyleft-solvers]")
        if requirement != "easeoff":
            extra = project["optional-dependencies"][requirement[8:-1]]
            assert SOLVERS[name].package.replace("_", "-") in {re.split(r"[^\w-]", wanted)[0] for wanted in extra}


def test_table_of_limits_is_that_of_the_code() -> None:
    page = text("solvers")
    listed = {float(row[0]): set(re.findall(r"`(\w+)`", row[1])) for row in rows(page, "## Tolerance, time and steps")}
    for tolerance, names in listed.items():
        assert names == {name for name, entry in SOLVERS.items() if entry.tolerance == tolerance}
    assert sum(map(len, listed.values())) == len(SOLVERS)
    for name, entry in SOLVERS.items():
        if entry.tolerance_settings:
            assert entry.tolerance_power == (2 if name in listed[1e-4] else 1), name

    def after(words: str) -> set[str]:
        return set(re.findall(r"`(\w+)`", re.split("[;.]", page.split(words, 1)[1], maxsplit=1)[0]))

    assert after("and 10⁻²;") == {name for name, entry in SOLVERS.items() if not entry.tolerance_settings}
    assert after("No time limit:") == {name for name, entry in SOLVERS.items() if not entry.time_setting}
    assert after("no limit of steps:") == {name for name, entry in SOLVERS.items() if not entry.step_setting}
    assert after("Warm start by `initial_force`:") == {name for name, entry in SOLVERS.items() if entry.warm_start}


def spin(axis: str, angle: float) -> np.ndarray[Any, Any]:
    """Homogeneous rotation about a coordinate axis."""
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(4)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[i, j], matrix[j, i] = -np.sin(angle), np.sin(angle)
    return matrix


def shift(axis: str, distance: float) -> np.ndarray[Any, Any]:
    """Homogeneous translation along a coordinate axis."""
    matrix = np.eye(4)
    matrix["xyz".index(axis), 3] = distance
    return matrix


@pytest.mark.parametrize("number", range(4))
@pytest.mark.parametrize("increment", [0.0, 0.21, -0.4])
def test_machine_has_the_signs_of_the_conventions_page(number: int, increment: float) -> None:
    """The other program's chain of joints, with the table's signs, puts the cutter where ours does."""
    who, *cells = rows(text("conventions"), "### The same in HypoidFaceMilled")[number]
    tilt, swivel, offset, *orders = (1 if cell == "+" else -1 for i, cell in enumerate(cells) if i != 3)
    cradle = (-1.1 if cells[3].startswith("−") else 1.1) + increment
    pinion = who.startswith("pinion")
    left = who.endswith("left-hand") or (not pinion and "right-hand pinion" in who)
    # A gear has no tilt here: the page says why.
    i, j = (0.2, -0.6) if pinion else (0.0, 0.0)
    ours = MachineSettings(75.0, 1.1, 0.3, 4.0, 0.7, -1.3, i, j, 3.2, (0.03, 0.02, 0.05))

    powers = sum(s * c * increment ** (k + 2) for k, (s, c) in enumerate(zip(orders, ours.modified_roll, strict=True)))
    chain = (
        spin("z", -3.2 * (increment + powers)) @ shift("z", 1.3) @ spin("y", 0.3) @ shift("x", 0.7)
        @ shift("y", 4.0 * offset) @ spin("x", -cradle) @ shift("z", 75.0) @ spin("x", j * swivel) @ spin("z", i * tilt)
        @ np.array([[0.0, 0, -1, 0], [0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
    )  # fmt: skip

    sense: IncrementSense = -1 if pinion else 1
    still = np.zeros(1)
    pose = machine_pose(ours, np.array([-increment if left else increment]), sense)
    mirror = np.array([1.0, -1.0 if left else 1.0, 1.0])
    found = pose.to_member(pose.center, still, point=True)[:, 0] * mirror
    np.testing.assert_allclose(found, chain[:3, 3], rtol=0, atol=1e-12)
    found = pose.to_member(pose.frame[2], still, point=False)[:, 0] * mirror
    np.testing.assert_allclose(found, chain[:3, 2], rtol=0, atol=1e-13)


def test_senses_of_rotation_are_those_of_the_conventions_page() -> None:
    from easeoff.geometry.pair.ease_off import conjugate_motion

    case = easeoff.read_case("nasa-12x36")
    for hand, flanks, sense, seen in rows(text("conventions"), "## Hands, offset, flanks"):
        pinion = case.pinion.model_copy(update={"hand_of_spiral": hand.removesuffix("-hand")})
        pair = gear_pair(case.model_copy(update={"pinion": pinion}), "drive" if flanks == "drive" else "coast")
        middle = pair.gear.middle().position[:, 0]
        target = np.array([middle[2], np.hypot(middle[0], middle[1])])
        motion = conjugate_motion(pair.pinion.loaded, pair.pinion.section, pair.assembly, target)
        assert sense == ("in the positive sense" if motion.pinion_sense > 0 else "in the negative sense")
        # Seen from the heel one looks against z, so that positive is counter-clockwise.
        assert seen == ("counter-clockwise" if motion.pinion_sense > 0 else "clockwise")


def test_page_of_the_commands_lists_every_one() -> None:
    listed = {row[0].strip("`").split()[1] for row in rows(text("commands"), "The commands, each with `--help`:")}
    assert listed == set(main.commands)


def test_lubricant_of_the_page_is_one(tmp_path: Path) -> None:
    from easeoff.friction import lubricant
    from easeoff.friction.lubricants.lubricant import KEYS

    ((_, example),) = blocks(text("friction"), "toml")
    (tmp_path / "my_oil.toml").write_text(example, encoding="utf-8")
    oil = lubricant(tmp_path / "my_oil.toml")
    assert oil.at(70.0).viscosity == pytest.approx(0.0443)
    assert set(tomllib.loads(example)) == KEYS


#: Elements of a page that go beyond its column: at most 1 px of rounding, and where they can be moved to if `movable`.
TOO_WIDE = """(movable => {
  const column = document.querySelector('article').getBoundingClientRect(), found = [];
  const frame = e => {
    for (; e.tagName !== 'ARTICLE'; e = e.parentElement)
      if (['auto', 'scroll'].includes(getComputedStyle(e).overflowX)) return e;
  };
  for (const e of document.querySelectorAll('article :is(div.math, math, table, img, pre, code, p, dt)')) {
    const place = e.getBoundingClientRect(), around = frame(e);
    if (movable && around) {
      if (place.left + around.scrollLeft < around.getBoundingClientRect().left - 1) found.push(e);
    } else if (place.right > column.right + 1 || (around === e && e.scrollWidth > e.clientWidth + 1)) found.push(e);
  }
  return found.map(e => e.tagName + ' ' + (e.title || e.textContent).slice(0, 60));
})"""


@pytest.mark.thorough
@pytest.mark.parametrize(("width", "movable"), [(1300, False), (400, True)])
def test_nothing_on_the_site_is_cut(width: int, movable: bool) -> None:
    """Formulas, tables, pictures and lines of code keep to the column; in a narrow window they can be moved into it."""
    site = DOCS / "_build" / "html"
    built = sorted(path.relative_to(site) for path in site.rglob("*.html"))
    pages = [site / path for path in built if path.parts[0] not in ("_static", "search.html", "genindex.html")]
    if not pages or chromium() is None:
        pytest.skip("needs the site, make docs, and Chromium, apt-get install chromium")
    cut = {}
    with Browser() as browser:
        browser.resize(width, 900)
        for page in pages:
            browser.open(page)
            wide = browser.run(f"{TOO_WIDE}({str(movable).lower()})")
            if wide or browser.run("document.documentElement.scrollWidth") > width:
                cut[page.name] = wide
    assert cut == {}
