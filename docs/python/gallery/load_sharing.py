"""
Load shares of the tooth pairs
==============================

Two or three pairs of teeth carry the load at a time; over the mesh cycle one hands it on to the next.
"""

import matplotlib.pyplot as plt
import numpy as np

import easeoff

tree = easeoff.analyze("fm-11x41", torques=[100.0, 500.0])
loaded = tree["loaded"].to_dataset()
moment = loaded["force"] * loaded["lever_arm"]  # what each segment adds to the torque

figure, panels = plt.subplots(1, 2, figsize=(9, 3.2), sharey=True, layout="constrained")
for axes, torque in zip(panels, loaded["torque"].values, strict=True):
    here = moment.sel(torque=torque)
    tooth = loaded["tooth"].sel(torque=torque) if "torque" in loaded["tooth"].dims else loaded["tooth"]
    for pair in np.unique(tooth.values[np.isfinite(here.values)]):
        share = here.where(tooth == pair).sum("segment") / here.sum("segment")
        axes.plot(here["mesh_position"], 100 * share, label=f"pair {pair:.0f}")
    axes.set(title=f"{torque:.0f} N m", xlabel="mesh position", ylabel="share of the load [%]")
panels[1].legend(loc="upper right", fontsize="small")
plt.show()
