"""
Contact over the torque, event by event
=======================================

Between two torques at which a segment touches or parts, forces are linear in the torque. ``torque_path`` finds all of
these events.
"""

import matplotlib.pyplot as plt
import numpy as np

from easeoff.contact import ContactProblem, torque_path

x = np.linspace(-1.0, 1.0, 15)
factor = 1e-3 * np.column_stack([np.ones(15), 0.5 * x])
line = ContactProblem(0.02 * (x - 0.1) ** 2, np.full(15, 50.0), 0.0, (np.full(15, 3e-6), factor))
path = torque_path(line, 0.0, 4e5)  # N mm
print(path.status.name, path.torque.size, "events")

torques = np.unique(np.r_[path.torque, np.linspace(1e3, 4e5, 40)])
forces = np.array([path.at(torque).force for torque in torques])
figure, axes = plt.subplots(figsize=(7, 3.4), layout="constrained")
axes.plot(1e-3 * torques, forces)
axes.vlines(1e-3 * path.torque, 0.0, forces.max(), color="0.8", zorder=0)
axes.set(xlabel="torque [N m]", ylabel="force of each segment [N]")
plt.show()
