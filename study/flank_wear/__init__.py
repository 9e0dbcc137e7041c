"""Wear of the flanks over a duty cycle."""
