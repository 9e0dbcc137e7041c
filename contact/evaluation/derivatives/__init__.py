"""Derivatives of the contact over a mesh cycle by machine and cutter settings, assembly errors and torque."""
