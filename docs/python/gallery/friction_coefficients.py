"""
Friction coefficients of a contact
==================================

Models of the friction coefficient over the rolling velocity, for one contact of two flanks.
"""

import matplotlib.pyplot as plt
import numpy as np

from easeoff.friction import friction_coefficient

rolling = np.geomspace(1.0, 20.0, 60)  # m/s
figure, axes = plt.subplots(figsize=(7, 3.6), layout="constrained")
for name in ("kolivand_blended", "mixed_lubrication", "xu_kahraman", "benedict_kelly"):
    coefficient = friction_coefficient(
        hertz_pressure=0.9e9,  # Pa
        equivalent_radius=0.020,  # m
        rolling_velocity=rolling,
        slide_to_roll=0.4,
        roughness=0.5e-6,  # m RMS
        temperature=90.0,  # degC
        model=name,
    )
    axes.semilogx(rolling, coefficient, label=name)
axes.set(xlabel="rolling velocity [m/s]", ylabel="friction coefficient", ylim=(0, None))
axes.legend()
plt.show()
