"""Random drawings of bevel and hypoid pairs, typed as a design file with what a drawing shows and nothing else."""

from __future__ import annotations

import math

import numpy as np

#: Radii of face-milling cutters [mm], most of whole or half inches of diameter; hobs by radius [mm] and blade groups.
MILLS = (6.35, 13.97, 19.05, 25.4, 34.925, 44.45, 57.15, 63.5, 76.2, 95.25, 114.3, 133.35, 152.4, 203.2, 228.6, 304.8)
HOBS = ((25, 5), (30, 7), (39, 7), (51, 7), (64, 11), (76, 13), (88, 13), (105, 13), (125, 13), (150, 17), (175, 19))
LARGEST_PITCH_ANGLE = math.radians(86.0)


def drawing(seed: int, number: int) -> str:
    """Design file: 5 to 20 pinion teeth, ratio 1 to 10, module 0.8 to 12, shaft angle 60 to 120 degrees."""
    rng = np.random.default_rng([seed, number])
    while True:
        pinion = int(rng.integers(5, 21))
        gear = max(pinion, round(pinion * math.exp(rng.uniform(0.0, math.log(10.0)))))
        shaft = 90.0 if rng.random() < 0.7 else float(rng.integers(60, 121))
        sine, cosine = math.sin(math.radians(shaft)), math.cos(math.radians(shaft))
        pitch_angle = math.atan2(sine, pinion / gear + cosine)
        if pitch_angle < LARGEST_PITCH_ANGLE:
            break
    module = math.exp(rng.uniform(math.log(0.8), math.log(12.0)))
    diameter = round(module * gear, 1)
    outer = diameter / 2.0 / math.sin(pitch_angle)
    width = round(min(0.3 * outer, 10.0 * module) * rng.uniform(0.85, 1.0), 1)
    offset = 0.0
    if rng.random() < 0.5 and gear > 1.8 * pinion:
        offset = round(rng.uniform(0.04, 0.22 if gear > 2.5 * pinion else 0.12) * diameter, 1)
    middle = outer - 0.5 * width
    hob = min(HOBS, key=lambda each: abs(each[0] - middle * rng.uniform(0.85, 1.1)))
    hobbed = rng.random() < 0.45 and 0.6 < hob[0] / middle < 1.5
    spiral = 0.0 if not offset and not hobbed and rng.random() < 0.1 else float(rng.integers(25, 38))
    lean = math.degrees(math.asin(min(0.9, 2.0 * offset / (diameter - width * math.sin(pitch_angle)))))
    angle, name = (
        (round(spiral + lean), "pinion") if offset and (not hobbed or rng.random() < 0.4) else (spiral, "gear")
    )
    radius: float = hob[0] if hobbed else min(MILLS, key=lambda each: abs(each - middle * rng.uniform(0.75, 1.15)))
    pressure = float(rng.choice([20.0, 20.0, 20.0, 19.0, 22.5]))
    sides = [f"nominal_{side}_pressure_angle = {pressure}" for side in ("drive", "coast")]
    lines = [
        "easeoff_design = 1",
        f'title = "{pinion}x{gear}, module {module:.2f}, shaft angle {shaft:g}, offset {offset:g}, cutter {radius:g}"',
        *(["[pair]"] if offset or shaft != 90.0 else []),
        *([f"shaft_angle = {shaft}"] if shaft != 90.0 else []),
        *([f"hypoid_offset = {offset}"] if offset else []),
        "[blank_design]",
        f"gear_outer_pitch_diameter = {diameter}",
        f"gear_face_width = {width}",
        f"{name}_mean_spiral_angle = {float(angle)}",
        f"cutter_radius = {float(radius)}",
        *([f"number_of_blade_groups = {hob[1]}"] if hobbed else []),
        *(sides if pressure != 20.0 else []),
        "[pinion]",
        f"number_of_teeth = {pinion}",
        f'hand_of_spiral = "{rng.choice(["left", "right"])}"',
        "[gear]",
        f"number_of_teeth = {gear}",
    ]
    return "\n".join(lines) + "\n"
