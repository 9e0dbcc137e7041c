"""Where the pages and pictures stand that the scripts make."""

from pathlib import Path

DOCS = Path(__file__).parents[1]
IMAGES = DOCS / "images"
DATA = DOCS / "data"
GUIDES = DOCS / "engineer" / "guides"
DESIGNS = DOCS / "engineer" / "designs"
REFERENCE = DOCS / "engineer" / "reference"
RESEARCHER = DOCS / "researcher"
HOW_IT_WORKS = DOCS / "how_it_works"
NOTES = HOW_IT_WORKS / "notes"
