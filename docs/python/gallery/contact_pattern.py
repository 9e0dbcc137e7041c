"""
Contact pattern under load
==========================

Analyse a shipped pair at one torque, and draw the pressure where the flanks touch over the mesh cycle.
"""

import matplotlib.pyplot as plt

import easeoff

tree = easeoff.analyze("fm-11x41", torques=[250.0])
loaded = tree["loaded"].to_dataset().sel(torque=250.0)
print(f"{loaded['max_pressure'].item():.0f} MPa, {loaded['peak_to_peak'].item():.1f} urad peak to peak")
print("every mesh position certified:", bool((loaded["status"] == 0).all()))

# %%
# Every segment of a contact line has a place on the gear flank, a force and a pressure.

touching = loaded["force"].values > 0.0
figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
points = axes.scatter(*(loaded[name].values[touching] for name in ("lengthwise", "profile")), s=14,
                      c=loaded["pressure"].values[touching])  # fmt: skip
figure.colorbar(points, label="pressure [MPa]")
axes.set(xlim=(0, 1), ylim=(0, 1), xlabel="toe to heel", ylabel="root to tip", title="fm-11x41 at 250 N m")
plt.show()
