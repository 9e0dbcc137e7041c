"""
Shafts and bearings
===================

Where pinion and gear go under load when shafts bend and bearings give way, and what becomes of the contact.
"""

import matplotlib.pyplot as plt

import easeoff
from easeoff.geometry import Misalignment

case = easeoff.read_case("fm-11x41")
at_rest = {"torques": [50, 150, 300, 450], "misalignment": Misalignment()}
supported = easeoff.analyze(case, supports="axle-fm-11x41", **at_rest)
rigid = easeoff.analyze(case, **at_rest)
under_load = supported["misalignment"].to_dataset().mean("mesh_position")
print(under_load["offset"].values, "mm offset")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
for name, label in (("offset", "E"), ("pinion_axial", "P"), ("gear_axial", "G")):
    left.plot(under_load["torque"], under_load[name], marker="o", label=label)
left.set(xlabel="torque at the pinion [N m]", ylabel="displacement [mm]")
left.legend()
for tree, label in ((rigid, "rigid"), (supported, "on shafts and bearings")):
    right.plot(tree["loaded/torque"], tree["loaded/max_pressure"], marker="o", label=label)
right.set(xlabel="torque at the pinion [N m]", ylabel="greatest pressure [MPa]")
right.legend()
plt.show()
