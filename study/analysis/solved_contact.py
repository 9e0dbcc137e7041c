"""Solved contact of a pair in mesh: the values of its analysis, and their derivatives when they are asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ...contact.compliance.finite_elements.finite_element_tooth import FiniteElementTooth
from ...contact.evaluation.cycle_slopes import CycleSlopes, cycle_values
from ...contact.evaluation.unloaded_slopes import unloaded_slopes
from ...contact.loaded import LoadedCase
from ...contact.solvers import Status
from ...core.attributes import labelled
from ...core.checks import shown, truth
from ...core.errors import InputError
from ...core.process_settings import one_blas_thread
from ..case_in_mesh import CaseInMesh
from ..sweep.swept_quantity import swept_quantity
from .contact_analysis import case_torques
from .friction_analysis import friction_settings, operation_of
from .named_setting import chosen_settings

if TYPE_CHECKING:
    from ...friction import FrictionModel, Operation


@dataclass(frozen=True, eq=False)
class SolvedContact:
    """Contact problems of a pair in mesh, solved and certified; ``of`` makes it.

    Parameters
    ----------
    state
        The case in mesh.
    loaded, cases
        From ``MeshCycle.loaded``.
    edge_contact
        Whether tooth edges could touch.
    operation
        Operating conditions of friction; ``None`` for no losses.
    friction_model
        Models of friction; ``None`` for the dissertation's.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> solved = SolvedContact.of(CaseInMesh.of(case), [100.0])
    >>> values, changes = solved.differentiated(["E"], unloaded=False)
    >>> changes["peak_to_peak"].dims, values.equals(solved.values(unloaded=False))
    (('torque', 'setting'), True)
    """

    state: CaseInMesh
    loaded: xr.Dataset
    cases: list[LoadedCase]
    edge_contact: bool
    operation: Operation | None
    friction_model: FrictionModel | None

    @classmethod
    @one_blas_thread()
    def of(
        cls,
        state: CaseInMesh,
        torques: float | Sequence[float] | None = None,
        *,
        edge_contact: bool | None = None,
        operation: Operation | None = None,
        friction_model: FrictionModel | None = None,
    ) -> SolvedContact:
        """Solve the contact; arguments and errors as of ``contact_derivatives``."""
        case = state.case
        if state.deflections is not None or case.supports is not None:
            raise InputError("derivatives need rigid supports: leave out [supports] and deflections over the torque")
        if state.deviations:
            raise InputError(
                "derivatives need flanks without measured deviations: take modification.TERM for small ones"
            )
        if case.compliance.model == "shell":
            raise InputError("compliance.model = 'shell': must be 'solid_shell' or 'fe' for derivatives")
        load = case_torques(case, torques)
        edges = case.contact.edge_contact if edge_contact is None else truth("edge_contact", edge_contact)
        loaded, cases = state.cycle.loaded(load, edge_contact=edges)
        if not all(one.solution.status == Status.CERTIFIED for one in cases):
            raise InputError(f"torques = {shown(load.tolist())}: must be such that every contact problem is certified")
        operation = operation_of(case.friction) if operation is None else operation
        model, _ = friction_settings(case, operation, friction_model, None)
        return cls(state, loaded, cases, edges, operation, model)

    def values(self, *, unloaded: bool = True) -> xr.Dataset:
        """What ``contact_derivatives`` has as ``values``; without load only if asked."""
        cycle = self.state.cycle
        errors = unloaded_slopes(cycle.geometry, cycle.lines, (), {}) if unloaded else None
        values = cycle_values(cycle, self.loaded, self.cases, self._roots, errors)
        if self.operation is None:
            return values
        from ...friction import FrictionModel
        from .loss_slopes import loss_values

        return values.merge(loss_values(cycle, self.loaded, self.operation, self.friction_model or FrictionModel()))

    @one_blas_thread()
    def differentiated(
        self, settings: Sequence[str] | None = None, *, unloaded: bool = True
    ) -> tuple[xr.Dataset, xr.Dataset]:
        """Values and derivatives, as ``contact_derivatives`` has them; without load only if asked."""
        chosen, names = chosen_settings(self.state.pair, self.state.flank, settings)
        found = CycleSlopes.of(self.state.cycle, [one.setting for one in chosen], self.cases)
        values, slopes = found.datasets(self.loaded, self._roots, unloaded=unloaded)
        if self.operation is not None:
            from ...friction import FrictionModel
            from .loss_slopes import loss_slopes

            of_loss = loss_slopes(found, self.loaded, self.operation, self.friction_model or FrictionModel())
            values, slopes = (one.merge(other) for one, other in zip((values, slopes), of_loss, strict=True))
        order = [len(chosen) if name == "torque" else [one.name for one in chosen].index(name) for name in names]
        factors = xr.DataArray(np.array([*(one.factor for one in chosen), 1.0])[order], dims="setting")
        changes = labelled(
            (slopes.isel(setting=order) * factors).assign_coords(
                setting=("setting", names),
                setting_units=("setting", [swept_quantity(name).units for name in names]),
            )
        )
        for variable in changes.data_vars.values():
            variable.attrs["units"] += " per setting_units"
            variable.attrs["long_name"] = f"derivative of: {variable.attrs['long_name']}"
        return values, changes

    @property
    def _roots(self) -> tuple[FiniteElementTooth, FiniteElementTooth] | None:
        """Teeth whose root stress is known."""
        teeth = self.state.teeth
        with_roots = self.state.case.compliance.model == "fe" and all(tooth.root is not None for tooth in teeth or ())
        return teeth if with_roots else None
