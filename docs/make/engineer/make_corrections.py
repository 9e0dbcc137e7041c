"""Write the table and picture of the closed loops in ``corrections.md``: python docs/make corrections."""

from __future__ import annotations

from collections.abc import Iterator

from correction_loops import CORRECTION_LOOPS, loop_case
from dissertation_figures import save_small
from folders import GUIDES, IMAGES
from generated_part import with_generated

from easeoff import plot
from easeoff.verification import CorrectionLoop, correction_loop
from easeoff.verification.correction_loop import greatest

PAGE = GUIDES / "corrections.md"
PICTURE = IMAGES / "corrections" / "topography.png"
DRAWN = "hobbed, completing, Formate"
NOISE = 0.5  # [um]
PART = "closed loops"


def loops(noise: float = 0.0) -> dict[str, CorrectionLoop]:
    """All loops, with noise [um rms] in the measurement."""
    return {
        name: correction_loop(loop_case(case), member, errors, noise)
        for name, (case, member, errors) in CORRECTION_LOOPS.items()
    }


def updated(page: str) -> str:
    """The page with its table made anew."""
    table = "\n".join(rows(loops(), loops(NOISE)))
    return with_generated(page, PART, table)


def rows(exact: dict[str, CorrectionLoop], noisy: dict[str, CorrectionLoop]) -> Iterator[str]:
    """The table: greatest deviations before and after, and with noise in the measurement."""
    yield f"| member | case | greatest deviation, µm | left, µm | left | left with {NOISE:g} µm noise, µm |"
    yield "| --- | --- | ---: | ---: | ---: | ---: |"
    for name, loop in exact.items():
        case, member, _ = CORRECTION_LOOPS[name]
        yield (
            f"| {name} | {member} of `{case.split()[0]}` | {greatest(loop.before):.1f} | {greatest(loop.after):.2f} | "
            f"{100.0 * loop.left:.1f} % | {greatest(noisy[name].after):.1f} |"
        )


def draw() -> None:
    """Write the topographies of one loop."""
    case, member, errors = CORRECTION_LOOPS[DRAWN]
    (correction,) = correction_loop(loop_case(case), member, errors, NOISE).correction.corrections[member]
    PICTURE.parent.mkdir(exist_ok=True)
    title = f"{DRAWN}: {member} of {case}, measured with {NOISE:g} µm of noise"
    save_small(plot.topography(correction, title=title), PICTURE)


if __name__ == "__main__":
    draw()
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
