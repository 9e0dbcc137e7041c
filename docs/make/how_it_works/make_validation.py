"""Write validation.md and the pictures of README and tutorial from fresh analyses: python docs/make validation."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
from dissertation_method import by_its_method
from folders import HOW_IT_WORKS, IMAGES
from tabulate import tabulate

import easeoff
from easeoff.cases import gear_pair, shipped_cases
from easeoff.contact import MeshCycle
from easeoff.geometry import FlankName, Misalignment, pair_geometry
from easeoff.study.plot.page import save
from easeoff.study.plot.written_pictures import PICTURES
from easeoff.verification.conventional_analysis import both_methods, line_differences, point_differences
from easeoff.verification.smallest_gap import smallest_envelope

HERE = Path(__file__).parent
TORQUES = [50.0, 200.0, 250.0, 500.0]
# Kolivand 2009: Table 3.1 (50, 250, 500 N m), Table 4.2 (200 N m), mean levels read off figure 3.6 and chapter 4.
THESIS = {
    50.0: (110, 12.8),
    200.0: (240, 14.2),
    250.0: (290, 15.9),
    500.0: (600, 21.9),
}
ERRORS = (Misalignment(), Misalignment(0.1, -0.1, 0.05))  # of every shipped pair beside the conventional analysis
DIRECT_ERRORS = (  # E, P, G [mm] and Sigma [deg] beside the direct search
    (0.0, 0.0, 0.0, 0.0),
    (0.1, -0.1, 0.05, 0.05),
    (-0.3, 0.2, 0.1, 0.1),
)
DIRECT_POSITIONS = 16
SEPARATIONS = (6.0, 1.5)  # [um] at the ends of a contact line


def table(rows: list[tuple[object, ...]], headers: list[str]) -> str:
    """A Markdown table; text as it is given."""
    return tabulate(rows, headers=headers, tablefmt="github", disable_numparse=True)


def against_the_dissertation() -> str:
    """Loaded error of fm-11x41 beside the dissertation's; draws two pictures."""
    tree = easeoff.analyze("fm-11x41", torques=TORQUES)
    for name in ("contact_pattern", "pressure"):
        save(PICTURES[name](tree), IMAGES / f"{name}.png")
    loaded = tree["loaded"].to_dataset()
    rows: list[tuple[object, ...]] = []
    for i, torque in enumerate(TORQUES):
        mean, peak = THESIS[torque]
        own_mean, own_peak = float(loaded["mean_level"][i]), float(loaded["peak_to_peak"][i])
        rows.append(
            (
                f"{torque:g}",
                f"{own_mean:.0f}, {mean}",
                f"{100 * (own_mean / mean - 1):+.0f} %",
                f"{own_peak:.1f}, {peak}",
                f"{100 * (own_peak / peak - 1):+.0f} %",
            )
        )
    headers = [
        "torque [N m]",
        "mean TE, ours, dissertation",
        "difference",
        "peak to peak, ours, dissertation",
        "difference",
    ]
    return table(rows, headers)


def conventional() -> tuple[int, str]:
    """Ease-off method against conventional contact analysis on every shipped pair: number of points, and lines."""
    number, greatest = 0, []
    flanks: tuple[FlankName, ...] = ("drive", "coast")
    for name, flank in itertools.product(shipped_cases(), flanks):
        pair = gear_pair(easeoff.read_case(name), flank)
        for errors in ERRORS:
            both = both_methods(pair.misaligned(errors))
            error, away = (np.nanmax(np.abs(v)) for v in point_differences(both))
            assert bool(both.contact.converged.all())
            assert 1e6 * error < 0.001
            assert 1e3 * away < 0.1
            number += int(both.inside.sum())
            found = np.array([line_differences(both, separation) for separation in SEPARATIONS])
            found = found[..., np.all(np.isfinite(found), axis=(0, 1))]
            greatest.append(np.abs(found).max(axis=2))
    angle, longer = np.max(greatest, axis=0).T
    directions = " and ".join(f"{v:.3f}" for v in np.degrees(angle))
    lengths = " and ".join(f"{v:.3f}" for v in 100.0 * longer)
    separations = " and ".join(f"{v:g}" for v in SEPARATIONS)
    return number, f"direction {directions} deg, length {lengths} % at {separations} um"


