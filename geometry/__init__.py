"""Tooth flanks, blanks, ease-off and surface of roll angle: geometry alone, no loads."""
