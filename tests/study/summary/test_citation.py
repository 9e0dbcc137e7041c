"""How the package is cited: file and command say the same, and a result names the sources of what it is made of."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
import yaml
from jsonschema import Draft7Validator
from places import DOCS, ROOT
from runs import output_of, refusal_of, small, text_file

import easeoff
from easeoff.cases.writing import case_toml
from easeoff.contact import SOLVERS, ContactProblem, write_problems
from easeoff.contact.problem.exchange.problem_file import read_attributes, read_labels
from easeoff.friction import COEFFICIENTS, FrictionModel
from easeoff.friction.conditions import FILM_FACTORS, FILMS, THERMAL_FACTORS
from easeoff.study.compare.comparison_table import comparison_table
from easeoff.study.summary.citation import (
    MODELS,
    OWN,
    WORKS,
    PublishedWork,
    ResultSource,
    citation,
    distinct_works,
    package,
    result_sources,
)

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def entries(text: str) -> dict[str, dict[str, str]]:
    """Entries of BibTeX by key, with their fields; braces must close."""
    found: dict[str, dict[str, str]] = {}
    for kind, key, body in re.findall(r"^@(\w+)\{([\w-]+),\n(.*?)^\}$", text, flags=re.MULTILINE | re.DOTALL):
        assert key not in found
        plain = re.sub(r"\\[{}]", "", body)
        assert plain.count("{") == plain.count("}")
        found[key] = {"kind": kind, **dict(re.findall(r"^  (\w+) = \{+(.*?)\}+,$", body, flags=re.MULTILINE))}
    assert len(found) == text.count("@")
    return found


def test_citation_file_is_valid() -> None:
    """By the schema 1.2.0 of the Citation File Format (CC-BY-4.0), as cffconvert ships it."""
    schema = json.loads((ROOT / "tests/data/cff_1.2.0_schema.json").read_text(encoding="utf-8"))
    # Dates aside, of which YAML makes more than text.
    assert [error.message for error in Draft7Validator(schema).iter_errors(CITATION)] == []


def test_citation_file_says_what_project_licence_and_command_say() -> None:
    assert CITATION["version"] == PROJECT["version"] == easeoff.__version__
    assert CITATION["license"] == PROJECT["license"]
    assert set(CITATION["keywords"]) == set(PROJECT["keywords"])
    (author,) = CITATION["authors"]
    assert PROJECT["authors"] == [author]
    assert f"the {author['name'].removeprefix('The ')}" in (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert package().fields["author"] == author["name"]
    assert package().fields["title"] == CITATION["title"]
    assert package().fields["note"] == f"version {PROJECT['version']}"
    (thesis,) = CITATION["references"]
    fields = WORKS["kolivand_2009"].fields
    assert (thesis["title"], str(thesis["year"])) == (fields["title"], fields["year"])
    assert thesis["institution"]["name"] == fields["school"]
    assert CITATION["repository-code"] == PROJECT["urls"]["Repository"]


def test_archive_is_told_what_the_citation_file_says() -> None:
    """Zenodo takes the second file in place of the first."""
    archived = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    assert archived["creators"] == CITATION["authors"]
    for name in ("title", "version", "keywords"):
        assert archived[name] == CITATION[name], name
    assert archived["license"] == CITATION["license"].lower()
    assert archived["description"] == f"<p>{CITATION['abstract']}</p>"
    (thesis,), (reference,) = CITATION["references"], archived["references"]
    assert all(part in reference for part in (thesis["title"], thesis["institution"]["name"], str(thesis["year"])))


def test_text_and_bibtex_name_program_and_dissertation() -> None:
    text, bibtex = citation(), entries(citation(bibtex=True))
    assert PROJECT["version"] in text
    assert "Kolivand" in text
    assert list(bibtex) == ["easeoff", "kolivand_2009"]
    assert bibtex["easeoff"]["author"] == "The easeoff developers"
    assert bibtex["kolivand_2009"]["kind"] == "phdthesis"


@pytest.mark.parametrize(
    ("attribute", "models", "without"),
    [
        ("friction_coefficient", COEFFICIENTS, {"constant"}),
        ("film", FILMS, set()),
        ("film_heating", FILM_FACTORS, {"none"}),
        ("thermal_factor", THERMAL_FACTORS, {"none"}),
    ],
)
def test_every_model_has_a_source(attribute: str, models: Iterable[str], without: set[str]) -> None:
    known = MODELS[attribute].keys() | OWN.keys() | without
    assert set(models) <= known
    assert MODELS[attribute].keys() <= set(models)


def test_sources_have_the_identifiers_of_the_pages() -> None:
    pages = "\n".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    for key in ("pan_1989", "goksem_1978", "murch_1975", "gupta_1992", "fritsch_1980"):
        assert WORKS[key].fields["doi"] in pages.replace("\n", " "), key


def test_a_result_names_its_own_sources() -> None:
    model = FrictionModel(coefficient="benedict_kelly")
    tree = easeoff.analyze(
        small("nasa-12x36", "shell"), torques=100.0, speed=1500.0, oil="pao-vg100", friction_model=model
    )
    found = {source.role: [work.key for work in source.works] for source in result_sources(tree)}
    assert found["pair, by its title"] == ["bibel_1994"]
    assert found["elastic teeth"] == ["kolivand_2009"]
    assert found["friction coefficient"] == ["benedict_1961"]
    assert found["oil"] == ["oil_pao_vg100"]
    assert "10.1177/1350650118778655" in citation(tree)
    bibtex = entries(citation(tree, bibtex=True))
    assert {"benedict_1961", "oil_pao_vg100", "pan_1989", "blok_1937"} <= bibtex.keys()
    assert "xu_2007" not in bibtex


def test_models_of_the_package_itself_are_told_by_their_pages() -> None:
    tree = xr.DataTree(xr.Dataset(attrs={"compliance_model": "solid_shell", "title": "my own pair"}))
    (_, teeth) = result_sources(tree)
    assert (teeth.model, teeth.works) == ("solid shell", ())
    pages = {page.name for page in (ROOT / "docs").rglob("*.md")}
    assert {word for remark in OWN.values() for word in remark.split() if word.endswith(".md")} <= pages


def test_what_an_oil_file_says_does_not_break_bibtex() -> None:
    oil = {"oil": "a/b c", "oil_title": r"100 % pure & cheap_oil {x} \end", "oil_source": "data sheet #3, 40-60 $"}
    tree = xr.DataTree.from_dict({"/friction": xr.Dataset(attrs=oil)})
    entry = entries(citation(tree, bibtex=True))["oil_a_b_c"]
    assert entry["title"] == r"100 \% pure \& cheap\_oil \{x\} \textbackslash{}end"
    assert entry["note"] == r"lubricant data: data sheet \#3, 40--60 \$"


def test_attributes_of_any_kind_and_length_are_taken() -> None:
    odd = {"title": [1.0, 2.0], "easeoff_version": [1, 2], "compliance_model": "x" * 10_000, "film": 3, "oil": ""}
    said = citation(xr.DataTree(xr.Dataset(attrs=odd | {"oil_source": "a\x1b[2Jb\nc" * 1000})))
    assert max(map(len, said.splitlines())) < 1000
    assert "\x1b" not in said


def test_command_prints_both_and_refuses_what_is_no_file(tmp_path: Path) -> None:
    assert "The easeoff developers" in output_of("cite")
    assert output_of("cite").startswith("If you publish results, please cite the program\n")
    assert list(entries(output_of("cite", "--bibtex"))) == ["easeoff", "kolivand_2009"]
    assert "there is no such file" in refusal_of("cite", tmp_path / "x.nc")


def test_work_without_author_is_named_by_its_title() -> None:
    oil = {"title": "Oil", "year": "2026"}
    assert PublishedWork("x", "misc", oil).text() == "Oil. 2026"
    assert PublishedWork("x", "misc", oil | {"note": "data sheet"}).text() == "Oil. 2026, data sheet"


def test_work_of_two_sources_is_cited_once() -> None:
    work = PublishedWork("x", "misc", {"title": "Oil", "year": "2026"})
    assert distinct_works([ResultSource("oil", "", (work,)), ResultSource("wear", "", (work,))]) == [work]


def test_library_file_and_comparison_name_what_they_are_of(tmp_path: Path) -> None:
    problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, [[1e-5, 0.0], [0.0, 1e-5]])
    about: dict[str, str | int | float] = {
        "title": "easeoff library of contact problems, part tiny",
        "library_version": 7,
        "checksum": "ab12",
    }
    write_problems([problem], tmp_path / "tiny.nc", {"name": ["two"]}, about)
    said = output_of("cite", tmp_path / "tiny.nc")
    assert "contact problems (version 7, part tiny): [1] library of this package, checksum of the content ab12" in said
    versions = json.dumps({"native": "0.1.0", "osqp": "1.1.3", "my_solver:fista": "unknown"})
    table = comparison_table([], 1e-5, {"solver_versions": versions})
    table.to_netcdf(tmp_path / "results.nc", engine="netcdf4")
    said = output_of("cite", tmp_path / "results.nc")
    assert "solver (osqp 1.1.3): [1]" in said
    assert "[1] B. Stellato et al.: OSQP. 2020, doi:10.1007/s12532-020-00179-2" in said
    assert "solver (my_solver:fista unknown): no published source" in said


def test_shipped_works_are_read_as_they_are_written() -> None:
    text = resources.files("easeoff.study.summary").joinpath("published_works.bib").read_text(encoding="utf-8")
    assert len(WORKS) == text.count("@")
    assert text.partition("\n\n")[2] == "\n".join(work.bibtex() for work in WORKS.values())


def test_works_of_solvers_are_those_of_the_bibliography() -> None:
    page = (ROOT / "docs" / "how_it_works" / "bibliography.md").read_text(encoding="utf-8")
    for key in filter(None, (solver.work for solver in SOLVERS.values())):
        assert WORKS[key].fields["doi"] in page, key


def test_problems_of_a_case_say_what_they_are(tmp_path: Path) -> None:
    """File, listing, exports and citation give the same names and the same pair."""
    case = text_file(tmp_path / "pair.toml", case_toml(small("nasa-12x36", "shell")))
    file, again = tmp_path / "problems.nc", tmp_path / "again.nc"
    output_of("problems", case, "--torque", "150", "--misalignment", "E=0.05", "-o", file)
    names = [f"pair-drive-150-{position}" for position in range(3)]
    assert read_labels(file)["name"].tolist() == names
    about = read_attributes(file)
    assert (about["case_name"], about["flank"], about["compliance_model"]) == ("pair", "drive", "shell")
    assert about["easeoff_version"] == package().fields["note"].removeprefix("version ")
    said = output_of("show", file)
    assert "3 contact problems of" in said
    assert "E 0.05 mm" in said
    assert re.search(r"torque about the gear axis +450 N m", said)  # 150 N m at the pinion of 12 x 36 teeth
    assert f"{names[0]} to {names[-1]}" in said
    output_of("convert", file, "-o", tmp_path / "qps", "--format", "qps")
    for name in names:
        text = (tmp_path / "qps" / f"{name}.qps").read_text(encoding="ascii")
        assert f"NAME {name}\n" in text
        assert f"* Problem: {name}\n" in text
    output_of("convert", file, "-o", again)
    assert read_attributes(again) == about
    assert "pair, by its title (nasa-12x36)" in output_of("cite", again)


# --- The paper


PAPER = (DOCS / "paper/paper.md").read_text(encoding="utf-8")
REFERENCES = (DOCS / "paper/paper.bib").read_text(encoding="utf-8")
_, FRONT, BODY = PAPER.split("---\n", 2)
SECTIONS = (
    *("Summary", "Statement of need", "State of the field", "Software design", "Verification"),
    *("Research impact statement", "AI usage disclosure", "Acknowledgements", "References"),
)
#: Figures of the paper, with what a page says in the same words or in a table.
FIGURES = {
    "1e-6 inch": "(`test_flank.py`) | 1e-6 inch",
    "1e-13 mm face-milled": "conjugate pinion of a Formate gear (`test_ease_off.py`) | 1e-13 mm",
    "1e-12 mm face-hobbed": "(`test_face_hobbing.py`, `test_blade.py`) | 1e-12 mm",
    "Of 298 printed values": "297 of 298 printed values (the other is a misprint)",
    "98,487 were certified": "contact_problems --count 100000`) 98,487 were certified",
    "42 of 153": "| osqp | 153 | 129 | 42 |",
    "125 of 154": "| clarabel | 154 | 154 | 125 |",
    "three of 2167 answers": "Of 2167 answers of the others that they call solved three are not certified",
    "within 0.3 % of the mean": "within 0.3 % of the mean",
    "4 % of its peak to peak and 0.9 %": "4 % or 0.5 µrad of the peak to peak, 0.5 % of the load in every share (0.9 %",
    "within 0.8 %": "0.8 % of the greatest pressure",
    "greatest line load is within 1.7 %": "0.8 % of the load in every share and 1.7 % of the greatest line load",
    "to $10^{-10}$ of the input": "losses with friction fed back (`test_efficiency.py`) | 1e-10 of the input",
    "within 21 %": "| 200 | 290, 240 | +21 %",
    "up to 34 % apart": "9.4, 14.2 | -34 %",
    "fourteen are met": "| across the line | 3 of 17 |",
    "510 contact problems": "510 [contact problems]",
}


def plain(text: str) -> str:
    """Text without emphasis and without the line breaks and columns of the file."""
    return " ".join(text.replace("**", "").split())


def keys(text: str) -> list[str]:
    return re.findall(r"^@\w+\{(\w+),$", text, flags=re.MULTILINE)


def test_front_matter_has_what_the_journal_asks_for() -> None:
    front: dict[str, Any] = yaml.safe_load(FRONT)
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} <= front.keys()
    assert "Python" in front["tags"]
    assert {author["affiliation"] for author in front["authors"]} <= {each["index"] for each in front["affiliations"]}
    assert (DOCS / "paper" / front["bibliography"]).exists()


def test_sections_and_length_are_those_of_the_journal() -> None:
    assert re.findall(r"^# (.*)$", BODY, flags=re.MULTILINE) == list(SECTIONS)
    words = re.sub(r"^```.*?^```$", "", BODY, flags=re.MULTILINE | re.DOTALL).split()
    assert 750 <= len(words) <= 1750


def test_references_resolve_and_all_are_cited() -> None:
    cited = set(re.findall(r"(?<![\w.])@(\w+)", re.sub(r"^```.*?^```$", "", BODY, flags=re.MULTILINE | re.DOTALL)))
    listed = keys(REFERENCES)
    assert sorted(set(listed)) == sorted(listed)
    assert cited == set(listed)


def test_references_are_well_formed() -> None:
    assert REFERENCES.count("{") == REFERENCES.count("}")
    entries = re.split(r"\n(?=@)", REFERENCES.strip())
    assert len(entries) == len(keys(REFERENCES))
    for entry in entries:
        assert "  title = {" in entry
        found = re.findall(r"^  doi = \{(.*)\},$", entry, flags=re.MULTILINE)
        assert all(re.fullmatch(r"10\.\d{4,5}/\S+", doi) for doi in found)
        assert found or "school" in entry or "institution" in entry or "howpublished" in entry or "ISO" in entry, entry


def test_figures_are_those_of_the_pages() -> None:
    pages = [plain(page.read_text(encoding="utf-8")) for page in DOCS.rglob("*.md") if page.parent.name != "paper"]
    paper = plain(BODY)
    for figure, source in FIGURES.items():
        assert figure in paper, figure
        assert any(source in page for page in pages), source
    told = re.sub(r"\[@[^]]*\]", "", paper.split("# Verification", 1)[1].split("# Research impact", 1)[0])
    covered = " ".join(
        (*FIGURES, "CR-191009", "ISO 23509", "100,000 random", "154 problems", "10^{-9}", "10^{-5}", "297 are")
    )
    assert set(re.findall(r"\d[\d,.]*\d|\d", told)) <= set(re.findall(r"\d[\d,.]*\d|\d", covered))


@pytest.mark.thorough
def test_code_runs(capsys: pytest.CaptureFixture[str]) -> None:
    namespace: dict[str, Any] = {}
    blocks = re.findall(r"^```python\n(.*?)^```$", BODY, flags=re.MULTILINE | re.DOTALL)
    assert len(blocks) == 1
    for code in blocks:
        exec(compile(code, "paper", "exec"), namespace)
    assert "microradians" in capsys.readouterr().out
    assert 0.9 < float(namespace["tree"]["friction/efficiency"].squeeze()) < 1.0
