"""Set-ups of the pinion as the shop has them: customary methods, their limits and their fit."""
