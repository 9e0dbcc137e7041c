"""Derivatives of the numbers of a transmission error over the mesh cycle."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...loaded_cases import HARMONIC_ORDER_COUNT, rotation_numbers
from ...pair_errors import ENVELOPE_REFINEMENT
from .unloaded_slopes import UnloadedSlopes

Array = NDArray[Any]


def rotation_slopes(error: Array, slopes: Array, orders: int) -> dict[str, Any]:
    """Derivatives of mean level, peak to peak, harmonics and rms of a transmission error, with their dimensions.

    Parameters
    ----------
    error
        Transmission error (t, k).
    slopes
        Its derivatives (t, k, j).
    orders
        Number of harmonics.

    Examples
    --------
    >>> error = np.array([[0.0, 2.0, 1.0, 1.0]])
    >>> rotation_slopes(error, error[..., None], 1)["peak_to_peak"]
    (('torque', 'setting'), array([[2.]]))
    """
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


def unloaded_numbers(found: UnloadedSlopes) -> tuple[dict[str, Any], dict[str, Any]]:
    """Numbers of the unloaded transmission error [urad], and their derivatives, which by the torque are zero.

    Parameters
    ----------
    found
        The error and its derivatives by settings.

    Returns
    -------
    tuple
        Both by name with their dimensions; the names begin with ``unloaded_``.
    """
    fine, change = 1e6 * found.error[None], 1e6 * np.pad(found.slopes, ((0, 0), (0, 1)))[None]
    names = ("mean_level", "harmonic", "rms")
    own, by_setting = rotation_numbers(fine), rotation_slopes(fine, change, HARMONIC_ORDER_COUNT)
    values = {f"unloaded_{name}": (own[name][0][1:], own[name][1][0]) for name in names}
    data = {f"unloaded_{name}": (by_setting[name][0][1:], by_setting[name][1][0]) for name in names}
    envelope = "unloaded_transmission_error_envelope"
    values[envelope] = (("mesh_position",), fine[0, ::ENVELOPE_REFINEMENT])
    data[envelope] = (("mesh_position", "setting"), change[0, ::ENVELOPE_REFINEMENT])
    values["unloaded_peak_to_peak"] = ((), 1e6 * found.peak_to_peak)
    data["unloaded_peak_to_peak"] = (("setting",), 1e6 * np.append(found.peak_slopes, 0.0))
    return values, data
