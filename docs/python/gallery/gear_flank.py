"""
A flank in space
================

A flank is the envelope of its cutter: points, normals and curvatures from machine settings.
"""

import matplotlib.pyplot as plt
import numpy as np

import easeoff
from easeoff.cases import gear_pair
from easeoff.geometry import flank

pair = gear_pair(easeoff.read_case("nasa-12x36"))
gear = flank(pair.gear, (25, 15))
x, y, z = np.moveaxis(gear["position"].values, -1, 0)
print(gear["position"].attrs["units"], gear["position"].dims)

# %%
# Turned about its axis it makes all teeth.

figure = plt.figure(figsize=(6, 5), layout="constrained")
axes = figure.add_subplot(projection="3d")
for angle in 2 * np.pi * np.arange(36) / 36:
    turned = np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
    axes.plot_surface(*turned, z, color="tab:blue" if angle else "tab:orange", linewidth=0)
axes.set_aspect("equal")
axes.set_axis_off()
axes.view_init(elev=65, azim=30)
plt.show()
