"""Root stress of both teeth over a mesh cycle, under the contact forces of every case."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..core.attributes import labelled
from ..core.checks import instance, instances
from ..core.errors import InputError
from ..geometry.pair.gear_pair import MEMBERS
from .compliance.elastic_model import member_points
from .compliance.finite_elements.finite_element_tooth import FiniteElementTooth
from .compliance.finite_elements.flank_compliance import spread_shares
from .lines.flank_splines import FlankSplines
from .loaded import LoadedCase
from .solvers import Status

LENGTHWISE_STATION_COUNT = 41
Teeth = tuple[FiniteElementTooth, FiniteElementTooth]  # pinion and gear


def root_stress(splines: FlankSplines, teeth: Teeth, cases: list[LoadedCase], loaded: xr.Dataset) -> xr.Dataset:
    """Largest tensile stress in the roots of the loaded sides of both members.

    A tooth of either member goes through all tooth pairs of the mesh cycle; the largest over mesh positions and pairs
    is the largest it ever feels.

    Parameters
    ----------
    splines
        Splines from ``loaded_splines``.
    teeth
        Pinion and gear by finite elements.
    cases
        Solved cases.
    loaded
        Their dataset, for the coordinates.

    Returns
    -------
    xr.Dataset
        ``root_stress`` (torque, member, lengthwise) over the cycle, ``root_stress_history`` (torque, member,
        mesh_position, pair) over the face, and ``max_root_stress`` (torque, member) [MPa]; NaN where a case is not
        certified.

    Raises
    ------
    InputError
        If a tooth is a solid shell, or cut by a blade without an edge radius: the stress in a sharp root has no limit.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> from easeoff.study import CaseInMesh
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 5, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("fm-11x41")
    >>> tables = {"contact": coarse, "compliance": {"model": "fe", "fineness": 0.3}}
    >>> changed = {name: getattr(case, name).model_copy(update=table) for name, table in tables.items()}
    >>> state = CaseInMesh.of(case.model_copy(update=changed))
    >>> loaded, cases = state.cycle.loaded([200.0])
    >>> root_stress(state.cycle.fields, state.teeth, cases, loaded)["max_root_stress"].dims
    ('torque', 'member')
    """
    instance("splines", splines, FlankSplines)
    instances("teeth", teeth, FiniteElementTooth, 2)
    instances("cases", cases, LoadedCase)
    instance("loaded", loaded, xr.Dataset)
    if lost := {"torque", "mesh_position", "pair"} - set(loaded.coords):
        raise InputError(f"loaded = dataset without {', '.join(sorted(lost))}: must be that of the cases")
    from scipy.sparse import csc_array

    certified = [case for case in cases if case.solution.status == Status.CERTIFIED]
    pairs, lengthwise = loaded["pair"].values, np.linspace(0.0, 1.0, LENGTHWISE_STATION_COUNT)
    shape = (loaded.sizes["torque"], loaded.sizes["mesh_position"], pairs.size)
    known = np.zeros(shape[:2], dtype=bool)
    where, force, column = [np.empty((2, 2, 0))], [np.empty(0)], [np.empty(0, dtype=np.int64)]
    for case in certified:
        known[case.torque, case.mesh_position] = True
        where.append(np.stack([case.segments.pinion_point, case.segments.point]))
        force.append(case.solution.force)
        tooth_pair = np.searchsorted(pairs, case.segments.pair)
        column.append(np.ravel_multi_index((case.torque, case.mesh_position, tooth_pair), shape))
    points, forces, columns = np.concatenate(where, axis=2), np.concatenate(force), np.concatenate(column)
    history = np.full((shape[0], 2, *shape[1:]), np.nan)
    greatest = np.full((shape[0], 2), np.nan)
    along = np.full((shape[0], 2, LENGTHWISE_STATION_COUNT), np.nan)
    for member, tooth in enumerate(teeth):
        if tooth.root is None:
            raise InputError(tooth.no_root)
        on_member = member_points(splines, MEMBERS[member], points[member])
        nodes, shares = spread_shares(tooth.flank.lengthwise, tooth.flank.profile, on_member)
        on_nodes = csc_array(
            ((shares * forces[:, None]).ravel(), (nodes.ravel(), np.repeat(columns, nodes.shape[1]))),
            shape=(tooth.flank.profile.size, int(np.prod(shape))),
        )
        stress = tooth.root.largest(on_nodes.toarray()).reshape(-1, *shape)
        stress[:, ~known] = np.nan
        history[:, member] = stress.max(axis=0)
        whole = np.where(known[None, :, :, None], stress, -np.inf).max(axis=(2, 3)).T
        for index in range(shape[0]):
            if known[index].any():
                greatest[index, member] = whole[index].max()
                along[index, member] = np.interp(lengthwise, tooth.root.lengthwise, whole[index])
    dims = ("torque", "member", "mesh_position", "pair")
    return labelled(
        xr.Dataset(
            {
                "root_stress": (("torque", "member", "lengthwise"), along),
                "root_stress_history": (dims, history),
                "max_root_stress": (("torque", "member"), greatest),
            },
            coords={
                "torque": loaded["torque"].values,
                "member": list(MEMBERS),
                "mesh_position": loaded["mesh_position"].values,
                "pair": pairs,
                "lengthwise": lengthwise,
            },
        )
    )
