"""
Transmission error over the torque
==================================

A torque at which the motion error of the flanks compensates the deflection of the teeth is quietest.
"""

import matplotlib.pyplot as plt

import easeoff

tree = easeoff.analyze("fh-12x41-45", torques=[25, 50, 100, 200, 350, 500])
loaded = tree["loaded"].to_dataset()

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
error = loaded["transmission_error"]
(error - error.mean("mesh_position")).sel(torque=[25, 50, 200, 500]).plot.line(x="mesh_position", ax=left)
left.set(xlabel="mesh position", ylabel="error less its mean [urad]")
left.set_ylim(top=15)
left.legend(["25 N m", "50", "200", "500"], ncols=4, loc="upper center", fontsize="small")
for order in (1, 2, 3):
    right.plot(loaded["torque"], loaded["harmonic"].sel(order=order), marker="o", label=f"order {order}")
right.set(xlabel="torque at the pinion [N m]", ylabel="amplitude [urad]")
right.legend()
plt.show()
