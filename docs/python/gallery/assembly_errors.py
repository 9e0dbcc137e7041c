"""
Assembly errors
===============

The pair in mesh, ``MeshCycle``, computes a further misalignment without repeating what does not change.
"""

import matplotlib.pyplot as plt
import numpy as np

import easeoff
from easeoff.cases import gear_pair
from easeoff.contact import MeshCycle
from easeoff.geometry import Misalignment, pair_geometry

cycle = MeshCycle.of(pair_geometry(gear_pair(easeoff.read_case("fm-11x41"))), mesh_positions=16)
offsets = np.linspace(-0.3, 0.0, 7)
unloaded = [cycle.misaligned(Misalignment(offset=offset, pinion_axial=0.1)).unloaded() for offset in offsets]

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
left.plot(offsets, [each.attrs["peak_to_peak"] for each in unloaded], marker="o")
left.set(xlabel="E, change of the offset [mm]", ylabel="peak to peak, unloaded [urad]")
right.plot(offsets, [100 * each["path_lengthwise"].sel(pair=0).mean().item() for each in unloaded], marker="o")
right.set(xlabel="E [mm]", ylabel="middle of the path [% from toe]")
plt.show()
