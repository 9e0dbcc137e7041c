"""
A pinion fitted to a target ease-off
====================================

Machine settings of the pinion that give a wanted crowning, by least squares.
"""

from dataclasses import replace

import matplotlib.pyplot as plt

import easeoff
from easeoff.cases import gear_pair
from easeoff.geometry import EaseOffTarget, ease_off, fit_pinion

pair = gear_pair(easeoff.read_case("nasa-12x36"))
fit = fit_pinion(pair, EaseOffTarget(lengthwise_crowning=0.030, profile_crowning=0.010))  # mm
for name, (start, end) in fit.moved.items():
    print(f"{name:34}{start:12.5f} -> {end:12.5f}")

fitted = replace(pair, pinion=replace(pair.pinion, loaded=fit.surface))
figure, panels = plt.subplots(1, 2, figsize=(9, 3.2), sharey=True, layout="constrained")
for axes, each, title in zip(panels, (pair, fitted), ("as published", "fitted"), strict=True):
    surface = ease_off(each, (31, 21))
    inside = surface["ease_off"].where(surface["inside"] == 1)
    inside.plot.contourf(x="lengthwise", y="profile", levels=11, ax=axes)
    axes.set(title=title, xlabel="toe to heel", ylabel="root to tip")
plt.show()
