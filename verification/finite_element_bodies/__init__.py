"""Yardsticks of the finite elements: another element, and several teeth as one body."""
