"""Deviations of a case: from files, datasets or formulas, the geometry with them, and corrections of settings."""
