"""Unloaded and loaded tooth contact: curves, compliance, the contact problem and its solvers."""
