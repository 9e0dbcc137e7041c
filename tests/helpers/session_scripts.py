"""Session scripts as another program writes them."""

from __future__ import annotations

from typing import Any

Machine = dict[str, float]


BLANKS = {
    "PINION": {
        "NTEETH": 12, "PITCHANGLE": 18.4333333, "FACEANGLE": 22.3166667, "ROOTANGLE": 16.8666666, "PITCHAPEX": 0.1,
        "FACEAPEX": -0.0577, "ROOTAPEX": 0.2, "OUTERCONEDIST": 93.7609, "FACEWIDTH": 25.4095, "FRONTANGLE": 17.0,
        "BACKANGLE": 18.0,
    },
    "GEAR": {
        "NTEETH": 36, "PITCHANGLE": 71.5666667, "FACEANGLE": 73.1333333, "ROOTANGLE": 67.6833333, "PITCHAPEX": 0.0,
        "FACEAPEX": -0.2248, "ROOTAPEX": 0.0, "OUTERCONEDIST": 93.8099, "FACEWIDTH": 25.4585, "FRONTANGLE": 68.0,
        "BACKANGLE": 69.0,
    },
}  # fmt: skip


MACHINES: dict[str, dict[str, Machine]] = {
    "PINION": {
        "CONCAVE": {
            "RADIALSETTING": 74.8742, "CRADLEANGLE": 63.9420, "ROOTANGLE": 16.8667, "BLANKOFFSET": 3.9262,
            "SLIDINGBASE": 0.2965, "MACHCTRBACK": -1.0219, "RATIOROLL": 3.24270,
        },
        "CONVEX": {
            "RADIALSETTING": 71.1467, "CRADLEANGLE": 53.9260, "ROOTANGLE": 16.8667, "BLANKOFFSET": -4.4262,
            "SLIDINGBASE": -0.3990, "MACHCTRBACK": 1.3752, "RATIOROLL": 3.10518,
        },
    },
    "GEAR": {
        "CONCAVE": {"RADIALSETTING": 72.6427, "CRADLEANGLE": 59.2342, "ROOTANGLE": 67.6833, "RATIOROLL": 1.0516744},
        "CONVEX": {"RADIALSETTING": 72.6427, "CRADLEANGLE": 59.2342, "ROOTANGLE": 67.6833, "RATIOROLL": 1.0516744},
    },
}  # fmt: skip


CUTTERS = {
    "PINION": {
        "CONCAVE": {"POINTRADIUS": 75.3268, "BLADEANGLE": 18.0457},
        "CONVEX": {"POINTRADIUS": 78.0112, "BLADEANGLE": 24.3374},
    },
    "GEAR": {
        "CONCAVE": {"POINTRADIUS": 77.0255, "BLADEANGLE": 22.0},
        "CONVEX": {"POINTRADIUS": 75.3745, "BLADEANGLE": 22.0},
    },
}


def script(
    hand: str,
    machines: dict[str, dict[str, Machine]],
    *,
    named: bool = True,
    formate: bool = False,
    cutters: dict[str, dict[str, dict[str, Any]]] | None = None,
) -> str:
    """A script as one would write it, or without the names of the flanks, as the public writer of scripts does."""
    lines = ["SESFILENAME", "pair.ses", "EDIT", "PAIRS", f"\tHAND_PINION {hand}", "EXIT", "ROTOR"]
    for number, member in enumerate(("PINION", "GEAR"), start=1):
        own = hand if member == "PINION" else "LEFT" if hand == "RIGHT" else "RIGHT"
        lines += [f"ROTOR {number}", "HYPOID", "NHYPOIDS 1", "HYPOID 1", f"TYPE FACEMILLED_{member}"]
        if member == "GEAR":
            lines.append(f"GEAR_TYPE {'formate' if formate else 'generated'}")
        lines += ["COMMON", f"HAND {own}", "SPIRALANGLE 35.0", *(f"{k} {v!r}" for k, v in BLANKS[member].items())]
        lines += ["USE_SPRD_BLD_THICKNESS TRUE", "EXIT  //EXIT COMMON"]
        for flank in ("CONCAVE", "CONVEX"):
            if named:
                lines.append(flank)
            lines += ["MACHINE", *(f"\t\t{k} {v!r}" for k, v in machines[member][flank].items()), "EXIT", "// MACHINE"]
            cutter = (cutters or CUTTERS)[member][flank]
            lines += ["CUTTER", *(f"{k} {v}" for k, v in ({"USENEWCUTTER": "TRUE"} | cutter).items()), "EXIT", "EXIT"]
        lines.append("EXIT")
    return "\n".join([*lines, "EXIT", ""])
