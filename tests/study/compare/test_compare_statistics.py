"""Statistics of a comparison: profiles, means, growth, work against precision, and the order of solvers in tables."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.text import Text

from easeoff.contact import ContactProblem, solve
from easeoff.contact.problem.certificate import Certificate
from easeoff.study.compare.attempt import Attempt, Method, PosedProblem
from easeoff.study.compare.comparison_table import Row, comparison_table
from easeoff.study.compare.method_statistics import (
    by_problem,
    data_profile,
    growth,
    headline,
    methods,
    pairwise_matrix,
    pairwise_share,
    performance_profile,
    run_time_table,
    shifted_geometric_mean,
    sweep_points,
    work_precision,
)
from easeoff.study.plot.page import sheet
from easeoff.study.report.comparison_figures import (
    draw_data_profile,
    draw_growth,
    draw_pairs,
    draw_performance_profile,
    draw_work_precision,
    panels,
    style,
    write_figure,
)
from easeoff.study.report.comparison_report import (
    ReportTable,
    comparison_report,
    milliseconds,
    ratio,
    report_sections,
    residual,
    size_groups,
    waiting_note,
)

LIMIT = 10.0
ATTRIBUTES = {"repetitions": 1, "time_limit_s": LIMIT, "machine": "{}", "solver_versions": "{}"}
#: Solvers of an invented comparison: share of problems certified, run time [s], and what they claim.
INVENTED = {
    "lie": (0.0, 1e-6, "solved"),
    "hang": (0.0, math.nan, "time_limit"),
    "slow": (1.0, 4e-3, "solved"),
    "fast": (1.0, 1e-3, "solved"),
    "half": (0.5, 1e-4, "solved"),
}


def posed(number: int, kind: str = "load", size: int = 2) -> PosedProblem:
    problem = ContactProblem(np.zeros(size), np.full(size, 40.0), 8.0e4, np.diag(np.full(size, 1e-6)))
    return PosedProblem("invented.nc", number, problem, "", solve(problem), None, f"problem-{number}", kind)


def outcome(worst: float, time: float, claim: str, posed: float = math.nan) -> Attempt:
    certificate = Certificate(worst, 0.0, 0.0, 0.0, 0.0)
    return Attempt(
        claim,
        run_time=time,
        processor_time=time,
        call_time=0.5 * time,
        setup_time=0.1 * time,
        solve_time=0.3 * time,
        time_source="solver",
        certificate=certificate,
        posed_residual=posed,
    )


def invented(solvers: list[str], count: int = 8, repetitions: int = 2) -> xr.Dataset:
    """Comparison whose numbers are known: the second repetition takes one and a half times as long."""
    rows = []
    for number in range(count):
        for solver in solvers:
            certified, time, claim = INVENTED[solver]
            worst = 1e-12 if number < certified * count else 1.0
            for repetition in range(1, repetitions + 1):
                found = outcome(worst, time * (0.5 + 0.5 * repetition) * (1 + number), claim)
                rows.append(Row(posed(number, size=20 * (1 + number % 4)), Method(solver, "scaled"), repetition, found))
    return comparison_table(rows, 1e-5, {**ATTRIBUTES, "repetitions": repetitions})


def swept() -> xr.Dataset:
    """Sweep of a solver that is slower the finer its tolerance; its certificate is a hundred times that.

    It keeps the first tolerance on the problem as posed, and misses the second.
    """
    runs = [
        ("scaled", 0.0, 1e-10, 5e-2, 1e-10),
        ("sweep", 1e-4, 1e-2, 1e-2, 1e-4),
        ("sweep", 1e-6, 1e-4, 1e-1, 1e-4),
    ]
    rows = [
        Row(posed(number), Method("fast", settings, "cold", tol), 1, outcome(worst, time, "solved", residual))
        for number in range(4)
        for settings, tol, worst, time, residual in runs
    ]
    return comparison_table(rows, 1e-5, ATTRIBUTES)


def tables(dataset: xr.Dataset) -> dict[str, ReportTable]:
    parts = [part for section in report_sections(dataset) for part in section.parts if isinstance(part, ReportTable)]
    return {part.name: part for part in parts}


# Profiles


def test_performance_profile_is_its_definition() -> None:
    rng = np.random.default_rng(1)
    time = np.where(rng.uniform(size=(4, 30)) < 0.2, np.inf, rng.uniform(0.1, 5.0, (4, 30)))
    time[:, 3] = np.inf
    factor, share = performance_profile(time)
    for method in range(4):
        for column, tau in enumerate(factor):
            solved = [math.isfinite(time[method, p]) and time[method, p] / time[:, p].min() <= tau for p in range(30)]
            assert share[method, column] == pytest.approx(sum(solved) / 30)


def test_profiles_of_two_are_the_same_whoever_else_is_there() -> None:
    """Of performance profiles this does not hold (Gould and Scott 2016); of data profiles and pairs it does."""
    rng = np.random.default_rng(7)
    time = np.where(rng.uniform(size=(5, 40)) < 0.2, np.inf, rng.lognormal(size=(5, 40)))
    for factor in (0.5, 1.0, 3.0):
        whole = pairwise_matrix(time, factor)
        np.testing.assert_array_equal(pairwise_matrix(time[[1, 3]], factor), whole[np.ix_([1, 3], [1, 3])])
    budget, share = data_profile(time)
    for chosen in ([1, 3], [1]):
        own, own_share = data_profile(time[chosen])
        np.testing.assert_allclose(own_share, share[chosen][:, np.searchsorted(budget, own)])


def test_pairwise_share_is_the_performance_profile_of_the_two() -> None:
    rng = np.random.default_rng(3)
    time = np.where(rng.uniform(size=(2, 50)) < 0.3, np.inf, rng.lognormal(size=(2, 50)))
    factors, shares = performance_profile(time)
    for tau, share in zip(factors, shares.T, strict=True):
        # A factor that is one run time over another may round to either side of it.
        pair = [pairwise_share(time[i], time[1 - i], tau * (1.0 + 1e-12)) for i in (0, 1)]
        np.testing.assert_allclose(share, pair)


def test_order_of_two_changes_in_the_performance_profile_alone() -> None:
    """A third solver that is the fastest where the first was reverses the order of the first two at a factor."""
    first, second = np.array([1.0, 1.0, 4.0, 4.0]), np.array([3.0, 3.0, 2.0, 2.0])
    third = np.array([0.3, 0.3, 50.0, 50.0])

    def shares(*times: Any) -> Any:
        factor, share = performance_profile(np.array(times))
        return share[:2, np.searchsorted(factor, 1.5, side="right") - 1].tolist()

    assert shares(first, second) == [0.5, 0.5]
    assert shares(first, second, third) == [0.0, 0.5]
    assert pairwise_share(first, second) == pairwise_matrix(np.array([first, second, third]))[0, 1] == 0.5


# Means and growth


def test_growth_finds_a_power_and_refuses_too_few_sizes() -> None:
    size = np.repeat(np.array([20.0, 40.0, 80.0, 160.0, 320.0]), 3)
    fit = growth(size, 1e-6 * size**1.7)
    assert fit == pytest.approx((1e-6, 1.7))
    overhead = np.maximum(1e-6 * size**1.7, 1e-6 * 80.0**1.7)  # the cost of the call hides the small problems
    assert growth(size, overhead) == pytest.approx((1e-6, 1.7))
    assert growth(np.array([62.0, 93.0, 93.0]), np.ones(3)) is None
    assert growth(size, np.full(size.size, np.inf)) is None


def test_shifted_mean_lies_between_plain_geometric_and_arithmetic_mean() -> None:
    values = np.random.default_rng(2).lognormal(size=50)
    geometric = math.exp(np.log(values).mean())
    assert shifted_geometric_mean(values, 0.0) == pytest.approx(geometric)
    assert geometric < shifted_geometric_mean(values, 1.0) < shifted_geometric_mean(values, 100.0) < values.mean()


def test_growth_is_within_one_kind_of_problem() -> None:
    """Two kinds with the exponent one, of which the larger problems are the slower kind: together they give another."""
    rows = [
        Row(posed(number, kind, size), Method("fast", "scaled"), 1, outcome(1e-12, cost * size, "solved"))
        for kind, cost, first, sizes in (("easy", 1e-6, 0, (4, 8, 12, 16)), ("hard", 1e-3, 4, (32, 64, 96, 128)))
        for number, size in enumerate(sizes, start=first)
    ]
    dataset = comparison_table(rows, 1e-5, ATTRIBUTES)
    table = tables(dataset)["growth"]
    assert list(table.head) == ["solver", "easy", "hard"]
    assert table.rows == [["fast", "1.00", "1.00"]]
    assert len(draw_growth(dataset, by_problem(dataset)).axes) == 2


# Order and tables


def test_who_is_wrong_comes_last_and_the_liar_after_all() -> None:
    dataset = invented(list(INVENTED))
    order = ["fast", "slow", "half", "hang", "lie"]
    problems = by_problem(dataset)
    assert [name for name, _, _ in methods(problems, LIMIT)] == order
    found = tables(dataset)
    for name in ("answers_scaled", "run_time", "time_parts", "growth", "certified_by_kind", "residuals", "violations"):
        assert [row[0] for row in found[name].rows] == order, name
    for draw in (draw_performance_profile, draw_data_profile, draw_growth):
        legend = draw(dataset, problems).axes[0].get_legend()
        assert legend is not None
        assert [text.get_text().split()[0] for text in legend.get_texts()] == order
    (axes,) = draw_performance_profile(dataset, problems).axes
    heights = {str(line.get_label()): float(np.asarray(line.get_ydata())[-1]) for line in axes.lines}
    assert heights == {"fast": 1.0, "slow": 1.0, "half": 0.5, "hang": 0.0, "lie": 0.0}
    assert [label.get_text() for label in draw_pairs(dataset, problems).axes[0].get_yticklabels()] == order


def test_time_of_who_is_wrong_does_not_count() -> None:
    """The liar is a thousand times faster than the others: it is no problem's fastest."""
    both = by_problem(invented(["fast", "slow", "lie"]))
    named = headline(methods(both, LIMIT))
    times = run_time_table(both, named).to_numpy(dtype=float).T
    assert np.isinf(times[2]).all()
    np.testing.assert_allclose(times[1], 4.0 * times[0])
    assert performance_profile(times)[1][0, 0] == 1.0
    assert pairwise_matrix(times)[:, 2].tolist() == [1.0, 1.0, 0.0]


