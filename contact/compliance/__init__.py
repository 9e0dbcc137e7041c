"""Tooth compliance, in replaceable pieces: shell, root foundation, local line contact."""
