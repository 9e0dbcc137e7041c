"""Modes in the order of the segments for compiled code, and columns of a factor that couple its blocks."""
