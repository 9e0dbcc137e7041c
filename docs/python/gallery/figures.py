"""
Figures in axes of your own
===========================

``easeoff.plot`` draws what the command ``easeoff plot`` draws, on a page or into axes of a figure of your own.
"""

import matplotlib.pyplot as plt

import easeoff

tree = easeoff.analyze("nasa-12x36", torques=[50.0, 150.0])
print(easeoff.plot.pictures(tree))  # what this result has

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
easeoff.plot.contact_pattern(tree, member="gear", parts="print", axes=left)
easeoff.plot.transmission_error(tree, parts="orders", axes=right)
plt.show()
