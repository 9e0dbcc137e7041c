"""Operating conditions and reported numbers: label, unit, factor and format of each in one place."""

from __future__ import annotations

#: Operating conditions of friction: labels of axes, and units.
CONDITION_LABELS = {
    "speed": "speed of the pinion [1/min]",
    "torque": "torque at the pinion [N m]",
    "temperature": "oil temperature [°C]",
    "roughness": "RMS roughness [µm]",
}
CONDITION_UNITS = {"torque": "N m", "speed": "1/min", "temperature": "°C", "roughness": "µm"}
