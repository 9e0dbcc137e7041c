"""Compliance and root stress of a tooth by finite elements on its real surfaces."""
