"""Derivatives of a mesh cycle as a dataset: ease-off, roll angle, unloaded and loaded contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.attributes import labelled
from ....core.ordered_values import ordered
from ....geometry.pair.field_slopes import field_slopes
from ....geometry.pair.pair_setting import PairSetting
from ...loaded_cases import HARMONIC_ORDER_COUNT, LoadedCase, rotation_numbers
from ...mesh_cycle import MeshCycle
from ...pair_errors import ENVELOPE_REFINEMENT
from .bending_slopes import BendingSlopes
from .field_directions import FieldDirections
from .line_motion import line_motion
from .loaded_slopes import CaseSlopes, case_slopes
from .segment_slopes import EdgePieces, SegmentSlopes
from .unloaded_slopes import UnloadedSlopes, unloaded_slopes

Array = NDArray[Any]

_GRID = ("lengthwise", "profile")
#: Variables of the ease-off and of the loaded contact that are differentiated.
ON_FLANK = ("ease_off", "ease_off_angle", "roll_angle", "lever_arm")
OF_LOAD = (
    "transmission_error",
    "mean_level",
    "peak_to_peak",
    "harmonic",
    "rms",
    "load_share",
    "edge_share",
    "force",
    "pressure",
    "max_pressure",
)


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


def cycle_slopes(
    cycle: MeshCycle, settings: Sequence[PairSetting], loaded: xr.Dataset, cases: Sequence[LoadedCase]
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
    >>> values, slopes = cycle_slopes(cycle, settings, *cycle.loaded([100.0], edge_contact=False))
    >>> dict(slopes["transmission_error"].sizes)
    {'torque': 1, 'mesh_position': 2, 'setting': 3}
    """
    by_node = field_slopes(cycle.geometry, settings)
    told = cycle.geometry.ease_off
    bends = {name: ordered(told, name, *_GRID) for name in ("separation_curvature", "separation_skew")}
    directions = FieldDirections.of(cycle.fields, bends, by_node)
    edges = any(np.any(np.isfinite(case.segments.line_contact.overhang)) for case in cases)
    pieces = EdgePieces.of(cases) if edges else None
    slopes = SegmentSlopes.of(cycle.segments, directions, line_motion(directions, cycle.lines), pieces)
    found = case_slopes(slopes, BendingSlopes.of(directions, slopes), cases, 1e3 * cycle.ratio)
    values: dict[str, Any] = {name: told[name] for name in ON_FLANK} | {name: loaded[name] for name in OF_LOAD}
    data: dict[str, Any] = {}
    for name, (dims, change) in ease_off_slopes(cycle, by_node).items():
        data[name] = (dims, np.pad(change, ((0, 0), (0, 0), (0, 1))))
    data |= _loaded(loaded, found)
    numbers = _unloaded(unloaded_slopes(cycle.geometry, cycle.lines, settings, by_node))
    values |= numbers[0]
    coords: dict[str, Any] = {name: loaded[name] for name in ("torque", "mesh_position", "order", "pair")}
    coords |= {name: told[name] for name in _GRID}
    return labelled(xr.Dataset(values, coords=coords).drop_attrs(deep=False)), xr.Dataset(
        data | numbers[1], coords=coords
    )


def _unloaded(found: UnloadedSlopes) -> tuple[dict[str, Any], dict[str, Any]]:
    """Numbers of the unloaded transmission error [urad], and their derivatives, by the torque none."""
    fine, change = 1e6 * found.error[None], 1e6 * np.pad(found.slopes, ((0, 0), (0, 1)))[None]
    names = ("mean_level", "harmonic", "rms")
    own, by_setting = rotation_numbers(fine), _rotation_slopes(fine, change, HARMONIC_ORDER_COUNT)
    values = {f"unloaded_{name}": (own[name][0][1:], own[name][1][0]) for name in names}
    data = {f"unloaded_{name}": (by_setting[name][0][1:], by_setting[name][1][0]) for name in names}
    envelope = "unloaded_transmission_error_envelope"
    values[envelope] = (("mesh_position",), fine[0, ::ENVELOPE_REFINEMENT])
    data[envelope] = (("mesh_position", "setting"), change[0, ::ENVELOPE_REFINEMENT])
    values["unloaded_peak_to_peak"] = ((), 1e6 * found.peak_to_peak)
    data["unloaded_peak_to_peak"] = (("setting",), 1e6 * np.append(found.peak_slopes, 0.0))
    return values, data


