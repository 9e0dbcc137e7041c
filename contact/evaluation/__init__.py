"""Evaluation of a mesh cycle: pattern, contact ratio, mesh stiffness and place of the greatest pressure."""
