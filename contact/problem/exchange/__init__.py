"""Files of contact problems: our own, and those of other fields."""
