"""The paper: its references resolve, its code runs, and its figures are those of the pages."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

DOCS = Path(__file__).parents[1] / "docs"
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
    "OSQP 123": "| osqp | 134 | 134 | 134 | 123 |",
    "Clarabel 36": "| clarabel | 134 | 134 | 130 | 36 |",
    "all of fifteen other solvers but one": "all but `lemke` call answers solved that miss 10⁻⁵",
    "one of 1917 answers": "one of 1917 answers called solved is not certified",
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
        (*FIGURES, "CR-191009", "ISO 23509", "100,000 random", "134 problems", "10^{-9}", "10^{-5}", "297 are")
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
