"""Templates of ``easeoff new``: each is read by its reader and runs, and has every key of its schema."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel
from runs import output_of, refusal_of, text_file

import easeoff
from easeoff.cases import (
    Case,
    Design,
    LoadCase,
    parse_case,
    parse_design,
    read_case,
    read_design,
    read_load_cases,
    read_supports,
    with_supports,
)
from easeoff.cases.reading import SUPPORT
from easeoff.cases.schema.file_templates import TEMPLATE_KINDS, template, template_text, toml_value
from easeoff.cases.schema.schema_table import inner_table, number
from easeoff.cases.schema.supports_table import SupportFile
from easeoff.core.errors import InputError
from easeoff.friction.lubricants.lubricant import KEYS, lubricant
from easeoff.study import design_case

HEAD = re.compile(r"(#?)\[\[?([\w.]+)\]\]?(?: +# keys as in \[([\w.]+)\])?$")
KEY = re.compile(r"(#?)(\w+) =(.*)")
FURTHER = re.compile(r"# further keys as in \[([\w.]+)\]")
OF_SCHEMA = [("case", Case), ("design", Design), ("supports", SupportFile)]
#: Designs with usual targets instead of those of the pair that their basic data are from.
USUAL = [("design", "face-milled"), ("design", "face-hobbed")]
NAMES = [(kind, name) for kind, model in OF_SCHEMA for name in TEMPLATE_KINDS[kind].names()]


def parsed(kind: str, text: str) -> Any:
    read: dict[str, Any] = {
        "case": parse_case,
        "design": parse_design,
        "supports": lambda text: SUPPORT.parse(text, "template", None),
    }
    return read[kind](text)


def tables(text: str) -> tuple[dict[str, set[str]], dict[str, str]]:
    """Keys by table, switched off or not, and the table that another one refers to."""
    keys: dict[str, set[str]] = {"": set()}
    others = {}
    at = ""
    for line in text.splitlines():
        if head := HEAD.match(line):
            at = head[2]
            keys.setdefault(at, set())
            if head[3]:
                others[at] = head[3]
        elif further := FURTHER.match(line):
            others[at] = further[1]
        elif key := KEY.match(line):
            keys[at].add(key[2])
    return keys, others


def schema_tables(model: type[BaseModel], path: str = "") -> dict[str, set[str]]:
    """Keys that hold values by table of a schema."""
    found: dict[str, set[str]] = {path: set()}
    for name, field in model.model_fields.items():
        inner = inner_table(field.annotation, listed=True)
        if inner is None or name == "sections":  # which stand in one line each
            found[path].add(name)
        else:
            found |= schema_tables(inner, f"{path}.{name}" if path else name)
    return found


@pytest.mark.parametrize(("kind", "model"), OF_SCHEMA)
@pytest.mark.parametrize("process", [0, 1])
def test_every_key_of_the_schema_is_there(kind: str, model: type[BaseModel], process: int) -> None:
    text = template(kind, TEMPLATE_KINDS[kind].names()[process])
    keys, others = tables(text)
    for path, wanted in schema_tables(model).items():
        if kind == "case" and path.split(".")[0] in ("supports", "blank_design"):
            assert f"# [{path.split('.')[0]}]: " in text  # says which template has them
        elif wanted:
            assert path in keys
            assert wanted == keys[path] or wanted == keys[others[path]], path
    known = schema_tables(model)
    assert all(found <= known[path] for path, found in keys.items())


def test_a_new_key_of_a_schema_comes_by_itself() -> None:
    class Steel(BaseModel):
        """A table with a key that no template knows."""

        hardness: float = number("surface hardness", "HV", default=700.0)

    assert template_text(Steel, {}) == "#hardness = 700.0                    # surface hardness [HV]"


@pytest.mark.parametrize(("process", "origin"), [("face-milled", "fm-11x41"), ("face-hobbed", "fh-design-b")])
def test_a_design_has_the_basic_data_of_a_pair_and_nothing_else_of_it(process: str, origin: str) -> None:
    found, example = parse_design(template("design", process)), read_design(origin)
    influence = {"limit_pressure_angle_influence": 1.0}
    assert found.blank_design == example.blank_design.model_copy(update=influence)
    assert found.pair == example.pair
    assert found.misalignment == Design.model_fields["misalignment"].default
    assert found.cutter_steps == Design.model_fields["cutter_steps"].default
    assert min(value for _, value in found.cutter_steps) > 0.0
    assert found.pinion.tool_edge_radius is None
    assert found.gear.tool_edge_radius is None
    for target in (found.target.drive, found.target.coast):
        assert target.model_dump(exclude_unset=True) == {"lengthwise_crowning": 60.0, "profile_crowning": 15.0}


@pytest.mark.thorough
def test_other_basic_data_in_the_template_make_a_pair_near_its_target() -> None:
    text = template("design")
    changes = {
        "hypoid_offset = 20.0": "hypoid_offset = 35.0",
        "gear_outer_pitch_diameter = 211.8355": "gear_outer_pitch_diameter = 220.0",
        "gear_face_width = 34.5": "gear_face_width = 34.0",
        "number_of_teeth = 11": "number_of_teeth = 9",
        "number_of_teeth = 41": "number_of_teeth = 37",
    }
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    _, report = design_case(parse_design(text))
    assert all(side.largest_residual < 0.006 for side in report.sides.values())


@pytest.mark.parametrize(("kind", "name"), [one for one in NAMES if one not in USUAL])
def test_a_template_reads_as_what_its_numbers_are_from(kind: str, name: str) -> None:
    shipped: dict[str, Any] = {"case": read_case, "design": read_design, "supports": SUPPORT.read}
    text = template(kind, name)
    found = parsed(kind, text)
    assert found.description == ""  # it would go into the case that a design makes
    head = re.sub(r"\n# ", " ", text.partition("\n\n")[0])
    origin = re.search(r"(?:Numbers|Basic data) of the shipped \w+ (\S+),", head)
    assert origin is not None
    wanted = shipped[kind](origin[1])
    both = [one.model_dump(exclude={"title", "description"}) for one in (found, wanted)]
    assert both[0] == both[1]
    if kind == "design":
        assert ("[cutter_steps] are zero" in head) == (not wanted.cutter_steps.blade_angle)


@pytest.mark.parametrize(("kind", "name"), NAMES)
def test_keys_switched_off_show_their_defaults(kind: str, name: str) -> None:
    """Switched on they change nothing."""
    lines = template(kind, name).splitlines()
    text = []
    off = False  # whether the table has keys that must be given, and stays switched off
    for line in lines:
        if head := HEAD.match(line):
            first = KEY.match(next((one for one in lines[lines.index(line) + 1 :] if KEY.match(one)), ""))
            off = bool(head[1]) and (bool(head[3]) or first is None or not first[3].split("#")[0].strip())
            text.append(line if off else line.removeprefix("#"))
            continue
        key = KEY.match(line)
        has_value = key is not None and bool(key[3].split("#")[0].strip())
        text.append(line.removeprefix("#") if has_value and not off else line)
    assert sum(line.startswith("#") for line in text) < sum(line.startswith("#") for line in lines)
    found, wanted = parsed(kind, "\n".join(text)), parsed(kind, "\n".join(lines))
    tables = [one.model_dump() for one in (found, wanted)]
    if kind == "case" and wanted.target.drive is None:  # a table that is there is a target, if of zeros
        assert {one.pop("target")["coast"] for one in tables} == {None}
    assert tables[0] == tables[1]


def test_processes_are_those_that_they_are_called_by() -> None:
    for name, process in (("face-milled", "face_milled"), ("face-hobbed", "face_hobbed")):
        assert parse_design(template("design", name)).blank_design.process == process
        case = parse_case(template("case", name))
        assert case.gear.convex is not None
        assert (case.gear.convex.cutter.number_of_blade_groups > 0) == (name == "face-hobbed")
    assert template("case") == template("case", "face-milled")


def test_an_oil_has_every_key_and_is_the_shipped_one(tmp_path: Path) -> None:
    path = text_file(tmp_path / "mine.toml", template("oil", "pao-vg100"))
    assert {key[2] for line in path.read_text().splitlines() if (key := KEY.match(line))} == KEYS
    for temperature in (40.0, 90.0):
        states = [lubricant(name).at(temperature).viscosity for name in (path, "pao-vg100")]
        assert states[0] == pytest.approx(states[1], rel=1e-5)


def test_load_cases_have_every_column_and_the_torques_of_the_case(tmp_path: Path) -> None:
    path = text_file(tmp_path / "duty.csv", template("load-cases", "nasa-12x36"))
    found = read_load_cases(path)
    assert [one.torque for one in found] == list(read_case("nasa-12x36").contact.torques)
    given = set().union(*(one.model_fields_set for one in found))
    assert given == set(LoadCase.model_fields)


@pytest.mark.parametrize(("kind", "name"), [("bearing", None), ("case", "nasa"), ("oil", "fm-11x41")])
def test_an_unknown_kind_or_name_is_a_mistake(kind: str, name: str | None) -> None:
    with pytest.raises(InputError, match=r"(kind|name) = '\S+': must be one of "):
        template(kind, name)


@pytest.mark.thorough
def test_what_is_written_is_used_as_the_command_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ends = []
    for kind in TEMPLATE_KINDS:
        suffix = TEMPLATE_KINDS[kind].suffix
        said = output_of("new", kind, "-o", f"my-{kind}{suffix}")
        wrote, following = said.splitlines()
        assert wrote == f"wrote my-{kind}{suffix}"
        ends.append(following.removeprefix("next: easeoff ").split())
    case = Path("my-case.toml")
    text = case.read_text(encoding="utf-8")
    for key, value in (
        ("mesh_positions", 3), ("segments_per_line", 9), ("lengthwise_nodes", 11), ("profile_nodes", 9)
    ):  # fmt: skip
        text = re.sub(rf"#{key} = \d+", f"{key} = {value}", text)
    case.write_text(text, encoding="utf-8")
    used = [words for words in ends if words[0] == "run"]
    assert len(used) == len(ends) - 1  # of the design a case is made, which takes longer
    options = [word for words in used for word in words[4:] if "--load-cases" not in words]
    shared = ["--torque", "100", *options]
    output_of("run", case, "-o", "out.nc", *(["1000" if word == "SPEED" else word for word in shared]))
    tree = easeoff.read_result("out.nc")
    assert "supports" in tree.children
    assert tree["friction"].attrs["oil"] == "my-oil"
    output_of("run", case, "-o", "duty.nc", *used[-1][4:])
    found = easeoff.read_result("duty.nc")["load_cases"].to_dataset()
    assert found["load_case"].values.tolist() == ["cruise", "climb", "launch"]


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["face-milled", "face-hobbed"])
def test_a_design_makes_a_case(name: str) -> None:
    case, _ = design_case(parse_design(template("design", name)))
    assert case.title == "My pair"


def test_supports_hold_the_pair_that_they_are_of(tmp_path: Path) -> None:
    for case in ("fm-11x41", "nasa-12x36"):
        (name,) = (one for one in TEMPLATE_KINDS["supports"].names() if case in one)
        path = text_file(tmp_path / f"{name}-mine.toml", template("supports", name))
        assert with_supports(read_case(case), path).supports == read_supports(name)


def test_an_edited_file_is_not_replaced_unless_forced(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    output_of("new", "case", "-o", path)
    output_of("new", "case", "face-hobbed", "-o", path)
    edited = path.read_text(encoding="utf-8").replace("My pair", "Ours")
    path.write_text(edited, encoding="utf-8")
    said = refusal_of("new", "case", "-o", path)
    assert "was edited after easeoff wrote it" in said
    assert path.read_text(encoding="utf-8") == edited
    output_of("new", "case", "-o", path, "--force")
    assert "Ours" not in path.read_text(encoding="utf-8")


def test_a_name_with_another_suffix_is_a_mistake(tmp_path: Path) -> None:
    for kind, name in (("case", "mine.nc"), ("load-cases", "mine.toml")):
        said = refusal_of("new", kind, "-o", tmp_path / name)
        assert f"must be a name that ends in {TEMPLATE_KINDS[kind].suffix}" in said
        assert not (tmp_path / name).exists()


def test_nested_values_stand_in_one_line_of_toml() -> None:
    assert toml_value({"start": 1.0, "ends": [True, "a"]}) == '{ start = 1.0, ends = [true, "a"] }'
