"""Shafts on bearings: simple systems of beams that hold a member."""
