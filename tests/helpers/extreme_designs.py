"""Designs at the edges of what is cut: shaft angles, ratios, modules, spiral angles, tapers, offsets."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Extreme:
    """Basic data of one design, lengths by its outer module [mm and degrees].

    The cutter radius is given over the gear's mean cone distance, the offset over its outer pitch diameter.
    """

    teeth: tuple[int, int]
    module: float = 4.0
    shaft: float = 90.0
    spiral: float = 35.0
    offset: float = 0.0
    groups: int = 0
    taper: str = "standard"
    generated: bool = False
    cutter: float = 1.0
    face: float = 0.28
    addendum: float = 0.3
    thickness: float = 0.06

    def text(self, method: str) -> str:
        """Its design file, with a target in proportion to the root of the module."""
        diameter = self.module * self.teeth[1]
        sigma = math.radians(self.shaft)
        pitch = math.atan2(math.sin(sigma), self.teeth[0] / self.teeth[1] + math.cos(sigma))
        distance = diameter / 2.0 / math.sin(pitch)
        face = self.face * distance
        crowning = 20.0 * math.sqrt(self.module)
        bevel = self.offset == 0.0
        lines = [
            "easeoff_design = 1",
            f'title = "{self}"',
            "[pair]",
            f"shaft_angle = {self.shaft}",
            f"hypoid_offset = {self.offset * diameter:.4f}",
            "[blank_design]",
            f"method = {0 if bevel else 1}",
            f'process = "{"face_hobbed" if self.groups else "face_milled"}"',
            f"{'gear' if bevel else 'pinion'}_mean_spiral_angle = {self.spiral}",
            f"gear_outer_pitch_diameter = {diameter:.4f}",
            f"gear_face_width = {face:.4f}",
            f"cutter_radius = {self.cutter * (distance - face / 2.0):.3f}",
            f"gear_mean_addendum_factor = {self.addendum}",
            "depth_factor = 2.0",
            "clearance_factor = 0.125",
            f"thickness_factor = {self.thickness}",
            f"limit_pressure_angle_influence = {0.0 if bevel else 1.0}",
            f'depth_taper = "{"uniform" if self.groups else self.taper}"',
            *([f"number_of_blade_groups = {self.groups}"] if self.groups else []),
            "[pinion]",
            f"number_of_teeth = {self.teeth[0]}",
            'hand_of_spiral = "left"',
            f'method = "{method}"',
            "[gear]",
            f"number_of_teeth = {self.teeth[1]}",
            f'generation = "{"generated" if self.generated else "formate"}"',
        ]
        for side in ("drive", "coast"):
            lines += [f"[target.{side}]", f"lengthwise_crowning = {crowning:.2f}"]
            lines += [f"profile_crowning = {crowning / 3.0:.2f}"]
        return "\n".join(lines) + "\n"


#: Thirty-one designs by what is extreme about them.
EXTREMES: dict[str, Extreme] = {
    "shaft angle 60": Extreme((16, 40), shaft=60.0),
    "shaft angle 60, ratio 1": Extreme((25, 25), shaft=60.0, generated=True, addendum=0.5, thickness=0.0),
    "shaft angle 60, hobbed": Extreme((14, 42), shaft=60.0, groups=11),
    "shaft angle 75, generated": Extreme((17, 34), shaft=75.0, generated=True, taper="constant_slot_width"),
    "shaft angle 75, hypoid": Extreme((12, 41), shaft=75.0, offset=0.1, spiral=45.0),
    "shaft angle 105": Extreme((14, 39), shaft=105.0),
    "shaft angle 105, hobbed hypoid": Extreme((13, 41), shaft=105.0, offset=0.1, spiral=44.0, groups=13),
    "shaft angle 120": Extreme((24, 42), shaft=120.0),
    "shaft angle 120, generated, hobbed": Extreme((25, 42), shaft=120.0, generated=True, groups=13),
    "ratio 1": Extreme((23, 23), generated=True, addendum=0.5, thickness=0.0),
    "ratio 1, hobbed": Extreme((24, 24), generated=True, groups=11, addendum=0.5, thickness=0.0),
    "ratio 1.2, Formate": Extreme((25, 30), addendum=0.45, thickness=0.02),
    "ratio 6": Extreme((8, 48), addendum=0.18, thickness=0.12),
    "ratio 8, hypoid": Extreme((6, 48), offset=0.15, spiral=50.0, addendum=0.12, thickness=0.2),
    "ratio 10, hobbed": Extreme((5, 50), groups=13, addendum=0.12, thickness=0.2),
    "ratio 10, milled": Extreme((5, 50), addendum=0.12, thickness=0.2),
    "ratio 10, hypoid": Extreme((5, 50), offset=0.15, spiral=50.0, groups=13, addendum=0.1, thickness=0.2),
    "Zerol": Extreme((18, 45), spiral=0.0, generated=True, cutter=1.2),
    "Zerol, Formate": Extreme((15, 45), spiral=0.0, cutter=1.2),
    "Zerol, uniform depth": Extreme((20, 40), spiral=0.0, generated=True, taper="uniform", cutter=1.2),
    "small spiral angle, hobbed": Extreme((15, 41), spiral=10.0, groups=5, generated=True),
    "module 0.5": Extreme((14, 41), module=0.5),
    "module 0.5, hobbed": Extreme((13, 44), module=0.5, groups=11),
    "module 20": Extreme((13, 39), module=20.0),
    "module 20, generated, hobbed": Extreme((12, 37), module=20.0, generated=True, groups=7),
    "uniform depth": Extreme((14, 39), taper="uniform"),
    "uniform depth, generated": Extreme((14, 39), taper="uniform", generated=True),
    "duplex taper, small cutter": Extreme((13, 40), taper="constant_slot_width", cutter=0.75),
    "large cutter": Extreme((14, 40), taper="modified_slot_width", cutter=1.6),
    "wide hypoid offset": Extreme((10, 41), offset=0.22, spiral=50.0, addendum=0.15, thickness=0.1),
    "negative hypoid offset": Extreme((14, 41), offset=-0.08, spiral=25.0, generated=True),
}
