"""Derivatives of a mesh cycle as a dataset: ease-off, roll angle, unloaded and loaded contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.attributes import labelled
from ....core.checks import frozen_arrays
from ....core.ordered_values import ordered
from ....geometry.pair.field_slopes import field_slopes
from ....geometry.pair.gear_pair import MEMBERS
from ....geometry.pair.pair_setting import PairSetting
from ....geometry.pair.tooth_thickness import mean_thicknesses, thickness_slopes
from ...compliance.finite_elements.finite_element_tooth import FiniteElementTooth
from ...load_capacity.tooth_root_stress import root_stress
from ...loaded_cases import LoadedCase
from ...mesh_cycle import MeshCycle
from ..load_spot import load_spot
from .bending_slopes import BendingSlopes
from .field_directions import FieldDirections
from .line_motion import line_motion
from .load_spot_slopes import load_spot_slopes
from .load_variables import OF_LOAD, load_variables
from .loaded_slopes import CaseSlopes, case_slopes
from .root_stress_slopes import OF_ROOTS, root_stress_slopes
from .rotation_slopes import unloaded_numbers
from .segment_slopes import EdgePieces, SegmentSlopes
from .unloaded_slopes import UnloadedSlopes, unloaded_slopes

Array = NDArray[Any]

_GRID = ("lengthwise", "profile")
#: Variables of the ease-off that are differentiated.
ON_FLANK = ("ease_off", "ease_off_angle", "roll_angle", "lever_arm")


def ease_off_slopes(cycle: MeshCycle, slopes: Mapping[str, Array]) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Derivatives of ease-off and roll angle at the nodes of the gear flank, with their dimensions.

    Parameters
    ----------
    cycle
        The pair in mesh.
    slopes
        From ``geometry.pair.field_slopes``.
    """
    told = cycle.geometry.ease_off
    angle, arm = (ordered(told, name, *_GRID)[..., None] for name in ("ease_off_angle", "lever_arm"))
    fields = {name: slopes[name] for name in ("ease_off_angle", "roll_angle", "lever_arm")}
    fields["ease_off"] = 1e3 * (slopes["ease_off_angle"] * arm + angle * slopes["lever_arm"])
    return {name: ((*_GRID, "setting"), values) for name, values in fields.items()}


@frozen_arrays
@dataclass(frozen=True)
class CycleSlopes:
    """Derivatives of a mesh cycle by settings, and last by the torque; ``of`` makes them.

    Parameters
    ----------
    cycle
        The pair in mesh.
    settings
        By what is differentiated, beside the torque (j).
    nodes
        Derivatives at the nodes of the gear flank, from ``geometry.pair.field_slopes``.
    directions
        Splines of the fields and of their derivatives.
    cases
        Derivatives of every torque and mesh position (j + 1).
    """

    cycle: MeshCycle
    settings: tuple[PairSetting, ...]
    nodes: Mapping[str, Array]
    directions: FieldDirections
    cases: list[CaseSlopes]

    @classmethod
    def of(cls, cycle: MeshCycle, settings: Sequence[PairSetting], cases: Sequence[LoadedCase]) -> CycleSlopes:
        """Differentiate solved cases; arguments and errors as of ``cycle_slopes``."""
        nodes, told = field_slopes(cycle.geometry, settings), cycle.geometry.ease_off
        bends = {name: ordered(told, name, *_GRID) for name in ("separation_curvature", "separation_skew")}
        directions = FieldDirections.of(cycle.fields, bends, nodes)
        edges = any(np.any(np.isfinite(case.segments.line_contact.overhang)) for case in cases)
        pieces = EdgePieces.of(cases) if edges else None
        slopes = SegmentSlopes.of(cycle.segments, directions, line_motion(directions, cycle.lines), pieces)
        found = case_slopes(slopes, BendingSlopes.of(directions, slopes), cases, 1e3 * cycle.ratio)
        return cls(cycle, tuple(settings), nodes, directions, found)

    def datasets(
        self,
        loaded: xr.Dataset,
        roots: tuple[FiniteElementTooth, FiniteElementTooth] | None = None,
        *,
        unloaded: bool = True,
    ) -> tuple[xr.Dataset, xr.Dataset]:
        """Values and derivatives; arguments and returns as of ``cycle_slopes``, without load only if asked."""
        cycle, cases = self.cycle, [one.case for one in self.cases]
        errors = unloaded_slopes(cycle.geometry, cycle.lines, self.settings, self.nodes) if unloaded else None
        values = cycle_values(cycle, loaded, cases, roots, errors)
        data: dict[str, Any] = {}
        for name, (dims, change) in ease_off_slopes(cycle, self.nodes).items():
            data[name] = (dims, np.pad(change, ((0, 0), (0, 0), (0, 1))))
        data |= load_variables(loaded, self.cases)
        data |= load_spot_slopes(load_spot(loaded), self.cases)
        data |= {} if errors is None else unloaded_numbers(errors)[1]
        by_setting = thickness_slopes(cycle.geometry.pair, self.settings)
        data["tooth_thickness"] = (("member", "setting"), np.pad(by_setting, ((0, 0), (0, 1))))
        if roots is not None:
            data |= root_stress_slopes(self.directions, roots, self.cases, values)
        return values, xr.Dataset(data, coords=values.coords)


