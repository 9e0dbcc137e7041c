"""Answer tables: what each solver claimed and what held, by kind of problem, residuals, and failures."""

from __future__ import annotations

from typing import Any

import xarray as xr

from ....contact.problem.certificate import EXACT_TOLERANCE
from ..comparison_table import RESIDUALS
from ..measurement.method import SETTINGS
from ..statistics.method_statistics import METHOD_COLUMNS, MethodName, of_method
from .report_table import NOTHING, ReportTable, quantiles, residual

#: Problems that a line of failures names.
NAMED_PROBLEM_LIMIT = 3
#: Head of the column of problems whose file gives them no kind.
WITHOUT_KIND = "without a kind"


def success_tables(dataset: xr.Dataset, problems: Any, named: list[MethodName]) -> list[ReportTable]:
    """Claims against certificates, a table for each settings."""
    columns = ["problems", "says solved", "certified", "%", "exact", "polished", "says solved, not certified", "denied"]
    tables = []
    for settings in dict.fromkeys(method[1] for method in named):
        rows: list[list[Any]] = []
        for method in [one for one in named if one[1] == settings]:
            found = of_method(problems, method)
            counts = {name: int(found[name].sum()) for name in ("claims", "certified", "exact", "polished")}
            share = f"{100.0 * found['certified'].mean():.4g}"
            rows.append(
                [
                    *method,
                    len(found),
                    counts["claims"],
                    counts["certified"],
                    share,
                    counts["exact"],
                    counts["polished"],
                    int(found["uncertified"].sum()),
                    int(found["denied"].sum()),
                ]
            )
        caption = f"`{settings}`: {SETTINGS[settings]}."
        tables.append(ReportTable(f"answers_{settings}", [*METHOD_COLUMNS, *columns], rows, "", caption))
    return tables


def success_note(dataset: xr.Dataset) -> str:
    """What the columns of the success tables mean."""
    return (
        f"*Certified*: the largest violation of a condition on the problem as it was given is at most "
        f"{dataset.attrs['tolerance']:g}, *exact*: at most {EXACT_TOLERANCE:g}, in every repetition. *Polished*: the "
        "answer is that of one linear solve on the active set that the solver found, without exchange of segments; if "
        "the set was wrong, the answer stays as it was. *Says solved, not certified*: the solver may have kept its own "
        "criterion, which is another: it bounds the sum of the products of force and gap (duality gap), the "
        "certificate the smaller one of the two on every segment, which goes like the root of that. *Denied*: "
        "certified, but does not say solved. The best are first.\n"
    )


def kind_table(problems: Any, named: list[MethodName]) -> ReportTable | None:
    """Certified problems by kind, where the files have kinds."""
    kinds = [kind for kind in dict.fromkeys(problems["kind"]) if kind]
    if not kinds:
        return None
    heads = list(kinds)
    if (problems["kind"] == "").any():
        kinds, heads = [*kinds, ""], [*kinds, WITHOUT_KIND]
    rows = []
    for method in named:
        found = of_method(problems, method)
        of_kind = [found[found["kind"] == kind]["certified"] for kind in kinds]
        rows.append([*method, *(f"{int(one.sum())} of {len(one)}" if len(one) else NOTHING for one in of_kind)])
    return ReportTable("certified_by_kind", [*METHOD_COLUMNS, *heads], rows, "", "Certified, by kind of problem:")


def residual_tables(dataset: xr.Dataset, named: list[MethodName]) -> list[ReportTable]:
    """Certificates and errors of rotation, and which condition is violated."""
    frame: Any = dataset.to_dataframe()
    rows: list[list[Any]] = []
    parts: list[list[Any]] = []
    for method in named:
        found = of_method(frame, method)
        worst, rotation = (quantiles(found[name]) for name in ("worst_residual", "rotation_error"))
        posed = quantiles(found["posed_residual"])
        rows.append([*method, int(found["worst_residual"].notna().sum()), *map(residual, [*worst, *posed, *rotation])])
        parts.append([*method, *(residual(quantiles(found[name])[2]) for name in RESIDUALS)])
    levels = ["median", "90 %", "worst"]
    posed_head, rotation_head = ([f"{name}, {level}" for level in levels] for name in ("as posed", "rotation"))
    head = [*METHOD_COLUMNS, "answers", *levels, *posed_head, *rotation_head]
    note = (
        "Largest entry of the certificate; *as posed*: largest of primal residual, dual residual and duality gap on "
        "the problem as the solver got it, each over one plus the size of its terms, for comparison with its own "
        "tolerance; relative error of the rotation beyond first contact. Over all attempts with an answer, certified "
        "or not."
    )
    conditions = [name.replace("_", " ") for name in RESIDUALS]
    return [
        ReportTable("residuals", head, rows, note),
        ReportTable("violations", [*METHOD_COLUMNS, *conditions], parts, "", "Which condition is violated, at worst:"),
    ]


def failure_table(dataset: xr.Dataset, named: list[MethodName]) -> ReportTable | None:
    """Attempts that are not certified, by claim and words; None if there are none."""
    frame: Any = dataset.to_dataframe()
    rows: list[list[Any]] = []
    short: list[list[Any]] = []
    for method in named:
        found = of_method(frame, method)
        failed = found[found["certified"] == 0]
        for (claim, message), group in failed.groupby(["claim", "message"], sort=False):
            words = str(message).replace("|", "/").replace("`", "'")
            problems = group.drop_duplicates(["problem_file", "problem"])
            counted = [*method, claim, words, len(group), len(problems)]
            names = [row.problem_name or f"{row.problem_file} {row.problem}" for row in problems.itertuples()]
            rows.append([*counted, ", ".join(names)])
            more = ", ..." if len(names) > NAMED_PROBLEM_LIMIT else ""
            short.append([*counted, ", ".join(names[:NAMED_PROBLEM_LIMIT]) + more])
    if not rows:
        return None
    head = [*METHOD_COLUMNS, "says", "its words", "attempts", "problems", "which"]
    note = "Attempts that are not certified; `tables/failures.csv` names all their problems."
    return ReportTable("failures", head, rows, note, short_rows=short)