def test_spread_and_parts_of_the_run_time_are_told() -> None:
    found = tables(invented(["fast"]))
    run_time = dict(zip(found["run_time"].head, found["run_time"].rows[0], strict=True))
    assert (run_time["spread"], run_time["spread, 90 %"]) == ("1.5", "1.5")
    parts = dict(zip(found["time_parts"].head, found["time_parts"].rows[0], strict=True))
    assert parts["whole / bare"] == "2"
    assert parts["by"] == "solver"
    np.testing.assert_allclose(float(parts["set-up [ms]"]), 0.1 * float(parts["whole [ms]"]), rtol=1e-2)
    once = tables(invented(["fast"], repetitions=1))["run_time"]
    assert dict(zip(once.head, once.rows[0], strict=True))["spread"] == "-"


@pytest.mark.parametrize(
    ("shown", "value", "text"),
    [(milliseconds, 1.2345e-3, "1.23"), (milliseconds, 12.3456, "12346"), (ratio, 1.23456, "1.23")],
)
def test_numbers_of_the_report_have_three_digits_and_no_exponent(shown: Any, value: float, text: str) -> None:
    assert shown(value) == text
    assert shown(math.nan) == shown(math.inf) == residual(math.nan) == "-"
    assert residual(1.23e-6) == "1.2e-06"