def _loaded(loaded: xr.Dataset, found: Sequence[CaseSlopes]) -> dict[str, Any]:
    """Derivatives of the variables of the loaded contact, with their dimensions."""
    cycle, count = (loaded.sizes["torque"], loaded.sizes["mesh_position"]), found[0].rotation.size
    pairs, size = loaded["pair"].values, loaded.sizes["segment"]
    rotation = np.full((*cycle, count), np.nan)
    share = np.full((*cycle, pairs.size, count), np.nan)
    on_edges = np.full((*cycle, count), np.nan)
    of_segments = {name: np.full((*cycle, size, count), np.nan) for name in ("force", "pressure")}
    for one in found:
        at, here = (one.case.torque, one.case.mesh_position), one.case.segments
        rotation[at] = 1e6 * one.rotation
        whole = one.case.problem.torque
        moments = here.lever_arm * one.case.solution.force

        def of_whole(own: Array, one: CaseSlopes = one, moments: Array = moments, whole: float = whole) -> Array:
            # The moments add up to the torque, which the last setting changes.
            part = one.moment[own].sum(axis=0) / whole
            part[-1] -= moments[own].sum() / whole * one.moment[:, -1].sum() / whole
            return np.asarray(part)

        for number, pair in enumerate(pairs):
            share[at][number] = of_whole(here.pair == pair)
        on_edges[at] = of_whole(here.edge >= 0)
        of_segments["force"][at][: here.pair.size] = one.force
        of_segments["pressure"][at][: here.pair.size] = one.pressure
    error = ordered(loaded, "transmission_error", "torque", "mesh_position")
    data: dict[str, Any] = {"transmission_error": (("torque", "mesh_position", "setting"), rotation)}
    data |= _rotation_slopes(error, rotation, loaded.sizes["order"])
    data["load_share"] = (("torque", "mesh_position", "pair", "setting"), share)
    data["edge_share"] = (("torque", "mesh_position", "setting"), on_edges)
    for name, values in of_segments.items():
        data[name] = (("torque", "mesh_position", "segment", "setting"), values)
    pressure = ordered(loaded, "pressure", "torque", "mesh_position", "segment")
    flat, slopes = pressure.reshape(cycle[0], -1), of_segments["pressure"].reshape(cycle[0], -1, count)
    greatest = np.argmax(np.where(flat > 0.0, flat, -np.inf), axis=1)
    data["max_pressure"] = (("torque", "setting"), slopes[np.arange(cycle[0]), greatest])
    return data


def _rotation_slopes(error: Array, slopes: Array, orders: int) -> dict[str, Any]:
    """Derivatives of the numbers of a transmission error (t, k) over the mesh cycle, from its own (t, k, j)."""
    rows, count = np.arange(len(error)), error.shape[1]
    spectrum, change = np.fft.rfft(error, axis=1), np.fft.rfft(slopes, axis=1)
    scale = np.full(spectrum.shape[1], 2.0 / count)
    if count % 2 == 0:
        scale[-1] /= 2.0  # as in ``mesh_harmonics``
    amplitude = scale * np.abs(spectrum)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = np.real(np.conj(spectrum / np.abs(spectrum))[..., None] * change) * scale[:, None]
    harmonic = np.zeros((len(error), orders, slopes.shape[2]))
    kept = min(orders, spectrum.shape[1] - 1)
    harmonic[:, :kept] = along[:, 1 : kept + 1]
    first = slice(1, min(3, kept) + 1)
    rms = np.sqrt(np.sum(amplitude[:, first] ** 2, axis=1))
    by_rms = np.sum(amplitude[:, first, None] * along[:, first], axis=1) / rms[:, None]
    ends = slopes[rows, np.argmax(error, axis=1)] - slopes[rows, np.argmin(error, axis=1)]
    return {
        "mean_level": (("torque", "setting"), slopes.mean(axis=1)),
        "peak_to_peak": (("torque", "setting"), ends),
        "harmonic": (("torque", "order", "setting"), harmonic),
        "rms": (("torque", "setting"), by_rms),
    }
