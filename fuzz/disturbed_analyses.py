"""Analyses of cases with disturbed numbers: none crashes or warns, and nothing uncertified is shown as certified."""

from __future__ import annotations

import random
import sys
import warnings
from pathlib import Path
from typing import Any

from bases import CASES, Bases
from mutations.number_changes import disturbed
from processes import Outcome, forked

#: Largest violation of a condition that this check, computed anew, allows a certified solution: that of the package.
TOLERANCE = 1e-9


def draw(seed: int, bases: Bases) -> tuple[str, dict[str, Any]]:
    """Text of a case and arguments of its analysis."""
    rng = random.Random(f"analysis {seed}")
    text = disturbed(rng, bases[rng.choice(list(CASES))].read_text(encoding="utf-8"))
    arguments: dict[str, Any] = {"flank": rng.choice(["drive", "drive", "coast"])}
    if rng.random() < 0.7:
        arguments["torques"] = [10.0 ** rng.uniform(-3.0, 5.0) for _ in range(rng.choice([1, 1, 2]))]
    if rng.random() < 0.2:
        arguments["edge_contact"] = False
    return text, arguments


def analysis(text: str, arguments: dict[str, Any]) -> None:
    """Analyse a case, and end with 1 and a message if what is shown does not hold."""
    from easeoff import analyze
    from easeoff.cases import parse_case
    from easeoff.contact.problem.certificate import certify
    from easeoff.core.errors import EaseoffError
    from easeoff.study import CaseInMesh
    from easeoff.study.analysis.contact_analysis import contact_analysis
    from easeoff.study.summary.result_summary import result_summary
    from easeoff.study.summary.result_summary import uncertified

    edges = arguments.get("edge_contact")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            case = parse_case(text)
            tree = analyze(case, **arguments)
            shown = result_summary(tree)
            # The contact problems are not in the result: they are solved again.
            state = CaseInMesh.of(case, flank=arguments["flank"])
            solved = contact_analysis(state, tree["loaded"].to_dataset()["torque"].values, edge_contact=edges).cases
        except EaseoffError as error:
            sys.stderr.write(f"Error: {error}\n")
            sys.exit(2)
    loaded = tree["loaded"].to_dataset()
    certified = loaded["status"].values == 0
    faults = []
    for item in solved:
        if certified[item.torque, item.mesh_position]:
            worst = certify(item.problem, item.solution.force, item.solution.rotation).worst
            if not worst <= TOLERANCE:
                faults.append(
                    f"certified at torque {item.torque}, position {item.mesh_position}: violation {worst:.1e}"
                )
    for name in ("transmission_error", "force", "pressure"):
        values = loaded[name].values
        finite = values == values if name == "transmission_error" else (values == values).any(-1)
        if (finite & ~certified).any():
            faults.append(f"{name} shown where the status is not certified")
        if (certified & ~finite).any():
            faults.append(f"certified without {name}")
    if not certified.all() and not uncertified(tree):
        faults.append("uncertified solutions are not told")
    if "nan" in shown.lower().split() and certified.all():
        faults.append("NaN in the summary of a certified result")
    if faults:
        sys.stderr.write("; ".join(faults) + "\n")
        sys.exit(1)


def judge(seed: int, bases: Bases, work: Path) -> tuple[Outcome, list[str]]:
    """Analyse the disturbed case of a seed."""
    text, arguments = draw(seed, bases)
    outcome = forked(lambda: analysis(text, arguments), work, environment={"EASEOFF_CACHE": str(bases.cache)})
    if outcome.hung:
        return outcome, [f"hang: {outcome.processor_time:.0f} s of processor time"]
    if outcome.code not in (0, 2):
        return outcome, [(outcome.stderr.strip().splitlines() or [f"signal {-outcome.code}"])[-1][:200]]
    return outcome, []
