"""Processes: their memory, the environment of those that are started, and reading in one of its own."""
