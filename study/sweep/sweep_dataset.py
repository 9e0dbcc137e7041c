"""Dataset of a sweep, filled batch by batch: key numbers and status over the swept coordinates."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import variable_attributes
from ..analysis.swept_quantity import swept_quantity
from .batch_analysis import Block
from .sweep_file import PointStatus
from .sweep_plan import PointTable, SweepSetup

NOT_COMPUTED = -1  # value of a number with meanings where a point failed
ROW_NAMES = {"sample": "number of the sample", "load_case": "number of the load case"}


class SweepNumbers:
    """Numbers of a sweep as they arrive."""

    def __init__(self, table: PointTable, setup: SweepSetup) -> None:
        self.table, self.setup = table, setup
        self.status = np.full((table.count, *setup.loads), PointStatus.FAILED, dtype=np.int8)
        self.reason = np.full(self.status.shape, "", dtype=object)
        self._numbers: dict[str, Array] = {}
        self._variables: dict[str, Any] = {}
        self._coordinates: dict[str, list[Any]] = {}

    def add(self, block: Block) -> None:
        """Take in the numbers of a batch."""
        self.status[block.rows] = block.status
        self.reason[block.rows] = block.reason
        if not block.layout:
            return
        layout = json.loads(block.layout)
        for name, values in layout["coordinates"].items():
            self._coordinates.setdefault(name, values)
        for name, variable in layout["variables"].items():
            if name not in self._numbers:
                self._numbers[name] = np.full((self.table.count, *block.numbers[name].shape[1:]), np.nan)
                self._variables[name] = variable
            self._numbers[name][block.rows] = block.numbers[name]

    def dataset(self) -> xr.Dataset:
        """The dataset over the swept coordinates."""
        shape, outer = self.table.shape, tuple(axis.name for axis in self.table.axes)
        loads = () if self.setup.torques is None else ("torque",)
        data: dict[str, Any] = {}
        for name, values in self._numbers.items():
            variable = self._variables[name]
            dims = (*outer, *variable["dimensions"])
            data[name] = self._variable(name, dims, values.reshape((*shape, *values.shape[1:])), variable["flags"])
        status = self.status.reshape((*shape, *self.status.shape[1:]))
        data["status"] = xr.Variable(
            (*outer, *loads),
            status,
            {**PointStatus.flag_attributes(), "long_name": "how the analysis of a point ended"},
        )
        reason = self.reason.astype(str).reshape(status.shape)
        data["reason"] = xr.Variable(
            (*outer, *loads), reason, {"long_name": "why a point is not certified; empty where it is"}
        )
        return xr.Dataset(data, coords=self._coords(outer))

    def _coords(self, outer: tuple[str, ...]) -> dict[str, Any]:
        coords: dict[str, Any] = {}
        for axis in self.table.axes:
            for name, values in axis.columns.items():
                quantity = swept_quantity(name)
                attributes = {"long_name": quantity.long_name} | ({"units": quantity.units} if quantity.units else {})
                coords[name] = xr.Variable((axis.name,), values, attributes)
            if axis.name not in axis.columns:
                attributes = {"long_name": ROW_NAMES[axis.name], "units": "1"}
                coords[axis.name] = xr.Variable((axis.name,), np.arange(axis.size), attributes)
        if self.setup.torques is not None:
            self._coordinates.setdefault("torque", list(self.setup.torques))
        for name, along in self._coordinates.items():
            if name not in outer:
                coords[name] = self._variable(name, (name,), np.asarray(along), {})
        return coords

    @staticmethod
    def _variable(name: str, dims: tuple[str, ...], values: Array, flags: dict[str, Any]) -> xr.Variable:
        attributes = variable_attributes(name)
        if flags:
            whole = np.where(np.isnan(values), NOT_COMPUTED, values).astype(np.int8)
            meanings = {
                "flag_values": np.array([*flags["flag_values"], NOT_COMPUTED], dtype=np.int8),
                "flag_meanings": f"{flags['flag_meanings']} not_computed",
            }
            return xr.Variable(dims, whole, attributes | meanings)
        return xr.Variable(dims, values, attributes)
