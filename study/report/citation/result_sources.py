"""Published sources that a result rests on, by what its attributes say of pair, elastic teeth, friction and oil."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import xarray as xr

from ....core.errors import printable, shortened
from ....core.regular_file import parsed_json
from ...compare.comparison_table import FORMAT as COMPARISON_FORMAT
from ..model_name import MODEL_NAMES
from .published_work import WORKS, PublishedWork
from .solver_works import SOLVER_WORKS

#: Keys of works by the attribute and the model that it names.
MODELS: dict[str, dict[str, tuple[str, ...]]] = {
    "friction_coefficient": {
        **dict.fromkeys(("kolivand", "kolivand_blended"), ("kolivand_2009",)),
        **{"xu_kahraman": ("xu_2007",), "benedict_kelly": ("benedict_1961",)},
    },
    "film": {"pan_hamrock": ("pan_1989",), "dowson_higginson": ("dowson_1966",)},
    "film_heating": {"murch_wilson": ("murch_1975",), "gupta_cheng": ("gupta_1992",)},
    "thermal_factor": {
        "goksem_hargreaves": ("goksem_1978",),
        "murch_wilson": ("murch_1975",),
        "gupta_cheng": ("gupta_1992",),
    },
}
TEXT_LENGTH_LIMIT = 400  # of an attribute
WORDS = {
    "friction_coefficient": "friction coefficient",
    "film": "film thickness",
    "film_heating": "heat of the inlet, film",
    "thermal_factor": "heat of the inlet, rolling traction",
}
#: What the package has computed or made itself, with the page that describes it.
OWN = {
    "solid_shell": "model of this package, see finite_elements.md of its documentation",
    "fe": "model of this package, see finite_elements.md of its documentation",
    "mixed_lubrication": "formula of this package, see mixed_ehl.md of its documentation",
}

OWN_SOLVER = "solver of this package, see solvers.md of its documentation"


@dataclass(frozen=True)
class ResultSource:
    """What a result takes from a source.

    Parameters
    ----------
    role
        Part of the result.
    model
        Name of the model or of the data.
    works
        The sources; none if there is nothing published.
    remark
        Where else the model is described.
    """

    role: str
    model: str
    works: tuple[PublishedWork, ...] = ()
    remark: str = ""


def result_sources(tree: xr.DataTree) -> list[ResultSource]:
    """Sources that a result rests on, in the order of the method, each once.

    Parameters
    ----------
    tree
        Content of a file of any command; what its attributes do not tell is left out.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0], speed=1500.0)
    >>> [(source.role, source.model) for source in result_sources(tree)][1:3]
    [('pair, by its title', 'nasa-12x36'), ('elastic teeth', 'solid shell')]
    """
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
    from ....cases import shipped_cases

    title = _text(attributes, "title")
    for name, shipped in shipped_cases().items():
        if title == shipped:
            yield ResultSource(
                "pair, by its title", name, _works("bibel_1994" if name == "nasa-12x36" else "kolivand_2009")
            )


def _library(attributes: Mapping[Any, Any]) -> ResultSource:
    """The problem library, with what tells one file of it from another."""
    part = _text(attributes, "title").rpartition("part ")[2]
    checksum = _text(attributes, "checksum")
    model = f"version {_text(attributes, 'library_version')}, part {part}"
    remark = f"library of this package, checksum of the content {checksum}"
    return ResultSource("contact problems", model, _works("kolivand_2009"), remark)


def _solvers(attributes: Mapping[Any, Any]) -> Iterator[ResultSource]:
    """Solvers of a comparison, with their versions."""
    try:
        versions = parsed_json(str(attributes.get("solver_versions", "{}")))
    except ValueError:
        versions = {}
    for name, number in versions.items() if isinstance(versions, dict) else ():
        solver = shortened(printable(str(name)), TEXT_LENGTH_LIMIT)
        remark = OWN_SOLVER if solver == "native" else ""
        yield ResultSource("solver", f"{solver} {printable(str(number))}", SOLVER_WORKS.get(solver, ()), remark)


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
    """Works of the sources, each once.

    Examples
    --------
    >>> [work.key for work in distinct_works([ResultSource("wear", "", _works("archard_1953"))] * 2)]
    ['archard_1953']
    """
    return list({work.key: work for source in sources for work in source.works}.values())
