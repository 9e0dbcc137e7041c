"""Wear in words: revolutions and steps, greatest depths, and the transmission error before and after."""

from __future__ import annotations

import xarray as xr


def wear_summary(history: xr.Dataset) -> str:
    """Lines on a history of wear, those of ``easeoff wear`` and ``easeoff show``.

    Parameters
    ----------
    history
        Of ``study.wear``, or read from its file.

    Examples
    --------
    >>> import easeoff
    >>> from easeoff.study import WearLaw, wear
    >>> coarse = {"mesh_positions": 4, "segments_per_line": 9, "lengthwise_nodes": 11, "profile_nodes": 9}
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> history = wear(case, WearLaw(1e-12, 1e-12, revolutions=1e5), torque=100.0)
    >>> print(wear_summary(history).splitlines()[1].partition(":")[0])
    largest depth
    """
    last = history.isel(step=-1)
    depths = ", ".join(f"{m} {float(last['largest_depth'].sel(member=m)):.2f} um" for m in ("pinion", "gear"))
    steps = history.sizes["step"] - 1
    lines = [
        f"{history.attrs.get('stop', 'ended')}, {float(last['revolutions']):.4g} revolutions in {steps} steps",
        f"largest depth: {depths}",
        "contact on lines alone, without tooth edges",
    ]
    if "deflections" in history.attrs:
        lines.append(f"deflections: {history.attrs['deflections']}")
    for torque in history["torque"].values:
        at = history.sel(torque=torque)
        first, final = (float(at["peak_to_peak"][step]) for step in (0, -1))
        lines.append(f"peak to peak at {torque:g} N m: {first:.1f} to {final:.1f} urad")
        pressures = [float(at["max_pressure"][step]) for step in (0, -1)]
        lines.append(f"greatest pressure at {torque:g} N m: {pressures[0]:.0f} to {pressures[1]:.0f} MPa")
    return "\n".join(lines)
