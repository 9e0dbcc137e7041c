"""The site made of these pages by Sphinx: ``make docs``. It needs no network, neither to build nor to read."""

from __future__ import annotations

import sys
import tomllib
from html import escape
from pathlib import Path
from typing import Any

import latex2mathml.converter
from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.writers.html5 import HTML5Translator

sys.path.insert(0, str(Path(__file__).parent / "make"))
from reading_order import with_reading_order
from reference_pages import write_reference_pages

project = "easeoff"
copyright = "the easeoff developers"
release = version = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]["version"]

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = [
    "make",
    "paper",
    "data",
    "python/gallery",
    "**/*.py",
    "sg_execution_times.rst",
    "**/sg_execution_times.rst",
]
default_role = "code"
nitpicky = True
# Types of other packages, and classes inside the package that are no part of its interface.
nitpick_ignore_regex = [(r"py:.*", r"(?!easeoff\.).*"), (r"py:class", r"easeoff(\.[a-z_0-9]+){2,}\.[A-Z]\w*")]

myst_heading_anchors = 4
myst_fence_as_directive = ["math"]

autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
# Named as in the source, not spelt out.
autodoc_type_aliases = {name: name for name in ("ArrayLike", "Array", "Mask", "SolverChoice")}
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autosummary_generate = True
napoleon_google_docstring = False
napoleon_use_rtype = False
add_module_names = False
python_use_unqualified_type_names = True

sphinx_gallery_conf = {
    "examples_dirs": ["python/gallery"],
    "gallery_dirs": ["python/examples"],
    "filename_pattern": r"\.py$",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "plot_gallery": True,
    "within_subsection_order": "reading_order.ExampleOrder",
    "image_scrapers": ("matplotlib",),
    "remove_config_comments": True,
}

html_theme = "pydata_sphinx_theme"
html_title = f"easeoff {release}"
templates_path = ["_templates"]
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_show_search_summary = False  # what shows it asks for pages, which a browser does not read for a file
html_context = {"default_mode": "auto"}
html_math_renderer = "mathml"
html_sidebars = {"**": ["sidebar-nav-bs", "page-toc"]}
html_theme_options: dict[str, Any] = {
    "logo": {"text": "easeoff"},
    "show_prev_next": True,
    "navigation_with_keys": False,
    "navbar_end": ["theme-switcher"],
    "secondary_sidebar_items": [],  # the column then takes a line of 120 characters at 1300 pixels
    "footer_start": ["copyright"],
    "footer_end": [],
    "header_links_before_dropdown": 4,
    "show_toc_level": 2,
    "navigation_depth": 2,
    "collapse_navigation": True,
}


def visit_inline_math(writer: HTML5Translator, node: nodes.math) -> None:
    """Write a formula in a line as MathML, which browsers set themselves."""
    writer.body.append(latex2mathml.converter.convert(node.astext()))
    raise nodes.SkipNode


def visit_math_block(writer: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula on a line of its own as MathML; the converter knows no aligned, and split is the same."""
    formula = latex2mathml.converter.convert(node.astext().replace("{aligned}", "{split}"), display="block")
    writer.body.append(f'<div class="math" title="{escape(node.astext())}">{formula}</div>\n')
    raise nodes.SkipNode


def require_pictures(app: Sphinx, error: Exception | None) -> None:
    """Refuse examples of the gallery that drew no picture."""
    pictures = Path(app.srcdir) / "python" / "examples" / "images"
    for example in sorted((Path(app.srcdir) / "python" / "gallery").glob("*.py")):
        if error is None and not (pictures / f"sphx_glr_{example.stem}_001.png").exists():
            raise ExtensionError(f"{example.name} draws no picture")


def setup(app: Sphinx) -> None:
    """Add the renderer of formulas, and write the pages of the reference of the interface before all else."""
    app.add_html_math_renderer("mathml", (visit_inline_math, None), (visit_math_block, None))
    app.connect("source-read", with_reading_order)
    app.add_lexer("csv", TextLexer)
    app.connect("build-finished", require_pictures)
    write_reference_pages(Path(app.srcdir) / "python" / "api")
