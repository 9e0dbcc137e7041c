"""From basic data to blanks and machine settings."""
