"""Figures of results as functions of what they show."""
