"""Friction added to an analysis: its operating conditions and models, from what is given and else from the case."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import xarray as xr

from ...cases.analysis_size import KEPT_VALUES_LIMIT
from ...cases.schema.case_schema import Case
from ...contact.solvers import SolverChoice
from ...core.checks import instance
from ...core.errors import InputError
from .joined_analysis import OVER_TORQUE, Analysis, joined_analysis

if TYPE_CHECKING:
    from ...cases.schema.friction_table import FrictionTable
    from ...friction import FrictionModel, Operation


def with_friction(
    found: Analysis,
    operation: Operation,
    model: FrictionModel | None = None,
    *,
    feedback: bool = False,
    solver: SolverChoice = "auto",
    progress: Callable[[], None] | None = None,
    stage: Callable[[str], None] | None = None,
) -> Analysis:
    """An analysis with the group ``friction`` added to it.

    Parameters
    ----------
    found
        The analysis.
    operation
        Operating conditions.
    model
        Models of friction coefficient, film and rolling; the dissertation's if left out.
    feedback, solver, progress, stage
        As ``friction_feedback`` and so on of ``analyze``.
    """
    if stage is not None:
        stage("friction")
    if not found.parts:
        losses = _losses(found, operation, model, feedback, solver, progress)
        return Analysis({**found.groups, "friction": losses}, found.cases)
    # All parts keep fields over the segments, or none, by the size of the whole.
    loaded = found.groups["loaded"].sizes
    size = loaded["torque"] * loaded["mesh_position"] * loaded["segment"] * math.prod(operation.shape)
    parts = []
    for places, part in found.parts:
        losses = _losses(part, operation, model, feedback, solver, progress, segment_fields=size <= KEPT_VALUES_LIMIT)
        parts.append((places, replace(part, groups={**part.groups, "friction": losses})))
    return joined_analysis(parts, {name: group for name, group in found.groups.items() if name not in OVER_TORQUE})


def _losses(
    found: Analysis,
    operation: Operation,
    model: FrictionModel | None,
    feedback: bool,
    solver: SolverChoice,
    progress: Callable[[], None] | None,
    segment_fields: bool | None = None,
) -> xr.Dataset:
    """The group ``friction`` of an analysis whose ease-off is that of all its torques."""
    from ...friction import friction
    from ...friction import friction_feedback as with_feedback

    tree = xr.DataTree.from_dict({name: found.groups[name] for name in ("ease_off", "loaded")})
    if feedback:
        return with_feedback(tree, found.cases, operation, model, solver=solver, progress=progress)
    return friction(tree, operation, model, segment_fields=segment_fields, progress=progress)


def friction_settings(
    case: Case, operation: Operation | None, model: FrictionModel | None, feedback: bool | None
) -> tuple[FrictionModel | None, bool]:
    """Friction models and whether friction is fed back: what is given, or else the case's own.

    Raises
    ------
    InputError
        If they are given without operating conditions, the model is none, or the oil has no data for a temperature.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> friction_settings(read_case("nasa-12x36"), None, None, None)
    (None, False)
    """
    if case.friction is not None:
        model = case.friction.model() if model is None else model
        feedback = case.friction.feedback if feedback is None else feedback
    if operation is not None:
        from ...friction import FrictionModel, Operation

        model = FrictionModel() if model is None else model
        instance("operation", operation, Operation)
        instance("friction_model", model, FrictionModel)
        model.oil_states(operation)  # a temperature the oil has no data for shows before the work, not after
    elif model is not None or feedback:
        raise InputError("speed = None: must be given [1/min] for friction_model and friction_feedback")
    return model, bool(feedback)


def operation_of(table: FrictionTable | None, **conditions: Any) -> Operation | None:
    """Operating conditions from what was given of them and else from a case; ``None`` without a speed in either.

    Parameters
    ----------
    table
        The case's own conditions.
    **conditions
        Arguments of ``friction.Operation``; those that are ``None`` count as not given.

    Raises
    ------
    InputError
        If other conditions are given and no speed, or a value is not possible.

    Examples
    --------
    >>> operation_of(None, speed=1000.0, temperature=None).temperature
    90.0
    """
    given = {name: value for name, value in conditions.items() if value is not None}
    if table is not None:
        return table.operation(**given)
    if "speed" not in given:
        if given:
            raise InputError(
                f"{' and '.join(given)} without a speed: friction needs the speed of the pinion in 1/min, here or in a "
                "table [friction] of the case"
            )
        return None
    from ...friction import Operation

    return Operation(**given)
