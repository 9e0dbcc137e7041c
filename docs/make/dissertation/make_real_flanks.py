"""Write worn_and_measured_flanks.md, its pictures and the shipped measured grids: python docs/make real_flanks."""

from __future__ import annotations

from pathlib import Path

from folders import NOTES
from real_flanks_examples import write_examples
from real_flanks_pictures import draw
from real_flanks_studies import own_wear, shortcut, wear_by_torque
from real_flanks_tables import amplitudes, said_measured, said_worn

from easeoff.core.output_file import whole_file

HERE = Path(__file__).parent


def main() -> None:
    """Write everything."""
    write_examples()
    draw()
    page = (HERE / "worn_and_measured_flanks.md.in").read_text(encoding="utf-8")
    parts = {
        "table_4_2": amplitudes("worn"),
        "table_4_4": amplitudes("measured"),
        "said_worn": said_worn(),
        "said_measured": said_measured(),
        "shortcut": shortcut(),
        "own_wear": own_wear(),
        "wear_by_torque": wear_by_torque(),
    }
    for name, text in parts.items():
        page = page.replace(f"{{{name}}}", text)
    with whole_file(NOTES / "worn_and_measured_flanks.md") as temporary:
        temporary.write_text(page, encoding="utf-8")
    print("wrote docs/how_it_works/notes/worn_and_measured_flanks.md")


if __name__ == "__main__":
    main()
