"""
Ease-off of a pair
==================

The ease-off is the distance of a pair from an exactly conjugate one, over the gear flank. It takes no analysis under
load.
"""

import matplotlib.pyplot as plt

import easeoff
from easeoff.cases import gear_pair
from easeoff.geometry import ease_off

pair = gear_pair(easeoff.read_case("fm-11x41"))  # the drive side; gear_pair(case, "coast") is the other
surface = ease_off(pair, (41, 25))
print(surface["ease_off"].sel(lengthwise=0.5, profile=0.5, method="nearest").item(), "um in the middle")

# %%
# Only points on the common flank count: ``inside`` marks them.

figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
surface["ease_off"].where(surface["inside"] == 1).plot.contourf(x="lengthwise", y="profile", levels=13, ax=axes)
axes.set(xlabel="toe to heel", ylabel="root to tip")
plt.show()
