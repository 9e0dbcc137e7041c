"""The equations of the film on a grid: deflection, mass balance, complementarity, and the proof of an answer."""
