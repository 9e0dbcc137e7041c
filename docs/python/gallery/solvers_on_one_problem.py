"""
A contact problem of your own
=============================

A quadratic programme without any gear: an elastic bed whose segments lie on a parabola. Every answer is certified on
the problem as given, whoever found it.
"""

import matplotlib.pyplot as plt
import numpy as np

from easeoff.contact import ContactProblem, solve

x = np.linspace(-1.0, 1.0, 60)
modes = 1.0e-3 * np.stack([np.ones_like(x), x], axis=1)
problem = ContactProblem(
    separation=0.02 * x**2,  # mm
    lever_arm=np.full(60, 60.0),  # mm
    torque=3.0e5,  # N mm
    compliance=(np.full(60, 2.0e-5), modes),  # diag(d) + V V', mm/N
)
for name in ("native", "clarabel", "osqp"):
    answer = solve(problem, name, polish=False, tolerance=1e-4)
    print(f"{name:9} {answer.status.name:10} {answer.certificate.worst:.0e}  theta {answer.rotation:.12f}")

# %%
# Where a force is positive the gap is zero, and the other way round.

solution = solve(problem)
figure, left = plt.subplots(figsize=(7, 3.2), layout="constrained")
left.bar(x, solution.force, width=0.03, label="force")
left.set(xlabel="x", ylabel="force [N]")
right = left.twinx()
right.plot(x, 1e3 * solution.gap, color="tab:orange")
right.set_ylabel("gap [um]", color="tab:orange")
plt.show()