def test_tables_are_the_same_in_markdown_csv_and_latex(tmp_path: Path) -> None:
    table = ReportTable("some", ["solver", "50 %", "a_b"], [["native", 1, "2 & 3"], ["x, y", 2, "-"]], "Note.")
    csv_path, latex_path = table.write(tmp_path)
    assert csv_path.read_text(encoding="utf-8") == 'solver,50 %,a_b\nnative,1,2 & 3\n"x, y",2,-\n'
    latex = latex_path.read_text(encoding="utf-8")
    assert all(part in latex for part in ("\\toprule", "50 \\%", "a\\_b", "2 \\& 3"))
    assert "| native " in table.markdown
    assert table.markdown.endswith("\nNote.\n")


def test_figures_are_the_same_files_again_in_three_formats(tmp_path: Path) -> None:
    for folder in ("one", "two"):
        figure = sheet(1.5)
        figure.subplots().plot([0.0, 1.0])
        write_figure(figure, tmp_path / folder, "pairs")
    for suffix, start in (("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")):
        content = (tmp_path / "one" / f"pairs.{suffix}").read_bytes()
        assert content.startswith(start)
        assert content == (tmp_path / "two" / f"pairs.{suffix}").read_bytes()


def test_run_times_count_with_the_shift_that_the_report_states() -> None:
    text = comparison_report(invented(["half"], repetitions=1))
    times = np.array([1e-4 * (1 + number) if number < 4 else LIMIT for number in range(8)])
    mean = math.exp(np.log(times + 1e-3).mean()) - 1e-3
    assert f"| {1e3 * mean:.3g} " in text.split("## Run time")[1]
    assert "shift 1 ms" in text


