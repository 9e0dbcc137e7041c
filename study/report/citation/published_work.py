"""A published work as a line of text and as a BibTeX entry, and the works that models of the package are from."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import version

#: Fields of a BibTeX entry that locate a work, in the order of a line of text, with what stands before each.
PLACES = {"journal": "", "booktitle": "", "school": "", "institution": "", "number": "no. ", "volume": "vol. "}
SPECIAL = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


@dataclass(frozen=True)
class PublishedWork:
    """A published work, or a file that names its own source.

    Parameters
    ----------
    key
        Key of its BibTeX entry.
    kind
        Kind of that entry: ``article``, ``phdthesis``, ``misc``, ...
    fields
        Fields of the entry in plain text, by name; authors are separated by ``and``.

    Examples
    --------
    >>> print(PublishedWork("oil", "misc", {"title": "Gear oil", "note": "data sheet", "year": "2026"}).text())
    Gear oil. 2026, data sheet
    """

    key: str
    kind: str
    fields: Mapping[str, str] = field(hash=False)

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
    text = re.sub(r"[\\~^]|[&%$#_{}]", lambda found: SPECIAL.get(found[0], "\\" + found[0]), text)
    return re.sub(r"(\d)-(\d)", r"\1--\2", text)


def package() -> PublishedWork:
    """The package itself, as ``CITATION.cff`` has it.

    Examples
    --------
    >>> package().kind
    'misc'
    """
    fields = {
        "author": "The easeoff developers",
        "title": "easeoff: contact of spiral bevel and hypoid gears",
        "year": "2026",
        "note": f"version {version('easeoff')}",
    }
    return PublishedWork("easeoff", "misc", fields)


_ENTRIES = (
    PublishedWork(
        "kolivand_2009",
        "phdthesis",
        {
            "author": "M. Kolivand",
            "title": "Development of Tooth Contact and Mechanical Efficiency Models for Face-Milled and Face-Hobbed "
            "Hypoid and Spiral Bevel Gears",
            "school": "The Ohio State University",
            "year": "2009",
        },
    ),
    PublishedWork(
        "bibel_1994",
        "techreport",
        {
            "author": "G. D. Bibel and K. Reddy and A. Kumar",
            "title": "NASA Contractor Report CR-191009",
            "institution": "NASA",
            "year": "1994",
        },
    ),
    PublishedWork(
        "xu_2007",
        "article",
        {
            "author": "H. Xu and A. Kahraman and N. E. Anderson and D. G. Maddock",
            "title": "Prediction of mechanical efficiency of parallel-axis gear pairs",
            "journal": "Journal of Mechanical Design",
            "volume": "129",
            "year": "2007",
            "pages": "58-68",
            "doi": "10.1115/1.2359478",
        },
    ),
    PublishedWork(
        "benedict_1961",
        "article",
        {
            "author": "G. H. Benedict and B. W. Kelly",
            "title": "Instantaneous coefficients of gear tooth friction",
            "journal": "ASLE Transactions",
            "volume": "4",
            "year": "1961",
            "pages": "59-70",
            "doi": "10.1080/05698196108972420",
        },
    ),
    PublishedWork(
        "pan_1989",
        "article",
        {
            "author": "P. Pan and B. J. Hamrock",
            "title": "Simple formulas for performance parameters used in elastohydrodynamically lubricated line "
            "contacts",
            "journal": "Journal of Tribology",
            "volume": "111",
            "year": "1989",
            "pages": "246-251",
            "doi": "10.1115/1.3261900",
        },
    ),
    PublishedWork(
        "dowson_1966",
        "book",
        {"author": "D. Dowson and G. R. Higginson", "title": "Elasto-Hydrodynamic Lubrication", "year": "1966"},
    ),
    PublishedWork(
        "goksem_1978",
        "article",
        {
            "author": "P. G. Goksem and R. A. Hargreaves",
            "title": "The effect of viscous shear heating on both film thickness and rolling traction in an EHL line "
            "contact, part I: fully flooded conditions",
            "journal": "Journal of Lubrication Technology",
            "volume": "100",
            "year": "1978",
            "doi": "10.1115/1.3453183",
        },
    ),
    PublishedWork(
        "murch_1975",
        "article",
        {
            "author": "L. E. Murch and W. R. D. Wilson",
            "title": "A thermal elastohydrodynamic inlet zone analysis",
            "journal": "Journal of Lubrication Technology",
            "volume": "97",
            "year": "1975",
            "doi": "10.1115/1.3452559",
        },
    ),
    PublishedWork(
        "gupta_1992",
        "article",
        {
            "author": "P. K. Gupta and H. S. Cheng and D. Zhu and N. H. Forster and J. B. Schrand",
            "title": "Viscoelastic effects in MIL-L-7808-type lubricant, part I: analytical formulation",
            "journal": "Tribology Transactions",
            "volume": "35",
            "year": "1992",
            "doi": "10.1080/10402009208982117",
        },
    ),
    PublishedWork(
        "blok_1937",
        "inproceedings",
        {
            "author": "H. Blok",
            "title": "Theoretical study of temperature rise at surfaces of actual contact under oiliness lubricating "
            "conditions",
            "booktitle": "Proc. General Discussion on Lubrication, IMechE",
            "volume": "2",
            "year": "1937",
            "pages": "222-235",
        },
    ),
    PublishedWork(
        "jaeger_1942",
        "article",
        {
            "author": "J. C. Jaeger",
            "title": "Moving sources of heat and the temperature at sliding contacts",
            "journal": "Journal and Proceedings of the Royal Society of New South Wales",
            "volume": "76",
            "year": "1942",
            "pages": "203-224",
        },
    ),
    PublishedWork(
        "fritsch_1980",
        "article",
        {
            "author": "F. N. Fritsch and R. E. Carlson",
            "title": "Monotone piecewise cubic interpolation",
            "journal": "SIAM Journal on Numerical Analysis",
            "volume": "17",
            "year": "1980",
            "pages": "238-246",
            "doi": "10.1137/0717021",
        },
    ),
    PublishedWork(
        "archard_1953",
        "article",
        {
            "author": "J. F. Archard",
            "title": "Contact and rubbing of flat surfaces",
            "journal": "Journal of Applied Physics",
            "volume": "24",
            "year": "1953",
            "pages": "981-988",
            "doi": "10.1063/1.1721448",
        },
    ),
)
WORKS: Mapping[str, PublishedWork] = {work.key: work for work in _ENTRIES}