def direct() -> str:
    """Envelope of the unloaded error beside a direct search of the smallest gap over both bounded flanks."""
    at_edges, differences, positions = 0, [], 0
    flanks: tuple[FlankName, ...] = ("drive", "coast")
    for name, flank in itertools.product(shipped_cases(), flanks):
        members = pair_geometry(gear_pair(easeoff.read_case(name), flank))
        for offset, pinion, gear, angle in DIRECT_ERRORS:
            geometry = members.misaligned(Misalignment(offset, pinion, gear, float(np.radians(angle))))
            cycle = MeshCycle.of(geometry, mesh_positions=DIRECT_POSITIONS)
            envelope = cycle.unloaded()["transmission_error_envelope"].values
            found, _ = smallest_envelope(geometry, cycle.lines.rotations)
            wanted = 1e6 * (found.closing_angle - geometry.ease_off.attrs["first_contact_rad"])
            at_edges += int(np.count_nonzero(found.edge != ""))
            positions += DIRECT_POSITIONS
            differences.append(float(np.abs(envelope - wanted).max()))
    return (
        f"greatest difference of the envelope {max(differences):.1e} urad; the pair that carries touches at an edge at "
        f"{at_edges} of {positions} positions"
    )


def convergence() -> str:
    """Loaded error and greatest pressure of fm-11x41 against grid, segments and teeth, at low and high torque."""

    def run(changes: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
        modes = any(key.endswith("modes") for key in changes)
        case = by_its_method("fm-11x41") if modes else easeoff.read_case("fm-11x41")
        tables: dict[str, dict[str, Any]] = {"contact": {}, "compliance": {}}
        for key, value in changes.items():
            tables["compliance" if modes or key == "fineness" else "contact"][key] = value
        changed = case.model_copy(
            update={name: getattr(case, name).model_copy(update=values) for name, values in tables.items()}
        )
        loaded = easeoff.analyze(changed, torques=[50.0, 500.0])["loaded"].to_dataset()
        return loaded["transmission_error"].values, loaded["max_pressure"].values

    studies: list[tuple[str, list[dict[str, Any]]]] = [
        (
            "grid of the flank",
            [{"lengthwise_nodes": a, "profile_nodes": b} for a, b in ((9, 7), (13, 9), (21, 15), (31, 21), (61, 41))],
        ),
        ("segments of a line", [{"segments_per_line": n} for n in (8, 16, 31, 62, 248)]),
        ("fineness of the solid shells", [{"fineness": f} for f in (0.5, 0.7, 1.0, 1.4)]),
        ("shell modes along the face", [{"lengthwise_modes": n} for n in (7, 11, 15, 21, 31)]),
        ("shell modes up the profile", [{"profile_modes": n} for n in (3, 4, 5, 6, 9)]),
    ]
    rows: list[tuple[object, ...]] = []
    for name, changes in studies:
        found = [run(c) for c in changes]
        reference, pressure = found[-1]
        errors = [100.0 * np.abs(error / reference - 1.0).max(axis=1) for error, _ in found]
        sizes = [next(iter(c.values())) for c in changes]
        labels = [" x ".join(str(v) for v in change.values()) for change in changes]
        pressures = [100.0 * np.abs(greatest / pressure - 1.0) for _, greatest in found]
        figures = [(e.max(), p.max()) for e, p in zip(errors[:-1], pressures[:-1], strict=True)]
        orders = [
            np.log(errors[k - 1][1] / errors[k][1]) / np.log(sizes[k] / sizes[k - 1]) for k in range(1, len(figures))
        ]
        cells = (", ".join(f"{v:.3f}" for v in column) for column in zip(*figures, strict=True))
        order = ", ".join(f"{v:.1f}" for v in orders)
        rows.append((name, ", ".join(labels[:-1]), labels[-1], *cells, order))
    heads = ["TE [%]", "pressure [%]"]
    return table(rows, ["what", "values", "against", *heads, "order"])


def main() -> None:
    """Write the page."""
    template = (HERE / "validation.md.in").read_text(encoding="utf-8")
    points, lines = conventional()
    page = template.format(
        points=points,
        conventional=lines,
        direct=direct(),
        positions=DIRECT_POSITIONS,
        assemblies="; ".join(" ".join(f"{v:g}" for v in errors) for errors in DIRECT_ERRORS),
        loaded=against_the_dissertation(),
        convergence=convergence(),
    )
    (HOW_IT_WORKS / "validation.md").write_text(page, encoding="utf-8")
    print("wrote docs/how_it_works/validation.md")


if __name__ == "__main__":
    main()
