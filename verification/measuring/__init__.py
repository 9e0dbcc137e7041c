"""Measured flanks: distances along normals, and the loop of cutting, measuring and correcting."""
