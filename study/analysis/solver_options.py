"""Further keywords of an analysis: settings of its solver, told from misspelt arguments before any work."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Mapping
from inspect import Parameter, signature
from typing import Any

from pydantic import BaseModel

from ...cases.schema.case_schema import ComplianceTable, ContactTable
from ...contact.solvers import SOLVERS, SolverChoice, require_solver
from ...contact.solvers.solver_limits import Limits
from ...core.checks import one_of, shown
from ...core.errors import InputError, suggestion

#: What ``contact.solve`` takes of an analysis, whichever solver it calls. Starts are those of the torque before.
OPTIONS = ("tolerance", "time_limit", "max_iterations", "polish", "form")
#: Tables of a case whose keys are no arguments.
TABLES: Mapping[str, type[BaseModel]] = {"contact": ContactTable, "compliance": ComplianceTable}
#: Likeness of an argument and a name that may be a setting of a solver, and least length of such a name.
LIKENESS, LENGTH_MINIMUM = 0.8, 5


def require_solver_options(options: Mapping[str, Any], solver: SolverChoice, function: Callable[..., Any]) -> None:
    """Refuse keywords that no solver can mean.

    Parameters
    ----------
    options
        The keywords.
    solver
        Solver of the analysis. The native one takes ``OPTIONS`` and ``method``; the settings of others are theirs, and
        only a name that is near an argument is refused.
    function
        What was called: its arguments are suggested.

    Raises
    ------
    InputError
        If a keyword is no option, with the nearest argument, or how a key of the case is changed; or a limit is out of
        range.
    MissingSolverError
        If the solver's package is not installed.

    Examples
    --------
    >>> from easeoff import analyze
    >>> try:
    ...     require_solver_options({"torque": 100.0}, "auto", analyze)
    ... except InputError as error:
    ...     print(str(error).partition(";")[0])
    torque = 100: must be an argument of analyze or an option of its solver
    """
    name = require_solver(solver)
    Limits(*(options.get(limit) for limit in OPTIONS[:3]))
    native = name == "native"
    known = (*OPTIONS, "method") if native else (*OPTIONS, *_settings(name))
    words = [key for key, one in signature(function).parameters.items() if one.kind is not Parameter.VAR_KEYWORD]
    for option, value in options.items():
        if option in known:
            continue
        near = suggestion(option, [*words, *OPTIONS, *(("method",) if native else ())])
        table = next((key for key, fields in TABLES.items() if option in fields.model_fields), "")
        head = f"{option} = {shown(value)}: must be an argument of {function.__name__} or an option of its solver"
        if table:
            change = f'update={{"{table}": case.{table}.model_copy(update={{"{option}": ...}})}}'
            raise InputError(f"{head}; it is a key of the case's [{table}]: change it by case.model_copy({change})")
        if native or _is_near(option, words):
            raise InputError(head + (near or f"; native takes {', '.join(known)}"))
    if native and "method" in options:
        from ...contact.solvers.native import METHODS

        one_of("method", options["method"], ("cascade", *METHODS))


def _settings(name: str) -> tuple[str, ...]:
    """Settings of a solver that its table knows; there may be others."""
    if name not in SOLVERS:
        return ()
    entry = SOLVERS[name]
    return tuple(filter(None, (*entry.settings, entry.time_setting, entry.step_setting)))


def _is_near(option: str, words: Iterable[str]) -> bool:
    """Whether a name is a misspelt argument rather than a setting that is not known here."""
    near = difflib.get_close_matches(option.lower(), words, n=1, cutoff=LIKENESS)
    return len(option) >= LENGTH_MINIMUM and bool(near)
