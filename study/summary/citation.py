"""Citation of the program and of the sources of a result, as text and BibTeX of ``easeoff cite``.

A result rests on published works by what its attributes say of pair, elastic teeth, friction, oil and solver.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib import resources
from importlib.metadata import version
from typing import Any

import xarray as xr

from ...core.errors import printable, shortened
from ...core.regular_file import parsed_json
from ..analysis.key_numbers import MODEL_NAMES
from ..compare.comparison_table import FORMAT as COMPARISON_FORMAT
from .quantities import TABLES

#: Fields of a BibTeX entry that locate a work, in the order of a line of text, with what stands before each.
PLACES = {"journal": "", "booktitle": "", "school": "", "institution": "", "number": "no. ", "volume": "vol. "}
SPECIAL = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


@dataclass(frozen=True)
class PublishedWork:
    """Published work, or a file that names its own source, as an entry of BibTeX."""

    key: str
    kind: str  # article, phdthesis, misc, ...
    fields: Mapping[str, str] = field(hash=False)  # of the entry, in plain text; authors separated by 'and'

    def text(self) -> str:
        """One line for a list of references."""
        fields = self.fields
        places = [f"{before}{fields[name]}" for name, before in PLACES.items() if name in fields]
        said = [*places, *(fields[name] for name in ("year", "pages", "note") if name in fields)]
        said += [f"doi:{fields['doi']}"] if "doi" in fields else []
        authors = fields.get("author", "").replace(" and others", " et al.").replace(" and ", ", ")
        head = f"{authors}: {fields['title']}" if authors else fields["title"]
        return f"{head}. {', '.join(said)}" if said else head

    def bibtex(self) -> str:
        """Entry of a BibTeX file, ended by a line feed."""
        rows = []
        for name, value in self.fields.items():
            words = value if name == "doi" else _escaped(value)
            whole = name == "title" or (name == "author" and " and " not in value and "." not in value)
            rows.append(f"  {name} = {{{{{words}}}}},\n" if whole else f"  {name} = {{{words}}},\n")
        return f"@{self.kind}{{{self.key},\n{''.join(rows)}}}\n"


def _escaped(text: str) -> str:
    """Text in which TeX sees no command."""
    text = re.sub(r"[\\~^]|[&%$#_{}]", lambda match: SPECIAL.get(match[0], "\\" + match[0]), text)
    return re.sub(r"(\d)-(\d)", r"\1--\2", text)


def package() -> PublishedWork:
    """The package itself, as ``CITATION.cff`` has it."""
    fields = {
        "author": "The easeoff developers",
        "title": "easeoff: contact of spiral bevel and hypoid gears",
        "year": "2026",
        "note": f"version {version('easeoff')}",
    }
    return PublishedWork("easeoff", "misc", fields)


def _works_of(text: str) -> dict[str, PublishedWork]:
    """Works of a BibTeX file that is laid out as `PublishedWork.bibtex` lays it out, by their keys."""
    works = {}
    for kind, key, body in re.findall(r"^@(\w+)\{(\w+),\n(.*?)^\}$", text, re.MULTILINE | re.DOTALL):
        fields = dict(re.findall(r"^  (\w+) = \{+(.*?)\}+,$", body, re.MULTILINE))
        plain = {name: re.sub(r"\\([&%$#_])", r"\1", value).replace("--", "-") for name, value in fields.items()}
        works[key] = PublishedWork(key, kind, plain)
    return works


WORKS = _works_of(resources.files(__package__).joinpath("published_works.bib").read_text(encoding="utf-8"))

#: Keys of works by the attribute and the model that it names.
MODELS: dict[str, dict[str, list[str]]] = TABLES["models"]
TEXT_LENGTH_LIMIT = 400  # of an attribute
WORDS: dict[str, str] = TABLES["model_words"]
#: What the package has computed or made itself, with the page that describes it.
OWN = {
    "solid_shell": "model of this package, see finite_elements.md of its documentation",
    "fe": "model of this package, see finite_elements.md of its documentation",
    "mixed_lubrication": "formula of this package, see mixed_ehl.md of its documentation",
}

OWN_SOLVER = "solver of this package, see solvers.md of its documentation"


@dataclass(frozen=True)
class ResultSource:
    """Source of a part of a result; without works if there is nothing published."""

    role: str
    model: str
    works: tuple[PublishedWork, ...] = ()
    remark: str = ""  # another place where the model is described


def result_sources(tree: xr.DataTree) -> list[ResultSource]:
    """Sources that a result rests on, as far as its attributes tell, in the order of the method, each once."""
    return list(dict.fromkeys(source for node in tree.subtree for source in _of_node(node)))


def _of_node(node: xr.DataTree) -> Iterator[ResultSource]:
    attributes = node.attrs
    if _text(attributes, "format") == COMPARISON_FORMAT:
        yield from _solvers(attributes)
        return
    if "library_version" in attributes:
        yield _library(attributes)
        return
    if node.parent is None:
        yield ResultSource("ease-off and load distribution", "", _works("kolivand_2009"))
        yield from _pair(attributes)
        model = _text(attributes, "compliance_model")
        if model:
            known = _works("kolivand_2009") if model == "shell" else ()
            yield ResultSource("elastic teeth", MODEL_NAMES.get(model, model), known, OWN.get(model, ""))
    if "deflections" in attributes:
        yield ResultSource("interpolation of deflections", "monotone cubic", _works("fritsch_1980"))
    if "wear_depth" in node.dataset:
        yield ResultSource("wear", "Archard's law", _works("archard_1953"))
    for name, models in MODELS.items():
        model = _text(attributes, name)
        if model not in ("", "none"):
            yield ResultSource(WORDS[name], model, _works(*models.get(model, ())), OWN.get(model, ""))
    if "max_flash_temperature" in node.dataset:
        yield ResultSource("flash temperature", "", _works("blok_1937", "jaeger_1942"))
    if "oil" in attributes:
        yield _oil(attributes)


def _text(attributes: Mapping[Any, Any], name: str) -> str:
    """An attribute in one line of bounded length; empty if there is none."""
    return shortened(printable(str(attributes.get(name, ""))), TEXT_LENGTH_LIMIT)


def _works(*keys: str) -> tuple[PublishedWork, ...]:
    return tuple(WORKS[key] for key in keys)


def _pair(attributes: Mapping[Any, Any]) -> Iterator[ResultSource]:
    """The source of a shipped pair, known by its title."""
    from ...cases import shipped_cases

    title = _text(attributes, "title")
    for name, shipped in shipped_cases().items():
        if title == shipped:
            key = "bibel_1994" if name == "nasa-12x36" else "kolivand_2009"
            yield ResultSource("pair, by its title", name, _works(key))


def _library(attributes: Mapping[Any, Any]) -> ResultSource:
    """The problem library, with what tells one file of it from another."""
    part = _text(attributes, "title").rpartition("part ")[2]
    checksum = _text(attributes, "checksum")
    model = f"version {_text(attributes, 'library_version')}, part {part}"
    remark = f"library of this package, checksum of the content {checksum}"
    return ResultSource("contact problems", model, _works("kolivand_2009"), remark)


def _solvers(attributes: Mapping[Any, Any]) -> Iterator[ResultSource]:
    """Solvers of a comparison, with their versions."""
    from ...contact.solvers.solver_table import SOLVERS

    try:
        versions = parsed_json(str(attributes.get("solver_versions", "{}")))
    except ValueError:
        versions = {}
    for name, number in versions.items() if isinstance(versions, dict) else ():
        solver = shortened(printable(str(name)), TEXT_LENGTH_LIMIT)
        remark = OWN_SOLVER if solver == "native" else ""
        works = _works(SOLVERS[solver].work) if solver in SOLVERS and SOLVERS[solver].work else ()
        yield ResultSource("solver", f"{solver} {printable(str(number))}", works, remark)


def _oil(attributes: Mapping[Any, Any]) -> ResultSource:
    """An oil with the source that its file names."""
    name, source = _text(attributes, "oil"), _text(attributes, "oil_source")
    if source.startswith("M. Kolivand, dissertation"):
        return ResultSource("oil", name, _works("kolivand_2009"))
    if not source:
        return ResultSource("oil", name)
    key = "oil_" + re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")
    fields = {"title": _text(attributes, "oil_title") or name, "note": f"lubricant data: {source}"}
    return ResultSource("oil", name, (PublishedWork(key, "misc", fields),))


def distinct_works(sources: list[ResultSource]) -> list[PublishedWork]:
    """Works of the sources, each once."""
    return list({work.key: work for source in sources for work in source.works}.values())


def citation(tree: xr.DataTree | None = None, *, bibtex: bool = False) -> str:
    """Advice on citing the package, and with a result its sources, as text or as entries of BibTeX."""
    sources = [] if tree is None else result_sources(tree)
    method = WORKS["kolivand_2009"]
    if bibtex:
        works = {work.key: work for work in (package(), method, *distinct_works(sources))}
        return "\n".join(work.bibtex() for work in works.values()).rstrip("\n")
    lines = [
        "If you publish results, please cite the program",
        f"  {package().text()}",
        "and the dissertation whose method it follows",
        f"  {method.text()}",
    ]
    if tree is None:
        return "\n".join([*lines, "'easeoff cite RESULT' names the sources that a result rests on."])
    made = tree.attrs.get("easeoff_version", "")
    lines += [f"This result was made by version {shortened(str(made))}."] if isinstance(made, str) and made else []
    listed = distinct_works(sources)
    numbers = {work.key: number for number, work in enumerate(listed, start=1)}
    lines += ["", "The result rests on"]
    for source in sources:
        marks = "".join(f"[{numbers[work.key]}]" for work in source.works)
        said = " ".join(part for part in (marks, source.remark) if part) or "no published source"
        lines.append(f"  {source.role}{f' ({source.model})' if source.model else ''}: {said}")
    if "friction" not in tree.children and "efficiency" in tree.dataset:
        lines.append("  friction: this file does not tell its models; they are those of the command or of the case")
    return "\n".join([*lines, "", *(f"[{number}] {work.text()}" for number, work in enumerate(listed, start=1))])
