"""
Efficiency over torque and speed
================================

Friction of a stored or fresh result at any speed, oil and roughness; the contact is not solved again.
"""

import matplotlib.pyplot as plt
import numpy as np

import easeoff
from easeoff.friction import Operation, friction

tree = easeoff.analyze("fh-design-a", torques=[50, 100, 200, 300, 500])
operation = Operation(speed=np.linspace(500.0, 4000.0, 8), temperature=90.0, roughness=0.5)
losses = friction(tree, operation)
efficiency = 100 * losses["efficiency"].squeeze()
print(efficiency.round(2).to_pandas())

figure, axes = plt.subplots(figsize=(7, 3.6), layout="constrained")
lines = axes.contourf(losses["speed"], losses["torque"], efficiency.transpose("torque", "speed"), levels=12)
figure.colorbar(lines, label="efficiency of the mesh [%]")
axes.set(xlabel="speed of the pinion [1/min]", ylabel="torque at the pinion [N m]")
plt.show()
