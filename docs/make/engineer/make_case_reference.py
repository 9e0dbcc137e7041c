"""Write the tables of keys of case and design files from the schemas that check these files.

``python docs/make case_reference`` updates the pages; with ``--print`` it only prints the tables.

After a change of the schema of cases or designs.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator

from alike_rows import in_few_rows
from annotated_types import MinLen
from folders import REFERENCE
from generated_part import with_generated
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from easeoff.cases import LoadCase
from easeoff.cases.schema import case_schema as model, cutting_table, design_schema as design_model
from easeoff.cases.schema.blank_design_table import BlankDesignTable
from easeoff.cases.schema.case_schema import DeflectionRow, MisalignmentTable
from easeoff.cases.schema.file_templates import allowed, described, sub_table, toml_value
from easeoff.cases.schema.friction_table import FrictionTable
from easeoff.cases.schema.supports_table import (
    BearingTable,
    HousingTable,
    MemberSupportTable,
    ShaftSectionTable,
    ShaftTable,
    SupportsTable,
)

PAGE, DESIGN_PAGE = REFERENCE / "case_file_keys.md", REFERENCE / "design_file_keys.md"


def updated(page: str) -> str:
    """The page with its generated part, between two comments, made anew."""
    return with_generated(page, "case keys", case_tables())


def updated_design(page: str) -> str:
    """The page of design files with its generated part made anew."""
    return with_generated(page, "design keys", design_tables())


def case_tables() -> str:
    """The tables of a case file and of all its sub-tables, as Markdown."""
    return "\n\n".join(f"{heading}\n\n{keys(table)}" for heading, table in sections())


def design_tables() -> str:
    """The tables of a design file that a case file does not have, as Markdown."""
    own = (
        ("### Top level", design_model.Design),
        ("### `[pinion]`", design_model.DesignedPinion),
        ("### `[pinion.limits]`", design_model.LimitsTable),
        ("### `[gear]`", design_model.DesignedGear),
        ("### `[cutter_steps]`", design_model.CutterStepsTable),
        ("### `[resolution]`", design_model.ResolutionTable),
    )
    return "\n\n".join(f"{heading}\n\n{keys(table)}" for heading, table in own)


def sections() -> Iterator[tuple[str, type[BaseModel]]]:
    """Heading and schema of every table, in the order of a case file."""
    yield "### Top level", model.Case
    yield "### `[pair]`", model.PairTable
    yield "### `[blank_design]`", BlankDesignTable
    yield "### `[pinion]` and `[gear]`", model.PinionTable
    yield "### `[pinion.blank]` and `[gear.blank]`", model.Blank
    yield "### `[pinion.concave.machine]` of every flank", cutting_table.Machine
    yield "### `[pinion.concave.machine.motions]` of every generated flank", cutting_table.Motions
    yield "### `[pinion.concave.cutter]` of every flank", cutting_table.Cutter
    yield "### `[pinion.material]` and `[gear.material]`", model.Steel
    yield "### `[misalignment]`", MisalignmentTable
    yield "### `[[misalignment.deflections]]`", DeflectionRow
    yield "### `[supports]`", SupportsTable
    yield "### `[supports.pinion]` and `[supports.gear]`", MemberSupportTable
    yield "### `[supports.pinion.shaft]` and `[supports.gear.shaft]`", ShaftTable
    yield "### `sections` of a shaft, a list of tables", ShaftSectionTable
    yield "### `[[supports.pinion.bearings]]` and `[[supports.gear.bearings]]`", BearingTable
    yield "### `[supports.housing]`", HousingTable
    yield "### `[contact]`", model.ContactTable
    yield "### `[compliance]`", model.ComplianceTable
    yield "### `[compliance.pinion_web]` and `[compliance.gear_web]`", model.WebTable
    yield "### `[friction]`", FrictionTable
    yield "### `[drawing]`", model.DrawingTable
    yield "### `[target.drive]` and `[target.coast]`", model.TargetTable
    yield "### `[[load_cases]]`", LoadCase


def keys(table: type[BaseModel]) -> str:
    """Rows of the keys that are no tables, of those that are alike one; a meaning that is the key is left out."""
    found: list[tuple[str, str, str, str]] = []
    for name, field in table.model_fields.items():
        if not sub_table(field.annotation):
            meaning, unit = described(field)
            said = "" if meaning == name.replace("_", " ") else meaning
            found.append((f"`{name}`", said, unit and f" [{unit}]", f"{allowed(name, field)} | {default(field)}"))
    rows = ["| key | meaning | allowed | default |", "| --- | --- | --- | --- |"]
    for group, said in in_few_rows(found, meaning=lambda row: row[1], alike=lambda row: row[2:]):
        names = ", ".join(row[0] for row in group)
        rows.append(f"| {names}{group[0][2]} | {said} | {group[0][3]} |")
    return "\n".join(rows)


def default(field: FieldInfo) -> str:
    """Default of a key; nothing for one that may be left out."""
    if field.is_required():
        return "**required**"
    if field.default is None or (field.default == () and any(isinstance(limit, MinLen) for limit in field.metadata)):
        return ""
    if isinstance(field.default, tuple) and len(field.default) == 1:
        return f"`{toml_value(field.default[0])}`"
    if isinstance(field.default, tuple):
        return f"`{list(field.default)}`"
    return f"`{toml_value(field.default)}`"


def main() -> None:
    """Print the tables or update the page."""
    if "--print" in sys.argv[1:]:
        print(case_tables(), design_tables(), sep="\n\n")
        return
    DESIGN_PAGE.write_text(updated_design(DESIGN_PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
