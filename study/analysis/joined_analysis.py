"""An analysis as labelled groups, and analyses of several assemblies joined along the torque into one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.loaded import LoadedCase
from ...core.attributes import labelled
from ...geometry.pair.assembly import Misalignment

Array = NDArray[Any]

#: Groups over the torque, joined from those of the assemblies.
OVER_TORQUE = ("misalignment", "supports", "loaded", "root_stress", "friction")
#: Attributes of a group that count something in one assembly: of several the greatest stands.
COUNTS = ("searched_segments",)


@dataclass(frozen=True)
class Analysis:
    """An analysis with what does not go into the file.

    Parameters
    ----------
    groups
        The labelled results by the name of their group; ``/`` is that of the whole.
    cases
        Every solved case with its contact problem.
    parts
        Analyses of the assemblies it is joined from, with the numbers of their torques; empty if there is one assembly.

    Examples
    --------
    >>> list(Analysis({"unloaded": xr.Dataset()}, cases=[]).tree.children)
    ['unloaded']
    """

    groups: Mapping[str, xr.Dataset]
    cases: list[LoadedCase]
    parts: tuple[tuple[tuple[int, ...], Analysis], ...] = ()

    @cached_property
    def tree(self) -> xr.DataTree:
        """The labelled results as one tree."""
        return xr.DataTree.from_dict(self.groups)


def joined_analysis(parts: Sequence[tuple[Sequence[int], Analysis]], common: Mapping[str, xr.Dataset]) -> Analysis:
    """Analyses of several assemblies as one, along the torque.

    Segments are padded with NaN to the greatest number; tooth pairs that an assembly does not know carry nothing.

    Parameters
    ----------
    parts
        The numbers that the torques of each analysis have in the whole, and the analysis: its groups ``loaded`` and, if
        it has them, ``misalignment``, ``root_stress`` and ``friction``. All have the same groups, variables and mesh
        positions. ``friction_analysis.with_friction`` needs their ``ease_off``, too.
    common
        The groups of the whole that are not over the torque.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> from easeoff.geometry import Misalignment
    >>> from easeoff.study import CaseInMesh
    >>> from easeoff.study.analysis.contact_analysis import contact_analysis
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> state = CaseInMesh.of(case.model_copy(update={"contact": case.contact.model_copy(update=coarse)}))
    >>> light, heavy = contact_analysis(state, 100.0), contact_analysis(state.misaligned(Misalignment(0.05)), 300.0)
    >>> whole = joined_analysis([((1,), light), ((0,), heavy)], {"ease_off": light.groups["ease_off"]})
    >>> whole.tree["loaded/torque"].values.tolist()
    [300.0, 100.0]
    """
    numbered = tuple((tuple(places), part) for places, part in parts)
    groups = dict(common)
    for name in OVER_TORQUE:
        if name in numbered[0][1].groups:
            groups[name] = _joined([part.groups[name] for _, part in numbered], [places for places, _ in numbered])
    cases = [replace(case, torque=places[case.torque]) for places, part in numbered for case in part.cases]
    torques = groups["loaded"]["torque"].values
    # In the order of one analysis: neighbouring torques of a mesh position stand together.
    cases.sort(key=lambda case: (case.mesh_position, float(torques[case.torque])))
    return Analysis(groups, cases, numbered)


def misalignment_group(misalignments: Sequence[Misalignment], torques: Array, mesh_positions: Array) -> xr.Dataset:
    """The group ``misalignment`` of a result, where it is the same at all mesh positions of a torque.

    Parameters
    ----------
    misalignments
        Of every torque (t).
    torques
        At the pinion (t) [N m].
    mesh_positions
        Mesh positions (k).

    Examples
    --------
    >>> misalignment_group([Misalignment(offset=0.1)], np.array([100.0]), np.array([0.0, 0.5]))["offset"].values
    array([[0.1, 0.1]])
    """
    names = ("offset", "pinion_axial", "gear_axial", "shaft_angle")
    shape = (len(misalignments), len(mesh_positions))
    data = {
        name: (
            ("torque", "mesh_position"),
            np.broadcast_to(np.array([[getattr(one, name)] for one in misalignments]), shape).copy(),
        )
        for name in names
    }
    return labelled(xr.Dataset(data, coords={"torque": torques, "mesh_position": mesh_positions}))


def _joined(parts: list[xr.Dataset], places: list[tuple[int, ...]]) -> xr.Dataset:
    """Datasets joined along the torque, in the order of its numbers."""
    order = np.argsort(np.concatenate([np.asarray(one) for one in places]), kind="stable")
    segments = max(part.sizes.get("segment", 0) for part in parts)
    pairs = np.unique(np.concatenate([part["pair"].values for part in parts])) if "pair" in parts[0].dims else None
    data: dict[str, xr.Variable] = {}
    for name, first in parts[0].variables.items():
        own = [part.variables[name] for part in parts]
        if name == "pair":
            data["pair"] = first.copy(data=pairs) if own[0].sizes == own[-1].sizes else xr.Variable("pair", pairs)
            data["pair"].attrs = dict(first.attrs)
        elif "torque" in first.dims or "segment" in first.dims:
            # What depends on the segments alone is another thing in every assembly.
            if "torque" not in first.dims:
                own = [_repeated(one, len(at)) for one, at in zip(own, places, strict=True)]
            if "pair" in first.dims and pairs is not None:
                own = [_of_pairs(one, part["pair"].values, pairs) for one, part in zip(own, parts, strict=True)]
            if "segment" in first.dims:
                own = [_padded(one, segments) for one in own]
            own = [one.transpose(*own[0].dims) for one in own]
            axis = own[0].dims.index("torque")
            values = np.take(np.concatenate([one.values for one in own], axis=axis), order, axis=axis)
            data[str(name)] = xr.Variable(own[0].dims, values, first.attrs)
        else:
            data[str(name)] = first
    attributes = {name: value for part in reversed(parts) for name, value in part.attrs.items()}
    attributes |= {name: max(part.attrs[name] for part in parts) for name in COUNTS if name in attributes}
    coordinates = {name: data.pop(str(name)) for name in map(str, parts[0].coords)}
    return xr.Dataset(data, coords=coordinates, attrs=attributes)


def _repeated(variable: xr.Variable, torques: int) -> xr.Variable:
    """A variable over as many torques, the same at each."""
    values = np.broadcast_to(variable.values, (torques, *variable.shape))
    return xr.Variable(("torque", *variable.dims), values, variable.attrs)


def _of_pairs(variable: xr.Variable, known: Array, pairs: Array) -> xr.Variable:
    """A variable over further tooth pairs, which carry nothing: zero, or NaN where there is no solution."""
    axis = variable.dims.index("pair")
    zero = 0.0 * np.take(variable.values, [0], axis=axis)
    values = np.repeat(zero, pairs.size, axis=axis)
    values[(slice(None),) * axis + (np.searchsorted(pairs, known),)] = variable.values
    return xr.Variable(variable.dims, values, variable.attrs)


def _padded(variable: xr.Variable, segments: int) -> xr.Variable:
    """A variable over further segments, which there are none: NaN, or zero for numbers of flags."""
    more = segments - variable.sizes["segment"]
    fill = np.nan if variable.dtype.kind == "f" else 0
    return variable if more == 0 else variable.pad(segment=(0, more), constant_values=fill)