# Work and precision


def test_work_is_that_of_the_fastest_run_whose_certificate_reaches_the_accuracy() -> None:
    (curve,) = work_precision(swept())
    found = dict(zip(np.round(np.log10(curve.accuracy)).astype(int).tolist(), curve.run_time.tolist(), strict=True))
    assert found[-1] == found[-2] == 1e-2  # the certificate of the tolerance 1e-4 is 1e-2
    assert found[-3] == found[-10] == 5e-2  # that of 1e-6 is 1e-4, but the headline is faster
    assert math.isinf(found[-11])
    assert curve.share.tolist() == [1.0] * 10 + [0.0] * 2


def test_sweep_tells_who_misses_the_tolerance_that_was_given() -> None:
    points = {point.tolerance: point for point in sweep_points(swept())}
    assert {tol: point.missed for tol, point in points.items()} == {0.0: 0, 1e-4: 0, 1e-6: 4}
    assert (points[1e-4].worst, points[1e-4].posed) == (1e-2, 1e-4)
    assert [row[4] for row in tables(swept())["sweep"].rows] == [0, 4, "-"]
    assert [row[1] for row in tables(swept())["sweep"].rows] == ["0.0001", "1e-06", "table"]
    upper, lower = draw_work_precision(swept(), by_problem(swept())).axes
    assert [line.get_label() for line in upper.lines] == ["fast"]
    assert np.asarray(lower.lines[0].get_ydata()).tolist() == [1.0] * 10 + [0.0] * 2


def test_runs_of_the_sweep_are_in_no_other_table() -> None:
    whole = swept()
    ours, theirs = tables(whole), tables(whole.isel(attempt=whole["settings"].values == "scaled"))
    assert set(ours) - set(theirs) == {"work_precision", "sweep"}
    for name, table in theirs.items():
        assert table.rows == ours[name].rows, name


