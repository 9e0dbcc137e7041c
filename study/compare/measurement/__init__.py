"""Measurement of a comparison: problems, attempts in processes of their own, machine and versions."""
