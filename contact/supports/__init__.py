"""Shafts, bearings and housing as a compliance of the pair: wrenches, relative motion, supports."""
