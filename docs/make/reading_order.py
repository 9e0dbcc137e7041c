"""The reading order of the site. Pages themselves are plain Markdown, so that they read as well on a code host."""

from __future__ import annotations

import re
from pathlib import Path

from folders import DOCS
from reference_pages import PACKAGES
from sphinx.application import Sphinx

#: Pages that an index leads to: captions with pages, in the order in which they are read.
READING_ORDER = {
    "index": {"": ["engineer/index", "researcher/index", "python/index", "how_it_works/index"]},
    "engineer/index": {
        "Tutorials": [
            "tutorials/drawing_to_pattern",
            "tutorials/vh_check",
            "tutorials/measured_flanks",
            "tutorials/strength_and_efficiency",
            "tutorials/shafts_and_bearings",
        ],
        "Designs": ["designs/milled_axle", "designs/hobbed_axle", "designs/aerospace_pair"],
        "Guides": [
            "guides/report",
            "guides/backlash",
            "guides/load_cases",
            "guides/sweeps",
            "guides/deflections",
            "guides/supports",
            "guides/real_flanks",
            "guides/corrections",
            "guides/optimal_modification",
            "guides/optimal_settings",
            "guides/finite_elements",
            "guides/friction",
            "guides/mixed_ehl",
        ],
        "Reference": [
            "reference/commands",
            "reference/case_file",
            "reference/case_file_keys",
            "reference/design_file",
            "reference/design_file_keys",
            "reference/results",
            "reference/result_variables",
            "reference/exchange",
            "reference/cad",
        ],
    },
    "researcher/index": {
        "": ["contact_problems", "problem_files", "solvers", "problem_library", "compare", "parametric", "half_space"]
    },
    "python/index": {
        "": ["recipes", "derivatives", "examples/index", "compatibility", "browsers"],
        "Reference": [f"api/{name}" for name in PACKAGES],
    },
    "how_it_works/index": {
        "": ["method", "conventions", "glossary", "validation", "verification", "bibliography"],
        "Research notes": [
            "notes/pair_design",
            "notes/elastic_teeth",
            "notes/unloaded_contact",
            "notes/elastic_supports",
            "notes/friction_formulas",
            "notes/mixed_lubrication",
            "notes/modification_search",
            "notes/contact_solvers",
            "notes/worn_and_measured_flanks",
            "notes/dissertation",
            "notes/efficiency",
        ],
    },
}
#: Examples of the gallery; others come behind these.
EXAMPLES = (
    "contact_pattern",
    "figures",
    "transmission_error_over_torque",
    "load_sharing",
    "ease_off_map",
    "gear_flank",
    "assembly_errors",
    "shafts_and_bearings",
    "measured_flank",
    "fitted_pinion",
    "efficiency_map",
    "friction_coefficients",
    "mixed_film",
    "solvers_on_one_problem",
    "torque_path",
)
#: What stands elsewhere on the site than in the repository.
ELSEWHERE = {"gallery/GALLERY_HEADER.rst": "examples/index.rst"}


class ExampleOrder:
    """Place of an example in the gallery."""

    def __init__(self, folder: str) -> None:
        self.folder = folder

    def __call__(self, file: str) -> tuple[int, str]:
        """Sort a file by the list, then by its name."""
        name = Path(file).stem
        return EXAMPLES.index(name) if name in EXAMPLES else len(EXAMPLES), name


def trees(name: str) -> str:
    """Tables of contents of an index page, which show in the navigation alone."""
    made = []
    for caption, pages in READING_ORDER.get(name, {}).items():
        options = [
            ":hidden:",
            *([f":caption: {caption}"] if caption else []),
            *([":glob:"] if "api/*" in pages else []),
        ]
        made.append("\n".join(["", "```{toctree}", *options, "", *pages, "```", ""]))
    return "\n".join(made)


def on_the_site(target: re.Match[str], page: Path) -> str:
    """Link of a page on the site: what is no page of it is named by its path in the repository."""
    label, path = target[1], target[2]
    if path in ELSEWHERE:
        return f"[{label}]({ELSEWHERE[path]})"
    there = (page.parent / path).resolve()
    if there.is_relative_to(DOCS.resolve()):
        return target.group(0)
    return f"{label} (`{there.relative_to(DOCS.resolve().parent)}`)"


def with_reading_order(app: Sphinx, name: str, source: list[str]) -> None:
    """Add the tables of contents to the indexes, and replace links that leave the site."""
    page = Path(app.env.doc2path(name))
    if page.suffix == ".md":
        source[0] = re.sub(
            r"\[([^\]]+)\]\(([\w./-]+\.(?:md|rst))(#[\w-]*)?\)", lambda target: on_the_site(target, page), source[0]
        ) + trees(name)