def test_busy_machine_is_told_and_processor_time_can_be_compared() -> None:
    whole = invented(["slow", "fast"])
    assert waiting_note(whole) is None
    waited = whole.copy(deep=True)
    waited["run_time"] = waited["run_time"] * np.where(waited["solver"].values == "fast", 10.0, 1.0)
    note = waiting_note(waited)
    assert note is not None
    assert "fast 10" in note
    assert "slow" not in note
    assert note in comparison_report(waited)
    assert [one[0] for one in methods(by_problem(waited), LIMIT)] == ["slow", "fast"]
    by_processor = waited.assign_attrs(time="processor")
    assert [one[0] for one in methods(by_problem(by_processor), LIMIT)] == ["fast", "slow"]
    label = draw_data_profile(by_processor, by_problem(by_processor)).axes[0].get_xlabel()
    assert label == "processor time of a call, the package's share included [ms]"
    assert waiting_note(waited.assign_attrs(threads=4)) is None
    work = swept().assign_attrs(time="processor")
    drawn = draw_work_precision(work, by_problem(work))
    assert drawn.axes[0].get_ylabel() == "median processor time [ms]"
    assert not any("run time" in text.get_text() for text in drawn.findobj(Text))


def test_a_legend_of_one_panel_speaks_of_no_other() -> None:
    whole = invented(["slow", "fast"])
    raw = whole.assign(settings=("attempt", ["raw"] * whole.sizes["attempt"]))
    both = xr.concat([whole, raw], "attempt", combine_attrs="override")
    for table, words in ((whole, "legend: the best first"), (both, "legend: the best of the first panel first")):
        drawn = draw_data_profile(table, by_problem(table))
        assert any(words in text.get_text() for text in drawn.findobj(Text))


def test_a_solver_that_polishes_itself_is_named_beside_the_sweep() -> None:
    assert "polishes its own answer" not in comparison_report(swept())
    osqp = swept()
    osqp = osqp.assign(solver=("attempt", ["osqp"] * osqp.sizes["attempt"]))
    assert "`osqp` polishes its own answer" in comparison_report(osqp)


# Style of the figures


def test_lines_of_many_solvers_differ_in_grey_as_well() -> None:
    solvers = [f"solver-{number}" for number in range(16)]
    problems = pd.DataFrame({"solver": ["native", *solvers]})
    found = [style(name, problems) for name in solvers]
    assert len({one["color"] for one in found[:11]}) == 11
    assert len({(one["marker"], one["dashes"]) for one in found}) == 16


def test_panels_have_one_order_and_no_native_among_raw_runs() -> None:
    table = invented(["slow", "fast"])
    native = invented(["fast"])
    native["solver"] = ("attempt", ["native"] * native.sizes["attempt"])
    raw = table.copy(deep=True)
    raw["settings"] = ("attempt", ["raw"] * raw.sizes["attempt"])
    raw["run_time"] = raw["run_time"] * np.where(raw["solver"].values == "fast", 100.0, 1.0)  # another order alone
    whole = xr.concat([native, table, raw], "attempt", combine_attrs="override")
    found = dict(panels(by_problem(whole), LIMIT))
    assert [one[0] for one in found["scaled"] if one[0] != "native"] == ["fast", "slow"]
    assert [one[0] for one in found["raw"]] == ["fast", "slow"]
    assert "native" in [one[0] for one in found["scaled"]]


def test_growth_is_left_out_where_sizes_span_too_little() -> None:
    whole = invented(["fast"])  # of 20 to 80 segments
    assert size_groups(by_problem(whole)) == ["load"]
    few = whole.isel(attempt=whole["size"].values > 20)
    assert size_groups(by_problem(few)) == []
    assert "Neither tabulated nor drawn" in comparison_report(few)


def test_solver_without_tolerance_is_a_point_of_work_and_precision() -> None:
    both = swept()
    native = both.isel(attempt=both["settings"].values == "scaled").copy(deep=True)
    native["solver"] = ("attempt", ["native"] * native.sizes["attempt"])
    whole = xr.concat([both, native], "attempt", combine_attrs="override")
    upper, _ = draw_work_precision(whole, by_problem(whole)).axes
    (line,) = [one for one in upper.lines if one.get_label() == "native (no tolerance)"]
    assert len(np.asarray(line.get_xdata())) == 1
