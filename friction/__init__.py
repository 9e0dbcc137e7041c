"""Friction and lubrication of the tooth contact."""
