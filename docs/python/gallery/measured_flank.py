"""
A measured flank
================

Deviations of a flank on the grid of a measuring machine, their global errors, and the machine settings that cancel
them.
"""

import matplotlib.pyplot as plt

import easeoff
from easeoff.cases import gear_pair
from easeoff.geometry import corrective_settings, fit_global_errors
from easeoff.geometry.formats import flank_deviation
from easeoff.study import measured_file

pair = gear_pair(easeoff.read_case("fm-11x41"))
grid = measured_file("fm-11x41-worn-pinion")  # read_measured_grid reads a file of your own
deviation = flank_deviation(grid, pair.pinion)

errors = fit_global_errors(deviation)
for name in ("spiral_angle", "pressure_angle", "lengthwise_crowning", "profile_crowning", "twist"):
    print(f"{name:34}{getattr(errors.errors, name):+8.2f} um")
correction = corrective_settings(pair.pinion, deviation)
for name, change in correction.changes.items():
    print(f"{name:34}{change:+10.5f}")  # mm, rad or per radian
print(f"scatter {1e3 * correction.rms_before:.2f} um, after the correction {1e3 * correction.rms:.2f} um")

measured = grid["deviation"].squeeze()
figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
image = axes.pcolormesh(measured.values, cmap="RdBu_r", vmin=-10, vmax=10, edgecolors="w")
figure.colorbar(image, label="deviation [um], positive: more metal")
axes.set(xlabel="column, toe to heel", ylabel="row, root to tip")
plt.show()