def cycle_values(
    cycle: MeshCycle,
    loaded: xr.Dataset,
    cases: Sequence[LoadedCase],
    roots: tuple[FiniteElementTooth, FiniteElementTooth] | None = None,
    unloaded: UnloadedSlopes | None = None,
) -> xr.Dataset:
    """Values of the variables that ``cycle_slopes`` differentiates.

    Parameters
    ----------
    cycle, loaded, cases, roots
        As of ``cycle_slopes``.
    unloaded
        From ``unloaded_slopes``; ``None`` to leave the unloaded transmission error out.
    """
    told = cycle.geometry.ease_off
    values: dict[str, Any] = {name: told[name] for name in ON_FLANK} | {name: loaded[name] for name in OF_LOAD}
    values |= load_spot(loaded)
    values |= {} if unloaded is None else unloaded_numbers(unloaded)[0]
    values["tooth_thickness"] = (("member",), mean_thicknesses(cycle.geometry.pair))
    coords: dict[str, Any] = {name: loaded[name] for name in ("torque", "mesh_position", "order", "pair")}
    coords["member"] = list(MEMBERS)
    coords |= {name: told[name] for name in _GRID}
    if roots is not None:
        stress = root_stress(cycle.fields, roots, list(cases), loaded)
        values |= {name: stress[name] for name in OF_ROOTS}
    return labelled(xr.Dataset(values, coords=coords).drop_attrs(deep=False))


def cycle_slopes(
    cycle: MeshCycle,
    settings: Sequence[PairSetting],
    loaded: xr.Dataset,
    cases: Sequence[LoadedCase],
    roots: tuple[FiniteElementTooth, FiniteElementTooth] | None = None,
) -> tuple[xr.Dataset, xr.Dataset]:
    """Numbers of a mesh cycle, and their derivatives by settings, and last by the torque.

    Parameters
    ----------
    cycle
        The pair in mesh.
    settings
        By what to differentiate, beside the torque.
    loaded, cases
        From ``cycle.loaded``.
    roots
        Teeth by finite elements whose root stress is differentiated as well.

    Returns
    -------
    tuple
        Variables of ``loaded``, of the unloaded contact and of the ease-off; and their derivatives, over ``setting`` as
        well, by mm, rad or the unit of the setting, last by the torque at the pinion [N m]. NaN where the contact has a
        kink.

    Raises
    ------
    InputError
        If the teeth are plates, or a case is not one with rigid supports.
    GeometryError
        If a contact line ends at a hole of the flank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=9)
    >>> settings = [PairSetting("pinion", "radial_distance"), PairSetting("assembly", "offset")]
    >>> values, slopes = cycle_slopes(cycle, settings, *cycle.loaded([100.0]))
    >>> dict(slopes["transmission_error"].sizes)
    {'torque': 1, 'mesh_position': 2, 'setting': 3}
    """
    return CycleSlopes.of(cycle, settings, cases).datasets(loaded, roots)
