"""Correction report: global errors and corrective settings of a measured flank, as text."""

from __future__ import annotations

import math
from dataclasses import asdict

from tabulate import tabulate

from ...geometry.cutting.named_settings import BLADE_STEPS, MACHINE_STEPS, get_setting
from ...geometry.deviation.corrective_settings import corrective_settings
from ...geometry.deviation.deviation import Deviation
from ...geometry.deviation.global_errors import angle_errors, fit_global_errors
from ...geometry.deviation.measurement import zeroed
from ...geometry.pair.gear_pair import Member
from ...geometry.tooth.tooth_flanks import side

COLUMNS = ("left", "right", "right", "right")


def correction_report(name: str, member: Member, deviation: Deviation) -> str:
    """Report of the global errors of a measured flank and the settings that cancel them.

    Parameters
    ----------
    name
        ``pinion`` or ``gear``.
    member
        The member, seen from the measured flank.
    deviation
        Deviation of the measured flank from the designed one.

    Returns
    -------
    str
        Two tables, with the root mean square of what remains.
    """
    turned = zeroed(deviation, member.loaded)
    found, correction = fit_global_errors(turned), corrective_settings(member, turned)
    angles = dict(zip(("spiral_angle", "pressure_angle"), angle_errors(found.errors, member), strict=True))
    errors = [
        (key, f"{value:+.1f}", f"{60.0 * math.degrees(angles[key]):+.2f}" if key in angles else "")
        for key, value in asdict(found.errors).items()
    ]
    changes = []
    for key, change in correction.changes.items():
        plain = key in BLADE_STEPS or key in MACHINE_STEPS
        angle = plain and (key.endswith("angle") or key in ("cutter_tilt", "cutter_swivel"))
        unit = 180.0 / math.pi if angle else 1.0
        start = get_setting(member.loaded, key)
        changes.append((key, f"{unit * start:.6f}", f"{unit * change:+.6f}", f"{unit * (start + change):.6f}"))
    return "\n".join(
        [
            f"{name}, {side(member.loaded)} flank: global errors, um of metal at the edges of the flank",
            tabulate(errors, headers=["error", "um", "minutes"], disable_numparse=True, colalign=COLUMNS[:3]),
            f"rms {found.rms_before:.2f} um, without these {found.rms:.2f} um",
            "",
            "corrective settings, mm and degrees",
            tabulate(
                changes, headers=["setting", "designed", "change", "to set"], disable_numparse=True, colalign=COLUMNS
            ),
            f"rms {1e3 * correction.rms_before:.2f} um, after the correction {1e3 * correction.rms:.2f} um; a rotation "
            "of the tooth is left out",
        ]
    )
