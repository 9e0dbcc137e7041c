"""Variations of a shipped case that hypothesis draws: blades, machines, motions, and everything that has a default."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from easeoff.cases import Case, read_case
from easeoff.cases.reading import check_case

NASA = read_case("nasa-12x36")


def number(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, exclude_min=True, exclude_max=True)


def some(**entries: st.SearchStrategy[Any]) -> st.SearchStrategy[dict[str, Any]]:
    """A table with any of the given keys."""
    return st.fixed_dictionaries({}, optional=entries)


derivatives = st.lists(number(-9.0, 9.0), min_size=1, max_size=6)
motions = some(
    radial_distance=derivatives,
    work_offset=derivatives,
    sliding_base=derivatives,
    machine_center_to_crossing_point=derivatives,
    machine_root_angle=derivatives,
    cutter_tilt=derivatives,
    cutter_swivel=derivatives,
)
generated = st.builds(
    lambda needed, more, moving: {**needed, **more, "motions": moving},
    st.fixed_dictionaries(
        {
            "radial_distance": number(0.0, 5000.0),
            "cradle_angle": number(-180.0, 180.0),
            "machine_root_angle": number(-45.0, 120.0),
            "ratio_of_roll": number(0.0, 100.0),
        }
    ),
    some(
        work_offset=number(-500.0, 500.0),
        sliding_base=number(-1000.0, 1000.0),
        machine_center_to_crossing_point=number(-1000.0, 1000.0),
        cutter_tilt=number(-90.0, 90.0),
        cutter_swivel=number(-360.0, 360.0),
        # A format that holds C, D, ... rounds these in the last digit: not at the very limit of what is allowed.
        modified_roll_2c=number(-9.0, 9.0),
        modified_roll_6d=number(-90.0, 90.0),
        modified_roll_24e=number(-900.0, 900.0),
        modified_roll_120f=number(-9e3, 9e3),
        modified_roll_720g=number(-9e4, 9e4),
    ),
    motions,
)
formate = st.fixed_dictionaries(
    {
        "horizontal_distance": number(-3500.0, 3500.0),
        "vertical_distance": number(-3500.0, 3500.0),
        "machine_root_angle": number(-45.0, 120.0),
    }
)


def relief(name: str, height: st.SearchStrategy[float]) -> st.SearchStrategy[dict[str, float]]:
    """No relief, or one with a kink, an arc or both."""
    depth = st.fixed_dictionaries({f"{name}_depth": height})
    angle = st.fixed_dictionaries({f"{name}_angle": number(0.0, 30.0)})
    radius = st.fixed_dictionaries({f"{name}_radius": number(0.1, 1e7)})
    merged = st.builds(lambda *tables: dict(pair for table in tables for pair in table.items()), depth, angle, radius)
    return st.one_of(
        st.just({}),
        st.builds(lambda a, b: a | b, depth, angle),
        st.builds(lambda a, b: a | b, depth, radius),
        merged,
    )


profile: st.SearchStrategy[dict[str, float]] = st.one_of(
    st.just({}),
    st.fixed_dictionaries(
        {"blade_spheric_radius": number(1.0, 1e7) | number(-1e7, -1.0), "blade_reference_height": number(-50.0, 100.0)}
    ),
)
milling = st.builds(
    lambda needed, *more: dict(pair for table in (needed, *more) for pair in table.items()),
    st.fixed_dictionaries({"blade_point_radius": number(1.0, 2000.0), "blade_pressure_angle": number(-45.0, 60.0)}),
    profile,
    some(tool_edge_radius=number(0.0, 20.0)),
    relief("toprem", number(0.0, 50.0)),
    relief("flankrem", number(0.0, 100.0)),
)
hobbing = st.builds(
    lambda blade, more, groups: {**blade, **more, "number_of_blade_groups": groups},
    milling,
    some(
        blade_offset_angle=number(-60.0, 60.0),
        blade_rake_angle=number(-60.0, 60.0),
        blade_hook_angle=number(-60.0, 60.0),
    ),
    st.integers(1, 100),
)
flank = st.fixed_dictionaries({"machine": st.one_of(generated, formate), "cutter": st.one_of(milling, hobbing)})
steel = some(elastic_modulus=number(500.0, 1e6), poisson_ratio=number(0.0, 0.5))


@st.composite
def cases(draw: st.DrawFn) -> Case:
    """A checked case: the drive side is there, the rest may be."""
    data = NASA.model_dump()
    data["title"] = draw(st.text(st.characters(codec="utf-8", exclude_categories=["C"]), min_size=1, max_size=60))
    data["description"] = draw(st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), max_size=60))
    data["pair"] = draw(some(shaft_angle=number(5.0, 175.0), hypoid_offset=number(-500.0, 500.0)))
    data["misalignment"] = draw(
        some(
            offset=number(-10.0, 10.0), pinion_axial=number(-10.0, 10.0), gear_axial=number(-10.0, 10.0),
            shaft_angle=number(-5.0, 5.0),
        )
    )  # fmt: skip
    data["contact"] = draw(
        some(torques=st.lists(number(1e-6, 1e7), min_size=1, max_size=3, unique=True), separation=number(1e-3, 1e3))
    )
    roots = st.sampled_from(["weber", "odonnell", "clamped"])
    shell = some(root=roots, shear_factor=number(0.0, 1.0)).map(lambda keys: keys | {"model": "shell"})
    bricks = some(model=st.sampled_from(["solid_shell", "fe"]), fineness=number(0.2, 4.0))
    data["compliance"] = draw(st.one_of(shell, bricks))
    data["target"] = draw(some(drive=some(bias=number(-99.0, 99.0))))
    thickness = st.sampled_from(["mean_normal_circular_thickness", "mid_flank_normal_circular_thickness"])
    data["pinion"]["hand_of_spiral"] = draw(st.sampled_from(["left", "right"]))
    for member, drive, coast in (("pinion", "concave", "convex"), ("gear", "convex", "concave")):
        data[member] |= {drive: draw(flank), coast: draw(st.none() | flank), "material": draw(steel)}
        data[member][draw(thickness)] = draw(st.none() | number(0.0, 200.0))
        for end in ("front_angle", "back_angle"):
            data[member]["blank"][end] = draw(st.none() | number(-90.0, 180.0))
    return check_case(data)
