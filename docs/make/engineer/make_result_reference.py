"""Write the summary of ``easeoff show`` in ``results.md``, and the tables of variables in ``result_variables.md``.

The summary is that of a shipped case, the tables are from a coarse analysis of one.

``python docs/make result_reference`` updates the pages; with ``--print`` it only prints the tables.

After a change of a result's variables or of what ``easeoff show`` prints.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Hashable, Mapping

import xarray as xr
from alike_rows import in_few_rows
from folders import REFERENCE
from generated_part import with_generated

import easeoff
from easeoff.cases import gear_pair
from easeoff.cases.schema.case_schema import ComplianceTable, ContactTable
from easeoff.geometry import GlobalErrors, deviation_from_formula
from easeoff.study.summary.result_summary import result_summary

PAGE, VARIABLES_PAGE = REFERENCE / "results.md", REFERENCE / "result_variables.md"
CHOSEN = ("setting", "setting_units", "objective", "quantity_limit")  # texts that depend on what was asked for
CERTIFICATE = "[certificate](../../researcher/contact_problems.md#what-the-certificate-proves)"
COARSE = ContactTable(torques=(100.0,), mesh_positions=3, segments_per_line=3, lengthwise_nodes=7, profile_nodes=7)


def coarse_analysis() -> xr.DataTree:
    """A quick analysis with finite elements, friction and deviations, and the groups of a quick optimization.

    That is more than one result ever has: the variables of any, with few numbers.
    """
    changed = {"contact": COARSE, "compliance": ComplianceTable(model="fe", fineness=0.2, neighbours=False)}
    case = easeoff.read_case("fm-11x41").model_copy(update=changed)
    case = case.with_tables(pinion={"mean_normal_circular_thickness": 8.0})
    worn = deviation_from_formula(gear_pair(case).pinion.section, GlobalErrors(twist=1.0))
    tree = easeoff.analyze(case, speed=1500.0, friction_feedback=True, deviations={"pinion": worn})
    shells = case.model_copy(update={"compliance": ComplianceTable(model="shell")})
    best = easeoff.modify(shells, order=2, programmes=1)
    further = {name: best[name] for name in ("modification", "optimization")}
    front = easeoff.optimize(
        case,
        form="pareto",
        points=2,
        steps=1,
        limits=["ease_off_change<=9"],
        free=["pinion.concave.machine.radial_distance"],
        spread={"E": "uniform(-0.01,0.01)"},
        samples=1,
    )
    further |= {name: front[name] for name in ("optimal_settings", "front")}
    return tree.assign(further | {"supports": easeoff.analyze(shells, supports="axle-fm-11x41")["supports"]})


def result_tables(tree: xr.DataTree) -> str:
    """One table a group of the tree, or for groups with the same variables, and one of the coordinates of all."""
    groups = {name: tree[name].to_dataset() for name in tree.children}
    coordinates = {name: values for group in groups.values() for name, values in group.coords.items()}
    tables = {f"`/{name}`": dict(group.data_vars) for name, group in groups.items()} | {"Coordinates": coordinates}
    heads: dict[str, list[str]] = {}
    for head, variables in tables.items():
        heads.setdefault(described(variables), []).append(head)
    return codes_once("\n\n".join(f"### {', '.join(names)}\n\n{made}" for made, names in heads.items()))


def described(variables: Mapping[Hashable, xr.DataArray]) -> str:
    """Rows of variables behind a row with the dimensions that they have; one row for those that are alike."""
    found: dict[str, list[tuple[str, str, str]]] = {}
    for name, variable in variables.items():
        dimensions = ", ".join(map(str, variable.dims))
        over = "" if variable.dims == (name,) else f"over {dimensions}" if dimensions else "single values"
        said = meaning(name, variable)
        entry = CERTIFICATE if said.startswith("certificate: ") else said
        found.setdefault(over, []).append((f"`{name}`", unit(variable), entry))
    rows = ["| variable | meaning |", "| --- | --- |"]
    for over, each in found.items():
        rows += [f"| *{over}* | |"] * bool(over)
        for group, said in in_few_rows(each, meaning=lambda row: row[2], alike=lambda row: row[1]):
            names = ", ".join(row[0] for row in group)
            rows.append(f"| {names}{group[0][1]} | {said} |")
    return "\n".join(rows)


def codes_once(tables: str) -> str:
    """The tables with each list of codes where it comes first; then the name of the variable and the group there."""
    first: dict[str, str] = {}
    lines, head = [], ""
    for line in tables.splitlines():
        head = line.removeprefix("### ").split(", ")[-1] if line.startswith("### ") else head
        row = re.fullmatch(r"\| `(\w+)` \| ([^:|]*): (-?\d+ `[^|]*`) \|", line)
        if row and row[3] in first:
            line = f"| `{row[1]}` | {row[2]}: codes of {first[row[3]]} |"
        elif row:
            first[row[3]] = f"`{row[1]}` in {head}"
        lines.append(line)
    return "\n".join(lines)


def unit(variable: xr.DataArray) -> str:
    """Its unit in brackets, to stand behind its name; nothing for a pure number."""
    units = variable.attrs.get("units", "1")
    return "" if units == "1" else f" [{units}]"


def meaning(name: Hashable, variable: xr.DataArray) -> str:
    """Its long name, unless that is its name, and its comment; its codes or labels."""
    label, comment = str(variable.attrs["long_name"]), variable.attrs.get("comment")
    same = label.replace("-", " ") == str(name).replace("_", " ")
    said = "; ".join(filter(None, [label if comment is None or not same else "", comment]))
    if "flag_meanings" in variable.attrs:
        codes = variable.attrs["flag_values" if "flag_values" in variable.attrs else "flag_masks"]
        flags = zip(codes, variable.attrs["flag_meanings"].split(), strict=True)
        text = ", ".join(f"{value} `{word}`" for value, word in flags)
        return f"{said}: {text}"
    if variable.dtype.kind == "U" and name in variable.coords and name not in CHOSEN:
        said += ": " + ", ".join(f"`{word}`" for word in variable.values)
    return said


def summary() -> str:
    """What ``easeoff show`` prints of the page's first example, but without load, notes and the residual."""
    printed, *_ = result_summary(easeoff.analyze("nasa-12x36", torques=[150.0])).partition("\n\nNote: ")
    head, _, rest = printed.partition("\n\nWithout load\n")
    loaded = f"{head}\n\n...\n\nUnder load{rest.partition(chr(10) + 'Under load')[2]}"
    lines = (line for line in loaded.splitlines() if not line.startswith("worst residual"))
    return "\n".join(["```text", *lines, "```"])


def main() -> None:
    """Print the tables or update the pages."""
    tree = coarse_analysis()
    if "--print" in sys.argv[1:]:
        print(result_tables(tree))
        return
    for page, name, made in ((PAGE, "summary", summary()), (VARIABLES_PAGE, "variables", result_tables(tree))):
        page.write_text(with_generated(page.read_text(encoding="utf-8"), name, made), encoding="utf-8")


if __name__ == "__main__":
    main()
