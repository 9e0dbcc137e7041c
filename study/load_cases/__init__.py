"""Analysis over load cases, and the means of a duty cycle."""
